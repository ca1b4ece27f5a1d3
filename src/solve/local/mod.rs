//! What the solve asks about a body: from loads to displacements, corrections of both, motions of R, and sizes.

mod corrected;
mod displaced;
mod motions;
mod sizes;

pub use corrected::{
    Added, Begin, Correct, Deformation, Displacement, Point, PointAtRows, Residual, Shift, Strained,
};
pub use displaced::{Displace, FromLoad, Loaded, OfLoad, Scale, Slide, Turn};
pub use motions::{Along, Basis, Energy, FreeMotions, FreeMotionsAtRows, Negate, Place, Rigid, Split};
pub use sizes::{Left, Proof, Sizes, SizesLeft, SizesOfForces, Take, Unheld, Work};
