//! Bodies: blocks, trusses with a bar between any two nodes, single points on springs; held, held in part, floating.

use decks::dense::singular;
use decks::random::Random;
use decks::{Block, Body, Csr};

/// Unknowns of an element within its body, and its matrix.
pub type Element = (Vec<usize>, Vec<f64>);

/// Bodies and what they are measured in.
pub struct Drawing {
    pub dim: usize,
    pub length: f64,
    pub young: f64,
    pub bodies: Vec<Body>,
    /// Rigid motions of each body were it free.
    free: Vec<Vec<Vec<f64>>>,
    /// Springs of each body to the ground: unknown and stiffness.
    springs: Vec<Vec<(usize, f64)>>,
    /// Largest K_ii of each body.
    pub stiffness: Vec<f64>,
    /// The elements of each body, springs to the ground included.
    pub elements: Vec<Vec<Element>>,
}

/// The elements of a block, without motions.
pub fn elements(block: &Block) -> Vec<Element> {
    let (dim, corners) = (block.dimension, 1 << block.dimension);
    let of = |e: usize| {
        let low = block.low(e);
        let node = |c: usize| block.node([low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2)]);
        let unknowns = (0..corners).flat_map(|c| (0..dim).map(move |i| dim * node(c) + i));
        (unknowns.collect(), block.element())
    };
    (0..block.volume()).map(of).collect()
}

/// How a body is held.
#[derive(Clone, Copy, PartialEq)]
pub enum Held {
    No,
    InPart,
    Wholly,
}

impl Drawing {
    pub fn new(dim: usize, length: f64, young: f64) -> Self {
        let (bodies, free, springs, stiffness, elements) = Default::default();
        Self { dim, length, young, bodies, free, springs, stiffness, elements }
    }

    /// First unknown of a body.
    pub fn offset(&self, p: usize) -> usize {
        self.bodies[..p].iter().map(Body::dofs).sum()
    }

    pub fn nodes(&self, p: usize) -> usize {
        self.bodies[p].dofs() / self.dim
    }

    pub fn add(&mut self, random: &mut Random, softer: f64) {
        let held = [Held::No, Held::No, Held::InPart, Held::Wholly][random.below(4)];
        let kind = random.below(5);
        self.add_held(random, softer, kind, held);
    }

    /// `kind` 0: a point, 1 and 2: a truss, else a block.
    pub fn add_held(&mut self, random: &mut Random, softer: f64, kind: usize, held: Held) {
        let young = self.young * softer;
        let (mut elements, free) = match kind {
            0 => self.point(),
            1 | 2 => self.truss(random, young),
            _ => self.block(random, young),
        };
        let n = free[0].len();
        let mut k = sum(n, &elements);
        let unit = match kind {
            0 => young * self.length.powi(self.dim as i32 - 2),
            _ => (0..n).map(|i| k[i * n + i]).fold(0.0, f64::max),
        };
        let mut springs = Vec::new();
        let count = match held {
            Held::No => 0,
            Held::InPart => 1,
            Held::Wholly => n,
        };
        for spring in 0..count {
            let j = if held == Held::Wholly { spring } else { random.below(n) };
            springs.push((j, unit * random.decades(-1.0, 0.5)));
        }
        for &(j, spring) in &springs {
            k[j * n + j] += spring;
            elements.push((vec![j], vec![spring]));
        }
        let stiffness = if kind == 0 { unit } else { (0..n).map(|i| k[i * n + i]).fold(0.0, f64::max) };
        let null_space = null_space(&free, &springs);
        self.bodies.push(Body {
            stiffness: Csr::from_dense(n, &k),
            null_space,
            load: vec![0.0; n],
            coordinates: vec![[0.0; 3]; n],
            node: (0..n).map(|i| (i / self.dim + 1) as i32).collect(),
            direction: (0..n).map(|i| (i % self.dim + 1) as i32).collect(),
        });
        self.free.push(free);
        self.springs.push(springs);
        self.stiffness.push(stiffness);
        self.elements.push(elements);
    }

    fn point(&self) -> (Vec<Element>, Vec<Vec<f64>>) {
        let free = (0..self.dim).map(|axis| (0..self.dim).map(|i| f64::from(i == axis)).collect());
        (vec![((0..self.dim).collect(), vec![0.0; self.dim * self.dim])], free.collect())
    }

    fn block(&self, random: &mut Random, young: f64) -> (Vec<Element>, Vec<Vec<f64>>) {
        let most = if self.dim == 2 { 2 } else { 1 };
        let block = Block {
            dimension: self.dim,
            elements: std::array::from_fn(|_| 1 + random.below(most)),
            size: std::array::from_fn(|_| self.length * random.between(0.5, 2.0)),
            young,
            poisson: random.between(0.0, 0.45),
            ..Block::default()
        };
        (elements(&block), block.rigid_modes())
    }

