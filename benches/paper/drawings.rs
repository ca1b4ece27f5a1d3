//! The pictures of docs/paper.md.

use std::path::Path;

use crate::case::Case;
use crate::plot::{marked, Mark, Plot, Series, BLUE, GREEN, GREY, RED};
use crate::problems::PROBLEMS;
use crate::run::{as_in_paper, by_default, handed_over, history, Run};

type Drawing = fn() -> Result<Plot, String>;

/// Writes all pictures; their names.
pub fn all(folder: &Path) -> Result<Vec<String>, String> {
    let drawings: [(&str, Drawing); 4] = [
        ("paper_membranes.svg", membranes),
        ("paper_cylinders.svg", cylinders),
        ("paper_blocks.svg", blocks),
        ("paper_histories.svg", histories),
    ];
    std::fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    let mut names = Vec::new();
    for (name, draw) in drawings {
        let path = folder.join(name);
        std::fs::write(&path, draw()?.svg()).map_err(|e| format!("{}: {e}", path.display()))?;
        names.push(path.display().to_string());
    }
    Ok(names)
}

/// The answer of a problem of the table.
fn solved(name: &str) -> Result<(Case, Run), String> {
    let problem = PROBLEMS.iter().find(|p| p.name == name).ok_or("no such problem")?;
    Ok((Case::read(problem.data), by_default(problem)?))
}

/// Problem 1 seen from above at an angle: grid lines of both membranes, the closed nodes of x = 1 marked.
fn membranes() -> Result<Plot, String> {
    const LINE: usize = 21;
    let (_, run) = solved("p1")?;
    let h = 1.0 / (LINE - 1) as f64;
    let view = |x: f64, y: f64, u: f64| (x + 0.45 * y, 0.35 * y + 0.9 * u);
    // the held line x = 0 is no unknown
    let u = |body: usize, i: usize, j: usize| match (body, i) {
        (0, 0) => 0.0,
        (0, _) => run.displacement[(i - 1) * LINE + j],
        _ => run.displacement[(LINE - 1) * LINE + i * LINE + j],
    };
    let at = |body: usize, i: usize, j: usize| view(body as f64 + i as f64 * h, j as f64 * h, u(body, i, j));
    let sheet = |body: usize| -> Vec<Vec<(f64, f64)>> {
        let along = (0..LINE).map(|i| (0..LINE).map(|j| at(body, i, j)).collect());
        along.chain((0..LINE).map(|j| (0..LINE).map(|i| at(body, i, j)).collect())).collect()
    };
    let contact = (0..LINE).filter(|&j| run.forces[j] > 0.0).map(|j| at(0, LINE - 1, j)).collect();
    Ok(Plot {
        title: "Problem 1: two membranes, contact along x = 1".into(),
        x: "x + 0.45 y (seen at an angle; no units)".into(),
        y: "0.9 u + 0.35 y".into(),
        logarithmic: [false; 2],
        equal: false,
        series: vec![
            Series { name: "Omega_1", colour: BLUE, mark: Mark::Line(0.8), lines: sheet(0) },
            Series { name: "Omega_2", colour: GREEN, mark: Mark::Line(0.8), lines: sheet(1) },
            Series { name: "contact zone", colour: RED, mark: Mark::Disc(3.5), lines: vec![contact] },
        ],
    })
}

