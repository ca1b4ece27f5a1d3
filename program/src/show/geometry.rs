//! What is suspicious in rows and bodies with coordinates: normals and gaps that do not fit the places of the unknowns.

use feti_contact::solver::RowSet;

use crate::contents::Contents;
use crate::show::rows::groups;
use crate::show::{listed, Suspicion};

/// Digits that coordinates and normals agree to.
const AGREE: f64 = 1e-6;
/// Fewer rows show nothing that most of them have.
const FEW: usize = 4;
/// Larger pairs are not compared row by row.
const MOST: usize = 4000;
/// Pairs whose points lie so many times the size of a body apart have no common unit of length.
const APART: f64 = 20.0;

/// A row with its normal on the first and on the second body, its places there, and the gap that the coordinates have.
struct Seen {
    row: usize,
    normal: [[f64; 3]; 2],
    place: [[f64; 3]; 2],
    /// `-B x`, and the size of its terms.
    gap: f64,
    size: f64,
}

pub fn suspicions(all: &Contents) -> Vec<Suspicion> {
    let mut found = Vec::new();
    let rows = all.rows[0];
    for (bodies, own) in groups(all, rows) {
        let [a, .., b] = [&bodies[..], &bodies[..]].concat()[..] else { continue };
        if bodies.len() > 2 || bodies.iter().any(|p| all.bodies[*p].given.coordinates.is_none()) {
            continue;
        }
        let all_seen = own.iter().map(|&i| see(all, rows, i, [a, b]));
        let seen: Vec<Seen> = all_seen.filter(|of| bodies.len() == 1 || is_whole(of)).collect();
        if seen.len() < FEW {
            continue;
        }
        lengths(&seen, &mut found);
        if bodies.len() == 1 || apart(all, &seen, [a, b], &mut found) {
            continue;
        }
        moved(&seen, &mut found);
        gaps(rows, &seen, &mut found);
        turned(&seen, &mut found);
    }
    found
}

fn see(all: &Contents, rows: &RowSet, row: usize, bodies: [usize; 2]) -> Seen {
    let mut seen = Seen { row, normal: [[0.0; 3]; 2], place: [[0.0; 3]; 2], gap: 0.0, size: 0.0 };
    let mut weight = [0.0; 2];
    for (j, value) in rows.matrix.row(row) {
        let p = all.body_of(j);
        let (i, side) = (j - all.starts[p], usize::from(p == bodies[1] && bodies[0] != bodies[1]));
        let Some((xyz, dir)) = all.bodies[p].given.coordinates else { continue };
        let Some(d) = usize::try_from(dir[i] - 1).ok().filter(|d| *d < 3) else { continue };
        seen.normal[side][d] += value;
        weight[side] += value.abs();
        for k in 0..3 {
            seen.place[side][k] += value.abs() * xyz[i][k];
        }
        seen.gap -= value * xyz[i][d];
        seen.size += (value * xyz[i][d]).abs();
    }
    for side in 0..2 {
        seen.place[side].iter_mut().for_each(|x| *x /= weight[side]);
    }
    seen
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dot(&d, &d).sqrt()
}

/// Normals of both sides that cancel.
fn cancels(of: &Seen) -> bool {
    distance(&of.normal[0], &of.normal[1].map(|x| -x)) <= AGREE * dot(&of.normal[0], &of.normal[0]).sqrt()
}

/// Where supports are struck out of K, a row lacks entries: what is left of the face lies beside the normal.
fn is_whole(of: &Seen) -> bool {
    let (n, [a, b]) = (&of.normal[0], &of.place);
    let away = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let along = dot(&away, n).powi(2) / dot(n, n);
    let beside = (dot(&away, &away) - along).max(0.0).sqrt();
    cancels(of) || beside <= AGREE * (dot(a, a).sqrt() + dot(b, b).sqrt())
}

/// The rows that differ, if most of them agree.
fn exceptions(seen: &[Seen], agrees: impl Fn(&Seen) -> bool) -> Vec<usize> {
    let other: Vec<usize> = seen.iter().filter(|of| !agrees(of)).map(|of| of.row).collect();
    if 3 * other.len() < seen.len() {
        other
    } else {
        Vec::new()
    }
}

fn tell(found: &mut Vec<Suspicion>, rows: &[usize], what: &str, remedy: &'static str) {
    if !rows.is_empty() {
        found.push(Suspicion::new(listed("contact row", rows), what, remedy));
    }
}

