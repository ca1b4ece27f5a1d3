//! Every function with a handle, and its source file.

use std::ptr::{null, null_mut};

use crate::*;

pub const SOURCES: [&str; 27] = [
    include_str!("../bodies/body.rs"),
    include_str!("../bodies/body_info.rs"),
    include_str!("../bodies/elements.rs"),
    include_str!("../diagnosis.rs"),
    include_str!("../dof_table.rs"),
    include_str!("../boundary/error_store.rs"),
    include_str!("../file.rs"),
    include_str!("../bodies/forms.rs"),
    include_str!("../friction.rs"),
    include_str!("../log.rs"),
    include_str!("../bodies/null_space.rs"),
    include_str!("../bodies/numbering.rs"),
    include_str!("../bodies/operator.rs"),
    include_str!("../options.rs"),
    include_str!("../pairs.rs"),
    include_str!("../phases.rs"),
    include_str!("../problem.rs"),
    include_str!("../progress.rs"),
    include_str!("../ranks.rs"),
    include_str!("../results.rs"),
    include_str!("../rows.rs"),
    include_str!("../solve.rs"),
    include_str!("../state.rs"),
    include_str!("../surfaces.rs"),
    include_str!("../bodies/stiffness.rs"),
    include_str!("../validation.rs"),
    include_str!("../bodies/values.rs"),
];

/// Status of every function with handle `p` and otherwise NULL and zero; the handle is checked first.
pub fn statuses(p: *mut feti_problem) -> Vec<(&'static str, i32)> {
    macro_rules! table {
        ($($function:ident($($argument:expr),*);)*) => {
            #[allow(unused_unsafe)]
            // SAFETY: pointers are NULL, sizes zero.
            unsafe { vec![$((stringify!($function), $function(p $(, $argument)*))),*] }
        };
    }
    table! {
        feti_problem_error(null_mut(), 0, &mut 0);
        feti_communicator_set(null());
        feti_set_f64(null(), 0.0);
        feti_set_i64(null(), 0);
        feti_set_str(null(), null());
        feti_set_text(null());
        feti_get_f64(null(), null_mut());
        feti_get_i64(null(), null_mut());
        feti_get_str(null(), null_mut(), 0, null_mut());
        feti_body_add(0, null_mut());
        feti_body_stiffness_i32(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_i64(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_dense(0, 0, null(), 0, 0, 0);
        feti_body_stiffness_split_i32(0, 0, null(), null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_split_i64(0, 0, null(), null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_skyline_i32(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_skyline_i64(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_triplets_i32(0, 0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_triplets_i64(0, 0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_values(0, 0, null());
        feti_body_values_split(0, 0, null(), 0, null());
        feti_body_values_dense(0, 0, null(), 0);
        feti_body_mesh_i32(0, 0, null(), null(), 0);
        feti_body_mesh_i64(0, 0, null(), null(), 0);
        feti_body_element(0, 0, 0, null(), 0);
        feti_body_elements(0, 0, 0, null(), 0);
        feti_body_elements_size(0, 0, 0, 0, null_mut());
        feti_body_held_forces(0, 0, null_mut());
        feti_body_pieces(0, 0, null_mut());
        feti_body_components(0, 0, null_mut());
        feti_body_info(0, null_mut());
        feti_body_numbering_i32(0, 0, null(), 0);
        feti_body_numbering_i64(0, 0, null(), 0);
        feti_dof_table_i32(0, null(), null(), null(), null(), null(), 0);
        feti_dof_table_i64(0, null(), null(), null(), null(), null(), 0);
        feti_body_null_space(0, 0, 0, null(), 0, 0);
        feti_body_no_null_space(0);
        feti_body_null_space_get(0, 0, null_mut(), null_mut(), 0);
        feti_body_coordinates(0, 0, 0, null(), null(), null(), 0);
        feti_body_coordinates_flags(0, 0);
        feti_body_load(0, 0, null());
        feti_body_operator(0, 0, null(), None, None, 0, null_mut());
        feti_rows_add_i32(0, 0, null(), null(), null(), null(), 0, null(), null_mut());
        feti_rows_add_i64(0, 0, null(), null(), null(), null(), 0, null(), null_mut());
        feti_rows_rhs(0, 0, 0, null());
        feti_rows_compliance(0, 0, 0, null());
        feti_rows_clear(0);
        feti_friction_add_i32(0, 0, null(), null(), null(), null(), null(), 0, null(), null(), null_mut());
        feti_friction_add_i64(0, 0, null(), null(), null(), null(), null(), 0, null(), null(), null_mut());
        feti_friction_law(0, 0, null(), null());
        feti_friction_compliance(0, 0, null());
        feti_friction_reference(0, 0, 0, null());
        feti_friction_commit();
        feti_friction_slips(0, 0, null_mut());
        feti_friction_states(0, null_mut());
        feti_friction_clear();
        feti_surface_add_i32(0, 0, 0, null(), 0, null(), 0, 0, null_mut());
        feti_surface_add_i64(0, 0, 0, null(), 0, null(), 0, 0, null_mut());
        feti_surface_faces_i32(0, 0, 0, null(), 0);
        feti_surface_faces_i64(0, 0, 0, null(), 0);
        feti_surface_rigid(0, 0, null(), null_mut());
        feti_surface_move(0, null(), 0);
        feti_surface_counts(0, null_mut(), null_mut(), null_mut(), null_mut());
        feti_pair_add(0, 0, 0, 0.0, null_mut(), null_mut());
        feti_pair_set_f64(0, null(), 0, null());
        feti_pairs_find();
        feti_pairs_commit();
        feti_pair_field(0, 0, 0, null_mut());
        feti_pair_info(0, null_mut());
        feti_setup(); feti_solve(null_mut());
        feti_phase_count(null_mut()); feti_phase_at(0, null_mut());
        feti_cancel();
        feti_on_progress(None, null_mut());
        feti_on_log(None, 0, null_mut());
        feti_problem_write(null());
        feti_problem_read(null());
        feti_start_from(0, 0, null());
        feti_state_save(null_mut());
        feti_state_restore(0); feti_state_drop(0);
        feti_diagnosis(null_mut());
        feti_diagnosis_rows(0, 0, null_mut(), null_mut(), null_mut());
        feti_diagnosis_motion(0, 0, null_mut());
        feti_diagnosis_dependent(0, null_mut(), null_mut());
        feti_diagnosis_untouched(0, null_mut(), null_mut());
        feti_diagnosis_undetermined(0, null_mut(), null_mut());
        feti_diagnosis_undetermined_motion(0, 0, 0, null_mut());
        feti_check(0, null(), 0, null(), 0, null(), null_mut());
        feti_check_friction(0, null(), 0, null(), 0, null(), 0, 0, null(), null_mut());
        feti_displacement(0, 0, null_mut());
        feti_reaction(0, 0, 0, null_mut());
        feti_amplitudes(0, 0, null_mut());
        feti_multipliers(0, 0, null_mut());
        feti_gaps(0, null_mut());
        feti_active(0, null_mut());
        feti_counts(null_mut(), null_mut(), null_mut(), null_mut());
        feti_friction_counts(null_mut(), null_mut());
        feti_body_fixing(0, 0, null_mut());
        feti_body_fixing_set(0, 0, null());
        feti_body_kplus(0, 0, 0, null(), 0, null_mut(), 0);
        feti_dual_apply(0, null(), null_mut());
        feti_dual_rhs(0, null_mut());
    }
}
