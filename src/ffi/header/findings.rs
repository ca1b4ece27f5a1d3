//! What a solve has found out, as a struct of the header without padding.
#![allow(non_camel_case_types)]

/// What the last solve, or the last setup that failed, has found out about the problem. Numbers count from 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_findings {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Status it ended with.
    pub status: i32,
    /// FETI_INEQUALITY or FETI_EQUALITY: kind of the contradicting rows' `row`; 0: none.
    pub kind: i32,
    /// Body that escapes or was refused; of several groups of bodies the first of the one that ended with this status; -1: none.
    pub body: i64,
    /// Connected part of the body that escapes, where it has several, -1: does not apply.
    pub component: i64,
    /// Unknown of the body that moves fastest or was refused, -1: none.
    pub dof: i64,
    /// After FETI_GAPS_CONTRADICT the row with the largest weight, else a row that was refused, -1: none.
    pub row: i64,
    /// Rows of both kinds that contradict each other; feti_diagnosis_rows lists them.
    pub rows_involved: i64,
    /// Rigid motions that neither loads nor rows determine.
    pub undetermined: i64,
    /// Rows of both kinds that repeat the direction of another one.
    pub redundant_rows: i64,
    /// Bodies that no row touches.
    pub untouched_bodies: i64,
    /// The first of them, -1: none.
    pub untouched_body: i64,
    /// How clearly there is no solution, above 0 and at most 1: after FETI_INDEFINITE of a driven motion 1 - 1 / rho, rho what drives
    /// it over what resists it; after FETI_LOAD_NOT_HELD the share of the resultant of
    /// the load that nothing holds, after FETI_GAPS_CONTRADICT |w'c| over |w|'|c| for the weights w; else NaN.
    pub margin: f64,
    /// Rigid motion of the body that escapes: velocity of the origin and rotation about the axes; NaN without
    /// coordinates. feti_diagnosis_motion has it for every unknown.
    pub motion: [f64; 6],
    /// The largest share of the load of bodies that move together which nothing holds, |resultant| / |load| in the metric of diag K:
    /// above 1e-7 after FETI_LOAD_NOT_HELD; with an answer rounding of the load, FETI_MARGINAL above 1e-10.
    pub unheld: f64,
    /// Bodies with motions that only the rounding of the entries of K may resist; feti_body_info has their numbers.
    pub doubtful_bodies: i64,
    /// The first of them, -1: none.
    pub doubtful_body: i64,
    /// Bodies with rigid motions that K resists or drives softly: weak springs, rounding, geometric stiffness.
    pub soft_bodies: i64,
    /// The first of them, -1: none.
    pub soft_body: i64,
    /// After FETI_SLIDES what friction holds of the load along the motion, as a part of it; else NaN.
    pub capacity: f64,
}
