//! Nodes with friction: a contact row, tangential rows, a law, and where a load step begins.

use crate::error::{Error, Result};
use crate::ffi::boundary::{
    base, call, count, enter, id, input, input_or_none, numbers, pointers, same, Call, Index, Output,
};
use crate::ffi::header::types::feti_problem;
use crate::solver::{FrictionInput, Problem, RowsInput};

/// Adds nodes with friction, with 32-bit indices.
///
/// A node has a normal row b_n, which is a contact row that is there (feti_rows_add_i32, feti_rows_add_i64), and dim tangential
/// rows T, dim = 1 in the plane and 2 in space. Its tangential force lambda_t acts on the bodies as -T'lambda_t, its slip is
/// `s = T u - s_old - C_t lambda_t`: the motion of the body with positive entries against the other one. |lambda_t| <= b with
/// b = bound + coefficient lambda_n; the node sticks, s = 0, or slips along the force, `lambda_t = b s / |s|`: slip and force have one sign.
/// Coefficient 0 is friction of Tresca, bound 0 of Coulomb; `bound` acts at open nodes too.
///
/// Contact row and tangential rows of a node are to be multiplied by one factor (that of an area, of a unit): lengths that differ by
/// more than 1e3 are refused. Tangential rows may be oblique, and may have no entries. `normal_row` is the number of a contact row,
/// never of an equality row, and of one node alone. A pair of body and unknown that comes twice in a row is summed. s_old and
/// C_t are zero (feti_friction_reference, feti_friction_compliance). The data are copied, the nodes numbered behind those that are
/// there; all nodes have the same dim. Factors of the bodies stay, the last answer does not. FETI_STATE where `body` is NULL
/// and some bodies have numbers of the host, others have none. After a failure nothing is added.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `nodes` | in | scalar | number of nodes, 0 adds none |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2 |
/// | `normal_row` | in | nodes | contact row of each node, counted from `base`; `base` - 1: none, the bound acts alone |
/// | `row_ptr` | in | dim * nodes + 1 | tangential row i, dim of them for each node, holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
/// | `body` | in | `row_ptr[dim * nodes] - base` | body of each entry, counted from `base`; NULL: `dof` is the host's number of the unknown (feti_body_numbering_i32), without numbers it counts through all bodies |
/// | `dof` | in | `row_ptr[dim * nodes] - base` | unknown of each entry, counted from `base` |
/// | `val` | in | `row_ptr[dim * nodes] - base` | entries of T |
/// | `base` | in | scalar | 0 or 1: what `normal_row`, `row_ptr`, `body` and `dof` count from |
/// | `coefficient` | in | nodes | coefficient of friction, >= 0, no unit; 0 without a contact row; NULL: zeros |
/// | `bound` | in | nodes | bound without contact force, >= 0, force; NULL: zeros |
/// | `first` | out | scalar | number of the first node added, from 0; may be NULL |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_add_i32(
    p: *mut feti_problem,
    nodes: i64,
    dim: i32,
    normal_row: *const i32,
    row_ptr: *const i32,
    body: *const i32,
    dof: *const i32,
    val: *const f64,
    base: i32,
    coefficient: *const f64,
    bound: *const f64,
    first: *mut i64,
) -> i32 {
    let call = call!(feti_friction_add_i32(
        p,
        nodes,
        dim,
        normal_row,
        row_ptr,
        body,
        dof,
        val,
        base,
        coefficient,
        bound,
        first
    ));
    let given =
        HostNodes { nodes, dim, normal_row, row_ptr, body, dof, val, base, coefficient, bound, first };
    // SAFETY: shapes by the caller's word.
    unsafe { given.add(p, call) }
}

