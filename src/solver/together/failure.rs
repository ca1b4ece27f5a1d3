//! Errors as ranks report them to their hosts.

use crate::body::Wire;
use crate::error::{Error, Kind, Place, Result};
use crate::ranks::damaged;

/// An error of any kind.
#[derive(Debug, Clone)]
pub struct Failure(pub Error);

/// Arguments of calls that all ranks make, and of others that only all ranks together can refuse.
const ARGUMENTS: [&str; 25] = [
    "argument", "body", "cap", "count", "dim", "dof", "eqs", "id", "info", "k", "lambda", "lambda_t",
    "motion", "mu", "n", "nodes", "number", "out", "path", "row", "rows", "text", "u", "v", "value",
];

pub fn put_kind(kind: Kind, to: &mut Vec<u8>) {
    let place = match kind {
        Kind::Argument(name) => {
            Kind::ALL.len() + ARGUMENTS.iter().position(|known| *known == name).unwrap_or(0)
        }
        kind => Kind::ALL.iter().position(|known| *known == kind).unwrap_or(0),
    };
    (place as u8).put(to);
}

pub fn take_kind(from: &mut &[u8]) -> Result<Kind> {
    let place = usize::from(u8::take(from)?);
    let argument = |at: usize| ARGUMENTS.get(at).map(|name| Kind::Argument(name));
    let known = Kind::ALL.get(place).copied();
    known.or_else(|| argument(place.checked_sub(Kind::ALL.len())?)).ok_or_else(damaged)
}

/// Its proof belongs to the findings.
impl Wire for Failure {
    fn put(&self, to: &mut Vec<u8>) {
        put_kind(self.0.kind, to);
        self.0.what.put(to);
        self.0.place.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let kind = take_kind(from)?;
        let (what, place) = (String::take(from)?, Box::new(Place::take(from)?));
        Ok(Self(Error { kind, what, place, proof: None }))
    }
}
