//! What the certificate does not see: the largest errors of forces that still pass, on problems known by hand. Each test
//! states a figure of the table in docs/certificate.md.

use feti_contact::solver::{Modes, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Bodies of two unknowns, and contact rows without gaps between any of them.
struct Model(Problem);

impl Model {
    /// Two unknowns with a spring 1 between them, and `ground` of each; floating where both are 0.
    fn block(&mut self, ground: [f64; 2], load: [f64; 2]) {
        let body = self.0.add_body(2).unwrap();
        let val = [1.0 + ground[0], -1.0, 1.0 + ground[1]];
        let stiffness = SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &val, storage: Storage::Lower };
        self.0.set_stiffness(body, stiffness).unwrap();
        let modes = usize::from(ground == [0.0; 2]);
        self.0.set_null_space(body, 2, modes, &[1.0; 2][..2 * modes], 2, Modes::Exact).unwrap();
        self.0.set_load(body, &load).unwrap();
    }

    /// Entries by unknowns of all bodies, and the gap.
    fn row(&mut self, entries: &[(i64, f64)], gap: f64) {
        let (dof, val): (Vec<i64>, Vec<f64>) = entries.iter().copied().unzip();
        let ptr = [0, dof.len()];
        let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&[gap]) };
        self.0.add_rows(RowKind::Inequality, rows).unwrap();
    }

    /// The largest e, up to a factor 1.01, for which the answer (u, lambda) of e passes; that of 0 is right.
    fn largest(&mut self, answer: impl Fn(f64) -> (Vec<f64>, Vec<f64>)) -> f64 {
        let mut passes = |e: f64| {
            let (u, lambda) = answer(e);
            self.0.check(&u, &lambda, &[]).unwrap().passed()
        };
        assert!(passes(0.0), "the right answer is refused");
        let (mut low, mut high) = (1e-18_f64, 1e18_f64);
        while high > 1.01 * low {
            let middle = (low * high).sqrt();
            *(if passes(middle) { &mut low } else { &mut high }) = middle;
        }
        low
    }
}

fn model() -> Model {
    Model(Problem::new())
}

fn documented(what: &str, found: f64, figure: f64) {
    println!("{what}: {found:.1e}");
    assert!(found < 3.0 * figure && found > figure / 3.0, "{what}: {found:e}, documented {figure:e}");
}

/// Two equal held blocks, loads 1 and `part`, a row between their ends with a force of part / 2; u = (F, 2 F), F the force at
/// the end. An error of the gap is allowed against the deformation of both.
#[test]
fn the_force_of_a_light_body_beside_a_heavy_one_is_known_by_the_length_of_the_heavy_one() {
    for part in [1e-2, 1e-4, 1e-6] {
        let mut model = model();
        model.block([1.0, 0.0], [0.0, 1.0]);
        model.block([1.0, 0.0], [0.0, part]);
        let force = |e: f64| part / 2.0 * (1.0 + e);
        model.row(&[(3, 1.0), (1, -1.0)], 2.0 * (part - force(0.0)) - 2.0 * (1.0 + force(0.0)));
        let accepted = model.largest(|e| {
            let (heavy, light) = (1.0 + force(e), part - force(e));
            (vec![heavy, 2.0 * heavy, light, 2.0 * light], vec![force(e)])
        });
        documented(&format!("light body, load {part:.0e} of its neighbour's"), accepted, 1.5e-8 / part);
    }
}

/// A penalty p holds unknown 0 of a block at 1, and a row with a force of 1 acts there alone.
#[test]
fn a_force_on_a_penalty_unknown_alone_is_known_to_the_penalty_times_the_displacement() {
    for p in [1e6, 1e10, 1e20] {
        let mut model = model();
        model.block([p, 1.0], [p + 1.0 + 0.5, 0.0]);
        let u = (p + 0.5 + 1.0 - 1.0) / (p + 0.5);
        model.row(&[(0, 1.0)], u);
        let accepted = model.largest(|e| (vec![u, u / 2.0], vec![1.0 + e]));
        documented(&format!("row on a penalty unknown, penalty {p:.0e}"), accepted, 1e-8 * p);
    }
}

/// A floating block pressed against two walls, deformed by 1/2 after a travel: the walls share the load in one way only, and
/// the balance does not see which.
#[test]
fn after_far_travel_forces_that_balance_each_other_are_known_to_rounding_of_the_travel() {
    for travel in [1e6, 1e8, 1e10] {
        let mut model = model();
        model.block([0.0; 2], [1.0, 1.0]);
        let gap = travel / 2.0;
        model.row(&[(0, 1.0)], gap);
        model.row(&[(1, 1.0)], gap + 0.5);
        let accepted = model.largest(|e| {
            let spring = 0.5 * (1.0 + e);
            (vec![gap, gap + spring], vec![1.0 + spring, 1.0 - spring])
        });
        documented(&format!("travel {travel:.0e} of the deformation"), accepted, 3e-14 * travel + 2e-8);
    }
}

/// A held block and two rows (1, 0) and (1, epsilon) that carry 1/2 each.
#[test]
fn forces_of_rows_that_are_nearly_the_same_are_known_by_their_sum() {
    for epsilon in [1e-2, 1e-4, 1e-6] {
        let mut model = model();
        model.block([1.0, 1.0], [3.0, 0.0]);
        let (a, b) = (2.0, -0.5 * epsilon);
        let u = [(2.0 * a + b) / 3.0, (a + 2.0 * b) / 3.0];
        model.row(&[(0, 1.0)], u[0]);
        model.row(&[(0, 1.0), (1, epsilon)], u[0] + epsilon * u[1]);
        let accepted = model.largest(|e| (u.to_vec(), vec![0.5 - 0.5 * e, 0.5 + 0.5 * e]));
        documented(&format!("rows that differ by {epsilon:.0e}"), accepted, 1.2e-7 / epsilon);
    }
}
