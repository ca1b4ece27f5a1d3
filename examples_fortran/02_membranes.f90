!> 02 Two membranes (Problem 1 of the paper): a scalar contact problem, matrices built here.
!>
!> Two square membranes hang side by side, Omega_1 = (0,1) x (0,1) and Omega_2 = (1,2) x (0,1). Omega_1
!> is held at x = 0; only the contact holds Omega_2. Along x = 1 the left membrane must stay below the
!> right membrane:
!>
!>     u1(1,y) - u2(1,y) <= 0   on the 21 nodes with x = 1
!>
!> Grid of h = 1/20, five-point differences, so K is the Laplacian of the grid's graph: every grid line
!> between two neighbours is an edge of weight 1. Load per node h^2 P: P = -3 on Omega_1 for y = .75
!> to .95, P = -1 on Omega_2 for y = .05 to .20, inside the squares. No units.
program membranes
  use case_reader, only: contact_case, read_case
  use demo
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: side = 20, line = side + 1  ! nodes on a line x = const
  integer, parameter :: left = side * line, right = line * line  ! unknowns: x = 0 is held and struck out
  type(feti_problem) :: problem
  type(feti_info) :: info
  type(contact_case) :: reference
  integer :: omega1, omega2, row, row_ptr(line + 1), dof(2 * line)
  real(dp) :: val(2 * line), load_left(left), load_right(right), constant(right, 1)
  real(dp) :: u(left + right), lambda(line), error

  load_left = 0
  load_right = 0
  call pull(load_left, 1, side - 1, 15, 19, -3.0_dp)
  call pull(load_right, 2, line - 1, 1, 4, -1.0_dp)

  call feti_problem_create(problem)
  call feti_set(problem, 'tolerance', 1e-10_dp)

  call feti_body_add(problem, left, omega1)
  call give_stiffness(omega1, side, .true.)
  call feti_body_no_null_space(problem, omega1)
  call feti_body_load(problem, omega1, load_left)

  ! A membrane that nothing holds may move as a whole: its null space is the constant.
  constant = 1
  call feti_body_add(problem, right, omega2)
  call give_stiffness(omega2, line, .false.)
  call feti_body_null_space(problem, omega2, constant, FETI_EXACT)
  call feti_body_load(problem, omega2, load_right)

  ! One row per pair of nodes on x = 1. Without an array of bodies the unknowns count through all bodies
  ! one after the other: the first unknown of Omega_2 is number left + 1. Without right-hand sides the
  ! gaps are 0.
  row_ptr = [(2 * row - 1, row = 1, line + 1)]
  do row = 1, line
    dof(2 * row - 1:2 * row) = [left - line + row, left + row]
    val(2 * row - 1:2 * row) = [1.0_dp, -1.0_dp]
  end do
  call feti_rows_add(problem, FETI_INEQUALITY, row_ptr, dof, val)

  call feti_solve(problem, info)

  call feti_displacement(problem, omega1, u(:left))
  call feti_displacement(problem, omega2, u(left + 1:))
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)
  call feti_problem_destroy(problem)

  ! The contact carries the whole load of the floating membrane: the sum is .19.
  call demo_value('sum of the multipliers', sum(lambda), '-')
  call demo_value('largest multiplier', maxval(lambda), '-')
  call demo_value('energy', info%energy, '-')

  ! The reference solution of the same problem, known to 13 digits.
  call read_case(data_folder(), 'p1_P3', reference)
  if (reference%n /= left + right .or. size(reference%lambda_ref) /= line) &
    call demo_stop('p1_P3 is not the problem of this example')
  error = max(demo_error(lambda, reference%lambda_ref), demo_error(u, reference%u_ref))
  call demo_line('02_membranes', info, error, abs(sum(lambda) - 0.19_dp) < 1e-9_dp)

contains

  !> Hands over the lower triangle of a membrane of `columns` lines of nodes x = const; unknown
  !> line (ix-1) + iy, iy upwards. With held_left there is one more line on the left whose displacement
  !> is 0: it was struck out, and of its edges only the diagonal entries remain.
  subroutine give_stiffness(body, columns, held_left)
    integer, intent(in) :: body, columns
    logical, intent(in) :: held_left
    integer :: start(columns * line + 1), col(3 * columns * line), ix, iy, i, entries
    real(dp) :: k(3 * columns * line)

    entries = 0
    do ix = 1, columns
      do iy = 1, line
        i = line * (ix - 1) + iy
        start(i) = entries + 1
        if (ix > 1) then
          entries = entries + 1
          col(entries) = i - line
          k(entries) = -1
        end if
        if (iy > 1) then
          entries = entries + 1
          col(entries) = i - 1
          k(entries) = -1
        end if
        entries = entries + 1
        col(entries) = i
        k(entries) = count([ix > 1 .or. held_left, ix < columns, iy > 1, iy < line])
      end do
    end do
    start(columns * line + 1) = entries + 1
    call feti_body_stiffness(problem, body, start, col, k, FETI_LOWER)
  end subroutine

  !> Adds the load h^2 P on the nodes of the lines ix_low to ix_high with y from iy_low h to iy_high h.
  subroutine pull(load, ix_low, ix_high, iy_low, iy_high, p)
    real(dp), intent(inout) :: load(:)
    integer, intent(in) :: ix_low, ix_high, iy_low, iy_high
    real(dp), intent(in) :: p
    integer :: ix, iy

    do ix = ix_low, ix_high
      do iy = iy_low, iy_high
        load(line * (ix - 1) + iy + 1) = load(line * (ix - 1) + iy + 1) + p / side**2
      end do
    end do
  end subroutine

end program
