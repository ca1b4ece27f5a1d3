//! Decks with friction, against the linear problem on the states they end with: closed and sticking nodes, slip directions and slips known.

use std::time::Instant;

use decks::rubbing::{self, Rubbing};
use decks::{Cube, Deck, Stack};
use feti_contact::solver::{Problem, Report};

use crate::measure::{prepared, TOLERANCE};
use crate::sequence::{self, Sequence};
use crate::solved::solved;

/// Decks that share their goals.
pub struct Group {
    pub name: &'static str,
    /// Largest ratio of F to linear: of half the decks, and of each.
    pub median: f64,
    pub worst: f64,
    pub cases: Vec<Case>,
}

pub struct Case {
    pub name: String,
    build: Box<dyn Fn() -> Deck>,
}

pub struct Measurement {
    /// Products with F, every one of them, and those of the linear problem.
    pub products: usize,
    pub linear: usize,
    report: Report,
    /// Nodes with friction.
    nodes: usize,
    /// Of everything, generation of the deck included.
    seconds: f64,
}

pub fn groups() -> [Group; 3] {
    [
        Group { name: "rub_floating", median: 1.3, worst: 2.0, cases: floating() },
        Group { name: "rub_glued", median: 1.2, worst: 1.8, cases: glued() },
        Group { name: "rub_stacks", median: 1.4, worst: 2.2, cases: stacks() },
    ]
}

/// One block on the plane, and three upon each other that do not match.
fn floating() -> Vec<Case> {
    let all = Rubbing::floating_36().into_iter();
    all.map(|model| Case { name: model.name(), build: Box::new(move || model.build()) }).collect()
}

/// Subdomains on the obstacle: cubes whose every part floats, clamped at x = 0 or held by friction alone, and slabs.
fn glued() -> Vec<Case> {
    let mut cases = Vec::new();
    let sizes = [(2, 4), (3, 4), (4, 4), (5, 4), (2, 8), (3, 8), (4, 8), (5, 8)];
    for (side, h) in sizes {
        for clamp in [true, false] {
            let mus: &[f64] = if (side, h) == (3, 4) { &[0.1, 0.3, 1.0] } else { &[0.3] };
            for &mu in mus {
                cases.push(cube([side; 3], h, clamp, mu));
            }
        }
    }
    for (side, mus) in [(8, &[0.1, 0.3, 1.0][..]), (12, &[0.3]), (16, &[0.3])] {
        cases.extend(mus.iter().map(|&mu| cube([side, side, 1], 4, false, mu)));
    }
    cases
}

/// Of the load that friction alone holds: where a clamp holds as well it is pushed beyond that.
const PUSH: f64 = 0.8;
const PUSH_OF_CLAMPED: f64 = 1.5;

fn cube(subdomains: [usize; 3], elements: usize, clamp: bool, mu: f64) -> Case {
    let model = Cube { subdomains, elements, clamp, ..Cube::default() };
    let load = if clamp { PUSH_OF_CLAMPED } else { PUSH };
    let [x, y, z] = subdomains;
    let how = if clamp { "clamped" } else { "floating" };
    let name = format!("rub_cube_{x}x{y}x{z}_h{elements}_{how}_mu{mu}");
    Case { name, build: Box::new(move || rubbing::cube(&model, mu, load)) }
}

/// Height of each of three blocks: higher ones are tipped over by the push.
const LOW: f64 = 0.25;

/// Two and three blocks, the upper ones floating, on grids that do not match: 81 to 1000 nodes.
fn stacks() -> Vec<Case> {
    let mut cases = Vec::new();
    let sizes: [(&[usize], &[usize]); 7] = [
        (&[8, 6], &[4, 3]),
        (&[8, 6, 7], &[4, 3, 3]),
        (&[12, 9], &[6, 4]),
        (&[16, 12], &[6, 5]),
        (&[16, 12, 15], &[3, 2, 3]),
        (&[22, 17], &[5, 4]),
        (&[30, 23], &[4, 3]),
    ];
    for (in_plane, layers) in sizes {
        let mus: &[f64] = if in_plane[0] < 16 { &[0.1, 0.3, 1.0] } else { &[0.3] };
        for &mu in mus {
            for load in [0.5, 0.9] {
                let bodies = in_plane.len();
                let model = Stack {
                    bodies,
                    in_plane: in_plane.to_vec(),
                    layers: layers.to_vec(),
                    thickness: if bodies == 3 { LOW } else { 0.5 },
                    ..Stack::default()
                };
                let name = format!("rub_stack_{bodies}_n{}_mu{mu}_load{load}", in_plane[0]);
                cases.push(Case { name, build: Box::new(move || rubbing::stack(&model, mu, load)) });
            }
        }
    }
    cases
}

