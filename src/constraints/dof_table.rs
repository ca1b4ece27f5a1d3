//! Unknowns of the host that its K does not have: supports and combinations of other unknowns (multi-point constraints). With v the unknowns
//! of K, all unknowns of the host are `u = T v + g`.

use std::collections::HashMap;

use crate::constraints::entries::summed;
use crate::error::{Error, Result, INDEX};
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{first_non_finite, NOISE};
use crate::linalg::Csr;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the table of unknowns";

/// The table as given, an entry for each unknown of the host: `u_i = constant_i + sum_k coefficient_k u_term(k)` where `number_i` < 0.
#[derive(Debug, Clone, Copy)]
pub struct DofTableInput<'a> {
    /// Number of the unknown of K, from 0; negative: eliminated.
    pub number: &'a [i64],
    /// Terms `ptr[i]` to `ptr[i + 1]` belong to unknown i; none has any if absent.
    pub ptr: Option<&'a [usize]>,
    /// Unknown of the host, from 0, which may be eliminated itself.
    pub term: &'a [i64],
    pub coefficient: &'a [f64],
    /// Length; zeros if absent.
    pub constant: Option<&'a [f64]>,
}

/// The table without chains.
#[derive(Debug, Clone)]
pub struct DofTable {
    /// T, (unknowns of the host) x (unknowns of K).
    pub terms: Csr,
    /// g, length.
    pub constants: Vec<f64>,
    /// Place in K of the unknowns that are not eliminated.
    pub places: Vec<Option<usize>>,
}

impl DofTable {
    /// `place`: where K has the unknown with a number, if it has it.
    pub fn resolve(input: DofTableInput<'_>, place: impl Fn(usize) -> Option<usize>) -> Result<Self> {
        let n = input.number.len();
        let mut places: Vec<Option<usize>> = reserved(n, WHAT)?;
        let mut seen = HashMap::new();
        for (i, &number) in input.number.iter().enumerate() {
            let Ok(number) = usize::try_from(number) else {
                places.push(None);
                continue;
            };
            if let Some(other) = seen.insert(number, i) {
                let what =
                    format!("unknown {other} of the table has this number, too: couple them by a term");
                return Err(Error::argument("number", what).entry(i).index(number as i64));
            }
            let known = place(number).ok_or_else(|| {
                let what = format!("no unknown of K has the number {INDEX}");
                Error::argument("number", what).entry(i).index(number as i64)
            })?;
            places.push(Some(known));
        }
        input.check(n)?;
        let mut found: Vec<Vec<(usize, f64)>> = filled(n, Vec::new(), WHAT)?;
        let mut constants = filled(n, 0.0, WHAT)?;
        for i in input.order(n)?.into_iter().filter(|i| places[*i].is_none()) {
            let mut constant = Twofold::from(input.constant(i));
            let mut entries = Vec::new();
            for (_, term, by) in input.terms(i) {
                constant.add_product(by, constants[term]);
                entries.extend(places[term].map(|place| (place, by)));
                entries.extend(found[term].iter().map(|(place, v)| (*place, by * v)));
            }
            let noise = summed(&mut entries);
            entries.retain(|entry| entry.1.abs() > noise);
            constants[i] = constant.value();
            if !constants[i].is_finite() || entries.iter().any(|entry| !entry.1.is_finite()) {
                return Err(
                    Error::argument("coefficient", "the sum of the terms is not a finite number").entry(i)
                );
            }
            found[i] = entries;
        }
        let mut terms = Csr::empty(0);
        for (place, entries) in places.iter().zip(found) {
            terms.push_row(place.map(|place| (place, 1.0)).into_iter().chain(entries));
        }
        Ok(Self { terms, constants, places })
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// `rhs - b g` of a row with entries b over the unknowns of the host. A row that has no unknown of K holds up to its rounding, and one that
    /// never closes stays so.
    pub fn right_hand_side(&self, row: impl Iterator<Item = (usize, f64)>, rhs: f64) -> f64 {
        if rhs.is_infinite() {
            return rhs;
        }
        let (mut left, mut terms, mut is_free) = (Twofold::from(rhs), rhs.abs(), true);
        for (i, b) in row {
            left.add_product(-b, self.constants[i]);
            terms += (b * self.constants[i]).abs();
            is_free &= self.terms.row(i).next().is_none();
        }
        let left = left.value();
        if is_free && left.abs() <= NOISE * terms {
            0.0
        } else {
            left
        }
    }

    /// `u_i = (T v + g)_i`
    pub fn value(&self, i: usize, v: &[f64]) -> f64 {
        self.terms.row(i).fold(self.constants[i], |sum, (place, t)| sum + t * v[place])
    }
}

impl DofTableInput<'_> {
    fn constant(&self, i: usize) -> f64 {
        self.constant.map_or(0.0, |constant| constant[i])
    }

