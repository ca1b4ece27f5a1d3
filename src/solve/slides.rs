//! Motions along which rows with a force resist so little that this resistance may be the accuracy of the host's normals,
//! weights and coordinates.
//!
//! A closed row lets a body move by no more than deformations and gaps, `b (R alpha) = c - b w`. A body whose rigid motion
//! `v = R alpha` is far larger than the deformations w slides along all its rows that have a force, `|b v| << |b| v^`, and
//! so the answer itself shows such a motion. `v^ = D^-1 |K||v|` has no unit and does not vanish at the centre of a rotation.

use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::vector::{norm, ratio};
use crate::linalg::Csr;
use crate::numbers::linalg::WEAK;
use crate::numbers::solve::FAR;
use crate::platform::memory::zeros;
use crate::qp::AnswerFace;
use crate::setup::Ready;
use crate::solve::local::{Along, Split};
use crate::solve::recovery::{Ending, Recovery};

const WHAT: &str = "the slides of an answer";

/// A motion of bodies that slide together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slide {
    /// The largest `|b v| / |b| v^` of its rows with a force.
    pub resisted: f64,
    /// `|b| v^ / |b||w|`, summed over these rows.
    pub travel: f64,
    /// A body that slides, by its place in the island.
    pub body: usize,
    /// These rows resist the motion: otherwise it is undetermined, and rests.
    pub held: bool,
}

/// All slides of an answer, on different bodies.
pub struct Slides {
    pub all: Vec<Slide>,
    /// The slide of each body.
    of_body: Vec<Option<usize>>,
    /// v and v^ where rows touch; v is 0 on bodies that do not slide.
    v: Vec<f64>,
    size: Vec<f64>,
    /// |v|_D over the unknowns of each body without stiffness: with rows of length 1, it is a part of |b| v^ where these touch
    /// the body.
    loose: Vec<f64>,
    /// Amplitudes of v over the modes of the dual.
    amplitudes: Vec<f64>,
    /// Rows of the dual without force.
    held: Vec<bool>,
}

