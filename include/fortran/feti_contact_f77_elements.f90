!> FORTRAN 77 interface: bodies by their elements. Bodies, elements and unknowns count from 1. A refused call changes
!> nothing. See docs/fortran77.md.

!> Connectivity of the ne elements: element e has the entries iptr(e) to iptr(e+1)-1 of idof; iptr(ne+1). A number below 1
!> means a held unknown, whose row and column are left out: 0 means held unknown 1, -1 means held unknown 2. Then give the
!> matrices.
recursive subroutine ftbmsh(ip, ibody, ne, iptr, idof, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, ne, iptr(*), idof(*)
  integer, intent(out) :: ierr

  ierr = told(mesh_of_body(handle(ip), from_zero(ibody), wide(ne), iptr, idof, 1_c_int32_t))
end subroutine

!> Adds the matrix ae(lda,n) of element ie. Give each element once in a pass; the first element after a complete pass
!> begins the next pass.
recursive subroutine ftbelm(ip, ibody, ie, n, ae, lda, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, ie, n, lda
  real(c_double), intent(in) :: ae(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_element(handle(ip), from_zero(ibody), from_zero(ie), wide(n), ae, wide(lda)))
end subroutine

!> Adds the matrices of ne elements, beginning with element ifirst, one after the other in ae. istor: FTFULL, n x n each;
!> FTLOWR or FTUPPR, this triangle column by column.
recursive subroutine ftbels(ip, ibody, ifirst, ne, ae, istor, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, ifirst, ne, istor
  real(c_double), intent(in) :: ae(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_elements(handle(ip), from_zero(ibody), from_zero(ifirst), wide(ne), ae, narrow(istor)))
end subroutine

!> Number of values that ftbels reads from ae.
recursive subroutine ftbesz(ip, ibody, ifirst, ne, istor, nnz, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, ifirst, ne, istor
  integer, intent(inout) :: nnz
  integer, intent(out) :: ierr
  integer(c_int64_t) :: found

  ierr = told(feti_body_elements_size(handle(ip), from_zero(ibody), from_zero(ifirst), wide(ne), narrow(istor), found))
  if (ierr == FETI_OK) call fit(found, nnz, ierr)
end subroutine

!> Forces on the held unknowns 1 to nh in the last answer, r(nh), force.
recursive subroutine ftbhld(ip, ibody, nh, r, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nh
  real(c_double), intent(inout) :: r(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_held_forces(handle(ip), from_zero(ibody), wide(nh), r))
end subroutine

!> Piece of each unknown, ipiece(n), from 1. An unknown of several pieces gets the first one; all are 1 if the body is not
!> cut.
recursive subroutine ftbpcs(ip, ibody, n, ipiece, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n
  integer, intent(inout) :: ipiece(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable :: found(:)
  integer :: refused

  ierr = FTEMEM
  allocate (found(n), stat=refused)
  if (refused == 0) ierr = told(feti_body_pieces(handle(ip), from_zero(ibody), wide(n), found))
  if (ierr == FETI_OK) call fit_all(found + 1, n, ipiece, ierr)
end subroutine
