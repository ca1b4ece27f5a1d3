!> FORTRAN 77 interface: contact rows B u <= c (kind FTKINE) and equality rows H u = h (FTKEQU), each kind numbered from
!> 1. The library copies all arrays. A refused call changes nothing. See docs/fortran77.md.

!> Adds m rows after the existing rows of the kind: row i holds the entries iptr(i) to iptr(i+1)-1 of ibody, idof and val,
!> coefficient val of unknown idof of body ibody; iptr(m+1). Repeated entries add up. rhs(m): c or h, length. ifirst: the
!> first new row.
recursive subroutine ftrows(ip, kind, m, iptr, ibody, idof, val, rhs, ifirst, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, m, iptr(*), idof(*)
  integer, intent(in), target :: ibody(*)
  real(c_double), intent(in) :: val(*)
  real(c_double), intent(in), target :: rhs(*)
  integer, intent(inout) :: ifirst
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: first

  ierr = told(add_rows(handle(ip), narrow(kind), wide(m), iptr, integers(ibody), idof, val, 1_c_int32_t, &
    reals(rhs, .true.), c_loc(first)), [1, 2, 3, 4, 5, 6, 7, 0, 8, 9])
  if (ierr == FETI_OK) call fit(first + 1, ifirst, ierr)
end subroutine

!> Like the subroutine above, with idof counted consecutively over all bodies.
recursive subroutine ftrowc(ip, kind, m, iptr, idof, val, rhs, ifirst, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, m, iptr(*), idof(*)
  real(c_double), intent(in) :: val(*)
  real(c_double), intent(in), target :: rhs(*)
  integer, intent(inout) :: ifirst
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: first

  ierr = told(add_rows(handle(ip), narrow(kind), wide(m), iptr, c_null_ptr, idof, val, 1_c_int32_t, &
    reals(rhs, .true.), c_loc(first)), [1, 2, 3, 4, 0, 5, 6, 0, 7, 8])
  if (ierr == FETI_OK) call fit(first + 1, ifirst, ierr)
end subroutine

!> Replaces the right-hand sides of the m rows from ifirst: rhs(m), length.
recursive subroutine ftrrhs(ip, kind, ifirst, m, rhs, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, ifirst, m
  real(c_double), intent(in) :: rhs(*)
  integer, intent(out) :: ierr

  ierr = told(feti_rows_rhs(handle(ip), narrow(kind), from_zero(ifirst), wide(m), rhs))
end subroutine

!> Makes the m rows from ifirst compliant: B u - c <= lambda/k, cinv(m) = 1/k, length / force; 0: rigid.
recursive subroutine ftrcmp(ip, kind, ifirst, m, cinv, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, ifirst, m
  real(c_double), intent(in) :: cinv(*)
  integer, intent(out) :: ierr

  ierr = told(feti_rows_compliance(handle(ip), narrow(kind), from_zero(ifirst), wide(m), cinv))
end subroutine

!> Removes all rows of a kind; removing the contact rows also removes all nodes with friction.
recursive subroutine ftrclr(ip, kind, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind
  integer, intent(out) :: ierr

  ierr = told(feti_rows_clear(handle(ip), narrow(kind)))
end subroutine
