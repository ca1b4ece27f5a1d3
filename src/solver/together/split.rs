//! The answer of the problem of all ranks, split: to each rank what belongs to its own bodies, rows and nodes, in its own numbers.

use std::collections::HashMap;

use crate::certificate::{Certificate, Entry};
use crate::constraints::RowKind;
use crate::error::{Error, Proof, Result};
use crate::gathering::{At, Order};
use crate::model::{HostModel, Joint, Parts};
use crate::solve::{Answer, OfOthers, Report, Shown, Stays};
use crate::solver::findings::Findings;
use crate::solver::together::share::Share;

/// The bodies, rows and nodes of one rank in the problem of all, in the order of their numbers there.
#[derive(Default)]
struct Own {
    bodies: Vec<usize>,
    rows: [Vec<usize>; 3],
    nodes: Vec<usize>,
}

impl Own {
    /// Of every rank.
    fn of_all(order: &Order, ranks: usize) -> Vec<Self> {
        let mut own: Vec<Self> = (0..ranks).map(|_| Self::default()).collect();
        let mut split = |all: &[At], list: fn(&mut Self) -> &mut Vec<usize>| {
            let mut ascending: Vec<(At, usize)> = all.iter().copied().zip(0..).collect();
            ascending.sort_unstable();
            ascending.into_iter().for_each(|(at, k)| list(&mut own[at.rank]).push(k));
        };
        split(&order.bodies, |own| &mut own.bodies);
        split(&order.rows[0], |own| &mut own.rows[0]);
        split(&order.rows[1], |own| &mut own.rows[1]);
        split(&order.rows[2], |own| &mut own.rows[2]);
        split(&order.nodes, |own| &mut own.nodes);
        own
    }
}

fn picked<T: Clone>(all: &[T], own: &[usize]) -> Vec<T> {
    own.iter().filter_map(|k| all.get(*k).cloned()).collect()
}

/// Translates what the problem of all ranks has found.
pub struct Split<'a> {
    order: &'a Order,
    model: &'a HostModel,
    /// Of every rank.
    own: Vec<Own>,
    others: Vec<OfOthers>,
}

impl<'a> Split<'a> {
    pub fn new(
        order: &'a Order,
        model: &'a HostModel,
        ranks: usize,
        answer: Option<(&Answer, &Stays)>,
    ) -> Result<Self> {
        let nothing = || OfOthers { of_rows: vec![Vec::new(); RowKind::ALL.len()], ..OfOthers::default() };
        let mut others: Vec<OfOthers> = (0..ranks).map(|_| nothing()).collect();
        let all = Own::of_all(order, ranks);
        let Some((answer, stays)) = answer else { return Ok(Self { order, model, own: all, others }) };
        let starts = order.starts();
        let own = |j: usize| {
            let body = model.offsets[1..].partition_point(|end| *end <= j);
            (order.bodies[body].rank, j - model.offsets[body] + starts[body])
        };
        for kind in RowKind::ALL {
            let rows = model.rows(kind);
            let forces = answer.forces(kind)[..rows.len()].iter().enumerate();
            for (i, force) in forces.filter(|(_, force)| **force != 0.0) {
                for (j, v) in rows.matrix.row(i) {
                    let (rank, j) = own(j);
                    others[rank].of_rows[kind as usize].push((j, -force * v));
                }
            }
        }
        for (Joint { ends: [before, after], .. }, mu) in
            model.joints()?.into_iter().zip(&answer.mu[model.equalities.len()..])
        {
            for (j, push) in [(before, -mu), (after, *mu)] {
                let (rank, j) = own(j);
                others[rank].of_glue.push((j, push));
            }
        }
        let shown = Shown::new(model, &answer.u, stays);
        let (dim, reached) =
            (model.friction.dim, model.friction.reached(|j| shown.at(j), &answer.tangential)?);
        for (to, own) in others.iter_mut().zip(&all) {
            let nodes = own.nodes.iter().flat_map(|k| &reached[dim * k..dim * (k + 1)]);
            to.reached = nodes.copied().collect();
        }
        Ok(Self { order, model, own: all, others })
    }

    /// Of the parts of every body of a rank, in their order there, those of what stays on other ranks: `names`, by parts.
    pub fn names(&self, rank: usize, parts: Option<&Parts>, names: &HashMap<usize, u64>) -> Vec<Option<u64>> {
        let own = self.own[rank].bodies.iter();
        own.flat_map(|body| parts.map_or(*body..body + 1, |parts| parts.of(*body)))
            .map(|part| names.get(&part).copied())
            .collect()
    }

    fn body(&self, body: usize) -> At {
        self.order.bodies.get(body).copied().unwrap_or(At { rank: 0, number: body })
    }

    /// An error in the numbers of the rank that has its place.
    pub fn error(&self, mut error: Error) -> Error {
        self.model.set_rank(&mut error.place);
        error
    }

    fn report(&self, report: &Report) -> Report {
        Report { certificate: self.certificate(&report.certificate), ..report.clone() }
    }

    /// With the places of all ranks.
    pub fn certificate(&self, certificate: &Certificate) -> Certificate {
        let (mut told, Order { bodies, rows, nodes, .. }) = (*certificate, self.order);
        let Certificate {
            equilibrium, balance, penetration, equality, negative_force, complementarity, ..
        } = &mut told;
        [equilibrium, balance].into_iter().for_each(|entry| named(entry, bodies));
        [penetration, negative_force, complementarity].into_iter().for_each(|entry| named(entry, &rows[0]));
        named(equality, &rows[1]);
        let Certificate { friction_cone, friction_work, friction_stick, .. } = &mut told;
        [friction_cone, friction_work, friction_stick].into_iter().for_each(|entry| named(entry, nodes));
        told
    }

