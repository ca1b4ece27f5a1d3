//! Correct answers pass and wrong answers fail, in models with very different sizes.

use super::model::{chain, truss, DenseAnswer, DenseModel};

/// Two chains on the ground, the first pushed by 1 at its end against the second across a gap of .1.
fn held() -> DenseModel {
    let parts = vec![
        chain(&[2.0, 3.1, 1.7], &[(0, 4.3)]).loaded(&[(3, 1.0), (1, 0.3)]),
        chain(&[1.9, 2.3], &[(2, 3.7)]),
    ];
    let contact = vec![(vec![(3, 1.0), (4, -1.0)], 0.1, 0.0)];
    DenseModel { parts, contact, active: vec![0], ..DenseModel::default() }
}

#[test]
fn wrong_forces_and_motions_of_held_bodies_are_refused() {
    held().refuses_wrong_forces("held");
    held().refuses_wrong_motions("held", 1.0);
}

/// A free chain that travels before it touches a held one.
fn travelling(far: f64) -> DenseModel {
    let parts = vec![
        chain(&[2.0, 3.1, 1.7, 2.9], &[]).loaded(&[(0, 0.01), (2, 0.02)]),
        chain(&[1.9, 2.3], &[(2, 3.7)]),
    ];
    let contact = vec![(vec![(4, 1.0), (5, -1.0)], far, 0.0)];
    DenseModel { parts, contact, active: vec![0], travel: vec![far; 5], ..DenseModel::default() }
}

#[test]
fn travel_excuses_no_force() {
    for far in [0.0, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e8, 1e10] {
        travelling(far).refuses_wrong_forces(&format!("travel {far:e}"));
        if far <= 1e4 {
            travelling(far).refuses_wrong_motions(&format!("travel {far:e}"), 0.02);
        }
    }
}

#[test]
fn a_stiff_part_hides_no_error_of_a_soft_one() {
    for contrast in [1e2, 1e4, 1e6] {
        let stiff = contrast * 3.1;
        for held in [vec![], vec![(0, 2.0)], vec![(5, 2.0 * contrast)]] {
            let springs = [2.0, 1.3, stiff, stiff, stiff];
            let parts =
                vec![chain(&springs, &held).loaded(&[(5, 1.0), (0, -0.2)]), chain(&[1.9], &[(1, 3.7)])];
            let contact = vec![(vec![(0, 1.0), (6, -1.0)], -0.5, 0.0)];
            let model = DenseModel { parts, contact, active: vec![0], ..DenseModel::default() };
            let name = format!("contrast {contrast:e} {held:?}");
            model.refuses_wrong_forces(&name);
            model.refuses_wrong_motions(&name, 1.0);
        }
    }
}

/// A spring of 1e-8 holds the body, and an obstacle stops it.
#[test]
fn wrong_forces_and_motions_of_a_body_on_a_weak_spring_are_refused() {
    let parts = vec![chain(&[2.0, 3.1, 1.7], &[(0, 1e-8)]).loaded(&[(0, 1.0)]), chain(&[1.9], &[(1, 3.7)])];
    let contact = vec![(vec![(3, 1.0), (4, -1.0)], 0.3, 0.0)];
    let model = DenseModel { parts, contact, active: vec![0], ..DenseModel::default() };
    model.refuses_wrong_forces("weak");
    model.refuses_wrong_motions("weak", 1.0);
}

/// A stiff spring moves one end of a chain by .4; its other end pushes a chain on the ground.
#[test]
fn displacements_prescribed_by_penalty_hide_nothing() {
    for penalty in [1e8, 1e10, 1e12, 1e16, 1e20] {
        let parts = vec![
            chain(&[2.0, 3.1, 1.7], &[(0, penalty)]).loaded(&[(0, 0.4 * penalty)]),
            chain(&[1.9, 2.3], &[(2, penalty)]),
        ];
        let contact = vec![(vec![(3, 1.0), (4, -1.0)], 0.1, 0.0)];
        let model = DenseModel { parts, contact, active: vec![0], ..DenseModel::default() };
        let name = format!("penalty {penalty:e}");
        model.refuses_wrong_forces(&name);
        model.refuses_wrong_motions(&name, 0.4);
    }
}

