//! Unknowns that the host has eliminated: its table against dense matrices T.

mod refusals;

use decks::random::Random;
use feti_contact::error::Result;
use feti_contact::solver::{
    DofTableInput, FrictionInput, FrictionState, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage,
};

/// A grounded body, the host's unknowns in its order, and rows over them.
struct Model {
    /// Lower triangle by rows, m x m.
    k: Vec<f64>,
    /// Number in K of the host's unknowns; -1: eliminated.
    number: Vec<i64>,
    ptr: Vec<usize>,
    term: Vec<i64>,
    coefficient: Vec<f64>,
    constant: Vec<f64>,
    load: Vec<f64>,
    /// Entries, right-hand side and kind of rows; those of kind Tangential belong to the contact row before.
    rows: Vec<(RowKind, Vec<(usize, f64)>, f64)>,
}

impl Model {
    /// `new`: values on which nothing is built: constants, loads and right-hand sides.
    fn random(seed: u64, new: u64) -> Self {
        let mut random = Random::new(seed);
        let (m, eliminated) = (3 + random.below(6), 1 + random.below(6));
        let n = m + eliminated;
        let mut k = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..i {
                k[i * m + j] = random.between(-1.0, 1.0);
            }
            k[i * m + i] = m as f64 + random.uniform();
        }
        // the host's unknown of every place, in a random order; places from m on are eliminated, by those before them
        let mut of_place: Vec<usize> = (0..n).collect();
        (1..n).for_each(|i| of_place.swap(i, random.below(i + 1)));
        let (mut number, mut terms) = (vec![-1; n], vec![Vec::new(); n]);
        for (place, &i) in of_place.iter().enumerate() {
            if place < m {
                number[i] = place as i64;
            } else if random.chance(0.7) {
                // chains: mostly by eliminated unknowns
                let term = |random: &mut Random| match random.chance(0.6) && place > m {
                    true => m + random.below(place - m),
                    false => random.below(place),
                };
                let count = 1 + random.below(3);
                terms[i] =
                    (0..count).map(|_| (of_place[term(&mut random)], random.between(-1.0, 1.0))).collect();
                if random.chance(0.2) {
                    terms[i].truncate(1);
                    terms[i][0].1 = 1.0;
                }
            }
        }
        let mut rows = Vec::new();
        let entries = |random: &mut Random| -> Vec<(usize, f64)> {
            (0..1 + random.below(3)).map(|_| (random.below(n), random.between(-1.0, 1.0))).collect()
        };
        for _ in 0..2 + random.below(3) {
            rows.push((RowKind::Inequality, entries(&mut random), 0.0));
            if random.chance(0.4) {
                rows.push((RowKind::Tangential, entries(&mut random), 0.0));
            }
        }
        if random.chance(0.4) {
            rows.push((RowKind::Equality, entries(&mut random), 0.0));
        }
        let mut random = Random::new(seed ^ (new << 32));
        let constant =
            number.iter().map(|k| if *k < 0 && random.chance(0.7) { random.normal() } else { 0.0 });
        let constant = constant.collect();
        let load = random.normals(n, 10.0);
        rows.iter_mut().for_each(|row| row.2 = random.between(-0.2, 0.5));
        let ptr = (0..=n).map(|i| terms[..i].iter().map(Vec::len).sum()).collect();
        let terms: Vec<(usize, f64)> = terms.concat();
        Self {
            k,
            number,
            ptr,
            term: terms.iter().map(|term| term.0 as i64).collect(),
            coefficient: terms.iter().map(|term| term.1).collect(),
            constant,
            load,
            rows,
        }
    }

    fn m(&self) -> usize {
        self.number.iter().filter(|number| **number >= 0).count()
    }

    fn table(&self) -> DofTableInput<'_> {
        let (number, ptr, constant) = (&self.number[..], Some(&self.ptr[..]), Some(&self.constant[..]));
        DofTableInput { number, ptr, term: &self.term, coefficient: &self.coefficient, constant }
    }

    /// T and g by substitution until nothing changes.
    fn dense(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (n, m) = (self.number.len(), self.m());
        let (mut t, mut g) = (vec![vec![0.0; m]; n], vec![0.0; n]);
        for _ in 0..=n {
            for i in 0..n {
                if self.number[i] >= 0 {
                    t[i][self.number[i] as usize] = 1.0;
                    continue;
                }
                let (mut row, mut constant) = (vec![0.0; m], self.constant[i]);
                for at in self.ptr[i]..self.ptr[i + 1] {
                    let (term, by) = (self.term[at] as usize, self.coefficient[at]);
                    row.iter_mut().zip(&t[term]).for_each(|(sum, v)| *sum += by * v);
                    constant += by * g[term];
                }
                (t[i], g[i]) = (row, constant);
            }
        }
        (t, g)
    }

    /// The body, without a load.
    fn body(&self) -> Problem {
        let m = self.m();
        let ptr: Vec<usize> = (0..=m).map(|i| i * (i + 1) / 2).collect();
        let lower = (0..m).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let (col, val): (Vec<i64>, Vec<f64>) = lower.map(|(i, j)| (j as i64, self.k[i * m + j])).unzip();
        let mut problem = Problem::new();
        problem.add_body(m).unwrap();
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(0, k).unwrap();
        problem
    }
}

