!> 18 Two blocks, large sliding with friction: contact by surfaces.
!>
!> A block with a crowned foot is pressed on another block and then pushed along it by 1.5 times its own width, with friction. Meshes of
!> quadrilaterals do not match; material of St. Venant and Kirchhoff (Green's strain), plane strain, 1 mm thick. The host iterates: in every
!> iteration it assembles element matrices and internal forces at the present positions, and the library finds the partner of every node
!> of the foot, makes the rows of contact and friction, and solves for the increment. Supports are in a table of unknowns; the top of the
!> upper block is driven.
!>
!> Between the two marks below stands everything that contact adds to the host: from coordinates, faces, element matrices and supports to
!> pressures and resultant.
!>
!> Known by hand: when the block slides, every node of its foot that touches has the shear mu x pressure, against the motion; and the
!> resultant on the foot holds the forces at the top.
program sliding_blocks
  use demo
  use feti_contact
  use vtu_picture, only: nan_of, picture_pvd, picture_step
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: below_x = 40, below_y = 5, above_x = 16, above_y = 8
  integer, parameter :: below = (below_x + 1) * (below_y + 1), nodes = below + (above_x + 1) * (above_y + 1), n = 2 * nodes
  integer, parameter :: elements = below_x * below_y + above_x * above_y, steps = 7, most = 20
  real(dp), parameter :: young = 1000, poisson = 0.3_dp, mu = 0.3_dp                       ! MPa, -, -
  real(dp), parameter :: length = 40, height = 8, width = 10, tall = 6, r = 60             ! mm; r: radius of the foot
  real(dp), parameter :: left_end = 6, depth = 0.25_dp, slide = 15                         ! mm: where the block stands, how far it goes
  integer, parameter :: none(0) = [integer ::]
  real(dp), parameter :: nothing(0) = [real(dp) ::]

  !> The mesh of both blocks: positions at rest, unknown of K of each direction (0: held), corners of elements, faces that may touch.
  real(dp) :: x(2, nodes)
  integer :: number(n), own(2, nodes), corner(4, elements), dof(8 * elements), unknowns
  integer :: face_below(2, below_x), face_foot(2, above_x)

  !> Of an iteration: positions, what held unknowns still have to go, the increment, internal forces, element matrices.
  real(dp) :: now(2, nodes), left(2, nodes), d(n), internal(2, nodes), load(n), ke(8, 8, elements)

  !> Of contact, by node; state: 0 open, 2 sticks, 3 slips.
  real(dp) :: pressure(nodes), shear(2, nodes), force(nodes), gap(nodes), state(nodes)     ! MPa, N, mm
  type(feti_pair_facts) :: facts
  type(feti_info) :: info
  type(feti_problem) :: problem
  integer :: body, surface_below, surface_foot, pair

  real(dp) :: change, error, held(2), along
  integer :: step, iterations, longest, k
  logical :: sliding

  call make_mesh
  now = x
  longest = 0
  call begin_contact
  do step = 0, steps - 1
    change = 1
    iterations = 0
    call begin_step
    do while (change > 1e-10_dp * width .and. iterations < most)
      iterations = iterations + 1
      left = 0
      do k = 1, nodes
        if (number(2 * k) <= 0) left(:, k) = x(:, k) + goal_of(step, k) - now(:, k)
      end do
      call assemble
      call find_increment
      now = now + reshape(d, [2, nodes])
      change = maxval(abs(d))
    end do
    longest = max(longest, iterations)
    call get_results
    call assemble
    call draw
    along = facts%force(1)
    print '(a, i0, a, i2, a, i2, a, i2, a, f11.6, a, f11.6, a)', 'step ', step, ': ', iterations, ' iterations, ', facts%closed, &
      ' nodes touch, ', facts%slipping, ' slip, force on the foot ', facts%force(2), ' N up, ', along, ' N along'
  end do
  call end_contact
  call picture_pvd(picture_folder(), 'sliding_blocks_fortran', steps)

  held = sum(internal(:, nodes - above_x:), 2)
  error = norm2(held + facts%force(:2)) / norm2(held)
  sliding = .true.
  do k = below + 1, below + above_x + 1
    if (nint(state(k)) == 0) cycle
    sliding = sliding .and. nint(state(k)) == 3 .and. shear(1, k) < 0
    error = max(error, abs(norm2(shear(:, k)) - mu * pressure(k)) / (mu * facts%pressure))
  end do
  call demo_value('most iterations of a load step', real(longest, dp), '-')
  call demo_value('largest pressure', facts%pressure, 'MPa')
  call demo_value('force on the foot, up', facts%force(2), 'N')
  call demo_value('force on the foot, along', facts%force(1), 'N')
  call demo_value('area that touches', facts%closed_area, 'mm2')
  call demo_line('18_sliding_blocks', info, error, sliding .and. facts%closed > 3 .and. longest < most)

contains

  ! ---- Contact: all that the host needs of the library. ----
  subroutine begin_contact
    call feti_problem_create(problem)
    call feti_body_add(problem, unknowns, body)
    call feti_body_mesh(problem, body, [(8 * k + 1, k=0, elements)], dof)
    call feti_dof_table(problem, number, none, none, nothing)
    call feti_surface_add(problem, x, own, surface_below)
    call feti_surface_faces(problem, surface_below, FETI_LINE2, face_below)
    call feti_surface_add(problem, x, own, surface_foot)
    call feti_surface_faces(problem, surface_foot, FETI_LINE2, face_foot)
    call feti_pair_add(problem, surface_foot, surface_below, FETI_NODE_TO_FACE, 1.0_dp, pair)
    call feti_pair_set(problem, pair, 'friction', mu)
  end subroutine

  subroutine begin_step
    call feti_pairs_commit(problem)   ! slips count from here
  end subroutine

  subroutine move_surfaces
    call feti_surface_move(problem, surface_below, now)
    call feti_surface_move(problem, surface_foot, now)
  end subroutine

  !> The increment d at the present positions.
  subroutine find_increment
    call move_surfaces
    call feti_dof_table(problem, number, none, none, nothing, reshape(left, [n]))
    call feti_pairs_find(problem)
    call feti_body_elements(problem, body, 1, ke)
    call feti_body_load(problem, load)
    call feti_solve(problem, info)
    call feti_displacement(problem, d)
  end subroutine

  subroutine get_results
    call move_surfaces
    call feti_pair_field(problem, pair, FETI_PRESSURE, pressure)
    call feti_pair_field(problem, pair, FETI_SHEAR, shear)
    call feti_pair_field(problem, pair, FETI_FORCE, force)
    call feti_pair_field(problem, pair, FETI_GAP, gap)
    call feti_pair_field(problem, pair, FETI_CLOSED, state)
    call feti_pair_info(problem, pair, facts)
  end subroutine

  subroutine end_contact
    call feti_problem_destroy(problem)
  end subroutine
  ! ---- End of contact. ----

  !> A step of the film. Where nothing is held, internal forces balance those of contact.
  subroutine draw
    real(dp), parameter :: stiff = young / (2 * (1 + poisson)), lame = 2 * stiff * poisson / (1 - 2 * poisson)
    real(dp) :: forces(2, nodes)

    forces = merge(internal, 0.0_dp, reshape(number, [2, nodes]) > 0)
    gap(:below) = nan_of()
    gap(below + above_x + 2:) = nan_of()
    state(:below) = -1
    state(below + above_x + 2:) = -1
    call picture_step(picture_folder(), 'sliding_blocks_fortran', step, below_x * below_y, corner, x, now - x, forces, force, gap, &
      nint(state), stiff, lame)
  end subroutine

  !> Where a held node is to go in a step: the foot of the lower block stays; the top of the upper one goes down in the first step, then along.
  pure function goal_of(at, node) result(goal)
    integer, intent(in) :: at, node
    real(dp) :: goal(2)

    goal = 0
    if (node > below) goal = [slide * at / (steps - 1), -depth]
  end function

  !> Nodes row by row from below; in front of them stand `first` nodes.
  pure integer function node_at(first, nx, i, j)
    integer, intent(in) :: first, nx, i, j

    node_at = first + j * (nx + 1) + i + 1
  end function

  subroutine add_block(first, element, nx, ny, held_row)
    integer, intent(in) :: first, element, nx, ny, held_row
    real(dp) :: s, t
    integer :: i, j, node, e

    do j = 0, ny
      do i = 0, nx
        node = node_at(first, nx, i, j)
        s = real(i, dp) / nx
        t = real(j, dp) / ny
        x(:, node) = [length * s, height * t]
        if (first > 0) x(:, node) = [left_end + width * s, height + t * tall + (1 - t) * (width * (s - 0.5_dp))**2 / (2 * r)]
        number(2 * node - 1:2 * node) = 0
        if (j == held_row) cycle
        number(2 * node - 1:2 * node) = unknowns + [1, 2]
        unknowns = unknowns + 2
      end do
    end do
    e = element
    do j = 0, ny - 1
      do i = 0, nx - 1
        e = e + 1
        corner(:, e) = node_at(first, nx, i, j) + [0, 1, nx + 2, nx + 1]
      end do
    end do
  end subroutine

  !> In the plane the body is on the left of its faces: the top of the lower block goes backwards, the foot of the upper one forwards.
  subroutine make_mesh
    integer :: i, a

    unknowns = 0
    call add_block(0, 0, below_x, below_y, 0)
    call add_block(below, below_x * below_y, above_x, above_y, above_y)
    own = reshape([(i, i=1, n)], [2, nodes])
    dof = [((number(2 * corner(a, i) - 1), number(2 * corner(a, i)), a=1, 4), i=1, elements)]
    face_below = reshape([(node_at(0, below_x, i, below_y), node_at(0, below_x, i - 1, below_y), i=1, below_x)], [2, below_x])
    face_foot = reshape([(below + i, below + i + 1, i=1, above_x)], [2, above_x])
  end subroutine

  !> Element matrices and internal forces at the present positions. The load of the increment: minus internal forces, and minus the part
  !> of K that acts on what held unknowns still have to go.
  subroutine assemble
    real(dp), parameter :: gauss = sqrt(1 / 3.0_dp)
    real(dp) :: fe(2, 4)
    integer :: e, p, at(8)

    ke = 0
    internal = 0
    load = 0
    do e = 1, elements
      fe = 0
      do p = 0, 3
        call add_point(corner(:, e), merge(gauss, -gauss, mod(p, 2) == 1), merge(gauss, -gauss, p > 1), ke(:, :, e), fe)
      end do
      at = reshape(spread(2 * corner(:, e), 1, 2) + spread([-1, 0], 2, 4), [8])
      internal(:, corner(:, e)) = internal(:, corner(:, e)) + fe
      load(at) = load(at) - reshape(fe, [8]) - matmul(ke(:, :, e), reshape(left(:, corner(:, e)), [8]))
    end do
  end subroutine

  !> Adds one point of integration of an element: F = sum x_a g_a', Green's strain E = (F'F - I)/2, stress S = lame tr(E) I + 2 shear E,
  !>
  !>     f_a = w F S g_a,   K_ab = w (lame F g_a (F g_b)' + shear (F g_b (F g_a)' + g_a'g_b F F') + g_a'S g_b I)
  subroutine add_point(node, s, t, k_e, fe)
    integer, intent(in) :: node(4)
    real(dp), intent(in) :: s, t
    real(dp), intent(inout) :: k_e(8, 8), fe(2, 4)
    real(dp), parameter :: unit(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    real(dp), parameter :: place(2, 4) = reshape([-1, -1, 1, -1, 1, 1, -1, 1] * 1.0_dp, [2, 4])
    real(dp), parameter :: stiff = young / (2 * (1 + poisson)), lame = 2 * stiff * poisson / (1 - 2 * poisson)
    real(dp) :: g(2, 4), slope(2, 4), jacobian(2, 2), F(2, 2), FF(2, 2), Fg(2, 4), strain(2, 2), Sg(2, 4), w, block(2, 2)
    integer :: a, b, c, e

    slope(1, :) = place(1, :) * (1 + place(2, :) * t) / 4
    slope(2, :) = place(2, :) * (1 + place(1, :) * s) / 4
    jacobian = matmul(slope, transpose(x(:, node)))
    w = jacobian(1, 1) * jacobian(2, 2) - jacobian(1, 2) * jacobian(2, 1)
    g(1, :) = (jacobian(2, 2) * slope(1, :) - jacobian(1, 2) * slope(2, :)) / w
    g(2, :) = (jacobian(1, 1) * slope(2, :) - jacobian(2, 1) * slope(1, :)) / w
    F = matmul(now(:, node), transpose(g))
    FF = matmul(F, transpose(F))
    strain = (matmul(transpose(F), F) - unit) / 2
    Sg = matmul(lame * (strain(1, 1) + strain(2, 2)) * unit + 2 * stiff * strain, g)
    Fg = matmul(F, g)
    fe = fe + w * matmul(F, Sg)
    do a = 1, 4
      do b = 1, 4
        do c = 1, 2
          do e = 1, 2
            block(c, e) = lame * Fg(c, a) * Fg(e, b) + stiff * (Fg(c, b) * Fg(e, a) + dot_product(g(:, a), g(:, b)) * FF(c, e)) &
              + dot_product(Sg(:, a), g(:, b)) * unit(c, e)
          end do
        end do
        k_e(2 * a - 1:2 * a, 2 * b - 1:2 * b) = k_e(2 * a - 1:2 * a, 2 * b - 1:2 * b) + w * block
      end do
    end do
  end subroutine
end program
