!> FORTRAN 77 interface: start values, saved states, diagnosis. Bodies, unknowns, rows, motions and states count from 1;
!> 0: none. See docs/fortran77.md.

!> Start values for the next solve only: multipliers of the m rows of a kind, rlam(m), force. Kind FTKTAN has idim rows
!> per node.
recursive subroutine ftstrt(ip, kind, m, rlam, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, m
  real(c_double), intent(in) :: rlam(*)
  integer, intent(out) :: ierr

  ierr = told(feti_start_from(handle(ip), narrow(kind), wide(m), rlam))
end subroutine

!> Saves loads, gaps, friction, multipliers and contact state; id: the number of the state.
recursive subroutine ftssav(ip, id, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(inout) :: id
  integer, intent(out) :: ierr
  integer(c_int64_t) :: number

  ierr = told(feti_state_save(handle(ip), number))
  if (ierr == FETI_OK) call fit(number + 1, id, ierr)
end subroutine

!> Goes back to state id, which stays saved.
recursive subroutine ftsres(ip, id, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, id
  integer, intent(out) :: ierr

  ierr = told(feti_state_restore(handle(ip), from_zero(id)))
end subroutine

!> Drops state id.
recursive subroutine ftsdrp(ip, id, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, id
  integer, intent(out) :: ierr

  ierr = told(feti_state_drop(handle(ip), from_zero(id)))
end subroutine

!> What the last solve, or the last failed setup, found out: idiag(ni) and rdiag(nr), positions FTGSTA to FTGDBD, FTGMAR,
!> FTGMOT to FTGMOT + 5, FTGUNH and FTGCAP.
recursive subroutine ftdiag(ip, ni, idiag, nr, rdiag, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ni, nr
  integer, intent(inout) :: idiag(*)
  real(c_double), intent(inout) :: rdiag(*)
  integer, intent(out) :: ierr
  type(feti_findings) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_diagnosis(handle(ip), found))
  if (ierr /= FETI_OK) return
  call give([int(found%status, c_int64_t), int(found%kind, c_int64_t), found%body + 1, found%component + 1, found%dof + 1, &
    found%row + 1, found%rows_involved, found%undetermined, found%redundant_rows, found%untouched_bodies, &
    found%untouched_body + 1, found%doubtful_bodies, found%doubtful_body + 1], ni, idiag)
  call give_reals([found%margin, found%motion, found%unheld, found%capacity], nr, rdiag)
end subroutine

!> Rows of a kind that contradict each other, with their weights, or without a contradiction the redundant rows: n is the
!> number of rows; the first icap are in irow and w.
recursive subroutine ftdrow(ip, kind, icap, n, irow, w, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, kind, icap
  integer, intent(inout) :: n, irow(*)
  real(c_double), intent(inout), target :: w(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable, target :: found(:)
  integer(c_int64_t) :: count
  integer :: refused

  ierr = FTEMEM
  allocate (found(max(icap, 1)), stat=refused)
  if (refused == 0) ierr = told(feti_diagnosis_rows(handle(ip), narrow(kind), wide(icap), count, c_loc(found), &
    reals(w, icap > 0)))
  if (ierr == FETI_OK) call fit_list(count, icap, found, n, irow, ierr)
end subroutine

!> Equality rows that are linear combinations of the other equality rows: n is the number of rows; the first icap are in
!> irow.
recursive subroutine ftddep(ip, icap, n, irow, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, icap
  integer, intent(inout) :: n, irow(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable, target :: found(:)
  integer(c_int64_t) :: count
  integer :: refused

  ierr = FTEMEM
  allocate (found(max(icap, 1)), stat=refused)
  if (refused == 0) ierr = told(feti_diagnosis_dependent(handle(ip), wide(icap), count, c_loc(found)))
  if (ierr == FETI_OK) call fit_list(count, icap, found, n, irow, ierr)
end subroutine

!> Bodies that no row touches: n is the number of bodies; the first icap are in ibody.
recursive subroutine ftdunt(ip, icap, n, ibody, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, icap
  integer, intent(inout) :: n, ibody(*)
  integer, intent(out) :: ierr
  integer(c_int64_t), allocatable, target :: found(:)
  integer(c_int64_t) :: count
  integer :: refused

  ierr = FTEMEM
  allocate (found(max(icap, 1)), stat=refused)
  if (refused == 0) ierr = told(feti_diagnosis_untouched(handle(ip), wide(icap), count, c_loc(found)))
  if (ierr == FETI_OK) call fit_list(count, icap, found, n, ibody, ierr)
end subroutine

!> Motion k that the last answer leaves undetermined: the body ibody that moves fastest, and rmotn(6), velocity of the
!> origin and rotation about the axes; NaN without coordinates.
recursive subroutine ftdund(ip, k, ibody, rmotn, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, k
  integer, intent(inout) :: ibody
  real(c_double), intent(inout), target :: rmotn(6)
  integer, intent(out) :: ierr
  integer(c_int64_t), target :: body

  ierr = told(feti_diagnosis_undetermined(handle(ip), from_zero(k), c_loc(body), reals(rmotn, .true.)))
  if (ierr == FETI_OK) call fit(body + 1, ibody, ierr)
end subroutine

!> Motion k of the undetermined motions on one body, v(n), scaled to a largest entry of 1 over all bodies.
recursive subroutine ftdunm(ip, k, ibody, n, v, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, k, ibody, n
  real(c_double), intent(inout) :: v(*)
  integer, intent(out) :: ierr

  ierr = told(feti_diagnosis_undetermined_motion(handle(ip), from_zero(k), from_zero(ibody), wide(n), v))
end subroutine

!> Motion with which a body escapes, v(n), scaled to a largest entry of 1 over all bodies; after FTELNH.
recursive subroutine ftdmot(ip, ibody, n, v, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n
  real(c_double), intent(inout) :: v(*)
  integer, intent(out) :: ierr

  ierr = told(feti_diagnosis_motion(handle(ip), from_zero(ibody), wide(n), v))
end subroutine
