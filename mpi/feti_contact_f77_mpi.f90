!> FORTRAN 77 interface: a problem of the ranks of an MPI communicator. To be compiled with the host, like feti_mpi.c,
!> after the other sources of the interface. See docs/fortran77.md.

!> Each rank that has a part of the problem calls it, before the first body; those without call FTMSRV.
recursive subroutine ftmpi(ip, icomm, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, icomm
  integer, intent(out) :: ierr
  interface
    function feti_mpi_f(p, comm) bind(C, name='feti_mpi_f') result(status)
      import :: c_int32_t, c_int64_t, c_ptr
      type(c_ptr), value :: p
      integer(c_int64_t), value :: comm
      integer(c_int32_t) :: status
    end function
  end interface

  ierr = told(feti_mpi_f(handle(ip), wide(icomm)))
end subroutine

!> On ranks other than 0: answers rank 0, until rank 0 makes this call, too.
recursive subroutine ftmsrv(icomm, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: icomm
  integer, intent(out) :: ierr
  interface
    function feti_mpi_serve_f(comm) bind(C, name='feti_mpi_serve_f') result(status)
      import :: c_int32_t, c_int64_t
      integer(c_int64_t), value :: comm
      integer(c_int32_t) :: status
    end function
  end interface

  ierr = told(feti_mpi_serve_f(wide(icomm)))
end subroutine
