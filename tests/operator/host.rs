//! A host with its own dense factorisation.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};

use feti_contact::solver::{HostFunctions, HostProduct, Problem};

/// How K+ is made of a singular K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// r unknowns held.
    Held,
    /// `(K + rho Q Q')^-1`, Q an orthonormal basis of the null space.
    Regularised,
}

/// Dense, n x n by columns.
#[derive(Clone)]
pub struct Host {
    pub n: usize,
    pub k: Vec<f64>,
    pub kplus: Vec<f64>,
    pub book: Arc<Book>,
}

/// What the functions have seen.
#[derive(Default)]
pub struct Book {
    pub columns_of_kplus: AtomicUsize,
    /// Of them, columns in calls of one column.
    pub columns_alone: AtomicUsize,
    pub columns_of_k: AtomicUsize,
    /// Calls of both.
    pub calls: AtomicUsize,
    /// Number of the call that fails, from 1; 0: none.
    pub fails: AtomicUsize,
    pub threads: Mutex<Vec<ThreadId>>,
}

impl Book {
    fn enter(&self) -> i32 {
        let me = thread::current().id();
        let mut threads = self.threads.lock().unwrap();
        if !threads.contains(&me) {
            threads.push(me);
        }
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        if call == self.fails.load(Ordering::Relaxed) {
            7
        } else {
            0
        }
    }
}

fn orthonormal(n: usize, modes: &[f64]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for v in modes.chunks(n) {
        let mut v = v.to_vec();
        for _ in 0..2 {
            for q in &basis {
                let part: f64 = q.iter().zip(&v).map(|(a, b)| a * b).sum();
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
            }
        }
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        v.iter_mut().for_each(|v| *v /= length);
        basis.push(v);
    }
    basis
}

/// Unknowns whose rows of the basis are most independent.
fn most_independent(n: usize, basis: &[Vec<f64>]) -> Vec<usize> {
    let mut rows: Vec<Vec<f64>> = (0..n).map(|i| basis.iter().map(|q| q[i]).collect()).collect();
    let size = |row: &Vec<f64>| row.iter().map(|v| v * v).sum::<f64>();
    let mut held = Vec::new();
    for _ in 0..basis.len() {
        let best = (0..n).fold(0, |best, i| if size(&rows[i]) > size(&rows[best]) { i } else { best });
        let (pivot, length) = (rows[best].clone(), size(&rows[best]));
        for row in &mut rows {
            let part = row.iter().zip(&pivot).map(|(a, b)| a * b).sum::<f64>() / length;
            row.iter_mut().zip(&pivot).for_each(|(v, p)| *v -= part * p);
        }
        held.push(best);
    }
    held
}

/// The inverse of a positive definite matrix by Cholesky.
fn inverse(n: usize, mut a: Vec<f64>) -> Vec<f64> {
    for j in 0..n {
        for k in 0..j {
            let factor = a[j + k * n];
            (j..n).for_each(|i| a[i + j * n] -= a[i + k * n] * factor);
        }
        let pivot = a[j + j * n].sqrt();
        (j..n).for_each(|i| a[i + j * n] /= pivot);
    }
    let mut x = vec![0.0; n * n];
    for (c, x) in x.chunks_mut(n).enumerate() {
        x[c] = 1.0;
        for j in c..n {
            x[j] /= a[j + j * n];
            let value = x[j];
            (j + 1..n).for_each(|i| x[i] -= a[i + j * n] * value);
        }
        for j in (0..n).rev() {
            let sum: f64 = (j + 1..n).map(|i| a[i + j * n] * x[i]).sum();
            x[j] = (x[j] - sum) / a[j + j * n];
        }
    }
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (x[i + j * n] + x[j + i * n]);
            (x[i + j * n], x[j + i * n]) = (mean, mean);
        }
    }
    x
}

impl Host {
    /// `modes`: a basis of the null space, n x r.
    pub fn new(n: usize, k: Vec<f64>, modes: &[f64], form: Form) -> Self {
        let (basis, mut regular) = (orthonormal(n, modes), k.clone());
        let held = if form == Form::Held { most_independent(n, &basis) } else { Vec::new() };
        let rho = (0..n).map(|i| k[i + i * n]).sum::<f64>() / n as f64;
        match form {
            Form::Held => held.iter().for_each(|&dof| {
                (0..n).for_each(|i| {
                    regular[i + dof * n] = 0.0;
                    regular[dof + i * n] = 0.0;
                });
                regular[dof + dof * n] = rho;
            }),
            Form::Regularised => {
                for q in &basis {
                    (0..n * n).for_each(|at| regular[at] += rho * q[at % n] * q[at / n]);
                }
            }
        }
        let mut kplus = inverse(n, regular);
        held.iter().for_each(|&dof| kplus[dof + dof * n] = 0.0);
        Self { n, k, kplus, book: Arc::default() }
    }

    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.n).map(|i| self.k[i + i * self.n]).collect()
    }

    pub fn functions(&self, concurrent: bool) -> HostFunctions {
        let product = |matrix: Vec<f64>, of_kplus: bool| -> HostProduct {
            let (n, book) = (self.n, Arc::clone(&self.book));
            Box::new(move |x, nrhs, y| {
                let counter = if of_kplus { &book.columns_of_kplus } else { &book.columns_of_k };
                counter.fetch_add(nrhs, Ordering::Relaxed);
                if of_kplus && nrhs == 1 {
                    book.columns_alone.fetch_add(1, Ordering::Relaxed);
                }
                for (x, y) in x.chunks(n).zip(y.chunks_mut(n)) {
                    for (column, x) in matrix.chunks(n).zip(x).filter(|(_, x)| **x != 0.0) {
                        y.iter_mut().zip(column).for_each(|(y, a)| *y += a * x);
                    }
                }
                book.enter()
            })
        };
        HostFunctions {
            kplus: product(self.kplus.clone(), true),
            k: product(self.k.clone(), false),
            concurrent,
        }
    }

    pub fn give(&self, problem: &mut Problem, body: usize, concurrent: bool) {
        problem.set_operator(body, &self.diagonal(), self.functions(concurrent)).unwrap();
    }
}
