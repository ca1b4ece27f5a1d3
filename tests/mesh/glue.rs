//! Bodies of the host that share numbers of unknowns: glued, they are one body, and no row says so.

use crate::mesh::bodies::{apart, blocks, solved, Model};
use decks::mesh::Mesh;
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, RowKind, RowsInput};

/// A model whose bodies come in parts, and the numbers of the unknowns of every part.
struct Glued {
    model: Model,
    numbers: Vec<Vec<i64>>,
}

impl Glued {
    /// Every body in `parts` parts, `part` of an element by its centre; loads and rows act on the first copy.
    fn of(whole: &Model, parts: usize, part: impl Fn([f64; 3]) -> usize) -> Self {
        let mut model = Model { bodies: Vec::new(), loads: Vec::new(), rows: whole.rows.clone() };
        let (mut numbers, mut offset) = (Vec::new(), 0);
        // for every unknown of every body its first copy
        let mut first: Vec<Vec<Option<(usize, usize)>>> = Vec::new();
        for mesh in &whole.bodies {
            let (number, unknowns) = mesh.numbers();
            let mut of_body = vec![None; unknowns];
            for own in 0..parts {
                let mut kept = mesh.clone();
                let centre = |nodes: &Vec<usize>| {
                    let along = |axis: usize| nodes.iter().map(|k| mesh.nodes[*k][axis]).sum::<f64>();
                    std::array::from_fn(|axis| along(axis) / nodes.len() as f64)
                };
                let chosen: Vec<usize> =
                    (0..mesh.elements.len()).filter(|&e| part(centre(&mesh.elements[e])) == own).collect();
                let mut nodes: Vec<usize> =
                    chosen.iter().flat_map(|&e| mesh.elements[e].iter().copied()).collect();
                nodes.sort_unstable();
                nodes.dedup();
                let place = |k: &usize| nodes.binary_search(k).unwrap();
                kept.elements =
                    chosen.iter().map(|&e| mesh.elements[e].iter().map(place).collect()).collect();
                kept.young = chosen.iter().map(|&e| mesh.young[e]).collect();
                kept.nodes = nodes.iter().map(|&k| mesh.nodes[k]).collect();
                kept.held = nodes.iter().map(|&k| mesh.held[k]).collect();
                let free = nodes.iter().filter_map(|&k| number[k]).flat_map(|at| at..at + 3);
                let own_numbers: Vec<i64> = free.map(|j| (offset + j) as i64).collect();
                for (i, j) in own_numbers.iter().enumerate() {
                    of_body[*j as usize - offset].get_or_insert((model.bodies.len(), i));
                }
                model.loads.push(vec![0.0; own_numbers.len()]);
                model.bodies.push(kept);
                numbers.push(own_numbers);
            }
            first.push(of_body);
            offset += unknowns;
        }
        for (body, load) in whole.loads.iter().enumerate() {
            for (j, f) in load.iter().enumerate() {
                let (part, i) = first[body][j].unwrap();
                model.loads[part][i] = *f;
            }
        }
        for (body, dof, _) in model.rows.iter_mut().flat_map(|row| &mut row.0) {
            (*body, *dof) = first[*body][*dof].unwrap();
        }
        Self { model, numbers }
    }

    fn glued(&self, pieces: i64) -> Problem {
        let mut problem = self.model.by_elements(pieces, true).unwrap();
        problem.set_i64("glue", 1).unwrap();
        self.numbers.iter().enumerate().for_each(|(body, own)| problem.set_numbering(body, own).unwrap());
        problem
    }

    /// The same with equality rows of the host, a chain over the copies.
    fn by_rows(&self, pieces: i64) -> Problem {
        let mut problem = self.model.by_elements(pieces, true).unwrap();
        let mut last = std::collections::HashMap::new();
        let (mut ptr, mut body, mut dof, mut val) = (vec![0], vec![], vec![], vec![]);
        for (own, numbers) in self.numbers.iter().enumerate() {
            for (i, number) in numbers.iter().enumerate() {
                if let Some((before, j)) = last.insert(*number, (own as i64, i as i64)) {
                    body.extend([before, own as i64]);
                    dof.extend([j, i as i64]);
                    val.extend([1.0, -1.0]);
                    ptr.push(dof.len());
                }
            }
        }
        let rows = RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: None };
        problem.add_rows(RowKind::Equality, rows).unwrap();
        problem
    }

    /// Values by number, of the first copy; and how far the others are off at most.
    fn by_number(&self, values: &[f64]) -> (Vec<f64>, f64) {
        let count = self.numbers.iter().flatten().max().map_or(0, |most| *most as usize + 1);
        let (mut all, mut off) = (vec![None; count], 0.0f64);
        for (number, v) in self.numbers.iter().flatten().zip(values) {
            let first: f64 = *all[*number as usize].get_or_insert(*v);
            off = off.max((first - v).abs());
        }
        (all.into_iter().map(Option::unwrap).collect(), off)
    }
}

