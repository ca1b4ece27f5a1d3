!> Bodies with functions of the host instead of a matrix, of module feti_contact. A host uses feti_contact, not this
!> module. `stat` and `errmsg`: see feti_contact_base.
module feti_contact_operators
  use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funloc, c_funptr, c_int32_t, c_int64_t, c_loc, c_ptr
  use feti_contact_base, only: feti_problem, finish, handle_of, host_operator, keep_operator, operator_procedure
  use feti_contact_c, only: FETI_OK, &
    c_body_operator => feti_body_operator
  implicit none
  private
  public :: body_operator

contains

  !> Registers the functions of the host that multiply by K and by a generalised inverse K+ of a body.
  !>
  !> diag(n): diagonal of K, >= 0, force / length. kplus, k: module procedures, y = K+ x (x force, y length) and y = K x
  !> (x length, y force); they return 0 on success; any other number reports a failure and ends the call with
  !> FETI_CALLBACK. K+ is any symmetric positive semidefinite matrix with K K+ K = K. The null space must be given.
  !> concurrent: if absent or .false., the functions run only on the thread that calls the library; if .true., several run
  !> at once, on any thread. Then declare them recursive, because -fcheck=recursion of gfortran mistakes a second thread
  !> for a recursion. data: anything declared with the attribute target that lives as long as p or until the functions of
  !> the body are replaced; they receive it and access it with select type. Inside them, p is busy except for feti_cancel
  !> and feti_problem_error. A second call replaces the functions; make this call whenever K has changed.
  recursive subroutine body_operator(p, body, diag, kplus, k, concurrent, data, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(c_double), intent(in), contiguous :: diag(:)
    procedure(operator_procedure) :: kplus, k
    logical, intent(in), optional :: concurrent
    class(*), intent(inout), optional, target :: data
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(host_operator), pointer :: host
    type(c_funptr) :: multiply_by_kplus, multiply_by_k
    integer(c_int32_t) :: status, anywhere

    allocate (host)
    host%body = body
    host%kplus => kplus
    host%k => k
    host%data => host%nothing
    if (present(data)) host%data => data
    anywhere = 0
    if (present(concurrent)) anywhere = merge(1_c_int32_t, 0_c_int32_t, concurrent)
    multiply_by_kplus = c_funloc(hand_on_to_kplus)
    multiply_by_k = c_funloc(hand_on_to_k)
    status = c_body_operator(handle_of(p), int(body - 1, c_int64_t), size(diag, kind=c_int64_t), diag, &
      multiply_by_kplus, multiply_by_k, anywhere, c_loc(host))
    if (status == FETI_OK) then
      call keep_operator(p, host)
    else
      deallocate (host)
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Calls the host's function for K+.
  recursive function hand_on_to_kplus(user, body, n, nrhs, x, ldx, y, ldy) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int64_t), value :: body, n, nrhs, ldx, ldy
    real(c_double), intent(in) :: x(ldx, nrhs)
    real(c_double), intent(inout) :: y(ldy, nrhs)
    integer(c_int32_t) :: reply
    type(host_operator), pointer :: host

    call c_f_pointer(user, host)
    reply = int(host%kplus(int(body) + 1, x(:n, :), y(:n, :), host%data), c_int32_t)
  end function

  !> Calls the host's function for K.
  recursive function hand_on_to_k(user, body, n, nrhs, x, ldx, y, ldy) result(reply) bind(C, name='')
    type(c_ptr), value :: user
    integer(c_int64_t), value :: body, n, nrhs, ldx, ldy
    real(c_double), intent(in) :: x(ldx, nrhs)
    real(c_double), intent(inout) :: y(ldy, nrhs)
    integer(c_int32_t) :: reply
    type(host_operator), pointer :: host

    call c_f_pointer(user, host)
    reply = int(host%k(int(body) + 1, x(:n, :), y(:n, :), host%data), c_int32_t)
  end function

end module
