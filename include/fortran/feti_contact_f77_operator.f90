!> FORTRAN 77 interface: bodies with functions of the host instead of a matrix. The function shares data with the rest of
!> the host through COMMON. See docs/fortran77.md.
module feti_contact_f77_operator
  use feti_contact_f77_base
  implicit none
  private
  public :: address_of, multiply_kplus, multiply_k, host_product

  abstract interface
    !> y(ldy,nrhs) = K+ x(ldx,nrhs) if iwhat is FTKPLS, or K x if iwhat is FTKMUL, for body ibody. Result: 0, or any other
    !> number to report a failure.
    integer function host_product(iwhat, ibody, n, nrhs, x, ldx, y, ldy)
      import :: c_double
      integer, intent(in) :: iwhat, ibody, n, nrhs, ldx, ldy
      real(c_double), intent(in) :: x(*)
      real(c_double), intent(inout) :: y(*)
    end function
  end interface

contains

  !> The host's function is passed through the library as the data of multiply_kplus and multiply_k.
  recursive type(c_ptr) function address_of(host)
    procedure(host_product) :: host
    type(c_funptr) :: address

    address = c_funloc(host)
    address_of = transfer(address, c_null_ptr)
  end function

  !> Called by the library: Y = K+ X by the function of the host.
  recursive function multiply_kplus(user, body, n, nrhs, x, ldx, y, ldy) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int64_t), value :: body, n, nrhs, ldx, ldy
    real(c_double), intent(in) :: x(*)
    real(c_double), intent(out) :: y(*)
    integer(c_int32_t) :: reply
    procedure(host_product), pointer :: host

    call c_f_procpointer(transfer(user, c_null_funptr), host)
    reply = narrow(host(FTKPLS, clipped(body + 1), clipped(n), clipped(nrhs), x, clipped(ldx), y, clipped(ldy)))
  end function

  !> Called by the library: Y = K X by the function of the host.
  recursive function multiply_k(user, body, n, nrhs, x, ldx, y, ldy) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int64_t), value :: body, n, nrhs, ldx, ldy
    real(c_double), intent(in) :: x(*)
    real(c_double), intent(out) :: y(*)
    integer(c_int32_t) :: reply
    procedure(host_product), pointer :: host

    call c_f_procpointer(transfer(user, c_null_funptr), host)
    reply = narrow(host(FTKMUL, clipped(body + 1), clipped(n), clipped(nrhs), x, clipped(ldx), y, clipped(ldy)))
  end function

end module

!> Registers the INTEGER FUNCTION host(iwhat, ibody, n, nrhs, x, ldx, y, ldy) of the host, declared EXTERNAL there, which
!> multiplies by K and by a generalised inverse K+ of body ibody; diag(n): diagonal of K. iconc: 0, it runs only on the
!> calling thread; 1, on any thread.
recursive subroutine ftbopr(ip, ibody, n, diag, host, iconc, ierr)
  use feti_contact_f77_base
  use feti_contact_f77_operator
  implicit none
  integer, intent(in) :: ip, ibody, n, iconc
  real(c_double), intent(in) :: diag(*)
  procedure(host_product) :: host
  integer, intent(out) :: ierr
  type(c_funptr) :: by_kplus, by_k

  by_kplus = c_funloc(multiply_kplus)
  by_k = c_funloc(multiply_k)
  ierr = told(feti_body_operator(handle(ip), from_zero(ibody), wide(n), diag, by_kplus, by_k, narrow(iconc), &
    address_of(host)), [1, 2, 3, 4, 5, 5, 6, 5])
end subroutine
