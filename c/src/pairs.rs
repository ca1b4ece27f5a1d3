//! Pairs of surfaces that may meet: their laws, the search for partners, results.

use std::ffi::c_char;

use crate::boundary::{call, count, enter, id, input, known, meaning, same, text, OutStruct, Output};
use crate::header::types::{
    feti_pair_facts, feti_problem, FETI_AREA, FETI_CLOSED, FETI_FORCE, FETI_GAP, FETI_MORTAR,
    FETI_NODE_TO_FACE, FETI_NORMAL, FETI_PRESSURE, FETI_SHEAR, FETI_SLIP, FETI_TIED,
};
use feti_contact::error::Result;
use feti_contact::solver::{PairFacts, PairField, PairMethod};

/// Adds a pair of surfaces that may meet: the nodes of the slave must not enter the master.
///
/// The pair has one contact row for each slave node that is in a face (of a cloud for each node), in ascending order of nodes. A tie has
/// an equality row for each direction of such a node instead: along the normal, then along the face. The numbers of the rows never change: pairs come
/// before rows of the host (FETI_STATE, which names such a row), and feti_rows_clear leaves the rows of pairs. The rows have entries after
/// feti_pairs_find; a node without partner has the gap +infinity and no entries. FETI_NODE_TO_FACE is for edges, corners and rigid obstacles;
/// its pressures of a slave with FETI_LINE3, FETI_TRI6, FETI_QUAD8 or FETI_QUAD9 are wrong, however fine the mesh. FETI_MORTAR is for faces that lie on
/// each other: pressures are right for all shapes. The slave should be the finer mesh. FETI_UNSUPPORTED if slave and master are one surface, and for a cloud
/// of points by FETI_MORTAR.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `slave` | in | scalar | surface whose nodes get rows, from 0; it has unknowns |
/// | `master` | in | scalar | surface that they meet, from 0; it has faces or is rigid, with the dimensions of the slave |
/// | `method` | in | scalar | FETI_NODE_TO_FACE or FETI_MORTAR, with + FETI_TIED for a tie |
/// | `distance` | in | scalar | > 0, finite, length: nodes up to this distance, outside or inside, have a partner; larger than the motion of a step |
/// | `pair` | out | scalar | number of the new pair, from 0 |
/// | `first` | out | scalar | number of its first row among those of its kind, from 0; may be NULL |
///
/// # Safety
/// `pair` has room for one number, `first` is NULL or has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_pair_add(
    p: *mut feti_problem,
    slave: i64,
    master: i64,
    method: i32,
    distance: f64,
    pair: *mut i64,
    first: *mut i64,
) -> i32 {
    enter(p, call!(feti_pair_add(p, slave, master, method, distance, pair, first)), |problem| {
        let (slave, master, (method, is_tied)) =
            (id(slave, "slave")?, id(master, "master")?, method_of(method)?);
        // SAFETY: room for one number, or NULL, guaranteed by the caller.
        let (number, row) = unsafe { (Output::new(pair, 1, "pair")?, Output::optional(first, 1, "first")?) };
        let rows = problem.surface_sizes(slave).map_or(0, |sizes| sizes.dim * sizes.nodes);
        let _room = problem.headroom_for_rows(rows, 0)?;
        let (pair, first) = problem.pair_add(slave, master, method, is_tied, distance)?;
        number.set(pair as i64);
        row.set(first as i64);
        Ok(())
    })
}