/// Adds nodes with friction, with 64-bit indices.
///
/// A node has a normal row b_n, which is a contact row that is there (feti_rows_add_i32, feti_rows_add_i64), and dim tangential
/// rows T, dim = 1 in the plane and 2 in space. Its tangential force lambda_t acts on the bodies as -T'lambda_t, its slip is
/// `s = T u - s_old - C_t lambda_t`: the motion of the body with positive entries against the other one. |lambda_t| <= b with
/// b = bound + coefficient lambda_n; the node sticks, s = 0, or slips along the force, `lambda_t = b s / |s|`: slip and force have one sign.
/// Coefficient 0 is friction of Tresca, bound 0 of Coulomb; `bound` acts at open nodes too.
///
/// Contact row and tangential rows of a node are to be multiplied by one factor (that of an area, of a unit): lengths that differ by
/// more than 1e3 are refused. Tangential rows may be oblique, and may have no entries. `normal_row` is the number of a contact row,
/// never of an equality row, and of one node alone. A pair of body and unknown that comes twice in a row is summed. s_old and
/// C_t are zero (feti_friction_reference, feti_friction_compliance). The data are copied, the nodes numbered behind those that are
/// there; all nodes have the same dim. Factors of the bodies stay, the last answer does not. FETI_STATE where `body` is NULL
/// and some bodies have numbers of the host, others have none. After a failure nothing is added.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `nodes` | in | scalar | number of nodes, 0 adds none |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2 |
/// | `normal_row` | in | nodes | contact row of each node, counted from `base`; `base` - 1: none, the bound acts alone |
/// | `row_ptr` | in | dim * nodes + 1 | tangential row i, dim of them for each node, holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
/// | `body` | in | `row_ptr[dim * nodes] - base` | body of each entry, counted from `base`; NULL: `dof` is the host's number of the unknown (feti_body_numbering_i32), without numbers it counts through all bodies |
/// | `dof` | in | `row_ptr[dim * nodes] - base` | unknown of each entry, counted from `base` |
/// | `val` | in | `row_ptr[dim * nodes] - base` | entries of T |
/// | `base` | in | scalar | 0 or 1: what `normal_row`, `row_ptr`, `body` and `dof` count from |
/// | `coefficient` | in | nodes | coefficient of friction, >= 0, no unit; 0 without a contact row; NULL: zeros |
/// | `bound` | in | nodes | bound without contact force, >= 0, force; NULL: zeros |
/// | `first` | out | scalar | number of the first node added, from 0; may be NULL |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_add_i64(
    p: *mut feti_problem,
    nodes: i64,
    dim: i32,
    normal_row: *const i64,
    row_ptr: *const i64,
    body: *const i64,
    dof: *const i64,
    val: *const f64,
    base: i32,
    coefficient: *const f64,
    bound: *const f64,
    first: *mut i64,
) -> i32 {
    let call = call!(feti_friction_add_i64(
        p,
        nodes,
        dim,
        normal_row,
        row_ptr,
        body,
        dof,
        val,
        base,
        coefficient,
        bound,
        first
    ));
    let given =
        HostNodes { nodes, dim, normal_row, row_ptr, body, dof, val, base, coefficient, bound, first };
    // SAFETY: shapes by the caller's word.
    unsafe { given.add(p, call) }
}

/// Nodes as the host gives them.
struct HostNodes<I> {
    nodes: i64,
    dim: i32,
    normal_row: *const I,
    row_ptr: *const I,
    body: *const I,
    dof: *const I,
    val: *const f64,
    base: i32,
    coefficient: *const f64,
    bound: *const f64,
    first: *mut i64,
}

