//! Rows of hard problems with their forces: ties that follow from others, rows nearly parallel, leverage, rows without force,
//! gaps of unequal size.

use super::{Kind, Plan};
use crate::dense::solve;
use crate::dense::{inner, orthonormal, remove};
use crate::random::Random;
use crate::varied::draft::Draft;
use crate::varied::rows::{between, contact, push_contact, sizes, touch, Entries};
use crate::vector::axpy;

/// Random sign.
pub(super) fn sign(random: &mut Random) -> f64 {
    if random.chance(0.5) {
        1.0
    } else {
        -1.0
    }
}

/// An unknown that rows may touch.
pub(super) fn free_unknown(draft: &mut Draft) -> Option<usize> {
    let free: Vec<usize> = (0..draft.grounded.len()).filter(|&i| !draft.grounded[i]).collect();
    (!free.is_empty()).then(|| free[draft.random.below(free.len())])
}

/// H u = h under a force of what the bodies carry, half of the time under none.
pub(super) fn push_tie(draft: &mut Draft, entries: &Entries) {
    draft.deck.equalities.push(entries, 0.0);
    let share = sign(&mut draft.random) * draft.random.decades(-1.0, 0.0);
    let force = if draft.random.chance(0.5) { 0.0 } else { sizes(draft, entries, 0.0).0 * share };
    draft.mu.push(force);
}

/// u_0 = a, u_0 - u_1 = b, ..., the sum of them once more, u_k - x u_(k+1) = c; then sums of three to six ties.
pub(super) fn ties(plan: &mut Plan, draft: &mut Draft) {
    for _ in 0..1 + draft.random.below(2) {
        let mut chain: Vec<usize> =
            (0..3 + draft.random.below(4)).filter_map(|_| free_unknown(draft)).collect();
        chain.sort_unstable();
        chain.dedup();
        let (first, Some(last)) = (draft.mu.len(), chain.pop()) else { continue };
        let Some(&end) = chain.last() else { continue };
        let ground = draft.random.chance(0.6);
        if ground {
            push_tie(draft, &vec![(chain[0], 1.0)]);
        }
        chain.windows(2).for_each(|pair| push_tie(draft, &vec![(pair[0], 1.0), (pair[1], -1.0)]));
        let members: Vec<(usize, f64)> =
            (first..draft.mu.len()).map(|i| (i, if ground && i > first { -1.0 } else { 1.0 })).collect();
        if members.len() > 1 {
            follow(plan, draft, members);
        }
        let contrast = draft.random.decades(0.0, 6.0) * sign(&mut draft.random);
        plan.note(&format!("chain of {}, contrast {contrast:.0e}", chain.len()));
        push_tie(draft, &vec![(end, 1.0), (last, contrast)]);
    }
    for _ in 0..draft.random.below(3) {
        let count = (3 + draft.random.below(4)).min(draft.mu.len());
        let mut rows: Vec<usize> = (0..count).map(|_| draft.random.below(draft.mu.len())).collect();
        rows.sort_unstable();
        rows.dedup();
        let mut members: Vec<(usize, f64)> =
            rows.iter().map(|&i| (i, sign(&mut draft.random) * draft.random.between(0.3, 2.0))).collect();
        if draft.random.chance(0.3) && !members.is_empty() {
            members[0].1 *= draft.random.decades(0.0, 6.0);
        }
        follow(plan, draft, members);
    }
}

/// The sum of ties with these factors, each entry rounded; half of the time its h is the same sum of theirs.
fn follow(plan: &mut Plan, draft: &mut Draft, members: Vec<(usize, f64)>) {
    let matrix = &draft.deck.equalities.matrix;
    let rigid = members.iter().all(|&(i, _)| draft.deck.equalities.compliance[i] == 0.0);
    let sum: Entries =
        members.iter().flat_map(|&(i, factor)| matrix.row(i).map(move |(j, v)| (j, factor * v))).collect();
    let largest = sum.iter().fold(0.0f64, |most, entry| most.max(entry.1.abs()));
    let mut row = crate::Csr::empty(draft.deck.dofs());
    row.push_row(&sum);
    let entries: Entries = row.row(0).filter(|entry| entry.1.abs() > 1e-12 * largest).collect();
    if entries.is_empty() || !rigid {
        return;
    }
    if draft.random.chance(0.5) && entries.len() == row.val.len() {
        plan.sums.push((draft.mu.len(), members));
    }
    push_tie(draft, &entries);
}