impl Case {
    /// Both solves; the text names what failed.
    pub fn measure(&self) -> Result<Measurement, String> {
        let started = Instant::now();
        let deck = (self.build)();
        let mut problem = prepared(&deck, TOLERANCE)?;
        let report = solved(&mut problem, "friction")?;
        let linear = linear(&mut problem)?;
        let (products, nodes) = (report.counts.products, deck.friction.normal.len());
        Ok(Measurement { products, linear, report, nodes, seconds: started.elapsed().as_secs_f64() })
    }

    /// Products of the method and of sequences of problems of Tresca, exact ones and others, for Coulomb's law.
    pub fn against_sequences(&self) -> Result<(usize, [Result<Sequence, String>; 2]), String> {
        let deck = (self.build)();
        let mut problem = prepared(&deck, TOLERANCE)?;
        let products = solved(&mut problem, "friction")?.counts.products;
        Ok((products, [true, false].map(|exact| sequence::measure(&deck, exact))))
    }
}

fn linear(problem: &mut Problem) -> Result<usize, String> {
    problem.products_of_known_states().map_err(|error| format!("linear: {error}"))
}

impl Measurement {
    pub fn ratio(&self) -> f64 {
        self.products as f64 / self.linear as f64
    }

    /// The line of a deck and its details.
    pub fn lines(&self, name: &str, goal: f64) -> String {
        let Self { products, linear, report, nodes, seconds } = self;
        let word = if self.ratio() > goal { "short" } else { "ok" };
        let counts = &report.counts;
        format!(
            "count {name} F {products} linear {linear} ratio {:.2} goal {goal:.2} {word}\n    Newton {}, starts {}, M {}, coarse solves \
             {}, closed {}, sticking {}, slipping {} of {nodes} nodes, {:.2} s, in all {seconds:.1} s",
            self.ratio(),
            counts.newton,
            counts.starts,
            counts.preconditioned,
            counts.coarse_solves,
            report.active,
            report.sticking,
            report.slipping,
            report.seconds_setup + report.seconds_solve,
        )
    }
}

/// Pushes of a loop, of the load that makes it slide; slips are kept from step to step.
const LOOP: [f64; 9] = [0.3, 0.6, 0.9, 0.6, 0.3, 0.0, -0.3, -0.6, -0.9];

/// Decks whose push goes up, back and forth: a name, and the deck under a push.
pub fn loops() -> Vec<(&'static str, Box<dyn Fn(f64) -> Deck>)> {
    let block = |dimension, elements, blocks| {
        move |load| Rubbing { load, ..Rubbing::new(dimension, elements, blocks, 0.6, 0.0) }.build()
    };
    let glued = Cube { subdomains: [3; 3], elements: 4, clamp: false, ..Cube::default() };
    vec![
        ("rub_loop_2d_n32_1", Box::new(block(2, 32, 1))),
        ("rub_loop_3d_n8_1", Box::new(block(3, 8, 1))),
        ("rub_loop_3d_n8_3", Box::new(block(3, 8, 3))),
        ("rub_loop_cube_3x3x3_h4", Box::new(move |load| rubbing::cube(&glued, 0.3, load))),
    ]
}

/// Products of nine steps, each started from the forces of the one before, against linear problems that start cold.
pub fn measure_loop(build: &dyn Fn(f64) -> Deck) -> Result<(usize, usize), String> {
    let text = |error: feti_contact::error::Error| error.to_string();
    let deck = build(LOOP[0]);
    let mut problem = prepared(&deck, TOLERANCE)?;
    problem.set_str("start", "previous").map_err(text)?;
    let (nodes, dim) = (deck.friction.normal.len(), deck.friction.dim);
    let mut begun = vec![0.0; nodes * dim];
    let (mut products, mut cold) = (0, 0);
    for load in LOOP {
        for (p, body) in build(load).bodies.iter().enumerate() {
            problem.set_load(p, &body.load).map_err(text)?;
        }
        problem.set_friction_reference(0, nodes, dim, &begun).map_err(text)?;
        let report = solved(&mut problem, &format!("push {load}"))?;
        let known = linear(&mut problem)?;
        (products, cold) = (products + report.counts.products, cold + known);
        let slips = problem.slips().map_err(text)?;
        begun.iter_mut().zip(slips).for_each(|(begun, slip)| *begun += slip);
    }
    Ok((products, cold))
}
