//! Bodies given by their elements, whole and cut: one problem, one answer.

mod bodies;
mod glue;
mod motions;
mod passes;
mod proofs;
mod shapes;

use bodies::{apart, blocks, solved};

#[test]
fn a_body_that_is_cut_has_the_answer_of_the_whole_one() {
    let model = blocks(6);
    let (u, lambda, energy) = solved(&mut model.by_elements(1, true).unwrap());
    for pieces in [2, 3, 8, 27] {
        for coordinates in [true, false] {
            let (own, forces, own_energy) = solved(&mut model.by_elements(pieces, coordinates).unwrap());
            assert!(
                (own_energy - energy).abs() <= 1e-9 * energy.abs(),
                "{pieces}: {own_energy:e} {energy:e}"
            );
            assert!(apart(&forces, &lambda) < 1e-7, "{pieces}: {:e}", apart(&forces, &lambda));
            assert!(apart(&own, &u) < 1e-7, "{pieces}: {:e}", apart(&own, &u));
        }
    }
}

/// One step fewer would hardly do: the worst entry of the certificate ends within a factor of 20 of its limit.
#[test]
fn cut_bodies_are_solved_as_far_as_the_certificate_asks() {
    let model = blocks(8);
    let solve = |certificate: f64| {
        let mut problem = model.by_elements(27, true).unwrap();
        problem.set_f64("certificate_tolerance", certificate).unwrap();
        solved(&mut problem);
        let report = problem.report().unwrap();
        assert!(report.certificate.worst() > 0.05, "{certificate:e}: {:e}", report.certificate.worst());
        report.counts.products
    };
    let products = [1e-4, 1e-6, 1e-8].map(solve);
    assert!(products.windows(2).all(|two| two[0] + 4 <= two[1]), "{products:?}");
}

#[test]
fn the_host_sees_its_bodies_and_not_their_pieces() {
    let model = blocks(5);
    let (mut whole, mut cut) = (model.by_elements(1, true).unwrap(), model.by_elements(12, true).unwrap());
    let (u, lambda, _) = solved(&mut whole);
    solved(&mut cut);
    assert_eq!(cut.sizes(), whole.sizes());
    let [cut_report, whole_report] = [&cut, &whole].map(|problem| problem.report().unwrap().clone());
    assert_eq!((cut_report.sizes, cut_report.floating_modes), (whole_report.sizes, 6));
    assert_eq!(
        (cut_report.active, cut_report.undetermined),
        (whole_report.active, whole_report.undetermined)
    );
    for body in 0..2 {
        let [facts, other] = [&cut, &whole].map(|problem| problem.body_facts(body).unwrap());
        assert!((2..=12).contains(&facts.pieces) && other.pieces == 1, "{}", facts.pieces);
        assert_eq!((facts.unknowns, facts.entries), (other.unknowns, other.entries));
        assert_eq!((facts.components, facts.origin), (Some(1), other.origin));
        assert_eq!(facts.factors.unwrap().null_space, other.factors.unwrap().null_space);
        assert!(facts.force_error.unwrap() < 1e-6);
        let (r, n) = cut.null_space(body).map(|(r, basis)| (r, basis.len())).unwrap();
        assert_eq!((r, n), (6 * body, 6 * body * facts.unknowns));
        assert_eq!(cut.amplitudes(body).unwrap().len(), 6 * body);
        let [mut own, mut others] = [vec![0.0; facts.unknowns], vec![0.0; facts.unknowns]];
        cut.reaction(None, body, &mut own).unwrap();
        whole.reaction(None, body, &mut others).unwrap();
        assert!(apart(&own, &others) < 1e-7);
    }
    assert!(cut.gaps().unwrap().iter().zip(whole.gaps().unwrap()).all(|(a, b)| (a - b).abs() < 1e-9));
    assert_eq!(cut.active().unwrap(), whole.active().unwrap());
    assert_eq!(cut.findings().unwrap().untouched, [0; 0]);
    // the certificate of another code's answer, and of a wrong one
    assert!(cut.check(&u, &lambda, &[]).unwrap().passed());
    let mut wrong = u.clone();
    wrong[u.len() - 1] += 1e-4 * u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(!cut.check(&wrong, &lambda, &[]).unwrap().passed());
    for refused in [
        cut.kplus(1, &u[..u.len() - 450], &mut []).is_err(),
        cut.dual_rhs(&mut vec![0.0; lambda.len()]).is_err(),
    ] {
        assert!(refused);
    }
}

