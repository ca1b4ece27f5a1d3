//! Answers against all combinations of states.

use feti_contact::linalg::Matrix;
use feti_contact::qp::friction::{FrictionStart, Node};
use feti_contact::qp::Verdict;

use crate::friction::enumeration::answers;
use crate::friction::problem::{Given, Random};

fn matrix(entries: [[f64; 2]; 2]) -> Matrix {
    Matrix::from_fn(2, 2, |i, j| entries[i][j]).unwrap()
}

fn is_one_of(x: &[f64], answers: &[Vec<f64>], accuracy: f64) -> bool {
    answers.iter().any(|answer| answer.iter().zip(x).all(|(a, b)| (a - b).abs() <= accuracy))
}

/// Where there are answers and whether one was found: solved, unsolved, without any.
fn compared(given: &Given, accuracy: f64, count: &mut [usize; 3]) {
    let answers = answers(given);
    let found = given.solved();
    match (found.verdict == Verdict::Solved, answers.is_empty()) {
        (true, _) => {
            assert!(is_one_of(&found.x, &answers, accuracy), "{:?} is none of {answers:?}", found.x);
            count[0] += 1;
        }
        (false, false) => count[1] += 1,
        (false, true) => count[2] += 1,
    }
}

#[test]
fn a_coercive_node_has_one_or_three_states_and_one_of_them_is_found() {
    let mut random = Random::new(1);
    for mu in [0.5, 2.0, 4.0] {
        for _ in 0..250 {
            let node = Node::new(Some(0), &[1], mu, 0.0).unwrap();
            let given = Given::new(matrix([[1.0, 0.8], [0.8, 1.0]]), random.vector(2), vec![node]);
            let all = answers(&given);
            let found = given.solved();
            assert!(all.len() == 1 || all.len() == 3, "{all:?}");
            assert!(
                found.verdict == Verdict::Solved && is_one_of(&found.x, &all, 1e-8),
                "{mu} {:?}",
                given.d
            );
        }
    }
}

#[test]
fn a_floating_node_rests_where_it_can_and_nothing_is_claimed_where_it_cannot() {
    let mut random = Random::new(2);
    let (mut rests, mut none) = (0, 0);
    for _ in 0..750 {
        let node = Node::new(Some(0), &[1], 2.0, 0.0).unwrap();
        let (d, e) = (random.vector(2), random.next());
        let given = Given::new(matrix([[1.0, -0.8], [-0.8, 1.0]]), d, vec![node])
            .floating(&[vec![0.0, 1.0]], vec![e]);
        let n = given.d[0] + 0.8 * e;
        let can = n >= 0.0 && e.abs() <= 2.0 * n;
        let found = given.solved();
        assert_eq!(found.verdict == Verdict::Solved, can, "{:?} {e}: {:?}", given.d, found.verdict);
        if can {
            assert!((found.x[0] - n).abs() < 1e-9 && (found.x[1] - e).abs() < 1e-9, "{:?}", found.x);
            rests += 1;
        } else {
            none += 1;
        }
    }
    assert!(rests > 200 && none > 200, "{rests} {none}");
}

fn nodes(count: usize, mu: f64, bound: f64) -> Vec<Node> {
    (0..count).map(|i| Node::new(Some(2 * i), &[2 * i + 1], mu, bound).unwrap()).collect()
}

#[test]
fn answers_in_the_plane_are_among_all_combinations_of_states() {
    let mut random = Random::new(3);
    let mut count = [0; 3];
    for case in 0..120 {
        let k = 2 + case % 4;
        let mu = [0.1, 0.4, 0.8, 0.0][case / 4 % 4];
        let bound = [0.0, 0.0, 0.3][case % 3];
        if bound > 0.0 && k > 4 {
            continue;
        }
        let (f, d) = (random.positive(2 * k, 0.1), random.vector(2 * k));
        compared(&Given::new(f, d, nodes(k, mu, bound)), 1e-6, &mut count);
    }
    assert!(count[0] >= 90 && count[1] == 0, "{count:?}");
}

