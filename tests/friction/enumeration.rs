//! All combinations of states in the plane, one linear system each.

use feti_contact::qp::friction::Node;

use crate::friction::problem::Given;

#[derive(Clone, Copy, PartialEq)]
enum Tangential {
    Stick,
    Slip(f64),
}

/// A x = b by elimination with pivots; none where A is singular.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    let size = a.iter().flatten().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    for k in 0..n {
        let p = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if a[p][k].abs() < 1e-10 * size {
            return None;
        }
        a.swap(k, p);
        b.swap(k, p);
        for i in k + 1..n {
            let by = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= by * a[k][j];
            }
            b[i] -= by * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    Some(b)
}

/// x of every combination of states that meets all laws; nodes have a normal row and one tangential row.
pub fn answers(given: &Given) -> Vec<Vec<f64>> {
    let (m, r) = (given.d.len(), given.e.len());
    let nodes = given.cones.nodes();
    let choices: Vec<Vec<(bool, Tangential)>> = nodes.iter().map(choices_of).collect();
    let count: usize = choices.iter().map(Vec::len).product();
    let mut found: Vec<Vec<f64>> = Vec::new();
    for mut number in 0..count {
        let states: Vec<(bool, Tangential)> = choices
            .iter()
            .map(|choices| {
                let state = choices[number % choices.len()];
                number /= choices.len();
                state
            })
            .collect();
        let (mut a, mut b) = (vec![vec![0.0; m + r]; m + r], vec![0.0; m + r]);
        // r = 0 at first
        for i in 0..m {
            (0..m).for_each(|j| a[i][j] = given.f.0.get(i, j));
            given.g_transposed.row(i).for_each(|(k, v)| {
                a[i][m + k] = -v;
                a[m + k][i] = v;
            });
            b[i] = given.d[i];
        }
        b[m..].copy_from_slice(&given.e);
        for (node, (closed, tangential)) in nodes.iter().zip(&states) {
            let (n, t) = (node.normal.unwrap(), node.tangents()[0]);
            if !closed {
                a[n].fill(0.0);
                (a[n][n], b[n]) = (1.0, 0.0);
            }
            if let Tangential::Slip(sign) = tangential {
                a[t].fill(0.0);
                (a[t][t], b[t]) = (1.0, sign * node.bound);
                if *closed {
                    a[t][n] = -sign * node.mu;
                }
            }
        }
        let Some(x) = solve(a, b) else { continue };
        let known = |other: &Vec<f64>| other.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-8);
        if meets(given, &states, &x) && !found.iter().any(known) {
            found.push(x);
        }
    }
    found.iter().map(|x| x[..m].to_vec()).collect()
}

fn choices_of(node: &Node) -> Vec<(bool, Tangential)> {
    let mut choices =
        vec![(true, Tangential::Stick), (true, Tangential::Slip(1.0)), (false, Tangential::Slip(0.0))];
    if node.mu > 0.0 || node.bound > 0.0 {
        choices.push((true, Tangential::Slip(-1.0)));
    }
    if node.bound > 0.0 {
        choices.pop();
        choices[2] = (false, Tangential::Slip(1.0));
        choices.extend([
            (true, Tangential::Slip(-1.0)),
            (false, Tangential::Slip(-1.0)),
            (false, Tangential::Stick),
        ]);
    }
    choices
}

fn meets(given: &Given, states: &[(bool, Tangential)], x: &[f64]) -> bool {
    const NONE: f64 = 1e-9;
    let m = given.d.len();
    let r = |i: usize| {
        let force: f64 = (0..m).map(|j| given.f.0.get(i, j) * x[j]).sum();
        force - given.d[i] - given.g_transposed.row_dot(i, &x[m..])
    };
    given.cones.nodes().iter().zip(states).all(|(node, (closed, tangential))| {
        let (n, t) = (node.normal.unwrap(), node.tangents()[0]);
        let normal = if *closed { x[n] >= -NONE } else { r(n) >= -NONE };
        let limit = node.bound + node.mu * x[n].max(0.0);
        let tangent = match tangential {
            Tangential::Stick => x[t].abs() <= limit + NONE,
            Tangential::Slip(sign) => limit <= NONE || -r(t) * sign >= -NONE,
        };
        normal && tangent
    })
}