impl Recovery<'_> {
    pub fn slides(&self, ending: &Ending) -> Result<Slides> {
        let ready = self.ready;
        let (bodies, n) = (&self.data.bodies, self.data.touched.len());
        let mut slides = Slides {
            all: Vec::new(),
            of_body: vec![None; bodies.len()],
            v: zeros(n, WHAT)?,
            size: zeros(n, WHAT)?,
            loose: vec![0.0; bodies.len()],
            amplitudes: vec![0.0; ready.dual.modes()],
            held: Vec::new(),
        };
        let (mut moves, mut rest) = (vec![false; bodies.len()], Vec::with_capacity(n));
        for (p, parted) in bodies.ask(|_| Split, &ending.recovered.u.of)?.into_iter().enumerate() {
            rest.extend(parted.at_rows);
            moves[p] = parted.slides.is_some();
            let amplitudes = &mut slides.amplitudes[ready.dual.modes_of(p)];
            parted.slides.iter().for_each(|slides| amplitudes.copy_from_slice(slides));
        }
        if !moves.contains(&true) && self.scaled.along.is_empty() {
            return Ok(slides);
        }
        slides.held = self.without_force(&ending.recovered)?;
        self.evaluate(&mut slides, &moves, &rest)?;
        if slides.all.is_empty() && !self.scaled.along.is_empty() {
            // what the forces left of the load is left along rows that hardly resist it
            slides.amplitudes.clone_from(&self.scaled.along);
            let moved = |p: usize| slides.amplitudes[ready.dual.modes_of(p)].iter().any(|a| *a != 0.0);
            moves = (0..bodies.len()).map(moved).collect();
            rest.fill(0.0);
            self.evaluate(&mut slides, &moves, &rest)?;
        }
        if !slides.all.is_empty() {
            // the deformation of the rows is a part of this motion, too
            let before = std::mem::take(&mut slides.amplitudes);
            let mut motion = before.clone();
            for _ in 0..2 {
                motion = AnswerFace::of(&self.faces.qp, &slides.held)?.hardly_resisted(&motion)?;
            }
            for p in 0..bodies.len() {
                let modes = ready.dual.modes_of(p);
                let by = ratio(norm(&before[modes.clone()]), norm(&motion[modes.clone()]));
                motion[modes].iter_mut().for_each(|a| *a *= by);
            }
            slides.amplitudes = motion;
            moves.iter_mut().zip(&slides.of_body).for_each(|(moves, slide)| *moves = slide.is_some());
            self.evaluate(&mut slides, &moves, &rest)?;
        }
        Ok(slides)
    }

    /// Finds the slides among bodies that move along their amplitudes; `rest`: deformations where rows touch.
    fn evaluate(&self, slides: &mut Slides, moves: &[bool], rest: &[f64]) -> Result<()> {
        let (ready, rows, bodies) = (self.ready, &self.ready.rows.scaled, &self.data.bodies);
        slides.all.clear();
        slides.of_body.fill(None);
        let along = |p: usize| Along { a: moves[p].then(|| self.of_modes(p, &slides.amplitudes)) };
        for (p, moved) in bodies.make(along, ())?.0.into_iter().enumerate() {
            let range = self.data.touched.range(p);
            match moved {
                Some(moved) => {
                    slides.v[range.clone()].copy_from_slice(&moved.v);
                    slides.size[range].copy_from_slice(&moved.size);
                    slides.loose[p] = moved.loose;
                }
                None => {
                    slides.v[range].fill(0.0);
                    slides.amplitudes[ready.dual.modes_of(p)].fill(0.0);
                }
            }
        }
        // parts of row i on the bodies that move: body, b v, |b| v^
        let parts = |i: usize| {
            let mut parts: Vec<(usize, f64, f64)> = Vec::new();
            for (j, b) in rows.row(i) {
                let p = ready.island.touched.body_of(j);
                let (along, size) = (b * slides.v[j], b.abs() * slides.size[j]);
                match parts.last_mut().filter(|part| part.0 == p) {
                    Some(part) => (part.1, part.2) = (part.1 + along, part.2 + size),
                    None if moves[p] => parts.push((p, along, size + slides.loose[p])),
                    None => {}
                }
            }
            parts
        };
        let with_force: Vec<usize> = (0..rows.rows()).filter(|&i| !slides.held[i]).collect();
        let together = with_force.iter().map(|&i| {
            let parts = parts(i);
            let terms: f64 = parts.iter().map(|part| part.2).sum();
            let resists = parts.iter().any(|part| part.1.abs() > WEAK * terms);
            parts.into_iter().filter(move |_| resists).map(|part| part.0)
        });
        let (cluster, count) = joined(bodies.len(), together);
        let (mut resisted, mut moved, mut deformed) =
            (vec![0.0f64; count], vec![0.0; count], vec![0.0; count]);
        for &i in &with_force {
            let mut parts = parts(i);
            parts.iter_mut().for_each(|part| part.0 = cluster[part.0]);
            parts.sort_by_key(|part| part.0);
            let bent: f64 = rows.row(i).map(|(j, b)| (b * rest[j]).abs()).sum();
            for own in parts.chunk_by(|a, b| a.0 == b.0) {
                let (k, terms) = (own[0].0, own.iter().map(|part| part.2).sum::<f64>());
                let along = own.iter().map(|part| part.1).sum::<f64>().abs();
                resisted[k] = resisted[k].max(if along > 0.0 { along / terms } else { 0.0 });
                (moved[k], deformed[k]) = (moved[k] + terms, deformed[k] + bent);
            }
        }
        let resists = self.resists(slides, &cluster, count);
        let mut number = vec![None; count];
        for p in (0..bodies.len()).filter(|&p| moves[p]) {
            let k = cluster[p];
            if resisted[k] <= WEAK && moved[k] > FAR * deformed[k] {
                let travel = moved[k] / deformed[k];
                let slide = Slide { resisted: resisted[k], travel, body: p, held: resists[k] };
                slides.of_body[p] = Some(*number[k].get_or_insert_with(|| {
                    slides.all.push(slide);
                    slides.all.len() - 1
                }));
            }
        }
        Ok(())
    }

    /// Whether rows with a force resist the motion of a cluster at all: otherwise it is undetermined, and rests.
    fn resists(&self, slides: &Slides, cluster: &[usize], count: usize) -> Vec<bool> {
        let (dual, g) = (&self.ready.dual, self.faces.qp.g_transposed);
        let (mut resisting, mut size) = (vec![0.0; count], vec![0.0; count]);
        for i in (0..g.rows()).filter(|&i| !slides.held[i]) {
            let terms = g.row(i).map(|(mode, v)| {
                let body = dual.blocks.partition_point(|first| *first <= mode) - 1;
                (cluster[body], v * slides.amplitudes[mode])
            });
            let mut terms: Vec<(usize, f64)> = terms.filter(|term| term.1 != 0.0).collect();
            terms.sort_by_key(|term| term.0);
            for own in terms.chunk_by(|a, b| a.0 == b.0) {
                let along: f64 = own.iter().map(|term| term.1).sum();
                resisting[own[0].0] += along.abs();
                size[own[0].0] += own.iter().map(|term| term.1.abs()).sum::<f64>();
            }
        }
        let rounding = self.faces.qp.rounding;
        resisting.iter().zip(size).map(|(along, size)| *along > rounding * size).collect()
    }
}