/// Rows that differ from others by 1e-12 to 1e-6, on their own unknowns or by one more; closed, touching, all but open, or ties.
pub(super) fn near(plan: &mut Plan, draft: &mut Draft) {
    for _ in 0..1 + draft.random.below(4) {
        let entries = match draft.random.below(3) {
            0 if !draft.lambda.is_empty() => {
                let i = draft.random.below(draft.lambda.len());
                draft.deck.contact.matrix.row(i).collect()
            }
            1 if !draft.mu.is_empty() => {
                let i = draft.random.below(draft.mu.len());
                draft.deck.equalities.matrix.row(i).collect()
            }
            _ => between(draft),
        };
        if entries.is_empty() {
            continue;
        }
        let angle = if draft.random.chance(0.3) { 1e-9 } else { draft.random.decades(-12.0, -6.0) };
        let factor = sign(&mut draft.random)
            * if draft.random.chance(0.5) { 1.0 } else { draft.random.between(0.3, 3.0) };
        let mut close: Entries = entries.iter().map(|&(j, v)| (j, factor * v)).collect();
        let unit = close.iter().fold(0.0f64, |most, entry| most.max(entry.1.abs()));
        if draft.random.chance(0.5) {
            close.iter_mut().for_each(|entry| entry.1 *= 1.0 + angle * draft.random.normal());
        } else if let Some(other) = free_unknown(draft) {
            close.push((other, unit * angle * draft.random.normal()));
        }
        plan.note(&format!("near {angle:.0e}"));
        push_near(draft, &close, angle);
    }
}

fn push_near(draft: &mut Draft, entries: &Entries, angle: f64) {
    let how = draft.random.below(5);
    if how == 0 {
        push_tie(draft, entries);
        return;
    }
    push_contact(draft, entries, how <= 2, 1.0);
    let last = draft.lambda.len() - 1;
    if how == 3 {
        draft.slack[last] = 0.0;
    } else if how == 4 {
        draft.slack[last] *= angle;
    }
}

/// Rows t + e n and -t' + e n under large forces, t' = t or another unknown of the body that moves with it: together they give
/// 2 e times their forces.
pub(super) fn leverage(plan: &mut Plan, draft: &mut Draft) {
    for _ in 0..1 + draft.random.below(2) {
        let p = draft.random.below(draft.group.len());
        let (mut along, mut normal) = (Vec::new(), Vec::new());
        touch(draft, p, 1.0, &mut along);
        touch(draft, p, 1.0, &mut normal);
        if along.is_empty() {
            continue;
        }
        let e = draft.random.decades(-6.0, -3.0);
        let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
        let away = draft.random.chance(0.4) && range.len() > 2;
        let mut back = along.clone();
        if away {
            let alike = |j: usize| {
                let directions = &draft.deck.bodies[p].direction;
                directions[j - range.start] == directions[along[0].0 - range.start] && !draft.grounded[j]
            };
            let places: Vec<usize> = range.clone().filter(|&j| alike(j)).collect();
            along.truncate(1);
            back = vec![(places[draft.random.below(places.len())], along[0].1)];
        }
        let force = draft.strength[p] / inner_of(draft, &along).sqrt() / e;
        for (sign, part) in [(1.0, &along), (-1.0, &back)] {
            let entries: Entries = part
                .iter()
                .map(|&(j, v)| (j, sign * v))
                .chain(normal.iter().map(|&(j, v)| (j, e * v)))
                .collect();
            draft.deck.contact.push(&entries, 0.0);
            draft.lambda.push(force);
            draft.slack.push(0.0);
        }
        if away {
            relax(draft, p, force, &along, &back);
        }
        plan.note(&format!("leverage {:.0e}{}", 1.0 / e, if away { " within the body" } else { "" }));
    }
}

