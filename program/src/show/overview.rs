//! What a problem has: bodies, rows, friction, options.

use feti_contact::solver::{Origin, Problem, RowSet};

use crate::contents::{word, Contents};
use crate::show::{bodies, rows};
use crate::table::{row, table};

pub fn text(problem: &Problem, all: &Contents, options: &str) -> String {
    let sizes = problem.sizes();
    let mut out = format!(
        "{} bodies, {} unknowns, {} contact rows, {} equality rows, {} nodes with friction\noptions: {}\n\nbodies\n",
        sizes.bodies, sizes.dofs, sizes.rows, sizes.equalities, sizes.nodes,
        if options.is_empty() { "defaults" } else { options }
    );
    out += &of_bodies(problem, all);
    for (own, kind) in all.rows.into_iter().zip(["contact rows", "equality rows"]) {
        if !own.rhs.is_empty() {
            out += &format!("\n{kind}\n{}", of_rows(all, own));
        }
    }
    let friction = all.friction;
    if !friction.nodes.is_empty() {
        let [low, high] = range(friction.nodes.iter().map(|node| node.coefficient));
        let bounds = friction.nodes.iter().filter(|node| node.bound > 0.0).count();
        out += &format!(
            "\nfriction: {} nodes with {} tangential rows each, coefficients {low:.3} to {high:.3}, {bounds} with a bound of their own\n",
            friction.nodes.len(), friction.dim
        );
    }
    out
}

fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

fn of_bodies(problem: &Problem, all: &Contents) -> String {
    let head =
        ["body", "unknowns", "entries of K", "digits", "K_ii", "motions declared", "found", "K R", "load"];
    let mut lines = vec![row(head)];
    for (p, body) in all.bodies.iter().enumerate() {
        let [low, high] = range(body.diagonal());
        let given = &body.given;
        let declared = match (given.motions, given.coordinates) {
            (Some((_, of)), _) => format!("{} {}", body.declared().unwrap_or(0), word(of)),
            (None, Some(_)) => format!("coordinates, {}", word(given.coordinate_modes)),
            (None, None) => "none".to_owned(),
        };
        let facts = problem.body_facts(p).ok();
        let found = facts
            .as_ref()
            .and_then(|of| of.factors.as_ref())
            .map_or("?".to_owned(), |of| of.null_space.to_string());
        let searched = facts.is_some_and(|of| of.origin == Origin::Found && given.coordinates.is_some());
        let pieces = given.pieces;
        let pieces = if pieces > 1 { format!(" in {pieces} pieces") } else { String::new() };
        lines.push(vec![
            p.to_string(),
            format!("{}{pieces}", body.n()),
            body.k().map_or(0, |k| k.val.len()).to_string(),
            body.digits().map_or("all".to_owned(), |of| of.to_string()),
            format!("{low:.1e} to {high:.1e}"),
            declared,
            found + if searched { " in K" } else { "" },
            bodies::resisted(body).map_or(String::new(), |most| format!("{most:.0e}")),
            format!("{:.2e}", body.load.iter().map(|f| f * f).sum::<f64>().sqrt()),
        ]);
    }
    table(&lines)
}

fn of_rows(all: &Contents, own: &RowSet) -> String {
    let mut lines =
        vec![row(["bodies", "rows", "first", "entries", "largest entry", "right-hand side", "compliant"])];
    for (bodies, of) in rows::groups(all, own) {
        let entries = || of.iter().flat_map(|&i| own.matrix.row(i));
        let most = |i: usize| own.matrix.row(i).fold(0.0f64, |most, (_, value)| most.max(value.abs()));
        let [low, high] = range(of.iter().map(|&i| most(i)));
        let [least, largest] = range(of.iter().map(|&i| own.rhs[i]));
        lines.push(vec![
            match bodies.is_empty() {
                true => "none".to_owned(),
                false => bodies.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
            },
            of.len().to_string(),
            of[0].to_string(),
            entries().count().to_string(),
            format!("{low:.1e} to {high:.1e}"),
            format!("{least:.2e} to {largest:.2e}"),
            of.iter().filter(|&&i| own.compliance[i] > 0.0).count().to_string(),
        ]);
    }
    table(&lines)
}
