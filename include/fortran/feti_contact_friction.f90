!> Nodes with friction of module feti_contact. A host uses feti_contact, not this module.
!>
!> A node has a contact row and dim tangential rows T, dim = 1 in the plane and 2 in space. Its tangential force lambda_t
!> acts on the bodies as -T'lambda_t, and its slip is s = T u - s_old - C_t lambda_t. The force is bounded by |lambda_t|
!> <= b = bound + coefficient * lambda_n. The node sticks, s = 0, or slips in the direction of the force, lambda_t = b s /
!> |s|. Values of nodes are (dim, nodes).
!>
!> The library copies all arrays. Nodes, rows, bodies and unknowns count from 1. A refused call leaves the problem
!> unchanged. `stat` and `errmsg`: see feti_contact_base.
module feti_contact_friction
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_loc, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  use feti_contact_base, only: address_of, feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_OK, &
    c_friction_add_i32 => feti_friction_add_i32, &
    c_friction_add_i64 => feti_friction_add_i64, &
    c_friction_clear => feti_friction_clear, &
    c_friction_commit => feti_friction_commit, &
    c_friction_compliance => feti_friction_compliance, &
    c_friction_counts => feti_friction_counts, &
    c_friction_law => feti_friction_law, &
    c_friction_reference => feti_friction_reference, &
    c_friction_slips => feti_friction_slips, &
    c_friction_states => feti_friction_states
  implicit none
  private
  public :: friction_add, friction_law, friction_compliance, friction_reference
  public :: friction_counts, friction_commit, friction_slips, friction_states, friction_clear

  !> Nodes with friction, added after the nodes of earlier calls.
  !>
  !> call feti_friction_add(p, normal_row, row_ptr, body, dof, val, coefficient, bound, first): node k has the contact row
  !>   normal_row(k); 0: no contact row, only the bound acts. Its tangential rows are dim*(k-1)+1 to dim*k; row i holds
  !>   the entries row_ptr(i) .. row_ptr(i+1)-1 of body, dof and val: coefficient val of unknown dof of that body.
  !>   Repeated entries add up.
  !> call feti_friction_add(p, normal_row, row_ptr, dof, val, coefficient, bound, first): dof is the host's number of the
  !>   unknown (feti_body_numbering) or, without such numbers, counts the unknowns of all bodies consecutively.
  !>
  !> row_ptr has dim*nodes + 1 entries, from which dim follows, 1 or 2 and equal for all nodes; normal_row, row_ptr, body
  !> and dof are all int32 or all int64. coefficient (>= 0, no unit) and bound (>= 0, force), one per node; absent: zero.
  !> first: number of the first new node. If the host scales the rows of a node, all of them must have the same factor.
  interface friction_add
    module procedure friction_int32, friction_int64, concatenated_int32, concatenated_int64
  end interface

  !> State of each node in the last answer, int32 or int64: FETI_FRICTION_OPEN (its bound is zero), FETI_FRICTION_STICK,
  !> FETI_FRICTION_SLIP, FETI_FRICTION_WEAK (its force reaches the bound and it does not slip, within rounding error) or
  !> FETI_FRICTION_UNKNOWN (its bodies are in a group without an answer).
  interface friction_states
    module procedure states_int32, states_int64
  end interface

