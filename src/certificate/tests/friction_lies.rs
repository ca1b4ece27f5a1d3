//! Correct answers with friction pass, and the entries of friction alone detect a wrong force or slip.

use super::friction::entries;
use super::model::{DenseAnswer, DenseBody, DenseModel};
use super::nodes::DenseNode;
use crate::certificate::{Certificate, FrictionState};

/// Nodes of `dim` unknowns, all joined to each other in all directions; springs `ground` hold the last.
fn cluster(count: usize, dim: usize, ground: f64) -> DenseBody {
    let n = count * dim;
    let mut k = vec![vec![0.0; n]; n];
    let mut spring = |ends: &[(usize, f64)]| {
        ends.iter().for_each(|&(i, x)| ends.iter().for_each(|&(j, y)| k[i][j] += x * y));
    };
    for (a, b) in (0..count).flat_map(|b| (0..b).map(move |a| (a, b))) {
        for m in 0..dim {
            let along = |d: usize| if d == m { 1.0 } else { 0.4 * ((7 * a + 3 * b + 5 * d) as f64).sin() };
            let ends: Vec<_> =
                (0..dim).flat_map(|d| [(a * dim + d, along(d)), (b * dim + d, -along(d))]).collect();
            spring(&ends);
        }
    }
    if ground > 0.0 {
        (n - dim..n).for_each(|j| spring(&[(j, ground.sqrt())]));
    }
    let translation = |d: usize| (0..n).map(|j| if j % dim == d { 1.0 } else { 0.0 }).collect();
    let motions = if ground > 0.0 { vec![] } else { (0..dim).map(translation).collect() };
    DenseBody { k, load: vec![0.0; n], motions }
}

/// Number of nodes in contact with nodes of the ground; the gap of the last one is open.
const PAIRS: usize = 4;

/// A free body of six nodes pressed on a held body at four of them, once for each of `sizes`, which scales loads and
/// bounds. It starts after a slip `far`; mu = .3 to .6, and the third node has a bound.
fn pressed(dim: usize, sizes: &[f64], far: f64) -> DenseModel {
    let mut model = DenseModel::default();
    for size in sizes {
        model.parts.push(cluster(6, dim, 2.0));
        let ground = model.unknowns() - 6 * dim;
        let start = model.unknowns();
        let pushes = [1.2, 0.1, -0.4, 0.05, 0.1, -0.1];
        let presses = [1.5, 1.2, 1.0, 0.02, 0.3, 0.2];
        let across = [0.3, -0.2, 0.2, 0.0, 0.1, 0.1];
        let load = |j: usize| match j % dim {
            d if d == dim - 1 => (j, -size * presses[j / dim]),
            0 => (j, size * pushes[j / dim]),
            _ => (j, size * across[j / dim]),
        };
        model.parts.push(cluster(6, dim, 0.0).loaded(&(0..6 * dim).map(load).collect::<Vec<_>>()));
        for i in 0..PAIRS {
            let ends = |d: usize, sign: f64| vec![(ground + i * dim + d, -sign), (start + i * dim + d, sign)];
            let gap = if i == PAIRS - 1 { 3.0 } else { 0.0 };
            let normal = Some(model.contact.len());
            if gap == 0.0 {
                model.active.push(model.contact.len());
            }
            model.contact.push((ends(dim - 1, -1.0), gap, 0.0));
            let bound = if i == 2 { 0.2 * size } else { 0.0 };
            let rows = (0..dim - 1).map(|d| ends(d, 1.0)).collect();
            let old = vec![far; dim - 1];
            let coefficient = 0.3 + 0.1 * i as f64;
            model.nodes.push(DenseNode { normal, rows, old, coefficient, bound, ..DenseNode::default() });
        }
    }
    let moved = |j: usize| if j / (6 * dim) % 2 == 1 && j % dim < dim - 1 { far } else { 0.0 };
    model.travel = (0..model.unknowns()).map(moved).collect();
    model
}

