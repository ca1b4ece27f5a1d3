!> Solve and results of module feti_contact. A host uses feti_contact, not this module.
!>
!> Sizes are taken from the arrays and compared with the problem. Bodies, unknowns and rows count from 1. Results are
!> written if the status is not negative; a failed call leaves the host's arrays unchanged. `stat` and `errmsg`: see
!> feti_contact_base.
module feti_contact_results
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_loc, c_null_ptr, c_ptr, c_sizeof
  use, intrinsic :: iso_fortran_env, only: int64, real64
  use feti_contact_base, only: body_index, f_text, feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_ALL, FETI_OK, feti_certificate, feti_info, &
    c_active => feti_active, &
    c_amplitudes => feti_amplitudes, &
    c_body_fixing => feti_body_fixing, &
    c_body_kplus => feti_body_kplus, &
    c_check => feti_check, &
    c_check_friction => feti_check_friction, &
    c_counts => feti_counts, &
    c_displacement => feti_displacement, &
    c_dual_apply => feti_dual_apply, &
    c_dual_rhs => feti_dual_rhs, &
    c_gaps => feti_gaps, &
    c_multipliers => feti_multipliers, &
    c_phase => feti_phase, &
    c_phase_at => feti_phase_at, &
    c_phase_count => feti_phase_count, &
    c_reaction => feti_reaction, &
    c_setup => feti_setup, &
    c_solve => feti_solve
  implicit none
  private
  public :: feti_info, feti_certificate
  public :: setup, solve, check, check_friction, counts, feti_phase, phase_count, phase_at
  public :: displacement, reaction, amplitudes, multipliers, gaps, active
  public :: body_fixing, body_kplus, dual_apply, dual_rhs

  !> Time and memory of a phase of a setup or a solve.
  type :: feti_phase
    character(len=:), allocatable :: name
    !> Wall time in the last setup or solve.
    real(real64) :: seconds = 0
    !> Bytes of the data that the phase computed and keeps; 0: not counted.
    integer(int64) :: bytes = 0
  end type

  !> Displacement, length.
  !>
  !> call feti_displacement(p, body, u): u(n) of one body.
  !> call feti_displacement(p, u): u of all bodies, u(number) with the numbers of feti_body_numbering (entries that belong
  !>   to no unknown are left unchanged); without numbers one body after the other. Bodies in a group without an answer
  !>   get NaN; for such a body alone the call returns FETI_STATE.
  interface displacement
    module procedure displacement_one, displacement_all
  end interface

  !> Force of the rows on a body, -B'lambda (kind FETI_INEQUALITY), -H'mu (FETI_EQUALITY), -T'lambda_t (FETI_TANGENTIAL)
  !> or the sum of all (0): K u = f + r.
  !>
  !> call feti_reaction(p, kind, body, r): r(n) on one body.
  !> call feti_reaction(p, kind, r): r on all bodies, arranged as in feti_displacement.
  interface reaction
    module procedure reaction_one, reaction_all
  end interface

  !> Contact forces lambda >= 0 (kind FETI_INEQUALITY), forces mu of the equality rows (FETI_EQUALITY) or lambda_t of the
  !> nodes with friction (FETI_TANGENTIAL), force.
  !>
  !> call feti_multipliers(p, kind, lambda): lambda(rows); for nodes with friction lambda(dim * nodes), node after node.
  !> call feti_multipliers(p, kind, lambda): lambda(dim, nodes), with FETI_TANGENTIAL.
  interface multipliers
    module procedure multipliers_rows, multipliers_nodes
  end interface

  !> State of each contact row, int32 or int64: FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK (closed without a clear
  !> force) or FETI_ROW_UNKNOWN (the bodies that it touches are in a group without an answer).
  interface active
    module procedure active_int32, active_int64
  end interface

