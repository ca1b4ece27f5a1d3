//! From the pieces back to the bodies of the host: why there is no answer, and where.

use crate::error::{Error, Proof};
use crate::model::Parts;

/// An error about pieces as one about bodies of the host with `contact` contact rows.
pub fn of_host(parts: &Parts, contact: usize, mut error: Error) -> Error {
    if let Some(part) = error.place.body.filter(|part| *part < parts.parts.len()) {
        error.place.body = Some(parts.parts[part].body);
        let unknowns = parts.starts[part + 1] - parts.starts[part];
        let dof = error.place.dof.filter(|dof| *dof < unknowns);
        error.place.dof = dof.map(|dof| parts.place(part, dof).0).or(error.place.dof);
    }
    let rows = contact + parts.equalities;
    error.proof = error.proof.map(|proof| Box::new(proof_of_host(parts, rows, *proof)));
    if let Some(Proof::Rows { heaviest, .. }) = error.proof.as_deref() {
        error.place.row = Some(heaviest.checked_sub(contact).unwrap_or(*heaviest));
    }
    error
}

/// A motion of the pieces moves all copies alike; glue adds nothing to a combination of rows that is 0, for it is 0 on a body.
fn proof_of_host(parts: &Parts, rows: usize, proof: Proof) -> Proof {
    match proof {
        Proof::Motion { margin, v } => match parts.mean(&v) {
            Ok(of_host) => Proof::Motion { margin, v: of_host },
            Err(_) => Proof::Motion { margin, v: Vec::new() },
        },
        Proof::Rows { margin, mut weights, heaviest } => {
            weights.retain(|(row, _)| *row < rows);
            let weight = |at: &(usize, f64)| at.1.abs();
            let first = weights.first().map_or(heaviest, |at| at.0);
            let most = weights.iter().fold((first, 0.0), |best, at| {
                if weight(at) > best.1 {
                    (at.0, weight(at))
                } else {
                    best
                }
            });
            let largest = if most.1 > 0.0 { most.1 } else { 1.0 };
            weights.iter_mut().for_each(|(_, weight)| *weight /= largest);
            Proof::Rows { margin, weights, heaviest: most.0 }
        }
    }
}
