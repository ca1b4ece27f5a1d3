!> 16 A body per rank: each rank has its own bodies, and no rank has the model.
!>
!> Four bars of 1 m stand on each other, the lowest on the ground, 1 mm below it; each weighs .5 MN. Rank r has bars r, r + size, ...: its
!> matrix, its weight, and the contact row of its lower end, which names an unknown of the bar below by its number. All ranks make the
!> calls; each gets the displacements of its bars and the forces of its rows:
!>   mpirun -n 4 16_body_per_rank
program body_per_rank
  use demo
  use feti_contact
  use feti_contact_mpi_f08, only: feti_mpi
  use mpi_f08
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: bars = 4, n = 1000                        ! unknowns of a bar
  integer :: level, rank, size, own, b, k, i
  real(dp), allocatable :: lambda(:)
  real(dp) :: u(n), mine(2 * bars), all(2 * bars), expected(bars)
  type(feti_info) :: info
  type(feti_problem) :: problem

  call MPI_Init_thread(MPI_THREAD_FUNNELED, level)
  call MPI_Comm_rank(MPI_COMM_WORLD, rank)
  call MPI_Comm_size(MPI_COMM_WORLD, size)
  call feti_problem_create(problem)
  call feti_mpi(problem, MPI_COMM_WORLD)
  own = 0
  do b = rank + 1, bars, size
    call add_bar(b)
    call add_row(b)
    own = own + 1
  end do
  call feti_solve(problem, info)                                  ! by all ranks
  allocate (lambda(own))
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)
  mine = 0
  do k = 1, own
    b = rank + 1 + (k - 1) * size
    call feti_displacement(problem, k, u)                         ! of its bar k
    mine(b) = lambda(k)
    mine(bars + b) = u(n)
  end do
  call feti_problem_destroy(problem)

  call MPI_Reduce(mine, all, 2 * bars, MPI_DOUBLE_PRECISION, MPI_SUM, 0, MPI_COMM_WORLD)
  expected = [(0.5_dp * (bars + 1 - b), b=1, bars)]               ! each stands on what is below it
  if (rank == 0) then
    call demo_value('force on the ground', all(1), 'MN')
    call demo_value('force between the upper two', all(bars), 'MN')
    call demo_value('the top sinks by', -1e3_dp * all(2 * bars), 'mm')
    call demo_line('16_body_per_rank', info, demo_error(all(:bars), expected), .true.)
  end if
  call MPI_Finalize()

contains

  !> A chain of springs, held by nothing; unknown i of bar b has the number (b - 1) n + i.
  subroutine add_bar(b)
    integer, intent(in) :: b
    real(dp), parameter :: k = 1e4_dp * (n - 1)
    real(dp) :: val(2 * n - 1)
    integer :: ptr(n + 1), col(2 * n - 1), body

    ptr = [1, (2 * i, i=1, n)]
    col(1) = 1
    val(1) = k
    do i = 2, n
      col(2 * i - 2:2 * i - 1) = [i - 1, i]
      val(2 * i - 2:2 * i - 1) = [-k, merge(2 * k, k, i < n)]
    end do
    call feti_body_add(problem, n, body)
    call feti_body_stiffness(problem, body, ptr, col, val, FETI_LOWER)
    call feti_body_null_space(problem, body, reshape([(1.0_dp, i=1, n)], [n, 1]), FETI_EXACT)
    call feti_body_load(problem, body, [(-0.5_dp / n, i=1, n)])
    call feti_body_numbering(problem, body, [(int((b - 1) * n + i, int64), i=1, n)])
  end subroutine

  !> The lower end of bar b stays above the upper end of the bar below it, or above the ground.
  subroutine add_row(b)
    integer, intent(in) :: b
    integer(int64) :: first

    first = int(b - 1, int64) * n + 1
    if (b > 1) then
      call feti_rows_add(problem, FETI_INEQUALITY, [1_int64, 3_int64], [first, first - 1], [-1.0_dp, 1.0_dp], [0.0_dp])
    else
      call feti_rows_add(problem, FETI_INEQUALITY, [1_int64, 2_int64], [first], [-1.0_dp], [1e-3_dp])
    end if
  end subroutine

end program
