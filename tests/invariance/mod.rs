//! What must not change the answer: units, the order of bodies and rows, the number of threads, what was
//! solved before, the form in which a matrix is handed over, the way the dual operators are kept.

mod answer;
mod factors;
mod forms;
mod history;
mod operators;
mod order;
mod units;
