!> A problem of the ranks of an MPI communicator; to be compiled with the host, like feti_mpi.c, after the modules of
!> feti_contact. It needs no module of MPI: a communicator is an integer of `use mpi` or mpif.h, of 4 or 8 bytes
!> (of mpi_f08: feti_contact_mpi_f08). `stat` and `errmsg`: see feti_contact_base.
module feti_contact_mpi
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_ptr
  use feti_contact_base, only: feti_problem, finish, handle_of
  implicit none
  private
  public :: feti_mpi, feti_mpi_serve

  !> Each rank that has a part of the problem calls it, before the first body; those without call feti_mpi_serve.
  !>
  !> call feti_mpi(p, comm)
  interface feti_mpi
    module procedure mpi_int32, mpi_int64
  end interface

  !> On ranks other than 0: answers rank 0, until rank 0 makes this call, too.
  !>
  !> call feti_mpi_serve(comm)
  interface feti_mpi_serve
    module procedure serve_int32, serve_int64
  end interface

  interface
    function feti_mpi_f(p, comm) bind(C, name='feti_mpi_f') result(status)
      import :: c_int32_t, c_int64_t, c_ptr
      type(c_ptr), value :: p
      integer(c_int64_t), value :: comm
      integer(c_int32_t) :: status
    end function

    function feti_mpi_serve_f(comm) bind(C, name='feti_mpi_serve_f') result(status)
      import :: c_int32_t, c_int64_t
      integer(c_int64_t), value :: comm
      integer(c_int32_t) :: status
    end function
  end interface

contains

  recursive subroutine mpi_int32(p, comm, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(feti_mpi_f(handle_of(p), int(comm, c_int64_t)), stat, errmsg)
  end subroutine

  recursive subroutine mpi_int64(p, comm, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int64_t), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(feti_mpi_f(handle_of(p), comm), stat, errmsg)
  end subroutine

  recursive subroutine serve_int32(comm, stat, errmsg)
    integer(c_int32_t), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(feti_mpi_serve_f(int(comm, c_int64_t)), stat, errmsg)
  end subroutine

  recursive subroutine serve_int64(comm, stat, errmsg)
    integer(c_int64_t), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(feti_mpi_serve_f(comm), stat, errmsg)
  end subroutine

end module
