!> 13 A block between two dies: only contact holds the block, and it turns by 60 degrees.
!>
!> The block, 20 x 10 mm with a round groove along its top and its bottom, is pressed by two round dies that lie in the
!> grooves and then turn together about its middle. It is a mesh of quadrilaterals of St. Venant and Kirchhoff's material
!> (Green's strain); the dies are rigid. As in example 08, the host iterates and the library solves each linear problem:
!>
!>     min 1/2 d'K d - f'd   with   -n_i'd <= g_i,   f = -internal forces(u),   then u := u + d
!>
!> The library makes the rows from top and bottom of the block and from the circles, as in example 18.
!>
!> K is the complete second derivative, so that the iteration converges quadratically: stiffness of the material, stress term
!> (geometric stiffness), and curvature of the dies under the forces of the last iterate, -lambda (I - n n')/r. The block
!> is compressed, so the last two terms are negative on its rigid motions and make K indefinite. The rigid motions of the
!> position where K was assembled are therefore given as soft motions, FETI_SOFT: the library computes their stiffness from K
!> itself, and returns FETI_INDEFINITE if the closed rows do not hold them.
!>
!> A load step that returns FETI_INDEFINITE or takes more than `most` iterations is rejected: displacement and forces are
!> restored and the step is halved. The first step of each stage is the whole stage; for the rotation it is deliberately too
!> large.
!>
!> Known by hand: without friction the force of a round die passes through its axis. The block is in balance, so both
!> forces lie on the line of the axes, equal and opposite. Because the dies turn together, the block has the shape and
!> the forces that it had before the rotation, rotated by the angle of the dies.
program block_between_dies
  use demo
  use feti_contact
  use vtu_picture, only: nan_of, picture_pvd, picture_step
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: nx = 24, ny = 8, nodes = (nx + 1) * (ny + 1), n = 2 * nodes, side = nx + 1, rows = 2 * side, most = 6
  real(dp), parameter :: young = 1000, poisson = 0.3_dp               ! MPa, -; plane strain, 1 mm thick
  real(dp), parameter :: width = 20, height = 10, groove = 12         ! mm; height in the middle, groove: radius of curvature
  real(dp), parameter :: radius(2) = [6.0_dp, 8.0_dp]                 ! mm, of the dies above and below
  real(dp), parameter :: full_depth = 1, full_turn = 60               ! mm, degrees: the dies come closer, then they turn
  real(dp), parameter :: least = 0.01_dp                              ! of a stage: no step is smaller
  real(dp), parameter :: degree = 3.14159265358979323846_dp / 180     ! rad

  !> Where the dies are: mm, degrees.
  type :: place
    real(dp) :: depth = 0, angle = 0
  end type

  !> Lower triangle of K by rows: node (i, j) has entries with the nodes left of it and below it, and with itself.
  integer :: ptr(n + 1), col(10 * n), entries
  real(dp) :: val(10 * n)

  type(feti_problem) :: problem
  type(feti_info) :: info
  type(place) :: dies
  real(dp) :: u(2, nodes), pressed(2, nodes), internal(2, nodes), lambda(rows), before(rows), force(2, 2), error, size_of_force
  integer :: body, steps, rejected, longest, block_side(2), die(2)
  logical :: right, quadratic

  u = 0
  lambda = 0
  steps = 0
  rejected = 0
  longest = 0
  quadratic = .true.
  call make_pattern
  call assemble
  call feti_problem_create(problem)
  call feti_body_add(problem, n, body)
  call feti_body_stiffness(problem, body, ptr, col(:entries), val(:entries), FETI_LOWER)
  call add_surfaces
  call go(place(0.0_dp, 0.0_dp), place(full_depth, 0.0_dp), right)
  pressed = u
  before = lambda
  if (right) call go(place(full_depth, 0.0_dp), place(full_depth, full_turn), right)
  call feti_problem_destroy(problem)

  call unbalanced(force, error)
  size_of_force = norm2(force(:, 1))
  error = max(error, norm2(force(:, 1) + force(:, 2)) / size_of_force, &
    norm2(force(:, 1) / size_of_force + axis_of(1) / norm2(axis_of(1))), not_turned(), demo_error(lambda, before))
  call picture_pvd(picture_folder(), 'block_between_dies_fortran', steps)
  call demo_value('load steps', real(steps, dp), '-')
  call demo_value('rejected load steps', real(rejected, dp), '-')
  call demo_value('most iterations of a load step', real(longest, dp), '-')
  call demo_value('force of either die', size_of_force, 'N')
  call demo_value('its angle against the first', atan2(force(1, 1), -force(2, 1)) / degree, 'degrees')
  call demo_line('13_block_between_dies', info, error, right .and. quadratic .and. rejected > 0)

contains

  !> A stage: the dies go from a place to another by load steps, halved where one fails. there: they have come there.
  subroutine go(from, to, there)
    type(place), intent(in) :: from, to
    logical, intent(out) :: there
    real(dp) :: saved_u(2, nodes), saved_lambda(rows), done, step
    integer :: stat, iterations
    logical :: fast

    done = 0
    step = 1
    do while (done < 1 .and. step >= least)
      dies = place(from%depth + (done + step) * (to%depth - from%depth), from%angle + (done + step) * (to%angle - from%angle))
      saved_u = u
      saved_lambda = lambda
      print '(a, f6.4, a, f7.4, a)', 'depth ', dies%depth, ' mm, angle ', dies%angle, ' degrees'
      print '(a)', '           |d| / mm  unbalanced closed  status'
      call newton(stat, iterations, fast)
      if (stat == FETI_OK) then
        call draw(steps)
        done = done + step
        steps = steps + 1
        longest = max(longest, iterations)
        quadratic = quadratic .and. fast
      else
        print '(a)', 'rejected, halved'
        u = saved_u
        lambda = saved_lambda
        step = step / 2
        rejected = rejected + 1
      end if
    end do
    there = done >= 1
  end subroutine

  !> Newton's method for the place of the dies; prints a line per iteration. stat: FETI_OK, or the status of the library for a step
  !> that is too large, or FETI_ITERATIONS. fast: no change is more than twice its predecessor squared (mm), once that is
  !> below 1 mm. Less than 1e-9 is printed as 1e-9.
  subroutine newton(stat, iterations, fast)
    integer, intent(out) :: stat, iterations
    logical, intent(out) :: fast
    real(dp) :: d(n), force(2, 2), error, change, last

    fast = .true.
    change = huge(change)
    do iterations = 1, most
      last = change
      call assemble
      call add_curvature
      call feti_body_values(problem, body, val(:entries))
      call give_motions
      call feti_body_load(problem, body, -reshape(internal, [n]))
      call find_rows
      call feti_start_from(problem, FETI_INEQUALITY, lambda)   ! the pairs are those of the last iterate
      call feti_solve(problem, info, stat=stat)
      if (stat /= FETI_OK) then
        print '(i5, t40, a)', iterations, feti_status_name(stat)
        return
      end if
      call feti_displacement(problem, body, d)
      call feti_multipliers(problem, FETI_INEQUALITY, lambda)
      u = u + reshape(d, [2, nodes])
      change = maxval(abs(d))
      call unbalanced(force, error)
      print '(i5, 6x, a, 5x, a, i7, 2x, a)', iterations, power_of_ten(max(change, 1e-9_dp)), &
        power_of_ten(max(error, 1e-9_dp)), info%active, feti_status_name(stat)
      if (last < 1 .and. change > 2 * last**2 + 1e-10_dp) fast = .false.
      if (change < 1e-6_dp) return
    end do
    stat = FETI_ITERATIONS
  end subroutine

  !> Node (i, j) among all, 0 for others; its unknowns are 2 node - 1 and 2 node.
  pure integer function node_at(i, j)
    integer, intent(in) :: i, j

    node_at = 0
    if (i >= 0 .and. i <= nx .and. j >= 0 .and. j <= ny) node_at = i * (ny + 1) + j + 1
  end function

  !> Position of a node at rest, the middle of the block being the origin.
  pure function at_rest(node) result(x)
    integer, intent(in) :: node
    real(dp) :: x(2)

    x(1) = width * (real((node - 1) / (ny + 1), dp) / nx - 0.5_dp)
    x(2) = (height + x(1)**2 / groove) * (real(mod(node - 1, ny + 1), dp) / ny - 0.5_dp)
  end function

  subroutine make_pattern
    integer :: i, j, b, d, e, near(5)

    entries = 0
    do i = 0, nx
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

  !> K and internal forces of the block at u.
  subroutine assemble
    real(dp), parameter :: gauss = sqrt(1 / 3.0_dp)
    integer :: i, j, p, node(4)

    val = 0
    internal = 0
    do i = 0, nx - 1
      do j = 0, ny - 1
        node = [node_at(i, j), node_at(i + 1, j), node_at(i + 1, j + 1), node_at(i, j + 1)]
        do p = 0, 3
          call add_point(node, merge(gauss, -gauss, mod(p, 2) == 1), merge(gauss, -gauss, p > 1))
        end do
      end do
    end do
  end subroutine

  !> Adds one point of integration (s, t) of a quadrilateral. With the gradients g_a of the shape functions at rest and
  !> F = sum x_a g_a': Green's strain E = (F'F - I)/2, stress S = lame tr(E) I + 2 shear E, weight w,
  !>
  !>     f_a = w F S g_a,   K_ab = w (lame F g_a (F g_b)' + shear (F g_b (F g_a)' + g_a'g_b F F') + g_a'S g_b I)
  subroutine add_point(node, s, t)
    integer, intent(in) :: node(4)
    real(dp), intent(in) :: s, t
    real(dp), parameter :: unit(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    real(dp), parameter :: corner(2, 4) = reshape([-1, -1, 1, -1, 1, 1, -1, 1] * 1.0_dp, [2, 4])
    real(dp), parameter :: shear = young / (2 * (1 + poisson)), lame = 2 * shear * poisson / (1 - 2 * poisson)
    real(dp) :: x(2, 4), g(2, 4), slope(2, 4), jacobian(2, 2), F(2, 2), FF(2, 2), Fg(2, 4), strain(2, 2), Sg(2, 4), w, value
    integer :: a, b, c, d

    do a = 1, 4
      x(:, a) = at_rest(node(a))
    end do
    slope(1, :) = corner(1, :) * (1 + corner(2, :) * t) / 4
    slope(2, :) = corner(2, :) * (1 + corner(1, :) * s) / 4
    jacobian = matmul(slope, transpose(x))
    w = jacobian(1, 1) * jacobian(2, 2) - jacobian(1, 2) * jacobian(2, 1)
    g(1, :) = (jacobian(2, 2) * slope(1, :) - jacobian(1, 2) * slope(2, :)) / w
    g(2, :) = (jacobian(1, 1) * slope(2, :) - jacobian(2, 1) * slope(1, :)) / w
    F = matmul(x + u(:, node), transpose(g))
    FF = matmul(F, transpose(F))
    strain = (matmul(transpose(F), F) - unit) / 2
    Sg = matmul(lame * (strain(1, 1) + strain(2, 2)) * unit + 2 * shear * strain, g)
    Fg = matmul(F, g)
    internal(:, node) = internal(:, node) + w * matmul(F, Sg)
    do a = 1, 4
      do b = 1, 4
        do c = 1, 2
          do d = 1, 2
            value = lame * Fg(c, a) * Fg(d, b) + shear * (Fg(c, b) * Fg(d, a) + dot_product(g(:, a), g(:, b)) * FF(c, d)) &
              + dot_product(Sg(:, a), g(:, b)) * unit(c, d)
            call add(2 * node(a) - 2 + c, 2 * node(b) - 2 + d, w * value)
          end do
        end do
      end do
    end do
  end subroutine

  !> Row r is about a node of the top (r <= side) or of the bottom: its node.
  pure integer function node_of(r)
    integer, intent(in) :: r

    node_of = node_at(mod(r - 1, side), merge(ny, 0, r <= side))
  end function

  !> The die of row r: 1 above, 2 below.
  pure integer function die_of(r)
    integer, intent(in) :: r

    die_of = 1 + (r - 1) / side
  end function

  !> Axis of the die above (1) or below (2).
  function axis_of(die) result(c)
    integer, intent(in) :: die
    real(dp) :: c(2)

    c = (height / 2 + radius(die) - dies%depth / 2) * [-sin(dies%angle * degree), cos(dies%angle * degree)]
    if (die == 2) c = -c
  end function

  !> Distance of the node of row r from the axis of its die, and its direction away from it.
  subroutine from_axis(r, distance, normal)
    integer, intent(in) :: r
    real(dp), intent(out) :: distance, normal(2)

    normal = at_rest(node_of(r)) + u(:, node_of(r)) - axis_of(die_of(r))
    distance = norm2(normal)
    normal = normal / distance
  end subroutine

  !> The forces of the rows bend with the normals: -lambda (I - n n') / r.
  subroutine add_curvature
    real(dp) :: normal(2), distance
    integer :: r, c, d, first

    do r = 1, rows
      call from_axis(r, distance, normal)
      first = 2 * node_of(r) - 2
      do c = 1, 2
        do d = 1, 2
          call add(first + c, first + d, -lambda(r) / distance * (merge(1, 0, c == d) - normal(c) * normal(d)))
        end do
      end do
    end do
  end subroutine

  !> Top and bottom of the block as surfaces, the dies as circles: a contact row per node of top and bottom, in the order of node_of. In the
  !> plane the body is on the left of its faces.
  subroutine add_surfaces
    integer :: i, r, pair, own(2, nodes), top(2, nx), bottom(2, nx)

    own = reshape([(i, i=1, n)], [2, nodes])
    top = reshape([(node_at(i, ny), node_at(i - 1, ny), i=1, nx)], [2, nx])
    bottom = reshape([(node_at(i - 1, 0), node_at(i, 0), i=1, nx)], [2, nx])
    do r = 1, 2
      call feti_surface_add(problem, body, positions(), own, block_side(r))
      call feti_surface_faces(problem, block_side(r), FETI_LINE2, merge(top, bottom, r == 1))
      call feti_surface_rigid(problem, FETI_SPHERE, [axis_of(r), radius(r)], die(r))
    end do
    do r = 1, 2
      call feti_pair_add(problem, block_side(r), die(r), FETI_NODE_TO_FACE, width, pair)
    end do
  end subroutine

  !> Rows where block and dies are now: -n_i'd <= g_i.
  subroutine find_rows
    integer :: r

    do r = 1, 2
      call feti_surface_move(problem, block_side(r), positions())
      call feti_surface_move(problem, die(r), [axis_of(r), radius(r)])
    end do
    call feti_pairs_find(problem)
  end subroutine

  !> Of all nodes.
  function positions() result(x)
    real(dp) :: x(2, nodes)
    integer :: k

    do k = 1, nodes
      x(:, k) = at_rest(k) + u(:, k)
    end do
  end function

  !> A step of the film: the block, and what the dies do to its top and its bottom.
  subroutine draw(step)
    integer, intent(in) :: step
    real(dp), parameter :: shear = young / (2 * (1 + poisson)), lame = 2 * shear * poisson / (1 - 2 * poisson)
    real(dp) :: forces(2, nodes), push(nodes), gap(nodes), distance, normal(2)
    integer :: corner(4, nx * ny), state(nodes), i, j, k, r

    forces = 0
    push = 0
    gap = nan_of()
    state = -1
    corner = reshape([((node_at(i, j) + [0, ny + 1, ny + 2, 1], j=0, ny - 1), i=0, nx - 1)], [4, nx * ny])
    do r = 1, rows
      k = node_of(r)
      call from_axis(r, distance, normal)
      gap(k) = distance - radius(die_of(r))
      push(k) = lambda(r)
      state(k) = merge(FETI_ROW_CLOSED, FETI_ROW_OPEN, push(k) > 0)
      forces(:, k) = push(k) * normal
    end do
    call picture_step(picture_folder(), 'block_between_dies_fortran', step, nx * ny, corner, positions() - u, u, forces, push, &
      gap, state, shear, lame)
  end subroutine

  !> The rigid motions of the block where it is: two translations, and the rotation about the origin, (-y, x).
  subroutine give_motions
    real(dp) :: motion(2, nodes, 3), x(2)
    integer :: k

    motion = 0
    motion(1, :, 1) = 1
    motion(2, :, 2) = 1
    do k = 1, nodes
      x = at_rest(k) + u(:, k)
      motion(:, k, 3) = [-x(2), x(1)]
    end do
    call feti_body_null_space(problem, body, reshape(motion, [n, 3]), FETI_SOFT)
  end subroutine

  !> What block and dies leave unbalanced, against the largest internal force, and depth of penetration against the height of
  !> the block: both zero in the solution. total: what each die does to the block, in N.
  subroutine unbalanced(total, largest)
    real(dp), intent(out) :: total(2, 2), largest
    real(dp) :: normal(2), distance, inside, size
    integer :: r

    call assemble
    size = maxval(abs(internal))
    total = 0
    inside = 0
    do r = 1, rows
      call from_axis(r, distance, normal)
      inside = max(inside, radius(die_of(r)) - distance)
      internal(:, node_of(r)) = internal(:, node_of(r)) - lambda(r) * normal
      total(:, die_of(r)) = total(:, die_of(r)) + lambda(r) * normal
    end do
    largest = max(maxval(abs(internal)) / size, inside / height)
  end subroutine

  !> How far the block is from having turned as one since it was pressed, against its width.
  real(dp) function not_turned()
    real(dp) :: c, s, turn(2, 2)
    integer :: k

    c = cos(dies%angle * degree)
    s = sin(dies%angle * degree)
    turn = reshape([c, s, -s, c], [2, 2])
    not_turned = 0
    do k = 1, nodes
      not_turned = max(not_turned, norm2(at_rest(k) + u(:, k) - matmul(turn, at_rest(k) + pressed(:, k))) / width)
    end do
  end function

end program