/// Adds a row; entries name unknowns by number.
fn add(problem: &mut Problem, kind: RowKind, entries: &[(usize, f64)], rhs: f64) -> Result<usize> {
    let (dof, val): (Vec<i64>, Vec<f64>) = entries.iter().map(|(i, v)| (*i as i64, *v)).unzip();
    let (ptr, own) = ([0, dof.len()], [rhs]);
    let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&own) };
    if kind != RowKind::Tangential {
        return problem.add_rows(kind, rows);
    }
    let normal = [problem.sizes().of(RowKind::Inequality) as i64 - 1];
    let rows = RowsInput { rhs: None, ..rows };
    let (coefficient, bound) = (Some(&[0.3][..]), Some(&[0.5][..]));
    let node = problem.add_friction(FrictionInput { dim: 1, normal: &normal, rows, coefficient, bound })?;
    problem.set_friction_reference(node, 1, 1, &own)?;
    Ok(node)
}

/// By the table.
fn tabled(model: &Model) -> Problem {
    let mut problem = model.body();
    problem.set_dof_table(model.table()).unwrap();
    problem.set_all_loads(&model.load).unwrap();
    for (kind, entries, rhs) in &model.rows {
        add(&mut problem, *kind, entries, *rhs).unwrap();
    }
    problem
}

/// By the dense T and g.
fn reduced(model: &Model) -> Problem {
    let ((t, g), mut problem) = (model.dense(), model.body());
    let load: Vec<f64> =
        (0..model.m()).map(|j| (0..g.len()).map(|i| t[i][j] * model.load[i]).sum()).collect();
    problem.set_load(0, &load).unwrap();
    for (kind, entries, rhs) in &model.rows {
        let (mut row, mut rhs) = (vec![0.0; model.m()], *rhs);
        for (i, b) in entries {
            row.iter_mut().zip(&t[*i]).for_each(|(sum, t)| *sum += b * t);
            rhs -= b * g[*i];
        }
        let row: Vec<(usize, f64)> = row.into_iter().enumerate().filter(|entry| entry.1 != 0.0).collect();
        add(&mut problem, *kind, &row, rhs).unwrap();
    }
    problem
}

/// One unknown on a spring 2.
fn spring() -> Problem {
    let mut problem = Problem::new();
    problem.add_body(1).unwrap();
    let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[2.0], storage: Storage::Lower };
    problem.set_stiffness(0, k).unwrap();
    problem
}

const KINDS: [RowKind; 3] = RowKind::ALL;

