//! Projections on single cones by brute force, on cones and `G x = e` by the inequality that says nearest.

use feti_contact::qp::friction::{Force, Node};

use crate::friction::problem::{Given, Random};

fn length(t: [f64; 2]) -> f64 {
    t[0].hypot(t[1])
}

/// The least square distance over n, t being the nearest for every n: by three parts of an interval.
fn least_distance(node: &Node, force: Force) -> f64 {
    let size = length(force.tangential);
    let at = |n: f64| {
        let beyond = (size - node.bound - node.mu * n).max(0.0);
        (n - force.normal).powi(2) + beyond.powi(2)
    };
    let (mut low, mut high) = (0.0, 10.0 + force.normal.abs() + size);
    for _ in 0..200 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(a) < at(b) {
            high = b
        } else {
            low = a
        }
    }
    at(0.5 * (low + high)).min(at(0.0))
}

#[test]
fn the_nearest_force_of_a_cone_is_in_it_and_no_other_is_nearer() {
    let mut random = Random::new(5);
    for case in 0..4000 {
        let mu = [0.0, 0.1, 0.6, 3.0][case % 4];
        let bound = [0.0, 0.4, 0.0, 1.5][case / 4 % 4];
        let node = Node::new(Some(0), &[1, 2], mu, bound).unwrap();
        let force =
            Force { normal: 2.0 * random.next(), tangential: [2.0 * random.next(), 2.0 * random.next()] };
        let (nearest, _) = node.nearest(force);
        assert!(nearest.normal >= 0.0);
        assert!(
            length(nearest.tangential) <= (bound + mu * nearest.normal) * (1.0 + 1e-14),
            "{node:?} {force:?}"
        );
        let away: f64 = (0..2).map(|k| (nearest.tangential[k] - force.tangential[k]).powi(2)).sum();
        let own = away + (nearest.normal - force.normal).powi(2);
        let least = least_distance(&node, force);
        assert!((own - least).abs() <= 1e-9 * (1.0 + least), "{node:?} {force:?}: {own} {least}");
        let again = node.nearest(nearest).0.normal;
        assert!(
            (again - nearest.normal).abs() <= 1e-14 * (1.0 + nearest.normal),
            "a projection repeats itself"
        );
    }
}

/// The nearest point p of a convex set is the one with `(v - p).(y - p) <= 0` for all its points y.
#[test]
fn the_nearest_forces_of_nodes_that_share_a_normal_force_are_nearest() {
    let mut random = Random::new(15);
    for case in 0..400 {
        let count = 2 + case % 4;
        let node = |i: usize, random: &mut Random| {
            let (mu, bound) = (random.next().abs() + 0.1, [0.0, 0.4][case / 4 % 2]);
            Node::new(Some(2 * count), &[2 * i, 2 * i + 1], mu, bound).unwrap()
        };
        let nodes: Vec<Node> = (0..count).map(|i| node(i, &mut random)).collect();
        let cones = feti_contact::qp::friction::Cones::new(2 * count + 1, nodes.clone()).unwrap();
        let v: Vec<f64> = random.vector(2 * count + 1).iter().map(|v| 3.0 * v).collect();
        let point = cones.nearest(&v).0;
        let beyond = |node: &Node| {
            let force = node.of(&point);
            length(force.tangential) - node.limit(force.normal)
        };
        assert!(point[2 * count] >= 0.0 && nodes.iter().all(|node| beyond(node) <= 1e-14), "{case}");
        for _ in 0..200 {
            let normal = 4.0 * random.next().abs();
            let mut y = vec![normal; 2 * count + 1];
            for node in &nodes {
                let t = [random.next(), random.next()];
                let by = node.limit(normal) * random.next().abs() / length(t);
                node.put(Force { normal, tangential: t.map(|t| by * t) }, &mut y);
            }
            let product: f64 = (0..y.len()).map(|i| (v[i] - point[i]) * (y[i] - point[i])).sum();
            assert!(product <= 1e-12, "{case}: {product:e}");
        }
    }
}

