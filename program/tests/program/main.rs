//! The program as a user runs it.

mod alarms;
mod commands;
#[allow(dead_code)]
#[path = "../../../tests/support/hand_over.rs"]
mod hand_over;
mod healthy;
mod page;
mod show;
mod support;
