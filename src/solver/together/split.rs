//! The answer of the problem of all ranks, split: to each rank what belongs to its own bodies, rows and nodes, in its own numbers.

use crate::certificate::{Certificate, Entry};
use crate::constraints::RowKind;
use crate::error::{Error, Proof, Result};
use crate::gathering::{At, Order};
use crate::model::{HostModel, Joint};
use crate::solve::{Answer, OfOthers, Report};
use crate::solver::findings::Findings;
use crate::solver::together::share::{OwnAnswer, Share};

/// The bodies, rows and nodes of one rank in the problem of all, in the order of their numbers there.
struct Own {
    bodies: Vec<usize>,
    rows: [Vec<usize>; 3],
    nodes: Vec<usize>,
}

impl Own {
    fn of(order: &Order, rank: usize) -> Self {
        let own = |all: &[At]| {
            let mut own: Vec<(usize, usize)> = all
                .iter()
                .enumerate()
                .filter(|(_, at)| at.rank == rank)
                .map(|(k, at)| (at.number, k))
                .collect();
            own.sort_unstable();
            own.into_iter().map(|(_, k)| k).collect::<Vec<usize>>()
        };
        Self {
            bodies: own(&order.bodies),
            rows: order.rows.each_ref().map(|rows| own(rows)),
            nodes: own(&order.nodes),
        }
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
    others: Vec<OfOthers>,
}

impl<'a> Split<'a> {
    pub fn new(order: &'a Order, model: &'a HostModel, answer: Option<&Answer>) -> Result<Self> {
        let nothing = || OfOthers { of_rows: vec![Vec::new(); RowKind::ALL.len()], ..OfOthers::default() };
        let all = [&order.bodies, &order.nodes].into_iter().flatten();
        let ranks = all.map(|at| at.rank + 1).max().unwrap_or(0);
        let mut others: Vec<OfOthers> = (0..ranks).map(|_| nothing()).collect();
        let Some(answer) = answer else { return Ok(Self { order, model, others }) };
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
        let reached = model.friction.reached(&answer.u, &answer.tangential)?;
        for rank in 0..ranks {
            let dim = model.friction.dim;
            let nodes = Own::of(order, rank).nodes;
            others[rank].reached =
                nodes.iter().flat_map(|k| &reached[dim * k..dim * (k + 1)]).copied().collect();
        }
        Ok(Self { order, model, others })
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
        let own = Own::of(self.order, rank).bodies;
        own.into_iter().flat_map(|body| &all[self.model.range(body)]).copied().collect()
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
    pub fn share(&self, rank: usize, answer: Option<&Answer>, findings: &Findings) -> Share {
        let own = Own::of(self.order, rank);
        let answer = answer.map(|answer| (self.report(&answer.report), self.own_answer(rank, &own, answer)));
        Share { answer, findings: self.findings(rank, &own, findings) }
    }

    fn own_answer(&self, rank: usize, own: &Own, answer: &Answer) -> OwnAnswer {
        let dim = self.model.friction.dim;
        let u = own.bodies.iter().flat_map(|body| &answer.u[self.model.range(*body)]).copied().collect();
        let forces = RowKind::ALL.iter().map(|kind| picked(answer.forces(*kind), &own.rows[*kind as usize]));
        let of_node = |k: &usize| (dim * k..dim * (k + 1)).map(|i| answer.slips[i]);
        OwnAnswer {
            u,
            forces: forces.collect(),
            slips: own.nodes.iter().flat_map(of_node).collect(),
            friction: picked(&answer.friction, &own.nodes),
            alpha: picked(&answer.alpha, &own.bodies),
            gaps: picked(&answer.gaps, &own.rows[0]),
            states: picked(&answer.states, &own.rows[0]),
            force_errors: picked(&answer.force_errors, &own.bodies),
            without: picked(&answer.without, &own.bodies),
            fails: answer.without.contains(&true),
            of_others: self.others.get(rank).cloned().unwrap_or_default(),
        }
    }

    fn findings(&self, rank: usize, own: &Own, findings: &Findings) -> Findings {
        let mut told = findings.clone();
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
