!> The log of setups and solves, of module feti_contact. A host uses feti_contact, not this module. `stat` and `errmsg`:
!> see feti_contact_base.
module feti_contact_log
  use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_funloc, c_funptr, c_int32_t, c_loc, c_null_funptr, &
    c_null_ptr, c_ptr
  use feti_contact_base, only: f_text, feti_problem, finish, handle_of, listener, listener_of, log_procedure
  use feti_contact_c, only: FETI_OK, FETI_LOG_NONE, c_on_log => feti_on_log
  implicit none
  private
  public :: on_log

contains

  !> Registers the function that receives the log of setups and solves; an absent tell removes it. level: FETI_LOG_RESULT
  !> (one line for each solve, and warnings), FETI_LOG_PHASE (also phases with time and bytes), FETI_LOG_STEP (also every
  !> step); if level is absent, FETI_LOG_NONE. tell: a module procedure (an internal one would need an executable stack).
  !> data: anything with the attribute target that lives as long as p or until the next feti_on_log; tell receives it.
  !> tell returns 0 to continue and any other number to report a failure (FETI_CALLBACK). Inside tell, p is busy except
  !> for feti_cancel and feti_problem_error.
  recursive subroutine on_log(p, tell, level, data, stat, errmsg)
    type(feti_problem), intent(in) :: p
    procedure(log_procedure), optional :: tell
    integer(c_int32_t), intent(in), optional :: level
    class(*), intent(inout), optional, target :: data
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(listener), pointer :: host
    type(c_funptr) :: function_of_library
    type(c_ptr) :: address
    integer(c_int32_t) :: status, most

    function_of_library = c_null_funptr
    address = c_null_ptr
    most = FETI_LOG_NONE
    host => listener_of(p)
    if (present(tell)) function_of_library = c_funloc(hand_on)
    if (present(level)) most = level
    if (associated(host)) address = c_loc(host)
    status = c_on_log(handle_of(p), function_of_library, most, address)
    if (status == FETI_OK .and. present(tell)) then
      host%tell => tell
      host%log_data => host%nothing
      if (present(data)) host%log_data => data
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Calls the host's function.
  recursive function hand_on(user, level, text) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int32_t), value :: level
    character(kind=c_char), intent(in), target :: text(*)
    integer(c_int32_t) :: reply
    type(listener), pointer :: host

    call c_f_pointer(user, host)
    reply = int(host%tell(int(level), f_text(c_loc(text(1))), host%log_data), c_int32_t)
  end function

end module
