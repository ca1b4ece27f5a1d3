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
mod theorem_2;
mod theorem_4;
