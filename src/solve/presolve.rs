//! The gaps that the rows of the dual have.

use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::Operator;
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::contradiction::contradiction;
use crate::solve::diagnosis::Contradictions;
use crate::solve::gaps::Gaps;

/// Gaps of two rows that differ by less than this fraction of them are equal ...
const EQUAL: f64 = 1e-10;
/// ... and so are those that differ by rounding of how far loads and rows move the bodies.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// A gap so many times as large as all motion that loads make and rows demand is far.
pub const FAR: f64 = 1e4;

/// Gaps of all groups; refuses rows whose gaps no displacement satisfies. `moved` is how far the loads move a row at most.
pub fn presolve(case: Case, moved: f64) -> Result<Gaps> {
    let Ready { rows, island, dual, .. } = case.ready;
    let rhs = island.contact.rows.rhs.iter().chain(&island.equalities.rows.rhs);
    let scaled: Vec<f64> = rhs.zip(&rows.scaling.scale).map(|(c, s)| c * s).collect();
    let leaders = &rows.scaling.grouping.leaders;
    let kinds = (0..leaders.len()).map(|group| rows.kind(group));
    let mut gaps = Gaps {
        value: leaders.iter().map(|&i| scaled[i]).collect(),
        dual: Vec::new(),
        holder: leaders.clone(),
        bounded: kinds.map(|kind| kind == RowKind::Inequality).collect(),
        far: Vec::new(),
    };
    let demand = |(i, c): (usize, &f64)| if i < rows.contact { (-c).max(0.0) } else { c.abs() };
    let reach = scaled.iter().enumerate().map(demand).fold(moved, f64::max);
    let slack = |a: f64, b: f64| EQUAL * a.abs().max(b.abs()) + ROUNDING * reach;
    for (i, member) in rows.scaling.grouping.member.iter().enumerate() {
        let Some((group, sign)) = *member else { continue };
        let gap = sign * gaps.value[group];
        let slack = slack(gap, scaled[i]);
        let contradicts = if i >= rows.contact {
            (gap - scaled[i]).abs() > slack
        } else if gaps.bounded[group] {
            if scaled[i] < gap {
                (gaps.value[group], gaps.holder[group]) = (scaled[i], i);
            }
            false
        } else {
            gap > scaled[i] + slack
        };
        if contradicts {
            let turned = if gap > scaled[i] { 1.0 } else { -1.0 };
            let pair = vec![(i, turned), (leaders[group], -turned * sign)];
            if let Some(error) = Contradictions::new(case, &gaps).proof(pair)? {
                return Err(error);
            }
        }
    }
    if let Some(error) = contradiction(case, &gaps)? {
        return Err(error);
    }
    gaps.dual = rows.scaling.decoupling.solve(gaps.value.clone());
    gaps.far =
        gaps.value.iter().zip(&gaps.bounded).map(|(c, bounded)| *bounded && *c > FAR * reach).collect();
    gaps.add_springs(dual.order());
    Ok(gaps)
}
