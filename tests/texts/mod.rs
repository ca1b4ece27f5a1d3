//! A refusal says what the library knows about it.

use crate::support::hand_over;
use std::sync::{Arc, Mutex};

use decks::Blocks;
use feti_contact::body::{SparseInput, Storage};
use feti_contact::constraints::{FrictionInput, RowKind, RowsInput};
use feti_contact::error::{Error, Kind};
use feti_contact::solver::{LogLevel, Outcome, Problem};

/// A body of three unknowns: a bar of two springs along unknowns 0 and 1, and one unknown across, which nothing resists.
fn bar() -> Problem {
    let mut problem = Problem::new();
    problem.add_body(3).unwrap();
    let (ptr, col, val) = ([0, 1, 3, 4], [0, 0, 1, 2], [4.0, -4.0, 4.0, 0.0]);
    problem
        .set_stiffness(0, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })
        .unwrap();
    problem
}

fn row(problem: &mut Problem, kind: RowKind, dof: i64, value: f64, rhs: f64) {
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[dof], val: &[value], rhs: Some(&[rhs]) };
    problem.add_rows(kind, rows).unwrap();
}

fn node(problem: &mut Problem, dof: i64, coefficient: f64, bound: f64) {
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[dof], val: &[2.0], rhs: None };
    let (coefficient, bound) = (Some(&[coefficient][..]), Some(&[bound][..]));
    problem.add_friction(FrictionInput { dim: 1, normal: &[0], rows, coefficient, bound }).unwrap();
}

#[track_caller]
fn refused(problem: &mut Problem, kind: Kind, says: &str) -> Error {
    let error = problem.solve().unwrap_err();
    assert!(error.kind == kind && error.to_string().contains(says), "{says}: {error}");
    error
}

#[test]
fn a_load_that_nothing_holds_is_told_with_what_the_rows_do() {
    let mut alone = bar();
    alone.set_load(0, &[1.0, 0.0, 0.0]).unwrap();
    refused(&mut alone, Kind::LoadNotHeld, "no row with a finite gap touches what moves");
    row(&mut alone, RowKind::Inequality, 0, 1.0, f64::INFINITY);
    refused(&mut alone, Kind::LoadNotHeld, "no row with a finite gap touches what moves");
    // the wall is at the side to which the load pushes, but the row says the other
    let mut reversed = bar();
    row(&mut reversed, RowKind::Inequality, 1, -1.0, 0.5);
    reversed.set_load(0, &[1.0, 0.0, 0.0]).unwrap();
    refused(&mut reversed, Kind::LoadNotHeld, "opens every contact row that touches what moves (1)");
    let mut across = bar();
    row(&mut across, RowKind::Inequality, 1, 1.0, 0.5);
    across.set_load(0, &[1.0, 0.0, 1.0]).unwrap();
    let error =
        refused(&mut across, Kind::LoadNotHeld, "this unknown has no stiffness: no element resists it");
    assert_eq!(error.place.dof, Some(2));
    let mut rubbing = bar();
    row(&mut rubbing, RowKind::Inequality, 1, 1.0, 0.5);
    node(&mut rubbing, 2, 0.0, 0.25);
    rubbing.set_load(0, &[1.0, 0.0, 1.0]).unwrap();
    // the bound times the length of the tangential row
    refused(
        &mut rubbing,
        Kind::LoadNotHeld,
        "the friction of 1 nodes gives way: it can hold 50.000 % of the load along the slide",
    );
}

/// The proof's motion lifts the body, without pressure Coulomb's friction would hold nothing: the share is that of the slide.
#[test]
fn the_share_that_coulombs_friction_holds_is_told_for_the_slide_and_the_pressure_that_there_is() {
    for force in [1.0, 1e-6, 3e7] {
        let mut pushed = bar();
        row(&mut pushed, RowKind::Inequality, 1, 1.0, 0.5);
        node(&mut pushed, 2, 0.3, 0.0);
        pushed.set_load(0, &[force, 0.0, force]).unwrap();
        // the bound .3 N times the length of the tangential row
        let says = "the friction of 1 nodes gives way: it can hold 60.000 % of the load along the slide";
        refused(&mut pushed, Kind::LoadNotHeld, says);
        pushed.set_load(0, &[-force, 0.0, force]).unwrap();
        refused(
            &mut pushed,
            Kind::LoadNotHeld,
            "nothing presses the 1 nodes with friction that would resist",
        );
    }
}

#[test]
fn the_other_rows_of_a_contradiction_are_named_as_the_host_counts_them() {
    let mut problem = bar();
    problem.set_i64("index_base", 1).unwrap();
    row(&mut problem, RowKind::Inequality, 2, 1.0, 9.0);
    row(&mut problem, RowKind::Inequality, 0, 1.0, -1.0);
    row(&mut problem, RowKind::Equality, 0, 1.0, 0.5);
    let error = problem.solve().unwrap_err().counted_from(1);
    let said = error.to_string();
    let known =
        ["row 2: this contact row and equality row 1 ", "row 1: this equality row and contact row 2 "];
    assert!(error.kind == Kind::GapsContradict && known.iter().any(|known| said.contains(known)), "{said}");
}

#[test]
fn a_lagrange_multiplier_inside_k_is_called_by_its_name() {
    let mut problem = bar();
    let saddle = SparseInput {
        ptr: &[0, 1, 2, 4],
        col: &[0, 1, 0, 2],
        val: &[1.0, 1.0, 1.0, 0.0],
        storage: Storage::Lower,
    };
    let said = problem.set_stiffness(0, saddle).and_then(|()| problem.solve().map(drop)).unwrap_err();
    assert!(said.kind == Kind::Indefinite && said.what.contains("Lagrange multiplier"), "{said}");
    assert_eq!(said.place.dof, Some(2));
}

#[test]
fn an_answer_that_is_not_accurate_is_told_with_entry_and_place() {
    let mut problem = hand_over::problem(&Blocks::default().build()).unwrap();
    problem.set_text("max_steps=1 direct_limit=0 finish=none").unwrap();
    assert!(problem.shortfall().is_none());
    let outcome = problem.solve().unwrap().outcome;
    let told = problem.shortfall().unwrap();
    assert!(outcome != Outcome::Solved && told.place.value > told.place.limit, "{outcome:?} {told}");
    let placed = [told.place.body, told.place.row];
    assert!(placed.iter().flatten().count() == 1 || told.what.contains("duality gap"), "{told}");
}

#[test]
fn the_log_notes_a_percentage_a_tangential_row_along_its_normal_and_a_row_given_twice() {
    let mut problem = bar();
    row(&mut problem, RowKind::Inequality, 1, 1.0, 0.5);
    row(&mut problem, RowKind::Inequality, 1, 1.0, 0.5);
    node(&mut problem, 1, 30.0, 0.0);
    problem.set_load(0, &[1.0, 0.0, 0.0]).unwrap();
    let lines = Arc::new(Mutex::new(String::new()));
    let book = Arc::clone(&lines);
    let tell = move |_: LogLevel, text: &str| {
        book.lock().unwrap().push_str(text);
        0
    };
    problem.on_log(Some((LogLevel::Phase, Box::new(tell))));
    let _ = problem.solve();
    let lines = lines.lock().unwrap();
    for known in [
        "node 0 has a coefficient of friction of 30,",
        "a tangential row of node 0 is a multiple of its contact row 0",
        "contact row 1: it is row 0 given twice",
    ] {
        assert!(lines.contains(known), "{known}: {lines}");
    }
}