fn models() -> Vec<(String, DenseModel)> {
    let mut all = Vec::new();
    for dim in [2, 3] {
        for far in [0.0, 0.1, 100.0] {
            all.push((format!("{dim}D, slip {far}"), pressed(dim, &[1.0], far)));
        }
        let mut soft = pressed(dim, &[1.0], 0.1);
        soft.nodes.iter_mut().for_each(|node| node.compliance = 0.03);
        all.push((format!("{dim}D, elastic stick"), soft));
        all.push((format!("{dim}D, beside a small one"), pressed(dim, &[1.0, 1e-6], 0.0)));
    }
    all
}

/// The worst of the three entries of friction.
fn friction(certificate: &Certificate) -> f64 {
    entries(certificate).iter().map(|entry| entry.ratio).fold(0.0, f64::max)
}

/// All values with rounding errors; values that are 0 get the rounding of the largest.
fn rounded(answer: &DenseAnswer, seed: usize) -> DenseAnswer {
    let of = |values: &[f64], shift: usize| {
        let largest = values.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        let off = |i: usize| ((31 * i + 17 * seed + shift) as f64).sin() * 1e-15;
        let of = |(i, v): (usize, &f64)| if *v == 0.0 { largest * off(i).abs() } else { v * (1.0 + off(i)) };
        values.iter().enumerate().map(of).collect()
    };
    DenseAnswer {
        u: of(&answer.u, 1),
        lambda: of(&answer.lambda, 2),
        mu: of(&answer.mu, 3),
        tangential: of(&answer.tangential, 4),
    }
}

#[test]
fn right_answers_pass_also_to_rounding() {
    let mut largest = [0.0; 2];
    for (name, model) in models() {
        let right = model.accepted(&name);
        let judgement = model.judged(&right);
        assert!(judgement.nodes.contains(&FrictionState::Slip), "{name} {judgement:?}");
        assert!(judgement.nodes.contains(&FrictionState::Stick), "{name} {judgement:?}");
        assert_eq!(judgement.nodes[PAIRS - 1], FrictionState::Open);
        let mut worst = judgement.certificate.worst();
        for seed in 0..20 {
            let certificate = model.certificate(&rounded(&right, seed));
            worst = f64::max(worst, certificate.worst());
            largest[1] = f64::max(largest[1], friction(&certificate));
            assert!(worst <= 0.35, "{name} {seed} {certificate:#?}");
        }
        largest[0] = f64::max(largest[0], worst);
    }
    println!("right answers, rounded: worst {:.1e}, friction {:.1e}", largest[0], largest[1]);
}

/// A correct answer in which one value is changed; the entries of friction must detect it.
struct Liar<'a> {
    name: &'a str,
    model: &'a DenseModel,
    right: &'a DenseAnswer,
    least: &'a mut f64,
}

impl Liar<'_> {
    /// cone, work, stick: the entries that detect the change. If `alone`, the others must pass.
    fn found(&mut self, what: &str, by: [bool; 3], wrong: &DenseAnswer) {
        let certificate = self.model.certificate(wrong);
        let found = entries(&certificate).map(|entry| entry.ratio > 1.0);
        let missed = (0..3).any(|k| by[k] && !found[k]);
        assert!(!missed, "{}, {what}: {by:?} {certificate:#?}", self.name);
        *self.least = self.least.min(friction(&certificate));
    }

    /// Replaces the force of a node.
    fn forced(&mut self, what: &str, by: [bool; 3], node: usize, force: impl Fn([f64; 2]) -> [f64; 2]) {
        let (mut wrong, rows) = (self.right.clone(), self.model.laws()[node].rows());
        let mut own = [0.0; 2];
        own.iter_mut().zip(&self.right.tangential[rows.clone()]).for_each(|(own, v)| *own = *v);
        wrong.tangential[rows].iter_mut().zip(force(own)).for_each(|(v, new)| *v = new);
        self.found(&format!("node {node}, {what}"), by, &wrong);
    }
}

