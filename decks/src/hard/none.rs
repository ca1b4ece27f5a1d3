//! Problems without an answer, made from the proof that there is none.

use super::rows::sign;
use super::{proof, Ends, Hard, Plan};
use crate::dense::orthonormal;
use crate::random::Random;
use crate::varied::draft::Draft;
use crate::vector::axpy;
use crate::{Deck, Rows};

/// A proof holds by this much more than it has to.
const CLEARLY: f64 = 10.0;

/// A floating body moves by v: rows that would stop it are turned about or lose the body's force, ties that hold it are gone, and
/// the load drives it, by 1e-5 of all loads or more.
pub(super) fn not_held(seed: u64, mut plan: Plan, mut draft: Draft) -> Hard {
    plan.rows(&mut draft);
    plan.sums.clear();
    let floating: Vec<usize> =
        (0..draft.group.len()).filter(|&p| !draft.deck.bodies[p].modes().is_empty()).collect();
    let p = floating[draft.random.below(floating.len())];
    let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
    let own = draft.diagonal[range.clone()].to_vec();
    let mut motion = vec![0.0; draft.deck.dofs()];
    for mode in orthonormal(draft.deck.bodies[p].modes(), &own) {
        axpy(draft.random.normal(), &mode, &mut motion[range.clone()]);
    }
    open(&mut draft, &motion);
    release(&mut draft, &motion);
    let share = draft.random.decades(-5.0, 0.0);
    plan.note(&format!("driven by {share:.0e}"));
    let diagonal = draft.diagonal.clone();
    let mut hard = plan.finish(seed, draft);
    let length = crate::dense::inner(&motion, &diagonal, &motion).sqrt();
    let drive = |size: f64, deck: &mut Deck| {
        let own = range.clone().map(|j| size * diagonal[j] * motion[j] / length);
        deck.bodies[p].load.iter_mut().zip(own).for_each(|(f, pull)| *f += pull);
    };
    let size = force(&hard.deck, &diagonal);
    drive(share * if size > 0.0 { size } else { 1.0 }, &mut hard.deck);
    let found = proof::motion(&hard.deck, &motion);
    hard.answer = None;
    hard.ends =
        if found.holds(hard.digits) && found.work > CLEARLY * 1e6 * found.resisted && found.share > 1e-6 {
            Ends { load_not_held: true, ..Ends::default() }
        } else {
            Ends::ANY
        };
    hard
}

/// |f|_{D^-1}
fn force(deck: &Deck, diagonal: &[f64]) -> f64 {
    deck.load().iter().zip(diagonal).map(|(f, d)| f * f / d).sum::<f64>().sqrt()
}

/// b v <= 0 of every contact row: those that v closes are turned about, those that it moves have no force.
pub(super) fn open(draft: &mut Draft, motion: &[f64]) {
    let moved = draft.deck.contact.matrix.times(motion);
    for (i, along) in moved.iter().enumerate() {
        let matrix = &mut draft.deck.contact.matrix;
        let values = &mut matrix.val[matrix.ptr[i]..matrix.ptr[i + 1]];
        let size = values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let most = motion.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        if along.abs() > 1e-13 * size * most {
            draft.lambda[i] = 0.0;
            if *along > 0.0 {
                values.iter_mut().for_each(|v| *v = -*v);
            }
        }
    }
}

/// Takes away the ties that v moves.
fn release(draft: &mut Draft, motion: &[f64]) {
    let none = Rows::none(draft.deck.dofs());
    let old = std::mem::replace(&mut draft.deck.equalities, none);
    let moved = old.matrix.times(motion);
    let forces = std::mem::take(&mut draft.mu);
    for i in (0..old.len()).filter(|&i| moved[i] == 0.0) {
        let entries: Vec<_> = old.matrix.row(i).collect();
        draft.deck.equalities.push_compliant(&entries, 0.0, old.compliance[i]);
        draft.mu.push(forces[i]);
    }
}

/// One more row: the opposite of a sum of one to five others, with less room than they leave, by 10 to 1e6 times what rounding
/// and a motion of 1e6 sizes of the problem could undo.
pub(super) fn contradict(seed: u64, mut plan: Plan, mut draft: Draft) -> Hard {
    plan.rows(&mut draft);
    let mut random = draft.random.clone();
    let mut hard = plan.finish(seed, draft);
    (hard.answer, hard.ends) = (None, Ends::ANY);
    let chosen = weights(&hard.deck, &mut random);
    if !chosen.is_empty() {
        let factor = random.decades(1.0, 6.0);
        let excess = oppose(&mut hard.deck, chosen, factor);
        if let Some(excess) = excess {
            hard.ends = Ends { gaps_contradict: true, ..Ends::default() };
            hard.detail.push_str(&format!("rows contradict by {excess:.0e}; "));
        }
    }
    hard
}

/// The row of a place among all, contact rows before ties.
fn row(deck: &Deck, place: usize) -> (&Rows, usize) {
    let contact = deck.contact.len();
    if place < contact {
        (&deck.contact, place)
    } else {
        (&deck.equalities, place - contact)
    }
}

/// One to five rigid rows with finite gaps, each with a weight.
fn weights(deck: &Deck, random: &mut Random) -> Vec<(usize, f64)> {
    let contact = deck.contact.len();
    let usable = |place: &usize| {
        let (rows, i) = row(deck, *place);
        rows.compliance[i] == 0.0 && rows.rhs[i].is_finite()
    };
    let places: Vec<usize> = (0..contact + deck.equalities.len()).filter(usable).collect();
    if places.is_empty() {
        return vec![];
    }
    let mut chosen: Vec<usize> =
        (0..1 + random.below(5)).map(|_| places[random.below(places.len())]).collect();
    chosen.sort_unstable();
    chosen.dedup();
    let mut weigh = |place: usize| {
        let sense = if place < contact { 1.0 } else { sign(random) };
        (place, sense * random.between(0.3, 2.0))
    };
    chosen.into_iter().map(&mut weigh).collect()
}

/// Adds the row that these weights and 1 of its own leave nothing of. What it asks for too much, if that proves it.
fn oppose(deck: &mut Deck, mut weights: Vec<(usize, f64)>, factor: f64) -> Option<f64> {
    let (contact, mut sum, mut reach) = (deck.contact.len(), vec![], 0.0);
    for &(place, w) in &weights {
        let (rows, i) = row(deck, place);
        sum.extend(rows.matrix.row(i).map(|(j, v)| (j, -w * v)));
        reach += w * rows.rhs[i];
    }
    deck.contact.push(&sum, -reach);
    // ties have moved on by one
    weights.iter_mut().filter(|(place, _)| *place >= contact).for_each(|(place, _)| *place += 1);
    weights.push((contact, 1.0));
    let mut excess = factor * proof::weights(deck, &weights).doubt;
    for _ in 0..20 {
        deck.contact.rhs[contact] = -reach - excess;
        let found = proof::weights(deck, &weights);
        if found.hold() && -found.demanded > CLEARLY * found.doubt {
            return Some(excess);
        }
        excess *= 10.0;
    }
    None
}
