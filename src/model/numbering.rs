//! The host's own numbers of the unknowns, over all bodies; without them unknowns are numbered consecutively through the
//! bodies.

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result, INDEX};
use crate::linalg::vector::first_non_finite;
use crate::model::host::HostModel;
use crate::platform::memory::{refusal, reserved};

/// The smallest number that is too large for an index of an array.
const TOO_LARGE: usize = isize::MAX as usize / size_of::<f64>();

/// Columns of rows from here on are numbers of unknowns that this rank does not have.
pub const NAMED: usize = TOO_LARGE.next_power_of_two();

impl HostModel {
    /// The numbers of a body, distinct over all bodies; if glue is allowed, distinct within each body.
    fn checked_numbers(&self, body: usize, numbers: &[i64]) -> Result<Vec<usize>> {
        let refused = |dof: usize, what: &str| {
            let error = Error::argument("number", what).body(body).dof(dof).entry(dof);
            Err(error.index(numbers[dof]))
        };
        let (glued, mut checked) =
            (self.settings.glue == 1, reserved(numbers.len(), "the numbers of a body")?);
        for (dof, &number) in numbers.iter().enumerate() {
            match usize::try_from(number).ok().filter(|number| *number < TOO_LARGE) {
                None => return refused(dof, &format!("no array has an entry {INDEX}")),
                Some(number)
                    if !glued && self.unknowns.get(&number).is_some_and(|(other, _)| *other != body) =>
                {
                    let what =
                        "an unknown of another body has this number; if you set option glue = 1 first, \
                                the two unknowns move together";
                    return refused(dof, what);
                }
                Some(number) => checked.push(number),
            }
        }
        let mut order: Vec<usize> = reserved(numbers.len(), "the numbers of a body")?;
        order.extend(0..numbers.len());
        order.sort_unstable_by_key(|&dof| (checked[dof], dof));
        let again = order.windows(2).filter(|pair| checked[pair[0]] == checked[pair[1]]).map(|pair| pair[1]);
        again.min().map_or(Ok(checked), |dof| refused(dof, "another unknown of the body has this number"))
    }

    pub fn set_numbering(&mut self, body: usize, numbers: &[i64]) -> Result<()> {
        self.check_length(body, "n", numbers.len())?;
        let numbers = self.checked_numbers(body, numbers)?;
        if self.bodies[body].numbers.as_deref() == Some(&numbers) {
            return Ok(());
        }
        self.check_no_table()?;
        let was_shared = self.shares_numbers();
        let (unknowns, bodies) = (&mut self.unknowns, &mut self.contents.bodies);
        let bytes = numbers.len() * size_of::<(usize, (usize, usize))>();
        unknowns.try_reserve(numbers.len()).map_err(|_| refusal(bytes, "the numbers of the unknowns"))?;
        for old in bodies[body].numbers.iter().flatten() {
            if unknowns.get(old).is_some_and(|(first, _)| *first == body) {
                unknowns.remove(old);
            }
        }
        bodies[body].numbers = Some(numbers.into());
        self.numberings += 1;
        // a number that the body no longer uses may belong to other bodies
        let claiming = if was_shared { 0..bodies.len() } else { body..body + 1 };
        for p in claiming {
            for (dof, &number) in bodies[p].numbers.iter().flatten().enumerate() {
                let first = unknowns.entry(number).or_insert((p, dof));
                *first = (*first).min((p, dof));
            }
        }
        if was_shared || self.shares_numbers() {
            self.revisions.rows += 1;
            self.revisions.bodies += 1;
        }
        Ok(())
    }

    /// Whether unknowns of several bodies share a number.
    pub fn shares_numbers(&self) -> bool {
        let all = self.bodies.iter().filter_map(|given| given.numbers.as_deref());
        all.map(<[usize]>::len).sum::<usize>() > self.unknowns.len()
    }

    /// Whether the bodies have numbers: either all or none must have.
    pub(super) fn is_numbered(&self) -> Result<bool> {
        let numbers = self.unknowns.len();
        if numbers == 0 || numbers == self.sizes().dofs {
            return Ok(numbers > 0);
        }
        match self.bodies.iter().position(|given| given.numbers.is_none()) {
            None => Ok(true),
            Some(body) => {
                let what =
                    "other bodies have numbers of the host, this body has none: give them by feti_body_numbering";
                Err(Error::new(Kind::State, what).body(body))
            }
        }
    }

