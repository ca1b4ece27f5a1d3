//! A cylinder on a block, both elastic: the pressure by mortar against Hertz.

use super::pair_by;
use super::solids::{mapped, Solid};
use crate::solver::{PairField, PairMethod, Problem, Shape};

const RADIUS: f64 = 50.0;
/// Width and height of both bodies, in half widths of the contact, and edges of faces grow by this factor outside of it.
const SIZE: f64 = 24.0;
const GROWTH: f64 = 1.25;

/// From 0 to `SIZE`, in steps of h up to 1.5.
fn graded(h: f64) -> Vec<f64> {
    let mut x = vec![0.0];
    let mut step = h;
    while x[x.len() - 1] < SIZE {
        let last = x[x.len() - 1];
        step *= if last < 1.5 { 1.0 } else { GROWTH };
        x.push(last + step);
    }
    let (end, last) = (x.len() - 1, x[x.len() - 1]);
    let inner = 1.5 + h;
    (0..=end).for_each(|k| {
        x[k] = if x[k] <= inner { x[k] } else { inner + (x[k] - inner) * (SIZE - inner) / (last - inner) }
    });
    x
}

/// Height of the cylinder.
fn height(x: f64) -> f64 {
    RADIUS - (RADIUS * RADIUS - x * x).sqrt()
}

/// The upper body, with grid lines shifted by the part `shift` of a step, or the lower one.
fn body(shape: Shape, h: f64, shift: f64, upper: bool) -> Solid {
    let line = graded(h);
    let last = line.len() - 1;
    let corner = |at: [usize; 3]| {
        let k = at[0].abs_diff(last);
        let x = if at[0] < last { -line[k] } else { line[k] };
        let y = if upper { line[at[1]] } else { -line[last - at[1]] };
        [x + if k < last { shift * h * (1.0 - line[k] / SIZE) } else { 0.0 }, y, 0.0]
    };
    let to = |x: [f64; 3]| if upper { [x[0], x[1] + height(x[0]) * (1.0 - x[1] / SIZE), 0.0] } else { x };
    mapped(shape, &[2 * last, last], corner, to)
}

/// The largest error of the pressure inside .9 a, in parts of the peak, and the largest pressure outside of 1.1 a.
fn worst(shape: Shape, h: f64) -> [f64; 2] {
    let (mut lower, mut upper) = (body(shape, 0.8 * h, 0.0, false), body(shape, h, 0.23, true));
    lower.hold(|x, _| x[1] == -SIZE);
    upper.hold(|x, i| i == 0 && x[1] == SIZE);
    // E* of two bodies with E = 1 and Poisson's ratio 0.3
    let modulus = 0.5 / (1.0 - 0.3 * 0.3);
    let total = std::f64::consts::PI * modulus / (4.0 * RADIUS);
    let mut top: Vec<usize> = upper.faces[1].iter().map(|node| *node as usize).collect();
    top.sort_unstable();
    top.dedup();
    let mut load = vec![0.0; upper.x.len()];
    // far away any distribution of the force does: its top is straight
    let unit: Vec<f64> = (0..load.len()).map(|i| if i % 2 == 1 { upper.x[i] } else { 0.0 }).collect();
    let forces = upper.forces(&unit);
    let sum: f64 = top.iter().map(|node| forces[2 * node + 1]).sum();
    top.iter().for_each(|node| load[2 * node + 1] = -total * forces[2 * node + 1] / sum);
    let mut problem = Problem::new();
    let zeros = vec![0.0; lower.x.len()];
    let bodies = [lower.give(&mut problem, &zeros), upper.give(&mut problem, &load)];
    let near = |of: &mut Solid, top: bool, most: f64| {
        let side = &mut of.faces[usize::from(top)];
        let nodes = of.shape.nodes();
        let kept =
            side.chunks(nodes).filter(|face| face.iter().all(|node| of.x[2 * *node as usize].abs() < most));
        *side = kept.flatten().copied().collect();
    };
    near(&mut lower, true, 3.5);
    near(&mut upper, false, 2.5);
    let (master, slave) =
        (lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false));
    let made = pair_by(&mut problem, PairMethod::Mortar, slave, master, 1.5);
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let field = |field| problem.pair_field(made, field).unwrap();
    let (pressure, force) = (field(PairField::Pressure), field(PairField::Force));
    let sum: f64 = force.iter().sum();
    let a = (4.0 * sum * RADIUS / (std::f64::consts::PI * modulus)).sqrt();
    let peak = 2.0 * sum / (std::f64::consts::PI * a);
    let centre = force.iter().enumerate().map(|(node, f)| f * upper.x[2 * node]).sum::<f64>() / sum;
    let mut worst = [0.0f64; 2];
    for node in 0..pressure.len() {
        let x = (upper.x[2 * node] - centre).abs() / a;
        if pressure[node] == 0.0 && x > 0.9 {
            continue;
        }
        let expected = peak * (1.0 - x * x).max(0.0).sqrt();
        if upper.x[2 * node + 1] < 0.1 && x < 0.9 && upper.faces[0].contains(&(node as i64)) {
            worst[0] = worst[0].max((pressure[node] - expected).abs() / peak);
        } else if x > 1.1 {
            worst[1] = worst[1].max(pressure[node] / peak);
        }
    }
    worst
}

#[test]
fn the_pressure_under_a_cylinder_is_that_of_hertz() {
    for (shape, h, limit) in [(Shape::Line2, 0.125, 0.005), (Shape::Line3, 0.25, 0.012)] {
        let [inside, outside] = worst(shape, h);
        println!("{shape:?} {h}: {inside:.2e} {outside:.1e}");
        assert!(inside <= limit && outside < 1e-6, "{shape:?}: {inside} {outside}");
    }
}
