//! Tests of whole problems that need access to internals.

mod body_facts;
mod clock;
mod file;
mod friction;
mod glue;
mod headroom;
mod lent;
mod log;
mod log_file;
mod numbering;
mod outcome;
mod pairs;
mod response;
mod results;
mod rows;
mod sharing;
mod states;
mod together;
mod watch;
