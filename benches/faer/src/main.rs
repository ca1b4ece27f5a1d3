//! The numeric factorisation by faer's supernodal Cholesky: `factorise-by-faer <matrix> <order> <threads>`. The order of
//! elimination is given, so that it is that of the library; the second factorisation is measured, as the library's is in
//! `factors.rs`. Prints lines `name value`.

#[path = "../../bench/clock.rs"]
mod clock;

use std::fs::File;
use std::io::{BufReader, Read};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use clock::{peak, restart_peak, Clock};

/// What the residual of a solution may be, against the terms of its sums.
const RESIDUAL: f64 = 1e-13;

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [matrix, order, threads] = &arguments[..] else {
        return Err("matrix, order, threads".into());
    };
    let k = Lower::read(matrix).map_err(|error| format!("{matrix}: {error}"))?;
    let order = read_order(order).map_err(|error| format!("{order}: {error}"))?;
    let par = match threads.parse() {
        Ok(1) => Par::Seq,
        Ok(threads) => start(threads)?,
        Err(_) => return Err("no number of threads".into()),
    };
    run(&k, &order, par).map_err(|error| format!("{error:?}"))
}

/// Starts the threads.
fn start(threads: usize) -> Result<Par, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global().map_err(|error| error.to_string())?;
    rayon::broadcast(|_| ());
    Ok(Par::rayon(threads))
}

fn run(k: &Lower, order: &[u32], par: Par) -> Result<(), Box<dyn std::fmt::Debug>> {
    let symbolic = analyse(k, order).map_err(boxed)?;
    restart_peak();
    let before = peak();
    drop(factorise(k, &symbolic, par, "first_")?);
    println!("entries {}\nmemory {:.0}", symbolic.len_val(), peak() - before);
    let values = factorise(k, &symbolic, par, "")?;
    let residual = k.residual(LltRef::new(&symbolic, &values));
    println!("residual {residual:.3e}");
    if residual.is_nan() || residual > RESIDUAL {
        return Err(boxed(format!("residual {residual:e}")));
    }
    Ok(())
}

/// The values of L, in memory not touched before.
fn factorise(
    k: &Lower,
    symbolic: &SymbolicCholesky<u32>,
    par: Par,
    name: &str,
) -> Result<Vec<f64>, Box<dyn std::fmt::Debug>> {
    let clock = Clock::start();
    let mut values = vec![0.0; symbolic.len_val()];
    let need = symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default());
    let mut workspace = MemBuffer::try_new(need).map_err(boxed)?;
    let stack = MemStack::new(&mut workspace);
    let (lower, exact, params) = (Side::Lower, Default::default(), Default::default());
    symbolic.factorize_numeric_llt(&mut values, k.view(), lower, exact, par, stack, params).map_err(boxed)?;
    let lap = clock.lap();
    println!("{name}wall {:.6}\n{name}cpu {:.6}", lap.wall, lap.cpu);
    Ok(values)
}

fn boxed(error: impl std::fmt::Debug + 'static) -> Box<dyn std::fmt::Debug> {
    Box::new(error)
}

/// The pattern of L, `order[k]` eliminated as number k.
fn analyse(k: &Lower, order: &[u32]) -> Result<SymbolicCholesky<u32>, faer::sparse::FaerError> {
    let mut position = vec![0; order.len()];
    order.iter().enumerate().for_each(|(at, &dof)| position[dof as usize] = at as u32);
    let order = SymmetricOrdering::Custom(PermRef::new_checked(order, &position, order.len()));
    let always = SupernodalThreshold::FORCE_SUPERNODAL;
    let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: always, ..Default::default() };
    factorize_symbolic_cholesky(k.view().symbolic(), Side::Lower, order, params)
}

/// The lower triangle by columns.
struct Lower {
    ptr: Vec<u32>,
    row: Vec<u32>,
    val: Vec<f64>,
}

impl Lower {
    /// From the file of `matrix.rs`.
    fn read(path: &str) -> std::io::Result<Self> {
        let mut file = BufReader::new(File::open(path)?);
        let mut size = || bytes::<8>(&mut file).map(|b| i64::from_ne_bytes(b) as usize);
        let (order, entries) = (size()?, size()?);
        let ptr = indices(&mut file, order + 1)?;
        let row = indices(&mut file, entries)?;
        let val = (0..entries).map(|_| bytes(&mut file).map(f64::from_ne_bytes)).collect::<Result<_, _>>()?;
        Ok(Self { ptr, row, val })
    }

    fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    fn view(&self) -> SparseColMatRef<'_, u32, f64> {
        let n = self.order();
        SparseColMatRef::new(
            SymbolicSparseColMatRef::new_checked(n, n, &self.ptr, None, &self.row),
            &self.val,
        )
    }

    /// max_i |b - K x|_i / (|K||x| + |b|)_i of the solution for b_i = sin i.
    fn residual(&self, factor: LltRef<'_, u32, f64>) -> f64 {
        let b: Vec<f64> = (0..self.order()).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        let mut workspace = MemBuffer::new(factor.symbolic().solve_in_place_scratch::<f64>(1, Par::Seq));
        let columns = MatMut::from_column_major_slice_mut(&mut x, self.order(), 1);
        factor.solve_in_place_with_conj(Conj::No, columns, Par::Seq, MemStack::new(&mut workspace));
        let mut left = b.clone();
        let mut terms: Vec<f64> = b.iter().map(|b| b.abs()).collect();
        let mut add = |i: usize, term: f64| {
            left[i] -= term;
            terms[i] += term.abs();
        };
        for j in 0..self.order() {
            for at in self.ptr[j] as usize..self.ptr[j + 1] as usize {
                let (i, k) = (self.row[at] as usize, self.val[at]);
                add(i, k * x[j]);
                if i != j {
                    add(j, k * x[i]);
                }
            }
        }
        left.iter().zip(&terms).fold(0.0, |worst: f64, (left, terms)| worst.max(left.abs() / terms))
    }
}

/// A file of indices alone.
fn read_order(path: &str) -> std::io::Result<Vec<u32>> {
    let count = std::fs::metadata(path)?.len() as usize / 4;
    indices(&mut BufReader::new(File::open(path)?), count)
}

fn indices(file: &mut impl Read, count: usize) -> std::io::Result<Vec<u32>> {
    (0..count).map(|_| bytes(file).map(u32::from_ne_bytes)).collect()
}

fn bytes<const N: usize>(file: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes).map(|()| bytes)
}
