//! What is suspicious in bodies: few digits of K, declared motions that K resists, units of stiffness that do not fit those of a neighbour.

use std::collections::BTreeMap;

use crate::contents::{Body, Contents};
use crate::show::{median, Suspicion};

/// Values that K has at least, in different sizes, before its digits say something.
const VALUES: usize = 32;
/// Digits that numbers have which were written with few: single precision, or 8 decimal places.
const FEW: usize = 8;
/// A motion is resisted by rounding of double precision up to this part of its terms, with a row of 100 entries.
const ROUNDING: f64 = 1e-12;
/// Steel on rubber is 1e5; MPa for Pa is 1e6.
const STIFFER: f64 = 2e5;

pub fn suspicions(all: &Contents) -> Vec<Suspicion> {
    let mut found = Vec::new();
    for (p, body) in all.bodies.iter().enumerate() {
        let (digits, is_round) = (digits(body), distinct(body) < VALUES);
        if digits <= FEW
            && (resisted(body) > Some(ROUNDING)
                || !is_round && body.motions.as_ref().is_none_or(|of| of.columns == 0))
        {
            let what = match is_single(body) {
                true => "the entries of K have single precision".to_owned(),
                false => format!("the entries of K have only {digits} digits"),
            };
            found.push(Suspicion::new(
                format!("body {p}"),
                what,
                "write K with all digits of double precision (17), not in single precision",
            ));
        }
    }
    for ((a, b), [soft, stiff]) in stiffnesses(all) {
        if stiff > STIFFER * soft {
            let what =
                format!("where these bodies touch, one is {:.0e} times stiffer than the other", stiff / soft);
            let remedy =
                "check the units of K: N/mm against N/m, MPa against Pa; nothing to do if it is meant";
            found.push(Suspicion::new(format!("bodies {a} and {b}"), what, remedy));
        }
    }
    found
}

/// Significant decimal digits of the entries of K, up to 17; single precision counts as 8.
pub fn digits(body: &Body) -> usize {
    match is_single(body) {
        true => FEW.min(decimal(&body.k.val)),
        false => decimal(&body.k.val),
    }
}

fn is_single(body: &Body) -> bool {
    let values = &body.k.val;
    !values.is_empty() && values.iter().all(|v| f64::from(*v as f32) == *v)
}

/// The rounding of a sum leaves more digits in a few entries: all but one of 32 have so many.
fn decimal(values: &[f64]) -> usize {
    let own = |v: &f64| (1..17).find(|d| format!("{v:.*e}", d - 1).parse() == Ok(*v)).unwrap_or(17);
    let mut digits: Vec<usize> =
        values.iter().filter(|v| **v != 0.0).step_by(values.len() / 4096 + 1).map(own).collect();
    digits.sort_unstable();
    digits.get((digits.len() * 31 / 32).min(digits.len().saturating_sub(1))).copied().unwrap_or(0)
}

fn distinct(body: &Body) -> usize {
    let mut sizes: Vec<u64> = body.k.val.iter().map(|v| v.abs().to_bits()).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes.len()
}

/// The largest (K R)_i relative to its terms, over the motions that are declared as exact.
pub fn resisted(body: &Body) -> Option<f64> {
    let motions = body.motions.as_ref().filter(|of| of.columns > 0 && of.modes == 0)?;
    let mut worst = 0.0f64;
    for r in motions.basis.chunks_exact(body.n.max(1)) {
        let (y, size) = body.product(r);
        y.iter()
            .zip(&size)
            .for_each(|(y, size)| worst = worst.max(if *size > 0.0 { y.abs() / size } else { 0.0 }));
    }
    Some(worst)
}

/// For each pair of bodies that contact rows join, the smaller and the larger of the stiffnesses at their rows.
fn stiffnesses(all: &Contents) -> BTreeMap<(usize, usize), [f64; 2]> {
    let diagonals: Vec<_> = all.bodies.iter().map(Body::diagonal).collect();
    let mut at: BTreeMap<(usize, usize), [Vec<f64>; 2]> = BTreeMap::new();
    let rows = &all.rows[0];
    for i in (0..rows.rhs.len()).filter(|&i| rows.rhs[i].is_finite()) {
        let mut bodies: Vec<usize> = rows.matrix.row(i).map(|(j, _)| all.body_of(j)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let [a, b] = bodies[..] else { continue };
        for (j, _) in rows.matrix.row(i) {
            let p = all.body_of(j);
            let k = diagonals[p][j - all.starts[p]];
            at.entry((a, b)).or_default()[usize::from(p == b)].push(k);
        }
    }
    let both = |[a, b]: [Vec<f64>; 2]| {
        let (a, b) = (median(a)?, median(b)?);
        (a > 0.0 && b > 0.0).then(|| [a.min(b), a.max(b)])
    };
    at.into_iter().filter_map(|(pair, of)| Some((pair, both(of)?))).collect()
}
