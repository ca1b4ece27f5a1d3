!> FORTRAN 77 interface: the log of setups and solves. The host's function shares data with the rest of the host through
!> COMMON. See docs/fortran77.md.
module feti_contact_f77_log
  use feti_contact_f77_base
  implicit none
  private
  public :: address_of, hand_on, host_listener

  abstract interface
    !> level: FTLRES, FTLPHA or FTLSTP; text: one line. Result: 0 to continue, any other number to report a failure.
    integer function host_listener(level, text)
      integer, intent(in) :: level
      character(len=*), intent(in) :: text
    end function
  end interface

contains

  !> The host's function is passed through the library as the data of hand_on.
  recursive type(c_ptr) function address_of(listen)
    procedure(host_listener) :: listen
    type(c_funptr) :: address

    address = c_funloc(listen)
    address_of = transfer(address, c_null_ptr)
  end function

  !> Called by the library; passes a line on to the function of the host.
  recursive function hand_on(user, level, text) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int32_t), value :: level
    character(kind=c_char), intent(in), target :: text(*)
    integer(c_int32_t) :: reply
    procedure(host_listener), pointer :: listen

    call c_f_procpointer(transfer(user, c_null_funptr), listen)
    reply = narrow(listen(int(level), f_text(c_loc(text(1)))))
  end function

end module

!> Registers the INTEGER FUNCTION listen(level, text) of the host, declared EXTERNAL there, which receives lines up to a
!> level: FTLRES, FTLPHA or FTLSTP.
recursive subroutine ftonlg(ip, listen, level, ierr)
  use feti_contact_f77_base
  use feti_contact_f77_log
  implicit none
  integer, intent(in) :: ip, level
  procedure(host_listener) :: listen
  integer, intent(out) :: ierr
  type(c_funptr) :: function_of_face

  function_of_face = c_funloc(hand_on)
  ierr = told(feti_on_log(handle(ip), function_of_face, narrow(level), address_of(listen)))
end subroutine

!> Removes the function of the host.
recursive subroutine ftoflg(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_on_log(handle(ip), c_null_funptr, 0_c_int32_t, c_null_ptr))
end subroutine
