//! The problem of all ranks, brought up to date at the begin of a call.

use std::collections::HashMap;
use std::sync::Arc;

use crate::body::{BodyElsewhere, BodyThere, GivenThere, LoadThere, OtherForm, PartThere};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::gathering::{
    copies, gathered, refresh, shared, At, GivenAt, Order, Places, Revised, Told, Values, SECTION,
};
use crate::model::Revisions;
use crate::progress::LogLevel;
use crate::ranks::value;
use crate::solver::together::leader::Leading;
use crate::solver::together::messages::{
    Begun, PartTold, PartsTold, Touch, Touched, BLOCK, LOADS, NUMBERS, TOUCH,
};
use crate::solver::together::ready_part;

impl Leading<'_> {
    pub(super) fn gather(&mut self, begun: Vec<(usize, Begun)>) -> Result<()> {
        let (mut told, values) = self.told(begun)?;
        told.iter_mut().zip(&values).for_each(|(of, values)| of.refresh(values));
        let now: Vec<Revised> = told.iter().map(|of| of.revisions).collect();
        if self.leader.made_from != now {
            self.rebuild(&told, now)?;
        }
        refresh(&mut self.all.model, &self.leader.order, &values);
        self.all.model.contents.settings.clone_from(&self.own.model.settings);
        self.start(&values);
        self.loads()?;
        self.leader.told = Some(told);
        Ok(())
    }

    /// The parts of all ranks, told now or before, and what changes without a new setup.
    fn told(&mut self, begun: Vec<(usize, Begun)>) -> Result<(Vec<Told>, Vec<Values>)> {
        let start = self.own.history().given_start();
        ready_part(&mut self.own.model, 0).map_err(|e| e.rank(0))?;
        let model = &self.own.model;
        let before = self.leader.told.take().unwrap_or_default();
        let mut before = before.into_iter().map(Some).collect::<Vec<_>>();
        before.resize_with(self.ranks.size, || None);
        let own = match before[0].take().filter(|of| of.revisions == Revised::of(model)) {
            Some(own) => own,
            None => Told::of(model).map_err(|e| e.rank(0))?,
        };
        let nothing = |_| (Told::nothing(), Values::nothing());
        let (mut told, mut values): (Vec<_>, Vec<_>) = (0..self.ranks.size).map(nothing).unzip();
        (told[0], values[0]) = (own, Values::of(model, start, self.own.history.commits));
        for (rank, of) in begun {
            told[rank] = of.told.or_else(|| before[rank].take()).ok_or_else(lost)?;
            values[rank] = of.values.ok_or_else(lost)?;
        }
        check_commits(&values)?;
        self.tell_other_options(&values)?;
        Ok((told, values))
    }

    /// Notes ranks whose options differ from those of rank 0.
    fn tell_other_options(&self, values: &[Values]) -> Result<()> {
        let said = |options: &str| if options.is_empty() { "none" } else { options }.to_owned();
        for rank in self.members.iter().filter(|rank| values[**rank].options != values[0].options) {
            let [own, other] = [0, *rank].map(|rank| said(&values[rank].options));
            self.own.host.log.say(LogLevel::Result, || {
                format!("note: the options of rank 0 count ({own}); rank {rank} has others ({other})")
            })?;
        }
        Ok(())
    }

    /// Start values of the host: those of ranks that have given none are 0.
    fn start(&mut self, values: &[Values]) {
        for kind in RowKind::ALL {
            let k = kind as usize;
            if values.iter().all(|of| of.start[k].is_none()) {
                continue;
            }
            let own = |at: &At| values[at.rank].start[k].as_ref().map_or(0.0, |all| all[at.number]);
            let all = self.leader.order.rows[k].iter().map(own).collect();
            self.all.history().start[k] = Some(all);
        }
    }

    /// Bodies and rows anew.
    fn rebuild(&mut self, told: &[Told], now: Vec<Revised>) -> Result<()> {
        let order = Order::of(told)?;
        let before = &self.leader.order;
        let differs = |of: fn(&Revised) -> u64| {
            let old = &self.leader.made_from;
            old.len() != now.len() || now.iter().zip(old).any(|(a, b)| of(a) != of(b))
        };
        let same_bodies = before.bodies == order.bodies && before.offsets == order.offsets;
        let is_renumbered = differs(|of| of.numberings) || !same_bodies;
        let shared = match (is_renumbered, order.is_numbered) {
            (false, _) => self.leader.shared.clone(),
            (true, false) => Vec::new(),
            (true, true) => self.merge(told)?,
        };
        let (places, given) = self.places(told, &order, &shared)?;
        let was = self.all.model.revisions;
        let revisions = Revisions {
            bodies: was.bodies + 1,
            rows: was.rows + u64::from(differs(|of| of.of.rows) || is_renumbered),
            laws: was.laws + u64::from(differs(|of| of.of.laws)),
        };
        self.all.model = gathered(told, &order, &places, given, revisions)?;
        if !same_bodies {
            self.all.forget_bodies();
        }
        if self.leader.expected.take().is_some_and(|expected| expected.rows != order.rows) {
            self.all.history().previous = None;
        }
        let own = order.by_ranks().into_iter().take_while(|(at, _)| at.rank == 0);
        self.leader.own = own.map(|(_, body)| body).collect();
        (self.leader.order, self.leader.made_from, self.leader.shared) = (Arc::new(order), now, shared);
        Ok(())
    }

    /// Where the unknowns of numbers are, and all bodies in their order.
    fn places(
        &self,
        told: &[Told],
        order: &Order,
        shared: &[(usize, Vec<usize>)],
    ) -> Result<(Places, Vec<GivenAt>)> {
        let (named, number_of) = (Order::named(told), order.number_of_bodies());
        let touched = |rank: usize| {
            let shared = shared.iter().filter(|(_, of)| of.contains(&rank));
            let mut all: Vec<usize> =
                named.iter().copied().chain(shared.map(|(number, _)| *number)).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let mut places = Places::default();
        let mut add = |rank: usize, of: &(Vec<usize>, Vec<Vec<(usize, usize)>>)| {
            for (number, copies) in of.0.iter().zip(&of.1) {
                for (body, dof) in copies {
                    let body = number_of.get(&At { rank, number: *body }).copied().ok_or_else(lost)?;
                    places.add(*number, order.offsets[body] + dof);
                }
            }
            Ok(())
        };
        let model = &self.own.model;
        add(0, &copies(model, touched(0))?)?;
        let firsts: Vec<u64> = (0..self.ranks.size).map(|_| self.ranks.block(BLOCK)).collect();
        let answers = self.ask(TOUCH, |rank| Touch { numbers: touched(rank), first: firsts[rank] })?;
        let mut there = HashMap::new();
        for (rank, answer) in answers {
            let Touched { copies, bodies } = value(&answer)?;
            add(rank, &copies)?;
            let mut names = firsts[rank]..;
            for (number, PartsTold { parts, loose }) in bodies.into_iter().enumerate() {
                let part = |PartTold { order, dofs, facts }| {
                    let name = self.ranks.named(rank, names.next().unwrap_or_default());
                    let of = Arc::new(BodyElsewhere { name, facts });
                    PartThere { order, dofs, there: BodyThere { of, load: None } }
                };
                let parts = parts.into_iter().map(part).collect();
                there.insert(At { rank, number }, GivenThere { parts, loose });
            }
        }
        places.sort();
        let given = |at: &At| match at.rank {
            0 => Ok(GivenAt::Here(model.bodies[at.number].body.without_load())),
            _ => there.remove(at).map(GivenAt::There).ok_or_else(lost),
        };
        let given = order.bodies.iter().map(given).collect::<Result<_>>()?;
        Ok((places, given))
    }

    /// Numbers that several ranks have, which they may only if all have option glue.
    fn merge(&self, told: &[Told]) -> Result<Vec<(usize, Vec<usize>)>> {
        let mut numbers: Vec<usize> = self.own.model.unknowns.keys().copied().collect();
        numbers.sort_unstable();
        let mut own = numbers.chunks(SECTION).map(<[usize]>::to_vec);
        let mut firsts = vec![Vec::new(); self.ranks.size];
        firsts[0] = own.next().unwrap_or_default();
        for (rank, section) in self.ask(NUMBERS, |_| ())? {
            firsts[rank] = value(&section)?;
        }
        let found = shared(firsts, |rank| {
            if rank == 0 {
                return Ok(own.next().unwrap_or_default());
            }
            self.ask_one(rank, NUMBERS, ())
        })?;
        let without = told.iter().position(|of| !of.glue);
        if let (Some((number, of)), Some(rank)) = (found.first(), without) {
            let what = format!(
                "an unknown of rank {} has this number, too; if you set option glue = 1 on all ranks first (rank {rank} has 0), \
                 the two unknowns move together",
                of[0]
            );
            return Err(Error::argument("number", what).rank(of[1]).index(*number as i64));
        }
        Ok(found)
    }

    /// The loads of all bodies.
    fn loads(&mut self) -> Result<()> {
        let firsts: Vec<u64> = (0..self.ranks.size).map(|_| self.ranks.block(BLOCK)).collect();
        let mut loads: Vec<_> = (0..self.ranks.size).map(|_| Vec::new().into_iter()).collect();
        for (rank, answer) in self.ask(LOADS, |rank| firsts[rank])? {
            let largest: Vec<Option<f64>> = value(&answer)?;
            let names = (firsts[rank]..).map(|number| Arc::new(self.ranks.named(rank, number)));
            let all = largest.into_iter().zip(names).map(|(largest, name)| LoadThere { name, largest });
            loads[rank] = all.collect::<Vec<_>>().into_iter();
        }
        for (At { rank, number }, body) in self.leader.order.by_ranks() {
            let to = &mut self.all.model.contents.bodies[body].body;
            if rank == 0 {
                to.load.clone_from(&self.own.model.bodies[number].body.load);
            }
            if let Some(OtherForm::Given(there)) = to.other.as_deref_mut() {
                there.parts.iter_mut().for_each(|part| part.there.load = loads[rank].next());
            }
        }
        Ok(())
    }
}

/// Slips are committed by all ranks that have nodes with friction, or by none.
fn check_commits(values: &[Values]) -> Result<()> {
    let mut with_nodes = values.iter().enumerate().filter(|(_, of)| !of.laws.is_empty());
    let Some((first, of)) = with_nodes.next() else { return Ok(()) };
    let Some((other, _)) = with_nodes.find(|(_, other)| other.commits != of.commits) else { return Ok(()) };
    let what = format!("rank {first} and rank {other} have called feti_friction_commit not equally often");
    Err(Error::new(Kind::State, what))
}

fn lost() -> Error {
    Error::new(Kind::Internal, "a rank has not told all of its part")
}