/// Problem 2 A: nodal forces between the cylinders, and the integral of Hertz' pressure over the spacing of the nodes.
/// R = 1 mm, E = 2.1e5 N/mm^2, thickness 1 mm, plane stress.
fn cylinders() -> Result<Plot, String> {
    const NODES: usize = 7;
    let (_, run) = solved("p2_A")?;
    let spacing = 5f64.to_radians();
    let place = |k: usize| ((k as f64 - 3.0) * spacing).sin();
    let load: f64 = (0..NODES).map(|k| run.forces[k] * ((k as f64 - 3.0) * spacing).cos()).sum();
    let (modulus, radius) = (0.5 * 2.1e5, 0.5);
    let half_width = (4.0 * load * radius / (std::f64::consts::PI * modulus)).sqrt();
    let peak = 2.0 * load / (std::f64::consts::PI * half_width);
    let hertz = |x: f64| spacing * peak * (1.0 - (x / half_width).powi(2)).max(0.0).sqrt();
    let curve = (0..=200).map(|k| (k as f64 / 100.0 - 1.0) * half_width).map(|x| (x, hertz(x))).collect();
    let forces = (0..NODES).map(|k| (place(k), run.forces[k])).collect();
    Ok(Plot {
        title: "Problem 2: contact forces between the cylinders".into(),
        x: "x / mm".into(),
        y: "nodal force / N".into(),
        logarithmic: [false; 2],
        equal: false,
        series: vec![
            Series { name: "Hertz", colour: GREY, mark: Mark::Line(1.5), lines: vec![curve] },
            Series { name: "multipliers", colour: RED, mark: Mark::Disc(4.0), lines: vec![forces] },
        ],
    })
}

/// A node: its unknowns along x and z among all, none where it is fixed, and its place.
struct Node {
    dofs: Option<[usize; 2]>,
    place: (f64, f64),
}

impl Node {
    fn has(&self, dof: i64) -> bool {
        self.dofs.is_some_and(|dofs| dofs.contains(&(dof as usize)))
    }
}

/// Nodes of a floating block, whose rigid motions (1, 0), (0, 1), (z, -x) tell unknowns and places.
fn nodes(case: &Case, body: usize) -> Vec<Node> {
    let orders = case.bodies.iter().map(|(k, _)| k.ptr.len() - 1);
    let start: usize = orders.take(body).sum();
    let (k, r) = &case.bodies[body];
    let n = k.ptr.len() - 1;
    let (along, up, turn) = (&r[..n], &r[n..2 * n], &r[2 * n..]);
    let mut found = Vec::new();
    let mut last = None;
    for dof in 0..n {
        if along[dof] != 0.0 {
            last = Some(dof);
        } else if up[dof] != 0.0 {
            if let Some(x) = last.take() {
                found.push(Node { dofs: Some([start + x, start + dof]), place: (-turn[dof], turn[x]) });
            }
        }
    }
    found
}

/// The first node that a row with the unknown joins to it.
fn partner<'a>(case: &Case, dof: i64, others: &'a [Node]) -> Option<&'a Node> {
    let rows = &case.contact.0;
    let joined = |i: usize| &rows.col[rows.ptr[i]..rows.ptr[i + 1]];
    let mut touching = (0..rows.ptr.len() - 1).map(joined).filter(|row| row.contains(&dof));
    touching.find_map(|row| others.iter().find(|n| row.iter().any(|&j| j != dof && n.has(j))))
}

/// Moves the third block to its place beside the second one: rows join nodes of both at the same place.
fn shift(case: &Case, second: &[Node], third: &mut [Node]) -> Option<()> {
    let (x, z) = third.iter().find_map(|n| {
        let other = partner(case, n.dofs?[0] as i64, second)?;
        Some((other.place.0 - n.place.0, other.place.1 - n.place.1))
    })?;
    third.iter_mut().for_each(|n| n.place = (n.place.0 + x, n.place.1 + z));
    Some(())
}

/// The front of the base, 12 nodes in each of two free layers of 456 unknowns and in a fixed one below. Its top nodes
/// stand where the nodes do that rows press on them.
fn base(case: &Case, above: &[&[Node]]) -> Option<Vec<Node>> {
    const FRONT: usize = 12;
    const LAYER: usize = 456;
    const HEIGHT: f64 = 0.25;
    let mut found = Vec::new();
    for i in 0..FRONT {
        let top = (LAYER + 2 * i + 1) as i64;
        let (x, z) = above.iter().find_map(|nodes| partner(case, top, nodes))?.place;
        for (down, layer) in [(0.0, Some(LAYER)), (HEIGHT, Some(0)), (2.0 * HEIGHT, None)] {
            let dofs = layer.map(|first| [first + 2 * i, first + 2 * i + 1]);
            found.push(Node { dofs, place: (x, z - down) });
        }
    }
    Some(found)
}

