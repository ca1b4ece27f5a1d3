//! Certificate (S9, S14).

/// Stiffness of rows at an unknown relative to its own, from which they carry it: with less, an error of 1e-6 in a force moves
/// a gap by 1e-8 of what it yields.
pub const CARRIED: f64 = 1e2;
/// Weight of the deformation of neighbours in the length of a row. Found with `tests/liars`.
pub const NEIGHBOURS: f64 = 0.5;
/// Largest residual that rounding excuses in the equilibrium of a body, relative to the forces of its island: where strains are
/// lost the answer is not known. Found with `tests/liars`.
pub const EXCUSED: f64 = 1e-2;
/// Slip relative to its tolerance that stands for any larger one, against overflow.
pub const OVERFLOW: f64 = 1e100;
/// Shifts of A'A relative to its largest entry, one after the other: joints resist motions by more than the root of the last.
pub const RESISTED: [f64; 5] = [0.3, 1e-3, 1e-6, 1e-9, 1e-13];
