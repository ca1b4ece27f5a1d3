//! The paper: its problems by its methods, its theorems, its formulas against dense linear algebra, its numbers in
//! the sources.

mod cases;
mod decomposition;
mod eigenvalues;
mod equations;
mod failures;
mod numbers;
mod problem_1;
#[allow(dead_code)]
#[path = "../../benches/paper/problems.rs"]
mod problems;
#[allow(dead_code)]
#[path = "../../benches/paper/run.rs"]
mod run;
mod table;
mod theorem_2;
mod theorem_4;

use crate::reference::case;
