//! The order of the job: the sections of header, Fortran module, reference and manual pages, and what is in each.
//! Types come before the functions that need them.

use std::collections::HashMap;

use crate::model::{Api, Callback, Constant, Function, Struct};

pub struct Section {
    pub heading: &'static str,
    /// What a host does here, a line.
    pub says: &'static str,
    /// Constants, structs, functions of the host and functions by their names.
    pub names: &'static [&'static str],
}

macro_rules! section {
    ($heading:literal, $says:literal, [$($name:ident),* $(,)?]) => {
        Section { heading: $heading, says: $says, names: &[$(stringify!($name)),*] }
    };
}

#[rustfmt::skip]
pub const SECTIONS: [Section; 23] = [
    section!("Problem", "Create and destroy a problem, which owns all other data.", [
        feti_problem, feti_problem_create, feti_problem_destroy,
    ]),
    section!("Bodies", "Give each body its stiffness matrix and its load.", [
        FETI_FULL, FETI_LOWER, FETI_UPPER, FETI_COPY, FETI_BORROW, FETI_SKYLINE_DOWN, FETI_SKYLINE_UP, FETI_ALL,
        feti_body_add, feti_body_stiffness_i32, feti_body_stiffness_i64, feti_body_stiffness_split_i32, feti_body_stiffness_split_i64,
        feti_body_stiffness_skyline_i32, feti_body_stiffness_skyline_i64, feti_body_stiffness_triplets_i32, feti_body_stiffness_triplets_i64,
        feti_body_stiffness_dense, feti_body_load, feti_body_numbering_i32, feti_body_numbering_i64,
        feti_dof_table_i32, feti_dof_table_i64,
    ]),
    section!("Null spaces", "Give the motions that a matrix does not resist; otherwise the library finds them.", [
        FETI_EXACT, FETI_CANDIDATES, FETI_SOFT,
        feti_body_coordinates, feti_body_coordinates_flags, feti_body_null_space, feti_body_no_null_space,
        feti_body_null_space_get,
        feti_body_fixing_set, feti_body_fixing,
    ]),
    section!("Bodies by elements", "Give the elements of a large body; the library assembles them and cuts the body into pieces.", [
        feti_body_mesh_i32, feti_body_mesh_i64, feti_body_element, feti_body_elements, feti_body_elements_size,
        feti_body_held_forces, feti_body_pieces,
    ]),
    section!("Bodies by functions of the host", "Let the host solve with its own factorisation of K.", [
        feti_operator_fn, feti_body_operator,
    ]),
    section!("Rows", "Say where bodies touch (B u <= c) and where they are joined (H u = h).", [
        FETI_INEQUALITY, FETI_EQUALITY,
        feti_rows_add_i32, feti_rows_add_i64, feti_rows_compliance, feti_counts,
    ]),
    section!("Friction", "Give contact rows tangential rows and a law of friction.", [
        FETI_TANGENTIAL,
        feti_friction_add_i32, feti_friction_add_i64, feti_friction_law, feti_friction_compliance,
        feti_friction_counts,
    ]),
    section!("Surfaces", "Give surfaces with positions and faces, in place of rows of your own.", [
        FETI_LINE2, FETI_LINE3, FETI_TRI3, FETI_TRI6, FETI_QUAD4, FETI_QUAD8, FETI_QUAD9, FETI_POINT, FETI_PLANE, FETI_SPHERE, FETI_CYLINDER,
        feti_surface_add_i32, feti_surface_add_i64, feti_surface_faces_i32, feti_surface_faces_i64, feti_surface_rigid, feti_surface_move,
        feti_surface_counts,
    ]),
    section!("Pairs of surfaces", "Say which surfaces may meet, find where they meet, read pressures.", [
        FETI_NODE_TO_FACE, FETI_MORTAR, FETI_TIED,
        FETI_FORCE, FETI_PRESSURE, FETI_SHEAR, FETI_GAP, FETI_SLIP, FETI_AREA, FETI_NORMAL, FETI_CLOSED, feti_pair_facts,
        feti_pair_add, feti_pair_set_f64, feti_pairs_find, feti_pairs_commit, feti_pair_field, feti_pair_info,
    ]),
    section!("Options", "Set tolerance, threads, method and limits, by name.", [
        FETI_OPTION_F64, FETI_OPTION_I64, FETI_OPTION_STR, feti_option,
        feti_set_f64, feti_set_i64, feti_set_str, feti_set_text, feti_get_f64, feti_get_i64, feti_get_str,
        feti_option_count, feti_option_at,
    ]),
    section!("Solve", "Compute the answer and its accuracy.", [
        feti_info, feti_setup, feti_solve, feti_cancel,
    ]),
    section!("Results", "Read displacements, forces, gaps and states.", [
        FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK, FETI_ROW_UNKNOWN,
        FETI_FRICTION_OPEN, FETI_FRICTION_STICK, FETI_FRICTION_SLIP, FETI_FRICTION_WEAK, FETI_FRICTION_UNKNOWN,
        feti_displacement, feti_multipliers, feti_gaps, feti_active, feti_reaction, feti_amplitudes,
        feti_friction_slips, feti_friction_states,
    ]),
    section!("Load steps", "Continue with other loads and gaps; friction starts from the slips of the last step.", [
        feti_rows_rhs, feti_friction_commit, feti_friction_reference, feti_start_from,
    ]),
    section!("Newton's method", "Give new matrices and new rows to an existing problem.", [
        feti_body_values, feti_body_values_split, feti_body_values_dense, feti_rows_clear, feti_friction_clear,
    ]),
    section!("Saved states", "Save a step and go back to it.", [
        feti_state_save, feti_state_restore, feti_state_drop,
    ]),
    section!("Diagnosis", "Find out why there is no answer, and what is unusual about the problem.", [
        feti_findings, feti_diagnosis, feti_diagnosis_motion, feti_diagnosis_rows, feti_diagnosis_dependent, feti_diagnosis_untouched,
        feti_diagnosis_undetermined, feti_diagnosis_undetermined_motion,
    ]),
    section!("Facts on bodies", "Read size, memory and null space of a body, and the time of each phase.", [
        FETI_ORIGIN_EXACT, FETI_ORIGIN_CANDIDATES, FETI_ORIGIN_COORDINATES, FETI_ORIGIN_FOUND,
        feti_body_facts, feti_body_info, feti_body_components, feti_phase, feti_phase_count, feti_phase_at,
    ]),
    section!("Progress and log", "Follow the progress of a setup or a solve.", [
        FETI_PHASE_SETUP, FETI_PHASE_SOLVE,
        FETI_STEP_CONJUGATE_GRADIENT, FETI_STEP_EXPANSION, FETI_STEP_RELEASE, FETI_STEP_NEWTON,
        FETI_LOG_NONE, FETI_LOG_RESULT, FETI_LOG_PHASE, FETI_LOG_STEP,
        feti_progress, feti_progress_fn, feti_log_fn, feti_on_progress, feti_on_log,
    ]),
    section!("Validation", "Check an answer of this or another program; multiply by the operators of the method.", [
        feti_certificate, feti_check, feti_check_friction, feti_body_kplus, feti_dual_apply, feti_dual_rhs,
    ]),
    section!("Several ranks", "Let other ranks of a host share the work of rank 0.", [
        feti_communicator, feti_send_fn, feti_flush_fn, feti_receive_fn, feti_release_fn, feti_communicator_set, feti_serve,
    ]),
    section!("Files", "Write a problem to a file and read it.", [
        feti_problem_write, feti_problem_read,
    ]),
    section!("Errors", "Read what went wrong, where and by how much.", [
        feti_error_detail, feti_last_error, feti_last_error_detail, feti_problem_error,
    ]),
    section!("Statuses and version", "Names and texts of return values; the version of the library.", [
        FETI_OK, FETI_ITERATIONS, FETI_TIME, FETI_CANCELLED, FETI_STALLED, FETI_INACCURATE, FETI_MARGINAL,
        FETI_MEMORY, FETI_HANDLE, FETI_BUSY, FETI_CALLBACK, FETI_STATE, FETI_LOAD_NOT_HELD, FETI_GAPS_CONTRADICT,
        FETI_NULL_SPACE, FETI_INDEFINITE, FETI_IO, FETI_INTERNAL, FETI_UNSUPPORTED, FETI_OVERFLOW, FETI_SLIDES, FETI_COMMUNICATION,
        FETI_ARGUMENT,
        feti_status_name, feti_status_text, feti_version, feti_version_number,
    ]),
];