    pub fn check_whole(&self, n: usize) -> Result<()> {
        if let Some(table) = &self.table {
            let end = table.dofs.len();
            let what = format!("the table has {end} unknowns, not {n}");
            return match n >= end {
                true => Ok(()),
                false => Err(Error::argument("n", what).value(n as f64).limit(end as f64)),
            };
        }
        let numbered = self.is_numbered()?;
        let largest = self.bodies.iter().filter_map(|given| given.numbers.as_deref()?.iter().max());
        let end = if numbered { largest.max().map_or(0, |most| most + 1) } else { self.sizes().dofs };
        if n == end || numbered && n > end {
            return Ok(());
        }
        let what = match numbered {
            true => format!("the largest number of an unknown needs {end} entries, not {n}"),
            false => format!("the bodies have {end} unknowns, not {n}"),
        };
        Err(Error::argument("n", what).value(n as f64).limit(end as f64))
    }

    /// Refuses rows that name numbers of unknowns that this rank does not have.
    pub fn check_named(&self) -> Result<()> {
        for kind in RowKind::ALL.into_iter().filter(|_| self.has_others) {
            let rows = &self.rows(kind).matrix;
            if let Some(at) = rows.col.iter().position(|j| *j >= NAMED) {
                let error = Error::argument("dof", format!("no unknown has the number {INDEX}"));
                let row = rows.ptr.partition_point(|&start| start <= at) - 1;
                return Err(error.row(row).kind(kind as usize).index((rows.col[at] - NAMED) as i64));
            }
        }
        Ok(())
    }

    /// Calls `work` for every unknown with its body, its dof and its position in an array over all unknowns; the position
    /// is none if an unknown of an earlier body has the same number.
    fn each_unknown(&self, mut work: impl FnMut(usize, usize, Option<usize>)) -> Result<()> {
        let (numbered, shared, mut place) = (self.is_numbered()?, self.shares_numbers(), 0);
        for (body, given) in self.bodies.iter().enumerate() {
            for dof in 0..given.body.order {
                let number =
                    given.numbers.as_ref().filter(|_| numbered).map_or(place, |numbers| numbers[dof]);
                let again = shared && self.unknowns.get(&number) != Some(&(body, dof));
                work(body, dof, (!again).then_some(number));
                place += 1;
            }
        }
        Ok(())
    }

    pub fn spread(&self, values: &[f64], mut to: impl FnMut(usize, f64)) -> Result<()> {
        let mut values = values.iter();
        self.each_unknown(|_, _, place| {
            values.next().zip(place).into_iter().for_each(|(v, place)| to(place, *v));
        })
    }

    pub fn set_all_loads(&mut self, f: &[f64]) -> Result<()> {
        self.check_whole(f.len())?;
        if let Some(table) = self.table.clone() {
            return self.set_loads_by(&table, f);
        }
        let mut loads = reserved(self.bodies.len(), "the loads")?;
        for given in &self.bodies {
            loads.push(reserved(given.body.order, "a load")?);
        }
        self.each_unknown(|body, _, place| loads[body].push(place.map_or(0.0, |place| f[place])))?;
        for (body, load) in loads.iter().enumerate() {
            if let Some(dof) = first_non_finite(load) {
                let mut entry = dof;
                self.each_unknown(|p, i, place| {
                    if (p, i) == (body, dof) {
                        entry = place.unwrap_or(dof);
                    }
                })?;
                let error = Error::argument("f", "the entry is not a finite number");
                return Err(error.body(body).dof(dof).entry(entry));
            }
        }
        self.bodies.iter_mut().zip(loads).for_each(|(given, load)| given.body.load = Some(load.into()));
        Ok(())
    }

    /// Positions of the unknowns of rows, which begin at `ptr`, among the unknowns of all bodies one after the other; of those that only
    /// another rank may have, their numbers from `NAMED` on;
    /// none if the host has not given numbers.
    pub fn places_of(&self, ptr: &[usize], numbers: &[i64]) -> Result<Option<Vec<i64>>> {
        if !(self.is_numbered()? || self.has_others && self.bodies.is_empty()) {
            return Ok(None);
        }
        let mut places = reserved(numbers.len(), "constraint rows")?;
        let elsewhere = |number: usize| (self.has_others && number < TOO_LARGE).then_some(NAMED + number);
        for (entry, &number) in numbers.iter().enumerate() {
            let place = |number: usize| match self.unknowns.get(&number) {
                Some((body, dof)) => Some(self.offsets[*body] + dof),
                None => elsewhere(number),
            };
            let Some(place) = usize::try_from(number).ok().and_then(place) else {
                let row = ptr.partition_point(|&start| start <= entry) - 1;
                let error = Error::argument("dof", format!("no unknown has the number {INDEX}"))
                    .row(row)
                    .entry(entry);
                return Err(error.index(number));
            };
            places.push(place as i64);
        }
        Ok(Some(places))
    }
}
