//! Nodes with friction: a contact row, tangential rows, a law, and the reference slip of a load step.

use crate::boundary::{
    base_of, call, count, enter, id, input, input_or_none, numbers, pointers, same, twins, Output,
};
use crate::header::types::feti_problem;
use feti_contact::error::{Error, Result};
use feti_contact::solver::{FrictionInput, Problem, RowsInput};

twins! {
    /// Adds nodes with friction, with 32-bit indices.
    ///
    /// A node has a normal row b_n, which is an existing contact row (feti_rows_add_i32, feti_rows_add_i64), and dim
    /// tangential rows T, with dim = 1 in the plane and 2 in space. Its tangential force lambda_t acts on the bodies as
    /// -T'lambda_t. Its slip is `s = T u - s_old - C_t lambda_t`: the motion of the body with positive entries relative to
    /// the other body. The force is bounded by |lambda_t| <= b with b = bound + coefficient lambda_n. The node either sticks,
    /// s = 0, or slips in the direction of the force, `lambda_t = b s / |s|`, so that slip and force have the same sign.
    /// Coefficient 0 gives Tresca friction, bound 0 gives Coulomb friction; `bound` also acts at open nodes.
    ///
    /// If you scale the rows of a node (by an area or a unit), scale its contact row and its tangential rows by the
    /// same factor: lengths that differ by more than a factor of 1e3 are refused, unless struck-out supports may have
    /// shortened a row. Tangential rows may be oblique, and may have no entries. `normal_row` is the number of a
    /// contact row, never of an equality row, and each contact row belongs to at most one node. If a pair of body and
    /// unknown occurs twice in a row, the entries are summed. s_old and C_t start at zero (see feti_friction_reference
    /// and feti_friction_compliance). The nodes are numbered after the existing nodes; all nodes have the same dim. The
    /// factors of the bodies stay valid; the last answer is dropped. FETI_STATE if `body` is NULL and some bodies have
    /// numbers of the host while others have none.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `nodes` | in | scalar | number of nodes, 0 adds none |
    /// | `dim` | in | scalar | tangential rows of a node, 1 or 2 |
    /// | `normal_row` | in | nodes | contact row of each node, counted from `base`; `base` - 1: no contact row, only the bound acts |
    /// | `row_ptr` | in | dim * nodes + 1 | tangential row i (dim rows per node) holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
    /// | `body` | in | `row_ptr[dim * nodes] - base` | body of each entry, counted from `base`; NULL: `dof` is an unknown of the table (feti_dof_table_i32) or, without a table, the host's number of the unknown (feti_body_numbering_i32) or, without such numbers, counts the unknowns of all bodies consecutively |
    /// | `dof` | in | `row_ptr[dim * nodes] - base` | unknown of each entry, counted from `base` |
    /// | `val` | in | `row_ptr[dim * nodes] - base` | entries of T |
    /// | `base` | in | scalar | 0 or 1: what `normal_row`, `row_ptr`, `body` and `dof` count from |
    /// | `coefficient` | in | nodes | coefficient of friction, >= 0, no unit; must be 0 without a contact row; NULL: zeros |
    /// | `bound` | in | nodes | part of the bound that does not depend on the contact force, >= 0, force; NULL: zeros |
    /// | `first` | out | scalar | number of the first node added, from 0; may be NULL |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_friction_add_i32, feti_friction_add_i64(
        p: *mut feti_problem, nodes: i64, dim: i32, normal_row: *const I, row_ptr: *const I, body: *const I,
        dof: *const I, val: *const f64, base: i32, coefficient: *const f64, bound: *const f64, first: *mut i64,
    ) |call| {
        enter(p, call, |problem| {
            let (nodes, dim) = (count(nodes, "nodes")?, dimension(dim)?);
            let rows = tangential_rows(nodes, dim)?;
            let base = base_of(base)?;
            // SAFETY: NULL or room for one number guaranteed by the caller.
            let first = unsafe { Output::optional(first, 1, "first") }?;
            // SAFETY: one number per node guaranteed by the caller.
            let normal = unsafe { numbers(normal_row, nodes, base, "normal_row") }?;
            // SAFETY: rows + 1 positions guaranteed by the caller.
            let ptr = unsafe { pointers(row_ptr, rows, base) }.map_err(|error| at_node(error, dim))?;
            let entries = ptr.last().copied().unwrap_or(0);
            let _room = problem.headroom_for_rows(rows, entries)?;
            let given = (!body.is_null()).then_some(body);
            // SAFETY: the last position is the number of entries.
            let body = given.map(|body| unsafe { numbers(body, entries, base, "body") }).transpose()?;
            // SAFETY: the last position is the number of entries.
            let (dof, val) =
                unsafe { (numbers(dof, entries, base, "dof")?, input(val, entries, "val")?) };
            // SAFETY: NULL or one number per node guaranteed by the caller.
            let (coefficient, bound) = unsafe {
                (
                    input_or_none(coefficient, nodes, "coefficient")?,
                    input_or_none(bound, nodes, "bound")?,
                )
            };
            let rows = RowsInput { ptr: &ptr, body: body.as_deref(), dof: &dof, val, rhs: None };
            let given = FrictionInput { dim, normal: &normal, rows, coefficient, bound };
            first.set(problem.add_friction(given).map_err(|error| error.index_from(base))? as i64);
            Ok(())
        })
    }
}