/// A section with its items, each kind in the order of the names.
#[derive(Default)]
pub struct Group<'a> {
    pub heading: &'static str,
    pub says: &'static str,
    pub constants: Vec<&'a Constant>,
    pub structs: Vec<&'a Struct>,
    pub callbacks: Vec<&'a Callback>,
    pub functions: Vec<&'a Function>,
}

impl Group<'_> {
    /// Names in the order in which they are printed.
    pub fn names(&self) -> Vec<&str> {
        let constants = self.constants.iter().map(|item| item.name.as_str());
        let structs = self.structs.iter().map(|item| item.name.as_str());
        let callbacks = self.callbacks.iter().map(|item| item.name.as_str());
        constants
            .chain(structs)
            .chain(callbacks)
            .chain(self.functions.iter().map(|f| f.name.as_str()))
            .collect()
    }
}

/// The sections that have something, then names of no section.
pub fn groups(api: &Api) -> Vec<Group<'_>> {
    let places = places(&SECTIONS);
    let place = |name: &str| places.get(name).copied().unwrap_or((SECTIONS.len(), 0));
    let headings = SECTIONS.iter().map(|section| (section.heading, section.says));
    let headings = headings.chain([("Other", "In no section of the generator's list.")]).enumerate();
    let of = |(k, (heading, says))| Group {
        heading,
        says,
        constants: sorted(&api.constants, k, |item| place(&item.name)),
        structs: sorted(&api.structs, k, |item| place(&item.name)),
        callbacks: sorted(&api.callbacks, k, |item| place(&item.name)),
        functions: sorted(&api.functions, k, |item| place(&item.name)),
    };
    headings.map(of).filter(|group| !group.names().is_empty()).collect()
}

