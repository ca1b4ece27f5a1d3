//! What is suspicious in rows by their entries alone: gaps of one sign, lengths, rows given twice or nearly, sides that are missing.

use std::collections::BTreeMap;

use feti_contact::solver::RowSet;

use crate::contents::Contents;
use crate::show::{listed, median, Suspicion};

/// Gaps of fewer rows may all be negative by chance: signs drawn at random agree once in 2^6.
const FEW: usize = 6;
/// A row beside so many whole ones may have lost a side.
const WHOLE: usize = 4;
/// Lengths of the rows of a pair differ by the areas of nodes at most.
const LENGTH: f64 = 1e4;
/// Rows whose directions differ by less than this, and more than rounding, are one row, computed twice.
const NEARLY: f64 = 1e-6;
const ROUNDING: f64 = 1e-14;

const KINDS: [&str; 2] = ["contact row", "equality row"];

/// The rows between the same bodies.
pub fn groups(all: &Contents, rows: &RowSet) -> BTreeMap<Vec<usize>, Vec<usize>> {
    let mut groups = BTreeMap::<Vec<usize>, Vec<usize>>::new();
    for i in 0..rows.rhs.len() {
        let touched = rows.matrix.row(i).filter(|(_, value)| *value != 0.0);
        let mut bodies: Vec<usize> = touched.map(|(j, _)| all.body_of(j)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        groups.entry(bodies).or_default().push(i);
    }
    groups
}

pub fn suspicions(all: &Contents) -> Vec<Suspicion> {
    let mut found = Vec::new();
    all.rows.into_iter().zip(KINDS).for_each(|(rows, kind)| twice(rows, kind, &mut found));
    // an equality row says the same in any length, with any sign
    let (rows, groups) = (all.rows[0], groups(all, all.rows[0]));
    for (bodies, own) in groups.iter().filter(|(bodies, own)| !bodies.is_empty() && own.len() > 1) {
        let between = listed(if bodies.len() > 1 { "bodies" } else { "body" }, bodies);
        found.extend(gaps(rows, own, &between));
        lengths(rows, own, &mut found);
    }
    one_sided(all, rows, &groups, &mut found);
    found
}

/// All gaps of a pair below 0, or all +infinity.
fn gaps(rows: &RowSet, own: &[usize], between: &str) -> Option<Suspicion> {
    let all = |is: fn(f64) -> bool| own.iter().all(|&i| is(rows.rhs[i]));
    if own.len() >= FEW && all(|gap| gap < 0.0) {
        let remedy = "check the sign of the gaps, c = n'(x_foot - x_s), and of the normals; nothing to do for a press fit";
        return Some(Suspicion::new(between.to_owned(), "all gaps between them are negative", remedy));
    }
    let what = "all gaps between them are +infinity: no row can ever close";
    all(f64::is_infinite)
        .then(|| Suspicion::new(between.to_owned(), what, "give the gaps of the pairs that may close"))
}

fn norm(rows: &RowSet, i: usize) -> f64 {
    rows.matrix.row(i).map(|(_, value)| value * value).sum::<f64>().sqrt()
}

/// A row far longer or shorter than the others of its pair.
fn lengths(rows: &RowSet, own: &[usize], found: &mut Vec<Suspicion>) {
    let lengths: Vec<f64> = own.iter().map(|&i| norm(rows, i)).collect();
    let Some(middle) = median(lengths.clone()) else { return };
    let far = |length: f64| length > 0.0 && (length > LENGTH * middle || length * LENGTH < middle);
    let far: Vec<_> = own.iter().zip(lengths).filter(|(_, length)| far(*length)).collect();
    if let Some((_, length)) = far.first() {
        let rows: Vec<usize> = far.iter().map(|(i, _)| **i).collect();
        let what = format!(
            "its entries are {:.0e} times those of the other rows between the same bodies",
            length / middle
        );
        found.push(Suspicion::new(
            listed(KINDS[0], &rows),
            what,
            "check the normal: a unit vector, times the area at most",
        ));
    }
}

/// Rows with the same unknowns whose directions agree, exactly or nearly, and whose gaps agree, too.
fn twice(rows: &RowSet, kind: &str, found: &mut Vec<Suspicion>) {
    let mut alike = BTreeMap::<Vec<usize>, Vec<(usize, Vec<f64>)>>::new();
    let (mut same, mut nearly) = (Vec::new(), Vec::new());
    for i in 0..rows.rhs.len() {
        let length = norm(rows, i);
        let mut entries: Vec<_> = rows.matrix.row(i).filter(|(_, value)| *value != 0.0).collect();
        if entries.is_empty() {
            continue;
        }
        entries.sort_by_key(|(j, _)| *j);
        let direction: Vec<f64> = entries.iter().map(|(_, value)| value / length).collect();
        let gap = rows.rhs[i] / length;
        let others = alike.entry(entries.iter().map(|(j, _)| *j).collect()).or_default();
        for (k, other) in others.iter() {
            let away = direction.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let gap_of_other = rows.rhs[*k] / norm(rows, *k);
            if away <= ROUNDING && gap_of_other == gap {
                same.push((i, *k));
            } else if away > ROUNDING && away <= NEARLY {
                nearly.push((i, *k));
            }
        }
        others.push((i, direction));
    }
    if let Some((row, first)) = same.first() {
        let rows: Vec<usize> = same.iter().map(|(row, _)| *row).collect();
        let what = format!("row {row} is row {first} given twice: the two share one force");
        found.push(Suspicion::new(listed(kind, &rows), what, "give each node and face once"));
    }
    if let Some((row, first)) = nearly.first() {
        let rows: Vec<usize> = nearly.iter().map(|(row, _)| *row).collect();
        let what =
            format!("row {row} is nearly parallel to row {first}: forces between the two are not certain");
        found.push(Suspicion::new(
            listed(kind, &rows),
            what,
            "give one of the two, or compute both normals in the same way",
        ));
    }
}

/// A row of one body between rows that have the same length on it, but go on to a second body.
fn one_sided(
    all: &Contents,
    rows: &RowSet,
    groups: &BTreeMap<Vec<usize>, Vec<usize>>,
    found: &mut Vec<Suspicion>,
) {
    let mut bodies_of = vec![&[][..]; rows.rhs.len()];
    groups.iter().for_each(|(bodies, own)| own.iter().for_each(|&i| bodies_of[i] = &bodies[..]));
    let on = |i: usize, p: usize| {
        let own = rows.matrix.row(i).filter(|(j, _)| all.body_of(*j) == p);
        own.map(|(_, value)| value * value).sum::<f64>().sqrt()
    };
    let is_lost = |&i: &usize| {
        let ([p], Some(before), Some(after)) = (bodies_of[i], i.checked_sub(1), bodies_of.get(i + 1)) else {
            return false;
        };
        let is_pair = after.len() == 2 && after.contains(p) && bodies_of[before] == *after;
        let alike = |other: usize| (on(other, *p) / on(i, *p) - 1.0).abs() <= NEARLY;
        is_pair && alike(i - 1) && alike(i + 1) && groups[*after].len() >= WHOLE * groups[bodies_of[i]].len()
    };
    let lost: Vec<usize> = (0..rows.rhs.len()).filter(is_lost).collect();
    if let Some(&[p]) = lost.first().map(|i| bodies_of[*i]) {
        let what = format!("it touches body {p} alone, the rows around it a second body");
        found.push(Suspicion::new(
            listed(KINDS[0], &lost),
            what,
            "give the entries of the face, too; nothing to do if supports have struck them out of K",
        ));
    }
}
