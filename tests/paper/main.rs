//! The paper's methods on its three problems.

#[path = "../reference/case.rs"]
mod case;
mod problem_1;
