!> 15 A serial code under mpirun: the other ranks share the work of rank 0.
!>
!> Eight blocks of 1 m x 1 m stand on each other (plane strain, nu = .25, 1 m thick), each softer than the one below, E = 1e4 to
!> 5.625e3 MN/m^2. The lowest is clamped to the ground, the others float, and each top is slightly hollow. A load of .5 MN presses on the left half of the highest block, so
!> that contacts open on the right.
!>
!> The host is serial: one rank has the model and calls the library. The lines marked with MPI lend bodies to the other
!> ranks. The forces are the same on any number of ranks:
!>   mpirun -n 4 15_serial_under_mpirun
program serial_under_mpirun
  use demo
  use feti_contact
  use feti_contact_mpi, only: feti_mpi, feti_mpi_serve            ! MPI
  use mpi                                                         ! MPI
  use, intrinsic :: iso_fortran_env, only: int32
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: blocks = 8
  integer, parameter :: n = 16                                    ! elements along 1 m
  integer, parameter :: line = n + 1, unknowns = 2 * line**2
  integer :: level, rank, ierr

  call MPI_Init_thread(MPI_THREAD_FUNNELED, level, ierr)          ! MPI
  call MPI_Comm_rank(MPI_COMM_WORLD, rank, ierr)                  ! MPI
  if (rank == 0) call serial_host()
  call feti_mpi_serve(MPI_COMM_WORLD)                             ! MPI: the other ranks work here until rank 0 comes, too
  call MPI_Finalize(ierr)                                         ! MPI

contains

  subroutine serial_host()
    type(feti_problem) :: problem
    type(feti_info) :: info
    real(dp) :: rows(line * (blocks - 1)), lambda(line, blocks - 1), u(unknowns), expected(blocks - 1)

    call feti_problem_create(problem)
    call feti_mpi(problem, MPI_COMM_WORLD)                        ! MPI
    call add_blocks(problem)
    call add_rows(problem)
    call feti_solve(problem, info)
    call feti_multipliers(problem, FETI_INEQUALITY, rows)
    lambda = reshape(rows, shape(lambda))
    call feti_displacement(problem, blocks, u)
    call feti_problem_destroy(problem)

    expected = real(n / 2, dp) / n                                ! what stands above is pressed on by the load alone
    call demo_value('nodes in contact', real(count(lambda > 1e-6_dp), dp), '-')
    call demo_value('contact force on the ground', sum(lambda(:, 1)), 'MN')
    call demo_value('energy', 1e6_dp * info%energy, 'J')
    call demo_value('left upper corner sinks by', -1e3_dp * u(unknown(0, n) + 1), 'mm')
    call demo_value('right upper corner rises by', 1e3_dp * u(unknown(n, n) + 1), 'mm')
    call demo_line('15_serial_under_mpirun', info, demo_error(sum(lambda, 1), expected), .true.)
  end subroutine

  !> Unknown along x of node (i, j) of a block; the next is along y.
  pure integer function unknown(i, j)
    integer, intent(in) :: i, j

    unknown = 2 * (i * line + j) + 1
  end function

  !> Stiffness of a square element, plane strain, 2 x 2 Gauss points. Corners (0,0), (1,0), (0,1), (1,1).
  function element() result(k)
    real(dp), parameter :: young = 1e4_dp, nu = 0.25_dp
    real(dp), parameter :: mu = young / (2 * (1 + nu)), la = young * nu / ((1 + nu) * (1 - 2 * nu))
    real(dp), parameter :: sign_of(0:1) = [-1.0_dp, 1.0_dp]
    real(dp) :: k(8, 8), g(2, 0:3), other
    integer :: point, c, a, p, q, d, e

    k = 0
    do point = 0, 3
      do c = 0, 3
        do a = 0, 1
          other = sign_of(ibits(c, 1 - a, 1)) * sign_of(ibits(point, 1 - a, 1))
          g(a + 1, c) = sign_of(ibits(c, a, 1)) * 0.5_dp * (1 + other / sqrt(3.0_dp))
        end do
      end do
      do p = 1, 8
        do q = 1, 8
          d = 1 + mod(p - 1, 2)
          e = 1 + mod(q - 1, 2)
          associate (u => g(:, (p - 1) / 2), v => g(:, (q - 1) / 2))
            k(p, q) = k(p, q) + 0.25_dp * (la * u(d) * v(e) + mu * u(e) * v(d))
            if (d == e) k(p, q) = k(p, q) + 0.25_dp * mu * dot_product(u, v)
          end associate
        end do
      end do
    end do
  end function

  subroutine add_blocks(problem)
    type(feti_problem), intent(in) :: problem
    real(dp), allocatable :: k(:, :)
    real(dp) :: ke(8, 8), load(unknowns), xyz(2, unknowns)
    integer(int32) :: node(unknowns), dir(unknowns)
    integer :: i, j, b, c, d, at, body, dof(8)

    allocate (k(unknowns, unknowns))
    k = 0
    load = 0
    ke = element()
    do i = 0, n - 1
      do j = 0, n - 1
        do c = 0, 3
          dof(2 * c + 1) = unknown(i + mod(c, 2), j + c / 2)
          dof(2 * c + 2) = dof(2 * c + 1) + 1
        end do
        k(dof, dof) = k(dof, dof) + ke
      end do
    end do
    do i = 0, n
      do j = 0, n
        do d = 1, 2
          at = unknown(i, j) + d - 1
          node(at) = (at + 1) / 2
          dir(at) = d
          xyz(:, at) = [real(i, dp) / n, real(j, dp) / n]
          if (d == 2 .and. j == n .and. 2 * i < n) load(at) = -1.0_dp / n
        end do
      end do
    end do
    do b = 1, blocks
      call feti_body_add(problem, unknowns, body)
      call feti_body_stiffness(problem, body, (1 - real(b - 1, dp) / 16) * k, FETI_LOWER)
      call feti_body_coordinates(problem, body, node, dir, xyz)
      if (b == blocks) call feti_body_load(problem, body, load)
    end do
  end subroutine

  !> The clamp; a node of each other block that keeps it from sliding; a contact row along y for each node between two blocks.
  subroutine add_rows(problem)
    type(feti_problem), intent(in) :: problem
    real(dp) :: x
    integer :: b, i, d

    do i = 0, n
      do d = 0, 1
        call feti_rows_add(problem, FETI_EQUALITY, [1, 2], [1], [unknown(i, 0) + d], [1.0_dp], [0.0_dp])
      end do
    end do
    do b = 2, blocks
      call feti_rows_add(problem, FETI_EQUALITY, [1, 2], [b], [unknown(0, 0)], [1.0_dp], [0.0_dp])
      do i = 0, n
        x = real(i, dp) / n
        call feti_rows_add(problem, FETI_INEQUALITY, [1, 3], [b - 1, b], [unknown(i, n) + 1, unknown(i, 0) + 1], &
          [1.0_dp, -1.0_dp], [2e-5_dp * x * (1 - x)])
      end do
    end do
  end subroutine

end program
