//! The null space `R_p` found from the stiffness alone, and `K_p+` from the same factor.
//!
//! In every connected part some dofs t, spread over it, are eliminated last, each on a spring of the stiffness it has
//! already: `K + E D_tt E'` is regular as soon as t resists every motion of the null space. The end of its factor is
//! `S + D_tt`, S the Schur complement of K on t. With the diagonal scaled to 1 the null vectors of S are those of K at t.
//! Then some dofs of t are held in place of all springs: only the dense block of t changes.

use std::sync::Arc;

use crate::body::factor::Factor;
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::null_space::{largest, verified, Modes, NullSpaceInput, Verified};
use crate::body::overflow::refuse_overflow;
use crate::body::probe::SINGULAR;
use crate::body::symbolic::{Layout, Made, Symbolic};
use crate::error::{Error, Kind, Result};
use crate::linalg::graph::components;
use crate::linalg::memory::{copied, reserved, room, PRODUCTS};
use crate::linalg::spd::symmetric_eigen;
use crate::linalg::trailing::Trailing;
use crate::linalg::{Analysis, Breakdown, Cholesky, Matrix, Multiple, Symmetric};

/// Dofs eliminated last in each part, at first.
const LAST: usize = 24;
/// More than this in one part are not tried.
const MOST: usize = 400;
/// An eigenvalue of the scaled S below this against the largest may belong to the null space.
const SOFT: f64 = 1e-11;
/// Least ratio between the stiffest motion of the null space and the softest of the others.
const GAP: f64 = 1e3;
/// Eigenvalues below this against the largest are rounding.
const ROUNDING: f64 = 1e-14;
/// Bytes of labels, lists and vectors, per dof.
const PER_DOF: usize = 256;

pub struct Search {
    k: Multiple,
    tolerance: f64,
    fixing: Option<Vec<usize>>,
    /// The dofs t of every part, and all dofs of it.
    last: Vec<Vec<usize>>,
    members: Vec<Vec<usize>>,
    /// Entries of K between the parts.
    between: Vec<usize>,
    /// Dofs wanted in t of each part.
    count: usize,
    /// What the analysis depends on besides the pattern of K.
    pub(super) layout: Arc<Layout>,
    pub(super) symbolic: Option<Arc<Symbolic>>,
}

/// What one part moves like without stiffness.
struct Soft {
    schur: Matrix,
    /// m x r, the null vectors at t times D^1/2, orthonormal.
    vectors: Matrix,
    gap: f64,
}

/// An attempt ends with K+, or at a dof that t must have.
enum Attempt {
    Done(Box<GeneralizedInverse>),
    Missed(usize),
}

impl Search {
    /// `fixing`: the dofs to hold in K+, where the host has given them.
    pub fn new(k: Multiple, tolerance: f64, fixing: Option<&[usize]>) -> Result<Self> {
        let _room = room(k.order() * PER_DOF, "the connected parts of a body")?;
        let (part_of, parts) = components(&k.matrix);
        let mut members = vec![Vec::new(); parts];
        part_of.iter().enumerate().for_each(|(dof, &part)| members[part].push(dof));
        let mut last = vec![Vec::new(); parts];
        fixing.unwrap_or_default().iter().for_each(|&dof| last[part_of[dof]].push(dof));
        let between = between_parts(&k.matrix, &part_of)?;
        Self::with(k, tolerance, fixing.map(<[usize]>::to_vec), (members, last, between), LAST)
    }

    /// `last`: the dofs that t has in any case.
    fn with(
        k: Multiple,
        tolerance: f64,
        fixing: Option<Vec<usize>>,
        (members, mut last, between): (Vec<Vec<usize>>, Vec<Vec<usize>>, Vec<usize>),
        count: usize,
    ) -> Result<Self> {
        for (members, last) in members.iter().zip(&mut last) {
            last.extend(spread(members, count));
            last.sort_unstable();
            last.dedup();
        }
        let left_out = copied(&between, "the connected parts of a body")?;
        let layout = Arc::new(Layout::Last { dofs: last.clone(), between: left_out });
        Ok(Self { k, tolerance, fixing, last, members, between, count, layout, symbolic: None })
    }

