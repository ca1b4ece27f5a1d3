//! The answer of least travel, among all answers that differ by motions which nothing resists:
//!
//! ```text
//! u = v + R b + N a,   a = argmin |u|_D   subject to   B u <= c + C lambda
//! ```
//!
//! v is the deformation and R b the rigid motion of the given answer; N = R A are the motions that rows with lambda > 0 and
//! equality rows do not resist, exactly 0 on grounded unknowns where they are rounding. The answer is unique and does not depend
//! on the choice of K+. No matrix over all unknowns is formed.

use std::ops::Range;

use crate::body::{Distributed, Kept, Locals};
use crate::constraints::Touched;
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::vector::{axpy, dot, NOISE};
use crate::linalg::{Csr, Matrix};
use crate::numbers::linalg::DEPENDENT;
use crate::qp::{nearest_point, Polyhedron};
use crate::solve::local::{FreeMotions, FreeMotionsAtRows, Place};

/// The second pass removes the rounding of a long first travel.
const PASSES: usize = 2;

/// Free motions, and the rows that restrict them.
pub struct OpenMotions<'a> {
    /// Bodies in ascending order of modes.
    pub bodies: &'a Locals<'a>,
    /// The modes of each body among all modes.
    pub modes: &'a [Range<usize>],
    /// Accuracy of R_p, relative to the fastest dof of each vector.
    pub rounding: f64,
    /// A: amplitudes of the null spaces, r x d.
    pub amplitudes: &'a Matrix,
    /// Unknowns that rows touch.
    pub touched: &'a Touched,
    /// Contact rows B over these, their gaps c (infinite: never closed), compliance C and forces lambda. Rows with
    /// lambda > 0 resist no motion of N and are ignored.
    pub rows: &'a Csr,
    pub gaps: &'a [f64],
    pub compliance: &'a [f64],
    pub lambda: &'a [f64],
}

/// The answer of least travel.
pub struct Rest {
    pub u: Distributed,
    /// Of the null spaces, over all modes.
    pub amplitudes: Vec<f64>,
}

/// The answer of least travel from `deformed` + R `amplitudes` on. Only their sum moves u: a far way there and back leaves nothing.
pub fn travel(open: &OpenMotions, deformed: &Kept, mut amplitudes: Vec<f64>) -> Result<Rest> {
    let (of_bodies, motions_kept) = open.bodies.make(|_| FreeMotions { rounding: open.rounding }, ())?;
    let groups = open.orthonormal(&of_bodies)?;
    let of_motion: Vec<(usize, usize)> = groups
        .iter()
        .enumerate()
        .flat_map(|(g, group)| (0..group.motions.cols).map(move |j| (g, j)))
        .collect();
    let motions = open.along_rows(&of_bodies, &groups);
    // u, and R'D u over all modes
    let placed = |amplitudes: &[f64]| -> Result<(Distributed, Vec<f64>)> {
        let place = |p: usize| Place { a: amplitudes[open.modes[p].clone()].to_vec() };
        let (answers, of) = open.bodies.make(place, (&motions_kept, deformed))?;
        let (at_rows, spent): (Vec<_>, Vec<_>) = answers.into_iter().unzip();
        Ok((Distributed::new((at_rows, of)), spent.concat()))
    };
    let (mut u, mut spent) = placed(&amplitudes)?;
    for _ in 0..PASSES {
        let target: Vec<f64> = of_motion.iter().map(|&(g, j)| -groups[g].dot(j, &spent)).collect();
        let (gap, noise) = open.left(&u.at_rows);
        let within =
            Polyhedron { rows: &motions, gap: &gap, target: &target, noise: &noise, rounding: NOISE };
        let a = nearest_point(within)?.point;
        of_motion.iter().zip(&a).for_each(|(&(g, j), a)| groups[g].add(*a, j, &mut amplitudes));
        (u, spent) = placed(&amplitudes)?;
    }
    Ok(Rest { u, amplitudes })
}

/// D-orthonormal motions of bodies that move together.
struct MotionGroup {
    /// Modes of these bodies, ascending.
    modes: Vec<usize>,
    /// Amplitudes of `modes`, one column per motion.
    motions: Matrix,
    /// Number of the first motion of the group among all motions.
    first: usize,
}

impl MotionGroup {
    /// `A_j'v`
    fn dot(&self, j: usize, v: &[f64]) -> f64 {
        self.modes.iter().zip(self.motions.col(j)).map(|(&mode, a)| a * v[mode]).sum()
    }

    /// `v += a A_j`
    fn add(&self, a: f64, j: usize, v: &mut [f64]) {
        self.modes.iter().zip(self.motions.col(j)).for_each(|(&mode, m)| v[mode] += a * m);
    }
}

