//! Free bodies whose loads balance each other, but for a part that is drawn, and rounding.

use super::bodies::digits;
use super::none::open;
use super::{Ends, Hard, Kind, Plan};
use crate::dd;
use crate::dense::{inner, orthonormal};
use crate::random::Random;
use crate::varied::draft::Draft;
use crate::varied::rows::{contact, strut};
use crate::vector::axpy;
use crate::yardstick::{all_grounded, reaction};
use crate::{Csr, Deck};

/// A resultant of this part of a load is rounding; up to the second one it is told.
const ROUNDING: f64 = 1e-10;
const MARGINAL: f64 = 1e-7;
/// Within this factor of a limit both sides of it are right.
const NEAR: f64 = 2.0;

/// How bodies are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Join {
    None,
    Open,
    Touching,
    Struts,
    /// A body and its copy of another stiffness, equal unknowns tied.
    Glued,
}

pub(super) fn case(seed: u64, mut plan: Plan, mut draft: Draft) -> Hard {
    let mut join = [Join::None, Join::Open, Join::Touching, Join::Struts, Join::Glued][draft.random.below(5)];
    if join == Join::Struts && plan.is(Kind::Parts) {
        // they would hold the parts of a body to each other
        join = Join::Open;
    }
    let unequal = draft.random.chance(0.3);
    for p in (0..draft.group.len()).filter(|_| unequal) {
        let (range, factor) =
            (draft.deck.offset(p)..draft.deck.offset(p + 1), draft.random.decades(-4.0, 4.0));
        draft.u[range].iter_mut().for_each(|u| *u *= factor);
        draft.strength[p] *= factor;
    }
    let floating = |p: &usize| !draft.deck.bodies[*p].modes().is_empty();
    let all: Vec<usize> = (0..draft.group.len()).filter(floating).collect();
    let p = all[draft.random.below(all.len())];
    let mut cluster = vec![p];
    match join {
        Join::None => {}
        Join::Open | Join::Touching => {
            (0..1 + draft.random.below(6)).for_each(|_| contact(&mut draft, false, 1.0));
            if join == Join::Touching {
                draft.slack.fill(0.0);
            }
        }
        Join::Struts => (0..1 + draft.random.below(6)).for_each(|_| strut(&mut draft)),
        Join::Glued => cluster.push(copy(&mut draft, p)),
    }
    draft.travel();
    let naive = draft.random.chance(0.3);
    if naive {
        far(&mut draft);
        plan.note("products with u far away");
    }
    let motions = motions(&draft, &cluster);
    let mut motion = vec![0.0; draft.deck.dofs()];
    motions.iter().for_each(|mode| axpy(draft.random.normal(), mode, &mut motion));
    let share = share(&mut draft.random);
    if share > ROUNDING / NEAR {
        open(&mut draft, &motion);
    }
    let coarse = draft.random.chance(0.5);
    plan.note(&format!("{join:?}, resultant {share:.0e}{}", if coarse { ", 12 digits" } else { "" }));
    let diagonal = draft.diagonal.clone();
    let mut hard = plan.finish(seed, draft);
    if naive {
        multiply(&mut hard);
    }
    drive(&mut hard.deck, &cluster, &diagonal, &motion, share);
    if coarse {
        let loads = hard.deck.bodies.iter_mut().flat_map(|body| &mut body.load);
        loads.for_each(|f| *f = digits(*f, 12));
    }
    let everything: Vec<usize> = (0..hard.deck.bodies.len()).collect();
    let others = everything.iter().filter(|p| !cluster.contains(p));
    let others: Vec<(Vec<usize>, Vec<Vec<f64>>)> = others.map(|&p| (vec![p], own(&hard.deck, p))).collect();
    hard.ends = ends(&hard.deck, &diagonal, (&cluster, &motions), &others);
    let all_motions: Vec<Vec<f64>> =
        motions.iter().chain(others.iter().flat_map(|(_, motions)| motions)).cloned().collect();
    hard.resultant = resultant(&hard.deck, &all_motions) / loads(&hard.deck, &everything, &diagonal);
    if !hard.ends.solved && !hard.ends.marginal {
        hard.answer = None;
    }
    hard
}