/// Four columns that meet in edges along z, where every number has four copies.
fn columns(whole: &Model) -> Glued {
    Glued::of(whole, 4, |[x, y, _]| usize::from(x > 0.5) + 2 * usize::from(y > 0.5))
}

fn largest(u: &[f64]) -> f64 {
    u.iter().fold(0.0, |most, u| most.max(u.abs()))
}

#[test]
fn glued_bodies_have_the_bits_of_a_host_that_writes_the_rows() {
    let glued = columns(&blocks(4));
    let (mut own, mut host) = (glued.glued(1), glued.by_rows(1));
    assert_eq!(solved(&mut own), solved(&mut host));
    let (report, other) = (own.report().unwrap(), host.report().unwrap());
    assert_eq!(report.certificate.worst(), other.certificate.worst());
    assert_eq!(report.certificate.equality.figure, other.certificate.equality.figure);
    assert_eq!((report.counts, report.sizes.equalities), (other.counts, 0));
    assert_eq!(own.multipliers(RowKind::Equality).unwrap(), [0.0; 0]);
}

#[test]
fn glued_bodies_whole_and_cut_are_the_body_they_are_parts_of() {
    let whole = blocks(6);
    let mut one = whole.by_elements(1, true).unwrap();
    let (u, lambda, energy) = solved(&mut one);
    let open = one.findings().unwrap().undetermined;
    let glued = columns(&whole);
    for pieces in [1, 3] {
        let mut problem = glued.glued(pieces);
        let (own, forces, own_energy) = solved(&mut problem);
        let (by_number, off) = glued.by_number(&own);
        assert!(off <= 1e-10 * largest(&u), "{pieces}: copies {off:e} apart of {:e}", largest(&u));
        assert!(apart(&by_number, &u) < 1e-7, "{pieces}: {:e}", apart(&by_number, &u));
        assert!(apart(&forces, &lambda) < 1e-7, "{pieces}: {:e}", apart(&forces, &lambda));
        assert!((own_energy - energy).abs() <= 1e-9 * energy.abs(), "{pieces}: {own_energy:e} {energy:e}");
        let findings = problem.findings().unwrap();
        assert_eq!((findings.untouched.len(), findings.redundant.len(), findings.undetermined), (0, 0, open));
        assert_eq!(problem.body_facts(5).unwrap().pieces > 1, pieces > 1);
    }
}

#[test]
fn forces_of_the_glue_hold_every_body_and_cancel_in_their_sum() {
    let glued = columns(&blocks(4));
    for pieces in [1, 3] {
        let mut problem = glued.glued(pieces);
        let (u, ..) = solved(&mut problem);
        let all = problem.reactions(None).unwrap();
        let of_rows = problem.reactions(Some(RowKind::Inequality)).unwrap();
        assert_eq!(problem.reactions(Some(RowKind::Equality)).unwrap(), vec![0.0; u.len()]);
        let glue: Vec<f64> = all.iter().zip(&of_rows).map(|(all, rows)| all - rows).collect();
        assert!(largest(&glue) > 0.1 * largest(&of_rows));
        let (sums, of_rows_alone) = (problem.summed(all).unwrap(), problem.summed(of_rows).unwrap());
        assert!(apart(&glued.by_number(&sums).0, &glued.by_number(&of_rows_alone).0) < 1e-12);
        // a column that stands loose on the others: load, contact and glue have no resultant along z
        for body in 4..8 {
            let mut r = vec![0.0; problem.order(body).unwrap()];
            problem.reaction(None, body, &mut r).unwrap();
            let along_z = |f: &[f64]| f.iter().skip(2).step_by(3).sum::<f64>();
            let left = along_z(&r) + along_z(&glued.model.loads[body]);
            assert!(left.abs() < 1e-9 * largest(&r), "{left:e}");
        }
    }
}

