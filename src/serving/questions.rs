//! The questions about bodies of islands, by their names.

use crate::body::{asked, Answering, Bring, Name, Put, Section};
use crate::certificate::{Couple, Fit, Largest, Lend, LoadOf, Measure, SizeOfLoad, Way};
use crate::error::Result;
use crate::ranks::damaged;
use crate::solve::local::*;

/// Takes a question of this kind from a message.
pub fn taken(name: Name, from: &mut &[u8]) -> Result<Box<dyn Answering>> {
    macro_rules! of {
        ($($name:ident)+) => {
            match name {
                $(Name::$name => asked::<$name>(from),)+
                Name::Give | Name::GiveLoad | Name::Enter => Err(damaged()),
                Name::Plan | Name::Follow | Name::Analyse | Name::Factorise => Err(damaged()),
                Name::Boundary | Name::Multiply | Name::Entries | Name::Solve | Name::NullSpace | Name::Join => {
                    Err(damaged())
                }
            }
        };
    }
    of! {
        Put Bring Section Couple Fit Measure Largest SizeOfLoad Way Lend LoadOf
        Scale FromLoad Take Loaded Displace Turn Slide
        Begin Shift Strained Residual Correct Added PointAtRows Displacement Deformation
        Rigid Basis Split Along FreeMotions Place Energy Negate
        Sizes Left Proof Work
    }
}
