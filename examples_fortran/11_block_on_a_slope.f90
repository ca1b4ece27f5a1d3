!> 11 A block on a slope: friction holds a body that nothing else holds, up to an angle that is known by hand.
!>
!>    y |  +----------------+                contact row        -u_y <= 0     lambda_n: the slope presses
!>      |  |  2 m x 1 m     |   \            tangential row T   u_x           lambda_t > 0: the slope holds back
!>      |  |  W = 100 kN    |    \ weight, turned by the angle of the slope
!>      |  +----------------+     v          plane strain, 1 m thick
!>      +----------------------------- x, down the slope
!>
!> The block is elastic and floats: it has no support and no spring. The slope presses it with the sum of lambda_n = W
!> cos(angle), friction holds it by the sum of lambda_t = W sin(angle). Since |lambda_t| <= mu lambda_n at every node, the
!> block stays at rest if tan(angle) <= mu = 0.5, up to 26.565 degrees. Close to this angle some nodes slip a little, and the
!> others stick.
!>
!> 1. Smaller angles: the program prints both sums and the number of nodes that stick and slip.
!> 2. Larger angles: no contact force can balance the weight. feti_solve returns FETI_LOAD_NOT_HELD, and feti_diagnosis
!>    returns the body and a motion that the weight causes and no force of the slope resists: down, and away from the slope
!>    by mu. (With any slower lift friction could act.)
!> 3. Larger angles with a spring between the block and a rail above it. The spring could press the block onto the slope, and
!>    then friction would hold it: forces that balance the weight exist. But nothing tightens the spring, and the block still
!>    slides: FETI_SLIDES, with the part of the load that friction holds, mu / tan(angle).
!>
!> Units: kN and m.
program block_on_a_slope
  use demo
  use feti_contact
  use, intrinsic :: iso_fortran_env, only: int32
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: nx = 8, ny = 4, side = nx + 1, nodes = side * (ny + 1), n = 2 * nodes
  real(dp), parameter :: young = 3e7_dp, poisson = 0.2_dp, weight = 100   ! kPa, -, kN
  real(dp), parameter :: coefficient = 0.5_dp, edge = 0.25_dp, spring = 10   ! -, m, kN/m
  real(dp), parameter :: degree = acos(-1.0_dp) / 180
  real(dp), parameter :: below(4) = [5.0_dp, 15.0_dp, 25.0_dp, 26.5_dp], above(3) = [26.6_dp, 30.0_dp, 45.0_dp]

  type(feti_problem) :: problem
  type(feti_info) :: info
  real(dp) :: error, capacity
  logical :: right
  integer :: i

  call feti_problem_create(problem)
  call add_block
  call add_slope
  error = 0
  print '(a)', '   angle        normal         W cos    tangential         W sin stick  slip'
  do i = 1, size(below)
    call rest(below(i))
  end do
  right = error <= 1e-10_dp
  print '(a)', '   angle  status                      down        away          held  mu/tan(angle)'
  do i = 1, size(above)
    call escape(above(i), FETI_LOAD_NOT_HELD)
  end do

  call add_spring
  do i = 2, size(above)
    call escape(above(i), FETI_SLIDES)
    right = right .and. abs(capacity - coefficient / tan(above(i) * degree)) <= 1e-5_dp
  end do
  call feti_problem_destroy(problem)
  call demo_line('11_block_on_a_slope', info, error, right)