/// The glue of another code's answer is not given: what is left of the bodies' equilibrium finds its forces.
#[test]
fn answers_of_others_are_judged_with_the_glue() {
    let whole = blocks(4);
    let (u, lambda, _) = solved(&mut whole.by_elements(1, true).unwrap());
    let glued = columns(&whole);
    for pieces in [1, 3] {
        let mut problem = glued.glued(pieces);
        let copies: Vec<f64> = glued.numbers.iter().flatten().map(|number| u[*number as usize]).collect();
        let certificate = problem.check(&copies, &lambda, &[]).unwrap();
        assert!(certificate.passed(), "{certificate:?}");
        let wrong = |place: usize, by: f64| {
            let mut wrong = copies.clone();
            wrong[place] += by * largest(&u);
            wrong
        };
        let last = copies.len() - 1;
        let refused = problem.check(&wrong(last, 1e-4), &lambda, &[]).unwrap();
        assert!(!refused.passed() && refused.equality.place.is_none(), "{refused:?}");
        // a copy that moves for itself breaks the glue and the equilibrium around it
        let shared = glued.numbers[7].iter().position(|n| glued.numbers[6].contains(n)).unwrap();
        let first: usize = (0..7).map(|body| problem.order(body).unwrap()).sum();
        let refused = problem.check(&wrong(first + shared, 1e-6), &lambda, &[]).unwrap();
        assert!(!refused.passed() && refused.equality.ratio > 1.0 && refused.equality.place.is_none());
    }
}

#[test]
fn load_steps_states_starts_and_files_keep_the_glue() {
    let glued = columns(&blocks(4));
    for pieces in [1, 3] {
        let mut problem = glued.glued(pieces);
        let (first, lambda, _) = solved(&mut problem);
        let (state, made) = (problem.save_state().unwrap(), problem.work().factorisations);
        let mut other = Problem::new();
        other.read_bytes(&problem.write_bytes().unwrap()).unwrap();
        assert_eq!(other.get_i64("glue").unwrap(), 1);
        assert_eq!(solved(&mut other).0, first);
        let more: Vec<f64> = glued.model.loads[6].iter().map(|f| 1.5 * f).collect();
        problem.set_load(6, &more).unwrap();
        assert!(apart(&solved(&mut problem).0, &first) > 1e-2);
        problem.restore_state(state).unwrap();
        assert_eq!(problem.displacements().unwrap(), first);
        problem.start_from(RowKind::Inequality, &lambda).unwrap();
        assert!(apart(&solved(&mut problem).0, &first) < 1e-8);
        assert_eq!(solved(&mut problem).0, first);
        // the same numbers once more change nothing
        problem.set_numbering(6, &glued.numbers[6]).unwrap();
        assert_eq!(problem.displacements().unwrap(), first);
        assert_eq!(problem.work().factorisations, made);
    }
}

#[test]
fn a_column_with_numbers_of_its_own_comes_loose_and_may_be_glued_again() {
    let glued = columns(&blocks(4));
    for pieces in [1, 3] {
        let mut problem = glued.glued(pieces);
        let (first, ..) = solved(&mut problem);
        let state = problem.save_state().unwrap();
        let apart_from_all: Vec<i64> = (0..glued.numbers[7].len() as i64).map(|i| 100_000 + i).collect();
        problem.set_numbering(7, &apart_from_all).unwrap();
        assert!(problem.displacements().is_err(), "the answer is none of this problem");
        // pressed on the block below by itself, it may slide and turn about
        let (loose, ..) = solved(&mut problem);
        assert!(apart(&loose, &first) > 1e-3);
        problem.restore_state(state).unwrap();
        assert!(problem.displacements().is_err(), "nor is the answer of the state");
        problem.set_numbering(7, &glued.numbers[7]).unwrap();
        assert!(apart(&solved(&mut problem).0, &first) < 1e-9);
    }
}

#[test]
fn a_load_that_glued_bodies_do_not_hold_moves_all_of_them() {
    let mut whole = blocks(4);
    whole.loads[1].iter_mut().for_each(|f| *f = -*f);
    let glued = columns(&whole);
    let told = |problem: &mut Problem| {
        let error = problem.solve().unwrap_err();
        assert_eq!(error.kind, Kind::LoadNotHeld, "{error}");
        let bodies = problem.sizes().bodies;
        (0..bodies).flat_map(|body| problem.escaping_motion(body).unwrap().to_vec()).collect::<Vec<f64>>()
    };
    let motion = told(&mut whole.by_elements(1, true).unwrap());
    for pieces in [1, 3] {
        let (own, off) = glued.by_number(&told(&mut glued.glued(pieces)));
        assert!(off < 1e-8 && apart(&own, &motion) < 1e-5, "{off:e} {:e}", apart(&own, &motion));
    }
}

