//! The numeric factorisation of K in a process of its own: what is compared with faer's. The second one is measured: the
//! host of a virtual machine has found memory for the first.

use std::sync::Arc;

use decks::Deck;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::linalg::{Analysis, Cholesky, Symmetric};

use crate::clock::{peak, restart_peak, Clock};
use crate::parts::stiffness;

/// What the residual of a solution may be, against the terms of its sums.
const RESIDUAL: f64 = 1e-13;

/// Prints lines `name value`: time of the first and the second factorisation, entries of L, growth of the peak of memory.
pub fn run(deck: &Deck, threads: usize) -> std::result::Result<(), String> {
    let (k, analysis) = analyse(deck).map_err(|error| error.to_string())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| error.to_string())?;
    pool.broadcast(|_| ());
    restart_peak();
    let before = peak();
    let factorise = |name: &str| {
        let clock = Clock::start();
        let factor = match threads {
            1 => analysis.factorize(&k, 1.0),
            _ => pool.install(|| analysis.factorize(&k, 1.0)),
        };
        let lap = clock.lap();
        println!("{name}wall {:.6}\n{name}cpu {:.6}", lap.wall, lap.cpu);
        factor.map_err(|error| error.to_string())?.map_err(|at| format!("{at:?}"))
    };
    drop(factorise("first_")?);
    println!("dofs {}\nentries {}\nmemory {:.0}", k.order(), analysis.entries(), peak() - before);
    let factor = factorise("")?;
    let residual = residual(&k, &factor).map_err(|error| error.to_string())?;
    println!("residual {residual:.3e}");
    if residual.is_nan() || residual > RESIDUAL {
        return Err(format!("residual {residual:e}"));
    }
    Ok(())
}

/// The dofs in the order of elimination.
pub fn order(deck: &Deck) -> Result<Vec<u32>> {
    let (_, analysis) = analyse(deck)?;
    Ok(analysis.order.iter().map(|&dof| dof as u32).collect())
}

/// K of the one body of a deck, which is held.
fn analyse(deck: &Deck) -> Result<(Symmetric, Arc<Analysis>)> {
    let [body] = &deck.bodies[..] else { return Err(Error::new(Kind::State, "not one body")) };
    let k = stiffness(body)?;
    let analysis = Analysis::new(&k, &vec![false; k.order()])?;
    Ok((k, Arc::new(analysis)))
}

/// max_i |b - K x|_i / (|K||x| + |b|)_i of the solution for b_i = sin i.
fn residual(k: &Symmetric, factor: &Cholesky) -> Result<f64> {
    let b: Vec<f64> = (0..k.order()).map(|i| (i as f64).sin()).collect();
    let (mut x, mut image, mut terms) = (b.clone(), vec![0.0; b.len()], vec![0.0; b.len()]);
    factor.solve(&mut x)?;
    k.mul_with_terms(&x, &mut image, &mut terms);
    let left = b.iter().zip(&image).map(|(b, image)| (b - image).abs());
    let ratios = left.zip(&terms).zip(&b).map(|((left, terms), b)| left / (terms + b.abs()));
    Ok(ratios.fold(0.0, f64::max))
}
