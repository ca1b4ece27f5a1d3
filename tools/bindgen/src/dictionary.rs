//! What the test programs know of arguments: a right value for every name, and what can be wrong with it.
//!
//! Right values belong to the problem of tests/abi/c/calls.h: body 0 with 2 unknowns, held; body 1 with 2 unknowns,
//! floating; 2 inequality rows, 1 equality row; solved. A name that is not here, or not with its type, is an error: a new
//! function cannot be forgotten.

use crate::model::{Argument, Function};

/// What an argument that is read stands for. Results need no entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// A size that the problem knows.
    Size,
    /// Number of rows from `first` on: fewer are right.
    UpTo,
    /// A size that the caller chooses, >= 0.
    Free,
    /// A size that the caller chooses, > 0.
    Positive,
    /// Number of a body, row, state, option, phase: from 0.
    Number,
    /// Number of a body, or -1 for all of them.
    BodyOrAll,
    /// Leading dimension, at least the given number.
    Leading,
    /// Room for a text or a list.
    Room,
    /// One of some constants.
    Choice,
    /// 0 or 1.
    Base,
    /// Numbers per position, 1 to 3.
    Dimension,
    /// Value of an option: a double, an integer.
    Value,
    /// Anything goes.
    Any,
    /// Name of an option or a word that it knows.
    Word,
    /// Options and their values; an empty text has none.
    Options,
    /// Name of a file: any text.
    Path,
    /// Doubles, all finite.
    Doubles,
    /// Doubles, finite or +infinity.
    Gaps,
    /// Doubles, finite and not negative.
    NotNegative,
    /// Positions of a sparse matrix.
    Positions,
    /// Indices from 0.
    Indices,
    /// Numbers of rows from 0; -1: none.
    Rows,
    /// Indices from 0; one below 0 is a held unknown.
    Unknowns,
    /// Directions, 1 to 6.
    Directions,
    /// Numbers from 0 that differ.
    Distinct,
    /// Integers of any value.
    Labels,
    /// The table of functions for other ranks.
    Ranks,
}

/// (name or function.name, role, right value or initialiser)
type Entry = (&'static str, Role, &'static str);