    /// Of values over all unknowns those of the bodies of a rank.
    pub fn own(&self, rank: usize, all: &[f64]) -> Vec<f64> {
        let own = self.own[rank].bodies.iter();
        own.flat_map(|body| &all[self.model.range(*body)]).copied().collect()
    }

    /// Of rank 0; the others have theirs.
    fn own_displacements(&self, rank: usize, all: &[f64]) -> Vec<f64> {
        if rank > 0 {
            return Vec::new();
        }
        let starts = self.model.starts();
        let own = self.own[rank].bodies.iter();
        own.flat_map(|body| &all[starts[*body]..starts[body + 1]]).copied().collect()
    }

    /// The bodies of a rank, in the order of their numbers there.
    pub fn own_bodies_of(&self, rank: usize) -> &[usize] {
        &self.own[rank].bodies
    }

    /// The number of a body on this rank.
    pub fn own_body(&self, rank: usize, body: usize) -> Option<usize> {
        Some(self.body(body)).filter(|at| at.rank == rank).map(|at| at.number)
    }

    /// Of equality rows those of a rank, ascending.
    pub fn own_rows(&self, rank: usize, rows: &[usize]) -> Vec<usize> {
        let at = rows.iter().filter_map(|row| self.order.rows[1].get(*row)).filter(|at| at.rank == rank);
        let mut own: Vec<usize> = at.map(|at| at.number).collect();
        own.sort_unstable();
        own
    }

    /// What a rank gets.
    pub fn share(
        &self,
        rank: usize,
        answer: Option<&Answer>,
        names: Vec<Option<u64>>,
        findings: &Findings,
    ) -> Share {
        let answer = answer.map(|answer| self.own_answer(rank, answer));
        Share { answer, names, findings: self.findings(rank, findings) }
    }

    fn own_answer(&self, rank: usize, answer: &Answer) -> Answer {
        let (own, dim) = (&self.own[rank], self.model.friction.dim);
        let forces = |kind: RowKind| picked(answer.forces(kind), &own.rows[kind as usize]);
        let [lambda, mu, tangential] = RowKind::ALL.map(forces);
        let of_node = |k: &usize| (dim * k..dim * (k + 1)).map(|i| answer.slips[i]);
        Answer {
            report: self.report(&answer.report),
            u: self.own_displacements(rank, &answer.u),
            lambda,
            mu,
            tangential,
            slips: own.nodes.iter().flat_map(of_node).collect(),
            friction: picked(&answer.friction, &own.nodes),
            alpha: picked(&answer.alpha, &own.bodies),
            gaps: picked(&answer.gaps, &own.rows[0]),
            states: picked(&answer.states, &own.rows[0]),
            force_errors: picked(&answer.force_errors, &own.bodies),
            // some bodies of some rank have no answer
            failed: vec![answer.without.contains(&true)],
            cleaned: Vec::new(),
            without: picked(&answer.without, &own.bodies),
            of_others: Some(Box::new(self.others[rank].clone())),
        }
    }

    fn findings(&self, rank: usize, findings: &Findings) -> Findings {
        let (own, mut told) = (&self.own[rank], findings.clone());
        self.model.set_rank(&mut told.place);
        let lists = [&mut told.untouched, &mut told.doubtful, &mut told.soft];
        lists.into_iter().for_each(|list| *list = self.own_bodies(rank, list));
        told.contact = own.rows[0].len();
        let contact = self.order.rows[0].len();
        let of_own = |(row, weight): (usize, f64)| {
            let (kind, k) = if row < contact { (0, row) } else { (1, row - contact) };
            let at = self.order.rows[kind].get(k).filter(|at| at.rank == rank)?;
            Some((if kind == 0 { at.number } else { told.contact + at.number }, weight))
        };
        let listed = |all: &[(usize, f64)]| {
            let mut own: Vec<_> = all.iter().copied().filter_map(of_own).collect();
            own.sort_by_key(|(row, _)| *row);
            own
        };
        let redundant = listed(&findings.redundant);
        let proof = findings.proof.as_ref().map(|proof| match proof {
            Proof::Motion { margin, v } => {
                let v = own.bodies.iter().filter_map(|body| v.get(self.model.range(*body)));
                Proof::Motion { margin: *margin, v: v.flatten().copied().collect() }
            }
            Proof::Rows { margin, weights, heaviest } => {
                let heaviest = of_own((*heaviest, 1.0)).map_or(usize::MAX, |(row, _)| row);
                Proof::Rows { margin: *margin, weights: listed(weights), heaviest }
            }
        });
        Findings { redundant, proof, ..told }
    }

    fn own_bodies(&self, rank: usize, list: &[usize]) -> Vec<usize> {
        let mut own: Vec<usize> = list
            .iter()
            .map(|body| self.body(*body))
            .filter(|at| at.rank == rank)
            .map(|at| at.number)
            .collect();
        own.sort_unstable();
        own
    }
}

fn named(entry: &mut Entry, all: &[At]) {
    let Some(at) = entry.place.and_then(|place| all.get(place)) else { return };
    (entry.rank, entry.place) = (at.rank, Some(at.number));
}