/// Sets a number of a pair by its name; feti_pairs_find uses it.
///
/// One number for all slave nodes, or one for each node of the slave surface (nodes in no face are ignored), with its default in brackets:
/// - `friction` (0): coefficient of friction
/// - `cohesion` (0): shear per area that acts at pressure 0
/// - `offset` (0): length, subtracted from gaps: half the thickness of a shell, an interference, wear
/// - `compliance` (0): length per pressure, by which the contact yields
///
/// One number:
/// - `adjust` (0): length; gaps of the first find up to this size count as 0, so that faceted meshes cause no strain
/// - `on` (1): 0 opens all rows of the pair, a tie demands nothing
/// - `angle` (100): degrees; smallest angle between the outward normals of a node and its partner
/// - `depth` (`distance` of feti_pair_add): length; deepest penetration that is believed
/// - `thickness` (1): of a problem in the plane, length
/// - `axisymmetric` (0): 1: the area is `thickness` (2 pi or 1, as in K) times the first coordinate
///
/// The first coefficient or cohesion above 0 gives all nodes of the pair friction. FETI_STATE if the host has added nodes
/// with friction before; FETI_UNSUPPORTED for `cohesion` or `compliance` of a cloud, which has no areas, and for `friction` or `cohesion` of a tie.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `pair` | in | scalar | number of the pair, from 0 |
/// | `name` | in | text | one of the names above |
/// | `n` | in | scalar | 1, or the nodes of the slave surface |
/// | `value` | in | n | finite; >= 0 except for `offset` |
///
/// # Safety
/// `name` is NUL terminated, and the array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_pair_set_f64(
    p: *mut feti_problem,
    pair: i64,
    name: *const c_char,
    n: i64,
    value: *const f64,
) -> i32 {
    enter(p, call!(feti_pair_set_f64(p, pair, name, n, value)), |problem| {
        let pair = id(pair, "pair")?;
        // SAFETY: NUL terminated guaranteed by the caller.
        let name = unsafe { text(name, "name") }?;
        let n = count(n, "n")?;
        problem.check_pair_number(pair, name, n)?;
        // SAFETY: n numbers guaranteed by the caller.
        let value = unsafe { input(value, n, "value") }?;
        let (rows, dim) = problem.pair_rows(pair)?;
        let _room = problem.headroom_for_rows(rows * dim, 0)?;
        problem.pair_set(pair, name, value)
    })
}

/// Finds the partners of all slave nodes at the present positions, where u = 0, and makes the rows of all pairs.
///
/// Entries, gaps, tangential rows, areas and slips since the beginning of the step are replaced. Forces and states stay with their nodes: the
/// next solve starts from them if option start is previous. A node whose foot was inside a face keeps this face up to 2 % of the edge beyond
/// it, until feti_pairs_commit. Two calls at the same positions make the same rows, bit by bit, and keep the last answer. A tie finds its points once:
/// later calls measure what has opened since, so that an initial gap is kept. Rows whose unknowns are all held are switched off; if one of them overlaps by more
/// than 1e-9 of the size of the slave, the call returns FETI_GAPS_CONTRADICT and names pair and node. FETI_STATE if a
/// node with `compliance` has lost its area. The log has a line for each pair.
/// After a failure, and after feti_cancel (FETI_CANCELLED), the rows are those of the last find.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_pairs_find(p: *mut feti_problem) -> i32 {
    enter(p, call!(feti_pairs_find(p)), |problem| problem.pairs_find())
}

/// Begins the next load step at the present positions of all surfaces: slips count from here, and nodes keep no faces.
///
/// The first step begins at the positions of feti_pair_add. Call this function once for each load step, before the surfaces move; without
/// it slips count from the beginning of the analysis.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_pairs_commit(p: *mut feti_problem) -> i32 {
    enter(p, call!(feti_pairs_commit(p)), |problem| problem.pairs_commit())
}

