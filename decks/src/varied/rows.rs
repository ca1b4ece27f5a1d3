//! Rows of varied problems with their forces: contact, glue, supports, struts within a body, rows out of reach.

use crate::varied::draft::Draft;
use crate::varied::Class;
use crate::vector::norm_max;
use crate::yardstick::body_of;

/// Rows added at most until no motion is left.
const HOLDING: usize = 60;
/// A motion is held where |S B R a| exceeds this part of |a|.
const HELD: f64 = 0.02;

pub(crate) type Entries = Vec<(usize, f64)>;

pub(crate) fn draw(draft: &mut Draft) {
    let bodies = draft.group.len();
    let thermal = draft.is(Class::Thermal);
    let strength = if draft.is(Class::Newton) { draft.random.decades(6.0, 12.0) } else { 1.0 };
    for _ in 0..2 + draft.random.below(2 * bodies + 3) {
        let closed = draft.random.chance(0.6);
        contact(draft, closed && !thermal, strength);
        if thermal {
            strut(draft);
        }
    }
    if draft.is(Class::Glue) {
        (0..1 + draft.random.below(5)).for_each(|_| equality(draft, strength));
    }
    if thermal || draft.random.chance(0.9) {
        hold(draft, strength);
    }
    if draft.is(Class::Glue) {
        (0..1 + draft.random.below(3)).for_each(|_| redundant(draft));
    }
    if draft.is(Class::Far) {
        (0..1 + draft.random.below(4)).for_each(|_| far(draft));
    }
}

/// Closed rows or equality rows (without a force in thermal cases) until they resist every motion.
pub(crate) fn hold(draft: &mut Draft, strength: f64) {
    for _ in 0..HOLDING {
        if draft.face().free_motions(HELD) == 0 {
            return;
        }
        if draft.is(Class::Thermal) {
            equality(draft, 0.0);
        } else if draft.is(Class::Glue) && draft.random.chance(0.4) {
            equality(draft, strength);
        } else {
            contact(draft, true, strength);
        }
    }
}

/// One to three unknowns of a body with random coefficients times `sign`; nothing where all are grounded.
pub(crate) fn touch(draft: &mut Draft, p: usize, sign: f64, entries: &mut Entries) {
    let first = draft.deck.offset(p);
    let free: Vec<usize> = (first..draft.deck.offset(p + 1)).filter(|&i| !draft.grounded[i]).collect();
    if free.is_empty() {
        return;
    }
    for _ in 0..1 + draft.random.below(3) {
        let dof = free[draft.random.below(free.len())];
        if entries.iter().all(|entry| entry.0 != dof) {
            let side = if draft.random.chance(0.3) { -sign } else { sign };
            entries.push((dof, side * draft.random.between(0.3, 1.0)));
        }
    }
}

/// A row between a body and another one of its group, a third of the time a wall; all rows of a case in units of their own
/// one time in four.
pub(crate) fn between(draft: &mut Draft) -> Entries {
    let p = draft.random.below(draft.group.len());
    let partners: Vec<usize> =
        (0..draft.group.len()).filter(|&q| q != p && draft.group[q] == draft.group[p]).collect();
    let mut entries = Vec::new();
    let sign = if draft.random.chance(0.5) { 1.0 } else { -1.0 };
    touch(draft, p, sign, &mut entries);
    if !partners.is_empty() && draft.random.chance(0.67) {
        let q = partners[draft.random.below(partners.len())];
        touch(draft, q, -sign, &mut entries);
    }
    let unit = if draft.random.chance(0.25) { draft.random.decades(-3.0, 3.0) } else { 1.0 };
    entries.iter().map(|&(j, v)| (j, unit * v)).collect()
}

/// Row a/|a|: two unknowns of one body along the line between them; no rigid motion is felt.
pub(crate) fn strut(draft: &mut Draft) {
    let p = draft.random.below(draft.group.len());
    let (first, body) = (draft.deck.offset(p), &draft.deck.bodies[p]);
    let (a, b) = (draft.random.below(body.dofs()), draft.random.below(body.dofs()));
    let (from, to) = (body.coordinates[a], body.coordinates[b]);
    let edge: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
    let length = edge.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut entries = Vec::new();
    for (i, (at, axis)) in body.coordinates.iter().zip(&body.direction).enumerate() {
        let value = edge[*axis as usize - 1] / length;
        if value != 0.0 && (*at == from || *at == to) {
            entries.push((first + i, if *at == to { value } else { -value }));
        }
    }
    let touches_grounded = entries.iter().any(|entry| draft.grounded[entry.0]);
    if length > 0.0 && entries.len() > 1 && !touches_grounded {
        let closed = draft.random.chance(0.6);
        push_contact(draft, &entries, closed, 1.0);
    }
}

pub(crate) fn contact(draft: &mut Draft, closed: bool, strength: f64) {
    let entries = between(draft);
    if !entries.is_empty() {
        push_contact(draft, &entries, closed, strength);
    }
}