    /// Entry, unknown and coefficient of the terms of unknown i.
    fn terms(&self, i: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let range = self.ptr.map_or(0..0, |ptr| ptr[i]..ptr[i + 1]);
        range.map(|at| (at, self.term[at] as usize, self.coefficient[at]))
    }

    fn check(&self, n: usize) -> Result<()> {
        if let Some(at) = first_non_finite(self.coefficient) {
            return Err(Error::argument("coefficient", "the entry is not a finite number").entry(at));
        }
        if let Some(at) = self.constant.and_then(first_non_finite) {
            return Err(Error::argument("constant", "the entry is not a finite number").entry(at));
        }
        if let Some(at) = self.term.iter().position(|term| !usize::try_from(*term).is_ok_and(|term| term < n))
        {
            let what = format!("unknown {INDEX} is outside the {n} unknowns of the table");
            return Err(Error::argument("term", what).entry(at).index(self.term[at]));
        }
        for i in (0..n).filter(|i| self.number[*i] >= 0) {
            if let Some((at, ..)) = self.terms(i).next() {
                let what = format!("unknown {i} of the table has a number of K: it has no terms");
                return Err(Error::argument("term", what).entry(at));
            }
            if self.constant(i) != 0.0 {
                let what = "this unknown has a number of K: its constant is 0";
                return Err(Error::argument("constant", what).entry(i).value(self.constant(i)));
            }
        }
        Ok(())
    }

    /// The unknowns in an order in which each comes after its terms.
    fn order(&self, n: usize) -> Result<Vec<usize>> {
        let mut order: Vec<usize> = reserved(n, WHAT)?;
        let mut missing = filled(n, 0, WHAT)?;
        let mut users: Vec<Vec<usize>> = filled(n, Vec::new(), WHAT)?;
        for i in 0..n {
            for (_, term, _) in self.terms(i) {
                missing[i] += 1;
                users[term].push(i);
            }
        }
        order.extend((0..n).filter(|i| missing[*i] == 0));
        let mut at = 0;
        while at < order.len() {
            for &user in &users[order[at]] {
                missing[user] -= 1;
                if missing[user] == 0 {
                    order.push(user);
                }
            }
            at += 1;
        }
        match (0..n).find(|i| missing[*i] > 0) {
            None => Ok(order),
            Some(first) => Err(self.circle(first, &missing)),
        }
    }

    /// The circle that one meets from an unknown with terms that are missing.
    fn circle(&self, first: usize, missing: &[usize]) -> Error {
        let (mut path, mut i) = (Vec::new(), first);
        while !path.contains(&i) {
            path.push(i);
            i = self.terms(i).map(|(_, term, _)| term).find(|term| missing[*term] > 0).unwrap_or(i);
        }
        let begin = path.iter().position(|other| *other == i).unwrap_or(0);
        let names: Vec<String> = path[begin..].iter().take(8).map(|i| format!("{i}")).collect();
        let what = format!("unknowns of the table depend on each other in a circle: {}", names.join(", "));
        Error::argument("term", what).entry(i)
    }
}