/// A soft body that travels far, against the ground and a stiff one: three rows at rest around them carry forces of size `large` that
/// cancel, so that the loads are lost in their rounding.
#[test]
fn forces_that_cancel_between_rows_of_carried_unknowns_excuse_nothing() {
    for (far, large) in [(0.0, 1e10), (1.0, 1e10), (1e9, 1e10), (1e9, 1e14)] {
        let soft = chain(&[], &[(0, 1e-9)]).loaded(&[(0, 0.4 + 1e-9 * far)]);
        let parts = vec![chain(&[2.0], &[(1, 3.1)]).loaded(&[(0, 1.0)]), soft];
        let rows = [vec![(2, 1.0)], vec![(0, 1.0), (2, -1.0)], vec![(0, -1.0)]];
        let contact = rows.map(|row| (row, far, 0.0)).to_vec();
        let mut model = DenseModel { parts, contact, active: vec![0], ..DenseModel::default() };
        let mut answer = model.answer();
        (model.contact[1].1, model.contact[2].1) = (answer.u[0] - answer.u[2], -answer.u[0]);
        assert!(model.certificate(&answer).passed(), "{far:e}");
        answer.lambda.iter_mut().for_each(|force| *force += large);
        assert!(!model.certificate(&answer).passed(), "{far:e} {large:e}");
    }
}

/// Load and force of the obstacle cancel to the part `left` of their size.
#[test]
fn loads_that_all_but_cancel_pass_by_their_rounding_and_forces_are_right() {
    for left in [1e-6, 1e-9, 1e-12] {
        let mut model = held();
        model.parts[0].load = vec![0.0, 0.0, 0.0, 1.0];
        model.parts[1].load = vec![-1.0 + left, 0.0, 0.0];
        model.contact[0].1 = 0.0;
        model.refuses_wrong_forces(&format!("cancelling to {left:e}"));
    }
}

#[test]
fn subdomains_glued_together_move_as_one() {
    for far in [0.0, 1.0, 1e5] {
        let parts = vec![
            chain(&[2.0, 3.1], &[]).loaded(&[(0, 0.01)]),
            chain(&[1.7, 2.9], &[]),
            chain(&[0.3, 2.2], &[]),
            chain(&[1.9], &[(1, 3.7)]),
        ];
        let equalities = vec![(vec![(2, 1.0), (3, -1.0)], 0.0, 0.0), (vec![(5, 2.0), (6, -2.0)], 0.0, 0.0)];
        let contact = vec![(vec![(8, 1.0), (9, -1.0)], far, 0.0)];
        let model =
            DenseModel { parts, contact, equalities, active: vec![0], travel: vec![far; 9], nodes: vec![] };
        let name = format!("glued {far:e}");
        model.refuses_wrong_forces(&name);
        if far <= 1.0 {
            model.refuses_wrong_motions(&name, 0.01);
        }
        let right = model.answer();
        for p in 0..3 {
            let mut wrong = right.clone();
            (3 * p..3 * p + 3).for_each(|j| wrong.u[j] += 1e-5 * 0.01);
            model.refused(&format!("{name}, body {p} moved"), &wrong);
        }
    }
}

#[test]
fn a_truss_that_is_free_to_turn() {
    for far in [0.0, 1.0, 1e3] {
        let nodes = [[0.0, 0.0], [1.0, 0.1], [0.2, 1.0], [1.3, 1.1]];
        let bars = [(0, 1, 2.0), (0, 2, 3.1), (1, 2, 1.7), (1, 3, 2.3), (2, 3, 1.1)];
        let parts = vec![truss(&nodes, &bars).loaded(&[(5, -0.02), (7, -0.03), (6, 0.005)])];
        let contact =
            vec![(vec![(1, -1.0)], far, 0.0), (vec![(3, -1.0)], far, 0.0), (vec![(2, 1.0)], far, 0.0)];
        let travel = [-1.0, -1.0]
            .repeat(4)
            .iter()
            .enumerate()
            .map(|(j, t)| if j % 2 == 0 { -far * t } else { far * t })
            .collect();
        let model = DenseModel { parts, contact, active: vec![0, 1, 2], travel, ..DenseModel::default() };
        assert!(model.answer().lambda.iter().all(|l| *l > 0.0), "{:?}", model.answer());
        let name = format!("truss {far:e}");
        model.refuses_wrong_forces(&name);
        model.refuses_wrong_motions(&name, 0.01);
    }
}