/// Reads a field of a pair at the nodes of the slave surface, in the order of these nodes; 0 where a node has no partner.
///
/// FETI_SHEAR, FETI_SLIP and FETI_NORMAL have dim numbers for each node, all others one number. Without faces there are no areas, and
/// pressure and shear are 0. FETI_STATE without an answer, except for FETI_AREA and FETI_NORMAL, which the last find has.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `pair` | in | scalar | number of the pair, from 0 |
/// | `field` | in | scalar | FETI_FORCE, FETI_PRESSURE, FETI_SHEAR, FETI_GAP, FETI_SLIP, FETI_AREA, FETI_NORMAL or FETI_CLOSED |
/// | `n` | in | scalar | numbers of the field: nodes of the slave surface, or dim times as many |
/// | `values` | out | n | node after node |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_pair_field(
    p: *mut feti_problem,
    pair: i64,
    field: i32,
    n: i64,
    values: *mut f64,
) -> i32 {
    enter(p, call!(feti_pair_field(p, pair, field, n, values)), |problem| {
        let (pair, field) = (id(pair, "pair")?, field_of(field)?);
        let len = same(n, problem.pair_field_len(pair, field)?, "n", "the numbers of this field are")?;
        // SAFETY: room for n numbers guaranteed by the caller.
        let output = unsafe { Output::new(values, len, "values") }?;
        output.write(&problem.pair_field(pair, field)?);
        Ok(())
    })
}

/// Reads what a pair carries and where it is closed, by the last answer, and where it overlaps, at the present positions.
///
/// Without an answer forces and states are 0. The call finds the partners anew to see the overlap; it changes nothing.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `pair` | in | scalar | number of the pair, from 0 |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_pair_info(p: *mut feti_problem, pair: i64, out: *mut feti_pair_facts) -> i32 {
    enter(p, call!(feti_pair_info(p, pair, out)), |problem| {
        let pair = id(pair, "pair")?;
        // SAFETY: the caller gives `struct_size` bytes.
        let target = unsafe { OutStruct::new(out, "out") }?;
        target.write(&record(&problem.pair_info(pair)?));
        Ok(())
    })
}

fn record(facts: &PairFacts) -> feti_pair_facts {
    let node = |of: Option<(usize, f64)>| known(of.map(|(node, _)| node));
    let figure = |of: Option<(usize, f64)>| of.map_or(0.0, |(_, figure)| figure);
    feti_pair_facts {
        struct_size: size_of::<feti_pair_facts>() as i64,
        rows: facts.rows as i64,
        without: facts.without as i64,
        closed: facts.closed as i64,
        sticking: facts.sticking as i64,
        slipping: facts.slipping as i64,
        force: facts.force,
        moment: facts.moment,
        closed_area: facts.closed_area,
        pressure: figure(facts.largest_pressure),
        pressure_node: node(facts.largest_pressure),
        angle: figure(facts.largest_angle),
        angle_node: node(facts.largest_angle),
        depth: figure(facts.deepest),
        depth_node: node(facts.deepest),
        master_depth: figure(facts.deepest_of_master),
        master_depth_node: node(facts.deepest_of_master),
        between_walls: facts.between_walls as i64,
        between_walls_node: known(facts.first_between),
        held: facts.held as i64,
        held_overlap: facts.held_overlap,
    }
}

/// The method, and whether it ties the surfaces.
fn method_of(method: i32) -> Result<(PairMethod, bool)> {
    let known = [
        (FETI_NODE_TO_FACE, (PairMethod::NodeToFace, false)),
        (FETI_MORTAR, (PairMethod::Mortar, false)),
        (FETI_NODE_TO_FACE + FETI_TIED, (PairMethod::NodeToFace, true)),
        (FETI_MORTAR + FETI_TIED, (PairMethod::Mortar, true)),
    ];
    meaning(method, "method", &known, "neither FETI_NODE_TO_FACE nor FETI_MORTAR, without or with FETI_TIED")
}

fn field_of(field: i32) -> Result<PairField> {
    let known = [
        (FETI_FORCE, PairField::Force),
        (FETI_PRESSURE, PairField::Pressure),
        (FETI_SHEAR, PairField::Shear),
        (FETI_GAP, PairField::Gap),
        (FETI_SLIP, PairField::Slip),
        (FETI_AREA, PairField::Area),
        (FETI_NORMAL, PairField::Normal),
        (FETI_CLOSED, PairField::Closed),
    ];
    meaning(field, "field", &known, "no field from FETI_FORCE to FETI_CLOSED")
}
