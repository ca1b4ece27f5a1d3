!> FORTRAN 77 interface: solve and results. Results are written if the status is not negative; a failed call leaves the
!> host's arrays unchanged. See docs/fortran77.md.

!> Computes null spaces, factors and the dual operator in advance; otherwise FTSOLV does so when needed.
recursive subroutine ftstup(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_setup(handle(ip)))
end subroutine

!> Solves the problem. info(ni), rinfo(nr): the report, positions FTISTA to FTISTR, FTRWOR to FTRSTK, as many as fit; it
!> is written for every status.
recursive subroutine ftsolv(ip, ni, info, nr, rinfo, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ni, nr
  integer, intent(inout) :: info(*)
  real(c_double), intent(inout) :: rinfo(*)
  integer, intent(out) :: ierr
  type(feti_info), target :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_solve(handle(ip), c_loc(found)))
  call give([int(found%status, c_int64_t), found%bodies, found%dofs, found%rows, found%equalities, found%floating_modes, &
    found%active, found%undetermined, found%steps, found%cg_steps, found%expansions, found%releases, &
    found%dual_applications, found%coarse_solves, found%factorisations, found%analyses, found%direct_solves, &
    found%finished, found%explicit_operators, found%implicit_operators, found%columns_computed, found%columns_kept, &
    found%nodes, found%sticking, found%slipping, found%friction_steps, found%friction_starts], ni, info)
  call give_reals([found%worst, found%equilibrium, found%balance, found%penetration, found%equality, &
    found%negative_force, found%complementarity, found%duality_gap, found%energy, found%seconds_setup, &
    found%seconds_solve, real(found%factor_bytes, c_double), real(found%operator_bytes, c_double), &
    found%friction_cone, found%friction_work, found%friction_stick], nr, rinfo)
end subroutine

!> Verifies any answer, also of another program: u(n) of all bodies, rlam(m), rmu(me). icert(ni), rcert(nr): positions
!> FTVPAS to FTVSTK, FTRWOR to FTRGAP, FTRLIM and FTVRCO to FTVRST. The tangential forces of nodes with friction count as
!> 0.
recursive subroutine ftchk(ip, n, u, m, rlam, me, rmu, ni, icert, nr, rcert, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, n, m, me, ni, nr
  real(c_double), intent(in) :: u(*), rlam(*), rmu(*)
  integer, intent(inout) :: icert(*)
  real(c_double), intent(inout) :: rcert(*)
  integer, intent(out) :: ierr
  type(feti_certificate) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_check(handle(ip), wide(n), u, wide(m), rlam, wide(me), rmu, found))
  if (ierr >= FETI_OK) call give_certificate(found, ni, icert, nr, rcert)
end subroutine

!> Works like ftchk, with the tangential forces rlt(idim,nd) of the nd nodes with friction.
recursive subroutine ftchkf(ip, n, u, m, rlam, me, rmu, nd, idim, rlt, ni, icert, nr, rcert, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, n, m, me, nd, idim, ni, nr
  real(c_double), intent(in) :: u(*), rlam(*), rmu(*), rlt(*)
  integer, intent(inout) :: icert(*)
  real(c_double), intent(inout) :: rcert(*)
  integer, intent(out) :: ierr
  type(feti_certificate) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_check_friction(handle(ip), wide(n), u, wide(m), rlam, wide(me), rmu, wide(nd), narrow(idim), rlt, found))
  if (ierr >= FETI_OK) call give_certificate(found, ni, icert, nr, rcert)
end subroutine

