!> FORTRAN 77 face: a problem as a file. See docs/fortran77.md.

!> Writes all that has been given to the problem to the file path; an old one is replaced.
recursive subroutine ftwrit(ip, path, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: path
  integer, intent(out) :: ierr

  ierr = told(feti_problem_write(handle(ip), c_text(path)))
end subroutine

!> Reads such a file into an empty problem.
recursive subroutine ftread(ip, path, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: path
  integer, intent(out) :: ierr

  ierr = told(feti_problem_read(handle(ip), c_text(path)))
end subroutine
