!> FORTRAN 77 interface: bodies. The library copies all arrays; bodies and unknowns count from 1. A refused call changes
!> nothing. See docs/fortran77.md.

!> Adds a body with n unknowns; ibody: its number.
recursive subroutine ftbadd(ip, n, ibody, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, n
  integer, intent(inout) :: ibody
  integer, intent(out) :: ierr
  integer(c_int64_t) :: id

  ierr = told(feti_body_add(handle(ip), wide(n), id))
  if (ierr == FETI_OK) call fit(id + 1, ibody, ierr)
end subroutine

!> Stiffness by rows, n x n, force / length: row i holds the entries iptr(i) to iptr(i+1)-1 of icol and val; iptr(n+1).
!> istor: FTFULL, FTLOWR (columns <= row) or FTUPPR; use FTUPPR for a lower triangle by columns.
recursive subroutine ftbstf(ip, ibody, n, iptr, icol, val, istor, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, iptr(*), icol(*), istor
  real(c_double), intent(in) :: val(*)
  integer, intent(out) :: ierr

  ierr = told(stiffness_by_rows(handle(ip), from_zero(ibody), wide(n), iptr, icol, val, 1_c_int32_t, narrow(istor), &
    FETI_COPY), [1, 2, 3, 4, 5, 6, 0, 7, 0])
end subroutine

!> Stiffness as a dense matrix a(lda,n); with FTLOWR and FTUPPR the other triangle is not read.
recursive subroutine ftbdns(ip, ibody, n, a, lda, istor, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, lda, istor
  real(c_double), intent(in) :: a(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_stiffness_dense(handle(ip), from_zero(ibody), wide(n), a, wide(lda), narrow(istor), FETI_COPY))
end subroutine

!> Stiffness by rows with a separate diagonal diag(n), and the off-diagonal entries in iptr, icol, val.
recursive subroutine ftbspl(ip, ibody, n, diag, iptr, icol, val, istor, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, iptr(*), icol(*), istor
  real(c_double), intent(in) :: diag(*), val(*)
  integer, intent(out) :: ierr

  ierr = told(stiffness_split(handle(ip), from_zero(ibody), wide(n), diag, iptr, icol, val, 1_c_int32_t, narrow(istor), &
    FETI_COPY), [1, 2, 3, 4, 5, 6, 7, 0, 8, 0])
end subroutine

!> New values for the pattern of ftbspl: diag(n), val(nnz).
recursive subroutine ftbvsp(ip, ibody, n, diag, nnz, val, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, nnz
  real(c_double), intent(in) :: diag(*), val(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_values_split(handle(ip), from_zero(ibody), wide(n), diag, wide(nnz), val))
end subroutine

!> Connected part of each unknown, icomp(n), from 1.
recursive subroutine ftbcmp(ip, ibody, n, icomp, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n
  integer, intent(inout) :: icomp(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable :: found(:)
  integer :: refused

  ierr = FTEMEM
  allocate (found(n), stat=refused)
  if (refused == 0) ierr = told(feti_body_components(handle(ip), from_zero(ibody), wide(n), found))
  if (ierr == FETI_OK) call fit_all(found + 1, n, icomp, ierr)
end subroutine

!> The host's own numbers of the unknowns of a body, inum(n), from 1, different for all unknowns of all bodies.
recursive subroutine ftbnum(ip, ibody, n, inum, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, inum(*)
  integer, intent(out) :: ierr

  ierr = told(numbering(handle(ip), from_zero(ibody), wide(n), inum, 1_c_int32_t))
end subroutine

!> New values for the pattern of ftbstf, val(nnz) in the same order; they cost a numeric factorisation but no analysis.
recursive subroutine ftbval(ip, ibody, nnz, val, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nnz
  real(c_double), intent(in) :: val(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_values(handle(ip), from_zero(ibody), wide(nnz), val))
end subroutine

!> New values for a dense matrix, a(lda,n), in the storage of ftbdns.
recursive subroutine ftbvdn(ip, ibody, n, a, lda, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, lda
  real(c_double), intent(in) :: a(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_values_dense(handle(ip), from_zero(ibody), wide(n), a, wide(lda)))
end subroutine

!> Null space r(ldr,nr) of a body. iflag: FTEXCT, the columns span the null space (nr = 0: K is not singular, r is not
!> read); FTCAND, the null space lies in their span; FTSOFT, they are motions that K resists weakly.
recursive subroutine ftbnul(ip, ibody, nr, n, r, ldr, iflag, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nr, n, ldr, iflag
  real(c_double), intent(in), target :: r(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_null_space(handle(ip), from_zero(ibody), wide(nr), wide(n), reals(r, nr /= 0), wide(ldr), &
    narrow(iflag)))
end subroutine

!> The body has no null space: its supports hold it, K is not singular.
recursive subroutine ftbreg(ip, ibody, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody
  integer, intent(out) :: ierr

  ierr = told(feti_body_no_null_space(handle(ip), from_zero(ibody)))
end subroutine

!> Reads the null space that the library uses into r(ldr,nr). nr in: columns of r; 0: only the dimension is returned and r
!> is unchanged; out: the dimension.
recursive subroutine ftbnug(ip, ibody, n, nr, r, ldr, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, ldr
  integer, intent(inout) :: nr
  real(c_double), intent(inout), target :: r(*)
  integer, intent(out) :: ierr
  integer(c_int64_t) :: columns

  columns = wide(nr)
  ierr = told(feti_body_null_space_get(handle(ip), from_zero(ibody), wide(n), columns, reals(r, nr /= 0), wide(ldr)))
  if (ierr == FETI_OK) call fit(columns, nr, ierr)
end subroutine

!> Positions of the unknowns: node(n), any label of 32 bits, equal for the unknowns of one node; idir(n), 1 to 3
!> displacement, 4 to 6 rotation; xyz(ldx,n), the first idim numbers of a column, length.
recursive subroutine ftbxyz(ip, ibody, idim, n, node, idir, xyz, ldx, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, idim, n, node(*), idir(*), ldx
  real(c_double), intent(in) :: xyz(*)
  integer, intent(out) :: ierr
  integer(c_int32_t), allocatable :: nodes(:), directions(:)
  integer :: i, refused

  allocate (nodes(readable(ip, n)), directions(readable(ip, n)), stat=refused)
  if (refused /= 0) then
    ierr = FTEMEM
    return
  end if
  ierr = FETI_OK
  do i = 1, size(nodes)
    nodes(i) = narrow(node(i))
    directions(i) = narrow(idir(i))
    if (int(nodes(i), c_int64_t) /= wide(node(i))) ierr = FTEFIT
  end do
  if (ierr == FETI_OK) ierr = told(feti_body_coordinates(handle(ip), from_zero(ibody), narrow(idim), wide(n), nodes, &
    directions, xyz, wide(ldx)))
end subroutine

!> How the library uses the rigid body motions of these positions. iflag: FTCAND, as candidates for the null space (the
!> default); FTSOFT, as motions that K resists weakly.
recursive subroutine ftbxyf(ip, ibody, iflag, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, iflag
  integer, intent(out) :: ierr

  ierr = told(feti_body_coordinates_flags(handle(ip), from_zero(ibody), narrow(iflag)))
end subroutine

!> Load of a body, f(n), force; it stays valid until the next call. ibody = FTALL: load of all bodies, in the host's
!> numbers.
recursive subroutine ftblod(ip, ibody, n, f, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n
  real(c_double), intent(in) :: f(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_load(handle(ip), body_or_all(ibody), wide(n), f))
end subroutine

!> Reads the unknowns that K+ holds, idof(nr), where nr is the dimension of the null space.
recursive subroutine ftbfix(ip, ibody, nr, idof, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nr
  integer, intent(inout) :: idof(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable :: found(:)
  integer :: refused

  ierr = FTEMEM
  allocate (found(nr), stat=refused)
  if (refused == 0) ierr = told(feti_body_fixing(handle(ip), from_zero(ibody), wide(nr), found))
  if (ierr == FETI_OK) call fit_all(found + 1, nr, idof, ierr)
end subroutine

!> Chooses the unknowns that K+ holds: idof(nr); nr = 0: the library chooses them again.
recursive subroutine ftbfxs(ip, ibody, nr, idof, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, nr, idof(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable, target :: numbers(:)
  integer :: refused

  ierr = FTEMEM
  allocate (numbers(max(nr, 1)), stat=refused)
  if (refused /= 0) return
  numbers = 0
  if (nr > 0) numbers(:nr) = int(idof(:nr), c_int64_t) - 1
  ierr = told(feti_body_fixing_set(handle(ip), from_zero(ibody), wide(nr), c_loc(numbers)))
end subroutine

!> y(ldy,nrhs) = K+ x(ldx,nrhs), the generalised inverse of a body; x and y may be the same array.
recursive subroutine ftbkpl(ip, ibody, n, nrhs, x, ldx, y, ldy, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, nrhs, ldx, ldy
  real(c_double), intent(in) :: x(*)
  real(c_double), intent(inout) :: y(*)
  integer, intent(out) :: ierr

  ierr = told(feti_body_kplus(handle(ip), from_zero(ibody), wide(n), wide(nrhs), x, wide(ldx), y, wide(ldy)))
end subroutine

!> Input of a body and results of its last setup: ifact(ni), rfact(nr), positions FTBUNK to FTBPCE, FTBENT to FTBSRN; -1
!> or NaN: not known yet.
recursive subroutine ftbinf(ip, ibody, ni, ifact, nr, rfact, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, ni, nr
  integer, intent(inout) :: ifact(*)
  real(c_double), intent(inout) :: rfact(*)
  integer, intent(out) :: ierr
  type(feti_body_facts) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_body_info(handle(ip), from_zero(ibody), found))
  if (ierr /= FETI_OK) return
  call give([found%unknowns, found%components, found%origin, found%null_space, found%shared_with + 1, &
    found%explicit_operator, found%soft_free, found%soft_held, found%pieces], ni, ifact)
  call give_reals([real(found%entries, c_double), real(found%matrix_bytes, c_double), real(found%factor_entries, c_double), &
    real(found%factor_bytes, c_double), real(found%operator_bytes, c_double), found%gap, found%force_error, found%softness, &
    found%softness_of_rounding], nr, rfact)
end subroutine
