//! The numeric factorisation.

pub mod front;
pub mod multifrontal;
pub mod updates;

use crate::platform::pages::Number;

/// The type of the entries of L, in which they are also computed.
pub trait Entry: Number + Into<f64> + faer::traits::RealField {
    /// A number of this type.
    fn of(value: f64) -> Self;
}

impl Entry for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl Entry for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
}
