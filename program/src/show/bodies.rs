//! What is suspicious in bodies: few digits of K, declared motions that K resists, units of stiffness that do not fit those of a neighbour.

use std::collections::BTreeMap;

use feti_contact::solver::{Digits, Modes};

use crate::contents::{Body, Contents};
use crate::show::{median, Suspicion};

/// A motion is resisted by rounding of double precision up to this part of its terms, with a row of 100 entries.
const ROUNDING: f64 = 1e-12;
/// Steel on rubber is 1e5; MPa for Pa is 1e6.
const STIFFER: f64 = 2e5;

pub fn suspicions(all: &Contents) -> Vec<Suspicion> {
    let mut found = Vec::new();
    for (p, body) in all.bodies.iter().enumerate() {
        // with more digits than single precision the library solves as well
        let few = |of: &Digits| of.relative() >= Digits::Single.relative();
        let Some(digits) = body.digits().filter(few) else { continue };
        if resisted(body) > Some(ROUNDING) || body.declared().unwrap_or(0) == 0 {
            let only = if digits == Digits::Single { "" } else { "only " };
            found.push(Suspicion::new(
                format!("body {p}"),
                format!("the entries of K have {only}{digits}"),
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

/// The largest (K R)_i relative to its terms, over the motions that are declared as exact.
pub fn resisted(body: &Body) -> Option<f64> {
    let (basis, _) = body.given.motions.filter(|(basis, of)| *of == Modes::Exact && !basis.is_empty())?;
    let (k, n) = (body.k()?, body.n());
    let (mut y, mut terms, mut worst) = (vec![0.0; n], vec![0.0; n], 0.0f64);
    for r in basis.chunks_exact(n.max(1)) {
        k.mul_with_terms(r, &mut y, &mut terms);
        let parts = y.iter().zip(&terms).filter(|(_, term)| **term > 0.0);
        worst = parts.map(|(y, term)| y.abs() / term).fold(worst, f64::max);
    }
    Some(worst)
}

/// For each pair of bodies that contact rows join, the smaller and the larger of the stiffnesses at their rows.
fn stiffnesses(all: &Contents) -> BTreeMap<(usize, usize), [f64; 2]> {
    let diagonals: Vec<_> = all.bodies.iter().map(Body::diagonal).collect();
    let mut at: BTreeMap<(usize, usize), [Vec<f64>; 2]> = BTreeMap::new();
    let rows = all.rows[0];
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