/// Grid lines through nodes, in their places moved by `scale` u.
fn grid(nodes: &[Node], u: &[f64], scale: f64) -> Vec<Vec<(f64, f64)>> {
    let at = |n: &Node| {
        let u = n.dofs.map_or([0.0; 2], |dofs| dofs.map(|dof| u[dof]));
        (n.place.0 + scale * u[0], n.place.1 + scale * u[1])
    };
    let key = |v: f64| (v * 1e6).round() as i64;
    let mut lines = Vec::new();
    for by_x in [true, false] {
        let line_of = |n: &Node| if by_x { key(n.place.0) } else { key(n.place.1) };
        let along = |n: &Node| if by_x { key(n.place.1) } else { key(n.place.0) };
        let mut sorted: Vec<&Node> = nodes.iter().collect();
        sorted.sort_by_key(|n| (line_of(n), along(n)));
        sorted.dedup_by_key(|n| (line_of(n), along(n)));
        lines.extend(
            sorted.chunk_by(|a, b| line_of(a) == line_of(b)).map(|l| l.iter().map(|n| at(n)).collect()),
        );
    }
    lines
}

/// Problem 3, three blocks: two that float on a base that is fixed below and beside each other; the front of all.
fn blocks() -> Result<Plot, String> {
    let (case, run) = solved("p3_3block")?;
    let (second, mut third) = (nodes(&case, 1), nodes(&case, 2));
    shift(&case, &second, &mut third).ok_or("the blocks have no common row")?;
    let base = base(&case, &[&second, &third]).ok_or("a node on top of the base has no row")?;
    let all = [second, third, base];
    let dofs = all.iter().flatten().filter_map(|n| n.dofs).flatten();
    let scale = 0.3 / dofs.map(|dof| run.displacement[dof].abs()).fold(0.0, f64::max);
    let every =
        |scale: f64| all.iter().flat_map(|nodes| grid(nodes, &run.displacement, scale)).collect::<Vec<_>>();
    let fixed = all[2].iter().filter(|n| n.dofs.is_none()).map(|n| n.place).collect();
    Ok(Plot {
        title: format!("Problem 3: three blocks, displacements x {scale:.0}"),
        x: "x / m".into(),
        y: "z / m".into(),
        logarithmic: [false; 2],
        equal: true,
        series: vec![
            Series { name: "before", colour: GREY, mark: Mark::Line(0.6), lines: every(0.0) },
            Series { name: "deformed", colour: BLUE, mark: Mark::Line(0.9), lines: every(scale) },
            Series { name: "fixed", colour: RED, mark: Mark::Line(2.0), lines: vec![fixed] },
        ],
    })
}

/// Problem 1: error of the forces after every step of both methods, each to its own end.
fn histories() -> Result<Plot, String> {
    let problem = &PROBLEMS[0];
    let case = Case::read(problem.data);
    let mut paper = as_in_paper(&case, problem).map_err(|e| e.to_string())?;
    let mut default = handed_over(&case, false).map_err(|e| e.to_string())?;
    // cut short, the iteration itself is to be seen, not what would complete it
    default.set_i64("direct_limit", 0).map_err(|e| e.to_string())?;
    let mut all =
        Vec::from(marked("paper: Algorithm 3, extrapolating", RED, history(&case, &mut paper, 200)));
    all.extend(marked("default", BLUE, history(&case, &mut default, 200)));
    Ok(Plot {
        title: "Problem 1: largest error of a force".into(),
        x: "products with F".into(),
        y: "relative to the largest force".into(),
        logarithmic: [false, true],
        equal: false,
        series: all,
    })
}
