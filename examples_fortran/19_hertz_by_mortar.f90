!> 19 A cylinder on a block, quadratic elements: pressures by mortar and by node-to-face, against Hertz.
!>
!> Two blocks of quadrilaterals with 8 nodes, plane strain, 1 mm thick; the foot of the upper one is round, and a load presses it on the
!> lower one. Their meshes do not match. The blocks are 24 times as wide as the contact, so that Hertz' solution of two half planes holds:
!>
!>     a^2 = 4 P R / (pi E'),   p(x) = 2 P / (pi a) sqrt(1 - (x/a)^2),   E' = E / (2 (1 - nu^2))
!>
!> On faces with mid nodes, nodal forces of node-to-face are no measure of pressure however fine the mesh: consistent forces of a constant
!> pressure differ between corners and mid nodes by a factor that one row per node cannot follow. FETI_MORTAR weighs the gap over the faces.
!>
!> Known by hand: the resultant on the foot is the load, by either method.
program hertz_by_mortar
  use demo
  use feti_contact
  use picture
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: lines = 64, at_all = 20000
  real(dp), parameter :: young = 1000, poisson = 0.3_dp, r = 100, a = 1          ! MPa, -, mm, mm: half width of the contact
  real(dp), parameter :: half = 12, pi = 3.14159265358979323846_dp              ! mm: of both blocks
  real(dp), parameter :: stiff = young / (2 * (1 - poisson**2))                  ! E'

  !> Both blocks: positions, unknown of each direction (0: held), nodes of elements, faces (of the lower block, of the upper one).
  real(dp) :: x(2, at_all)
  integer :: number(2, at_all), corner(8, at_all), face(3, 4 * lines, 2), nodes, unknowns, elements, faces(2)

  type(feti_pair_facts) :: facts(2)
  type(feti_info) :: info(2)
  real(dp) :: pressure(at_all, 2), load, p0, mortar, by_nodes, error

  nodes = 0
  unknowns = 0
  elements = 0
  faces = 0
  call add_block(1, 0.2_dp * a)
  call add_block(2, 0.25_dp * a)
  load = pi * a**2 * stiff / (4 * r)
  p0 = 2 * load / (pi * a)
  call solve(FETI_MORTAR, pressure(:nodes, 1), facts(1), info(1))
  call solve(FETI_NODE_TO_FACE, pressure(:nodes, 2), facts(2), info(2))
  error = max(norm2(facts(1)%force - [0.0_dp, load, 0.0_dp]), norm2(facts(2)%force - [0.0_dp, load, 0.0_dp])) / load
  mortar = draw(pressure(:, 1), 'hertz_by_mortar_fortran.svg', 'Pressure by mortar, faces with mid nodes')
  by_nodes = draw(pressure(:, 2), 'hertz_by_nodes_fortran.svg', 'Pressure by node-to-face, faces with mid nodes')
  call demo_value('load', load, 'N')
  call demo_value('largest pressure, Hertz', p0, 'MPa')
  call demo_value('largest pressure, mortar', facts(1)%pressure, 'MPa')
  call demo_value('largest pressure, node-to-face', facts(2)%pressure, 'MPa')
  call demo_value('error of mortar inside .9 a', 100 * mortar, '%')
  call demo_value('error of node-to-face', 100 * by_nodes, '%')
  call demo_line('19_hertz_by_mortar', info(1), error, mortar < 0.02_dp .and. by_nodes > 0.1_dp .and. info(2)%status == FETI_OK)

contains

  !> Lines from 0 to half, `h` apart up to 1.5 a, then further and further; line(0:n).
  subroutine graded(h, line, n)
    real(dp), intent(in) :: h
    real(dp), intent(out) :: line(0:lines)
    integer, intent(out) :: n
    real(dp) :: at, step
    integer :: k

    n = 0
    at = 0
    step = h
    line = 0
    do while (at < half)
      if (at > 1.5_dp * a) step = 1.4_dp * step
      at = at + step
      n = n + 1
      line(n) = at
    end do
    do k = 0, n
      if (line(k) > 1.5_dp * a) line(k) = 1.5_dp * a + (line(k) - 1.5_dp * a) * (half - 1.5_dp * a) / (at - 1.5_dp * a)
    end do
  end subroutine

  !> The lower block (1) or the upper one (2); `h`: size of its elements at the contact. Elements have corners, then mid nodes.
  subroutine add_block(which, h)
    integer, intent(in) :: which
    real(dp), intent(in) :: h
    integer, parameter :: across(8) = [0, 2, 2, 0, 1, 2, 1, 0], along(8) = [0, 0, 2, 2, 0, 1, 2, 1]
    real(dp) :: line(0:lines), place, y
    integer, allocatable :: at(:, :)
    integer :: n, wide, high, i, j, k, b
    logical :: up, is_held

    up = which == 2
    call graded(h, line, n)
    wide = 4 * n
    high = 2 * n
    allocate (at(0:wide, 0:high), source=0)   ! places of nodes along x and y; none in the middle of elements
    do j = 0, high
      do i = 0, wide
        if (mod(i, 2) == 1 .and. mod(j, 2) == 1) cycle
        nodes = nodes + 1
        at(i, j) = nodes
        k = abs(i - 2 * n)
        place = merge(-0.5_dp, 0.5_dp, i < 2 * n) * (line(k / 2) + line(k - k / 2))
        y = 0.5_dp * (line(j / 2) + line(j - j / 2))
        x(:, nodes) = [place, -y]
        if (up) x(2, nodes) = y + place**2 / (2 * r) * (1 - y / half)
        is_held = .not. up .and. j == high
        number(:, nodes) = 0
        if (.not. (k == 0 .or. is_held)) number(1, nodes) = next()   ! the middle stays in the middle
        if (.not. is_held) number(2, nodes) = next()
      end do
    end do
    do j = 0, high - 2, 2
      do i = 0, wide - 2, 2
        elements = elements + 1
        do b = 1, 8   ! below, y goes down: turned over, to go around counterclockwise
          corner(b, elements) = at(i + across(b), j + merge(along(b), 2 - along(b), up))
        end do
      end do
    end do
    do i = 0, wide - 2, 2   ! the body is on the left
      faces(which) = faces(which) + 1
      face(:, faces(which), which) = [at(merge(i, i + 2, up), 0), at(merge(i + 2, i, up), 0), at(i + 1, 0)]
    end do
  end subroutine

  integer function next()
    unknowns = unknowns + 1
    next = unknowns
  end function

  !> Slopes of the shape functions of 8 nodes at (s, t).
  pure function slopes(s, t) result(slope)
    real(dp), intent(in) :: s, t
    real(dp), parameter :: place(2, 8) = reshape([-1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0] * 1.0_dp, [2, 8])
    real(dp) :: slope(2, 8), p, q, u, v
    integer :: k

    do k = 1, 8
      p = place(1, k)
      q = place(2, k)
      u = 1 + p * s
      v = 1 + q * t
      if (k <= 4) then
        slope(:, k) = [p * v * (2 * p * s + q * t), q * u * (2 * q * t + p * s)] / 4
      else if (mod(k, 2) == 1) then
        slope(:, k) = [-s * v, q * (1 - s**2) / 2]
      else
        slope(:, k) = [p * (1 - t**2) / 2, -t * u]
      end if
    end do
  end function

  !> K of an element: int lame N_a,i N_b,j + shear (N_a,j N_b,i + delta_ij N_a,k N_b,k).
  function element(node) result(ke)
    integer, intent(in) :: node(8)
    real(dp), parameter :: place(3) = [-1, 0, 1] * 0.774596669241483377_dp, weight(3) = [5, 8, 5] / 9.0_dp
    real(dp), parameter :: shear = young / (2 * (1 + poisson)), lame = 2 * shear * poisson / (1 - 2 * poisson)
    real(dp) :: ke(2, 8, 2, 8), g(2, 8), slope(2, 8), jacobian(2, 2), w
    integer :: p, q, i, j, b, c

    ke = 0
    do p = 1, 3
      do q = 1, 3
        slope = slopes(place(p), place(q))
        jacobian = matmul(slope, transpose(x(:, node)))
        w = jacobian(1, 1) * jacobian(2, 2) - jacobian(1, 2) * jacobian(2, 1)
        g(1, :) = (jacobian(2, 2) * slope(1, :) - jacobian(1, 2) * slope(2, :)) / w
        g(2, :) = (jacobian(1, 1) * slope(2, :) - jacobian(2, 1) * slope(1, :)) / w
        w = w * weight(p) * weight(q)
        do c = 1, 8
          do b = 1, 8
            do j = 1, 2
              do i = 1, 2
                ke(i, b, j, c) = ke(i, b, j, c) + w * (lame * g(i, b) * g(j, c) + shear * g(j, b) * g(i, c))
              end do
              ke(j, b, j, c) = ke(j, b, j, c) + w * shear * dot_product(g(:, b), g(:, c))
            end do
          end do
        end do
      end do
    end do
  end function

  !> The load on the top of the upper block as a pressure, consistent: 1/6, 4/6, 1/6 of each edge.
  function loads() result(f)
    real(dp) :: f(unknowns), part
    integer :: e, at(3)

    f = 0
    do e = 1, elements
      if (any(x(2, corner([3, 4], e)) < half - 1e-9_dp)) cycle
      part = load * (x(1, corner(3, e)) - x(1, corner(4, e))) / (2 * half)
      at = number(2, corner([3, 4, 7], e))
      f(at) = f(at) - part * [1, 1, 4] / 6.0_dp
    end do
  end function

  !> Pressures at the nodes of the foot by a method.
  subroutine solve(method, values, of_pair, of_solve)
    integer, intent(in) :: method
    real(dp), intent(out) :: values(:)
    type(feti_pair_facts), intent(out) :: of_pair
    type(feti_info), intent(out) :: of_solve
    type(feti_problem) :: problem
    integer :: body, surface(2), pair, k

    call feti_problem_create(problem)
    call feti_body_add(problem, unknowns, body)
    call feti_body_mesh(problem, body, [(16 * k + 1, k=0, elements)], &
      reshape(number(:, reshape(corner(:, :elements), [8 * elements])), [16 * elements]))
    do k = 1, elements
      call feti_body_element(problem, body, k, reshape(element(corner(:, k)), [16, 16]))
    end do
    call feti_body_load(problem, body, loads())
    do k = 1, 2
      call feti_surface_add(problem, body, x(:, :nodes), number(:, :nodes), surface(k))
      call feti_surface_faces(problem, surface(k), FETI_LINE3, face(:, :faces(k), k))
    end do
    call feti_pair_add(problem, surface(2), surface(1), method, a, pair)
    call feti_pairs_find(problem)
    call feti_solve(problem, of_solve)
    call feti_pair_field(problem, pair, FETI_PRESSURE, values)
    call feti_pair_info(problem, pair, of_pair)
    call feti_problem_destroy(problem)
  end subroutine

  !> Pressures along the foot within 1.5 a; the largest error within .9 a against the largest pressure p0.
  real(dp) function draw(values, file, title) result(worst)
    real(dp), intent(in) :: values(:)
    character(len=*), intent(in) :: file, title
    integer, parameter :: samples = 200
    real(dp) :: curve_x(0:samples), foot(2 * faces(2) + 1)
    integer :: k, node(2 * faces(2) + 1)
    logical :: is_near(2 * faces(2) + 1)

    node = [(face([1, 3], k, 2), k=1, faces(2)), face(2, faces(2), 2)]
    foot = x(1, node)
    is_near = abs(foot) <= 1.5_dp * a
    curve_x = [(a * (2.0_dp * k / samples - 1), k=0, samples)]
    call picture_svg(picture_folder(), file, title, 'x / mm', 'pressure / MPa', 'Hertz', pack(foot, is_near), &
      pack(values(node), is_near), curve_x, hertz(curve_x))
    worst = maxval(abs(values(node) - hertz(foot)) / p0, abs(foot) < 0.9_dp * a)
  end function

  elemental real(dp) function hertz(at)
    real(dp), intent(in) :: at

    hertz = p0 * sqrt(max(0.0_dp, 1 - (at / a)**2))
  end function
end program
