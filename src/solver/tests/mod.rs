//! Tests of whole problems, where they need to see inside.

mod body_facts;
mod file;
mod log;
mod numbering;
mod outcome;
mod response;
mod results;
mod room;
mod rows;
mod sharing;
mod states;
mod watch;