const CONE: [bool; 3] = [true, false, false];
const WORK: [bool; 3] = [false, true, false];
const WORK_AND_STICK: [bool; 3] = [false, true, true];

#[test]
fn wrong_forces_and_slips_are_found_by_the_entries_of_friction() {
    let mut all = Vec::new();
    for (name, model) in models() {
        let (right, mut least) = (model.answer(), f64::INFINITY);
        let states = model.judged(&right).nodes;
        let mut liar = Liar { name: &name, model: &model, right: &right, least: &mut least };
        for (node, state) in states.iter().enumerate() {
            match state {
                FrictionState::Slip => {
                    liar.forced("outside by 1e-5", CONE, node, |t| t.map(|v| v * (1.0 + 1e-5)));
                    liar.forced("inside by 1e-5", WORK_AND_STICK, node, |t| t.map(|v| v * (1.0 - 1e-5)));
                    liar.forced("halved", WORK_AND_STICK, node, |t| t.map(|v| 0.5 * v));
                    liar.forced("none", WORK_AND_STICK, node, |_| [0.0; 2]);
                    liar.forced("against the slip", WORK, node, |t| t.map(|v| -v));
                    if model.nodes[node].rows.len() == 2 {
                        for angle in [1e-3f64, 1e-4] {
                            let (cos, sin) = (angle.cos(), angle.sin());
                            let turned = |t: [f64; 2]| [cos * t[0] - sin * t[1], sin * t[0] + cos * t[1]];
                            liar.forced(&format!("turned by {angle}"), WORK, node, turned);
                        }
                    }
                }
                FrictionState::Open => {
                    liar.forced("a force at an open node", CONE, node, |_| [1e-5 * right.lambda[0], 0.0]);
                }
                _ => {}
            }
        }
        all.push((name.clone(), least));
        assert!(least > 1.0);
    }
    println!("least ratio of a wrong force: {all:?}");
}

/// Answers for another law or another earlier slip, in equilibrium: only the entries of friction can detect them.
#[test]
fn answers_of_another_law_are_found() {
    let mut all = Vec::new();
    for (name, model) in models() {
        let (right, mut least) = (model.answer(), f64::INFINITY);
        let states = model.judged(&right).nodes;
        let of = |change: &dyn Fn(&mut DenseModel)| {
            let mut other = model.clone();
            change(&mut other);
            other.answer()
        };
        let slips = states.iter().position(|state| *state == FrictionState::Slip).unwrap();
        let sticks = states.iter().position(|state| *state == FrictionState::Stick).unwrap();
        let last = states.iter().rposition(|state| *state == FrictionState::Slip).unwrap();
        let mut liar = Liar { name: &name, model: &model, right: &right, least: &mut least };
        for node in [slips, last] {
            let times = |by: f64| {
                of(&|other| {
                    other.nodes[node].coefficient *= by;
                    other.nodes[node].bound *= by;
                })
            };
            liar.found("mu x 1.001", CONE, &times(1.001));
            liar.found("mu x .999", WORK_AND_STICK, &times(0.999));
        }
        let earlier = |by: f64| of(&|other| other.nodes[sticks].old[0] += by);
        liar.found("s_old off by 1e-4", WORK_AND_STICK, &earlier(1e-4));
        if model.nodes[0].old[0] == 0.1 {
            let forgotten = of(&|other| other.nodes.iter_mut().for_each(|node| node.old = vec![0.0; 2]));
            liar.found("s_old forgotten", WORK_AND_STICK, &forgotten);
        }
        if model.nodes[0].compliance > 0.0 {
            let rigid = of(&|other| other.nodes.iter_mut().for_each(|node| node.compliance = 0.0));
            liar.found("elastic stick forgotten", WORK_AND_STICK, &rigid);
        }
        let mut swapped = right.clone();
        let (a, b) = (model.laws()[slips].rows(), model.laws()[sticks].rows());
        a.zip(b).for_each(|(a, b)| swapped.tangential.swap(a, b));
        assert!(friction(&model.certificate(&swapped)) > 1.0, "{name}: friction of the neighbour");
        all.push((name.clone(), least));
    }
    println!("least ratio of another law: {all:?}");
}