/// Nodes that share a normal row, on bodies that are held and that float, with an elastic coupling of everything.
#[test]
fn nodes_that_share_a_normal_force_are_solved() {
    let mut random = Random::new(16);
    let mut solved = 0;
    for case in 0..60 {
        let (count, dim) = (2 + case % 3, 1 + case % 2);
        let m = count * dim + 1;
        let node = |i: usize| {
            let tangents: Vec<usize> = (0..dim).map(|k| dim * i + k).collect();
            Node::new(Some(m - 1), &tangents, 0.1 + 0.1 * i as f64, 0.0).unwrap()
        };
        let mut given = Given::new(random.positive(m, 0.3), random.vector(m), (0..count).map(node).collect());
        given.d[m - 1] += 1.0;
        if case % 4 == 3 {
            let mut g = random.vector(m).iter().map(|v| 0.1 * v).collect::<Vec<_>>();
            g[m - 1] = 1.0;
            given = given.floating(&[g], vec![0.8]);
        }
        let found = given.solved();
        if found.verdict == feti_contact::qp::Verdict::Solved {
            let (laws, balance) = given.missed(&found);
            assert!(laws < 1e-8 && balance < 1e-9, "{case}: {laws:e} {balance:e}");
            solved += 1;
        }
    }
    assert!(solved >= 59, "{solved}");
}

#[test]
fn the_law_of_coulomb_is_met_by_stick_inside_and_slip_along_the_force_alone() {
    let node = Node::new(Some(0), &[1, 2], 0.5, 0.1).unwrap();
    let cones = feti_contact::qp::friction::Cones::new(3, vec![node]).unwrap();
    let missed = |x: [f64; 3], r: [f64; 3]| {
        cones.law(&x, &r, 0.7).iter().fold(0.0, |largest: f64, v| largest.max(v.abs()))
    };
    let stick = missed([2.0, 0.3, -0.4], [0.0; 3]);
    // the slip is -r_t
    let slip = missed([2.0, 0.66, -0.88], [0.0, -0.3, 0.4]);
    let open = missed([0.0, 0.06, 0.08], [1.0, -0.6, -0.8]);
    assert!(stick < 1e-15 && slip < 1e-15 && open < 1e-15, "{stick} {slip} {open}");
    assert!(missed([2.0, 0.66, -0.88], [0.0, 0.3, -0.4]) > 0.1, "slip against the force");
    assert!(missed([2.0, 0.3, -0.4], [0.0, -0.3, 0.4]) > 0.1, "slip inside the cone");
    assert!(missed([2.0, 0.9, -1.2], [0.0; 3]) > 0.1, "a force outside of the cone");
}

#[test]
fn wrong_nodes_are_refused() {
    assert!(Node::new(None, &[0], 0.3, 0.0).is_err(), "mu without a normal row");
    assert!(Node::new(None, &[0], 0.0, 0.3).is_ok());
    assert!(Node::new(Some(0), &[1, 2, 3], 0.3, 0.0).is_err());
    for (mu, bound) in [(-0.1, 0.0), (f64::NAN, 0.0), (f64::INFINITY, 0.0), (0.1, -1.0), (0.1, f64::NAN)] {
        assert!(Node::new(Some(0), &[1], mu, bound).is_err(), "{mu} {bound}");
    }
    let node = |n, t| Node::new(Some(n), &[t], 0.1, 0.0).unwrap();
    assert!(feti_contact::qp::friction::Cones::new(3, vec![node(0, 1), node(1, 2)]).is_err());
    assert!(feti_contact::qp::friction::Cones::new(2, vec![node(0, 2)]).is_err());
}

/// With F = 1 and mu = 0 the laws are those of the nearest point: `x = argmin |x - d|` in the discs with `G x = e`.
#[test]
fn discs_of_constant_size_have_the_nearest_point_as_their_answer() {
    let mut random = Random::new(6);
    for _ in 0..60 {
        let k = 5;
        let nodes: Vec<Node> =
            (0..k).map(|i| Node::new(Some(3 * i), &[3 * i + 1, 3 * i + 2], 0.0, 0.6).unwrap()).collect();
        let identity =
            feti_contact::linalg::Matrix::from_fn(3 * k, 3 * k, |i, j| f64::from(u8::from(i == j))).unwrap();
        let g: Vec<Vec<f64>> = (0..3)
            .map(|c| (0..3 * k).map(|i| if i % 3 == c { 0.4 } else { 0.05 * random.next() }).collect())
            .collect();
        let e = vec![1.0, 0.5 * random.next(), 0.5 * random.next()];
        let given = Given::new(identity, random.vector(3 * k), nodes).floating(&g, e);
        let found = given.solved();
        let (laws, balance) = given.missed(&found);
        assert!(laws < 1e-8 && balance < 1e-10, "{:?} {laws:e} {balance:e}", found.verdict);
    }
}
