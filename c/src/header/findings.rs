//! The findings of a solve, as a struct of the header without padding.
#![allow(non_camel_case_types)]

/// What the last solve, or the last failed setup, found out about the problem. Numbers count from 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_findings {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Status of that solve or setup.
    pub status: i32,
    /// Kind of `row` after a contradiction, FETI_INEQUALITY or FETI_EQUALITY; 0: none.
    pub kind: i32,
    /// Body that escapes or was refused, in the first group of bodies that ended with this status; -1: none.
    pub body: i64,
    /// Connected part that escapes, if the body has several parts; -1: does not apply.
    pub component: i64,
    /// Unknown of the body that moves fastest or was refused; -1: none.
    pub dof: i64,
    /// After FETI_GAPS_CONTRADICT the row with the largest weight, otherwise a row that was refused; -1: none.
    pub row: i64,
    /// Rows of both kinds that contradict each other; feti_diagnosis_rows lists them.
    pub rows_involved: i64,
    /// Number of rigid body motions that neither loads nor rows determine.
    pub undetermined: i64,
    /// Rows of both kinds that repeat the direction of another one.
    pub redundant_rows: i64,
    /// Bodies that no row touches.
    pub untouched_bodies: i64,
    /// The first of these bodies; -1: none.
    pub untouched_body: i64,
    /// Margin by which there is no solution, above 0 and at most 1. After FETI_INDEFINITE with a motion of negative
    /// stiffness: 1 - 1 / rho, where rho is the ratio of the negative stiffness to the stiffness of the closed rows. After
    /// FETI_LOAD_NOT_HELD: the fraction of the resultant load that nothing holds. After FETI_GAPS_CONTRADICT: |w'c| over
    /// |w|'|c| for the weights w. Otherwise NaN.
    pub margin: f64,
    /// Rigid body motion of the escaping body: velocity of the origin and rotation about the axes; NaN without
    /// coordinates. feti_diagnosis_motion gives the motion of every unknown.
    pub motion: [f64; 6],
    /// Largest fraction of the load that nothing holds, over the sets of bodies that move together: |resultant| / |load|
    /// in the metric of diag K. After FETI_LOAD_NOT_HELD it is above 1e-7. With an answer it is rounding of the load;
    /// above 1e-10 the status is FETI_MARGINAL.
    pub unheld: f64,
    /// Bodies with motions that perhaps only the rounding of the entries of K resists; feti_body_info gives the number of
    /// such motions.
    pub doubtful_bodies: i64,
    /// The first of these bodies; -1: none.
    pub doubtful_body: i64,
    /// Bodies with rigid body motions of small positive or negative stiffness, because of weak springs, rounding or
    /// geometric stiffness.
    pub soft_bodies: i64,
    /// The first of these bodies; -1: none.
    pub soft_body: i64,
    /// After FETI_SLIDES the fraction of the load along the motion that friction holds; otherwise NaN. After
    /// FETI_LOAD_NOT_HELD the text of the error has it for nodes with friction.
    pub capacity: f64,
    /// Rank that has given `body` or `row`, if several ranks have given some; -1: does not apply.
    pub rank: i64,
    /// Pair of surfaces to which `row` belongs; -1: none.
    pub pair: i64,
    /// Slave node of this row, in its surface; -1: none.
    pub pair_node: i64,
}