/// The points of all rows lie far apart, compared to the size of the smaller body.
fn apart(all: &Contents, seen: &[Seen], bodies: [usize; 2], found: &mut Vec<Suspicion>) -> bool {
    let sizes = bodies.map(|p| {
        let xyz = all.bodies[p].given.coordinates.map_or(&[][..], |(xyz, _)| xyz);
        let [low, high] =
            xyz.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[mut low, mut high], x| {
                (0..3).for_each(|k| (low[k], high[k]) = (low[k].min(x[k]), high[k].max(x[k])));
                [low, high]
            });
        distance(&low, &high)
    });
    let smaller = usize::from(sizes[1] < sizes[0]);
    let is_far = |of: &Seen| distance(&of.place[0], &of.place[1]) > APART * sizes[smaller];
    if sizes[smaller] > 0.0 && seen.iter().all(is_far) {
        let of = bodies[smaller];
        let what = format!("their contact points lie over {APART} times the size of body {of} apart");
        let place = format!("bodies {} and {}", bodies[0], bodies[1]);
        found.push(Suspicion::new(place, what, "check the units of coordinates: mm against m"));
        return true;
    }
    false
}

/// If both bodies move together, no gap changes.
fn moved(seen: &[Seen], found: &mut Vec<Suspicion>) {
    let rows = exceptions(seen, cancels);
    let what = "if both bodies move together, its gap changes: its entries do not sum to 0 in each direction";
    tell(
        found,
        &rows,
        what,
        "the weights of a face sum to 1, and its unknowns are those of the direction of the normal",
    );
}

/// The gap is the distance of the two places along the normal.
fn gaps(rows: &RowSet, seen: &[Seen], found: &mut Vec<Suspicion>) {
    let fits = |of: &Seen, sign: f64| (rows.rhs[of.row] - sign * of.gap).abs() <= AGREE * of.size;
    let finite = |of: &Seen| rows.rhs[of.row].is_finite();
    let most = seen.iter().filter(|of| finite(of)).map(|of| rows.rhs[of.row].abs()).fold(0.0, f64::max);
    let telling: Vec<&Seen> =
        seen.iter().filter(|of| finite(of) && rows.rhs[of.row].abs() > 1e-3 * most).collect();
    if telling.len() > 2 && telling.iter().all(|of| fits(of, -1.0) && !fits(of, 1.0)) {
        let of: Vec<usize> = seen.iter().map(|of| of.row).collect();
        return tell(
            found,
            &of,
            "its gap has the other sign than the distance along its normal",
            "turn the normal, or the gap: c = n'(x_foot - x_s)",
        );
    }
    let rows = exceptions(seen, |of| !finite(of) || fits(of, 1.0));
    tell(
        found,
        &rows,
        "its gap is not the distance of its points along the normal, as it is in the other rows",
        "check normal and gap: c = n'(x_foot - x_s)",
    );
}

/// A normal has the length of the others if these have the length 1.
fn lengths(seen: &[Seen], found: &mut Vec<Suspicion>) {
    let length = |normal: &[f64; 3]| dot(normal, normal).sqrt();
    // a body that touches itself has no normal in sum
    let is_unit = |of: &Seen| {
        let most = length(&of.normal[0]).max(length(&of.normal[1]));
        (most - 1.0).abs() <= AGREE || most <= AGREE
    };
    tell(
        found,
        &exceptions(seen, is_unit),
        "its normal is no unit vector, as those of the other rows are",
        "divide the normal by its length, or the multiplier is no force",
    );
}

/// A normal that neither of the two next rows has, on a face that is smooth without such rows: there every row has the normal of
/// both next ones.
fn turned(seen: &[Seen], found: &mut Vec<Suspicion>) {
    if seen.len() > MOST {
        return;
    }
    let cosine = |a: &Seen, b: &Seen| {
        let (a, b) = (&a.normal[0], &b.normal[0]);
        dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
    };
    // cosines of a row with the two next rows, and theirs
    let next = |of: &Seen, among: &[&Seen]| {
        let away = |other: &&Seen| distance(&other.place[0], &of.place[0]);
        let mut others: Vec<&Seen> = among.iter().copied().filter(|other| other.row != of.row).collect();
        others.select_nth_unstable_by(1, |a, b| away(a).total_cmp(&away(b)));
        [cosine(of, others[0]), cosine(of, others[1]), cosine(others[0], others[1])]
    };
    let all: Vec<&Seen> = seen.iter().collect();
    let points_elsewhere = |of: &&Seen| {
        let [a, b, both] = next(of, &all);
        both > 0.9 && a.max(b) < 0.3
    };
    let (elsewhere, others): (Vec<&Seen>, Vec<&Seen>) = seen.iter().partition(points_elsewhere);
    let is_smooth = |of: &&Seen| next(of, &others)[..2].iter().all(|cosine| *cosine > 0.9);
    if elsewhere.is_empty() || others.len() < FEW || !others.iter().all(is_smooth) {
        return;
    }
    tell(
        found,
        &elsewhere.iter().map(|of| of.row).collect::<Vec<_>>(),
        "its normal points elsewhere than those of the rows beside it",
        "turn the normal, or check the directions of its unknowns",
    );
}