/// Floating bodies 1000 deformations away.
fn far(draft: &mut Draft) {
    for p in 0..draft.group.len() {
        let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
        let own = draft.diagonal[range.clone()].to_vec();
        let size = inner(&draft.u[range.clone()], &own, &draft.u[range.clone()]).sqrt();
        for mode in orthonormal(draft.deck.bodies[p].modes(), &own) {
            axpy(1e3 * size * draft.random.normal(), &mode, &mut draft.u[range.clone()]);
        }
    }
}

/// f := K u + B'lambda + H'mu as a host would compute it, the rounding of a large u in it.
fn multiply(hard: &mut Hard) {
    let Some(answer) = &hard.answer else { return };
    let pull = reaction(&hard.deck, answer);
    for p in 0..hard.deck.bodies.len() {
        let range = hard.deck.offset(p)..hard.deck.offset(p + 1);
        let body = &mut hard.deck.bodies[p];
        body.load = body.stiffness.times(&answer.u[range.clone()]);
        axpy(1.0, &pull[range], &mut body.load);
    }
}

fn share(random: &mut Random) -> f64 {
    match random.below(5) {
        0 => random.decades(-9.6, -7.4),
        1 => random.decades(-6.6, -2.0),
        _ => random.decades(-16.0, -10.4),
    }
}

/// Body q is body p with another stiffness and deformation, tied to it at some or all unknowns.
fn copy(draft: &mut Draft, p: usize) -> usize {
    let (q, range) = (draft.group.len(), draft.deck.offset(p)..draft.deck.offset(p + 1));
    let (mut bodies, factor) = (draft.deck.bodies.clone(), draft.random.decades(-2.0, 2.0));
    let mut twin = bodies[p].clone();
    twin.stiffness.val.iter_mut().for_each(|k| *k *= factor);
    draft.diagonal.extend(twin.stiffness.diagonal());
    bodies.push(twin);
    draft.deck = Deck::new("hard", bodies);
    draft.group.push(draft.group[p]);
    draft.grounded.extend_from_within(range.clone());
    let first = draft.u.len();
    for j in range.clone() {
        draft.u.push(draft.u[j] + 0.3 * draft.u[j] * draft.random.normal());
    }
    draft.strength.push(draft.strength[p] * factor);
    let chance = if draft.random.chance(0.5) { 1.0 } else { 0.5 };
    for (i, j) in range.enumerate() {
        if !draft.grounded[j] && draft.random.chance(chance) {
            draft.deck.equalities.push(&[(j, 1.0), (first + i, -1.0)], 0.0);
            draft.mu.push(draft.strength[p] * draft.diagonal[j].sqrt() * draft.random.normal());
        }
    }
    q
}

/// R'DR = I over the bodies of the cluster, which move alike.
fn motions(draft: &Draft, cluster: &[usize]) -> Vec<Vec<f64>> {
    let mut modes = vec![vec![0.0; draft.deck.dofs()]; draft.deck.bodies[cluster[0]].modes().len()];
    for &p in cluster {
        let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
        for (long, mode) in modes.iter_mut().zip(draft.deck.bodies[p].modes()) {
            long[range.clone()].copy_from_slice(mode);
        }
    }
    orthonormal(&modes, &draft.diagonal)
}

/// f := f + share |f|_{D^-1} D v / |v|_D, f of the cluster.
fn drive(deck: &mut Deck, cluster: &[usize], diagonal: &[f64], motion: &[f64], share: f64) {
    let size = share * loads(deck, cluster, diagonal) / inner(motion, diagonal, motion).sqrt();
    for &p in cluster {
        let first = deck.offset(p);
        let own = deck.bodies[p].load.iter_mut().enumerate();
        own.for_each(|(i, f)| *f += size * diagonal[first + i] * motion[first + i]);
    }
}

/// |f|_{D^-1} of some bodies.
fn loads(deck: &Deck, cluster: &[usize], diagonal: &[f64]) -> f64 {
    let load = deck.load();
    let unknowns = cluster.iter().flat_map(|&p| deck.offset(p)..deck.offset(p + 1));
    unknowns.map(|j| load[j] * load[j] / diagonal[j]).sum::<f64>().sqrt()
}