/// A function in its own name, or without `_i32` and `_i64`.
const ENTRIES: &[Entry] = &[
    ("base", Role::Base, "0"),
    ("basis", Role::Doubles, "1.0, 1.0"),
    ("body", Role::Number, "1"),
    ("bound", Role::NotNegative, "0.5"),
    ("by", Role::Ranks, "{ .struct_size = sizeof(feti_communicator), .size = 1, .local_size = 1, .release = host_feti_release_fn }"),
    ("cap", Role::Room, "8"),
    ("coefficient", Role::NotNegative, "0.25"),
    ("col", Role::Indices, "0, 0, 1"),
    ("concurrent", Role::Base, "0"),
    ("count", Role::UpTo, "1"),
    ("data", Role::Doubles, "0.0, 0.0, 0.0, 1.0"),
    ("diag", Role::Doubles, "4.0, 4.0"),
    ("dim", Role::Dimension, "1"),
    ("dir", Role::Directions, "1, 1"),
    ("direction", Role::Choice, "FETI_SKYLINE_DOWN"),
    ("distance", Role::Value, "0.5"),
    ("dof", Role::Indices, "0"),
    ("e", Role::Number, "0"),
    ("elements", Role::Positive, "1"),
    ("eqs", Role::Size, "1"),
    ("f", Role::Doubles, "0.0, -6.0"),
    ("faces", Role::Free, "1"),
    ("field", Role::Choice, "FETI_AREA"),
    ("first", Role::Number, "0"),
    ("flags", Role::Choice, "0"),
    ("id", Role::Number, "0"),
    ("inv_k", Role::NotNegative, "0.0, 0.0"),
    ("k", Role::Number, "0"),
    ("inv_kt", Role::NotNegative, "0.0"),
    ("ke", Role::Doubles, "4.0, -4.0, 4.0"),
    ("kind", Role::Choice, "FETI_INEQUALITY"),
    ("lambda", Role::Doubles, "0.0, 0.0"),
    ("lambda_t", Role::Doubles, "0.0"),
    ("ld", Role::Leading, "2"),
    ("ldd", Role::Leading, "2"),
    ("ldr", Role::Leading, "2"),
    ("ldx", Role::Leading, "2"),
    ("ldy", Role::Leading, "2"),
    ("level", Role::Choice, "0"),
    ("m", Role::Size, "3"),
    ("master", Role::Number, "1"),
    ("method", Role::Choice, "FETI_NODE_TO_FACE"),
    ("mu", Role::Doubles, "0.0"),
    ("n", Role::Size, "2"),
    ("nnz", Role::Size, "3"),
    ("node", Role::Labels, "1, 2"),
    ("nrhs", Role::Free, "2"),
    ("nodes", Role::Size, "1"),
    ("normal_row", Role::Rows, "1"),
    ("number", Role::Distinct, "2, 3"),
    ("pair", Role::Number, "0"),
    ("path", Role::Path, "FILE_OF_CALLS"),
    ("ptr", Role::Positions, "0, 2"),
    ("r", Role::Size, "1"),
    ("rhs", Role::Gaps, "1.0, 5.0"),
    ("row", Role::Indices, "0, 1, 1"),
    ("row_ptr", Role::Positions, "0, 1, 3"),
    ("rows", Role::Size, "2"),
    ("s_old", Role::Doubles, "0.0"),
    ("shape", Role::Choice, "FETI_LINE2"),
    ("slave", Role::Number, "0"),
    ("status", Role::Any, "FETI_STATE"),
    ("storage", Role::Choice, "FETI_LOWER"),
    ("surface", Role::Number, "2"),
    ("text", Role::Options, "\"tolerance=1e-12 threads=1\""),
    ("u", Role::Doubles, "0.0, 0.0, 0.0, 0.0"),
    ("user", Role::Any, "NULL"),
    ("val", Role::Doubles, "4.0, -4.0, 4.0"),
    ("x", Role::Doubles, "1.0, 2.0, 3.0, 4.0"),
    ("xyz", Role::Doubles, "0.0, 1.0"),
    // Where a name stands for something else.
    ("feti_body_add.n", Role::Positive, "3"),
    ("feti_body_coordinates.ld", Role::Leading, "1"),
    ("feti_body_coordinates_flags.flags", Role::Choice, "FETI_SOFT"),
    ("feti_body_element.ke", Role::Doubles, "4.0, -4.0, -4.0, 4.0"),
    ("feti_body_fixing_set.r", Role::Free, "1"),
    ("feti_body_held_forces.n", Role::Free, "2"),
    ("feti_body_load.body", Role::BodyOrAll, "1"),
    ("feti_body_mesh.dof", Role::Unknowns, "0, 1"),
    ("feti_body_null_space.r", Role::Free, "1"),
    ("feti_body_stiffness_dense.k", Role::Doubles, "4.0, -4.0, -4.0, 4.0"),
    ("feti_body_stiffness_skyline.ptr", Role::Positions, "0, 0, 1"),
    ("feti_body_stiffness_skyline.val", Role::Doubles, "-4.0"),
    ("feti_body_stiffness_split.col", Role::Indices, "0"),
    ("feti_body_stiffness_split.row_ptr", Role::Positions, "0, 0, 1"),
    ("feti_body_stiffness_split.val", Role::Doubles, "-4.0"),
    ("feti_body_stiffness_triplets.nnz", Role::Free, "3"),
    ("feti_body_values_dense.k", Role::Doubles, "4.0, -4.0, -4.0, 4.0"),
    ("feti_body_values_split.nnz", Role::Size, "1"),
    ("feti_body_values_split.val", Role::Doubles, "-4.0"),
    ("feti_check.n", Role::Size, "4"),
    ("feti_displacement.body", Role::BodyOrAll, "1"),
    ("feti_dof_table.coefficient", Role::Doubles, "1.0"),
    ("feti_dof_table.constant", Role::Doubles, "0.0, 0.0, 1.0"),
    ("feti_dof_table.n", Role::Free, "3"),
    ("feti_dof_table.number", Role::Unknowns, "2, 3, -1"),
    ("feti_dof_table.ptr", Role::Positions, "0, 0, 0, 1"),
    ("feti_dof_table.term", Role::Indices, "0"),
    ("feti_dual_apply.x", Role::Doubles, "1.0, 2.0, 3.0"),
    ("feti_check_friction.n", Role::Size, "4"),
    ("feti_friction_add.body", Role::Indices, "0, 1"),
    ("feti_friction_add.dof", Role::Indices, "1, 0"),
    ("feti_friction_add.nodes", Role::Free, "1"),
    ("feti_friction_add.row_ptr", Role::Positions, "0, 2"),
    ("feti_friction_add.val", Role::Doubles, "1.0, -1.0"),
    ("feti_friction_compliance.nodes", Role::UpTo, "1"),
    ("feti_friction_law.nodes", Role::UpTo, "1"),
    ("feti_friction_reference.nodes", Role::UpTo, "1"),
    ("feti_get_f64.name", Role::Word, "\"gamma\""),
    ("feti_get_i64.name", Role::Word, "\"threads\""),
    ("feti_get_str.name", Role::Word, "\"start\""),
    ("feti_pair_set_f64.n", Role::Size, "1"),
    ("feti_pair_set_f64.name", Role::Word, "\"depth\""),
    ("feti_pair_set_f64.value", Role::NotNegative, "1.0"),
    ("feti_reaction.body", Role::BodyOrAll, "1"),
    ("feti_rows_add.body", Role::Indices, "0, 1"),
    ("feti_rows_add.dof", Role::Indices, "1, 0"),
    ("feti_rows_add.rhs", Role::Gaps, "1.0"),
    ("feti_rows_add.rows", Role::Free, "1"),
    ("feti_rows_add.row_ptr", Role::Positions, "0, 2"),
    ("feti_rows_add.val", Role::Doubles, "1.0, -1.0"),
    ("feti_rows_compliance.rows", Role::UpTo, "2"),
    ("feti_rows_rhs.rows", Role::UpTo, "2"),
    ("feti_set_f64.name", Role::Word, "\"gamma\""),
    ("feti_set_f64.value", Role::Value, "1.0"),
    ("feti_set_i64.name", Role::Word, "\"threads\""),
    ("feti_set_i64.value", Role::Value, "1"),
    ("feti_set_str.name", Role::Word, "\"start\""),
    ("feti_set_str.value", Role::Word, "\"cold\""),
    ("feti_surface_add.body", Role::BodyOrAll, "1"),
    ("feti_surface_add.dim", Role::Dimension, "2"),
    ("feti_surface_add.dof", Role::Unknowns, "0, -1, 1, -1"),
    ("feti_surface_add.nodes", Role::Free, "2"),
    ("feti_surface_add.x", Role::Doubles, "0.0, 0.0, 1.0, 0.0"),
    ("feti_surface_faces.node", Role::Indices, "0, 1"),
    ("feti_surface_move.x", Role::Doubles, "0.0, 1.0, 2.0, 1.0"),
    ("feti_surface_rigid.dim", Role::Dimension, "2"),
    ("feti_surface_rigid.shape", Role::Choice, "FETI_PLANE"),
];

/// Role and right value of an argument that is read.
pub fn entry(function: &Function, argument: &Argument) -> Result<(Role, &'static str), String> {
    let find = |function: &str| {
        let key = format!("{function}.{}", argument.name);
        ENTRIES.iter().find(|entry| entry.0 == key)
    };
    let name = function.name.as_str();
    let plain = name.strip_suffix("_i32").or(name.strip_suffix("_i64")).unwrap_or(name);
    let found = find(name).or_else(|| find(plain));
    let found = found.or_else(|| ENTRIES.iter().find(|entry| entry.0 == argument.name));
    let found = found.ok_or_else(|| {
        format!("function `{}`, argument `{}`: no right value in dictionary.rs", function.name, argument.name)
    })?;
    Ok((found.1, found.2))
}