impl<I: Index> HostNodes<I> {
    /// # Safety
    /// The arrays have the shapes that the documentation of feti_friction_add gives.
    unsafe fn add(self, p: *mut feti_problem, call: Call) -> i32 {
        enter(p, call, |problem| {
            let (nodes, dim) = (count(self.nodes, "nodes")?, dimension(self.dim)?);
            let rows = tangential_rows(nodes, dim)?;
            let base = base(self.base)?;
            // SAFETY: NULL or room for one number by the caller's word.
            let first = unsafe { Output::optional(self.first, 1, "first") }?;
            // SAFETY: one number per node by the caller's word.
            let normal = unsafe { numbers(self.normal_row, nodes, base, "normal_row") }?;
            // SAFETY: rows + 1 positions by the caller's word.
            let ptr = unsafe { pointers(self.row_ptr, rows, base) }.map_err(|error| at_node(error, dim))?;
            let entries = ptr.last().copied().unwrap_or(0);
            let _room = problem.headroom_for_rows(rows, entries)?;
            let given = (!self.body.is_null()).then_some(self.body);
            // SAFETY: the last position is the number of entries.
            let body = given.map(|body| unsafe { numbers(body, entries, base, "body") }).transpose()?;
            // SAFETY: the last position is the number of entries.
            let (dof, val) =
                unsafe { (numbers(self.dof, entries, base, "dof")?, input(self.val, entries, "val")?) };
            // SAFETY: NULL or one number per node by the caller's word.
            let (coefficient, bound) = unsafe {
                (
                    input_or_none(self.coefficient, nodes, "coefficient")?,
                    input_or_none(self.bound, nodes, "bound")?,
                )
            };
            let rows = RowsInput { ptr: &ptr, body: body.as_deref(), dof: &dof, val, rhs: None };
            let given = FrictionInput { dim, normal: &normal, rows, coefficient, bound };
            first.set(problem.add_friction(given).map_err(|error| error.index_from(base))? as i64);
            Ok(())
        })
    }
}

/// Replaces the law of nodes: coefficients, bounds, or both.
///
/// What is NULL stays as it is. The numbers are copied; factors of the bodies and the last answer stay, but for a node that may carry
/// no force before and some after, or the reverse: that drops the answer. After a failure all laws are as they were.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `first` | in | scalar | first node to change, from 0 |
/// | `nodes` | in | scalar | number of nodes to change |
/// | `coefficient` | in | nodes | coefficient of friction, >= 0, no unit; 0 without a contact row; NULL: it stays |
/// | `bound` | in | nodes | bound without contact force, >= 0, force; NULL: it stays |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_law(
    p: *mut feti_problem,
    first: i64,
    nodes: i64,
    coefficient: *const f64,
    bound: *const f64,
) -> i32 {
    enter(p, call!(feti_friction_law(p, first, nodes, coefficient, bound)), |problem| {
        let (first, nodes) = (id(first, "first")?, count(nodes, "nodes")?);
        // SAFETY: NULL or one number per node by the caller's word.
        let (coefficient, bound) = unsafe {
            (input_or_none(coefficient, nodes, "coefficient")?, input_or_none(bound, nodes, "bound")?)
        };
        problem.set_friction_law(first, nodes, coefficient, bound)
    })
}

/// Makes the stick of nodes elastic, `s = T u - s_old - C_t lambda_t` with C_t = 1/k_t.
///
/// A node that sticks then gives way by C_t lambda_t. Nodes that are added are rigid, C_t = 0; a node whose rows are multiplied by t
/// has a compliance times t^2. The numbers are copied and stay until they are replaced or the nodes are cleared; factors of the bodies
/// stay, the last answer does not. After a failure all compliances are as they were.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `first` | in | scalar | first node to change, from 0 |
/// | `nodes` | in | scalar | number of nodes to change |
/// | `inv_kt` | in | nodes | 1/k_t >= 0, length / force, for all tangential rows of the node; 0: rigid |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_compliance(
    p: *mut feti_problem,
    first: i64,
    nodes: i64,
    inv_kt: *const f64,
) -> i32 {
    enter(p, call!(feti_friction_compliance(p, first, nodes, inv_kt)), |problem| {
        let (first, nodes) = (id(first, "first")?, count(nodes, "nodes")?);
        // SAFETY: one number per node by the caller's word.
        problem.set_friction_compliance(first, unsafe { input(inv_kt, nodes, "inv_kt") }?)
    })
}