/// Gaps of rows that never close do not change the verdict, however large they are, and need no force.
#[test]
fn far_rows_excuse_nothing() {
    let gaps = [1e6, 1e12, 1e20, 1e30, 1e300, f64::INFINITY];
    for far in gaps {
        let mut model = held();
        model.contact.push((vec![(1, 1.0), (5, -1.0)], far, 0.0));
        model.contact.push((vec![(2, 1.0)], far, 0.5));
        let name = format!("far {far:e}");
        model.refuses_wrong_forces(&name);
        model.refuses_wrong_motions(&name, 1.0);
        let (near, with) = (held().certificate(&held().answer()), model.certificate(&model.answer()));
        assert_eq!((near.worst(), near.energy), (with.worst(), with.energy), "{name}");
        let mut wrong = model.answer();
        wrong.lambda[1] = 1e-5;
        model.refused(&format!("{name}, a force across the gap"), &wrong);
        let open = DenseAnswer { u: vec![0.0; 7], lambda: vec![0.0; 3], mu: vec![], tangential: vec![] };
        model.refused(&format!("{name}, nothing at all"), &open);
    }
}

/// Springs between a stiff free chain and its load, and its obstacle: the ends are weakly coupled to the chain, but not
/// grounded.
#[test]
fn the_soft_end_of_a_stiff_body() {
    for stiff in [1e2, 1e4, 1e8] {
        for held in [vec![], vec![(1, stiff)]] {
            for far in [0.0, 1.0] {
                let springs = [1.3, stiff, 2.0 * stiff, 1.7];
                let load = [(0, 0.3), (4, 0.7)];
                let parts = vec![chain(&springs, &held).loaded(&load), chain(&[1.9, 2.0], &[(2, 3.7)])];
                let gap = if held.is_empty() { far } else { -0.1 };
                let contact = vec![(vec![(4, 1.0), (5, -1.0)], gap, 0.0)];
                let travel = if held.is_empty() { vec![far; 5] } else { vec![] };
                let model = DenseModel { parts, contact, active: vec![0], travel, ..DenseModel::default() };
                let name = format!("soft end {stiff:e} {held:?} {far}");
                model.refuses_wrong_forces(&name);
                model.refuses_wrong_motions(&name, 1.0);
            }
        }
    }
}

/// A penalty support, a single spring, a free chain and a far row in one model.
#[test]
fn what_is_light_is_judged_by_itself() {
    for heavy in [1.0, 1e5, 1e9] {
        let parts = vec![
            chain(&[2.0, 3.1], &[(0, 4.3)]).loaded(&[(2, 1.0)]),
            chain(&[1.9], &[(1, 3.7)]),
            chain(&[2.0, 3.1], &[(0, 4.3)]).loaded(&[(2, heavy)]),
            chain(&[1.9], &[(1, 3.7)]),
        ];
        let contact = vec![(vec![(2, 1.0), (3, -1.0)], 0.01, 0.0), (vec![(7, 1.0), (8, -1.0)], 0.0, 0.0)];
        let model = DenseModel { parts, contact, active: vec![0, 1], ..DenseModel::default() };
        model.refuses_wrong_forces(&format!("heavy {heavy:e}"));
    }
}

