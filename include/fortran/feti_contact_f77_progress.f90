!> FORTRAN 77 interface: progress and cancelling. The host's function shares data with the rest of the host through
!> COMMON. See docs/fortran77.md.
module feti_contact_f77_progress
  use feti_contact_f77_base
  implicit none
  private
  public :: address_of, hand_on, host_function

  abstract interface
    !> now(5) and rnow(6), positions FTNPHA to FTNACT, FTNRES to FTNFRA. Result: 0 to continue, > 0 to cancel, < 0 to
    !> report a failure.
    integer function host_function(now, rnow)
      import :: c_double
      integer, intent(in) :: now(5)
      real(c_double), intent(in) :: rnow(6)
    end function
  end interface

contains

  !> The host's function is passed through the library as the data of hand_on. This module keeps no data, so threads need
  !> no synchronisation.
  recursive type(c_ptr) function address_of(hear)
    procedure(host_function) :: hear
    type(c_funptr) :: address

    address = c_funloc(hear)
    address_of = transfer(address, c_null_ptr)
  end function

  !> Called by the library; passes a step on to the function of the host.
  recursive function hand_on(user, now) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    type(feti_progress), intent(in) :: now
    integer(c_int32_t) :: reply
    procedure(host_function), pointer :: hear

    call c_f_procpointer(transfer(user, c_null_funptr), hear)
    reply = narrow(hear( &
      clipped([int(now%phase, c_int64_t), int(now%step, c_int64_t), now%steps, now%products, now%active]), &
      [now%residual, now%residual_free, now%residual_chopped, now%theta, now%seconds, now%fraction]))
  end function

end module

!> Registers the INTEGER FUNCTION hear(now, rnow) of the host, declared EXTERNAL there, which is called for every body in
!> every part of a setup and for every step of a solve.
recursive subroutine ftonpr(ip, hear, ierr)
  use feti_contact_f77_base
  use feti_contact_f77_progress
  implicit none
  integer, intent(in) :: ip
  procedure(host_function) :: hear
  integer, intent(out) :: ierr
  type(c_funptr) :: function_of_face

  function_of_face = c_funloc(hand_on)
  ierr = told(feti_on_progress(handle(ip), function_of_face, address_of(hear)))
end subroutine

!> Removes the function of the host.
recursive subroutine ftofpr(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_on_progress(handle(ip), c_null_funptr, c_null_ptr))
end subroutine

!> Cancels the setup or solve that is running on the problem; call it from another thread or from inside hear.
recursive subroutine ftcanc(ip, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  integer, intent(out) :: ierr

  ierr = told(feti_cancel(handle(ip)))
end subroutine