    /// A bar between any two of a few nodes.
    fn truss(&self, random: &mut Random, young: f64) -> (Vec<Element>, Vec<Vec<f64>>) {
        let (dim, count) = (self.dim, self.dim + 1 + random.below(3));
        let n = dim * count;
        // corners of a simplex, moved a little, then others
        let corner = |node: usize, axis: usize| f64::from(node == axis + 1);
        let places: Vec<Vec<f64>> = (0..count)
            .map(|node| {
                let at = |axis: usize, by: f64| if node <= dim { corner(node, axis) + 0.2 * by } else { by };
                (0..dim).map(|axis| at(axis, random.uniform())).collect()
            })
            .collect();
        let mut bars = Vec::new();
        for (a, b) in (0..count).flat_map(|a| (0..a).map(move |b| (a, b))) {
            let along = (0..dim).map(|axis| places[a][axis] - places[b][axis]);
            let bar: Vec<f64> = along.clone().chain(along.map(|d| -d)).collect();
            let stiff = young * self.length.powi(dim as i32 - 2) * random.decades(-0.5, 0.5);
            let unknowns = [a, b].into_iter().flat_map(|node| (0..dim).map(move |i| dim * node + i));
            let k = bar.iter().flat_map(|v| bar.iter().map(move |w| stiff * v * w));
            bars.push((unknowns.collect(), k.collect()));
        }
        let unit = |axis: usize| (0..n).map(|i| f64::from(i % dim == axis)).collect::<Vec<f64>>();
        let mut free: Vec<Vec<f64>> = (0..dim).map(unit).collect();
        let planes: &[(usize, usize)] = if dim == 2 { &[(0, 1)] } else { &[(0, 1), (1, 2), (2, 0)] };
        for &(p, q) in planes {
            let mut turn = vec![0.0; n];
            for (node, at) in places.iter().enumerate() {
                turn[dim * node + p] = -at[q];
                turn[dim * node + q] = at[p];
            }
            free.push(turn);
        }
        (bars, free)
    }

    /// Springs under unknowns of body p.
    pub fn stiffen(&mut self, p: usize, unknowns: std::ops::Range<usize>, stiff: f64) {
        let body = &mut self.bodies[p];
        let (mut k, n) = (dense(&body.stiffness), body.dofs());
        for j in unknowns {
            k[j * n + j] += stiff;
            self.springs[p].push((j, stiff));
            self.elements[p].push((vec![j], vec![stiff]));
        }
        body.stiffness = Csr::from_dense(n, &k);
        body.null_space = null_space(&self.free[p], &self.springs[p]);
    }

    /// Of the size of `moves`, and rigid motions `travel` times as large.
    pub fn displacements(&self, random: &mut Random, moves: f64, travel: f64) -> Vec<f64> {
        let mut all = Vec::new();
        for (p, body) in self.bodies.iter().enumerate() {
            let k = &body.stiffness;
            // no unknown strains the body by more than others do
            let mut own: Vec<f64> = (0..body.dofs())
                .map(|i| {
                    let stiff = k.get(i, i).max(self.stiffness[p]);
                    moves * random.normal() * (self.stiffness[p] / stiff)
                })
                .collect();
            for mode in body.modes() {
                let by = moves * travel * random.normal() / largest(mode);
                own.iter_mut().zip(mode).for_each(|(u, v)| *u += by * v);
            }
            all.extend(own);
        }
        all
    }
}

fn dense(k: &Csr) -> Vec<f64> {
    (0..k.rows).flat_map(|i| (0..k.cols).map(move |j| k.get(i, j))).collect()
}

/// The matrix of n unknowns that these elements add up to.
fn sum(n: usize, elements: &[Element]) -> Vec<f64> {
    let mut k = vec![0.0; n * n];
    for (unknowns, own) in elements {
        let entries = unknowns.iter().flat_map(|i| unknowns.iter().map(move |j| i * n + j));
        entries.zip(own).for_each(|(at, value)| k[at] += value);
    }
    k
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// The motions of a free body that strain none of the springs.
fn null_space(free: &[Vec<f64>], springs: &[(usize, f64)]) -> Option<Vec<Vec<f64>>> {
    let free: Vec<Vec<f64>> =
        free.iter().map(|mode| mode.iter().map(|v| v / largest(mode)).collect()).collect();
    if springs.is_empty() {
        return Some(free);
    }
    let strained = |mode: &Vec<f64>| springs.iter().map(|&(j, _)| mode[j]).collect();
    let of = singular(free.iter().map(strained).collect());
    let kept = (0..free.len()).filter(|&k| of.values[k] <= 1e-9 * of.values[0].max(1.0));
    let combined = |k: usize| {
        let mut sum = vec![0.0; free[0].len()];
        for (mode, by) in free.iter().zip(&of.right[k]) {
            sum.iter_mut().zip(mode).for_each(|(s, v)| *s += by * v);
        }
        sum
    };
    let modes: Vec<Vec<f64>> = kept.map(combined).collect();
    (!modes.is_empty()).then_some(modes)
}