fn inner_of(draft: &Draft, entries: &Entries) -> f64 {
    entries.iter().map(|&(j, v)| v * v / draft.diagonal[j]).sum()
}

/// u := u - (K + D R R' D)^-1 force (along - back), without rigid motions: the body takes it without a load.
fn relax(draft: &mut Draft, p: usize, force: f64, along: &Entries, back: &Entries) {
    let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
    let (n, own) = (range.len(), draft.diagonal[range.clone()].to_vec());
    let body = &draft.deck.bodies[p];
    let basis = orthonormal(body.modes(), &own);
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        body.stiffness.row(i).for_each(|(j, k)| matrix[i * n + j] = k);
        for mode in &basis {
            (0..n).for_each(|j| matrix[i * n + j] += own[i] * mode[i] * mode[j] * own[j]);
        }
    }
    let mut pull = vec![0.0; n];
    along.iter().for_each(|&(j, v)| pull[j - range.start] -= force * v);
    back.iter().for_each(|&(j, v)| pull[j - range.start] += force * v);
    if let Some(mut moved) = solve(matrix, pull) {
        remove(&basis, &own, &mut moved);
        axpy(1.0, &moved, &mut draft.u[range]);
    }
}

/// Bodies that will have no forces: a third of all, one at least, with rows of their own; half of them without load.
pub(super) fn idle(plan: &mut Plan, draft: &mut Draft) -> Vec<usize> {
    let floating = |p: usize| !draft.deck.bodies[p].modes().is_empty();
    let all: Vec<usize> = (0..draft.group.len()).filter(|&p| floating(p)).collect();
    let mut idle: Vec<usize> = all.iter().copied().filter(|_| draft.random.chance(0.4)).collect();
    if idle.is_empty() {
        idle.extend(all.first());
    }
    for &p in &idle {
        if draft.random.chance(0.5) {
            draft.u[draft.deck.offset(p)..draft.deck.offset(p + 1)].fill(0.0);
        }
    }
    plan.note(&format!("idle {idle:?}"));
    (0..draft.random.below(2 * idle.len() + 1)).for_each(|_| contact(draft, false, 1.0));
    idle
}

/// No force on any row that touches these bodies, half of them just touching; ties of them stay without force.
pub(super) fn unload(draft: &mut Draft, idle: &[usize]) {
    let ranges: Vec<_> = idle.iter().map(|&p| draft.deck.offset(p)..draft.deck.offset(p + 1)).collect();
    let touches = |j: usize| ranges.iter().any(|range| range.contains(&j));
    for i in 0..draft.lambda.len() {
        if draft.deck.contact.matrix.row(i).any(|(j, _)| touches(j)) {
            draft.lambda[i] = 0.0;
            if draft.slack[i] == 0.0 && draft.random.chance(0.5) {
                let entries: Entries = draft.deck.contact.matrix.row(i).collect();
                draft.slack[i] = sizes(draft, &entries, 0.0).1 * draft.random.decades(-3.0, 1.0);
            }
        }
    }
    for i in 0..draft.mu.len() {
        if draft.deck.equalities.matrix.row(i).any(|(j, _)| touches(j)) {
            draft.mu[i] = 0.0;
        }
    }
}

/// Open rows 1e-6 to 1e6 times as far, floating bodies moved by 1e-6 to 1e6 of their deformation.
pub(super) fn gaps(plan: &mut Plan, draft: &mut Draft) {
    for i in 0..draft.slack.len() {
        draft.slack[i] *= draft.random.decades(-6.0, 6.0);
    }
    for p in 0..draft.group.len() {
        let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
        let own = draft.diagonal[range.clone()].to_vec();
        let size = inner(&draft.u[range.clone()], &own, &draft.u[range.clone()]).sqrt();
        let share = draft.random.decades(-6.0, 6.0);
        for mode in orthonormal(draft.deck.bodies[p].modes(), &own) {
            axpy(share * size * draft.random.normal(), &mode, &mut draft.u[range.clone()]);
        }
        plan.note(&format!("travel {share:.0e}"));
    }
    debug_assert!(plan.is(Kind::Gaps));
}
