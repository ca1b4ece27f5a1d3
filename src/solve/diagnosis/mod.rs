//! The one place that says why there is no answer: a load that nothing holds, rows that contradict each other. It takes a
//! candidate for the proof from whoever found it and tries it on the data of the host. What is not proved is not said: the
//! next method follows.
//!
//! | module | claims |
//! |---|---|
//! | `loads` | no forces of the rows hold the load: a rigid motion |
//! | `gaps` | no displacement satisfies the rows: weights of rows |

mod gaps;
mod loads;

pub use gaps::Contradictions;
pub use loads::{Unheld, MARGINAL, ROUNDING};
