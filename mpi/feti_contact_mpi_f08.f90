!> As feti_contact_mpi, with a communicator of mpi_f08; to be compiled after it, with the host's MPI.
module feti_contact_mpi_f08
  use mpi_f08, only: MPI_Comm
  use feti_contact_base, only: feti_problem
  use feti_contact_mpi, only: by_integer => feti_mpi, serve_by_integer => feti_mpi_serve
  implicit none
  private
  public :: feti_mpi, feti_mpi_serve

contains

  !> call feti_mpi(p, comm)
  recursive subroutine feti_mpi(p, comm, stat, errmsg)
    type(feti_problem), intent(in) :: p
    type(MPI_Comm), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call by_integer(p, comm%MPI_VAL, stat, errmsg)
  end subroutine

  !> call feti_mpi_serve(comm)
  recursive subroutine feti_mpi_serve(comm, stat, errmsg)
    type(MPI_Comm), intent(in) :: comm
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call serve_by_integer(comm%MPI_VAL, stat, errmsg)
  end subroutine

end module