/// Single springs in contact, each a body of one unknown.
#[test]
fn single_springs_are_judged_by_the_forces_on_them() {
    for stiffness in [1e-8, 1.0, 1e8] {
        let parts = vec![chain(&[], &[(0, 4.0)]).loaded(&[(0, 2.0)]), chain(&[], &[(0, stiffness)])];
        let contact = vec![(vec![(0, 1.0), (1, -1.0)], 0.1, 0.0)];
        let model = DenseModel { parts, contact, active: vec![0], ..DenseModel::default() };
        model.refuses_wrong_forces(&format!("springs {stiffness:e}"));
        model.refuses_wrong_motions(&format!("springs {stiffness:e}"), 0.5);
    }
}

/// A tie given twice may distribute its force arbitrarily, unless the forces are so large that their sum is lost.
#[test]
fn forces_that_are_lost_between_redundant_rows_are_refused() {
    for (load, excess, right) in [(1.0, 1e3, true), (1.0, 1e12, false), (1e-6, 1e6, false), (1e6, 1e9, true)]
    {
        let parts = vec![chain(&[2.0, 3.0], &[(0, 1.0)]).loaded(&[(2, load)]), chain(&[1.5], &[(1, 0.7)])];
        let tie = (vec![(2, 1.0), (3, -1.0)], 0.0, 0.0);
        let single = DenseModel { parts, equalities: vec![tie.clone()], ..DenseModel::default() };
        let answer = single.answer();
        let double = DenseModel { equalities: vec![tie.clone(), tie], ..single };
        let mut shared = answer.clone();
        shared.mu = vec![answer.mu[0] + excess, -excess];
        assert_eq!(double.certificate(&shared).passed(), right, "{load:e} {excess:e}");
    }
}

/// A free chain of deformation .001 presses on a node on a spring kp, which a load of 1e4 presses on the ground.
#[test]
fn loads_that_go_straight_into_the_ground_excuse_no_gap() {
    for kp in [1e-12, 1.0] {
        let node = chain(&[], &[(0, kp)]).loaded(&[(0, 1e4)]);
        let contact = vec![(vec![(2, 1.0)], 0.1, 0.0), (vec![(1, 1.0), (2, -1.0)], 1e-4, 0.0)];
        let model = DenseModel {
            parts: vec![chain(&[1.0], &[]).loaded(&[(0, 1e-3)]), node],
            contact,
            active: vec![0, 1],
            ..DenseModel::default()
        };
        let mut wrong = model.accepted("pressed on a node");
        wrong.u[0] += 1e-8;
        wrong.u[1] += 1e-8;
        model.refused("moved into the node", &wrong);
    }
}

/// A node with a dummy stiffness hangs on a stiff body by a spring of 1: a displacement of 1 of the body moves it by 1, not by the
/// ratio of the stiffnesses.
#[test]
fn a_soft_row_passes_on_what_its_spring_lets_through() {
    let body = chain(&[1e8], &[(0, 1e8)]).loaded(&[(1, 1e8)]);
    let model = DenseModel {
        parts: vec![body, chain(&[], &[(0, 1e-9)]).loaded(&[(0, -1e-3)])],
        contact: vec![(vec![(1, 1.0), (2, -1.0)], 0.0, 1.0)],
        active: vec![0],
        ..DenseModel::default()
    };
    let mut wrong = model.accepted("hung on a stiff body");
    wrong.u[2] += 1e-4;
    model.refused("hung elsewhere", &wrong);
}

/// A tie holds a free chain 1000 away from a held one, and its deformation is .001: a displacement that a tie prescribes is none.
#[test]
fn a_displacement_prescribed_by_a_tie_excuses_no_gap() {
    let free = chain(&[1.0], &[]).loaded(&[(1, 1e-3)]);
    let model = DenseModel {
        parts: vec![chain(&[1.0], &[(0, 1.0)]), free],
        equalities: vec![(vec![(1, -1.0), (2, 1.0)], 1e3, 0.0)],
        ..DenseModel::default()
    };
    let mut wrong = model.accepted("tied at a distance");
    wrong.u[2] += 1e-8;
    wrong.u[3] += 1e-8;
    model.refused("moved against the tie", &wrong);
}
