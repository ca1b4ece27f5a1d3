!> 08 A Newton loop: a strip of bars is pressed down by a round die, with large displacements.
!>
!> The strip is a lattice of 24 x 4 cells of 1 mm with clamped ends. The bars have stiffness EA and Green strain, so
!> that the tangent K(u) changes with the displacement. The die, a cylinder of radius 10 mm, comes from above: the
!> normals of the contact rows also change with the displacement. The host iterates, and the library solves each linear
!> problem with contact:
!>
!>     min 1/2 d'K d - f'd   with   -n_i'd <= g_i,   f = -internal forces(u),   then u := u + d
!>
!> K includes the curvature of the die under the forces of the last iterate, -lambda (I - n n')/r; with this term the iteration
!> converges quadratically.
!>
!> 1. Small displacements: K is constant, only normals change. All iterations together need one factorisation.
!> 2. Large displacements: feti_body_values passes K on its old pattern. Each iteration needs one factorisation, no analysis.
!> 3. A load step that fails is rejected: feti_state_restore restores rows, gaps and forces, and the step is halved. A step
!>    smaller than least ends the program: at a limit load no step is small enough.
!> 4. Large displacements with friction. The slip function of a node is s = radius times its angle about the axis of the die;
!>    its tangential row is the gradient T = radius/r t', t perpendicular to n. In every iteration the host passes s_begin -
!>    s(u), minus the slip since the load step began, to feti_friction_reference. K includes the rotation of the tangential
!>    forces, -lambda_t radius/r^2 (n t' + t n'). This part ends at 6 mm: close to 8 mm bars that friction compresses buckle,
!>    and K is indefinite however small the step.
program newton_loop
  use demo
  use feti_contact
  use vtu_picture, only: nan_of, picture_pvd, picture_step
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: nx = 24, ny = 4, nodes = (nx - 1) * (ny + 1), n = 2 * nodes, rows = nx - 1, most = 8
  real(dp), parameter :: ea = 1000, radius = 10, full_depth = 8, least = 0.01_dp   ! N, mm, mm, mm
  real(dp), parameter :: with_friction = 0.3_dp, less_depth = 6   ! -, mm: coefficient, the depth with friction

  !> Lower triangle of K by rows: node (i, j) has entries with the nodes left of it and below it, and with itself.
  integer :: ptr(n + 1), col(10 * n), entries
  real(dp) :: val(10 * n)

  !> What a loop cost: feti_info counts what the problem has done in all.
  type :: cost
    integer :: iterations = 0, factorisations = 0, analyses = 0
  end type

  type(feti_problem) :: problem
  type(feti_info) :: info
  type(cost) :: spent
  real(dp) :: u(n), lambda(rows), f(n), depth, force, error, before_error
  integer :: body
  logical :: right

  ! Friction data of the loop: without friction mu and the forces are 0. Slips are radius times an angle, mm.
  real(dp) :: mu, lambda_t(rows), s_begin(rows)

  u = 0
  mu = 0
  call make_pattern
  call assemble(u, f)
  call feti_problem_create(problem)
  call feti_body_add(problem, n, body)
  call feti_body_stiffness(problem, body, ptr, col(:entries), val(:entries), FETI_LOWER)
  call feti_body_no_null_space(problem, body)   ! the ends are clamped

  call with_fixed_tangent(1.0_dp)
  call demo_value('small displacements, iterations', real(spent%iterations, dp), '-')
  call demo_value('  factorisations', real(spent%factorisations, dp), '-')
  call demo_value('  analyses', real(spent%analyses, dp), '-')
  right = spent%factorisations == 1 .and. spent%analyses == 1

  call press(full_depth)
  before_error = error
  call demo_value('force on the die', force, 'N')
  mu = with_friction
  print '(a)', 'with friction: iteration, |d| / mm, nodes that stick, that slip'
  call press(less_depth)
  call demo_value('force on the die', force, 'N')
  call demo_value('nodes that stick', real(info%sticking, dp), '-')
  call demo_value('nodes that slip', real(info%slipping, dp), '-')
  call feti_problem_destroy(problem)
  call demo_line('08_newton_loop', info, max(error, before_error), right)

contains

  !> Small displacements: K of the unloaded strip stays, the unknown is u itself.
  subroutine with_fixed_tangent(at_depth)
    real(dp), intent(in) :: at_depth
    type(feti_info) :: before
    real(dp) :: next(n), zero(n), change

    zero = 0
    change = 1
    spent = cost()
    do while (change > 1e-9_dp .and. spent%iterations < 30)
      before = info
      call give_rows(zero, at_depth)
      call feti_solve(problem, info)
      call feti_displacement(problem, body, next)
      change = maxval(abs(next - u))
      u = next
      call add_cost(before)
    end do
  end subroutine

  !> A step of the film: the cells of the lattice with its clamped ends, and what the die does to the top.
  subroutine draw(step)
    integer, intent(in) :: step
    integer, parameter :: all = (nx + 1) * (ny + 1)
    real(dp) :: x(2, all), moved(2, all), forces(2, all), push(all), gap(all), r, normal(2)
    integer :: corner(4, nx * ny), state(all), i, j, a, node

    moved = 0
    forces = 0
    push = 0
    gap = nan_of()
    state = -1
    do i = 0, nx
      do j = 0, ny
        a = i * (ny + 1) + j + 1
        node = node_at(i, j)
        x(:, a) = [i, j]
        if (i < nx .and. j < ny) corner(:, i * ny + j + 1) = a + [0, ny + 1, ny + 2, 1]
        if (node > 0) moved(:, a) = u(2 * node - 1:2 * node)
      end do
    end do
    do i = 1, rows
      a = (i + 1) * (ny + 1)
      call from_axis(depth, i, r, normal)
      gap(a) = r - radius
      push(a) = lambda(i)
      state(a) = merge(FETI_ROW_CLOSED, FETI_ROW_OPEN, push(a) > 0)
      forces(:, a) = push(a) * normal
    end do
    call picture_step(picture_folder(), 'newton_loop_fortran', step, nx * ny, corner, x, moved, forces, push, gap, state, &
      0.0_dp, 0.0_dp)
  end subroutine

  !> Presses the strip to a depth by load steps, halved where one fails; prints a line for each, and draws it if there is no friction.
  !> Force on the die, and what is left unbalanced.
  subroutine press(to)
    real(dp), intent(in) :: to
    real(dp) :: saved_u(n), saved_lambda(rows), saved_lambda_t(rows), step
    integer :: state, stat, steps, rejected
    logical :: quadratic

    u = 0
    lambda = 0
    lambda_t = 0
    depth = 0
    step = to
    steps = 0
    rejected = 0
    call feti_body_load(problem, body, u)
    call give_rows(u, 0.0_dp)
    do while (depth < to .and. step >= least)
      s_begin = slip_functions(depth)
      call feti_state_save(problem, state)
      saved_u = u
      saved_lambda = lambda
      saved_lambda_t = lambda_t
      call newton(depth + step, stat, quadratic)
      if (stat == FETI_OK) then
        depth = depth + step
        if (mu <= 0) call draw(steps)
        steps = steps + 1
        right = right .and. quadratic .and. spent%factorisations == spent%iterations .and. spent%analyses == 0
        call unbalanced(force, error)
        print '(a, f6.4, 3(a, i0), a, f0.4, a)', 'step to ', depth, ' mm: ', spent%iterations, ' iterations, ', &
          spent%factorisations, ' factorisations, ', spent%analyses, ' analyses, force ', force, ' N'
      else
        print '(a, f6.4, 3a, i0, a)', 'step to ', depth + step, ' mm: ', feti_status_name(stat), ' after ', &
          spent%iterations, ' iterations, halved'
        call feti_state_restore(problem, state)
        u = saved_u
        lambda = saved_lambda
        lambda_t = saved_lambda_t
        step = step / 2
        rejected = rejected + 1
      end if
      call feti_state_drop(problem, state)
    end do
    if (mu <= 0) call picture_pvd(picture_folder(), 'newton_loop_fortran', steps)
    call demo_value('load steps', real(steps, dp), '-')
    call demo_value('rejected load steps', real(rejected, dp), '-')
    right = right .and. depth >= to
    call unbalanced(force, error)
  end subroutine

  !> Newton's method at a depth of the die. stat: FETI_OK, the status of the library for a step that is too large, or
  !> FETI_ITERATIONS. fast: no change was more than its predecessor squared, once that was small.
  subroutine newton(at_depth, stat, fast)
    real(dp), intent(in) :: at_depth
    integer, intent(out) :: stat
    logical, intent(out) :: fast
    type(feti_info) :: before
    real(dp) :: d(n), change, last

    spent = cost()
    fast = .true.
    change = 1
    do while (spent%iterations < most)
      last = change
      before = info
      call assemble(u, f)
      call add_curvature(at_depth)
      call feti_body_values(problem, body, val(:entries))
      call feti_body_load(problem, body, -f)
      call give_rows(u, at_depth)
      if (mu > 0) then
        call give_friction(at_depth)
        call feti_start_from(problem, FETI_TANGENTIAL, lambda_t)
      end if
      call feti_start_from(problem, FETI_INEQUALITY, lambda)   ! the pairs are those of the last iterate
      call feti_solve(problem, info, stat=stat)   ! FETI_INDEFINITE: the step is too large
      if (stat < 0) info = before   ! the counts of a call that failed are zero
      call add_cost(before)
      if (stat /= FETI_OK) return
      call feti_displacement(problem, body, d)
      call feti_multipliers(problem, FETI_INEQUALITY, lambda)
      if (mu > 0) call feti_multipliers(problem, FETI_TANGENTIAL, lambda_t)
      u = u + d
      change = maxval(abs(d))
      if (mu > 0) print '(i5, 6x, a, 2i10)', spent%iterations, power_of_ten(max(change, 1e-9_dp)), info%sticking, info%slipping
      if (last < 1e-2_dp .and. change > 10 * last**2 + 1e-12_dp) fast = .false.
      if (change < 1e-6_dp) return
    end do
    stat = FETI_ITERATIONS
  end subroutine

  subroutine add_cost(before)
    type(feti_info), intent(in) :: before

    spent%iterations = spent%iterations + 1
    spent%factorisations = spent%factorisations + int(info%factorisations - before%factorisations)
    spent%analyses = spent%analyses + int(info%analyses - before%analyses)
  end subroutine

  !> Free node (i, j), 0 < i < nx, among all, 0 for others; its unknowns are 2 node - 1 and 2 node.
  pure integer function node_at(i, j)
    integer, intent(in) :: i, j

    node_at = 0
    if (i > 0 .and. i < nx .and. j >= 0 .and. j <= ny) node_at = (i - 1) * (ny + 1) + j + 1
  end function

  subroutine make_pattern
    integer :: i, j, b, d, e, near(5)

    entries = 0
    do i = 1, nx - 1
      do j = 0, ny
        near = [node_at(i - 1, j - 1), node_at(i - 1, j), node_at(i - 1, j + 1), node_at(i, j - 1), node_at(i, j)]
        do d = 1, 2
          ptr(2 * near(5) - 2 + d) = entries + 1
          do b = 1, 5
            do e = 1, merge(d, 2, b == 5)
              if (near(b) == 0) cycle
              entries = entries + 1
              col(entries) = 2 * near(b) - 2 + e
            end do
          end do
        end do
      end do
    end do
    ptr(n + 1) = entries + 1
  end subroutine

  subroutine add(row, column, value)
    integer, intent(in) :: row, column
    real(dp), intent(in) :: value
    integer :: at

    do at = ptr(row), ptr(row + 1) - 1
      if (col(at) == column) val(at) = val(at) + value
    end do
  end subroutine

  !> K and internal forces of the bars at x.
  subroutine assemble(x, internal)
    real(dp), intent(in) :: x(n)
    real(dp), intent(out) :: internal(n)
    integer :: i, j

    val = 0
    internal = 0
    do i = 0, nx - 1
      do j = 0, ny
        call add_bar(x, internal, i, j, i + 1, j)
        call add_bar(x, internal, i, j, i + 1, j + 1)
        call add_bar(x, internal, i, j, i + 1, j - 1)
        if (i > 0) call add_bar(x, internal, i, j, i, j + 1)
      end do
    end do
  end subroutine

  !> Adds a bar: Green strain e = (l^2 - L^2) / (2 L^2), force density q = EA e / L; the internal forces are q x per end,
  !> the tangent EA/L^3 x x' + q I, x from end to end in the deformed strip.
  subroutine add_bar(at, internal, i, j, i2, j2)
    real(dp), intent(in) :: at(n)
    real(dp), intent(inout) :: internal(n)
    integer, intent(in) :: i, j, i2, j2
    real(dp) :: x(2), length, q, value
    integer :: a, b, c, d

    a = node_at(i, j)
    b = node_at(i2, j2)
    if (j2 < 0 .or. j2 > ny .or. (a == 0 .and. b == 0)) return
    x = [i2 - i, j2 - j]
    length = norm2(x)
    if (b > 0) x = x + at(2 * b - 1:2 * b)
    if (a > 0) x = x - at(2 * a - 1:2 * a)
    q = ea * (dot_product(x, x) - length**2) / (2 * length**3)
    if (a > 0) internal(2 * a - 1:2 * a) = internal(2 * a - 1:2 * a) - q * x
    if (b > 0) internal(2 * b - 1:2 * b) = internal(2 * b - 1:2 * b) + q * x
    do c = 1, 2
      do d = 1, 2
        value = ea / length**3 * x(c) * x(d) + merge(q, 0.0_dp, c == d)
        if (a > 0) call add(2 * a - 2 + c, 2 * a - 2 + d, value)
        if (b > 0) call add(2 * b - 2 + c, 2 * b - 2 + d, value)
        if (a > 0 .and. b > 0) then
          call add(2 * a - 2 + c, 2 * b - 2 + d, -value)
          call add(2 * b - 2 + c, 2 * a - 2 + d, -value)
        end if
      end do
    end do
  end subroutine

  !> Distance of top node i from the axis of the die, and its direction away from it.
  subroutine from_axis(at_depth, i, r, normal)
    real(dp), intent(in) :: at_depth
    integer, intent(in) :: i
    real(dp), intent(out) :: r, normal(2)
    integer :: node

    node = node_at(i, ny)
    normal = u(2 * node - 1:2 * node) + [i - nx / 2.0_dp, at_depth - radius]
    r = norm2(normal)
    normal = normal / r
  end subroutine

  !> Slip functions of the top nodes.
  function slip_functions(at_depth) result(s)
    real(dp), intent(in) :: at_depth
    real(dp) :: s(rows), normal(2), r
    integer :: i

    do i = 1, rows
      call from_axis(at_depth, i, r, normal)
      s(i) = radius * atan2(normal(2), normal(1))
    end do
  end function

  !> The forces of the rows turn with normals and tangents: -lambda/r t t' - lambda_t radius/r^2 (n t' + t n').
  subroutine add_curvature(at_depth)
    real(dp), intent(in) :: at_depth
    real(dp) :: normal(2), along(2), r, bend, turn
    integer :: i, c, d, top

    do i = 1, nx - 1
      call from_axis(at_depth, i, r, normal)
      along = [-normal(2), normal(1)]
      bend = lambda(i) / r
      turn = lambda_t(i) * radius / r**2
      top = 2 * node_at(i, ny) - 2
      do c = 1, 2
        do d = 1, 2
          call add(top + c, top + d, -bend * along(c) * along(d) - turn * (normal(c) * along(d) + along(c) * normal(d)))
        end do
      end do
    end do
  end subroutine

  !> A row per top node: it moves no further towards the axis than its distance allows. `from` is the displacement that
  !> the unknowns are counted from.
  subroutine give_rows(from, at_depth)
    real(dp), intent(in) :: from(n), at_depth
    real(dp) :: normal(2), r, b(2, rows), gap(rows)
    integer :: i, k, top, dof(2, rows)

    do i = 1, rows
      call from_axis(at_depth, i, r, normal)
      top = 2 * node_at(i, ny) - 2
      dof(:, i) = top + [1, 2]
      b(:, i) = -normal
      gap(i) = r - radius - dot_product(normal, u(dof(:, i)) - from(dof(:, i)))
    end do
    call feti_rows_clear(problem, FETI_INEQUALITY)
    call feti_rows_add(problem, FETI_INEQUALITY, [(2 * k + 1, k=0, rows)], [(body, k=1, 2 * rows)], &
      reshape(dof, [2 * rows]), reshape(b, [2 * rows]), gap)
  end subroutine

  !> A tangential row beside each contact row, and what has slipped in this load step before u.
  subroutine give_friction(at_depth)
    real(dp), intent(in) :: at_depth
    real(dp) :: normal(2), r, along(2, rows)
    integer :: i, k, top, dof(2, rows)

    do i = 1, rows
      call from_axis(at_depth, i, r, normal)
      top = 2 * node_at(i, ny) - 2
      dof(:, i) = top + [1, 2]
      along(:, i) = radius / r * [-normal(2), normal(1)]
    end do
    call feti_friction_add(problem, [(k, k=1, rows)], [(2 * k + 1, k=0, rows)], [(body, k=1, 2 * rows)], &
      reshape(dof, [2 * rows]), reshape(along, [2 * rows]), [(mu, k=1, rows)])
    call feti_friction_reference(problem, 1, reshape(s_begin - slip_functions(at_depth), [1, rows]))
  end subroutine

  !> Largest force that bars and die leave unbalanced, and depth of penetration, relative: both zero in the solution.
  subroutine unbalanced(total, largest)
    real(dp), intent(out) :: total, largest
    real(dp) :: normal(2), on_node(2), r, inside, size
    integer :: i, top

    call assemble(u, f)
    size = maxval(abs(f))
    total = 0
    inside = 0
    do i = 1, rows
      call from_axis(depth, i, r, normal)
      top = 2 * node_at(i, ny)
      inside = max(inside, radius - r)
      on_node = lambda(i) * normal - lambda_t(i) * radius / r * [-normal(2), normal(1)]
      f(top - 1:top) = f(top - 1:top) - on_node
      total = total - on_node(2)
    end do
    largest = max(maxval(abs(f)) / size, inside / radius)
  end subroutine

end program
