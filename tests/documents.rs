//! Sources and licences, read as text: nothing is solved. docs/tests.md.

mod layering;
mod licences;
mod numbers;