/// Replaces the friction law of nodes: coefficients, bounds, or both.
///
/// An argument that is NULL leaves its values unchanged. The factors of the bodies and the last answer stay valid, with
/// one exception: the answer is dropped if a node could not carry a tangential force before the call and can after it,
/// or the reverse.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `first` | in | scalar | first node to change, from 0 |
/// | `nodes` | in | scalar | number of nodes to change |
/// | `coefficient` | in | nodes | coefficient of friction, >= 0, no unit; must be 0 without a contact row; NULL: unchanged |
/// | `bound` | in | nodes | part of the bound that does not depend on the contact force, >= 0, force; NULL: unchanged |
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
        // SAFETY: NULL or one number per node guaranteed by the caller.
        let (coefficient, bound) = unsafe {
            (input_or_none(coefficient, nodes, "coefficient")?, input_or_none(bound, nodes, "bound")?)
        };
        problem.set_friction_law(first, nodes, coefficient, bound)
    })
}

/// Makes sticking nodes elastic: `s = T u - s_old - C_t lambda_t` with C_t = 1/k_t.
///
/// A sticking node then yields by C_t lambda_t. Newly added nodes are rigid, C_t = 0. If the rows of a node are
/// multiplied by t, its compliance is multiplied by t^2. The numbers stay until they are replaced or the nodes are
/// cleared. The factors of the bodies stay valid; the last answer is dropped.
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
        // SAFETY: one number per node guaranteed by the caller.
        problem.set_friction_compliance(first, unsafe { input(inv_kt, nodes, "inv_kt") }?)
    })
}

/// Gives s_old, the reference from which slips are measured: T u - C_t lambda_t at the beginning of the load step.
///
/// Newly added nodes have s_old = 0; feti_friction_commit takes s_old from the answer. A host that solves for the
/// increment of a Newton iteration gives T (u_begin - u_k). The factors of the bodies stay valid, and the last answer
/// keeps its slips.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `first` | in | scalar | first node to change, from 0 |
/// | `nodes` | in | scalar | number of nodes to change |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2; ignored if there are no nodes |
/// | `s_old` | in | dim * nodes | node after node, length; rows without entries slip by minus this |
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
        // the nodes are checked first: no array is read for nodes that do not exist
        problem.check_friction_nodes(first, nodes, dim)?;
        // SAFETY: dim numbers for each node guaranteed by the caller.
        let s_old = unsafe { input(s_old, tangential_rows(nodes, dim)?, "s_old") }?;
        problem.set_friction_reference(first, nodes, dim, s_old)
    })
}

/// Ends a load step: sets s_old to `T u - C_t lambda_t` of the last answer at every node, including open nodes.
///
/// Call this function when a load step is accepted, before or after you give the loads of the next step. The answer
/// with its slips is unchanged, and so are the start values of the next solve. A second call has no further effect. To
/// be able to return to an earlier step, save the state before the call (feti_state_save). FETI_STATE if no solve has
/// given an answer yet, if a group of bodies has no answer, and if the answer is not certified (a status of feti_solve
/// other than FETI_OK and FETI_MARGINAL).
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
/// Nodes of pairs (feti_pair_add) stay. The numbering starts again behind them, at 0 without them, and new nodes may have another dim. feti_rows_clear with FETI_INEQUALITY also removes
/// the nodes. The factors of the bodies stay valid; the last answer is dropped.
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

/// Number of tangential rows of a node.
fn dimension(dim: i32) -> Result<usize> {
    usize::try_from(dim).ok().filter(|dim| (1..=2).contains(dim)).ok_or_else(|| {
        let what = format!("{dim} is neither 1 nor 2, the tangential rows of a node");
        Error::argument("dim", what).value(f64::from(dim))
    })
}

/// `dim` rows per node; checks that an array can have this number of entries.
fn tangential_rows(nodes: usize, dim: usize) -> Result<usize> {
    count((nodes as i64).saturating_mul(dim as i64), "nodes")
}

/// Number of tangential rows of all nodes; `nodes` and `dim` must be those of the problem.
pub(super) fn all_nodes(problem: &Problem, nodes: i64, dim: i32) -> Result<usize> {
    let nodes = same(nodes, problem.sizes().nodes, "nodes", NODES)?;
    let dim = if nodes == 0 { 0 } else { dimension(dim)? };
    problem.check_friction_nodes(0, nodes, dim)?;
    tangential_rows(nodes, dim)
}

/// Adds the node to an error about a tangential row.
fn at_node(error: Error, dim: usize) -> Error {
    match error.place.row {
        Some(row) => error.node(row / dim),
        None => error,
    }
}
