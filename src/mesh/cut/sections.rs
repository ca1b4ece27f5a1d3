//! The cut by planes: a set of elements is cut into slabs, and each slab again, until every set is a piece.

use super::directions::{dot, of_mesh, Choice, Frame, Point, Set};
use super::halves::{coarser, halves};
use super::incidence::{NONE, WHAT};
use super::scraps::give;
use super::smooth::smooth;
use crate::error::Result;
use crate::linalg::partition::levels::{coarsest, refined};
use crate::linalg::partition::Weighted;
use crate::numbers::cut::{DISCONNECTED, LONG, SNAP, TIE};
use crate::platform::interrupt;
use crate::platform::memory::{copied, filled, reserved};

/// Number of groups of elements per piece if the graph alone is cut.
const GROUPS: usize = 150;

/// Vertices `from..to` of the order, which become `pieces` pieces, numbered from `first`.
struct Task {
    from: usize,
    to: usize,
    first: usize,
    pieces: usize,
}

struct Sections<'a> {
    graph: &'a Weighted,
    centres: Option<&'a [Point]>,
    frame: Frame,
    piece: &'a mut [u32],
    order: Vec<u32>,
    place: Vec<u32>,
    keys: Vec<(f64, u32)>,
}

/// Cuts each part, the vertices with its number in `piece`, into its share of pieces: by planes if centres are given,
/// otherwise through the graph.
pub fn sections(
    graph: &Weighted,
    centres: Option<&[Point]>,
    piece: &mut [u32],
    shares: &[usize],
) -> Result<()> {
    let frame = centres.map_or(Ok(super::directions::AXES), |centres| of_mesh(graph, centres))?;
    let count = graph.count();
    let mut order = reserved(count, WHAT)?;
    order.extend(0..count as u32);
    order.sort_by_key(|&i| piece[i as usize]);
    let mut tasks = Vec::new();
    let (mut at, mut first) = (0, 0);
    for part in order.chunk_by(|&a, &b| piece[a as usize] == piece[b as usize]) {
        let pieces = shares[piece[part[0] as usize] as usize];
        tasks.push(Task { from: at, to: at + part.len(), first, pieces });
        at += part.len();
        first += pieces;
    }
    for task in &tasks {
        order[task.from..task.to].iter().for_each(|&i| piece[i as usize] = task.first as u32);
    }
    let (place, keys) = (filled(count, NONE, WHAT)?, reserved(count, WHAT)?);
    let mut all = Sections { graph, centres, frame, piece, order, place, keys };
    while let Some(task) = tasks.pop() {
        if task.pieces > 1 {
            interrupt::check()?;
            all.split(&task, &mut tasks)?;
        }
    }
    Ok(())
}

/// The cut without centres: groups of elements are cut, then each finer group and finally each element moves to the piece
/// with which it shares most.
pub fn by_levels(graph: &Weighted, piece: &mut [u32], shares: &[usize]) -> Result<()> {
    let enough = (GROUPS * shares.iter().sum::<usize>()).max(2000);
    let levels = coarser(graph, enough)?;
    // a group lies in one part, since it was formed across faces
    let mut label = copied(piece, WHAT)?;
    for level in &levels {
        let mut of_groups = filled(level.graph.count(), 0, WHAT)?;
        level.coarse.iter().zip(&label).for_each(|(&c, &l)| of_groups[c as usize] = l);
        label = of_groups;
    }
    let (last, count) = (coarsest(graph, &levels), shares.iter().sum());
    let smoothed = |graph: &Weighted, mut label: Vec<u32>| {
        give(graph, &mut label, count)?;
        smooth(graph, &mut label, count)?;
        Ok(label)
    };
    sections(last, None, &mut label, shares)?;
    let label = refined(graph, &levels, smoothed(last, label)?, smoothed)?;
    piece.copy_from_slice(&label);
    Ok(())
}

