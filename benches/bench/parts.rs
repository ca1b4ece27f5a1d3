//! The parts of the setup, one after the other, body by body on one thread; and a product with an explicit F.

use std::hint::black_box;
use std::sync::Arc;

use decks::{Body, Deck};
use feti_contact::body::{from_sparse, GeneralizedInverse, Modes, NullSpaceInput, SparseInput, Storage};
use feti_contact::error::{Error, Kind, Result};
use feti_contact::linalg::cholesky::{inverse_form, order_of_elimination};
use feti_contact::linalg::graph::Graph;
use feti_contact::linalg::{Analysis, Csr, Matrix, Multiple, Operator, Packed, Symmetric};

use crate::clock::Clock;

const NAMES: [&str; 6] = ["plan", "execute", "ordering", "analysis", "factorisation", "dual_operator"];

/// Prints seconds of processor time of every part, all bodies together. `plan` is the null space, `analysis` has the
/// ordering in it, `execute` analysis, factorisation and its probe, in memory not touched before.
pub fn run(deck: &Deck) -> Result<()> {
    let mut seconds = [0.0; NAMES.len()];
    let mut entries = 0;
    for (p, body) in deck.bodies.iter().enumerate() {
        let (own, of_l) = measure(body, &local_rows(deck, p))?;
        seconds.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        entries += of_l;
    }
    NAMES.iter().zip(seconds).for_each(|(name, seconds)| println!("{name}_cpu {seconds:.6}"));
    println!("entries {entries}");
    Ok(())
}

/// Processor time of `work`, and what it gives.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let clock = Clock::start();
    let result = work();
    *seconds = clock.lap().cpu;
    result
}

/// Seconds, and entries of L.
fn measure(body: &Body, rows: &Csr) -> Result<([f64; NAMES.len()], usize)> {
    let mut seconds = [0.0; NAMES.len()];
    let k = Multiple::from(stiffness(body)?);
    let modes = body.modes();
    let vectors = Matrix { rows: body.dofs(), cols: modes.len(), data: modes.concat() };
    let given = NullSpaceInput { vectors, modes: Modes::Exact };
    let plan = timed(&mut seconds[0], || {
        let mut plan = GeneralizedInverse::plan(k.clone(), &given, 1e-8)?;
        let symbolic = plan.analyse()?;
        plan.set_analysis(symbolic);
        Ok(plan)
    })?;
    let mut held = vec![false; body.dofs()];
    let inverse = timed(&mut seconds[1], || plan.execute())?.inverse;
    inverse.fixing.iter().for_each(|&dof| held[dof] = true);
    timed(&mut seconds[2], || order_of_elimination(&Graph::of(&k.matrix)?, &held))?;
    let analysis = Arc::new(timed(&mut seconds[3], || Analysis::new(&k.matrix, &held))?);
    let factor = timed(&mut seconds[4], || analysis.factorize(&k.matrix, k.by))?;
    let factor = factor.map_err(|at| Error::new(Kind::Indefinite, "no factor").dof(at.dof))?;
    black_box(timed(&mut seconds[5], || inverse_form(&factor, rows))?);
    Ok((seconds, analysis.entries()))
}

pub fn stiffness(body: &Body) -> Result<Symmetric> {
    let k = &body.stiffness;
    let col: Vec<i64> = k.col.iter().map(|&j| j as i64).collect();
    from_sparse(SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full }, 1e-10)
}

/// The contact rows of body p over its own dofs.
fn local_rows(deck: &Deck, p: usize) -> Csr {
    let own = deck.offset(p)..deck.offset(p + 1);
    let mut rows = Csr::empty(own.len());
    for row in 0..deck.contact.len() {
        let entries = deck.contact.matrix.row(row).filter(|entry| own.contains(&entry.0));
        rows.push_row(entries.map(|(dof, value)| (dof - own.start, value)));
    }
    rows
}

/// Prints bytes per second of y = F x, F packed and larger than twice the last cache, and of a = b + s c on vectors of
/// as many bytes in all; both the best of five.
pub fn bandwidth() -> Result<()> {
    let bytes = (2 * last_cache()).clamp(1 << 28, 1 << 30);
    let order = ((bytes / 4) as f64).sqrt() as usize;
    let mut f = Packed::zeros(order)?;
    (0..order).for_each(|i| (0..=i).for_each(|j| f.add(i, j, 1.0 / (1 + i + j) as f64)));
    let (x, mut y) = (vec![1.0; order], vec![0.0; order]);
    let len = bytes / 24;
    let (mut a, b, c) = (vec![0.0; len], vec![1.0; len], vec![2.0; len]);
    let (mut product, mut triad) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..5 {
        let clock = Clock::start();
        f.apply(black_box(&x), black_box(&mut y));
        product = product.min(clock.lap().wall);
        let clock = Clock::start();
        let (a, b, c) = (black_box(&mut a), black_box(&b), black_box(&c));
        a.iter_mut().zip(b).zip(c).for_each(|((a, b), c)| *a = b + 3.0 * c);
        triad = triad.min(clock.lap().wall);
    }
    println!("product {:.6e}", Packed::bytes(order) as f64 / product);
    println!("triad {:.6e}", (24 * len) as f64 / triad);
    Ok(())
}

/// Bytes of the last cache; 32 MiB where the system does not tell.
fn last_cache() -> usize {
    let size = |index: usize| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/size");
        let text = std::fs::read_to_string(path).ok()?;
        text.trim().strip_suffix('K')?.parse::<usize>().ok().map(|kilobytes| kilobytes << 10)
    };
    (0..8).filter_map(size).max().unwrap_or(32 << 20)
}