impl OpenMotions<'_> {
    /// Motions in groups that share bodies, `A'R'D R A = I`.
    fn orthonormal(&self, of_bodies: &[FreeMotionsAtRows]) -> Result<Vec<MotionGroup>> {
        let (a, mut moved_by) = (self.amplitudes, vec![Vec::new(); self.modes.len()]);
        for j in 0..a.cols {
            for (moved, modes) in moved_by.iter_mut().zip(self.modes) {
                if a.col(j)[modes.clone()].iter().any(|v| *v != 0.0) {
                    moved.push(j);
                }
            }
        }
        let (group_of, count) = joined(a.cols, moved_by.iter().map(|moved| moved.iter().copied()));
        let mut groups: Vec<(Vec<usize>, Vec<usize>)> = vec![Default::default(); count];
        (0..a.cols).for_each(|j| groups[group_of[j]].1.push(j));
        for (p, moved) in moved_by.iter().enumerate().filter(|(_, moved)| !moved.is_empty()) {
            groups[group_of[moved[0]]].0.push(p);
        }
        let (mut done, mut first) = (Vec::with_capacity(count), 0);
        for (bodies, columns) in groups {
            let group = self.orthonormal_group(of_bodies, &bodies, &columns, first)?;
            first += group.motions.cols;
            done.push(group);
        }
        Ok(done)
    }

    fn orthonormal_group(
        &self,
        of_bodies: &[FreeMotionsAtRows],
        bodies: &[usize],
        columns: &[usize],
        first: usize,
    ) -> Result<MotionGroup> {
        let modes: Vec<usize> = bodies.iter().flat_map(|&p| self.modes[p].clone()).collect();
        let (mut grams, mut start) = (Vec::with_capacity(bodies.len()), 0);
        for &p in bodies {
            let gram = &of_bodies[p].gram;
            grams.push((start, gram));
            start += gram.cols;
        }
        // R'D R a
        let image = |a: &[f64]| -> Vec<f64> {
            let mut image = vec![0.0; a.len()];
            for (start, gram) in &grams {
                let own = *start..*start + gram.rows;
                gram.mul_add(1.0, &a[own.clone()], &mut image[own]);
            }
            image
        };
        let mut motions = Matrix { rows: modes.len(), ..Matrix::default() };
        let mut images = motions.clone();
        for &j in columns {
            let mut column: Vec<f64> = modes.iter().map(|&mode| self.amplitudes.col(j)[mode]).collect();
            let before = dot(&column, &image(&column)).sqrt();
            for _ in 0..2 {
                for k in 0..motions.cols {
                    let part = dot(images.col(k), &column);
                    axpy(-part, motions.col(k), &mut column);
                }
            }
            let length = dot(&column, &image(&column)).max(0.0).sqrt();
            if length > DEPENDENT * before {
                column.iter_mut().for_each(|v| *v /= length);
                images.push_col(&image(&column));
                motions.push_col(&column);
            }
        }
        Ok(MotionGroup { modes, motions, first })
    }

    /// `B N` without entries that are rounding; rows with lambda > 0 are empty.
    fn along_rows(&self, of_bodies: &[FreeMotionsAtRows], groups: &[MotionGroup]) -> Csr {
        let modes = self.amplitudes.rows;
        let (mut at, mut fastest) = (vec![None; modes], vec![0.0; modes]);
        for (g, group) in groups.iter().enumerate() {
            group.modes.iter().enumerate().for_each(|(k, &mode)| at[mode] = Some((g, k)));
        }
        for (modes, of_body) in self.modes.iter().zip(of_bodies) {
            modes.clone().zip(&of_body.fastest).for_each(|(mode, of)| fastest[mode] = *of);
        }
        let mut all = Csr::empty(groups.iter().map(|group| group.motions.cols).sum());
        for i in 0..self.rows.rows() {
            // terms of `b_i R`: mode, value, accuracy
            let mut terms: Vec<(usize, f64, f64)> = Vec::new();
            for (unknown, b) in self.rows.row(i).filter(|_| self.lambda[i] <= 0.0) {
                let p = self.touched.body_of(unknown);
                let place = unknown - self.touched.range(p).start;
                for (j, mode) in self.modes[p].clone().enumerate().filter(|(_, mode)| at[*mode].is_some()) {
                    let value = b * of_bodies[p].at_rows.get(place, j);
                    let known = self.rounding.max(NOISE) * b.abs() * fastest[mode];
                    match terms.iter_mut().find(|term| term.0 == mode) {
                        Some(term) => (term.1, term.2) = (term.1 + value, term.2 + known),
                        None => terms.push((mode, value, known)),
                    }
                }
            }
            all.push_row(row_of(&terms, &at, groups));
        }
        all
    }

    /// `c + C lambda - B u` and its rounding, u where rows touch; rows with lambda > 0 and infinite gaps do not restrict.
    fn left(&self, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut gaps, mut noise) = (vec![f64::INFINITY; self.rows.rows()], vec![0.0; self.rows.rows()]);
        let restricts = |i: &usize| self.lambda[*i] <= 0.0 && self.gaps[*i] < f64::INFINITY;
        for i in (0..self.rows.rows()).filter(restricts) {
            let yielded = self.compliance[i] * self.lambda[i];
            gaps[i] = self.gaps[i] + yielded - self.rows.row_dot(i, u);
            noise[i] = NOISE * (self.gaps[i].abs() + yielded.abs() + self.rows.row_dot_abs(i, u));
        }
        (gaps, noise)
    }
}

/// `b_i R A` from the terms of `b_i R`, motions ascending.
fn row_of(
    terms: &[(usize, f64, f64)],
    at: &[Option<(usize, usize)>],
    groups: &[MotionGroup],
) -> Vec<(usize, f64)> {
    let mut touched: Vec<usize> = terms.iter().filter_map(|term| Some(at[term.0]?.0)).collect();
    touched.sort_unstable();
    touched.dedup();
    let mut row = Vec::new();
    for g in touched {
        for j in 0..groups[g].motions.cols {
            let (mut value, mut known) = (0.0, 0.0);
            for (mode, term, rounding) in terms {
                if let Some((_, k)) = at[*mode].filter(|(group, _)| *group == g) {
                    let a = groups[g].motions.get(k, j);
                    (value, known) = (value + term * a, known + rounding * a.abs());
                }
            }
            if f64::abs(value) > known {
                row.push((groups[g].first + j, value));
            }
        }
    }
    row
}

#[cfg(test)]
mod tests;
