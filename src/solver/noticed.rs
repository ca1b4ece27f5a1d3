//! Log lines about properties of the data that the host may not have intended.

use crate::body::Form;
use crate::constraints::{FrictionNode, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::Csr;
use crate::model::{Counted, HostModel, Parts};
use crate::numbers::data::HIGH_FRICTION;
use crate::numbers::rounding;
use crate::progress::{Log, LogLevel};

/// Notes: no load, contact rows that overlap before anything moves, contact rows that never close.
pub fn data(log: &Log, model: &HostModel) -> Result<()> {
    if !log.is_heard(LogLevel::Result) {
        return Ok(());
    }
    let number = |row: usize| model.number_of(Counted::Row(RowKind::Inequality), row);
    let contact = &model.contact;
    let overlap = rows(contact, |i| contact.rhs[i] < 0.0);
    load(log, model, !overlap.is_empty())?;
    if let Some(deepest) = overlap.iter().copied().min_by(|&i, &j| contact.rhs[i].total_cmp(&contact.rhs[j]))
    {
        let (gap, count) = (contact.rhs[deepest], counted(overlap.len()));
        log.say(LogLevel::Phase, || {
            format!(
                "note: {count} with overlap (c < 0) before anything moves, most in row {}: c = {gap:.1e}",
                number(deepest)
            )
        })?;
    }
    unusual(log, model)?;
    for (never, why) in [
        (rows(contact, |i| !contact.is_finite(i)), "because the gap is +infinity"),
        (rows(contact, |i| contact.is_finite(i) && has_no_entry(contact, i)), "because the row has no entry"),
    ] {
        if let Some(first) = never.first() {
            let count = counted(never.len());
            log.say(LogLevel::Phase, || {
                format!("note: {count} that can never close, {why}; the first is row {}", number(*first))
            })?;
        }
    }
    friction(log, model)
}

/// Notes: profiles whose new values need a new analysis. The result of the host's function is ignored: other ranks wait for this call.
pub fn grown(log: &Log, model: &mut HostModel) {
    for body in 0..model.bodies.len() {
        let Some(Form::Skyline(profile)) = model.bodies[body].form.as_deref_mut() else { continue };
        if !std::mem::take(&mut profile.has_grown) {
            continue;
        }
        let body = model.number_of(Counted::Body, body);
        let _ = log.say(LogLevel::Phase, || {
            format!("note: body {body}: a value of the profile of K was 0 and is not any more: the new pattern is analysed")
        });
    }
}

/// Notes: a coefficient of friction that is rather a percentage or an angle, a tangential row that is the normal row, rows
/// of very different lengths.
fn friction(log: &Log, model: &HostModel) -> Result<()> {
    let rows = &model.friction.rows;
    let number = |node: usize| model.number_of(Counted::Node, node);
    let nodes = || model.friction.nodes.iter().enumerate();
    // steel on rubber has 1 to 2
    if let Some((k, node)) = nodes().find(|(_, node)| node.coefficient > HIGH_FRICTION) {
        let coefficient = node.coefficient;
        log.say(LogLevel::Phase, || {
            format!(
                "note: node {} has a coefficient of friction of {coefficient}, a number and no percentage",
                number(k)
            )
        })?;
    }
    let along = |node: &FrictionNode| {
        let normal = node.normal?;
        node.rows().find(|&row| parallel(&rows.matrix, row, &model.contact.matrix, normal))
    };
    if let Some((k, node)) = nodes().find(|(_, node)| along(node).is_some()) {
        let normal = node.normal.unwrap_or_default();
        let normal = model.number_of(Counted::Row(RowKind::Inequality), normal);
        log.say(LogLevel::Phase, || {
            format!("note: a tangential row of node {} is a multiple of its contact row {normal}", number(k))
        })?;
    }
    let unequal = |k: usize| Some((k, model.friction.unequal(k, &model.contact)?));
    if let Some((k, ratio)) = (0..model.friction.len()).find_map(unequal) {
        log.say(LogLevel::Phase, || {
            format!(
                "note: the longest row of node {} has {ratio:.1e} times the length of its shortest: unless supports have \
                 taken entries, multiply the rows of a node by the same number",
                number(k)
            )
        })?;
    }
    Ok(())
}

/// Unknowns without stiffness, which belong to no part.
pub fn loose(log: &Log, host: &HostModel, parts: Option<&Parts>) -> Result<()> {
    let loose = parts.map(|parts| &parts.loose[..]).unwrap_or_default();
    let mut left = loose.iter().peekable();
    while let Some(&first) = left.next() {
        let body = host.offsets[1..].partition_point(|end| *end <= first);
        let stiffness =
            |j: usize| host.bodies[body].body.k().map_or(0.0, |k| k.metric(j - host.offsets[body], 0.0));
        let (dof, mut count, mut slight) = (first - host.offsets[body], 1, stiffness(first));
        while let Some(&j) = left.next_if(|j| **j < host.offsets[body + 1]) {
            (count, slight) = (count + 1, slight.max(stiffness(j)));
        }
        let (body, dof) = (host.number_of(Counted::Body, body), dof as i64 + host.settings.index_base);
        let unknowns = if count == 1 { "1 unknown has".to_owned() } else { format!("{count} unknowns have") };
        let left_out = match slight {
            0.0 => String::new(),
            most => {
                format!("; at most {most:.1e}, which is left out, is rounding of the stiffness of neighbours")
            }
        };
        let what = || {
            format!(
                "note: body {body}: {unknowns} no stiffness, no row and no load, and do not move; the first is \
                 {dof}{left_out}"
            )
        };
        log.say(LogLevel::Result, what)?;
    }
    Ok(())
}

/// Whether two rows are multiples of each other, to rounding.
fn parallel(a: &Csr, i: usize, b: &Csr, j: usize) -> bool {
    let (a, b) = (entries(a, i), entries(b, j));
    let largest = (0..a.len()).max_by(|&k, &l| a[k].1.abs().total_cmp(&a[l].1.abs()));
    let Some(k) = largest.filter(|_| a.len() == b.len()) else { return false };
    let by = b[k].1 / a[k].1;
    a.iter().zip(&b).all(|(a, b)| a.0 == b.0 && (b.1 - by * a.1).abs() <= 4.0 * f64::EPSILON * b.1.abs())
}

fn entries(rows: &Csr, i: usize) -> Vec<(usize, f64)> {
    rows.row(i).filter(|(_, value)| *value != 0.0).collect()
}

/// Rows whose entries cancel, and rows with entries far smaller than all others on their bodies.
fn unusual(log: &Log, model: &HostModel) -> Result<()> {
    let body_of = |j: usize| model.offsets[1..].partition_point(|end| *end <= j);
    let all = RowKind::ALL.map(|kind| (kind, model.rows(kind)));
    let mut largest = vec![0.0f64; model.bodies.len()];
    for (j, v) in all.iter().flat_map(|(_, rows)| (0..rows.len()).flat_map(|i| rows.matrix.row(i))) {
        let own = &mut largest[body_of(j)];
        *own = own.max(v.abs());
    }
    for (kind, rows) in all {
        let others =
            |i: usize| rows.matrix.row(i).map(|(j, _)| largest[body_of(j)]).fold(f64::INFINITY, f64::min);
        let short: Vec<usize> = (0..rows.len())
            .filter(|&i| !rows.is_empty_row(i) && rows.largest_entry(i) < rounding::METHOD * others(i))
            .collect();
        for (some, what) in [
            (rows.cancelled(), "the entries cancel up to rounding, or are rounding of the rows of their node: the row constrains nothing"),
            (&short[..], "its entries are below 1e-12 of those of all other rows on its bodies"),
        ] {
            let Some(first) = some.first() else { continue };
            let (count, number) = (some.len(), model.number_of(Counted::Row(kind), *first));
            log.say(LogLevel::Result, || {
                format!("warning: {} {number}: {what} (rows like this: {count})", kind.name())
            })?;
        }
    }
    Ok(())
}

/// `redundant` returns the rows of the stack, contact rows first, that are multiples of other rows, with their factors;
/// it is called only if the host has a log function.
pub fn repeated(
    log: &Log,
    model: &HostModel,
    redundant: impl FnOnce() -> Result<Vec<(usize, f64)>>,
) -> Result<()> {
    if !log.is_heard(LogLevel::Phase) {
        return Ok(());
    }
    let contact = model.contact.len();
    let mut of_host = redundant()?;
    of_host.retain(|(row, _)| *row < contact + model.equalities.len());
    let Some(&(first, _)) = of_host.first() else { return Ok(()) };
    let (kind, row) = if first < contact { ("contact", first) } else { ("equality", first - contact) };
    let count = of_host.len();
    let of = Counted::Row(if first < contact { RowKind::Inequality } else { RowKind::Equality });
    let rows = if first < contact { &model.contact } else { &model.equalities };
    let twice = (0..rows.len()).find(|&other| {
        other != row && rows.matrix.row(other).eq(rows.matrix.row(row)) && rows.rhs[other] == rows.rhs[row]
    });
    log.say(LogLevel::Phase, || {
        format!(
            "note: rows that are multiples of other rows, with which they share one force: {count}; the first is {kind} row {}{}",
            model.number_of(of, row),
            twice.map_or(String::new(), |other| format!(": it is row {} given twice", model.number_of(of, other)))
        )
    })
}

/// No load at all: a warning if nothing else moves the bodies.
fn load(log: &Log, model: &HostModel, overlaps: bool) -> Result<()> {
    let is_zero = |values: &[f64]| values.iter().all(|value| *value == 0.0);
    if model.bodies.iter().filter_map(|given| given.body.largest_load()).any(|most| most != 0.0) {
        return Ok(());
    }
    if overlaps || !is_zero(&model.equalities.rhs) || !is_zero(&model.friction.rows.rhs) {
        return log.say(LogLevel::Phase, || "note: no body has a load".to_owned());
    }
    let what = "warning: no body has a load, and neither gaps nor right-hand sides move the bodies: displacements are zero";
    log.say(LogLevel::Result, || what.to_owned())
}

fn rows(contact: &RowSet, is_one: impl Fn(usize) -> bool) -> Vec<usize> {
    (0..contact.len()).filter(|&i| is_one(i)).collect()
}

/// The row has only zero entries, and no compliance by which its own force could move it.
fn has_no_entry(contact: &RowSet, i: usize) -> bool {
    contact.rhs[i] >= 0.0 && contact.matrix.row(i).all(|(_, value)| value == 0.0)
}

fn counted(rows: usize) -> String {
    match rows {
        1 => "1 contact row".to_owned(),
        _ => format!("{rows} contact rows"),
    }
}