impl Slides {
    /// The slide that travels farthest.
    pub fn worst(&self) -> Option<Slide> {
        let travelled = self.all.iter().copied().filter(|slide| slide.held && slide.travel < f64::INFINITY);
        travelled.max_by(|a, b| a.travel.total_cmp(&b.travel))
    }

    /// `G'` without the resistance to slides of at most `accuracy`: of rows with a force, and of other rows that resist no
    /// more. None if there is no such resistance.
    pub fn without_noise(&self, recovery: &Recovery, accuracy: f64) -> Option<Box<Csr>> {
        let (ready, dual) = (recovery.ready, &recovery.ready.dual);
        let is_noise = |slide: &usize| self.all[*slide].resisted <= accuracy;
        if !(0..self.all.len()).any(|slide| is_noise(&slide)) {
            return None;
        }
        let g = recovery.faces.qp.g_transposed;
        let slide_of = |mode: usize| {
            let body = dual.blocks.partition_point(|first| *first <= mode) - 1;
            self.of_body[body].filter(is_noise)
        };
        let (mut cleaned, mut changed) = (Csr::empty(g.cols), false);
        for i in 0..g.rows() {
            let mut row: Vec<(usize, f64)> = g.row(i).collect();
            let mut slides: Vec<usize> = row.iter().filter_map(|(mode, _)| slide_of(*mode)).collect();
            slides.dedup();
            for slide in slides {
                if self.held[i] && !self.is_weak(ready, i, slide, accuracy) {
                    continue;
                }
                let own = |mode: usize| slide_of(mode) == Some(slide);
                let (mut along, mut square, mut terms) = (0.0, 0.0, 0.0);
                for (mode, v) in row.iter().filter(|(mode, _)| own(*mode)) {
                    let a = self.amplitudes[*mode];
                    (along, square) = (along + v * a, square + a * a);
                    terms += f64::abs(v * a);
                }
                changed |= f64::abs(along) > recovery.faces.qp.rounding * terms;
                for (mode, v) in row.iter_mut().filter(|(mode, _)| own(*mode)) {
                    *v -= along / square * self.amplitudes[*mode];
                }
            }
            cleaned.push_row(row.into_iter().filter(|(_, v)| *v != 0.0));
        }
        changed.then(|| Box::new(cleaned))
    }

    /// Row i of the dual resists a slide by at most `accuracy` of its terms.
    fn is_weak(&self, ready: &Ready, i: usize, slide: usize, accuracy: f64) -> bool {
        if i >= ready.rows.matrix.rows() {
            return false;
        }
        let (mut along, mut terms) = (0.0, 0.0);
        for (j, b) in ready.rows.matrix.row(i) {
            let p = ready.island.touched.body_of(j);
            if self.of_body[p] == Some(slide) {
                (along, terms) = (along + b * self.v[j], terms + (b.abs() * self.size[j]).max(self.loose[p]));
            }
        }
        f64::abs(along) <= accuracy * terms
    }
}
