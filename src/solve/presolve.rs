//! The gaps of the rows of the dual problem.

use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::linalg::Operator;
use crate::numbers::solve::{EQUAL_GAPS, FAR, FAR_WITH_FRICTION};
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::contradiction::contradiction;
use crate::solve::diagnosis::Contradictions;
use crate::solve::gaps::Gaps;

/// Gaps of all groups; refuses rows whose gaps no displacement satisfies. `moved`: the largest motion of a row by the
/// loads.
pub fn presolve(case: Case, moved: f64) -> Result<Gaps> {
    let Ready { rows, island, dual, .. } = case.ready;
    let rhs = RowKind::ALL.into_iter().flat_map(|kind| &island.members(kind).rows.rhs);
    let scaled: Vec<f64> = rhs.zip(&rows.scaling.scale).map(|(c, s)| c * s).collect();
    let leaders = &rows.scaling.grouping.leaders;
    let idle = idle(case);
    let is_bounded = |group: usize| rows.kind(group) == RowKind::Inequality || idle[leaders[group]];
    let mut gaps = Gaps {
        value: leaders.iter().map(|&i| if idle[i] { f64::INFINITY } else { scaled[i] }).collect(),
        dual: Vec::new(),
        holder: leaders.clone(),
        share: Vec::new(),
        bounded: (0..leaders.len()).map(is_bounded).collect(),
        far: Vec::new(),
    };
    let demand = |(i, c): (usize, &f64)| match i {
        _ if idle[i] => 0.0,
        _ if i < rows.contact => (-c).max(0.0),
        _ => c.abs(),
    };
    let reach = scaled.iter().enumerate().map(demand).fold(moved, f64::max);
    let slack = |a: f64, b: f64| EQUAL_GAPS * a.abs().max(b.abs()) + NOISE * reach;
    for (i, member) in rows.scaling.grouping.member[..rows.tangential].iter().enumerate() {
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
    share(case, &mut gaps, &scaled);
    let finite = gaps.value.iter().map(|gap| if *gap < f64::INFINITY { *gap } else { 0.0 });
    let far = if case.has_friction() { FAR_WITH_FRICTION } else { FAR };
    gaps.dual = rows.scaling.decoupling.solve(finite.collect());
    gaps.far =
        gaps.value.iter().zip(&gaps.bounded).map(|(c, bounded)| *bounded && *c > far * reach).collect();
    gaps.add_springs(dual.order());
    Ok(gaps)
}

/// Every row gets its share of the force of its group. Contact rows with equal gaps share evenly, and the first of them stands for
/// the group; if some of them belong to nodes with friction, only these.
fn share(case: Case, gaps: &mut Gaps, scaled: &[f64]) {
    let (rows, rubs) = (&case.ready.rows, rubbing(case));
    let equal = |i: usize| {
        let (group, _) = rows.scaling.grouping.member[i]?;
        let (own, tightest) = (scaled[i], gaps.value[group]);
        let is_equal = own - tightest <= NOISE * own.abs().max(tightest.abs());
        (is_equal && rows.kind(group) == RowKind::Inequality).then_some((group, i))
    };
    let mut equal: Vec<(usize, usize)> = (0..rows.contact).filter_map(equal).collect();
    let mut rubbed = vec![false; gaps.value.len()];
    equal.iter().for_each(|&(group, i)| rubbed[group] |= rubs[i]);
    equal.retain(|&(group, i)| rubs[i] || !rubbed[group]);
    let mut count = vec![0.0f64; gaps.value.len()];
    for &(group, i) in equal.iter().rev() {
        (gaps.holder[group], count[group]) = (i, count[group] + 1.0);
    }
    gaps.share = vec![0.0; scaled.len()];
    gaps.holder.iter().for_each(|&holder| gaps.share[holder] = 1.0);
    equal.iter().for_each(|&(group, i)| gaps.share[i] = 1.0 / count[group]);
}

/// Tangential rows of nodes without friction: they never carry a force, as if their gaps were infinite.
fn idle(case: Case) -> Vec<bool> {
    let (rows, island) = (&case.ready.rows, case.island());
    let mut idle = vec![false; rows.scaling.scale.len()];
    for node in island.friction.nodes.iter().filter(|node| !node.has_friction()) {
        node.rows().for_each(|row| idle[rows.tangential + row] = true);
    }
    idle
}

/// Contact rows of nodes with friction.
fn rubbing(case: Case) -> Vec<bool> {
    let mut rubbing = vec![false; case.ready.rows.contact];
    let nodes = case.island().friction.nodes.iter().filter(|node| node.has_friction());
    nodes.filter_map(|node| node.normal).for_each(|row| rubbing[row] = true);
    rubbing
}
