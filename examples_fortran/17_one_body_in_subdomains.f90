!> 17 One body in the host's subdomains: each rank has the matrix of its part of the mesh.
!>
!> A membrane of 40 x 80 square elements of 1 cm is held at its first line and pressed by 10 N/m^2 onto an obstacle 1 cm below it. The host
!> has cut the mesh into strips, strip s on rank s mod size, and sums the matrix and the load of each strip from its own elements alone. Nodes
!> on the line between two strips have one number on both: with option glue they move together. A rank gives the obstacle of the nodes that it
!> owns, by numbers:
!>   mpirun -n 4 17_one_body_in_subdomains
program one_body_in_subdomains
  use demo
  use feti_contact
  use feti_contact_mpi_f08, only: feti_mpi
  use mpi_f08
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: strips = 4, length = 20                   ! elements of a strip
  integer, parameter :: width = 40, line = width + 1, n = line * (length + 1)
  integer :: level, rank, size, s, k
  real(dp) :: u(n), reaction(n), mine(2), all(2)
  type(feti_info) :: info
  type(feti_problem) :: problem

  call MPI_Init_thread(MPI_THREAD_FUNNELED, level)
  call MPI_Comm_rank(MPI_COMM_WORLD, rank)
  call MPI_Comm_size(MPI_COMM_WORLD, size)
  call feti_problem_create(problem)
  call feti_mpi(problem, MPI_COMM_WORLD)
  call feti_set(problem, 'glue', 1)
  do s = rank, strips - 1, size
    call add_strip(s)
  end do
  do s = rank, strips - 1, size
    call add_lines(FETI_INEQUALITY, s * length + 1, length, -1.0_dp, 1e-2_dp)
  end do
  if (rank == 0) call add_lines(FETI_EQUALITY, 0, 1, 1.0_dp, 0.0_dp)
  call feti_solve(problem, info)                                  ! by all ranks
  mine = 0
  k = 0
  do s = rank, strips - 1, size
    k = k + 1
    call feti_displacement(problem, k, u)
    call feti_reaction(problem, FETI_INEQUALITY, k, reaction)
    mine(1) = mine(1) + sum(reaction)
    if (s == strips - 1) mine(2) = u(n)
  end do
  call feti_problem_destroy(problem)

  call MPI_Reduce(mine, all, 2, MPI_DOUBLE_PRECISION, MPI_SUM, 0, MPI_COMM_WORLD)
  if (rank == 0) then
    call demo_value('nodes on the obstacle', real(info%active, dp), '-')
    call demo_value('force of the obstacle', all(1), 'N')
    call demo_value('the far end is at', 1e3_dp * all(2), 'mm')   ! on the obstacle
    call demo_line('17_one_body_in_subdomains', info, demo_error(all(2:), [-1e-2_dp]), .true.)
  end if
  call MPI_Finalize()

contains

  !> Strip s of a membrane under a tension of 60 N/m.
  subroutine add_strip(s)
    integer, intent(in) :: s
    real(dp), parameter :: ke(4, 4) = &
      10 * reshape([4, -1, -1, -2, -1, 4, -2, -1, -1, -2, 4, -1, -2, -1, -1, 4], [4, 4])
    real(dp), allocatable :: k(:, :)
    real(dp) :: load(n)
    integer :: e, at, node(4), body, i

    allocate (k(n, n))
    k = 0
    load = 0
    do e = 0, width * length - 1
      at = e / width * line + mod(e, width) + 1
      node = [at, at + 1, at + line, at + line + 1]
      k(node, node) = k(node, node) + ke
      load(node) = load(node) - 10.0_dp * 1e-4_dp / 4             ! what each rank adds to a node of two strips is added up
    end do
    call feti_body_add(problem, n, body)
    call feti_body_stiffness(problem, body, k, FETI_LOWER)
    call feti_body_null_space(problem, body, reshape([(1.0_dp, i=1, n)], [n, 1]), FETI_EXACT)
    call feti_body_load(problem, body, load)
    call feti_body_numbering(problem, body, [(int(s * length * line + i, int64), i=1, n)])
  end subroutine

  !> Rows of one unknown each, for `lines` lines of nodes from the given one.
  subroutine add_lines(kind, first, lines, val, rhs)
    integer, intent(in) :: kind, first, lines
    real(dp), intent(in) :: val, rhs
    integer :: i, rows

    rows = lines * line
    call feti_rows_add(problem, kind, [(int(i, int64), i=1, rows + 1)], [(int(first * line + i, int64), i=1, rows)], &
      [(val, i=1, rows)], [(rhs, i=1, rows)])
  end subroutine

end program
