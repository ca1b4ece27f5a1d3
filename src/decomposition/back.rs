//! Translates the reason why there is no answer, and its place, from the parts to the bodies of the host.

use crate::error::{Error, Kind, Proof};
use crate::mesh::Mesh;
use crate::model::{contradiction, kind_and_row, HostModel, Parts};

/// Converts an error about pieces to one about bodies of the host.
pub fn of_host(host: &HostModel, parts: &Parts, mut error: Error) -> Error {
    if let Some(part) = error.place.body.filter(|part| *part < parts.parts.len()) {
        let body = parts.parts[part].body;
        error.place.body = Some(body);
        if error.kind == Kind::Memory && parts.is_cut(body) {
            // the host knows a piece only by its elements
            let mesh: Option<&Mesh> = host.bodies[body].mesh.as_deref();
            error.place.element = mesh.and_then(|mesh| mesh.first_of(parts.parts[part].piece as usize));
        }
        let unknowns = parts.starts[part + 1] - parts.starts[part];
        let dof = error.place.dof.filter(|dof| *dof < unknowns);
        error.place.dof = dof.map(|dof| parts.place(part, dof).0).or(error.place.dof);
        if let Some(Proof::Motion { .. }) = error.proof.as_deref() {
            error.place.component = error.place.dof.and_then(|_| component(host, parts, part));
        }
    }
    let contact = host.contact.len();
    let rows = contact + parts.equalities;
    let (glued, all) = match error.proof.as_deref() {
        Some(Proof::Rows { weights, .. }) => (glued(parts, rows, weights), weights.len()),
        _ => (Vec::new(), 0),
    };
    error.proof = error.proof.map(|proof| Box::new(proof_of_host(parts, rows, *proof)));
    if let Some(Proof::Rows { heaviest, weights, .. }) = error.proof.as_deref() {
        let (kind, row) = kind_and_row(*heaviest, contact);
        (error.place.row, error.place.kind) = (Some(row), Some(kind as usize));
        // the heaviest row of the host may be another one than that of the parts
        if weights.len() < all || weights.len() > 1 {
            let base = host.settings.index_base;
            let numbers: Vec<i64> = glued.iter().map(|number| *number as i64 + base).collect();
            let mut others: Vec<_> = weights.iter().map(|(i, _)| *i).filter(|i| i != heaviest).collect();
            others.sort_unstable();
            let others: Vec<_> = others.into_iter().map(|i| kind_and_row(i, contact)).collect();
            error.what = contradiction(kind, &others, &|of, row| host.number_of(of, row), &numbers);
            error.place.index = glued.first().map(|number| *number as i64);
        }
    }
    error
}

/// Which connected component of its body a part is, in the order of first unknowns; none if the body is connected or cut. It does not need K,
/// which another rank may have.
fn component(host: &HostModel, parts: &Parts, part: usize) -> Option<usize> {
    let body = parts.parts[part].body;
    let (all, range, first) = (parts.of(body), host.range(body), parts.place(part, 0).0);
    let loose = || parts.loose.iter().filter(|j| range.contains(j));
    let before = loose().filter(|j| **j - range.start < first).count();
    (!parts.is_cut(body) && all.len() + loose().count() > 1).then(|| part - all.start + before)
}

/// The numbers whose joints occur in a combination of rows, each once, the one with the largest weight first.
fn glued(parts: &Parts, rows: usize, weights: &[(usize, f64)]) -> Vec<usize> {
    let of_joint = |(row, weight): &(usize, f64)| {
        let number = row.checked_sub(rows).and_then(|k| parts.joints.get(k));
        number.map(|number| (*number, weight.abs()))
    };
    let mut found: Vec<(usize, f64)> = weights.iter().filter_map(of_joint).collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut numbers = Vec::new();
    for (number, _) in found {
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    numbers
}

/// A motion is equal at all copies. The glue of pieces is dropped from a combination of rows: summed over the copies it
/// is 0 on each body. Joints have no number of the host: their weights follow from those of the other rows.
fn proof_of_host(parts: &Parts, rows: usize, proof: Proof) -> Proof {
    match proof {
        Proof::Motion { margin, v } => match parts.mean(&v) {
            Ok(of_host) => Proof::Motion { margin, v: of_host },
            Err(_) => Proof::Motion { margin, v: Vec::new() },
        },
        Proof::Rows { margin, mut weights, heaviest } => {
            weights.retain(|(row, _)| *row < rows);
            // of equal weights the last, as in the proof
            let most = weights.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let (heaviest, largest) = most.filter(|most| most.1 != 0.0).unwrap_or((heaviest, 1.0));
            weights.iter_mut().for_each(|(_, weight)| *weight /= largest.abs());
            Proof::Rows { margin, weights, heaviest }
        }
    }
}
