!> Watching and cancelling, of module feti_contact. A host uses feti_contact, not this module.
!> `stat` and `errmsg`: see feti_contact_base.
module feti_contact_progress
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_funloc, c_funptr, c_int32_t, c_loc, c_null_funptr, c_null_ptr, c_ptr
  use feti_contact_base, only: feti_problem, feti_progress, finish, handle_of, listener, listener_of, progress_procedure
  use feti_contact_c, only: FETI_OK, &
    c_cancel => feti_cancel, &
    c_on_progress => feti_on_progress
  implicit none
  private
  public :: cancel, on_progress

contains

  !> Cancels the setup or solve that is running on p, in another thread or in this thread from inside its progress
  !> function: that call ends with FETI_CANCELLED. If no call is running, this procedure has no effect.
  recursive subroutine cancel(p, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_cancel(handle_of(p)), stat, errmsg)
  end subroutine

  !> Registers the function that is called for every body in every part of a setup and for every step of a solve; an
  !> absent hear removes it. hear: a module procedure (an internal one would need an executable stack). data: anything
  !> declared with the attribute target that lives as long as p or until the next feti_on_progress; hear receives it and
  !> accesses it with select type. hear returns 0 to continue, > 0 to cancel (status FETI_CANCELLED, results of the last
  !> step), or < 0 to report a failure (FETI_CALLBACK). Inside hear, p is busy except for feti_cancel and
  !> feti_problem_error.
  recursive subroutine on_progress(p, hear, data, stat, errmsg)
    type(feti_problem), intent(in) :: p
    procedure(progress_procedure), optional :: hear
    class(*), intent(inout), optional, target :: data
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(listener), pointer :: host
    type(c_funptr) :: function_of_library
    type(c_ptr) :: address
    integer(c_int32_t) :: status

    function_of_library = c_null_funptr
    address = c_null_ptr
    host => listener_of(p)
    if (present(hear)) function_of_library = c_funloc(hand_on)
    if (associated(host)) address = c_loc(host)
    status = c_on_progress(handle_of(p), function_of_library, address)
    if (status == FETI_OK .and. present(hear)) then
      host%hear => hear
      host%data => host%nothing
      if (present(data)) host%data => data
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Calls the host's function.
  recursive function hand_on(user, now) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    type(feti_progress), intent(in) :: now
    integer(c_int32_t) :: reply
    type(listener), pointer :: host

    call c_f_pointer(user, host)
    reply = int(host%hear(now, host%data), c_int32_t)
  end function

end module
