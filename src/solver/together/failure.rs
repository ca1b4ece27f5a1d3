//! Errors as ranks report them to their hosts.

use crate::body::Wire;
use crate::error::{Error, Kind, Place, Result};
use crate::ranks::damaged;

/// An error of any kind.
#[derive(Debug, Clone)]
pub struct Failure(pub Error);

const KINDS: [Kind; 20] = [
    Kind::Memory,
    Kind::State,
    Kind::LoadNotHeld,
    Kind::Slides,
    Kind::GapsContradict,
    Kind::NullSpace,
    Kind::Indefinite,
    Kind::Overflow,
    Kind::Internal,
    Kind::Unsupported,
    Kind::Cancelled,
    Kind::TimeOver,
    Kind::Callback,
    Kind::Io,
    Kind::Communication,
    // arguments that only all ranks together can refuse
    Kind::Argument("dof"),
    Kind::Argument("number"),
    Kind::Argument("dim"),
    Kind::Argument("value"),
    Kind::Argument("text"),
];

pub fn put_kind(kind: Kind, to: &mut Vec<u8>) {
    let known = KINDS.iter().position(|of| *of == kind);
    let internal = KINDS.iter().position(|of| *of == Kind::Internal);
    (known.or(internal).unwrap_or(0) as u8).put(to);
}

pub fn take_kind(from: &mut &[u8]) -> Result<Kind> {
    KINDS.get(usize::from(u8::take(from)?)).copied().ok_or_else(damaged)
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
