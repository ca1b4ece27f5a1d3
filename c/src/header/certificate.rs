//! The verdict on an answer.
#![allow(non_camel_case_types)]

/// Verdict on an answer, with one entry for each condition. Each entry is `limit` times the ratio of the violation at the worst body
/// or row to the allowed violation, which includes rounding; an entry passes if it is at most `limit`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_certificate {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// 1: every entry passes.
    pub passed: i32,
    /// Zero.
    pub reserved: i32,
    /// Option certificate_tolerance.
    pub limit: f64,
    /// Largest ratio of an entry to its limit; <= 1 passes.
    pub worst: f64,
    /// Relative error of equilibrium `K u + B'lambda + H'mu + T'lambda_t = f`, for the worst body.
    pub equilibrium: f64,
    /// Relative error of the balance `R'(f - B'lambda - H'mu - T'lambda_t) = 0`, for the worst floating body.
    pub balance: f64,
    /// Relative penetration: positive part of `B u - c - C lambda`, where C = diag(1/k) is the compliance of the rows;
    /// for the worst row.
    pub penetration: f64,
    /// Relative error of `H u = h + C mu`, for the worst row.
    pub equality: f64,
    /// Relative size of a negative contact force, for the worst row.
    pub negative_force: f64,
    /// Relative size of the force or of the open gap `c + C lambda - B u`, whichever is smaller; for the worst row.
    pub complementarity: f64,
    /// Relative gap between primal and dual energy, for the worst group of bodies.
    pub duality_gap: f64,
    /// Body with the worst equilibrium, from 0; -1: none.
    pub equilibrium_body: i64,
    /// Body with the worst balance, from 0; -1: none.
    pub balance_body: i64,
    /// Row with the worst penetration, from 0; -1: none.
    pub penetration_row: i64,
    /// Equality row with the worst error, from 0; -1: none, or the worst error is in the glue of unknowns with the same
    /// number (option glue).
    pub equality_row: i64,
    /// Row with the worst negative force, from 0; -1: none.
    pub force_row: i64,
    /// Row with the worst complementarity, from 0; -1: none.
    pub complementarity_row: i64,
    /// Relative excess of a tangential force over its bound, `(|lambda_t| - b)_+` with b = bound + coefficient lambda_n,
    /// for the worst node with friction.
    pub friction_cone: f64,
    /// Relative size of `b |s| - lambda_t's`, the deficit of frictional work, for the worst node. It is zero only if the
    /// node sticks or slips in the direction of a force that reaches the bound.
    pub friction_work: f64,
    /// Relative size of a slip although the force is within its bound, for the worst node.
    pub friction_stick: f64,
    /// Node with the worst excess over its bound, from 0; -1: none.
    pub friction_cone_node: i64,
    /// Node with the worst deficit of work, from 0; -1: none.
    pub friction_work_node: i64,
    /// Node with the worst slip, from 0; -1: none.
    pub friction_stick_node: i64,
    /// Rank that has given the body with the worst equilibrium, 0 without other ranks; -1: none. So the following.
    pub equilibrium_rank: i64,
    /// Rank of the body with the worst balance.
    pub balance_rank: i64,
    /// Rank of the row with the worst penetration.
    pub penetration_rank: i64,
    /// Rank of the equality row with the worst error.
    pub equality_rank: i64,
    /// Rank of the row with the worst negative force.
    pub force_rank: i64,
    /// Rank of the row with the worst complementarity.
    pub complementarity_rank: i64,
    /// Rank of the node with the worst excess over its bound.
    pub friction_cone_rank: i64,
    /// Rank of the node with the worst deficit of work.
    pub friction_work_rank: i64,
    /// Rank of the node with the worst slip.
    pub friction_stick_rank: i64,
    /// Pair of surfaces to which the row or node with the largest ratio `worst` belongs, from 0; -1: none.
    pub pair: i64,
    /// Slave node of this row, in its surface, from 0; -1: none.
    pub pair_node: i64,
}