/// A host that glues a number of its own accord, once more, says nothing new; one that holds the copies apart is told by its rows.
#[test]
fn rows_of_the_host_may_repeat_the_glue_but_not_contradict_it() {
    let glued = columns(&blocks(4));
    let dof =
        |number: i64, body: usize| glued.numbers[body].iter().position(|n| *n == number).unwrap() as i64;
    let number = *glued.numbers[7].iter().find(|n| glued.numbers[6].contains(n)).unwrap();
    let (ends, bodies) = ([dof(number, 6), dof(number, 7)], [6, 7]);
    for pieces in [1, 3] {
        let with = |val: &[f64], ptr: &[usize], rhs: &[f64]| {
            let mut problem = glued.glued(pieces);
            let rows = RowsInput { ptr, body: Some(&bodies), dof: &ends, val, rhs: Some(rhs) };
            problem.add_rows(RowKind::Equality, rows).unwrap();
            problem
        };
        let (first, ..) = solved(&mut glued.glued(pieces));
        let mut repeated = with(&[2.0, -2.0], &[0, 2], &[0.0]);
        assert!(apart(&solved(&mut repeated).0, &first) < 1e-8);
        let findings = repeated.findings().unwrap();
        assert!(findings.rows(RowKind::Equality).all(|(row, _)| row == 0));
        let apart = [
            (with(&[1.0, -1.0], &[0, 2], &[0.5]).solve().unwrap_err(), 1, "this equality row and the glue"),
            (with(&[1.0, 1.0], &[0, 1, 2], &[0.5, 0.0]).solve().unwrap_err(), 2, "another row and the glue"),
        ];
        for (error, rows, says) in apart {
            assert_eq!((error.kind, error.place.index), (Kind::GapsContradict, Some(number)), "{error}");
            assert!(error.what.contains(says), "{error}");
            assert!(error.what.contains(&format!("with number {number} ")), "{error}");
            assert!(error.place.row.unwrap() < rows, "{error}");
            let Some(feti_contact::error::Proof::Rows { weights, .. }) = error.proof.as_deref() else {
                panic!("{error:?}")
            };
            assert_eq!(weights.len(), rows);
            let first = glued.model.rows.len();
            assert!(weights.iter().all(|(row, _)| (first..first + rows).contains(row)), "{weights:?}");
        }
    }
}

/// A snap ring pressed against its bore may turn and move along the axis. A stop that carries no force turns it.
#[test]
fn a_snap_ring_travels_least_whole_cut_glued_and_after_load_steps() {
    let mesh = Mesh::grid([24, 1, 2], |[x, y, z]| {
        let (turn, radius) = (5.8 * x, 1.0 + 0.1 * y);
        [radius * turn.cos(), -radius * turn.sin(), 0.1 * z]
    });
    let (number, unknowns) = mesh.numbers();
    let (mut load, mut rows) = (vec![0.0; unknowns], Vec::new());
    for (k, at) in mesh.nodes.iter().enumerate() {
        let (radius, first) = (at[0].hypot(at[1]), number[k].unwrap());
        let out = [at[0] / radius, at[1] / radius];
        if radius > 1.05 {
            let entries = (0..2).map(|axis| (0, first + axis, out[axis])).collect();
            rows.push((entries, 0.001 * (1.0 + at[1])));
        } else {
            (0..2).for_each(|axis| load[first + axis] = 1e-3 * out[axis] * (1.0 + 0.3 * at[0]));
        }
    }
    rows.push((vec![(0, number[0].unwrap() + 1, 1.0)], -1e-3));
    let whole = Model { bodies: vec![mesh], loads: vec![load], rows };
    let mut one = whole.by_elements(1, true).unwrap();
    let (u, lambda, _) = solved(&mut one);
    assert_eq!(one.report().unwrap().undetermined, 2);
    assert!(*lambda.last().unwrap() <= 1e-12 * largest(&lambda));
    let glued = Glued::of(&whole, 3, |[x, y, _]| if y > 0.3 { 0 } else { 1 + usize::from(x > 0.2) });
    let steps = |problem: &mut Problem, loads: &[Vec<f64>]| {
        for step in 1..=5 {
            for (body, load) in loads.iter().enumerate() {
                let part: Vec<f64> = load.iter().map(|f| f64::from(step) / 5.0 * f).collect();
                problem.set_load(body, &part).unwrap();
            }
            solved(problem);
            problem.set_str("start", "previous").unwrap();
        }
    };
    for pieces in [1, 3, 40] {
        let mut after = whole.by_elements(pieces, true).unwrap();
        steps(&mut after, &whole.loads);
        let mut of_parts = glued.glued(pieces);
        steps(&mut of_parts, &glued.model.loads);
        let by_number = |own: &[f64]| glued.by_number(own).0;
        for (how, own) in [
            ("alone", solved(&mut whole.by_elements(pieces, true).unwrap()).0),
            ("alone, in steps", after.displacements().unwrap().to_vec()),
            ("glued", by_number(&solved(&mut glued.glued(pieces)).0)),
            ("glued, in steps", by_number(of_parts.displacements().unwrap())),
            ("glued by rows", by_number(&solved(&mut glued.by_rows(pieces)).0)),
        ] {
            assert!(apart(&own, &u) < 1e-8, "{pieces} pieces, {how}: {:e}", apart(&own, &u));
        }
    }
}
