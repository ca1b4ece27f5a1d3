//! The input of the host: bodies, rows, options, also read from a file. It is checked here; nothing is computed.

mod accuracy;
mod bodies;
mod contents;
pub mod file;
mod host;
mod joints;
mod matrices;
mod meshes;
mod numbering;
mod pairing;
mod pairs;
mod parts;
mod pieces;
mod row_sets;
mod settings;
mod settings_text;
mod tables;
mod words;

pub use accuracy::{Accuracy, Lengths};
pub use contents::{BodyRevisions, Counted, GivenBody, GivenBy, Revisions, Sizes, SolvedModel};
pub use host::HostModel;
pub use numbering::NAMED;
pub use pairs::{Geometry, Met, Pair, PairMethod, PairRows, Pairs, SurfaceSizes, Tied};
pub use parts::{Joint, Part, Parts};
pub use row_sets::{contradiction, kind_and_row, proof_of_rows, PER_ENTRY};
pub use settings::{options, OptionInfo, OptionValue, Settings};
pub use words::{
    FinishBy, LogTo, Method, OperatorForm, PaperStep1, PaperUnits, Preconditioning, StartFrom, Word,
};
