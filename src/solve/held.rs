//! Which rows carry a force that holds a motion, and which rows carry only rounding.

use crate::certificate::NOISE;
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::random::scattered;
use crate::linalg::vector::weighted_norm;
use crate::linalg::{Csr, Matrix, Operator};
use crate::numbers::rounding;
use crate::numbers::solve::SMALL_FORCE;
use crate::platform::memory::zeros;
use crate::qp::AnswerFace;
use crate::setup::Ready;
use crate::solve::local::SizesOfForces;

const WHAT: &str = "the forces of rows";

/// Rows of the dual that hold nothing: groups of contact rows whose forces are all rounding, their own or, beside uneven rows, that of
/// resultants, and tangential rows of nodes whose friction bound is 0. `sizes`: of the forces on each body, with those of rows where they
/// touch; `forces`: of the rows of each kind, force; `coarse`: G'.
pub fn without_force(
    ready: &Ready,
    coarse: &Csr,
    sizes: &dyn Fn(&[f64]) -> Result<Vec<SizesOfForces>>,
    forces: [&[f64]; 3],
) -> Result<Vec<bool>> {
    let (lambda, rows, island) = (forces[0], &ready.rows, &ready.island);
    let mut push = zeros(island.touched.len(), WHAT)?;
    let kinds = RowKind::ALL.into_iter().zip(forces);
    kinds.for_each(|(kind, f)| island.members(kind).rows.matrix.mul_transposed_add(1.0, f, &mut push));
    let sizes = sizes(&push)?;
    let of = |of: fn(&SizesOfForces) -> f64| sizes.iter().map(of).collect::<Vec<f64>>();
    let (loads, pushes) = (of(|body| body.load), of(|body| body.push));
    let everywhere = weighted_norm(&loads, |_| 1.0).hypot(weighted_norm(&pushes, |_| 1.0));
    let of_bodies = |part: f64, idle: f64| -> Vec<f64> {
        let nothing = |(own, push): (&f64, &f64)| {
            let idle = if *own == 0.0 { idle * everywhere } else { 0.0 };
            (part * (own + push)).max(idle)
        };
        loads.iter().zip(&pushes).map(nothing).collect()
    };
    let mut held: Vec<bool> = (0..rows.groups()).map(|group| rows.kind(group) != RowKind::Equality).collect();
    let mut small = held.clone();
    let (rounding, weak) = (of_bodies(rounding::METHOD, NOISE), of_bodies(SMALL_FORCE, SMALL_FORCE));
    for (i, (group, _)) in rows.scaling.grouping.members().filter(|(i, _)| *i < rows.contact) {
        let exceeds = |nothing: &[f64]| {
            let bodies = island.contact.rows.matrix.row(i).map(|(j, _)| nothing[island.touched.body_of(j)]);
            lambda[i] > rows.scaling.scale[i] * bodies.fold(f64::INFINITY, f64::min)
        };
        held[group] &= !exceeds(&rounding);
        small[group] &= !exceeds(&weak);
    }
    // friction resists if its bound is positive
    for node in island.friction.nodes.iter().filter(|node| node.limit(lambda) > 0.0) {
        for row in node.rows().map(|row| rows.tangential + row) {
            if let Some((group, _)) = rows.scaling.grouping.member[row] {
                (held[group], small[group]) = (false, false);
            }
        }
    }
    held.resize(ready.dual.order(), false);
    small.resize(ready.dual.order(), false);
    let mut carries = vec![false; held.len()];
    for (i, (group, _)) in rows.scaling.grouping.members().filter(|(i, _)| *i < rows.contact) {
        carries[group] |= lambda[i] > 0.0 && small[group];
    }
    let is_carried = carries.contains(&true);
    if !is_carried && !rows.uneven {
        return Ok(held);
    }
    let dual = &ready.dual;
    let terms = dual.of_modes(sizes.iter().map(|body| body.of_load + body.of_push));
    if is_carried {
        let free = AnswerFace::new(coarse, &dual.blocks, &small, dual.rounding())?.undetermined()?;
        let resultants: Vec<f64> = sizes.iter().flat_map(|body| &body.resultants).copied().collect();
        judge(&mut held, &carries, coarse, &free, (&resultants, &terms), dual.rounding());
    }
    if rows.uneven {
        let noise = rounding_of(&terms);
        let shaken = AnswerFace::new(coarse, &dual.blocks, &held, dual.rounding())?.forces(&noise)?;
        let is_bounded = |group| rows.kind(group) == RowKind::Inequality;
        let mut none: Vec<bool> = (0..rows.groups()).map(is_bounded).collect();
        for (i, (group, _)) in rows.scaling.grouping.members().filter(|(i, _)| *i < rows.contact) {
            none[group] &= lambda[i] <= rows.scaling.force_of(group, i) * shaken[group].abs();
        }
        held.iter_mut().zip(none).for_each(|(held, none)| *held |= none);
    }
    Ok(held)
}

/// Rounding of resultants with these terms: that of a heavy body may lie on a light one as a force of its rows.
fn rounding_of(terms: &[f64]) -> Vec<f64> {
    scattered(terms.len()).iter().zip(terms).map(|(sign, term)| sign.signum() * NOISE * term).collect()
}

/// Rows with small forces hold nothing if the loads do no work, up to rounding, along the free motions that they and others with
/// small forces resist; they do hold if the loads do.
fn judge(
    held: &mut [bool],
    carries: &[bool],
    coarse: &Csr,
    free: &Matrix,
    (e, terms): (&[f64], &[f64]),
    rounding: f64,
) {
    let mut along = vec![Vec::new(); free.rows];
    for j in 0..free.cols {
        free.col(j)
            .iter()
            .enumerate()
            .filter(|(_, a)| **a != 0.0)
            .for_each(|(mode, a)| along[mode].push((j, *a)));
    }
    let resisted: Vec<(usize, Vec<usize>)> =
        (0..held.len()).filter(|&i| carries[i]).map(|i| (i, resisted(coarse, i, &along, rounding))).collect();
    let (component, count) = joined(free.cols, resisted.iter().map(|(_, motions)| motions.iter().copied()));
    let mut works = vec![false; count];
    for j in 0..free.cols {
        let a = free.col(j);
        let work: f64 = a.iter().zip(e).map(|(a, e)| a * e).sum();
        let size: f64 = a.iter().zip(terms).map(|(a, term)| a.abs() * term).sum();
        works[component[j]] |= work.abs() > rounding * size;
    }
    for (i, motions) in resisted.into_iter().filter(|(_, motions)| !motions.is_empty()) {
        held[i] = !works[component[motions[0]]];
    }
}

/// The free motions that row i resists by more than rounding.
fn resisted(coarse: &Csr, i: usize, along: &[Vec<(usize, f64)>], rounding: f64) -> Vec<usize> {
    let mut terms: Vec<(usize, f64)> =
        coarse.row(i).flat_map(|(mode, g)| along[mode].iter().map(move |&(j, a)| (j, g * a))).collect();
    terms.sort_by_key(|term| term.0);
    let resists = |own: &&[(usize, f64)]| {
        let (sum, size) =
            own.iter().fold((0.0, 0.0), |(sum, size), term| (sum + term.1, size + term.1.abs()));
        f64::abs(sum) > rounding * size
    };
    terms.chunk_by(|a, b| a.0 == b.0).filter(resists).map(|own| own[0].0).collect()
}