/// The items of section `k`, in its order; those without a place in the order of the source.
fn sorted<T>(items: &[T], k: usize, place: impl Fn(&T) -> (usize, usize)) -> Vec<&T> {
    let mut found: Vec<&T> = items.iter().filter(|item| place(item).0 == k).collect();
    found.sort_by_key(|item| place(item));
    found
}

/// Name -> (section, place in it).
fn places(sections: &[Section]) -> HashMap<&'static str, (usize, usize)> {
    let named = sections.iter().enumerate().flat_map(|(k, section)| {
        section.names.iter().enumerate().map(move |(place, name)| (*name, (k, place)))
    });
    named.collect()
}

/// Every exported name is in one section, and every name of a section is exported.
pub fn check(api: &Api, sections: &[Section]) -> Result<(), String> {
    let mut seen: HashMap<&str, &str> = HashMap::new();
    for section in sections {
        for name in section.names {
            if let Some(other) = seen.insert(name, section.heading) {
                return Err(format!("order.rs: `{name}` is in `{other}` and in `{}`", section.heading));
            }
        }
    }
    let groups = groups(api);
    let exported: Vec<&str> = groups.iter().flat_map(Group::names).collect();
    if let Some(name) = exported.iter().find(|name| !seen.contains_key(*name)) {
        return Err(format!("order.rs: `{name}` is in no section"));
    }
    match seen.iter().find(|(name, _)| !exported.contains(name)) {
        Some((name, heading)) => Err(format!("order.rs: `{name}` of `{heading}` is not exported")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn api(names: &[&str]) -> Api {
        let functions =
            names.iter().map(|name| format!("#[no_mangle] pub extern \"C\" fn {name}() -> i32 {{ 0 }}"));
        let source = functions.collect::<Vec<_>>().join("\n");
        crate::checked(&[("a.rs".to_string(), source)], [0, 1, 0]).unwrap()
    }

    #[test]
    fn a_name_in_no_section_in_two_or_of_nothing_is_refused() {
        let one = section!("One", "", [feti_a, feti_b]);
        let two = section!("Two", "", [feti_c]);
        assert_eq!(check(&api(&["feti_c", "feti_b", "feti_a"]), &[one, two]), Ok(()));
        let one = || section!("One", "", [feti_a]);
        let message = check(&api(&["feti_a", "feti_b"]), &[one()]).unwrap_err();
        assert!(message.contains("`feti_b` is in no section"), "{message}");
        let message = check(&api(&["feti_a"]), &[one(), section!("Two", "", [feti_a])]).unwrap_err();
        assert!(message.contains("`feti_a` is in `One` and in `Two`"), "{message}");
        let message = check(&api(&["feti_b"]), &[section!("One", "", [feti_a, feti_b])]).unwrap_err();
        assert!(message.contains("`feti_a` of `One` is not exported"), "{message}");
    }

    #[test]
    fn functions_come_in_the_order_of_the_job() {
        let api = api(&[
            "feti_solve",
            "feti_body_stiffness_i64",
            "feti_body_add",
            "feti_problem_create",
            "feti_mine",
        ]);
        let groups = groups(&api);
        let headings: Vec<_> = groups.iter().map(|group| group.heading).collect();
        assert_eq!(headings, ["Problem", "Bodies", "Solve", "Other"]);
        assert_eq!(groups[1].names(), ["feti_body_add", "feti_body_stiffness_i64"]);
    }
}
