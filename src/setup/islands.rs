//! Bodies that do not interact are solved as separate problems. An island is a set of bodies joined by rows, directly or
//! through other bodies, with all its rows; its answer has the bits that it would have if solved alone.

use std::sync::Arc;

use crate::body::{Away, Local, Locals, Seen};
use crate::certificate::{Certificate, Entry};
use crate::constraints::{FrictionNode, RowKind, RowSet, Taken, Touched};
use crate::linalg::by_body::Ranges;
use crate::model::{Lengths, SolvedModel};

/// Bodies joined by rows, with their own numbering: unknowns body after body, rows in the order of the host.
#[derive(Clone)]
pub struct Island {
    /// Numbers of the bodies, ascending.
    pub bodies: Box<[usize]>,
    /// Unknowns of each body among those of the island; equal islands share them.
    pub ranges: Ranges,
    /// Unknowns that rows touch; equal islands share them.
    pub touched: Arc<Touched>,
    pub contact: Members,
    /// Shared by the islands without equality rows.
    pub equalities: Arc<Members>,
    /// Shared by the islands without friction.
    pub friction: Arc<Nodes>,
    /// 2^p, p = floor(log2 max K_ii), force / length: forces are divided by it.
    pub unit: f64,
}

/// Rows of one kind in an island.
#[derive(Clone, Default)]
pub struct Members {
    /// Their numbers among all rows of this kind, ascending.
    pub numbers: Vec<usize>,
    /// Over the unknowns that rows of the island touch.
    pub rows: RowSet,
}

/// Nodes with friction in an island that may carry a tangential force.
#[derive(Clone, Default)]
pub struct Nodes {
    /// Their numbers among all nodes, ascending.
    pub numbers: Vec<usize>,
    /// Laws with the contact rows and tangential rows of the island.
    pub nodes: Vec<FrictionNode>,
    /// Tangential rows that count: those without entries only if they slip by their s_old.
    pub tangential: Members,
}

impl Island {
    /// Some node has friction.
    pub fn has_friction(&self) -> bool {
        self.friction.nodes.iter().any(FrictionNode::has_friction)
    }

    pub fn unknowns(&self) -> usize {
        self.ranges.last().map_or(0, |range| range.end)
    }

