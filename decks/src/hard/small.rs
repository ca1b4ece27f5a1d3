//! Few unknowns and rows of small integers, degenerate.

use super::bodies::digits;
use super::rows::{free_unknown, push_tie, sign};
use super::{Ends, Given, Hard, Kind, Plan};
use crate::random::Random;
use crate::second;
use crate::varied::draft::Draft;
use crate::varied::rows::{push_contact, Entries};
use crate::varied::{condition, undetermined};

const CONTACT: usize = 5;
const TIES: usize = 4;

pub(super) fn case(seed: u64, main: Kind, mut random: Random) -> Hard {
    let (unknowns, given) = (10 + random.below(16), [Given::NullSpaces, Given::Coordinates][random.below(2)]);
    let mut plan = Plan {
        kinds: vec![main],
        classes: vec![],
        given,
        far: random.chance(0.1),
        digits: 16,
        detail: String::new(),
        sums: vec![],
    };
    if random.chance(0.1) {
        plan.kinds.push(Kind::Parts);
    }
    let mut draft = plan.bodies(unknowns, random);
    if draft.random.chance(0.3) {
        draft.u.fill(0.0);
    }
    for _ in 0..3 + draft.random.below(CONTACT) {
        let entries = row(&mut draft, |draft| &draft.deck.contact);
        contact(&mut draft, &entries);
    }
    for _ in 0..draft.random.below(2 * TIES) {
        let entries = row(&mut draft, |draft| &draft.deck.equalities);
        if !entries.is_empty() {
            push_tie(&mut draft, &entries);
        }
    }
    if draft.random.chance(0.5) {
        draft.travel();
    }
    if main == Kind::Drawn {
        return drawn(seed, plan, draft);
    }
    plan.finish(seed, draft)
}

/// One to four unknowns with factors 1, -1, 2, -2; one time in three the sum or difference of two rows that there are.
fn row(draft: &mut Draft, rows: fn(&Draft) -> &crate::Rows) -> Entries {
    let count = rows(draft).len();
    if count > 1 && draft.random.chance(0.33) {
        let (a, b) = (draft.random.below(count), draft.random.below(count));
        let factor = [1.0, -1.0, 2.0, -2.0][draft.random.below(4)];
        let matrix = &rows(draft).matrix;
        let mut sum = crate::Csr::empty(matrix.cols);
        let entries: Entries = matrix.row(a).chain(matrix.row(b).map(|(j, v)| (j, factor * v))).collect();
        sum.push_row(&entries);
        return sum.row(0).collect();
    }
    let mut entries = Entries::new();
    for _ in 0..1 + draft.random.below(4) {
        let Some(dof) = free_unknown(draft) else { break };
        if entries.iter().all(|entry| entry.0 != dof) {
            let factor = if draft.random.chance(0.2) { 2.0 } else { 1.0 };
            entries.push((dof, factor * sign(&mut draft.random)));
        }
    }
    entries
}

/// Closed under a force, touching or open.
fn contact(draft: &mut Draft, entries: &Entries) {
    if entries.is_empty() {
        return;
    }
    let how = draft.random.below(3);
    push_contact(draft, entries, how == 0, 1.0);
    if how == 1 {
        *draft.slack.last_mut().expect("a row") = 0.0;
    }
}

/// Gaps and loads are small integers of the size of the case.
fn drawn(seed: u64, plan: Plan, draft: Draft) -> Hard {
    let (length, diagonal, mut random) = (draft.length[0], draft.diagonal.clone(), draft.random.clone());
    let mut hard = plan.finish(seed, draft);
    let (length, force) = (digits(length, 1), digits(length * diagonal[0], 1));
    for body in &mut hard.deck.bodies {
        for f in &mut body.load {
            *f = if random.chance(0.6) { 0.0 } else { force * (random.below(5) as f64 - 2.0) };
        }
        let balanced = random.chance(0.4) && body.modes().len() == 1;
        if balanced {
            let sum: f64 = body.load.iter().sum();
            body.load[0] -= sum;
        }
    }
    for c in &mut hard.deck.contact.rhs {
        *c = length * (random.below(5) as f64 - 1.0);
    }
    let ties = hard.deck.equalities.len();
    let keeps = random.chance(0.5);
    for i in (0..ties).filter(|_| !keeps) {
        hard.deck.equalities.rhs[i] =
            if random.chance(0.5) { 0.0 } else { length * (random.below(3) as f64 - 1.0) };
    }
    hard.ends = Ends::ANY;
    hard.answer = second::solve(&hard.deck);
    if let Some(answer) = &hard.answer {
        hard.condition = condition(&hard.deck, &answer.lambda);
        hard.undetermined = undetermined(&hard.deck, &answer.lambda);
    }
    hard
}