!> Numbers of bodies, of unknowns of all bodies, of contact rows, of equality rows.
recursive subroutine ftcnts(ip, nbody, n, m, me, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(inout) :: nbody, n, m, me
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: count(4)
  integer :: numbers(4)

  ierr = told(feti_counts(handle(ip), c_loc(count(1)), c_loc(count(2)), c_loc(count(3)), c_loc(count(4))))
  if (ierr == FETI_OK) call fit_all(count, 4, numbers, ierr)
  if (ierr /= FETI_OK) return
  nbody = numbers(1)
  n = numbers(2)
  m = numbers(3)
  me = numbers(4)
end subroutine

!> Displacement of a body, u(n), length; ibody = FTALL: of all bodies, in the host's numbers. ftreac also accepts FTALL.
recursive subroutine ftdisp(ip, ibody, n, u, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n
  real(c_double), intent(inout) :: u(*)
  integer, intent(out) :: ierr

  ierr = told(feti_displacement(handle(ip), body_or_all(ibody), wide(n), u))
end subroutine

!> Force of the rows of a kind (0: all) on a body, r(n): K u = f + r.
recursive subroutine ftreac(ip, kind, ibody, n, r, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, ibody, n
  real(c_double), intent(inout) :: r(*)
  integer, intent(out) :: ierr

  ierr = told(feti_reaction(handle(ip), narrow(kind), body_or_all(ibody), wide(n), r))
end subroutine

!> Amplitudes alpha(nr) of the null space in the displacement of a body.
recursive subroutine ftampl(ip, ibody, nr, alpha, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nr
  real(c_double), intent(inout) :: alpha(*)
  integer, intent(out) :: ierr

  ierr = told(feti_amplitudes(handle(ip), from_zero(ibody), wide(nr), alpha))
end subroutine

!> Multipliers of the m rows of a kind, rlam(m), force; >= 0 for contact rows. Kind FTKTAN has idim rows per node.
recursive subroutine ftmult(ip, kind, m, rlam, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, m
  real(c_double), intent(inout) :: rlam(*)
  integer, intent(out) :: ierr

  ierr = told(feti_multipliers(handle(ip), narrow(kind), wide(m), rlam))
end subroutine

!> Remaining gaps c - B u of the m contact rows, or c + lambda/k - B u for compliant rows; gap(m), length.
recursive subroutine ftgaps(ip, m, gap, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, m
  real(c_double), intent(inout) :: gap(*)
  integer, intent(out) :: ierr

  ierr = told(feti_gaps(handle(ip), wide(m), gap))
end subroutine

!> State of the m contact rows: istate(m) = FTOPEN, FTCLOS, FTWEAK or FTUNKN (a group of bodies without an answer).
recursive subroutine ftactv(ip, m, istate, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, m
  integer, intent(inout) :: istate(*)
  integer, intent(out) :: ierr
  integer(c_int32_t), allocatable :: found(:)
  integer :: refused

  ierr = FTEMEM
  allocate (found(m), stat=refused)
  if (refused == 0) ierr = told(feti_active(handle(ip), wide(m), found))
  if (ierr == FETI_OK) istate(:m) = int(found)
end subroutine

!> y(m) = F x(m), contact rows first, m rows of both kinds; x and y may be the same array.
recursive subroutine ftdapp(ip, m, x, y, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, m
  real(c_double), intent(in) :: x(*)
  real(c_double), intent(inout) :: y(*)
  integer, intent(out) :: ierr

  ierr = told(feti_dual_apply(handle(ip), wide(m), x, y))
end subroutine

!> d(m) = [B K+ f - c; H K+ f - h], length.
recursive subroutine ftdrhs(ip, m, d, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, m
  real(c_double), intent(inout) :: d(*)
  integer, intent(out) :: ierr

  ierr = told(feti_dual_rhs(handle(ip), wide(m), d))
end subroutine

!> Number of phases of a setup and a solve.
recursive subroutine ftphsn(ip, n, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(inout) :: n
  integer, intent(out) :: ierr
  integer(c_int64_t) :: count

  ierr = told(feti_phase_count(handle(ip), count))
  if (ierr == FETI_OK) call fit(count, n, ierr)
end subroutine

!> Phase k, from 1: name, seconds in the last setup or solve, bytes of the data that the phase computed and keeps.
recursive subroutine ftphas(ip, k, name, secs, bytes, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, k
  character(len=*), intent(inout) :: name
  real(c_double), intent(inout) :: secs, bytes
  integer, intent(out) :: ierr
  type(feti_phase) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_phase_at(handle(ip), from_zero(k), found))
  if (ierr /= FETI_OK) return
  name = f_text(found%name)
  secs = found%seconds
  bytes = real(found%bytes, c_double)
end subroutine