    /// K of its bodies, without K+.
    pub(super) fn matrices<'a>(&'a self, model: &'a SolvedModel, away: &'a [Option<Away>]) -> Locals<'a> {
        let local = |(k, &p): (usize, &usize)| {
            if let Some(away) = away.get(k).and_then(Option::as_ref) {
                return Some(Seen::Away(away, self.touched.on(k)));
            }
            let body = &model.bodies[p].body;
            Some(Seen::Here(Local::of_matrix(body.k()?, body.without(self.unit), self.touched.on(k))))
        };
        Locals::new(self.bodies.iter().enumerate().filter_map(local).collect(), 1)
    }

    pub fn members(&self, kind: RowKind) -> &Members {
        match kind {
            RowKind::Inequality => &self.contact,
            RowKind::Equality => &self.equalities,
            RowKind::Tangential => &self.friction.tangential,
        }
    }

    /// Kind of row i of the stack, contact rows, equality rows, tangential rows, and its number within this kind.
    pub fn kind_and_place(&self, i: usize) -> (RowKind, usize) {
        let (contact, equalities) = (self.contact.numbers.len(), self.equalities.numbers.len());
        match (i.checked_sub(contact), i.checked_sub(contact + equalities)) {
            (None, _) => (RowKind::Inequality, i),
            (Some(k), None) => (RowKind::Equality, k),
            (_, Some(k)) => (RowKind::Tangential, k),
        }
    }

    /// Kind of row i of the stack, and its number among all rows of this kind.
    pub fn kind_and_row(&self, i: usize) -> (RowKind, usize) {
        let (kind, place) = self.kind_and_place(i);
        (kind, self.members(kind).numbers[place])
    }

    /// Number of row i of the stack among the `contact` contact rows of the host followed by its equality rows;
    /// tangential rows are not included.
    pub fn in_stack(&self, contact: usize, i: usize) -> usize {
        match self.kind_and_row(i) {
            (RowKind::Inequality, row) => row,
            (RowKind::Equality | RowKind::Tangential, row) => contact + row,
        }
    }

    /// The set of row i of the stack, and its number in this set.
    pub fn row(&self, i: usize) -> (&RowSet, usize) {
        let (kind, place) = self.kind_and_place(i);
        (&self.members(kind).rows, place)
    }

    /// Copies values over the unknowns of the island to values over all unknowns.
    pub fn scatter<O: AsRef<[f64]>>(
        &self,
        model: &SolvedModel,
        own: impl IntoIterator<Item = O>,
        all: &mut [f64],
    ) {
        for (&p, own) in self.bodies.iter().zip(own) {
            all[model.range(p)].copy_from_slice(own.as_ref());
        }
    }

    /// Replaces the numbers of bodies and rows of the island in a certificate by those of the model.
    pub fn named(&self, own: Certificate) -> Certificate {
        let at = |entry: Entry, numbers: &[usize]| Entry { place: entry.place.map(|k| numbers[k]), ..entry };
        let (contact, equalities) = (&self.contact.numbers, &self.equalities.numbers);
        Certificate {
            equilibrium: at(own.equilibrium, &self.bodies),
            balance: at(own.balance, &self.bodies),
            penetration: at(own.penetration, contact),
            equality: at(own.equality, equalities),
            negative_force: at(own.negative_force, contact),
            complementarity: at(own.complementarity, contact),
            friction_cone: at(own.friction_cone, &self.friction.numbers),
            friction_work: at(own.friction_work, &self.friction.numbers),
            friction_stick: at(own.friction_stick, &self.friction.numbers),
            ..own
        }
    }

    /// Takes over the right-hand sides of the host, without those that are rounding, and its laws of friction.
    pub fn refresh(&mut self, lengths: &Lengths) {
        let model = lengths.model();
        let mut friction = Some(&mut self.friction).filter(|of| !of.is_empty()).map(Arc::make_mut);
        let tangential = friction.as_mut().map(|of| (&mut of.tangential, RowKind::Tangential));
        let equalities = Some(&mut self.equalities).filter(|of| !of.numbers.is_empty());
        let equalities = equalities.map(|of| (Arc::make_mut(of), RowKind::Equality));
        let contact = (&mut self.contact, RowKind::Inequality);
        for (members, kind) in [contact].into_iter().chain(equalities).chain(tangential) {
            let rows = model.rows(kind);
            let Members { numbers, rows: own } = members;
            let mut rounding = vec![0.0; numbers.len()];
            let of_own = own.rhs.iter_mut().zip(&mut rounding);
            for ((c, taken), &i) in of_own.zip(&*numbers) {
                *c = lengths.rhs(kind, i);
                *taken = if *c == rows.rhs[i] { 0.0 } else { rows.rhs[i].abs() };
            }
            let is_taken = rounding.iter().any(|taken| *taken != 0.0);
            own.taken = is_taken.then(|| Box::new(Taken { rhs: rounding, ..Taken::default() }));
        }
        let nodes = friction.into_iter().flat_map(|of| of.nodes.iter_mut().zip(&of.numbers));
        for (own, &number) in nodes {
            let (coefficient, bound) = law(model, number);
            *own = FrictionNode { coefficient, bound, ..*own };
        }
    }
}

/// Coefficient and bound of a node; a contact row without entries has a constant force, which is added to the bound.
pub fn law(model: &SolvedModel, number: usize) -> (f64, f64) {
    let FrictionNode { normal, coefficient, bound, .. } = model.friction.nodes[number];
    let alone = normal.map_or(0.0, |row| model.contact.force_without_entries(RowKind::Inequality, row));
    (coefficient, bound + coefficient * alone)
}

impl Nodes {
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }
}

impl Members {
    /// Copies the values of the island from values over all rows of the kind.
    pub fn gather(&self, all: &[f64]) -> Vec<f64> {
        self.numbers.iter().map(|&i| all[i]).collect()
    }

    pub fn scatter<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.numbers.iter().zip(own).for_each(|(&i, v)| all[i] = *v);
    }
}

impl Island {
    pub fn empty() -> Self {
        let (contact, equalities, friction) = Default::default();
        let touched = Arc::default();
        Self { bodies: [].into(), ranges: Arc::default(), touched, contact, equalities, friction, unit: 1.0 }
    }
}
