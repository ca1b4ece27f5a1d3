//! The host's own numbers of the unknowns, over all bodies; without them the bodies count one after the other.

use std::collections::HashMap;

use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::platform::memory::{refusal, reserved};
use crate::solver::problem::Problem;

/// The unknown behind every number: body and dof.
#[derive(Default)]
pub(super) struct Numbering {
    unknowns: HashMap<usize, (usize, usize)>,
}

/// Numbers from which on no array has so many entries.
const TOO_LARGE: usize = isize::MAX as usize / size_of::<f64>();

impl Numbering {
    /// The numbers of a body, each used once in all bodies.
    fn checked(&self, body: usize, numbers: &[i64]) -> Result<Vec<usize>> {
        let refused = |dof: usize, what: &str| {
            let error = Error::argument("number", what).body(body).dof(dof).entry(dof);
            Err(error.index(numbers[dof]))
        };
        let mut checked = reserved(numbers.len(), "the numbers of a body")?;
        for (dof, &number) in numbers.iter().enumerate() {
            match usize::try_from(number).ok().filter(|number| *number < TOO_LARGE) {
                None => return refused(dof, "no array has such an entry"),
                Some(number) if self.unknowns.get(&number).is_some_and(|(other, _)| *other != body) => {
                    return refused(dof, "the number is that of an unknown of another body");
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
}

impl Problem {
    /// The host's numbers of the unknowns of a body, from 0, distinct over all bodies. Calling again replaces them.
    pub fn set_numbering(&mut self, body: usize, numbers: &[i64]) -> Result<()> {
        self.check_length(body, "n", numbers.len())?;
        let numbers = self.numbering.checked(body, numbers)?;
        let unknowns = &mut self.numbering.unknowns;
        let bytes = numbers.len() * size_of::<(usize, (usize, usize))>();
        unknowns.try_reserve(numbers.len()).map_err(|_| refusal(bytes, "the numbers of the unknowns"))?;
        for old in self.bodies[body].numbers.iter().flatten() {
            unknowns.remove(old);
        }
        unknowns.extend(numbers.iter().enumerate().map(|(dof, &number)| (number, (body, dof))));
        self.bodies[body].numbers = Some(numbers);
        Ok(())
    }

    /// Whether the bodies have numbers: all or none.
    fn is_numbered(&self) -> Result<bool> {
        let numbers = self.numbering.unknowns.len();
        if numbers == 0 || numbers == self.counts().dofs {
            return Ok(numbers > 0);
        }
        match self.bodies.iter().position(|slot| slot.numbers.is_none()) {
            None => Ok(true),
            Some(body) => {
                let what =
                    "other bodies have numbers of the host, this one has not: feti_body_numbering gives them";
                Err(Error::new(Kind::State, what).body(body))
            }
        }
    }

    /// The length of an array over all unknowns: at least the largest number + 1, without numbers that of all bodies.
    pub fn check_whole(&self, n: usize) -> Result<()> {
        let numbered = self.is_numbered()?;
        let largest = self.bodies.iter().filter_map(|slot| slot.numbers.as_deref()?.iter().max());
        let end = if numbered { largest.max().map_or(0, |most| most + 1) } else { self.counts().dofs };
        if n == end || numbered && n > end {
            return Ok(());
        }
        let what = match numbered {
            true => format!("the largest number of an unknown needs {end} entries, there are {n}"),
            false => format!("the bodies have {end} unknowns, not {n}"),
        };
        Err(Error::argument("n", what).value(n as f64).limit(end as f64))
    }

    /// `work` on every unknown: its body, its dof, and its place in an array over all unknowns.
    fn each_unknown(&self, mut work: impl FnMut(usize, usize, usize)) -> Result<()> {
        let (numbered, mut place) = (self.is_numbered()?, 0);
        for (body, slot) in self.bodies.iter().enumerate() {
            for dof in 0..slot.body.order {
                let number = slot.numbers.as_ref().filter(|_| numbered).map(|numbers| numbers[dof]);
                work(body, dof, number.unwrap_or(place));
                place += 1;
            }
        }
        Ok(())
    }

    /// Gives the values of all bodies, one after the other, with their places in an array over all unknowns.
    pub fn spread(&self, values: &[f64], mut to: impl FnMut(usize, f64)) -> Result<()> {
        let mut values = values.iter();
        self.each_unknown(|_, _, place| values.next().into_iter().for_each(|v| to(place, *v)))
    }

    /// The loads of all bodies, force; entries of `f` that belong to no unknown are not looked at.
    pub fn set_all_loads(&mut self, f: &[f64]) -> Result<()> {
        self.check_whole(f.len())?;
        let mut loads = reserved(self.bodies.len(), "the loads")?;
        for slot in &self.bodies {
            loads.push(reserved(slot.body.order, "a load")?);
        }
        self.each_unknown(|body, _, place| loads[body].push(f[place]))?;
        for (body, load) in loads.iter().enumerate() {
            if let Some(dof) = first_non_finite(load) {
                let mut entry = dof;
                self.each_unknown(|p, i, place| {
                    if (p, i) == (body, dof) {
                        entry = place;
                    }
                })?;
                let error = Error::argument("f", "the entry is not a finite number");
                return Err(error.body(body).dof(dof).entry(entry));
            }
        }
        self.bodies.iter_mut().zip(loads).for_each(|(slot, load)| slot.body.load = Some(load));
        Ok(())
    }

    /// Unknowns of rows, which begin at `ptr`, as places among those of all bodies one after the other; none where the host
    /// has no numbers but these.
    pub(super) fn places_of(&self, ptr: &[usize], numbers: &[i64]) -> Result<Option<Vec<i64>>> {
        if !self.is_numbered()? {
            return Ok(None);
        }
        let mut places = reserved(numbers.len(), "constraint rows")?;
        for (entry, &number) in numbers.iter().enumerate() {
            let found = usize::try_from(number).ok().and_then(|number| self.numbering.unknowns.get(&number));
            let Some((body, dof)) = found else {
                let row = ptr.partition_point(|&start| start <= entry) - 1;
                let error = Error::argument("dof", "no unknown has this number").row(row).entry(entry);
                return Err(error.index(number));
            };
            places.push((self.offsets[*body] + dof) as i64);
        }
        Ok(Some(places))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{RowKind, RowsInput, SparseInput, Storage};

    /// Two springs of stiffness 2 and 4 from the ground, each with a free unknown coupled by 1 to it.
    fn pairs() -> Problem {
        let mut problem = Problem::new();
        for s in [2.0, 4.0] {
            let body = problem.add_body(2).unwrap();
            let k = SparseInput {
                ptr: &[0, 1, 3],
                col: &[0, 0, 1],
                val: &[s + 1.0, -1.0, 1.0],
                storage: Storage::Lower,
            };
            problem.set_stiffness(body, k).unwrap();
        }
        problem
    }

    #[test]
    fn a_number_names_one_unknown_of_all_bodies() {
        let mut problem = pairs();
        problem.set_numbering(0, &[7, 3]).unwrap();
        for (numbers, dof, says) in [
            ([3, 8], 0, "another body"),
            ([8, 7], 1, "another body"),
            ([5, 5], 1, "another unknown"),
            ([-1, 2], 0, "no array"),
            ([0, i64::MAX], 1, "no array"),
        ] {
            let error = problem.set_numbering(1, &numbers).unwrap_err();
            assert!(error.what.contains(says), "{error}");
            assert_eq!((error.kind, error.place.body), (Kind::Argument("number"), Some(1)));
            assert_eq!((error.place.dof, error.place.entry), (Some(dof), Some(dof)), "{numbers:?}");
        }
        // its own numbers may change places, and those it gives up are free
        problem.set_numbering(0, &[3, 7]).unwrap();
        problem.set_numbering(0, &[3, 1]).unwrap();
        problem.set_numbering(1, &[7, 0]).unwrap();
        assert_eq!(problem.numbering.unknowns.len(), 4);
    }

    #[test]
    fn all_bodies_have_numbers_or_none_when_they_are_used() {
        let mut problem = pairs();
        assert!(problem.check_whole(4).is_ok());
        assert_eq!(problem.check_whole(5).unwrap_err().kind, Kind::Argument("n"));
        problem.set_numbering(1, &[5, 0]).unwrap();
        let error = problem.set_all_loads(&[0.0; 6]).unwrap_err();
        assert_eq!((error.kind, error.place.body), (Kind::State, Some(0)));
        problem.set_numbering(0, &[2, 1]).unwrap();
        assert!(problem.check_whole(6).is_ok() && problem.check_whole(9).is_ok());
        assert_eq!(problem.check_whole(5).unwrap_err().place.limit, Some(6.0));
        problem.add_body(1).unwrap();
        assert_eq!(problem.check_whole(6).unwrap_err().place.body, Some(2));
    }

    /// The end of the first pair pushed by 1: u = 1/2, 3/2; of the second by 2: u = 1/2, 5/2.
    #[test]
    fn loads_rows_and_displacements_go_by_the_numbers() {
        for (numbers, f) in [
            (None, vec![0.0, 1.0, 0.0, 2.0]),
            (Some([[6, 2], [0, 3]]), vec![0.0, f64::NAN, 1.0, 2.0, f64::NAN, 0.0, 0.0, 9.0]),
        ] {
            let mut problem = pairs();
            let place = |body: usize, dof: usize| {
                numbers.map_or(2 * body + dof, |numbers: [[i64; 2]; 2]| numbers[body][dof] as usize)
            };
            for (body, numbers) in numbers.iter().flatten().enumerate() {
                problem.set_numbering(body, numbers).unwrap();
            }
            problem.set_all_loads(&f).unwrap();
            let mut bad = f.clone();
            bad[place(1, 1)] = f64::INFINITY;
            let error = problem.set_all_loads(&bad).unwrap_err();
            assert_eq!(
                (error.place.body, error.place.dof, error.place.entry),
                (Some(1), Some(1), Some(place(1, 1)))
            );
            let dof = [place(1, 1) as i64, place(0, 1) as i64];
            let far = RowsInput { ptr: &[0, 2], body: None, dof: &dof, val: &[1.0, -1.0], rhs: Some(&[9.0]) };
            problem.add_rows(RowKind::Inequality, far).unwrap();
            assert_eq!(problem.contact.matrix.row(0).collect::<Vec<_>>(), [(1, -1.0), (3, 1.0)]);
            let nobody = RowsInput { dof: &[place(0, 0) as i64, 11], ..far };
            let error = problem.add_rows(RowKind::Inequality, nobody).unwrap_err();
            assert_eq!(
                (error.kind, error.place.row, error.place.entry),
                (Kind::Argument("dof"), Some(0), Some(1))
            );
            problem.solve().unwrap();
            let mut u = vec![7.0; f.len()];
            problem.spread(problem.displacements().unwrap(), |at, v| u[at] = v).unwrap();
            for (body, dof, by_hand) in [(0, 0, 0.5), (0, 1, 1.5), (1, 0, 0.5), (1, 1, 2.5)] {
                assert!((u[place(body, dof)] - by_hand).abs() < 1e-12, "{u:?}");
            }
            assert_eq!(u.iter().filter(|v| **v == 7.0).count(), f.len() - 4);
        }
    }
}
