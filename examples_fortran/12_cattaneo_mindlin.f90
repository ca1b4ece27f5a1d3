!> 12 Cattaneo and Mindlin: two cylinders are pressed together and pushed back and forth; comparison with the closed forms.
!>
!>     Q -->  ( upper cylinder )            pressure    p = p0 sqrt(1 - x^2/a^2),           P = pi/2 p0 a
!>             ------ 2a ------             push Q:     q = mu p(x) less mu p0 c/a sqrt(1 - x^2/c^2) where |x| < c,
!>            ( lower cylinder )  <-- Q                 c = a sqrt(1 - Q/(mu P)): it sticks within c, slips between c and a
!>                                          back to Q:  q = q(Q1) - 2 q((Q1 - Q)/2), Q1 being where the push has turned (Mindlin)
!>
!> Close to the contact both bodies are elastic half planes. The host has influence matrices, as from boundary elements: A f
!> are the displacements of n = 400 cells over 3a by the forces f on them, in either direction, relative to a far point of the
!> body, which also moves. In one direction the energy of a body is (u - w)'A^-1 (u - w) / 2, where w is the motion of the far
!> point on every cell:
!>
!>         [  A^-1       -A^-1 1 ]                  n cells and the far point; K 1 = 0:
!>     K = [                     ]                  the body floats
!>         [ -1'A^-1    1'A^-1 1 ]
!>
!> The loads P and Q act at the far point of the upper cylinder, which only contact and friction hold. Two equality rows hold
!> the far point of the lower cylinder. The displacement that a force causes perpendicular to its direction is left out: it
!> is equal on both surfaces, so it affects no row.
!>
!> Steps of the push, relative to mu P: 0 (pressed only), .3, .6, .9, back by steps of .45 to -.9, and to .9 again. After
!> each step feti_friction_commit makes the current slips the reference of the next step.
!>
!> Units: N, mm, MPa; 1 mm thick.
program cattaneo_and_mindlin
  use demo
  use feti_contact
  use picture, only: picture_svg
  use vtu_picture
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: cells = 400, far = cells + 1, n = 2 * far, steps = 12, samples = 401
  integer, parameter :: turn = 5, return = 9   ! the first steps of the ways back and to again
  real(dp), parameter :: pi = acos(-1.0_dp)
  real(dp), parameter :: young = 210000, poisson = 0.3_dp, radius = 200, mu = 0.3_dp   ! MPa, -, mm (of both cylinders), -
  real(dp), parameter :: half = 1, reach = 1000                                        ! mm: a; distance of the far point
  real(dp), parameter :: part(steps) = [0.0_dp, 0.3_dp, 0.6_dp, 0.9_dp, 0.45_dp, 0.0_dp, -0.45_dp, -0.9_dp, -0.45_dp, 0.0_dp, &
    0.45_dp, 0.9_dp]

  ! What follows from these: modulus of a half plane E/(1 - nu^2), the largest pressure, load, width of a cell, mu p0 / E* in mm.
  real(dp), parameter :: modulus = young / (1 - poisson**2), p0 = modulus * half / (2 * radius), load = 0.5_dp * pi * p0 * half
  real(dp), parameter :: cell = 3 * half / cells, unit = mu * p0 / (0.5_dp * modulus)

  !> What a step has come to.
  type :: step_result
    real(dp) :: shear(cells)             ! over mu p0
    real(dp) :: missed, size             ! root mean square over 2a of its error, and of the closed form
    real(dp) :: pressed, stuck, shift, sums   ! half-widths of contact and stick, mm; shift, mm; relative error of both sums
    real(dp) :: pressure(cells), gap(cells), u(n, 2)   ! MPa, mm, mm: upper cylinder, lower one
    integer :: state(cells)                   ! FETI_FRICTION_OPEN, _STICK, _SLIP, ..
  end type

  type(feti_problem) :: problem
  type(feti_info) :: info
  type(step_result) :: found(steps)
  real(dp) :: x(cells), sums, width
  logical :: right
  integer :: i, step

  x = [(-1.5_dp * half + (i - 0.5_dp) * cell, i=1, cells)]
  call feti_problem_create(problem)
  call feti_set(problem, 'start', 'previous')   ! each step begins from the forces of the last one
  call add_cylinders
  call add_pairs
  right = .true.
  sums = 0
  do step = 1, steps
    call solve_step(step, found(step))
    right = right .and. info%status == FETI_OK .and. info%worst <= 1
    sums = max(sums, found(step)%sums)
  end do
  call feti_problem_destroy(problem)

  call demo_value('load P', load, 'N/mm')
  call demo_value('largest pressure p0', p0, 'MPa')
  call demo_value('half-width of contact, computed', found(1)%pressed, 'mm')
  do step = 2, turn - 1
    width = half_width(part(step))
    print '(a, f3.1, a)', 'push ', part(step), ' mu P'
    call demo_value('  error of the shear, rms', found(step)%missed / found(step)%size, '-')
    call demo_value('  half-width that sticks', found(step)%stuck, 'mm')
    call demo_value('  by hand', width, 'mm')
    right = right .and. found(step)%missed / found(step)%size <= 2.5e-3_dp .and. abs(found(step)%stuck - width) <= cell
  end do
  print '(a)', 'to and fro   error/(mu p0), rms    shift / um       by hand'
  do step = turn, steps
    print '(f10.2, f22.6, 2f14.6)', part(step), found(step)%missed, 1e3_dp * found(step)%shift, 1e3_dp * unit * shift(step)
    right = right .and. found(step)%missed <= 5e-3_dp .and. abs(found(step)%shift - unit * shift(step)) <= 1e-4_dp * unit
  end do
  do step = 1, steps
    call draw_step(step, found(step))
  end do
  call picture_pvd(picture_folder(), 'cattaneo_mindlin_fortran', steps)
  call draw_shear
  call draw_loop
  call demo_line('12_cattaneo_mindlin', info, sums, right .and. abs(found(1)%pressed - half) <= cell)

