//! The paper: its problems by its methods, its theorems, its formulas against dense linear algebra, its numbers in
//! the sources.

#[allow(dead_code)]
#[path = "../reference/case.rs"]
mod case;
mod cases;
mod decomposition;
#[allow(dead_code)]
#[path = "../qp/dense.rs"]
mod dense;
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