    pub fn analyse(&self) -> Result<Arc<Analysis>> {
        let supported = supported(&self.k, &self.last, &self.between)?;
        Ok(Arc::new(Analysis::ending(&self.k.matrix, &supported, &self.last.concat())?))
    }

    /// Tries with more dofs t until none is missed.
    pub fn execute(mut self) -> Result<Made> {
        let (mut factorisations, mut further_analyses) = (0, 0);
        loop {
            let symbolic = match self.symbolic.take() {
                Some(symbolic) => symbolic,
                None => {
                    further_analyses += 1;
                    Arc::new(Symbolic { layout: Arc::clone(&self.layout), analysis: self.analyse()? })
                }
            };
            factorisations += 1;
            match self.attempt(&symbolic.analysis)? {
                Attempt::Done(inverse) => {
                    return Ok(Made { inverse: *inverse, symbolic, further_analyses, factorisations })
                }
                Attempt::Missed(dof) if 2 * self.count > MOST => {
                    let what = format!(
                        "the null space could not be found with {} dofs of each part: give it, or coordinates",
                        self.count
                    );
                    return Err(Error::new(Kind::NullSpace, what).dof(dof));
                }
                Attempt::Missed(dof) => {
                    if let Some(part) = self.members.iter().position(|all| all.binary_search(&dof).is_ok()) {
                        self.last[part].push(dof);
                    }
                    let parts = (self.members, self.last, self.between);
                    self = Self::with(self.k, self.tolerance, self.fixing, parts, 2 * self.count)?;
                }
            }
        }
    }

    fn attempt(&self, analysis: &Arc<Analysis>) -> Result<Attempt> {
        let supported = supported(&self.k, &self.last, &self.between)?;
        let factor = match analysis.factorize(&supported, 1.0)? {
            Ok(factor) => factor,
            Err(breakdown) => return missed_or_indefinite(breakdown),
        };
        let unsupported = |(dof, pivot): &(usize, f64)| *pivot < SINGULAR * supported.diagonal(*dof);
        if let Some((dof, _)) = factor.pivots().find(unsupported) {
            return Ok(Attempt::Missed(dof));
        }
        drop(supported);
        let mut soft = reserved(self.last.len(), "the null space of a body")?;
        for (last, members) in self.last.iter().zip(&self.members) {
            let part = self.soft(&factor, last)?;
            if 2 * part.vectors.cols > last.len() && last.len() < members.len() {
                return Ok(Attempt::Missed(last[0]));
            }
            soft.push(part);
        }
        let vectors = self.vectors(&factor, &soft)?;
        match self.inverse(factor, &soft, vectors) {
            Err(Error { kind: Kind::NullSpace, place, .. })
                if place.dof.is_some_and(|dof| self.may_take(dof)) =>
            {
                Ok(Attempt::Missed(place.dof.unwrap_or(0)))
            }
            done => done.map(|inverse| Attempt::Done(Box::new(inverse))),
        }
    }

    /// Whether t does not have this dof yet.
    fn may_take(&self, dof: usize) -> bool {
        self.last.iter().all(|last| last.binary_search(&dof).is_err())
    }

    /// The eigenvalues of `D_tt^-1/2 S D_tt^-1/2` of one part, cut where they leap.
    fn soft(&self, factor: &Cholesky, last: &[usize]) -> Result<Soft> {
        let m = last.len();
        let mut schur = factor.trailing(last)?;
        let d = |i: usize| self.k.metric(last[i], 1.0);
        (0..m).for_each(|i| schur.set(i, i, schur.get(i, i) - d(i)));
        let mut scaled = Matrix::zeros(m, m)?;
        for j in 0..m {
            (0..m).for_each(|i| scaled.set(i, j, schur.get(i, j) / (d(i) * d(j)).sqrt()));
        }
        refuse_overflow(&scaled.data, |at| last[at % m])?;
        let (values, mut vectors) = symmetric_eigen(&scaled)?;
        let stiffest = values[m - 1];
        let worst = largest(vectors.col(0), |_| 1.0);
        let relative_pivot = values[0] / stiffest.abs().max(1.0);
        if let Some(indefinite) = (Breakdown { dof: last[worst], relative_pivot }).refused() {
            return Err(indefinite);
        }
        let Some((dimension, gap)) = cut(&values) else {
            let what = format!(
                "the null space cannot be told from soft motions: no gap of {GAP:.0e} below {SOFT:.0e} of the \
                 largest stiffness; give it, or coordinates"
            );
            return Err(Error::new(Kind::NullSpace, what).dof(last[worst]).value(values[0] / stiffest));
        };
        vectors.data.truncate(m * dimension);
        vectors.cols = dimension;
        Ok(Soft { schur, vectors, gap })
    }

