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

  !> Writes all input of the problem to the file `path`: bodies, rows and options that differ from their defaults, but no
  !> answer, start values or saved states. After a failure (FETI_IO) an old file is unchanged.
  recursive subroutine problem_write(p, path, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_problem_write(handle_of(p), c_text(path)), stat, errmsg)
  end subroutine

  !> Reads a file of feti_problem_write into a problem without bodies and rows (FETI_STATE otherwise); a solve then gives
  !> the same bits as in the original problem. If the file is damaged, the entry of feti_last_error_detail is the position
  !> of the wrong byte, from 1. After a failure p is unchanged.
  recursive subroutine problem_read(p, path, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_problem_read(handle_of(p), c_text(path)), stat, errmsg)
  end subroutine

end module
