//! The problem of a host: its input, what is computed from it, its results.

mod body_facts;
mod call;
mod check;
mod decomposed;
mod findings;
mod friction;
mod given;
mod history;
mod input;
mod joined;
mod joints;
mod known;
mod made;
mod noticed;
mod pairs;
mod problem;
mod products;
mod results;
mod states;
#[cfg(test)]
mod tests;
mod together;
mod told;
mod undetermined;

pub use crate::body::{
    Columns, Digits, Direction, Doubt, HostFunctions, HostProduct, Modes, SkylineInput, SparseInput, Storage,
    TripletInput,
};
pub use crate::certificate::{Certificate, Entry, FrictionState};
pub use crate::constraints::{DofTableInput, Friction, FrictionInput, RowKind, RowSet, RowsInput};
pub use crate::error::Proof;
pub use crate::linalg::{Borrowed, Csr, Symmetric};
pub use crate::mesh::ElementStorage;
pub use crate::model::{
    options, Method, OptionInfo, OptionValue, PairMethod, PaperStep1, PaperUnits, Settings, Sizes,
    SurfaceSizes,
};
pub use crate::progress::{Listener, LogLevel, LogListener, PhaseReport, Progress, Reply};
pub use crate::qp::StepKind;
pub use crate::ranks::{Link, Ranks, Traffic};
pub use crate::serving::{serve, Rank};
pub use crate::solve::{DualMethod, HostForm, Outcome, Report, RowState};
pub use crate::surface::{RigidShape, Shape};
pub use body_facts::{BodyFacts, Factors, Origin};
pub use call::Call;
pub use check::Candidate;
pub use findings::Findings;
pub use given::Given;
pub use pairs::{PairFacts, PairField};
pub use problem::Problem;