/// K in 2^a, forces in 2^b, lengths in 2^(b - a).
#[test]
fn units_that_differ_by_powers_of_two_change_no_bit_of_friction() {
    let model = |k: f64, f: f64| {
        let mut model = pressed(3, &[1.0], 0.1);
        for part in &mut model.parts {
            part.k.iter_mut().flatten().for_each(|v| *v *= k);
            part.load.iter_mut().for_each(|v| *v *= f);
        }
        model.contact.iter_mut().for_each(|row| row.1 *= f / k);
        for node in &mut model.nodes {
            node.old.iter_mut().for_each(|s| *s *= f / k);
            node.bound *= f;
            node.compliance = 0.03 / k;
        }
        model
    };
    let mut answer = model(1.0, 1.0).answer();
    for turned in [0.0, 1e-9, 1e-3] {
        answer.tangential.swap(0, 1);
        answer.tangential[0] += turned;
        let judged = |a: i32, b: i32| {
            let (k, f) = (2f64.powi(a), 2f64.powi(b));
            let scaled = |v: &[f64], by: f64| v.iter().map(|v| v * by).collect::<Vec<_>>();
            let point = DenseAnswer {
                u: scaled(&answer.u, f / k),
                lambda: scaled(&answer.lambda, f),
                mu: vec![],
                tangential: scaled(&answer.tangential, f),
            };
            let judgement = model(k, f).judged(&point);
            (judgement.certificate.entries(), judgement.bodies, judgement.nodes)
        };
        for (a, b) in [(1, 0), (0, 1), (-31, 17), (100, -100)] {
            assert_eq!(judged(0, 0), judged(a, b), "{a} {b}");
        }
    }
}

/// Rows of a node times any factor, with its law divided by the factor; nodes in another order.
#[test]
fn neither_factors_of_nodes_nor_their_order_change_what_is_judged() {
    let model = pressed(3, &[1.0], 0.1);
    for times in [1.0 + 1e-5, 0.5] {
        let mut wrong = model.answer();
        wrong.tangential[..2].iter_mut().for_each(|force| *force *= times);
        let one = model.judged(&wrong);
        let (mut other, mut point) = (model.clone(), wrong.clone());
        for (i, factor) in [0.3, 1.7, 2e-4, 7e3].into_iter().enumerate() {
            let node = &mut other.nodes[i];
            node.rows.iter_mut().flatten().for_each(|entry| entry.1 *= factor);
            node.old.iter_mut().for_each(|s| *s *= factor);
            (node.coefficient, node.bound) = (node.coefficient / factor, node.bound / factor);
            (2 * i..2 * i + 2).for_each(|k| point.tangential[k] /= factor);
        }
        other.nodes.reverse();
        let forces = point.tangential.chunks(2).rev().flatten().copied().collect();
        point.tangential = forces;
        let two = other.judged(&point);
        for (one, two) in entries(&one.certificate).into_iter().zip(entries(&two.certificate)) {
            assert!((one.ratio - two.ratio).abs() <= 1e-6 * (one.ratio + 1.0), "{one:?} {two:?}");
            let at = |place: Option<usize>| place.map_or(0, |i| PAIRS - 1 - i);
            assert!(one.ratio < 1e-3 || one.place == Some(at(two.place)), "{one:?} {two:?}");
        }
        assert!(friction(&one.certificate) > 1.0);
        assert_eq!(one.nodes, two.nodes.into_iter().rev().collect::<Vec<_>>());
    }
}