contains

  !> Unknown along x of node (i, j), counted from below; that along y follows.
  pure integer function unknown(i, j)
    integer, intent(in) :: i, j

    unknown = 2 * (i + side * j) + 1
  end function

  !> Stiffness of a square element, plane strain, 2 x 2 Gauss points, independent of the edge length. Corners (0,0), (1,0),
  !> (0,1), (1,1).
  function element() result(k)
    real(dp), parameter :: mu = young / (2 * (1 + poisson)), la = 2 * mu * poisson / (1 - 2 * poisson)
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

  !> The unknowns of the corners of an element, counted from 0.
  pure function corners(e) result(dof)
    integer, intent(in) :: e
    integer :: dof(8), c

    do c = 0, 3
      dof(2 * c + 1) = unknown(mod(e, nx) + mod(c, 2), e / nx + c / 2)
      dof(2 * c + 2) = dof(2 * c + 1) + 1
    end do
  end function

  !> The block with its stiffness; coordinates in place of a null space.
  subroutine add_block
    real(dp) :: k(n, n), ke(8, 8), xyz(2, n)
    integer(int32) :: node(n), dir(n)
    integer :: body, e, at, dof(8)

    k = 0
    ke = element()
    do e = 0, nx * ny - 1
      dof = corners(e)
      k(dof, dof) = k(dof, dof) + ke
    end do
    do at = 1, n
      node(at) = (at + 1) / 2
      dir(at) = 2 - mod(at, 2)
      xyz(:, at) = edge * [mod(node(at) - 1, side), (node(at) - 1) / side]
    end do
    call feti_body_add(problem, n, body)
    call feti_body_stiffness(problem, body, k, FETI_LOWER)
    call feti_body_coordinates(problem, body, node, dir, xyz)
  end subroutine

  !> A contact row -u_y <= 0 and a tangential row u_x for every node of the bottom.
  subroutine add_slope
    integer :: ptr(side + 1), along_dof(side), k
    real(dp) :: one(side), no_gap(side)

    ptr = [(k, k=1, side + 1)]
    along_dof = [(unknown(k, 0), k=0, nx)]
    one = 1
    no_gap = 0
    call feti_rows_add(problem, FETI_INEQUALITY, ptr, along_dof + 1, -one, no_gap)
    call feti_friction_add(problem, ptr(:side), ptr, along_dof, one, coefficient * one)
  end subroutine

  !> A spring across the slope in the middle of the top: an equality row with a compliance, u_y = mu / k.
  subroutine add_spring
    call feti_rows_add(problem, FETI_EQUALITY, [1, 2], [unknown(nx / 2, ny) + 1], [1.0_dp], [0.0_dp])
    call feti_rows_compliance(problem, FETI_EQUALITY, 1, [1 / spring])
  end subroutine

  !> The weight of each element goes to its corners.
  subroutine give_weight(angle)
    real(dp), intent(in) :: angle
    real(dp) :: load(n), corner(2)
    integer :: e, dof(8)

    load = 0
    corner = weight / (4 * nx * ny) * [sin(angle * degree), -cos(angle * degree)]
    do e = 0, nx * ny - 1
      dof = corners(e)
      load(dof(1::2)) = load(dof(1::2)) + corner(1)
      load(dof(2::2)) = load(dof(2::2)) + corner(2)
    end do
    call feti_body_load(problem, 1, load)
  end subroutine

  !> Solves and prints a line; the relative error of both sums. `info` is that of the last angle that has an answer.
  subroutine rest(angle)
    real(dp), intent(in) :: angle
    real(dp) :: lambda_n(side), lambda_t(side), across, along

    across = weight * cos(angle * degree)
    along = weight * sin(angle * degree)
    call give_weight(angle)
    call feti_solve(problem, info)
    call feti_multipliers(problem, FETI_INEQUALITY, lambda_n)
    call feti_multipliers(problem, FETI_TANGENTIAL, lambda_t)
    print '(f8.2, 4f14.6, 2i6)', angle, sum(lambda_n), across, sum(lambda_t), along, info%sticking, info%slipping
    error = max(error, abs(sum(lambda_n) - across) / across, abs(sum(lambda_t) - along) / along)
  end subroutine

  !> Solves what has no answer and prints a line: the status, how fast the block moves down the slope and away from it (the
  !> largest unknown of the motion is 1), and what is held. Not right where the status is another one or the motion is.
  subroutine escape(angle, expected)
    real(dp), intent(in) :: angle
    integer, intent(in) :: expected
    type(feti_findings) :: found
    real(dp) :: v(n), down, away
    character(len=18) :: name
    integer :: stat

    call give_weight(angle)
    call feti_solve(problem, stat=stat)
    if (stat /= expected) call demo_stop('11_block_on_a_slope: ' // feti_status_name(stat))
    call feti_diagnosis(problem, found)
    call feti_diagnosis_motion(problem, int(found%body), v)
    down = sum(v(1::2)) / nodes
    away = sum(v(2::2)) / nodes
    capacity = found%capacity   ! NaN after FETI_LOAD_NOT_HELD
    name = feti_status_name(stat)
    if (stat == FETI_SLIDES) then
      print '(f8.2, 2x, a, 2x, 2f12.6, 2f14.6)', angle, name, down, away, capacity, coefficient / tan(angle * degree)
      right = right .and. abs(away) < 1e-2_dp
    else
      print '(f8.2, 2x, a, 2x, 2f12.6)', angle, name, down, away
      right = right .and. abs(away - coefficient) < 1e-2_dp
    end if
    right = right .and. found%body == 1 .and. down > 0.99_dp
  end subroutine

end program