contains

  !> Computes null spaces, factors and the dual operator in advance; otherwise feti_solve does so when needed.
  recursive subroutine setup(p, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_setup(handle_of(p)), stat, errmsg)
  end subroutine

  !> Solves the contact problem. info: the work done, and how well the answer satisfies the contact conditions; it is
  !> written for every status. With a positive status the answer is usable but incomplete.
  recursive subroutine solve(p, info, stat, errmsg)
    type(feti_problem), intent(in) :: p
    type(feti_info), intent(inout), optional, target :: info
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: address

    address = c_null_ptr
    if (present(info)) then
      info%struct_size = c_sizeof(info)
      address = c_loc(info)
    end if
    call finish(c_solve(handle_of(p), address), stat, errmsg)
  end subroutine

  !> Number of phases of a setup and a solve.
  recursive subroutine phase_count(p, count, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out) :: count
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found
    integer(c_int32_t) :: status

    found = 0
    status = c_phase_count(handle_of(p), found)
    count = int(found)
    call finish(status, stat, errmsg)
  end subroutine

  !> Phase k, from 1 to the number of phases, in the last setup or solve.
  recursive subroutine phase_at(p, k, phase, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: k
    type(feti_phase), intent(out) :: phase
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_phase) :: found
    integer(c_int32_t) :: status

    found%struct_size = c_sizeof(found)
    status = c_phase_at(handle_of(p), int(k - 1, c_int64_t), found)
    if (status == FETI_OK) then
      phase%name = f_text(found%name)
      phase%seconds = found%seconds
      phase%bytes = found%bytes
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Verifies any answer, also of another program: u (all bodies one after the other, length), lambda (force, one per
  !> contact row), mu (force, one per equality row; may have size 0). Rows and bodies in the certificate count from 1; 0:
  !> none. The tangential forces of nodes with friction count as 0; feti_check_friction takes them into account.
  recursive subroutine check(p, u, lambda, mu, certificate, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(in), contiguous :: u(:), lambda(:), mu(:)
    type(feti_certificate), intent(inout) :: certificate
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    certificate%struct_size = c_sizeof(certificate)
    status = c_check(handle_of(p), size(u, kind=c_int64_t), u, size(lambda, kind=c_int64_t), lambda, &
      size(mu, kind=c_int64_t), mu, certificate)
    if (status >= FETI_OK) call count_from_one(certificate)
    call finish(status, stat, errmsg)
  end subroutine

  !> Works like feti_check, with the tangential forces lambda_t(dim,nodes) of the nodes with friction. Nodes in the
  !> certificate count from 1.
  recursive subroutine check_friction(p, u, lambda, mu, lambda_t, certificate, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(in), contiguous :: u(:), lambda(:), mu(:), lambda_t(:, :)
    type(feti_certificate), intent(inout) :: certificate
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    certificate%struct_size = c_sizeof(certificate)
    status = c_check_friction(handle_of(p), size(u, kind=c_int64_t), u, size(lambda, kind=c_int64_t), lambda, &
      size(mu, kind=c_int64_t), mu, size(lambda_t, 2, c_int64_t), size(lambda_t, 1, c_int32_t), lambda_t, certificate)
    if (status >= FETI_OK) call count_from_one(certificate)
    call finish(status, stat, errmsg)
  end subroutine

  !> Bodies, rows and nodes of a certificate as Fortran counts them.
  recursive subroutine count_from_one(certificate)
    type(feti_certificate), intent(inout) :: certificate

    certificate%equilibrium_body = certificate%equilibrium_body + 1
    certificate%balance_body = certificate%balance_body + 1
    certificate%penetration_row = certificate%penetration_row + 1
    certificate%equality_row = certificate%equality_row + 1
    certificate%force_row = certificate%force_row + 1
    certificate%complementarity_row = certificate%complementarity_row + 1
    certificate%friction_cone_node = certificate%friction_cone_node + 1
    certificate%friction_work_node = certificate%friction_work_node + 1
    certificate%friction_stick_node = certificate%friction_stick_node + 1
  end subroutine

  !> Numbers of bodies, of unknowns of all bodies, of contact rows and of equality rows.
  recursive subroutine counts(p, bodies, dofs, rows, eqs, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: bodies, dofs, rows, eqs
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: count(4)
    integer(c_int32_t) :: status

    count = 0
    status = c_counts(handle_of(p), c_loc(count(1)), c_loc(count(2)), c_loc(count(3)), c_loc(count(4)))
    if (present(bodies)) bodies = int(count(1))
    if (present(dofs)) dofs = int(count(2))
    if (present(rows)) rows = int(count(3))
    if (present(eqs)) eqs = int(count(4))
    call finish(status, stat, errmsg)
  end subroutine

  !> The displacement of one body.
  recursive subroutine displacement_one(p, body, u, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(inout), contiguous :: u(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_displacement(handle_of(p), body_index(body), size(u, kind=c_int64_t), u), stat, errmsg)
  end subroutine

  !> The values of all bodies, with the numbers of the host.
  recursive subroutine displacement_all(p, u, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(inout), contiguous :: u(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_displacement(handle_of(p), FETI_ALL, size(u, kind=c_int64_t), u), stat, errmsg)
  end subroutine

  !> The forces on one body.
  recursive subroutine reaction_one(p, kind, body, r, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, intent(in) :: body
    real(real64), intent(inout), contiguous :: r(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_reaction(handle_of(p), kind, body_index(body), size(r, kind=c_int64_t), r), stat, errmsg)
  end subroutine

  !> The forces on all bodies, with the numbers of the host.
  recursive subroutine reaction_all(p, kind, r, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    real(real64), intent(inout), contiguous :: r(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_reaction(handle_of(p), kind, FETI_ALL, size(r, kind=c_int64_t), r), stat, errmsg)
  end subroutine

  !> Amplitudes alpha(r) of the motions R in the displacement of a body, u = K+(f - B'lambda - H'mu) + R alpha.
  recursive subroutine amplitudes(p, body, alpha, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(inout), contiguous :: alpha(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_amplitudes(handle_of(p), int(body - 1, c_int64_t), size(alpha, kind=c_int64_t), alpha), &
      stat, errmsg)
  end subroutine

  !> The values in one dimension, one after the other.
  recursive subroutine multipliers_rows(p, kind, lambda, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    real(real64), intent(inout), contiguous :: lambda(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_multipliers(handle_of(p), kind, size(lambda, kind=c_int64_t), lambda), &
      stat, errmsg)
  end subroutine

  !> The values of nodes with friction, (dim, nodes).
  recursive subroutine multipliers_nodes(p, kind, lambda, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    real(real64), intent(inout), contiguous :: lambda(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_multipliers(handle_of(p), kind, size(lambda, kind=c_int64_t), lambda), stat, errmsg)
  end subroutine

  !> Remaining gaps c - B u of the contact rows, or c + lambda/k - B u for compliant rows, length.
  recursive subroutine gaps(p, slack, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(inout), contiguous :: slack(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_gaps(handle_of(p), size(slack, kind=c_int64_t), slack), stat, errmsg)
  end subroutine

  !> int32 states.
  recursive subroutine active_int32(p, state, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(inout), contiguous :: state(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_active(handle_of(p), size(state, kind=c_int64_t), state), stat, errmsg)
  end subroutine

  !> int64 states.
  recursive subroutine active_int64(p, state, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(int64), intent(inout) :: state(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t), allocatable :: found(:)
    integer(c_int32_t) :: status

    allocate (found(size(state)))
    status = c_active(handle_of(p), size(found, kind=c_int64_t), found)
    if (status == FETI_OK) state = found
    call finish(status, stat, errmsg)
  end subroutine

  !> The unknowns that K+ holds, dof(r), where r is the dimension of the null space. For validation.
  recursive subroutine body_fixing(p, body, dof, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, intent(inout) :: dof(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(size(dof))
    integer(c_int32_t) :: status

    status = c_body_fixing(handle_of(p), int(body - 1, c_int64_t), size(dof, kind=c_int64_t), found)
    if (status >= FETI_OK) dof = int(found) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> y(n,nrhs) = K+ x(n,nrhs), the generalised inverse (14)-(15) of a body. For validation.
  recursive subroutine body_kplus(p, body, x, y, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: x(:, :)
    real(real64), intent(inout), contiguous :: y(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (any(shape(y) /= shape(x))) then
      call refuse(7, 'feti_body_kplus: x and y differ in shape', stat, errmsg)
    else
      call finish(c_body_kplus(handle_of(p), int(body - 1, c_int64_t), size(x, 1, c_int64_t), &
        size(x, 2, c_int64_t), x, size(x, 1, c_int64_t), y, size(y, 1, c_int64_t)), stat, errmsg)
    end if
  end subroutine

  !> y = F x, F = [B; H] K+ [B; H]' + diag(1/k), contact rows first, in the host's order and scaling. For validation.
  recursive subroutine dual_apply(p, x, y, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(in), contiguous :: x(:)
    real(real64), intent(inout), contiguous :: y(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(y) /= size(x)) then
      call refuse(4, 'feti_dual_apply: x and y differ in size', stat, errmsg)
    else
      call finish(c_dual_apply(handle_of(p), size(x, kind=c_int64_t), x, y), stat, errmsg)
    end if
  end subroutine

  !> d = [B K+ f - c; H K+ f - h], contact rows first, length. For validation.
  recursive subroutine dual_rhs(p, d, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(inout), contiguous :: d(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_dual_rhs(handle_of(p), size(d, kind=c_int64_t), d), stat, errmsg)
  end subroutine

end module
