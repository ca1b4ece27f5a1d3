!> FORTRAN 77 interface: functions of the host, which share data with the rest of the host through COMMON. See
!> docs/fortran77.md. A function is passed through the library as the data of the function here that calls it; this module
!> keeps no data.
module feti_contact_f77_functions
  use feti_contact_f77_base
  implicit none
  private
  public :: host_function, host_listener, host_product, pass_progress, pass_line, multiply_kplus, multiply_k

  abstract interface
    !> now(5) and rnow(6), positions FTNPHA to FTNACT, FTNRES to FTNFRA. Result: 0 to continue, > 0 to cancel, < 0 to
    !> report a failure.
    integer function host_function(now, rnow)
      import :: c_double
      integer, intent(in) :: now(5)
      real(c_double), intent(in) :: rnow(6)
    end function

    !> level: FTLRES, FTLPHA or FTLSTP; text: one line. Result: 0 to continue, any other number to report a failure.
    integer function host_listener(level, text)
      integer, intent(in) :: level
      character(len=*), intent(in) :: text
    end function

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

  !> Called by the library for a step.
  recursive function pass_progress(user, now) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    type(feti_progress), intent(in) :: now
    integer(c_int32_t) :: reply
    procedure(host_function), pointer :: hear

    call c_f_procpointer(transfer(user, c_null_funptr), hear)
    reply = narrow(hear( &
      clipped([int(now%phase, c_int64_t), int(now%step, c_int64_t), now%steps, now%products, now%active]), &
      [now%residual, now%residual_free, now%residual_chopped, now%theta, now%seconds, now%fraction]))
  end function

  !> Called by the library for a line of the log.
  recursive function pass_line(user, level, text) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int32_t), value :: level
    character(kind=c_char), intent(in), target :: text(*)
    integer(c_int32_t) :: reply
    procedure(host_listener), pointer :: listen

    call c_f_procpointer(transfer(user, c_null_funptr), listen)
    reply = narrow(listen(int(level), f_text(c_loc(text(1)))))
  end function

  !> Called by the library: Y = K+ X.
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

  !> Called by the library: Y = K X.
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

!> Registers the INTEGER FUNCTION hear(now, rnow) of the host, declared EXTERNAL there, which is called for every body in
!> every part of a setup and for every step of a solve.
recursive subroutine ftonpr(ip, hear, ierr)
  use feti_contact_f77_functions
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  procedure(host_function) :: hear
  integer, intent(out) :: ierr
  type(c_funptr) :: here, of_host

  here = c_funloc(pass_progress)
  of_host = c_funloc(hear)
  ierr = told(feti_on_progress(handle(ip), here, transfer(of_host, c_null_ptr)))
end subroutine

!> Registers the INTEGER FUNCTION listen(level, text) of the host, declared EXTERNAL there, which receives lines up to a
!> level: FTLRES, FTLPHA or FTLSTP.
recursive subroutine ftonlg(ip, listen, level, ierr)
  use feti_contact_f77_functions
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, level
  procedure(host_listener) :: listen
  integer, intent(out) :: ierr
  type(c_funptr) :: here, of_host

  here = c_funloc(pass_line)
  of_host = c_funloc(listen)
  ierr = told(feti_on_log(handle(ip), here, narrow(level), transfer(of_host, c_null_ptr)))
end subroutine

!> Registers the INTEGER FUNCTION host(iwhat, ibody, n, nrhs, x, ldx, y, ldy) of the host, declared EXTERNAL there, which
!> multiplies by K and by a generalised inverse K+ of body ibody; diag(n): diagonal of K. iconc: 0, it runs only on the
!> calling thread; 1, on any thread.
recursive subroutine ftbopr(ip, ibody, n, diag, host, iconc, ierr)
  use feti_contact_f77_functions
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, ibody, n, iconc
  real(c_double), intent(in) :: diag(*)
  procedure(host_product) :: host
  integer, intent(out) :: ierr
  type(c_funptr) :: by_kplus, by_k, of_host

  by_kplus = c_funloc(multiply_kplus)
  by_k = c_funloc(multiply_k)
  of_host = c_funloc(host)
  ierr = told(feti_body_operator(handle(ip), from_zero(ibody), wide(n), diag, by_kplus, by_k, narrow(iconc), &
    transfer(of_host, c_null_ptr)), [1, 2, 3, 4, 5, 5, 6, 5])
end subroutine