contains

  !> Body and unknown of every entry, int32.
  recursive subroutine friction_int32(p, normal_row, row_ptr, body, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int32), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    integer(int32), intent(in), contiguous, target :: body(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: bodies

    bodies = c_null_ptr
    if (size(body) > 0) bodies = c_loc(body)
    if (size(body) /= size(dof)) then
      call refuse(6, 'feti_friction_add: body and dof differ in size', stat, errmsg)
    else
      call add_int32(p, normal_row, row_ptr, bodies, dof, val, coefficient, bound, first, stat, errmsg)
    end if
  end subroutine

  !> Body and unknown of every entry, int64.
  recursive subroutine friction_int64(p, normal_row, row_ptr, body, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int64), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    integer(int64), intent(in), contiguous, target :: body(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: bodies

    bodies = c_null_ptr
    if (size(body) > 0) bodies = c_loc(body)
    if (size(body) /= size(dof)) then
      call refuse(6, 'feti_friction_add: body and dof differ in size', stat, errmsg)
    else
      call add_int64(p, normal_row, row_ptr, bodies, dof, val, coefficient, bound, first, stat, errmsg)
    end if
  end subroutine

  !> Unknowns counted consecutively over all bodies, or given by the numbers of the host; int32.
  recursive subroutine concatenated_int32(p, normal_row, row_ptr, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int32), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call add_int32(p, normal_row, row_ptr, c_null_ptr, dof, val, coefficient, bound, first, stat, errmsg)
  end subroutine

  !> Like the procedure above, with int64.
  recursive subroutine concatenated_int64(p, normal_row, row_ptr, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int64), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call add_int64(p, normal_row, row_ptr, c_null_ptr, dof, val, coefficient, bound, first, stat, errmsg)
  end subroutine

  !> bodies: address of one body number per entry, or NULL.
  recursive subroutine add_int32(p, normal_row, row_ptr, bodies, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int32), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    type(c_ptr), intent(in) :: bodies
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first, stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: start
    integer(c_int32_t) :: status, dim
    character(len=:), allocatable :: fault
    integer :: entries, k

    entries = 0
    if (size(row_ptr) > 0) entries = row_ptr(size(row_ptr)) - 1
    call compare_sizes(size(normal_row, kind=int64), size(row_ptr, kind=int64) - 1, int(entries, int64), &
      size(dof, kind=int64), size(val, kind=int64), coefficient, bound, dim, k, fault)
    start = -1
    if (len(fault) > 0) then
      call refuse(k, fault, stat, errmsg)
    else
      status = c_friction_add_i32(handle_of(p), size(normal_row, kind=c_int64_t), dim, normal_row, row_ptr, bodies, dof, val, &
        1_c_int32_t, address_of(coefficient), address_of(bound), c_loc(start))
      call finish(status, stat, errmsg)
    end if
    if (present(first)) first = int(start) + 1
  end subroutine

  !> Like the procedure above, for 8-byte integers.
  recursive subroutine add_int64(p, normal_row, row_ptr, bodies, dof, val, coefficient, bound, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int64), intent(in), contiguous :: normal_row(:), row_ptr(:), dof(:)
    type(c_ptr), intent(in) :: bodies
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: first, stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: start
    integer(c_int32_t) :: status, dim
    character(len=:), allocatable :: fault
    integer(int64) :: entries
    integer :: k

    entries = 0
    if (size(row_ptr) > 0) entries = row_ptr(size(row_ptr)) - 1
    call compare_sizes(size(normal_row, kind=int64), size(row_ptr, kind=int64) - 1, entries, size(dof, kind=int64), &
      size(val, kind=int64), coefficient, bound, dim, k, fault)
    start = -1
    if (len(fault) > 0) then
      call refuse(k, fault, stat, errmsg)
    else
      status = c_friction_add_i64(handle_of(p), size(normal_row, kind=c_int64_t), dim, normal_row, row_ptr, bodies, dof, val, &
        1_c_int32_t, address_of(coefficient), address_of(bound), c_loc(start))
      call finish(status, stat, errmsg)
    end if
    if (present(first)) first = int(start) + 1
  end subroutine

  !> dim: tangential rows of a node. fault: describes a mismatch, empty if the arrays match; k: number of the wrong
  !> argument in the C function.
  recursive subroutine compare_sizes(nodes, rows, entries, dofs, vals, coefficient, bound, dim, k, fault)
    integer(int64), intent(in) :: nodes, rows, entries, dofs, vals
    real(real64), intent(in), optional :: coefficient(:), bound(:)
    integer(c_int32_t), intent(out) :: dim
    integer, intent(out) :: k
    character(len=:), allocatable, intent(out) :: fault

    k = 5
    fault = ''
    dim = 1
    if (nodes > 0 .and. rows == 2 * nodes) dim = 2
    if (rows /= dim * nodes) then
      fault = 'feti_friction_add: row_ptr has neither one nor two rows for each node, and one entry more'
    else if (entries > min(dofs, vals)) then
      fault = 'feti_friction_add: row_ptr points behind the end of dof or val'
    else if (present(coefficient)) then
      k = 10
      if (size(coefficient, kind=int64) /= nodes) fault = 'feti_friction_add: coefficient has not one entry per node'
    end if
    if (.not. present(bound) .or. len(fault) > 0) return
    k = 11
    if (size(bound, kind=int64) /= nodes) fault = 'feti_friction_add: bound has not one entry per node'
  end subroutine

  !> New coefficients(:), no unit, bounds(:), force, or both, of the nodes first, first+1, ...; an absent argument leaves
  !> its values unchanged. No new setup is needed.
  recursive subroutine friction_law(p, first, coefficient, bound, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: first
    real(real64), intent(in), contiguous, optional, target :: coefficient(:), bound(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: nodes

    nodes = 0
    if (present(bound)) nodes = size(bound, kind=c_int64_t)
    if (present(coefficient)) then
      if (present(bound) .and. size(coefficient, kind=c_int64_t) /= nodes) then
        call refuse(5, 'feti_friction_law: coefficient and bound differ in size', stat, errmsg)
        return
      end if
      nodes = size(coefficient, kind=c_int64_t)
    end if
    call finish(c_friction_law(handle_of(p), int(first - 1, c_int64_t), nodes, address_of(coefficient), address_of(bound)), &
      stat, errmsg)
  end subroutine

  !> Makes sticking of the nodes first, first+1, ... elastic, s = T u - s_old - C_t lambda_t: inv_kt(:) = C_t >= 0, length
  !> / force, one value per node, 0 for a rigid node. New nodes are rigid. The factors of the bodies stay valid; the last
  !> answer is dropped.
  recursive subroutine friction_compliance(p, first, inv_kt, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: first
    real(real64), intent(in), contiguous :: inv_kt(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_compliance(handle_of(p), int(first - 1, c_int64_t), size(inv_kt, kind=c_int64_t), inv_kt), &
      stat, errmsg)
  end subroutine

  !> The reference from which slips of the nodes first, first+1, ... are measured: s_old(dim,nodes), length, T u - C_t
  !> lambda_t at the beginning of the load step. New nodes have s_old = 0; feti_friction_commit takes s_old from the
  !> answer.
  recursive subroutine friction_reference(p, first, s_old, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: first
    real(real64), intent(in), contiguous :: s_old(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_reference(handle_of(p), int(first - 1, c_int64_t), size(s_old, 2, c_int64_t), &
      size(s_old, 1, c_int32_t), s_old), stat, errmsg)
  end subroutine

  !> Ends a load step: sets s_old to T u - C_t lambda_t of the last answer at every node, including open nodes. The answer
  !> with its slips is unchanged. FETI_STATE if the last answer is not certified, or if there is no answer.
  recursive subroutine friction_commit(p, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_commit(handle_of(p)), stat, errmsg)
  end subroutine

  !> Number of nodes with friction, and of tangential rows of each, 1 or 2, 0 without nodes; also after feti_problem_read.
  recursive subroutine friction_counts(p, nodes, dim, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: nodes, dim
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: found
    integer(c_int32_t), target :: rows
    integer(c_int32_t) :: status

    found = 0
    rows = 0
    status = c_friction_counts(handle_of(p), c_loc(found), c_loc(rows))
    if (present(nodes)) nodes = int(found)
    if (present(dim)) dim = int(rows)
    call finish(status, stat, errmsg)
  end subroutine

  !> Slips s = T u - s_old - C_t lambda_t of the last answer, slip(dim,nodes), length; they have the sign of lambda_t.
  recursive subroutine friction_slips(p, slip, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(inout), contiguous :: slip(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_slips(handle_of(p), size(slip, 2, c_int64_t), size(slip, 1, c_int32_t), slip), stat, errmsg)
  end subroutine

  !> int32 states.
  recursive subroutine states_int32(p, state, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(inout), contiguous :: state(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_states(handle_of(p), size(state, kind=c_int64_t), state), stat, errmsg)
  end subroutine

  !> int64 states.
  recursive subroutine states_int64(p, state, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int64), intent(inout) :: state(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t), allocatable :: found(:)
    integer(c_int32_t) :: status

    allocate (found(size(state)))
    status = c_friction_states(handle_of(p), size(found, kind=c_int64_t), found)
    if (status == FETI_OK) state = found
    call finish(status, stat, errmsg)
  end subroutine

  !> Removes all nodes with friction; their contact rows stay.
  recursive subroutine friction_clear(p, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_friction_clear(handle_of(p)), stat, errmsg)
  end subroutine

end module