/// Gives s_old, what the slips of nodes are counted from: T u - C_t lambda_t at the beginning of the load step.
///
/// Nodes that are added have zeros; feti_friction_commit takes s_old from the answer. A host that solves for the increment of a Newton
/// iteration gives T (u_begin - u_k). The numbers are copied; factors of the bodies and the last answer stay, with the slips
/// it had. After a failure all of them are as they were.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `first` | in | scalar | first node to change, from 0 |
/// | `nodes` | in | scalar | number of nodes to change |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2; not looked at without nodes |
/// | `s_old` | in | dim * nodes | node after node, length; 0 for rows without entries |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_reference(
    p: *mut feti_problem,
    first: i64,
    nodes: i64,
    dim: i32,
    s_old: *const f64,
) -> i32 {
    enter(p, call!(feti_friction_reference(p, first, nodes, dim, s_old)), |problem| {
        let (first, nodes) = (id(first, "first")?, count(nodes, "nodes")?);
        let dim = if nodes == 0 { 0 } else { dimension(dim)? };
        // the nodes come first: no array is read for such as are not there
        problem.check_friction_nodes(first, nodes, dim)?;
        // SAFETY: dim numbers for each node by the caller's word.
        let s_old = unsafe { input(s_old, tangential_rows(nodes, dim)?, "s_old") }?;
        problem.set_friction_reference(first, nodes, dim, s_old)
    })
}

/// Ends a load step: s_old becomes what the last answer has reached, `T u - C_t lambda_t`, at every node, open ones too.
///
/// To be called once a step is accepted, before or after the loads of the next one are given. The answer stays as it was, with
/// the slips of its step; so does where the next solve starts. A second call does what the first did. To take a step back, save the
/// state before it (feti_state_save). FETI_STATE before a solve has given an answer, where a group of bodies has none, and where
/// the answer is not certified (a status of feti_solve other than FETI_OK and FETI_MARGINAL). After a failure s_old is as it was.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_friction_commit(p: *mut feti_problem) -> i32 {
    enter(p, call!(feti_friction_commit(p)), |problem| problem.commit_friction())
}

/// Removes all nodes with friction; their contact rows stay.
///
/// Numbering starts again at 0, and the next nodes may have another dim. feti_rows_clear with FETI_INEQUALITY removes them too.
/// Factors of the bodies stay, the last answer does not.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_friction_clear(p: *mut feti_problem) -> i32 {
    enter(p, call!(feti_friction_clear(p)), |problem| {
        problem.clear_friction();
        Ok(())
    })
}

pub(super) const NODES: &str = "the number of nodes with friction is";

/// Tangential rows of a node.
fn dimension(dim: i32) -> Result<usize> {
    usize::try_from(dim).ok().filter(|dim| (1..=2).contains(dim)).ok_or_else(|| {
        let what = format!("{dim} is neither 1 nor 2, the tangential rows of a node");
        Error::argument("dim", what).value(f64::from(dim))
    })
}

/// `dim` rows for each node; an array can have as many entries.
fn tangential_rows(nodes: usize, dim: usize) -> Result<usize> {
    count((nodes as i64).saturating_mul(dim as i64), "nodes")
}

/// Tangential rows of all nodes, whose number and dim must be those given.
pub(super) fn all_nodes(problem: &Problem, nodes: i64, dim: i32) -> Result<usize> {
    let nodes = same(nodes, problem.sizes().nodes, "nodes", NODES)?;
    let dim = if nodes == 0 { 0 } else { dimension(dim)? };
    problem.check_friction_nodes(0, nodes, dim)?;
    tangential_rows(nodes, dim)
}

/// An error about a tangential row, with its node.
fn at_node(error: Error, dim: usize) -> Error {
    match error.place.row {
        Some(row) => error.node(row / dim),
        None => error,
    }
}
