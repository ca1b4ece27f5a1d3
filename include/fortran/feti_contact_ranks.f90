!> Other ranks, of module feti_contact, for hosts that move messages themselves; those with MPI call feti_mpi and
!> feti_mpi_serve of module feti_contact_mpi. `stat` and `errmsg`: see feti_contact_base.
module feti_contact_ranks
  use, intrinsic :: iso_c_binding, only: c_int64_t, c_sizeof
  use feti_contact_base, only: feti_problem, finish, handle_of
  use feti_contact_c, only: feti_communicator, &
    c_communicator_set => feti_communicator_set, &
    c_serve => feti_serve
  implicit none
  private
  public :: feti_communicator, communicator_set, serve

contains

  !> Lends bodies of the problem to the other ranks, which serve (feti_serve). Rank 0 calls it for each of its problems,
  !> before the first body. by: functions with C binding (feti_send_fn, feti_flush_fn, feti_receive_fn of module
  !> feti_contact_c) by c_funloc; this procedure sets struct_size.
  recursive subroutine communicator_set(p, by, stat, errmsg)
    type(feti_problem), intent(in) :: p
    type(feti_communicator), intent(in) :: by
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_communicator_set(handle_of(p), sized(by)), stat, errmsg)
  end subroutine

  !> Answers rank 0 for all of its problems, until rank 0 calls this procedure, too. by: as for feti_communicator_set.
  recursive subroutine serve(by, stat, errmsg)
    type(feti_communicator), intent(in) :: by
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_serve(sized(by)), stat, errmsg)
  end subroutine

  !> The table with its size.
  recursive function sized(by)
    type(feti_communicator), intent(in) :: by
    type(feti_communicator) :: sized

    sized = by
    sized%struct_size = int(c_sizeof(by), c_int64_t)
  end function

end module
