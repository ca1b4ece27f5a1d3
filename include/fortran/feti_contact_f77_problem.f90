!> FORTRAN 77 interface: what is not generated into feti_contact_f77_calls.f90. See docs/fortran77.md. The last argument of
!> almost every subroutine is ierr, the status.

!> Creates a problem: ip, its handle. Texts and positions count from 1. The check words iword = 1, 2 and dword = 1, 2 show
!> the sizes of the host's INTEGER and DOUBLE PRECISION. If they differ from the sizes of this interface, ierr, written in
!> the host's size, is FTEISZ or FTEDSZ, FTERR returns the text, and ip is unchanged.
recursive subroutine ftnew(iword, dword, ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer(c_int32_t), intent(in) :: iword(2)
  integer(c_int64_t), intent(in) :: dword(1)
  integer, intent(inout) :: ip
  integer(c_int32_t), intent(inout) :: ierr(*)
  integer(c_int64_t), parameter :: one = transfer(1.0_c_double, 0_c_int64_t)
  integer(c_int32_t), parameter :: words(2) = transfer(1_c_int64_t, [0_c_int32_t, 0_c_int32_t])
  integer :: bits, status

  bits = 0
  if (all(iword == [1_c_int32_t, 2_c_int32_t])) bits = 32
  if (all(iword == words)) bits = 64
  if (bits /= storage_size(ip)) then
    status = FTEISZ
  else if (dword(1) /= one) then
    status = FTEDSZ
  else
    call create(status)
  end if
  if (bits == 64) then
    ierr(:2) = transfer(int(status, c_int64_t), ierr(:2))
  else
    ierr(1) = int(status, c_int32_t)
  end if

contains

  !> Creates the problem after the sizes have been found to agree; numbers in texts count from 1.
  recursive subroutine create(status)
    integer, intent(out) :: status
    type(c_ptr) :: p
    integer(c_int32_t) :: destroyed

    p = c_null_ptr
    status = int(feti_problem_create(p))
    if (status == FETI_OK) status = int(feti_set_i64(p, c_text('index_base'), 1_c_int64_t))
    if (status == FETI_OK) call fit(int(transfer(p, 0_c_intptr_t), c_int64_t), ip, status)
    if (status /= FETI_OK) destroyed = feti_problem_destroy(p)
  end subroutine

end subroutine

!> Destroys a problem with all its data and sets ip to 0. From then on calls with a copy of ip return FTEHDL.
recursive subroutine ftfree(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(inout) :: ip
  integer, intent(out) :: ierr
  type(c_ptr) :: p

  p = handle(ip)
  ierr = told(feti_problem_destroy(p))
  if (ierr == FETI_OK) ip = 0
end subroutine

!> Text for the status ierr that a subroutine has just returned on this thread; blank for 0.
recursive subroutine fterr(ierr, text)
  use feti_contact_f77_base
  implicit none
  integer(c_int32_t), intent(in) :: ierr(*)
  character(len=*), intent(inout) :: text
  integer(c_int32_t), parameter :: first(2) = transfer(1_c_int64_t, [0_c_int32_t, 0_c_int32_t])
  integer :: status

  ! The half of ierr that has the status, whatever the size of the host's INTEGER; if the first half is the upper one, in
  ! the INTEGER of this interface.
  status = int(ierr(merge(1, storage_size(status) / 32, first(1) == 1)))
  text = ' '
  if (status == FETI_OK) return
  if (status <= FTEISZ .and. status >= FTEFIT) then
    text = own_text(FTEISZ - status + 1)
  else
    call give_last_error(status, text)
    if (text == ' ') text = f_text(feti_status_text(narrow(status)))
  end if
end subroutine

!> Name of a status, such as FETI_LOAD_NOT_HELD for FTELNH.
recursive subroutine ftsnam(istat, text)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: istat
  character(len=*), intent(inout) :: text

  text = f_text(feti_status_name(narrow(istat)))
end subroutine

!> One sentence on a status.
recursive subroutine ftstxt(istat, text)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: istat
  character(len=*), intent(inout) :: text

  if (istat <= FTEISZ .and. istat >= FTEFIT) then
    text = own_text(FTEISZ - istat + 1)
  else
    text = f_text(feti_status_text(narrow(istat)))
  end if
end subroutine

!> Version of the library: text MAJOR.MINOR.PATCH, number 10000 MAJOR + 100 MINOR + PATCH.
recursive subroutine ftvers(text, number)
  use feti_contact_f77_base
  implicit none
  character(len=*), intent(inout) :: text
  integer, intent(out) :: number

  text = f_text(feti_version())
  number = int(feti_version_number())
end subroutine

!> Number of options.
recursive subroutine ftoptn(n)
  use feti_contact_f77_base
  implicit none
  integer, intent(out) :: n

  n = clipped(feti_option_count())
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

!> Gives the stiffness matrix K of a body by its profile with the diagonal diag(n) apart: jp(j) is the position of the last value of
!> column j, and 0 until a column has one, as in FEAP. C: feti_body_stiffness_skyline.
recursive subroutine ftbskd(ip, ibody, n, diag, jp, val, idir, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, jp(*), idir
  real(c_double), intent(in) :: diag(*), val(*)
  integer, intent(out) :: ierr
  integer, allocatable :: ptr(:)
  integer :: columns, refused

  columns = int(readable(ip, max(n, 0)))
  ierr = FTEMEM
  allocate (ptr(columns + 1), stat=refused)
  if (refused /= 0) return
  ptr(1) = 0
  ptr(2:) = jp(:columns)
  ierr = told(feti_body_stiffness_skyline(handle(ip), from_zero(ibody), wide(n), reals(diag, .true.), ptr, val, &
    0_c_int32_t, narrow(idir), FETI_COPY), [1, 2, 3, 4, 5, 6, 0, 7, 0])
end subroutine