impl Sections<'_> {
    fn split(&mut self, task: &Task, tasks: &mut Vec<Task>) -> Result<()> {
        let begun = tasks.len();
        if let Some(centres) = self.centres {
            let members = &self.order[task.from..task.to];
            let set = Set { graph: self.graph, centres, label: self.piece, members };
            if let Some(choice) = set.direction(&self.frame)? {
                self.slabs(task, centres, &choice, tasks);
                if self.are_connected(&tasks[begun..]) {
                    return Ok(());
                }
                tasks.truncate(begun);
                self.order[task.from..task.to]
                    .iter()
                    .for_each(|&i| self.piece[i as usize] = task.first as u32);
            }
        }
        self.by_graph(task, tasks)
    }

    fn slabs(&mut self, task: &Task, centres: &[Point], choice: &Choice, tasks: &mut Vec<Task>) {
        let members = &mut self.order[task.from..task.to];
        self.keys.clear();
        self.keys.extend(members.iter().map(|&i| (dot(&choice.direction, &centres[i as usize]), i)));
        self.keys.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        members.iter_mut().zip(&self.keys).for_each(|(i, key)| *i = key.1);
        let total: f64 = self.keys.iter().map(|key| self.graph.weight[key.1 as usize]).sum();
        let counts = counts(task.pieces, &choice.lengths);
        let (mut from, mut first, mut weight, mut at) = (0, task.first, 0.0, 0);
        let mut done = 0;
        for (slab, &pieces) in counts.iter().enumerate() {
            done += pieces;
            let goal = total * done as f64 / task.pieces as f64;
            let mut end = self.keys.len();
            if slab + 1 < counts.len() {
                let slack = SNAP * total * pieces as f64 / task.pieces as f64;
                end = between_layers(&self.keys, &self.graph.weight, (&mut at, &mut weight), goal, slack);
                // every remaining piece keeps at least one vertex
                let left = self.keys.len() - (task.pieces - done);
                end = end.clamp((from + pieces).min(left), left);
            }
            tasks.push(Task { from: task.from + from, to: task.from + end, first, pieces });
            self.keys[from..end].iter().for_each(|key| self.piece[key.1 as usize] = first as u32);
            (from, first) = (end, first + pieces);
        }
    }

    /// Whether nearly all of each of these sets is connected by faces.
    fn are_connected(&mut self, sets: &[Task]) -> bool {
        let mut queue = Vec::new();
        let mut connected = true;
        for set in sets {
            let members = &self.order[set.from..set.to];
            let (mut total, mut largest, mut left) = (0.0, 0.0, 0.0);
            for &first in members {
                if self.place[first as usize] != NONE {
                    continue;
                }
                let mut weight = 0.0;
                self.place[first as usize] = 0;
                queue.push(first as usize);
                while let Some(i) = queue.pop() {
                    weight += self.graph.weight[i];
                    for (j, _) in self.graph.around(i) {
                        if self.piece[j] == self.piece[i] && self.place[j] == NONE {
                            self.place[j] = 0;
                            queue.push(j);
                        }
                    }
                }
                total += weight;
                largest = f64::max(largest, weight);
                left = total - largest;
            }
            members.iter().for_each(|&i| self.place[i as usize] = NONE);
            connected &= left <= DISCONNECTED * total / set.pieces as f64;
        }
        connected
    }

    fn by_graph(&mut self, task: &Task, tasks: &mut Vec<Task>) -> Result<()> {
        let members = &mut self.order[task.from..task.to];
        let part = self.graph.of_some(members, &mut self.place)?;
        let low = task.pieces / 2;
        let side = halves(&part, low as f64 / task.pieces as f64)?;
        self.keys.clear();
        self.keys.extend(members.iter().zip(&side).map(|(&i, &side)| (f64::from(side), i)));
        self.keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        members.iter_mut().zip(&self.keys).for_each(|(i, key)| *i = key.1);
        let inside = side.iter().filter(|&&side| side == 0).count();
        let split = inside.clamp(low, members.len() - (task.pieces - low));
        let sizes =
            [(0, split, task.first, low), (split, members.len(), task.first + low, task.pieces - low)];
        for (from, to, first, pieces) in sizes {
            members[from..to].iter().for_each(|&i| self.piece[i as usize] = first as u32);
            tasks.push(Task { from: task.from + from, to: task.from + to, first, pieces });
        }
        Ok(())
    }
}

/// The number of pieces of each slab: equal numbers if the number has a small divisor that fits the lengths, otherwise
/// two slabs.
fn counts(pieces: usize, lengths: &Point) -> Vec<usize> {
    // edge length of a piece: shorter edges are not cut
    let mut length = (lengths.iter().product::<f64>() / pieces as f64).cbrt();
    for _ in 0..3 {
        let longer = || lengths.iter().filter(|&&l| l > length);
        let dimension = longer().count().max(1);
        length = (longer().product::<f64>() / pieces as f64).powf(1.0 / dimension as f64);
    }
    let fits = |&slabs: &usize| pieces % slabs == 0 && (slabs as f64) < LONG * lengths[0] / length;
    let slabs = [2, 3, 5, 7].into_iter().find(fits);
    slabs.map_or_else(|| vec![pieces / 2, pieces - pieces / 2], |slabs| vec![pieces / slabs; slabs])
}

/// The position in the order of the keys where the preceding weight is about `goal`: at the largest gap between keys
/// among the positions that deviate by at most `slack`. `passed`: an earlier position and its preceding weight.
fn between_layers(
    keys: &[(f64, u32)],
    weights: &[f64],
    passed: (&mut usize, &mut f64),
    goal: f64,
    slack: f64,
) -> usize {
    let (at, weight) = passed;
    let (mut best, mut widest, mut nearest) = (0, -1.0, f64::INFINITY);
    let (mut i, mut w) = (*at, *weight);
    while i < keys.len() && w <= goal + slack {
        if w < goal - slack {
            (*at, *weight) = (i, w);
        }
        let off = (w - goal).abs();
        let gap = if i > 0 { keys[i].0 - keys[i - 1].0 } else { 0.0 };
        let (inside, was_inside) = (off <= slack, nearest <= slack);
        if inside
            && (!was_inside || gap > (1.0 + TIE) * widest || gap > (1.0 - TIE) * widest && off < nearest)
            || !inside && !was_inside && off < nearest
        {
            (best, widest, nearest) = (i, gap, off);
        }
        w += weights[keys[i].1 as usize];
        i += 1;
    }
    if !(nearest <= slack) && (w - goal).abs() < nearest {
        best = i;
    }
    best
}