contains

  !> Displacement at a distance from the middle of a cell by a unit force spread over it, -2/(pi E') times the mean of
  !> ln(|x|/reach).
  pure real(dp) function influence(distance)
    real(dp), intent(in) :: distance
    real(dp) :: end(2)

    end = distance + [0.5_dp, -0.5_dp] * cell
    end = end * (log(abs(end) / reach) - 1)
    influence = -2 / (pi * modulus * cell) * (end(1) - end(2))
  end function

  !> Inverse of A in place, by elimination without pivoting: A is symmetric and positive definite.
  subroutine invert(a)
    real(dp), intent(inout) :: a(:, :)
    real(dp) :: factor
    integer :: j, k

    do k = 1, size(a, 2)
      factor = 1 / a(k, k)
      a(k, k) = 1
      a(:, k) = a(:, k) * factor
      do j = 1, size(a, 2)
        if (j == k) cycle
        factor = a(k, j)
        a(k, j) = 0
        a(:, j) = a(:, j) - factor * a(:, k)
      end do
    end do
  end subroutine

  !> K of either cylinder: normal direction in unknowns 1 to far, along in far + 1 to n, the far point being the last of each.
  subroutine stiffness(k)
    real(dp), intent(out) :: k(n, n)
    real(dp), allocatable :: a(:, :)
    integer :: i, j, from

    allocate (a(cells, cells))
    do j = 1, cells
      do i = 1, cells
        a(i, j) = influence(x(i) - x(j))
      end do
    end do
    call invert(a)
    a = 0.5_dp * (a + transpose(a))
    k = 0
    do from = 0, far, far
      k(from + 1:from + cells, from + 1:from + cells) = a
      k(from + far, from + 1:from + cells) = -sum(a, dim=1)
      k(from + 1:from + cells, from + far) = -sum(a, dim=1)
      k(from + far, from + far) = sum(a)
    end do
  end subroutine

  !> Two equal bodies: upper 1, lower 2. The far point of the lower one is held.
  subroutine add_cylinders
    real(dp), allocatable :: k(:, :)
    real(dp) :: rigid(n, 2), zero(2)
    integer :: b, body

    allocate (k(n, n))
    call stiffness(k)
    rigid = 0
    rigid(:far, 1) = 1
    rigid(far + 1:, 2) = 1
    do b = 1, 2
      call feti_body_add(problem, n, body)
      call feti_body_stiffness(problem, body, k, FETI_LOWER)
      call feti_body_null_space(problem, body, rigid, FETI_EXACT)
    end do
    zero = 0
    call feti_rows_add(problem, FETI_EQUALITY, [1, 2, 3], [2, 2], [far, n], [1.0_dp, 1.0_dp], zero)
  end subroutine

  !> Cell by cell: the lower surface stays below the upper one, u_lower - u_upper <= x^2 / R, the gap of both together; and the
  !> slip of the upper surface on the lower one, u_upper - u_lower along x, with friction.
  subroutine add_pairs
    integer :: k, ptr(cells + 1), body(2, cells), across(2, cells)
    real(dp) :: normal(2, cells), coefficient(cells)

    ptr = [(2 * k + 1, k=0, cells)]
    do k = 1, cells
      body(:, k) = [1, 2]
      across(:, k) = k
      normal(:, k) = [-1.0_dp, 1.0_dp]
    end do
    coefficient = mu
    call feti_rows_add(problem, FETI_INEQUALITY, ptr, reshape(body, [2 * cells]), reshape(across, [2 * cells]), &
      reshape(normal, [2 * cells]), x**2 / radius)
    call feti_friction_add(problem, [(k, k=1, cells)], ptr, reshape(body, [2 * cells]), reshape(far + across, [2 * cells]), &
      reshape(-normal, [2 * cells]), coefficient)
  end subroutine

  pure real(dp) function half_width(q)
    real(dp), intent(in) :: q

    half_width = half * sqrt(1 - q)
  end function

  pure real(dp) function ellipse(at, width)
    real(dp), intent(in) :: at, width

    ellipse = 0
    if (width > 0) ellipse = sqrt(max(0.0_dp, 1 - (at / width)**2))
  end function

  !> Shear of Cattaneo and Mindlin over mu p0 for a push q mu P, q >= 0.
  pure real(dp) function cattaneo(q, at)
    real(dp), intent(in) :: q, at

    cattaneo = ellipse(at, half) - half_width(q) / half * ellipse(at, half_width(q))
  end function

  !> Shear on the path: to .9, back to -.9, to .9.
  pure real(dp) function mindlin(step, at)
    integer, intent(in) :: step
    real(dp), intent(in) :: at

    if (step < turn) then
      mindlin = cattaneo(part(step), at)
    else if (step < return) then
      mindlin = cattaneo(0.9_dp, at) - 2 * cattaneo((0.9_dp - part(step)) / 2, at)
    else
      mindlin = -cattaneo(0.9_dp, at) + 2 * cattaneo((0.9_dp + part(step)) / 2, at)
    end if
  end function

  !> How far the far points shift against each other, over mu p0 / E*: the displacement of the middle by an elliptic shear of
  !> half-width b is b (ln(2 reach / b) + 1/2) times its largest value.
  pure real(dp) function shift_by(q)
    real(dp), intent(in) :: q
    real(dp) :: c

    c = half_width(q)
    shift_by = half * (log(2 * reach / half) + 0.5_dp)
    if (c > 0) shift_by = shift_by - c * c / half * (log(2 * reach / c) + 0.5_dp)
  end function

  pure real(dp) function shift(step)
    integer, intent(in) :: step

    if (step < turn) then
      shift = shift_by(part(step))
    else if (step < return) then
      shift = shift_by(0.9_dp) - 2 * shift_by((0.9_dp - part(step)) / 2)
    else
      shift = -shift_by(0.9_dp) + 2 * shift_by((0.9_dp + part(step)) / 2)
    end if
  end function

  subroutine solve_step(step, out)
    integer, intent(in) :: step
    type(step_result), intent(out) :: out
    real(dp) :: f(n), lambda_n(cells), lambda_t(cells), closed(cells), push
    integer :: k

    push = part(step) * mu * load
    f = 0
    f(far) = -load
    f(n) = push
    call feti_body_load(problem, 1, f)
    call feti_solve(problem, info)
    call feti_friction_commit(problem)   ! the step is accepted: slips of the next one are counted from here
    call feti_multipliers(problem, FETI_INEQUALITY, lambda_n)
    call feti_multipliers(problem, FETI_TANGENTIAL, lambda_t)
    call feti_gaps(problem, out%gap)
    call feti_friction_states(problem, out%state)
    do k = 1, 2
      call feti_displacement(problem, k, out%u(:, k))
    end do
    closed = [(mindlin(step, x(k)), k=1, cells)]
    out%pressure = lambda_n / cell
    out%shear = lambda_t / cell / (mu * p0)
    out%missed = sqrt(sum((out%shear - closed)**2) * cell / (2 * half))
    out%size = sqrt(sum(closed**2) * cell / (2 * half))
    out%pressed = 0.5_dp * info%active * cell
    out%stuck = 0.5_dp * info%sticking * cell
    out%shift = out%u(n, 1)   ! the other far point is held
    out%sums = max(abs(sum(lambda_n) - load), abs(sum(lambda_t) - push)) / load
  end subroutine

  !> Von Mises stress in the lower half plane, at depth below `across`: each cell acts as a force F of Flamant at its middle, whose
  !> stress at the distance d is -(2 / pi) (F.d) d d' / |d|^4; plane strain. (MPa)
  pure real(dp) function von_mises(of, across, depth)
    type(step_result), intent(in) :: of
    real(dp), intent(in) :: across, depth
    real(dp) :: d(cells), factor(cells), xx, yy, zz, xz

    d = across - x
    factor = -2 / pi * (of%shear * mu * p0 * cell * d + of%pressure * cell * depth) / (d**2 + depth**2)**2
    xx = sum(factor * d**2)
    zz = sum(factor * depth**2)
    xz = sum(factor * d * depth)
    yy = poisson * (xx + zz)
    von_mises = sqrt(0.5_dp * ((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3 * xz**2)
  end function

  !> Cells of both surfaces with what the contact does to them, and squares of the lower half plane with their stress.
  subroutine draw_step(step, of)
    integer, intent(in) :: step
    type(step_result), intent(in) :: of
    integer, parameter :: across = 75, down = 40, all = 2 * cells + across * down
    real(dp), parameter :: side = 3 * half / across
    type(picture_grid) :: grid
    character(len=60) :: name
    real(dp), allocatable :: moved(:, :), stress(:, :)
    integer :: unit, b, i, j, c, first

    allocate (grid%xyz(3, 2 * (cells + 1) + (across + 1) * (down + 1)), source=0.0_dp)
    allocate (grid%corner(20, all), source=0)
    allocate (grid%kind(all), grid%body(all))
    allocate (moved(3, all), stress(1, all), source=nan_of())
    do b = 1, 2
      do i = 0, cells
        first = i + 1 + (b - 1) * (cells + 1)
        grid%xyz(1, first) = -1.5_dp * half + i * cell
        if (i == cells) cycle
        c = i + 1 + (b - 1) * cells
        grid%kind(c) = picture_line
        grid%body(c) = b
        grid%corner(:2, c) = [first, first + 1]
        moved(:, c) = [of%u(far + i + 1, b), of%u(i + 1, b), 0.0_dp]
      end do
    end do
    do j = 0, down
      do i = 0, across
        first = 2 * (cells + 1) + 1 + i + (across + 1) * j
        grid%xyz(:2, first) = [-1.5_dp * half + i * side, -j * side]
        if (i == across .or. j == down) cycle
        c = 2 * cells + 1 + i + across * j
        grid%kind(c) = picture_quad
        grid%body(c) = 2
        grid%corner(:4, c) = [first, first + across + 1, first + across + 2, first + 1]
        stress(1, c) = von_mises(of, grid%xyz(1, first) + side / 2, (j + 0.5_dp) * side)
      end do
    end do
    write (name, '(a, i0, a)') 'cattaneo_mindlin_fortran_', step - 1, '.vtu'
    call vtu_begin(picture_folder(), trim(name), grid, unit)
    call vtu_next(unit, grid)
    call vtu_doubles(unit, 'displacement', moved)
    call vtu_doubles(unit, 'pressure', on_both(of%pressure, all))
    call vtu_doubles(unit, 'shear', on_both(mu * p0 * of%shear, all))
    call vtu_doubles(unit, 'gap', on_both(of%gap, all))
    call vtu_integers(unit, 'friction', [of%state, of%state, [(-1, c=2 * cells + 1, all)]])
    call vtu_doubles(unit, 'von_mises', stress)
    call vtu_end(unit)
  end subroutine

  !> Numbers of the cells of either surface, NaN for the other cells.
  function on_both(surface, all) result(values)
    real(dp), intent(in) :: surface(:)
    integer, intent(in) :: all
    real(dp) :: values(1, all)

    values = nan_of()
    values(1, :2 * cells) = [surface, surface]
  end function

  !> Every fifth cell of the three pushes and of the step back to no push, against the closed form.
  subroutine draw_shear
    integer, parameter :: shown(4) = [2, 3, 4, 6]
    real(dp) :: curve_x(samples, 4), curve_y(samples, 4)
    logical :: is_shown(cells)
    integer :: s, k

    is_shown = [(mod(k, 5) == 3, k=1, cells)] .and. abs(x) < 1.1_dp * half
    do s = 1, 4
      curve_x(:, s) = [(1.1_dp * half * (2 * k / (samples - 2.0_dp) - 1), k=0, samples - 1)]
      curve_y(:, s) = [(mindlin(shown(s), curve_x(k, s)), k=1, samples)]
    end do
    curve_x(samples, :) = nan_of()   ! the next curve begins
    curve_y(samples, :) = curve_x(samples, :)
    call picture_svg(picture_folder(), 'cattaneo_mindlin_shear_fortran.svg', &
      'Shear of two cylinders that are pushed along', 'x / mm', 'shear / (mu p0)', 'Cattaneo, Mindlin', &
      [(pack(x, is_shown), nan_of(), s=1, 4)], [(pack(found(shown(s))%shear, is_shown), nan_of(), s=1, 4)], &
      reshape(curve_x, [4 * samples]), reshape(curve_y, [4 * samples]), &
      [character(len=13) :: 'Q = .3 mu P', 'Q = .6 mu P', 'Q = .9 mu P', 'back to Q = 0'])
  end subroutine

  !> Push against shift: the steps, and the closed form from turn to turn.
  subroutine draw_loop
    real(dp) :: to(samples), back(samples), shift_to(samples), shift_back(samples)
    integer :: k

    to = [(0.9_dp * k / (samples - 1), k=0, samples - 1)]
    back = 0.9_dp - 2 * to
    do k = 1, samples
      shift_to(k) = 1e3_dp * unit * shift_by(to(k))
      shift_back(k) = 1e3_dp * unit * (shift_by(0.9_dp) - 2 * shift_by((0.9_dp - back(k)) / 2))
    end do
    call picture_svg(picture_folder(), 'cattaneo_mindlin_loop_fortran.svg', &
      'To and fro: the push against the shift of the cylinders', 'shift / um', 'push / (mu P)', 'Cattaneo, Mindlin', &
      1e3_dp * found%shift, part, [shift_to, shift_back, -shift_back], [to, back, -back])
  end subroutine

end program