/// What both say is the same: displacements of all unknowns of the host, forces, states and reactions; true if there is an answer.
fn agree(model: &Model, own: &mut Problem, other: &mut Problem, seed: u64) -> bool {
    let ends = [&mut *own, &mut *other].map(|p| p.solve().map(|r| r.outcome).map_err(|error| error.kind));
    assert_eq!(ends[0], ends[1], "problem {seed}");
    if ends[0] != Ok(Outcome::Solved) {
        return false;
    }
    let ((t, g), v) = (model.dense(), other.displacements().unwrap());
    let u: Vec<f64> =
        t.iter().zip(&g).map(|(t, g)| g + t.iter().zip(v).map(|(t, v)| t * v).sum::<f64>()).collect();
    let mut all = vec![f64::NAN; u.len()];
    own.spread_displacement(own.displacements().unwrap(), |i, u| all[i] = u).unwrap();
    close(&all, &u, seed);
    let mut reaction = vec![0.0; u.len()];
    for kind in KINDS {
        let [lambda, expected] = [&*own, &*other].map(|p| p.multipliers(kind).unwrap());
        close(lambda, expected, seed);
        let rows = model.rows.iter().filter(|row| row.0 == kind);
        for ((_, entries, _), force) in rows.zip(expected) {
            entries.iter().for_each(|(i, b)| reaction[*i] -= b * force);
        }
    }
    own.spread_reaction(None, |i, r| all[i] = r).unwrap();
    close(&all, &reaction, seed);
    let states = [&*own, &*other].map(|p| p.friction_states().unwrap().to_vec());
    let moves = |state: &FrictionState| !matches!(state, FrictionState::Open);
    assert_eq!(states[0].iter().filter(|s| moves(s)).count(), states[1].iter().filter(|s| moves(s)).count());
    true
}

fn close(own: &[f64], other: &[f64], seed: u64) {
    let most = other.iter().fold(1.0, |most: f64, v| most.max(v.abs()));
    let is_close =
        own.len() == other.len() && own.iter().zip(other).all(|(a, b)| (a - b).abs() <= 1e-10 * most);
    assert!(is_close, "problem {seed}: {own:?} {other:?}");
}

/// Chains, supports, combinations, unknowns that are equal, friction on driven and tied nodes.
#[test]
fn tables_at_random_give_what_dense_matrices_give() {
    let solved = (0..1000).filter(|&seed| {
        let model = Model::random(seed, 0);
        agree(&model, &mut tabled(&model), &mut reduced(&model), seed)
    });
    assert!(solved.count() > 600);
}

#[test]
fn new_constants_and_other_coefficients_give_what_a_new_problem_gives() {
    let solved = (0..300).filter(|&seed| {
        let (model, next) = (Model::random(seed, 0), Model::random(seed, 1));
        let mut own = tabled(&model);
        let state = own.save_state().unwrap();
        let answered = own.solve().is_ok();
        // other constants, then other coefficients, then both as they were
        own.set_dof_table(next.table()).unwrap();
        let halves = Model {
            coefficient: next.coefficient.iter().map(|c| 0.5 * c).collect(),
            ..Model::random(seed, 1)
        };
        own.set_dof_table(halves.table()).unwrap();
        own.set_all_loads(&halves.load).unwrap();
        for (kind, mut row) in [(RowKind::Inequality, 0), (RowKind::Equality, 0), (RowKind::Tangential, 0)] {
            for (_, _, rhs) in halves.rows.iter().filter(|of| of.0 == kind) {
                match kind {
                    RowKind::Tangential => own.set_friction_reference(row, 1, 1, &[*rhs]).unwrap(),
                    _ => own.set_rhs(kind, row, &[*rhs]).unwrap(),
                }
                row += 1;
            }
        }
        let agreed = agree(&halves, &mut own, &mut reduced(&halves), seed);
        own.restore_state(state).unwrap();
        agree(&model, &mut own, &mut reduced(&model), seed) && agreed && answered
    });
    assert!(solved.count() > 150);
}