#[test]
fn answers_of_floating_nodes_in_the_plane_are_among_all_combinations_of_states() {
    let mut random = Random::new(4);
    let mut count = [0; 3];
    for case in 0..120 {
        let k = 2 + case % 4;
        let mu = [0.1, 0.4, 0.8, 0.2][case / 4 % 4];
        let (f, d) = (random.positive(2 * k, 0.1), random.vector(2 * k));
        // one motion normal to the surface, one along it
        let g: Vec<Vec<f64>> = (0..2)
            .map(|mode| {
                (0..2 * k)
                    .map(|i| if i % 2 == mode { 1.0 / (k as f64).sqrt() } else { 0.1 * random.next() })
                    .collect()
            })
            .collect();
        let e = vec![1.0, 0.9 * mu * random.next()];
        compared(&Given::new(f, d, nodes(k, mu, 0.0)).floating(&g, e), 1e-6, &mut count);
    }
    println!("{count:?}");
    assert!(count[0] >= 80 && count[1] <= 2, "{count:?}");
}

/// Forces lie within the cones to rounding, not to the tolerance alone, and nodes that are open have none at all.
#[test]
fn forces_of_an_answer_are_within_the_cones_to_rounding() {
    let mut random = Random::new(11);
    let (mut open, mut slipping) = (0, 0);
    for case in 0..60 {
        let k = 3 + case % 4;
        let (f, d) = (random.positive(2 * k, 0.1), random.vector(2 * k));
        let given = Given::new(f, d, nodes(k, 0.5, [0.0, 0.1][case % 2]));
        let found = given.from(FrictionStart::default(), 1e-4, 0);
        assert_eq!(found.verdict, Verdict::Solved, "{case}");
        let size = found.x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let r = given.gaps(&found);
        for node in given.cones.nodes() {
            let (n, t) = (found.x[node.normal.unwrap()], found.x[node.tangents()[0]]);
            let limit = node.limit(n);
            assert!(n >= 0.0 && t.abs() <= limit + 1e-15 * size, "{case}: {n:e} {t:e} {limit:e}");
            if r[node.normal.unwrap()] > 0.01 {
                assert_eq!(n, 0.0, "{case}");
                open += 1;
            }
            slipping += usize::from(limit > 0.0 && t.abs() >= limit - 1e-15 * size);
        }
    }
    assert!(open > 20 && slipping > 20, "{open} {slipping}");
}

/// Larger coefficients and as many as 8 nodes; what is not solved although there are answers is told.
#[test]
#[ignore]
fn many_more_answers_are_among_all_combinations_of_states() {
    let mut random = Random::new(10);
    let (mut plain, mut floating) = ([0; 3], [0; 3]);
    for case in 0..400 {
        let k = 3 + case % 4 + 2 * usize::from(case % 40 == 0);
        let mu = [0.1, 0.6, 1.2, 2.5][case / 4 % 4];
        let (f, d) = (random.positive(2 * k, [0.3, 0.01][case % 2]), random.vector(2 * k));
        compared(&Given::new(f.clone(), d.clone(), nodes(k, mu, 0.0)), 1e-3, &mut plain);
        let g: Vec<Vec<f64>> = (0..2)
            .map(|mode| (0..2 * k).map(|i| if i % 2 == mode { 0.4 } else { 0.1 * random.next() }).collect())
            .collect();
        let e = vec![1.0, 0.95 * mu * random.next()];
        compared(&Given::new(f, d, nodes(k, mu, 0.0)).floating(&g, e), 1e-3, &mut floating);
    }
    println!("solved, unsolved, without answer: held {plain:?}, floating {floating:?}");
    assert!(plain[1] + floating[1] <= 8, "{plain:?} {floating:?}");
}
