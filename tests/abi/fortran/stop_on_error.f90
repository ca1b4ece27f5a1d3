!> Without stat a refused call prints its text on error_unit and ends the program with exit code 1: this program must
!> not reach its last line, which ends it with another code.
program stop_on_error
  use feti_contact
  implicit none
  type(feti_problem) :: p

  call feti_problem_create(p)
  call feti_body_load(p, 7, [1.0d0])
  stop 3
end program