/// |R'f|
fn resultant(deck: &Deck, motions: &[Vec<f64>]) -> f64 {
    let load = deck.load();
    let felt = |mode: &Vec<f64>| dd::dot(load.iter().copied().zip(mode.iter().copied())).value();
    motions.iter().map(felt).map(|v| v * v).sum::<f64>().sqrt()
}

/// The rigid motions of one body over all unknowns, R'DR = I.
fn own(deck: &Deck, p: usize) -> Vec<Vec<f64>> {
    let body = &deck.bodies[p];
    let long = |mode: Vec<f64>| {
        let mut long = vec![0.0; deck.dofs()];
        long[deck.offset(p)..deck.offset(p + 1)].copy_from_slice(&mode);
        long
    };
    orthonormal(body.modes(), &body.stiffness.diagonal()).into_iter().map(long).collect()
}

/// The shares of the resultants on the connected parts of a body in the loads of each: a part of a body that nothing joins to the
/// others is a body of its own.
fn share_of_parts(
    deck: &Deck,
    diagonal: &[f64],
    p: usize,
    motions: &[Vec<f64>],
    grounded: &[bool],
) -> Vec<f64> {
    let (first, load) = (deck.offset(p), deck.load());
    let share = |part: Vec<usize>| {
        let felt = |mode: &Vec<f64>| dd::dot(part.iter().map(|i| (load[first + i], mode[first + i]))).value();
        let resultant = motions.iter().map(felt).map(|v| v * v).sum::<f64>().sqrt();
        let moving = part.iter().map(|i| first + i).filter(|&j| !grounded[j]);
        resultant / moving.map(|j| load[j] * load[j] / diagonal[j]).sum::<f64>().sqrt()
    };
    connected(&deck.bodies[p].stiffness).into_iter().map(share).collect()
}

/// Unknowns of the connected parts of a matrix.
fn connected(k: &Csr) -> Vec<Vec<usize>> {
    let mut part: Vec<usize> = (0..k.rows).collect();
    // a part has the number of its first unknown as soon as nothing changes
    while (0..k.rows).any(|i| {
        let least = k.row(i).filter(|(_, v)| *v != 0.0).map(|(j, _)| part[j]).fold(part[i], usize::min);
        std::mem::replace(&mut part[i], least) != least
    }) {}
    let firsts = (0..k.rows).filter(|&i| part[i] == i);
    firsts.map(|first| (0..k.rows).filter(|&i| part[i] == first).collect()).collect()
}

/// By the share of the resultant in the load of its cluster and of each part of it, but for what acts on grounded unknowns, and in
/// all loads: where these differ both ends are right. Products may leave the other bodies a resultant as well.
fn ends(
    deck: &Deck,
    diagonal: &[f64],
    (cluster, motions): (&[usize], &[Vec<f64>]),
    others: &[(Vec<usize>, Vec<Vec<f64>>)],
) -> Ends {
    let grounded = all_grounded(deck);
    let load = deck.load();
    let share = |bodies: &[usize], motions: &[Vec<f64>]| {
        let unknowns = bodies.iter().flat_map(|&p| deck.offset(p)..deck.offset(p + 1));
        let moving = unknowns.filter(|&j| !grounded[j]).map(|j| load[j] * load[j] / diagonal[j]);
        resultant(deck, motions) / moving.sum::<f64>().sqrt()
    };
    let worst = |bodies: &[usize], motions: &[Vec<f64>]| {
        let parts = bodies.iter().flat_map(|&p| share_of_parts(deck, diagonal, p, motions, &grounded));
        NEAR * parts.fold(share(bodies, motions), f64::max)
    };
    let most = worst(cluster, motions);
    let everything: Vec<usize> = (0..deck.bodies.len()).collect();
    let least = resultant(deck, motions) / loads(deck, &everything, diagonal) / NEAR;
    let elsewhere = others.iter().map(|(body, motions)| worst(body, motions)).fold(0.0, f64::max);
    Ends {
        solved: least <= ROUNDING || most.is_nan(),
        marginal: most.max(elsewhere) > ROUNDING && least <= MARGINAL,
        load_not_held: most > MARGINAL,
        gaps_contradict: false,
    }
}