/// A row between idle bodies and others is open: it would hold the others by next to nothing.
pub(crate) fn push_contact(draft: &mut Draft, entries: &Entries, closed: bool, strength: f64) {
    let mut idle = entries.iter().map(|entry| draft.idle.get(body_of(&draft.deck, entry.0)));
    let first = idle.next();
    let closed = closed && idle.all(|idle| Some(idle) == first);
    let compliance = compliance(draft, entries);
    draft.deck.contact.push_compliant(entries, 0.0, compliance);
    let (force, length) = sizes(draft, entries, compliance);
    let (share, slack) = (draft.random.decades(-2.0, 0.0), draft.random.decades(-3.0, 1.0));
    draft.lambda.push(if closed { force * share * strength } else { 0.0 });
    draft.slack.push(if closed { 0.0 } else { length * slack });
}

fn equality(draft: &mut Draft, strength: f64) {
    let entries = between(draft);
    if entries.is_empty() {
        return;
    }
    let compliance = compliance(draft, &entries);
    draft.deck.equalities.push_compliant(&entries, 0.0, compliance);
    let share = draft.random.decades(-1.0, 0.0) * if draft.random.chance(0.5) { 1.0 } else { -1.0 };
    let force = sizes(draft, &entries, compliance).0 * share * strength;
    draft.mu.push(force);
}

/// The sum of two equality rows of one group, or a multiple of a closed contact row, with a force of its own.
fn redundant(draft: &mut Draft) {
    let count = draft.deck.equalities.len();
    if count > 0 && draft.random.chance(0.7) {
        let (a, b) = (draft.random.below(count), draft.random.below(count));
        let factor = [1.0, -1.0, 2.0][draft.random.below(3)];
        if group_of(draft, a) == group_of(draft, b) && (a != b || factor != -1.0) {
            let matrix = &draft.deck.equalities.matrix;
            let entries: Entries = matrix.row(a).chain(matrix.row(b).map(|(j, v)| (j, factor * v))).collect();
            draft.deck.equalities.push(&entries, 0.0);
            draft.mu.push(0.5 * draft.mu[a]);
        }
        return;
    }
    let closed: Vec<usize> = (0..draft.slack.len()).filter(|&i| draft.slack[i] == 0.0).collect();
    if !closed.is_empty() {
        let i = closed[draft.random.below(closed.len())];
        let factor = draft.random.decades(-2.0, 2.0);
        let entries: Entries = draft.deck.contact.matrix.row(i).map(|(j, v)| (j, factor * v)).collect();
        draft.deck.contact.push(&entries, 0.0);
        draft.lambda.push(draft.lambda[i] / factor);
        draft.slack.push(0.0);
    }
}

/// Group of the bodies that an equality row touches.
fn group_of(draft: &Draft, row: usize) -> Option<usize> {
    let (first, _) = draft.deck.equalities.matrix.row(row).next()?;
    let body = (0..draft.group.len()).find(|&p| first < draft.deck.offset(p + 1))?;
    Some(draft.group[body])
}

/// A row whose bodies never meet: slack 1e6 to 1e30 displacements, one in five infinite.
fn far(draft: &mut Draft) {
    let entries = between(draft);
    if entries.is_empty() {
        return;
    }
    push_contact(draft, &entries, false, 1.0);
    let unit = entries.iter().fold(0.0f64, |unit, entry| unit.max(entry.1.abs()));
    let moved = unit * norm_max(&draft.u);
    let infinite = draft.random.chance(0.2);
    let factor = if infinite { f64::INFINITY } else { draft.random.decades(6.0, 30.0) };
    let last = draft.slack.len() - 1;
    draft.slack[last] = (draft.slack[last] + moved) * factor;
}

/// Half of the rows of a case with springs: 1e-4 to 1e4 times as compliant as the bodies are there.
fn compliance(draft: &mut Draft, entries: &Entries) -> f64 {
    if !draft.is(Class::Springs) || draft.random.chance(0.5) {
        return 0.0;
    }
    local(draft, entries) * draft.random.decades(-4.0, 4.0)
}

/// b D^-1 b'
fn local(draft: &Draft, entries: &Entries) -> f64 {
    entries.iter().map(|&(j, v)| v * v / draft.diagonal[j]).sum()
}

/// The force that the weakest body it touches carries on one row, and the length of its group in the unit of the row.
pub(crate) fn sizes(draft: &Draft, entries: &Entries, compliance: f64) -> (f64, f64) {
    let touches = |p: usize| {
        let range = draft.deck.offset(p)..draft.deck.offset(p + 1);
        entries.iter().any(|entry| range.contains(&entry.0))
    };
    let touched: Vec<usize> = (0..draft.group.len()).filter(|&p| touches(p)).collect();
    let weakest = touched.iter().map(|&p| draft.strength[p]).fold(f64::INFINITY, f64::min);
    let unit = entries.iter().fold(0.0f64, |unit, entry| unit.max(entry.1.abs()));
    let moved = entries.iter().fold(0.0f64, |most, entry| most.max((entry.1 * draft.u[entry.0]).abs()));
    (
        weakest / (local(draft, entries) + compliance).sqrt(),
        moved.max(unit * 1e-3 * draft.u[entries[0].0].abs()),
    )
}
