//! Pairs on bodies in every form in which hosts give them.

use super::*;
use crate::body::Lending;
use crate::solver::tests::lent::served;
use crate::solver::{ElementStorage, Outcome, PairField, Storage};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    /// Two bodies with their own unknowns.
    Bodies,
    /// One K for both.
    OneMatrix,
    /// Elements, cut by the library.
    Pieces,
    /// Unknowns by numbers of the host.
    Numbers,
    /// The lower block in two halves that share numbers.
    Glued,
    /// A limit that no dual operator fits into.
    Implicit,
}

/// The unknown of every direction by its number: any order of different numbers.
fn numbers(block: &Block, first: usize, all: usize) -> Vec<i64> {
    let number = |dof: &i64| if *dof < 0 { -1 } else { (101 * (first as i64 + dof) + 3) % all as i64 };
    block.dof.iter().map(number).collect()
}

fn dense_of(problem: &mut Problem, order: usize, at: impl Fn(usize, usize) -> f64) -> usize {
    let body = problem.add_body(order).unwrap();
    let k: Vec<f64> = (0..order * order).map(|i| at(i % order, i / order)).collect();
    problem.set_stiffness_dense(body, order, &k, order, Storage::Full).unwrap();
    body
}

/// Half of the elements over the unknowns that they touch, with their numbers.
fn give_half(problem: &mut Problem, block: &Block, numbers: &[i64], second: bool) {
    let (dim, of_element) = (block.dim, 1 << block.dim);
    let elements: Vec<&[usize]> = block.corners.chunks(of_element).collect();
    let (first, rest) = elements.split_at(elements.len() / 2);
    let own = if second { rest } else { first };
    let mut used: Vec<usize> = own
        .concat()
        .iter()
        .flat_map(|node| dim * node..dim * (node + 1))
        .filter(|i| numbers[*i] >= 0)
        .collect();
    used.sort_unstable();
    used.dedup();
    let (n, order) = (used.len(), dim * of_element);
    let mut k = vec![0.0; n * n];
    for element in own {
        let place = |a: usize| used.binary_search(&(dim * element[a / dim] + a % dim)).ok();
        for (a, b) in (0..order).flat_map(|a| (0..order).map(move |b| (a, b))) {
            if let Some((i, j)) = place(a).zip(place(b)) {
                k[i + n * j] += block.ke[a * order + b];
            }
        }
    }
    let body = dense_of(problem, n, |i, j| k[i + n * j]);
    let own: Vec<i64> = used.iter().map(|i| numbers[*i]).collect();
    problem.set_numbering(body, &own).unwrap();
}

/// Forces and slips of the nodes of the foot.
fn solved(form: Form, dim: usize, lending: Option<Lending>) -> [Vec<f64>; 2] {
    let blocks = stacked(dim);
    let [lower, upper] = &blocks;
    let all = lower.free + upper.free;
    let mut problem = Problem::new();
    problem.prepared.lending = lending;
    let mut dofs = [lower.dof.clone(), upper.dof.clone()];
    let mut bodies = [Some(0), Some(1)];
    match form {
        Form::Bodies | Form::Implicit => blocks.iter().for_each(|block| {
            block.give(&mut problem);
        }),
        Form::OneMatrix => {
            let (a, b, m) = (lower.dense(), upper.dense(), lower.free);
            dense_of(&mut problem, all, |i, j| match (i < m, j < m) {
                (true, true) => a[i + m * j],
                (false, false) => b[i - m + upper.free * (j - m)],
                _ => 0.0,
            });
            dofs[1].iter_mut().filter(|dof| **dof >= 0).for_each(|dof| *dof += m as i64);
            bodies = [Some(0); 2];
        }
        Form::Pieces => {
            problem.set_i64("pieces", 3).unwrap();
            for block in &blocks {
                let body = problem.add_body(block.free).unwrap();
                let (order, dof) = (block.dim << block.dim, block.element_dofs());
                let elements = dof.len() / order;
                let ptr: Vec<usize> = (0..=elements).map(|e| order * e).collect();
                problem.set_mesh(body, &ptr, &dof).unwrap();
                problem
                    .add_elements(body, 0, elements, &block.ke.repeat(elements), ElementStorage::Full)
                    .unwrap();
            }
        }
        Form::Numbers | Form::Glued => {
            problem.set_i64("glue", i64::from(form == Form::Glued)).unwrap();
            dofs = [numbers(lower, 0, all), numbers(upper, lower.free, all)];
            for (block, dof) in blocks.iter().zip(&dofs) {
                if form == Form::Glued && block.x[0] == lower.x[0] && block.x[dim - 1] == lower.x[dim - 1] {
                    [false, true].into_iter().for_each(|half| give_half(&mut problem, block, dof, half));
                    continue;
                }
                let body = block.give(&mut problem);
                let own: Vec<i64> = dof.iter().copied().filter(|number| *number >= 0).collect();
                problem.set_numbering(body, &own).unwrap();
            }
            bodies = [None; 2];
        }
    }
    if form == Form::Implicit {
        problem.set_str("dual_operator", "implicit").unwrap();
    }
    let master = lower.surface_of(&mut problem, bodies[0], &dofs[0], true);
    let slave = upper.surface_of(&mut problem, bodies[1], &dofs[1], false);
    let made = pair(&mut problem, slave, master, 0.1);
    problem.pair_set(made, "friction", &[0.3]).unwrap();
    problem.pair_set(made, "offset", &[1e-3]).unwrap();
    problem.pairs_find().unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{form:?}");
    [PairField::Force, PairField::Slip].map(|field| problem.pair_field(made, field).unwrap())
}

#[test]
fn pairs_do_the_same_on_bodies_in_every_form() {
    for dim in [2, 3] {
        let by_bodies = solved(Form::Bodies, dim, None);
        assert!(by_bodies[0].iter().any(|force| *force > 1e-6));
        for form in [Form::OneMatrix, Form::Pieces, Form::Numbers, Form::Glued, Form::Implicit] {
            for (found, expected) in solved(form, dim, None).iter().zip(&by_bodies) {
                let most = expected.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
                let worst =
                    found.iter().zip(expected).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
                assert!(worst < 1e-7 * most, "{form:?} in {dim} dimensions: {worst:e} of {most:e}");
            }
        }
    }
}

#[test]
fn pairs_have_the_same_bits_if_other_ranks_have_the_bodies() {
    for form in [Form::Bodies, Form::OneMatrix, Form::Pieces] {
        let served = served(|_, _| None);
        let lent = solved(form, 3, served.lending());
        assert_eq!(lent, solved(form, 3, None), "{form:?}");
        served.end();
    }
}
