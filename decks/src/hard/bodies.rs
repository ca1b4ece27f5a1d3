//! The bodies of hard problems: those of varied ones, of unequal stiffness, put together, rounded, moved from the origin.

use super::{Kind, Plan};
use crate::random::Random;
use crate::varied::draft::Draft;
use crate::vector::axpy;
use crate::{Body, Csr, Deck};

/// Coordinates that are far from the origin.
const FAR: f64 = 1000.0;

impl Plan {
    pub(super) fn bodies(&mut self, unknowns: usize, random: Random) -> Draft {
        let mut draft = Draft::new(self.classes.clone(), unknowns, random);
        let floating = |draft: &Draft| draft.deck.bodies.iter().any(|body| !body.modes().is_empty());
        let needs_motion = matches!(self.kinds[0], Kind::Balanced | Kind::NotHeld | Kind::Idle);
        while needs_motion && !floating(&draft) {
            draft = Draft::new(self.classes.clone(), unknowns, draft.random);
        }
        if self.is(Kind::Contrast) {
            for p in 0..draft.deck.bodies.len() {
                let factor = draft.random.decades(-3.0, 3.0);
                draft.deck.bodies[p].stiffness.val.iter_mut().for_each(|k| *k *= factor);
            }
        }
        if self.digits < 16 {
            let values = draft.deck.bodies.iter_mut().flat_map(|body| &mut body.stiffness.val);
            values.for_each(|k| *k = digits(*k, self.digits));
            self.note(&format!("{} digits", self.digits));
        }
        draft.diagonal = draft.deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
        if self.is(Kind::Parts) {
            put_together(&mut draft);
        }
        if self.far {
            draft.deck.bodies.iter_mut().for_each(move_far);
            self.note("far from the origin");
        }
        draft.deform();
        draft
    }
}

/// The nearest number of so many decimal digits.
pub(super) fn digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().expect("a number")
}

/// Two to four neighbours become one body, again and again.
fn put_together(draft: &mut Draft) {
    let mut bodies = std::mem::take(&mut draft.deck.bodies).into_iter().peekable();
    let mut whole = Vec::new();
    while bodies.peek().is_some() {
        let count = 2 + draft.random.below(3);
        whole.push(one(&bodies.by_ref().take(count).collect::<Vec<_>>()));
    }
    draft.group.truncate(whole.len());
    draft.deck = Deck::new("hard", whole);
}

/// Parts that nothing connects as one body.
fn one(parts: &[Body]) -> Body {
    let order = parts.iter().map(Body::dofs).sum();
    let mut stiffness = Csr::empty(order);
    let mut whole = Body {
        stiffness: Csr::empty(order),
        null_space: None,
        load: vec![0.0; order],
        coordinates: vec![],
        node: vec![],
        direction: vec![],
    };
    let mut modes = Vec::new();
    let (mut first, mut nodes) = (0, 0);
    for (k, part) in parts.iter().enumerate() {
        for i in 0..part.dofs() {
            let entries: Vec<_> = part.stiffness.row(i).map(|(j, v)| (first + j, v)).collect();
            stiffness.push_row(&entries);
        }
        for mode in part.modes() {
            let mut long = vec![0.0; order];
            long[first..first + mode.len()].copy_from_slice(mode);
            modes.push(long);
        }
        whole.coordinates.extend(part.coordinates.iter().map(|x| [x[0] + 20.0 * k as f64, x[1], x[2]]));
        whole.node.extend(part.node.iter().map(|node| node + nodes));
        whole.direction.extend(&part.direction);
        nodes = whole.node.iter().copied().max().unwrap_or(0);
        first += part.dofs();
    }
    whole.stiffness = stiffness;
    whole.null_space = (!modes.is_empty()).then_some(modes);
    whole
}

/// Rotations about an origin far away: with a large part of translations in them.
fn move_far(body: &mut Body) {
    body.coordinates.iter_mut().flatten().for_each(|x| *x += FAR);
    let (coordinates, direction) = (&body.coordinates, &body.direction);
    let Some(modes) = &mut body.null_space else { return };
    let (dofs, old) = (direction.len(), modes.clone());
    for mode in modes.iter_mut() {
        let rotates = (0..dofs).any(|i| mode[i] != 0.0 && mode[i].abs() != 1.0) && old.len() > 2;
        let part: Vec<f64> = mode.iter().map(|v| f64::from(u8::from(*v != 0.0))).collect();
        for axis in 1..=if rotates { 2 } else { 0 } {
            let sign = if axis == 1 { -FAR } else { FAR };
            let moved =
                |i: usize| f64::from(u8::from(direction[i] == axis && part_of(coordinates, &part, i)));
            axpy(sign, &(0..dofs).map(moved).collect::<Vec<_>>(), mode);
        }
    }
}

/// Whether unknown i lies within the part of a body that a motion moves.
fn part_of(coordinates: &[[f64; 3]], part: &[f64], i: usize) -> bool {
    let moved = (0..part.len()).filter(|&j| part[j] != 0.0).map(|j| coordinates[j][0]);
    let (least, most) = moved.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
    (least..=most).contains(&coordinates[i][0])
}
