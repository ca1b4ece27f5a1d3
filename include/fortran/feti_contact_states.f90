!> Starts, saved states and diagnosis of module feti_contact. A host uses feti_contact, not this module.
!> `stat` and `errmsg`: see feti_contact_base.
module feti_contact_states
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_loc, c_null_ptr, c_sizeof
  use, intrinsic :: iso_fortran_env, only: real64
  use feti_contact_base, only: feti_problem, finish, handle_of
  use feti_contact_c, only: FETI_OK, feti_findings, &
    c_diagnosis => feti_diagnosis, &
    c_diagnosis_motion => feti_diagnosis_motion, &
    c_diagnosis_dependent => feti_diagnosis_dependent, &
    c_diagnosis_untouched => feti_diagnosis_untouched, &
    c_diagnosis_undetermined => feti_diagnosis_undetermined, &
    c_diagnosis_undetermined_motion => feti_diagnosis_undetermined_motion, &
    c_diagnosis_rows => feti_diagnosis_rows, &
    c_start_from => feti_start_from, &
    c_state_drop => feti_state_drop, &
    c_state_restore => feti_state_restore, &
    c_state_save => feti_state_save
  implicit none
  private
  public :: feti_findings
  public :: start_from, state_save, state_restore, state_drop
  public :: diagnosis, diagnosis_rows, diagnosis_motion
  public :: diagnosis_dependent, diagnosis_untouched, diagnosis_undetermined, diagnosis_undetermined_motion

  !> Start values for the next solve only: lambda of kind FETI_INEQUALITY, mu of FETI_EQUALITY or lambda_t of
  !> FETI_TANGENTIAL, force. Rows with a zero start without a force. A change of rows or bodies drops the start values.
  !>
  !> call feti_start_from(p, kind, lambda): lambda(rows); for nodes with friction lambda(dim * nodes), node after node.
  !> call feti_start_from(p, kind, lambda): lambda(dim, nodes), with FETI_TANGENTIAL.
  interface start_from
    module procedure start_from_rows, start_from_nodes
  end interface

contains

  !> The values of nodes with friction, (dim, nodes).
  recursive subroutine start_from_nodes(p, kind, lambda, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    real(real64), intent(in), contiguous :: lambda(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_start_from(handle_of(p), kind, size(lambda, kind=c_int64_t), lambda), stat, errmsg)
  end subroutine

  !> The values in one dimension, one after the other.
  recursive subroutine start_from_rows(p, kind, lambda, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    real(real64), intent(in), contiguous :: lambda(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_start_from(handle_of(p), kind, size(lambda, kind=c_int64_t), lambda), stat, errmsg)
  end subroutine

  !> Saves loads, rows, friction, multipliers and contact state under the number id (from 1).
  recursive subroutine state_save(p, id, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(inout) :: id
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: number
    integer(c_int32_t) :: status

    status = c_state_save(handle_of(p), number)
    if (status == FETI_OK) id = int(number) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Goes back to a saved state, which stays saved: loads, rows with their gaps and compliances, friction with its laws
  !> and s_old. FETI_STATE if bodies were added since the state was saved.
  recursive subroutine state_restore(p, id, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: id
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_state_restore(handle_of(p), int(id - 1, c_int64_t)), stat, errmsg)
  end subroutine

  !> Drops a saved state.
  recursive subroutine state_drop(p, id, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: id
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_state_drop(handle_of(p), int(id - 1, c_int64_t)), stat, errmsg)
  end subroutine

  !> What the last solve, or the last failed setup, found out: the body that escapes and its motion, rows that contradict
  !> each other, undetermined motions. Bodies, unknowns and rows count from 1; 0: none.
  recursive subroutine diagnosis(p, findings, stat, errmsg)
    type(feti_problem), intent(in) :: p
    type(feti_findings), intent(inout) :: findings
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    findings%struct_size = c_sizeof(findings)
    status = c_diagnosis(handle_of(p), findings)
    if (status == FETI_OK) then
      findings%body = findings%body + 1
      findings%component = findings%component + 1
      findings%dof = findings%dof + 1
      findings%row = findings%row + 1
      findings%untouched_body = findings%untouched_body + 1
      findings%doubtful_body = findings%doubtful_body + 1
      findings%soft_body = findings%soft_body + 1
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Rows of one kind that contradict each other, with their weights w: over both kinds sum w b = 0 and sum w c < 0.
  !> Without a contradiction the redundant rows, each with its factor relative to the row that it repeats.
  recursive subroutine diagnosis_rows(p, kind, row, weight, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, allocatable, intent(out) :: row(:)
    real(real64), allocatable, intent(out) :: weight(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    real(real64), allocatable, target :: found(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = c_diagnosis_rows(handle_of(p), kind, 0_c_int64_t, count, c_null_ptr, c_null_ptr)
    cap = count
    allocate (number(cap + 1), found(cap + 1))
    if (status == FETI_OK) status = c_diagnosis_rows(handle_of(p), kind, cap, count, c_loc(number), c_loc(found))
    row = int(number(:cap)) + 1
    weight = found(:cap)
    call finish(status, stat, errmsg)
  end subroutine

  !> Equality rows that are linear combinations of the other equality rows.
  recursive subroutine diagnosis_dependent(p, row, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, allocatable, intent(out) :: row(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = c_diagnosis_dependent(handle_of(p), 0_c_int64_t, count, c_null_ptr)
    cap = count
    allocate (number(cap + 1))
    if (status == FETI_OK) status = c_diagnosis_dependent(handle_of(p), cap, count, c_loc(number))
    row = int(number(:cap)) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Bodies that no row touches.
  recursive subroutine diagnosis_untouched(p, body, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, allocatable, intent(out) :: body(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = c_diagnosis_untouched(handle_of(p), 0_c_int64_t, count, c_null_ptr)
    cap = count
    allocate (number(cap + 1))
    if (status == FETI_OK) status = c_diagnosis_untouched(handle_of(p), cap, count, c_loc(number))
    body = int(number(:cap)) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Rigid body motion k among the motions that the last answer leaves undetermined: the body that moves fastest, and its
  !> motion(6), velocity of the origin and rotation about the axes; NaN without coordinates.
  recursive subroutine diagnosis_undetermined(p, k, body, motion, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: k
    integer, intent(out) :: body
    real(real64), intent(out) :: motion(6)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: fastest
    real(real64), target :: found(6)
    integer(c_int32_t) :: status

    fastest = -1
    found = 0
    status = c_diagnosis_undetermined(handle_of(p), int(k - 1, c_int64_t), c_loc(fastest), c_loc(found))
    body = int(fastest) + 1
    motion = found
    call finish(status, stat, errmsg)
  end subroutine

  !> Rigid body motion k of the undetermined motions on one body, v(n), scaled to a largest entry of 1 over all bodies.
  recursive subroutine diagnosis_undetermined_motion(p, k, body, v, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: k, body
    real(real64), intent(inout), contiguous :: v(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_diagnosis_undetermined_motion(handle_of(p), int(k - 1, c_int64_t), int(body - 1, c_int64_t), &
      size(v, kind=c_int64_t), v), stat, errmsg)
  end subroutine

  !> Rigid body motion with which a body escapes, v(n), scaled to a largest entry of 1 over all bodies; after
  !> FETI_LOAD_NOT_HELD, or after FETI_INDEFINITE because of a motion with negative stiffness.
  recursive subroutine diagnosis_motion(p, body, v, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(inout), contiguous :: v(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_diagnosis_motion(handle_of(p), int(body - 1, c_int64_t), size(v, kind=c_int64_t), v), stat, errmsg)
  end subroutine

end module
