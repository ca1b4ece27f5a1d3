//! The direction in which planes cut a set of elements: the one that cuts through the fewest unknowns.

use super::incidence::{mixed, WHAT};
use crate::error::Result;
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::partition::Weighted;
use crate::linalg::Matrix;
use crate::numbers::cut::{FLAT, SLOPE, TIE};
use crate::platform::memory::reserved;

/// Number of elements in the sample for the choice of a direction, evenly from the set.
const SAMPLE: usize = 8192;

pub type Point = [f64; 3];
pub type Frame = [Point; 3];

pub const AXES: Frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A set of elements: the whole graph, the centre of each vertex, and the label of the vertices in the set.
pub struct Set<'a> {
    pub graph: &'a Weighted,
    pub centres: &'a [Point],
    pub label: &'a [u32],
    pub members: &'a [u32],
}

/// Lengths are counted in elements: 1 is one layer.
pub struct Choice {
    pub direction: Point,
    /// Along the direction, and along two others normal to it.
    pub lengths: Point,
}

impl Set<'_> {
    /// The best of the axes of coordinates, of the mesh (`of_mesh`) and of inertia; none if every plane has nearly all
    /// elements on one side.
    pub fn direction(&self, of_mesh: &Frame) -> Result<Option<Choice>> {
        let step = self.members.len().div_ceil(SAMPLE).max(1);
        let mut sample = reserved(self.members.len() / step + 1, WHAT)?;
        // one of every few, not always at the same position, which could miss every other layer
        let one = |(at, few): (usize, &[u32])| few[(mixed(at as u64) % few.len() as u64) as usize];
        sample.extend(self.members.chunks(step).enumerate().map(one));
        let mut keys = reserved(sample.len(), WHAT)?;
        let mut best: Option<(usize, Frame, [(f64, f64); 3])> = None;
        for frame in [AXES, *of_mesh, self.of_inertia(&sample)?] {
            let cuts = frame.map(|axis| self.crossing(&sample, &axis, &mut keys));
            let least = (0..3).min_by(|&i, &j| cuts[i].0.total_cmp(&cuts[j].0)).unwrap_or(0);
            if cuts[least].0 < best.as_ref().map_or(f64::INFINITY, |best| (1.0 - TIE) * best.2[best.0].0) {
                best = Some((least, frame, cuts));
            }
        }
        let Some((least, frame, cuts)) = best else { return Ok(None) };
        let inside = self.inside(&sample);
        let at = |i: usize| (least + i) % 3;
        let lengths = [0, 1, 2].map(|i| (inside / cuts[at(i)].0).max(1.0));
        let extents = [0, 1, 2].map(|i| self.extent(&sample, &frame[at(i)]));
        let direction = tilted([0, 1, 2].map(|i| frame[at(i)]), cuts[least].1, extents, lengths);
        Ok(Some(Choice { direction, lengths }))
    }

    /// Unknowns shared across the plane through the middle of the sample, infinite if less than a quarter is on one side;
    /// and the mean distance of neighbours across it.
    fn crossing(&self, sample: &[u32], axis: &Point, keys: &mut Vec<f64>) -> (f64, f64) {
        let key = |i: usize| dot(axis, &self.centres[i]);
        keys.clear();
        keys.extend(sample.iter().map(|&i| key(i as usize)));
        let half = keys.len() / 2;
        let (_, &mut middle, _) = keys.select_nth_unstable_by(half, f64::total_cmp);
        let (mut below, mut across, mut distance, mut count) = (0, 0.0, 0.0, 0.0);
        for &i in sample.iter().filter(|&&i| key(i as usize) < middle) {
            below += 1;
            for (j, share) in self.within(i as usize).filter(|&(j, _)| key(j) >= middle) {
                across += f64::from(share);
                distance += key(j) - key(i as usize);
                count += 1.0;
            }
        }
        if 4 * below < sample.len() {
            return (f64::INFINITY, 0.0);
        }
        (across, distance / f64::max(count, 1.0))
    }

    /// Size of the sample times the mean number of unknowns shared by neighbours in the set.
    fn inside(&self, sample: &[u32]) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (_, share) in sample.iter().flat_map(|&i| self.within(i as usize)) {
            sum += f64::from(share);
            count += 1.0;
        }
        sample.len() as f64 * sum / f64::max(count, 1.0)
    }

    fn within(&self, i: usize) -> impl Iterator<Item = (usize, u32)> + '_ {
        self.graph.around(i).filter(move |&(j, _)| self.label[j] == self.label[i])
    }

    fn extent(&self, sample: &[u32], axis: &Point) -> f64 {
        let key = |&i: &u32| dot(axis, &self.centres[i as usize]);
        let (low, high) = sample
            .iter()
            .map(key)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    }

    /// Principal axes of the centres.
    fn of_inertia(&self, sample: &[u32]) -> Result<Frame> {
        let mut mean = [0.0; 3];
        for &i in sample {
            (0..3).for_each(|k| mean[k] += self.centres[i as usize][k] / sample.len() as f64);
        }
        let mut moments = Matrix::from_fn(3, 3, |_, _| 0.0)?;
        for &i in sample {
            let x = minus(&self.centres[i as usize], &mean);
            (0..9).for_each(|k| moments.data[k] += x[k / 3] * x[k % 3]);
        }
        let (_, vectors) = symmetric_eigen(&moments)?;
        Ok([2, 1, 0].map(|j| [0, 1, 2].map(|i| vectors.data[3 * j + i])))
    }
}