    /// R: the null vectors of S at t, extended without forces at the other dofs, n x r.
    fn vectors(&self, factor: &Cholesky, soft: &[Soft]) -> Result<Matrix> {
        let mut ends = reserved(soft.len(), "a null space")?;
        for (part, last) in soft.iter().zip(&self.last) {
            let mut end = part.vectors.clone();
            let root = |dof: usize| self.k.metric(dof, 1.0).sqrt();
            for j in 0..end.cols {
                end.col_mut(j).iter_mut().zip(last).for_each(|(v, &dof)| *v /= root(dof));
            }
            ends.push(end);
        }
        let parts: Vec<_> = self.last.iter().map(Vec::as_slice).zip(&ends).collect();
        factor.extended(&parts)
    }

    /// K+ from the same factor: r of the dofs t held, the others without their springs.
    fn inverse(&self, factor: Cholesky, soft: &[Soft], vectors: Matrix) -> Result<GeneralizedInverse> {
        let n = self.k.order();
        let _room = room((8 * vectors.cols + 24) * n * size_of::<f64>() + PRODUCTS, "a null space")?;
        let root = self.k.roots()?;
        let fixing = self.fixing_of(soft, &vectors, &root)?;
        let parts: Vec<Trailing<'_>> = (self.last.iter().zip(soft).zip(&fixing))
            .map(|((dofs, part), held)| Trailing { dofs, schur: &part.schur, held })
            .collect();
        let factor = factor.holding(&parts)?.map_err(|dof| {
            let what = "the stiffness matrix is singular with the fixing dofs of its null space held";
            Error::new(Kind::NullSpace, what).dof(dof)
        })?;
        let gap = soft.iter().map(|part| part.gap).reduce(f64::min);
        let found = NullSpaceInput { vectors, modes: Modes::Exact };
        let Verified { basis: null_space, error } = verified(&self.k, &root, &found, self.tolerance)?;
        let mut inverse = GeneralizedInverse {
            null_space,
            rounding: error,
            error,
            fixing: fixing.concat(),
            gap,
            softness: 1.0,
            factor: Factor::Own(Arc::new(factor)),
        };
        inverse.softness = inverse.probe(&self.k)?;
        inverse.rounding = inverse.known_to(&self.k)?;
        inverse.error = inverse.rounding;
        Ok(inverse)
    }

    /// The fixing dofs of every part.
    fn fixing_of(&self, soft: &[Soft], vectors: &Matrix, root: &[f64]) -> Result<Vec<Vec<usize>>> {
        if let Some(given) = &self.fixing {
            let given = given_dofs(vectors, root, given)?;
            let among = |last: &Vec<usize>| given.iter().copied().filter(|dof| last.contains(dof)).collect();
            return Ok(self.last.iter().map(among).collect());
        }
        let chosen = |(part, last): (&Soft, &Vec<usize>)| {
            let ones = vec![1.0; last.len()];
            let chosen = fixing_dofs(&part.vectors, &ones)?;
            Ok(chosen.into_iter().map(|at| last[at]).collect())
        };
        soft.iter().zip(&self.last).map(chosen).collect()
    }
}

/// A pivot that is not positive: K is indefinite, or t does not resist a motion of the null space.
fn missed_or_indefinite(breakdown: Breakdown) -> Result<Attempt> {
    match breakdown.refused() {
        Some(indefinite) => Err(indefinite),
        None => Ok(Attempt::Missed(breakdown.dof)),
    }
}

/// Dimension of the null space and the ratio of the stiffness beyond it to that within, from ascending eigenvalues of a
/// matrix of unit diagonal or a Schur complement of it; `None` where some are soft and none stands apart.
fn cut(values: &[f64]) -> Option<(usize, f64)> {
    let m = values.len();
    let stiffest = values[m - 1];
    if stiffest <= ROUNDING {
        return Some((m, ROUNDING.recip()));
    }
    let relative = |k: usize| (values[k] / stiffest).max(ROUNDING);
    if relative(0) >= SOFT {
        return Some((0, relative(0) / ROUNDING));
    }
    let gaps = (1..m).filter(|&k| relative(k - 1) < SOFT).map(|k| (k, relative(k) / relative(k - 1)));
    gaps.reduce(|best, gap| if gap.1 > best.1 { gap } else { best }).filter(|(_, gap)| *gap >= GAP)
}

