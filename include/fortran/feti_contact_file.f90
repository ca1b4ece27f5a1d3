!> A problem as one file, of module feti_contact. A host uses feti_contact, not this module.
!> The name `path` of the file is used without trailing blanks.
!> `stat` and `errmsg`: see feti_contact_base.
module feti_contact_file
  use feti_contact_base, only: c_text, feti_problem, finish, handle_of
  use feti_contact_c, only: &
    c_problem_read => feti_problem_read, &
    c_problem_write => feti_problem_write
  implicit none
  private
  public :: problem_read, problem_write

contains

  !> Writes all that the host has registered to the file `path`: bodies, rows, options that differ from their defaults;
  !> no answer, start values or saved states. After a failure (FETI_IO) an old file is as it was.
  recursive subroutine problem_write(p, path, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_problem_write(handle_of(p), c_text(path)), stat, errmsg)
  end subroutine

  !> Reads such a file into a problem without bodies and rows (FETI_STATE otherwise); the same solve then gives the same
  !> bits. Where a file is damaged the entry of feti_last_error_detail is its byte, from 1. After a failure p is as it was.
  recursive subroutine problem_read(p, path, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_problem_read(handle_of(p), c_text(path)), stat, errmsg)
  end subroutine

end module