/// The three main directions of neighbours in a mesh of bricks, in any orientation.
pub fn of_mesh(graph: &Weighted, centres: &[Point]) -> Result<Frame> {
    const EDGES: usize = 300;
    let step = graph.count().div_ceil(EDGES / 3).max(1);
    let mut edges: Vec<Point> = reserved(EDGES * 8, WHAT)?;
    for i in (0..graph.count()).step_by(step) {
        let edge = |(j, _): (usize, u32)| unit(minus(&centres[j], &centres[i]));
        edges.extend(graph.around(i).take(8).filter_map(edge));
    }
    let most = |allowed: &dyn Fn(&Point) -> bool| -> Option<Point> {
        let along = |a: &Point| edges.iter().map(|b| dot(a, b).powi(32)).sum::<f64>();
        let scored = edges.iter().filter(|a| allowed(a)).map(|a| (along(a), *a));
        scored
            .fold(None, |best: Option<(f64, Point)>, new| match best {
                Some(old) if new.0 <= old.0 => Some(old),
                _ => Some(new),
            })
            .map(|(_, a)| a)
    };
    let Some(first) = most(&|_| true) else { return Ok(AXES) };
    let other = most(&|a| dot(a, &first).abs() < 0.5).unwrap_or_else(|| smallest_axis(&first));
    let Some(third) = unit(cross(&first, &other)) else { return Ok(AXES) };
    Ok([first, cross(&third, &first), third])
}

/// The coordinate axis with the largest angle to `a`.
fn smallest_axis(a: &Point) -> Point {
    let least = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())).unwrap_or(0);
    AXES[least]
}

/// The first direction with a small tilt, so that a plane cuts a layer between its rows and a row between two elements.
/// `step` is the distance of two layers.
fn tilted(frame: Frame, mut step: f64, extents: Point, lengths: Point) -> Point {
    let mut direction = frame[0];
    for i in 1..3 {
        // a flat body has no third direction
        if extents[i] > FLAT * extents[0] {
            (0..3).for_each(|k| direction[k] += SLOPE * step / extents[i] * frame[i][k]);
            step *= SLOPE / lengths[i];
        }
    }
    direction
}

pub fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Option<Point> {
    let norm = dot(&a, &a).sqrt();
    (norm > 0.0).then(|| a.map(|x| x / norm))
}
