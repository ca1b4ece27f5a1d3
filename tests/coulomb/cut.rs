//! Bodies given by their elements, whole and cut into pieces.

use decks::{Deck, Rows};
use feti_contact::error::{Kind, Result};
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::coulomb::battery::{answer, sizes, RIGHT};
use crate::coulomb::drawn::{case, Drawn};
use crate::coulomb::idle::give;
use crate::coulomb::judge;
use crate::support::asked::seeds;
use crate::support::hand_over;

/// Number of problems of the ordinary run.
const PROBLEMS: u64 = 400;
/// Pieces of each body, about.
const PIECES: [i64; 3] = [1, 2, 4];

/// Bodies by their elements, cut into about so many pieces each.
fn in_pieces(drawn: &Drawn, pieces: i64) -> Result<Problem> {
    let mut problem = Problem::new();
    problem.set_i64("pieces", pieces)?;
    for (body, elements) in drawn.deck.bodies.iter().zip(&drawn.elements) {
        let p = give(&mut problem, body.dofs(), elements)?;
        problem.set_load(p, &body.load)?;
    }
    let Deck { contact, equalities, friction, .. } = &drawn.deck;
    let of = |problem: &mut Problem, kind, rows: &Rows| hand_over::add_rows(problem, kind, rows);
    of(&mut problem, RowKind::Inequality, contact)?;
    of(&mut problem, RowKind::Equality, equalities)?;
    hand_over::add_friction(&mut problem, friction)?;
    Ok(problem)
}

/// How it ends, and whether with an answer that is right.
fn ended(drawn: &Drawn, pieces: i64) -> (String, Option<bool>) {
    let solved = in_pieces(drawn, pieces).and_then(|mut problem| Ok((problem.solve()?, problem)));
    match solved {
        Ok((report, problem)) => {
            let is_solved = report.outcome == Outcome::Solved;
            let (ratio, place) = judge::worst(&drawn.deck, &answer(&problem));
            let text = format!(
                "{:?}, certificate {:.0e}, {ratio:.0e} {place}",
                report.outcome,
                report.certificate.worst()
            );
            (text, is_solved.then_some(ratio <= RIGHT))
        }
        Err(error) => {
            (format!("{:?}: {error}", error.kind), matches!(error.kind, Kind::LoadNotHeld).then_some(true))
        }
    }
}

#[test]
fn as_much_is_solved_in_pieces_as_whole() {
    let (mut lines, mut solved, mut wrong) = (Vec::new(), [0; PIECES.len()], 0);
    for seed in seeds(PROBLEMS) {
        let drawn = case(seed, sizes());
        let ends = PIECES.map(|pieces| ended(&drawn, pieces));
        solved.iter_mut().zip(&ends).for_each(|(count, end)| *count += usize::from(end.1 == Some(true)));
        wrong += ends.iter().filter(|end| end.1 == Some(false)).count();
        if ends.iter().any(|end| end.1 != Some(true)) {
            lines.push(format!("{seed:6} {} {:?} {:#?}", drawn.class, drawn.known, ends.map(|end| end.0)));
        }
    }
    let table = format!("solved {solved:?}, {wrong} wrong\n{}", lines.join("\n"));
    println!("{table}");
    assert!(
        wrong == 0 && solved.iter().all(|cut| cut + seeds(PROBLEMS).count() / 200 >= solved[0]),
        "{table}"
    );
}
