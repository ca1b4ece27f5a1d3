!> FORTRAN 77 interface: nodes with friction, numbered from 1; values of nodes are (idim, nd). The library copies all
!> arrays. A refused call changes nothing. The force on the bodies is -T'lambda_t; the slip is T u - s_old - C_t lambda_t.
!> See docs/fortran77.md.

!> Adds nd nodes after the existing nodes. nrow(nd): contact row of each node; 0: none. Tangential row i (idim rows per
!> node) holds the entries iptr(i) to iptr(i+1)-1 of ibody, idof and val; iptr(idim*nd+1). coef(nd), no unit, bnd(nd),
!> force. ifirst: the first new node.
recursive subroutine ftfadd(ip, nd, idim, nrow, iptr, ibody, idof, val, coef, bnd, ifirst, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, nd, idim, nrow(*), iptr(*), idof(*)
  integer, intent(in), target :: ibody(*)
  real(c_double), intent(in) :: val(*)
  real(c_double), intent(in), target :: coef(*), bnd(*)
  integer, intent(inout) :: ifirst
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: first

  ierr = told(add_friction(handle(ip), wide(nd), narrow(idim), nrow, iptr, integers(ibody), idof, val, 1_c_int32_t, &
    reals(coef, .true.), reals(bnd, .true.), c_loc(first)), [1, 2, 3, 4, 5, 6, 7, 8, 0, 9, 10, 11])
  if (ierr == FETI_OK) call fit(first + 1, ifirst, ierr)
end subroutine

!> Like the subroutine above, with idof counted consecutively over all bodies.
recursive subroutine ftfadc(ip, nd, idim, nrow, iptr, idof, val, coef, bnd, ifirst, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, nd, idim, nrow(*), iptr(*), idof(*)
  real(c_double), intent(in) :: val(*)
  real(c_double), intent(in), target :: coef(*), bnd(*)
  integer, intent(inout) :: ifirst
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: first

  ierr = told(add_friction(handle(ip), wide(nd), narrow(idim), nrow, iptr, c_null_ptr, idof, val, 1_c_int32_t, &
    reals(coef, .true.), reals(bnd, .true.), c_loc(first)), [1, 2, 3, 4, 5, 0, 6, 7, 0, 8, 9, 10])
  if (ierr == FETI_OK) call fit(first + 1, ifirst, ierr)
end subroutine

!> Replaces the coefficients of the nd nodes from ifirst, coef(nd), no unit.
recursive subroutine ftfcoe(ip, ifirst, nd, coef, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ifirst, nd
  real(c_double), intent(in), target :: coef(*)
  integer, intent(out) :: ierr

  ierr = told(feti_friction_law(handle(ip), from_zero(ifirst), wide(nd), reals(coef, .true.), c_null_ptr))
end subroutine

!> Replaces the bounds of the nd nodes from ifirst, bnd(nd), force.
recursive subroutine ftfbnd(ip, ifirst, nd, bnd, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ifirst, nd
  real(c_double), intent(in), target :: bnd(*)
  integer, intent(out) :: ierr

  ierr = told(feti_friction_law(handle(ip), from_zero(ifirst), wide(nd), c_null_ptr, reals(bnd, .true.)), [1, 2, 3, 0, 4])
end subroutine

!> Makes sticking of the nd nodes from ifirst elastic: ct(nd) = C_t, length / force; 0: rigid.
recursive subroutine ftfcmp(ip, ifirst, nd, ct, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ifirst, nd
  real(c_double), intent(in) :: ct(*)
  integer, intent(out) :: ierr

  ierr = told(feti_friction_compliance(handle(ip), from_zero(ifirst), wide(nd), ct))
end subroutine

!> The reference from which slips of the nd nodes from ifirst are measured: sold(idim,nd), length.
recursive subroutine ftfref(ip, ifirst, nd, idim, sold, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ifirst, nd, idim
  real(c_double), intent(in) :: sold(*)
  integer, intent(out) :: ierr

  ierr = told(feti_friction_reference(handle(ip), from_zero(ifirst), wide(nd), narrow(idim), sold))
end subroutine

!> Ends a load step: sets the reference of the slips to T u - C_t lambda_t of the last answer.
recursive subroutine ftfcom(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_friction_commit(handle(ip)))
end subroutine

!> Number nd of nodes with friction, and idim of tangential rows of each, 1 or 2, 0 without nodes; also after a problem was read.
recursive subroutine ftfcnt(ip, nd, idim, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(inout) :: nd, idim
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: nodes
  integer(c_int32_t), target :: rows

  ierr = told(feti_friction_counts(handle(ip), c_loc(nodes), c_loc(rows)))
  if (ierr == FETI_OK) call fit(nodes, nd, ierr)
  if (ierr == FETI_OK) idim = int(rows)
end subroutine

!> Slips of the nd nodes in the last answer, slip(idim,nd), length; they have the sign of their forces.
recursive subroutine ftfslp(ip, nd, idim, slip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, nd, idim
  real(c_double), intent(inout) :: slip(*)
  integer, intent(out) :: ierr

  ierr = told(feti_friction_slips(handle(ip), wide(nd), narrow(idim), slip))
end subroutine

!> State of the nd nodes: istate(nd) = FTFOPE, FTFSTI, FTFSLI, FTFWEA or FTFUNK (a group of bodies without an answer).
recursive subroutine ftfsta(ip, nd, istate, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, nd
  integer, intent(inout) :: istate(*)
  integer, intent(out) :: ierr
  integer(c_int32_t), allocatable :: found(:)
  integer :: refused

  ierr = FTEMEM
  allocate (found(nd), stat=refused)
  if (refused == 0) ierr = told(feti_friction_states(handle(ip), wide(nd), found))
  if (ierr == FETI_OK) istate(:nd) = int(found)
end subroutine

!> Removes all nodes with friction; their contact rows stay.
recursive subroutine ftfclr(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_friction_clear(handle(ip)))
end subroutine