#[test]
fn load_steps_states_and_threads_give_the_bits_of_a_first_solve() {
    let model = blocks(5);
    let mut cut = model.by_elements(9, true).unwrap();
    cut.set_i64("threads", 1).unwrap();
    let (first, ..) = solved(&mut cut);
    let (state, factorised) = (cut.save_state().unwrap(), cut.work().factorisations);
    let more: Vec<f64> = model.loads[1].iter().map(|f| 1.5 * f).collect();
    cut.set_load(1, &more).unwrap();
    let (second, ..) = solved(&mut cut);
    assert!(apart(&second, &first) > 1e-2);
    cut.restore_state(state).unwrap();
    assert_eq!(cut.displacements().unwrap(), first, "the answer comes back");
    for threads in [2, 4] {
        cut.set_i64("threads", threads).unwrap();
        assert_eq!(solved(&mut cut).0, first);
    }
    assert_eq!(cut.work().factorisations, factorised);
    cut.set_str("start", "previous").unwrap();
    assert!(apart(&solved(&mut cut).0, &first) < 1e-8);
    assert!(cut.report().unwrap().counts.products < 20, "{:?}", cut.report().unwrap().counts);
}

#[test]
fn factors_in_single_precision_take_less_memory_and_give_the_same_answer() {
    let model = blocks(9);
    let made = |operator: &str| {
        let mut problem = model.by_elements(8, true).unwrap();
        problem.set_str("dual_operator", operator).unwrap();
        problem.set_f64("certificate_tolerance", 1e-9).unwrap();
        problem
    };
    let (mut double, mut single) = (made("explicit"), made("implicit"));
    let [(u, lambda, energy), (own, forces, own_energy)] = [&mut double, &mut single].map(solved);
    assert!((own_energy - energy).abs() <= 1e-11 * energy.abs(), "{own_energy:e} {energy:e}");
    assert!(apart(&forces, &lambda) < 1e-8 && apart(&own, &u) < 1e-8, "{:e}", apart(&own, &u));
    let [double_bytes, single_bytes] = [&double, &single].map(|of| of.report().unwrap().factor_bytes);
    assert!(5 * single_bytes < 4 * double_bytes, "{single_bytes} of {double_bytes}");
    let [products, others] = [&single, &double].map(|of| of.report().unwrap().counts.products);
    assert!(products <= others + 5, "{products} products, {others} in double precision");
    for threads in [1, 2, 4] {
        single.set_i64("threads", threads).unwrap();
        assert_eq!(solved(&mut single).0, own);
    }
}

/// The energy of all bodies says little about the one that is refused, but its ratio says where it will pass.
#[test]
fn cut_bodies_beside_others_with_a_million_times_their_loads_are_refused_twice_at_most() {
    for ratio in [1e-4, 1e-6] {
        let (mut model, light) = (blocks(8), blocks(8));
        let n = model.bodies.len();
        model.bodies.extend(light.bodies);
        model.loads.extend(light.loads.iter().map(|load| load.iter().map(|f| ratio * f).collect()));
        let moved =
            |entries: &[(usize, usize, f64)]| entries.iter().map(|&(p, j, v)| (p + n, j, v)).collect();
        model.rows.extend(light.rows.iter().map(|(entries, gap)| (moved(entries), *gap)));
        // open, but one group
        model.rows.push((vec![(0, 400, 1.0), (n, 400, -1.0)], 1.0));
        let mut problem = model.by_elements(27, true).unwrap();
        problem.set_f64("certificate_tolerance", 1e-8).unwrap();
        solved(&mut problem);
        let tries = &problem.report().unwrap().tries;
        let refused: Vec<_> = tries.made().filter(|(name, _)| name.starts_with("tightened")).collect();
        assert!(refused.len() == 1 && refused[0].0 == "tightened by" && refused[0].1 <= 2, "{refused:?}");
    }
}
