!> FORTRAN 77 interface: a problem as a file. See docs/fortran77.md.

!> Writes all input of the problem to the file path; an existing file is replaced.
recursive subroutine ftwrit(ip, path, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: path
  integer, intent(out) :: ierr

  ierr = told(feti_problem_write(handle(ip), c_text(path)))
end subroutine

!> Reads a file of ftwrit into an empty problem.
recursive subroutine ftread(ip, path, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: path
  integer, intent(out) :: ierr

  ierr = told(feti_problem_read(handle(ip), c_text(path)))
end subroutine