/// One of the dofs from each of `count` stretches of equal length, at random with a fixed seed; all when there are no more.
fn spread(dofs: &[usize], count: usize) -> Vec<usize> {
    let (n, mut state) = (dofs.len(), 0x9e37_79b9_7f4a_7c15_u64);
    if n <= count {
        return dofs.to_vec();
    }
    (0..count)
        .map(|k| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let (begin, end) = (k * n / count, (k + 1) * n / count);
            dofs[begin + (state >> 33) as usize % (end - begin)]
        })
        .collect()
}

/// Positions of the entries of K between different parts: all of them are 0.
fn between_parts(k: &Symmetric, part_of: &[usize]) -> Result<Vec<usize>> {
    let row =
        |i: usize| (k.ptr[i]..k.ptr[i + 1]).filter(move |&at| part_of[k.col[at] as usize] != part_of[i]);
    let mut found = reserved((0..k.order()).flat_map(row).count(), "the connected parts of a body")?;
    found.extend((0..k.order()).flat_map(row));
    Ok(found)
}

/// `K + E D_tt E'` without the entries between parts, all dofs t of one part coupled.
fn supported(k: &Multiple, last: &[Vec<usize>], between: &[usize]) -> Result<Symmetric> {
    const WHAT: &str = "a supported stiffness matrix";
    let mut mates: Vec<&[usize]> = reserved(k.order(), WHAT)?;
    mates.resize(k.order(), &[]);
    last.iter().for_each(|last| last.iter().for_each(|&dof| mates[dof] = last));
    let coupled: usize = last.iter().map(|last| last.len() * (last.len() + 1) / 2).sum();
    let mut ptr = reserved(k.order() + 1, WHAT)?;
    let mut col = reserved(k.matrix.col.len() + coupled, WHAT)?;
    let mut val = reserved(k.matrix.col.len() + coupled, WHAT)?;
    ptr.push(0);
    let (mut row, mut left_out) = (Vec::new(), between.iter().copied().peekable());
    for i in 0..k.order() {
        row.clear();
        let kept = k.matrix.ptr[i]..k.matrix.ptr[i + 1];
        let kept = kept.filter(|at| left_out.next_if_eq(at).is_none());
        row.extend(kept.map(|at| (k.matrix.col[at] as usize, k.by * k.matrix.val[at])));
        let earlier = mates[i].iter().copied().take_while(|&j| j < i);
        if !mates[i].is_empty() {
            let found = row.len();
            for j in earlier {
                if row[..found].binary_search_by_key(&j, |entry| entry.0).is_err() {
                    row.push((j, 0.0));
                }
            }
            row.sort_unstable_by_key(|entry| entry.0);
            row.last_mut().into_iter().for_each(|diagonal| diagonal.1 += k.metric(i, 1.0));
        }
        col.extend(row.iter().map(|entry| entry.0 as u32));
        val.extend(row.iter().map(|entry| entry.1));
        ptr.push(col.len());
    }
    Ok(Symmetric::new(ptr, col, val))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_null_space_ends_at_the_largest_leap_below_the_soft_limit() {
        assert_eq!(cut(&[0.1, 0.5, 1.0]).map(|c| c.0), Some(0));
        assert_eq!(cut(&[-1e-17, 1e-16, 1e-4, 1.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[1e-20, 1e-16, 1e-9, 1e-4, 1.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[0.0, 0.0]).map(|c| c.0), Some(2));
        assert_eq!(cut(&[3e-13, 2e-12, 3e-11, 4e-10, 1.0]), None);
    }

    #[test]
    fn the_dofs_chosen_are_spread_and_never_the_same_twice() {
        let all: Vec<usize> = (0..1000).map(|i| 3 * i).collect();
        let chosen = spread(&all, LAST);
        assert!(chosen.len() == LAST && chosen.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(spread(&all[..7], LAST), all[..7]);
    }
}