/// A mass pushed past what friction holds, its foot driven by the host: the next step starts from where the foot has slipped to.
#[test]
fn committed_slips_are_those_of_driven_unknowns() {
    let mut problem = spring();
    // unknown 1 is driven by .5, and the node slips by u_0 - u_1
    let drive = |problem: &mut Problem, by: f64| {
        let constant = [0.0, by];
        let table = DofTableInput {
            number: &[0, -1],
            ptr: None,
            term: &[],
            coefficient: &[],
            constant: Some(&constant),
        };
        problem.set_dof_table(table).unwrap();
    };
    drive(&mut problem, 0.5);
    let rows = RowsInput { ptr: &[0, 2], body: None, dof: &[0, 1], val: &[1.0, -1.0], rhs: None };
    let node = FrictionInput { dim: 1, normal: &[-1], rows, coefficient: None, bound: Some(&[0.2]) };
    problem.add_friction(node).unwrap();
    let u = |problem: &mut Problem| {
        problem.solve().unwrap();
        problem.displacements().unwrap()[0]
    };
    // friction pulls by .2: u = .1, slip -.4
    assert!((u(&mut problem) - 0.1).abs() < 1e-12);
    problem.commit_friction().unwrap();
    assert!((u(&mut problem) - 0.1).abs() < 1e-12);
    // the foot goes back to .45: it sticks, u = .05
    drive(&mut problem, 0.45);
    assert!((u(&mut problem) - 0.05).abs() < 1e-12);
}

#[test]
fn a_row_that_never_closes_is_turned_on_with_what_is_left_of_its_gap() {
    let mut problem = spring();
    let constant = Some(&[0.0, 0.25][..]);
    let table = DofTableInput { number: &[0, -1], ptr: None, term: &[], coefficient: &[], constant };
    problem.set_dof_table(table).unwrap();
    problem.set_all_loads(&[2.0, 0.0]).unwrap();
    add(&mut problem, RowKind::Inequality, &[(0, 1.0), (1, -1.0)], f64::INFINITY).unwrap();
    for (gap, u) in [(f64::INFINITY, 1.0), (0.5, 0.75), (f64::INFINITY, 1.0)] {
        problem.set_rhs(RowKind::Inequality, 0, &[gap]).unwrap();
        problem.set_dof_table(table).unwrap();
        problem.solve().unwrap();
        assert!((problem.displacements().unwrap()[0] - u).abs() < 1e-12, "{gap}");
    }
}

/// On an arm of 1e4 the row along the arm is as short as that of the normal is long: what the table makes of rows says nothing of their factors.
#[test]
fn a_node_on_the_long_arm_of_a_pilot_has_friction() {
    for (factor, ends) in [(1.0, true), (2e3, false)] {
        let mut problem = Problem::new();
        problem.add_body(3).unwrap();
        let k = SparseInput { ptr: &[0, 1, 2, 3], col: &[0, 1, 2], val: &[2.0; 3], storage: Storage::Lower };
        problem.set_stiffness(0, k).unwrap();
        let arm = [6e3, 8e3 + 1e-2];
        let terms = ([0, 2, 1, 2], [1.0, -arm[1], 1.0, arm[0]]);
        let table = DofTableInput {
            number: &[0, 1, 2, -1, -1],
            ptr: Some(&[0, 0, 0, 0, 2, 4]),
            term: &terms.0,
            coefficient: &terms.1,
            constant: None,
        };
        problem.set_dof_table(table).unwrap();
        add(&mut problem, RowKind::Inequality, &[(3, 0.6), (4, 0.8)], 0.0).unwrap();
        let made = add(&mut problem, RowKind::Tangential, &[(3, -0.8 * factor), (4, 0.6 * factor)], 0.0);
        assert_eq!(made.is_ok(), ends, "{made:?}");
        problem.set_dof_table(table).unwrap();
        // a file has the rows as the table has made them
        Problem::new().read_bytes(&problem.write_bytes().unwrap()).unwrap();
    }
}

/// c - b g is rounding of its terms.
#[test]
fn a_held_node_on_a_held_face_has_a_row_that_holds_up_to_rounding() {
    let mut problem = spring();
    let constant = [0.0, 0.3, 0.1];
    let table = DofTableInput {
        number: &[0, -1, -1],
        ptr: None,
        term: &[],
        coefficient: &[],
        constant: Some(&constant),
    };
    problem.set_dof_table(table).unwrap();
    for rhs in [0.3 - 3.0 * 0.1, -1e-17] {
        add(&mut problem, RowKind::Inequality, &[(1, 1.0), (2, -3.0)], rhs).unwrap();
    }
    problem.set_all_loads(&[1.0, 5.0, 5.0]).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert!((problem.displacements().unwrap()[0] - 0.5).abs() < 1e-14);
}
