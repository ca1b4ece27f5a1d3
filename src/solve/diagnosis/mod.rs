//! Why there is no answer: a load that nothing holds, or rows that contradict each other. It receives a candidate for the proof and
//! tests it on the data of the host. Without a proof it makes no statement, and the next method follows.
//!
//! | module | claim and its proof |
//! |---|---|
//! | `loads` | no forces of the rows hold the load: a rigid motion |
//! | `gaps` | no displacement satisfies the rows: weights of rows |

mod gaps;
mod loads;

pub use gaps::Contradictions;
pub use loads::{resistance, Unheld};
