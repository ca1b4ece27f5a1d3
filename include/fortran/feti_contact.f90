!> Contact problems by FETI duality, for Fortran hosts: the typed Fortran interface of libfeti_contact.
!>
!>   minimise 1/2 u'Ku - f'u  over all u with  B u <= c  and  H u = h
!>
!> K is the stiffness of several bodies, which may float; lambda >= 0 are the forces of the contact rows.
!>
!>   use feti_contact
!>   type(feti_problem) :: p
!>   call feti_problem_create(p)
!>   call feti_set(p, 'tolerance', 1d-10)
!>   call feti_body_add(p, n, body)                                        ! for each body
!>   call feti_body_stiffness(p, body, row_ptr, col, val, FETI_LOWER)
!>   call feti_body_null_space(p, body, R, FETI_EXACT)
!>   call feti_body_load(p, body, f)
!>   call feti_rows_add(p, FETI_INEQUALITY, row_ptr, dof, val, c)
!>   call feti_solve(p)
!>   call feti_displacement(p, body, u)
!>   call feti_multipliers(p, FETI_INEQUALITY, lambda)
!>   call feti_problem_destroy(p)
!>
!> Names and meanings are the same as for the C functions in feti_contact.h. All numbers count from 1: bodies, unknowns,
!> rows, the indices inside arrays and the places in errors. Sizes are taken from the arrays. The library copies all
!> arrays. Index arrays are int32 or int64. A kind, a storage, a flag or a level is int32 like its constants, even if the
!> default INTEGER has 8 bytes. The last arguments of every subroutine are the optional stat and errmsg. With stat the
!> host decides how to react to a failure (feti_last_error_detail returns the place); without stat a failure prints its
!> text and stops the program. The module of each procedure, named below, describes it with shapes and units.
module feti_contact
  use feti_contact_c, only: &
    ! kinds of rows, storage of K, null spaces, states of contact rows, types of options
    FETI_INEQUALITY, FETI_EQUALITY, FETI_TANGENTIAL, FETI_FULL, FETI_LOWER, FETI_UPPER, FETI_EXACT, FETI_CANDIDATES, FETI_SOFT, &
    FETI_COPY, FETI_BORROW, FETI_ALL, FETI_ORIGIN_EXACT, FETI_ORIGIN_CANDIDATES, FETI_ORIGIN_COORDINATES, FETI_ORIGIN_FOUND, &
    FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK, FETI_ROW_UNKNOWN, FETI_OPTION_F64, FETI_OPTION_I64, FETI_OPTION_STR, &
    ! states of nodes with friction
    FETI_FRICTION_OPEN, FETI_FRICTION_STICK, FETI_FRICTION_SLIP, FETI_FRICTION_WEAK, FETI_FRICTION_UNKNOWN, &
    ! phases and kinds of steps that are reported to a progress function
    FETI_PHASE_SETUP, FETI_PHASE_SOLVE, FETI_STEP_CONJUGATE_GRADIENT, FETI_STEP_EXPANSION, FETI_STEP_RELEASE, &
    FETI_STEP_NEWTON, &
    ! levels of a log
    FETI_LOG_NONE, FETI_LOG_RESULT, FETI_LOG_PHASE, FETI_LOG_STEP, &
    ! status: solved; usable but incomplete; failed
    FETI_OK, &
    FETI_ITERATIONS, FETI_TIME, FETI_CANCELLED, FETI_STALLED, FETI_INACCURATE, FETI_MARGINAL, &
    FETI_MEMORY, FETI_HANDLE, FETI_BUSY, FETI_CALLBACK, FETI_STATE, FETI_LOAD_NOT_HELD, FETI_GAPS_CONTRADICT, &
    FETI_NULL_SPACE, FETI_INDEFINITE, FETI_IO, FETI_INTERNAL, FETI_UNSUPPORTED, FETI_OVERFLOW, FETI_SLIDES, &
    FETI_ARGUMENT, &
    FETI_CONTACT_VERSION_MAJOR, FETI_CONTACT_VERSION_MINOR, FETI_CONTACT_VERSION_PATCH
  use feti_contact_base, only: feti_problem, feti_error_detail, feti_progress, &
    feti_progress_procedure => progress_procedure, &
    feti_log_procedure => log_procedure, &
    feti_operator_procedure => operator_procedure, &
    feti_problem_create => problem_create, &
    feti_problem_destroy => problem_destroy, &
    feti_problem_error => problem_error, &
    feti_last_error => last_error, &
    feti_last_error_detail => last_error_detail, &
    feti_status_name => status_name, &
    feti_status_text => status_text, &
    feti_version => version, &
    feti_version_number => version_number
  use feti_contact_options, only: feti_option, &
    feti_set => set_option, &
    feti_set_text => set_options, &
    feti_get => get_option, &
    feti_option_count => option_count, &
    feti_option_at => option_at
  use feti_contact_file, only: &
    feti_problem_write => problem_write, &
    feti_problem_read => problem_read
  use feti_contact_bodies, only: feti_body_facts, &
    feti_body_add => body_add, &
    feti_body_components => body_components, &
    feti_body_info => body_info, &
    feti_body_numbering => body_numbering, &
    feti_body_null_space => body_null_space, &
    feti_body_no_null_space => body_no_null_space, &
    feti_body_null_space_get => body_null_space_get, &
    feti_body_coordinates => body_coordinates, &
    feti_body_coordinates_flags => body_coordinates_flags, &
    feti_body_fixing_set => body_fixing_set, &
    feti_body_load => body_load
  use feti_contact_stiffness, only: &
    feti_body_stiffness => body_stiffness, &
    feti_body_stiffness_borrow => body_stiffness_borrow, &
    feti_body_stiffness_split => body_stiffness_split, &
    feti_body_values => body_values, &
    feti_body_values_borrow => body_values_borrow, &
    feti_body_values_split => body_values_split
  use feti_contact_elements, only: &
    feti_body_mesh => body_mesh, &
    feti_body_element => body_element, &
    feti_body_elements => body_elements, &
    feti_body_elements_size => body_elements_size, &
    feti_body_held_forces => body_held_forces, &
    feti_body_pieces => body_pieces
  use feti_contact_operators, only: &
    feti_body_operator => body_operator
  use feti_contact_rows, only: &
    feti_rows_add => rows_add, &
    feti_rows_rhs => rows_rhs, &
    feti_rows_compliance => rows_compliance, &
    feti_rows_clear => rows_clear
  use feti_contact_friction, only: &
    feti_friction_add => friction_add, &
    feti_friction_law => friction_law, &
    feti_friction_compliance => friction_compliance, &
    feti_friction_reference => friction_reference, &
    feti_friction_counts => friction_counts, &
    feti_friction_commit => friction_commit, &
    feti_friction_slips => friction_slips, &
    feti_friction_states => friction_states, &
    feti_friction_clear => friction_clear
  use feti_contact_progress, only: &
    feti_on_progress => on_progress, &
    feti_cancel => cancel
  use feti_contact_log, only: &
    feti_on_log => on_log
  use feti_contact_states, only: feti_findings, &
    feti_start_from => start_from, &
    feti_state_save => state_save, &
    feti_state_restore => state_restore, &
    feti_state_drop => state_drop, &
    feti_diagnosis => diagnosis, &
    feti_diagnosis_rows => diagnosis_rows, &
    feti_diagnosis_motion => diagnosis_motion, &
    feti_diagnosis_dependent => diagnosis_dependent, &
    feti_diagnosis_untouched => diagnosis_untouched, &
    feti_diagnosis_undetermined => diagnosis_undetermined, &
    feti_diagnosis_undetermined_motion => diagnosis_undetermined_motion
  use feti_contact_results, only: feti_info, feti_certificate, feti_phase, &
    feti_phase_count => phase_count, &
    feti_phase_at => phase_at, &
    feti_setup => setup, &
    feti_solve => solve, &
    feti_check => check, &
    feti_check_friction => check_friction, &
    feti_counts => counts, &
    feti_displacement => displacement, &
    feti_reaction => reaction, &
    feti_amplitudes => amplitudes, &
    feti_multipliers => multipliers, &
    feti_gaps => gaps, &
    feti_active => active, &
    feti_body_fixing => body_fixing, &
    feti_body_kplus => body_kplus, &
    feti_dual_apply => dual_apply, &
    feti_dual_rhs => dual_rhs
  implicit none
  public
end module
