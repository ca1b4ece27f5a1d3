//! The entries of rows as given: their unknowns, and sums of repeated entries.

use crate::constraints::RowsInput;
use crate::error::{Error, Result, INDEX};
use crate::linalg::vector::NOISE;

/// Sorts entries and sums those of one unknown. Returns what is rounding in this row: 64 eps of the terms of a sum that is
/// no more than that; 0 if there is no such sum.
pub fn summed(entries: &mut Vec<(usize, f64)>) -> f64 {
    entries.sort_by_key(|entry| entry.0);
    if entries.windows(2).all(|pair| pair[0].0 != pair[1].0) {
        return 0.0;
    }
    let mut noise = 0.0f64;
    let sums = entries.chunk_by(|a, b| a.0 == b.0).map(|same| {
        let sum: f64 = same.iter().map(|entry| entry.1).sum();
        let rounding = NOISE * same.iter().map(|entry| entry.1.abs()).sum::<f64>();
        if same.len() > 1 && sum.abs() <= rounding {
            noise = noise.max(rounding);
        }
        (same[0].0, sum)
    });
    *entries = sums.collect();
    noise
}

/// Number of the unknown of entry `at` among all unknowns.
pub fn unknown(input: RowsInput<'_>, at: usize, offsets: &[usize]) -> Result<usize> {
    let bodies = offsets.len() - 1;
    let body = input.body.map(|body| {
        usize::try_from(body[at]).ok().filter(|&b| b < bodies).ok_or_else(|| {
            let what = format!("body {INDEX} does not exist: there are {bodies} bodies");
            Error::argument("body", what).index(body[at])
        })
    });
    let body = body.transpose()?;
    let (start, end) = body.map_or((0, offsets[bodies]), |body| (offsets[body], offsets[body + 1]));
    let dof = usize::try_from(input.dof[at]).ok().filter(|&dof| dof < end - start).ok_or_else(|| {
        let of = if body.is_some() { "the body" } else { "all bodies" };
        let what = format!("unknown {INDEX} is outside the {} unknowns of {of}", end - start);
        let error = Error::argument("dof", what).index(input.dof[at]);
        match body {
            Some(body) => error.body(body),
            None => error,
        }
    })?;
    Ok(start + dof)
}
