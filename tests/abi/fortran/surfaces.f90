!> Surfaces and pairs by hand, counted from 1: two strips of three nodes at x = 0, 1, 2, each unknown on a spring of stiffness 4 to the
!> ground. The lower one is the master, the upper one the slave with areas .5, 1, .5; a node pushed down by F across a gap g carries
!> (F - 4 g) / 2. Friction, a tie, rigid surfaces, what is refused.
program surfaces
  use, intrinsic :: iso_fortran_env, only: int64
  use case_problem, only: require
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: dof(2, 3) = reshape([1, 2, 3, 4, 5, 6], [2, 3]), lines(2, 2) = reshape([1, 2, 2, 3], [2, 2])
  real(dp), parameter :: flat(2, 3) = reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 2.0_dp, 0.0_dp], [2, 3])
  real(dp), parameter :: ground(4) = [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp]

  call strips_press_on_each_other
  call a_strip_slips_and_sticks
  call a_tie_carries_tension
  call rigid_surfaces_carry_all
  call what_does_not_fit_is_refused

contains

  !> Both bodies; the slave is surface 1 at this height, the master surface 2 in numbers through all bodies.
  subroutine strips(p, height, method, pair)
    type(feti_problem), intent(out) :: p
    real(dp), intent(in) :: height
    integer(kind(FETI_TIED)), intent(in) :: method
    integer, intent(out) :: pair
    integer :: slave, master, first

    call bodies(p)
    call feti_surface_add(p, 2, at(height), dof, slave)
    call feti_surface_faces(p, slave, FETI_LINE2, lines)
    call feti_surface_add(p, flat, int(dof, int64), master)
    call feti_surface_faces(p, master, FETI_LINE2, int(lines(2:1:-1, :), int64))
    call feti_pair_add(p, slave, master, method, 0.5_dp, pair, first)
    call require(all([slave, master, pair, first] == [1, 2, 1, 1]), 'surfaces, pairs or rows are not numbered from 1')
  end subroutine

  subroutine bodies(p)
    type(feti_problem), intent(out) :: p
    integer :: k, body

    call feti_problem_create(p)
    do k = 1, 2
      call feti_body_add(p, 6, body)
      call feti_body_stiffness(p, body, [1, 2, 3, 4, 5, 6, 7], [1, 2, 3, 4, 5, 6], spread(4.0_dp, 1, 6), FETI_LOWER)
    end do
  end subroutine

  pure function at(height) result(x)
    real(dp), intent(in) :: height
    real(dp) :: x(2, 3)

    x = flat
    x(2, :) = height
  end function

  subroutine same(p, pair, field, wanted, text)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: pair
    integer(kind(FETI_FORCE)), intent(in) :: field
    real(dp), intent(in) :: wanted(3)
    character(len=*), intent(in) :: text
    real(dp) :: found(3)

    call feti_pair_field(p, pair, field, found)
    call require(maxval(abs(found - wanted)) <= 1e-9_dp, text)
  end subroutine

  subroutine strips_press_on_each_other
    type(feti_problem) :: p
    type(feti_pair_facts) :: facts
    integer :: pair, dim, nodes, faces, data

    call strips(p, 0.25_dp, FETI_NODE_TO_FACE, pair)
    call feti_surface_counts(p, 1, dim, nodes, faces, data)
    call require(all([dim, nodes, faces, data] == [2, 3, 2, 0]), 'sizes of a surface')
    call feti_body_load(p, 2, [0.0_dp, -4.0_dp, 0.0_dp, -7.0_dp, 0.0_dp, -4.0_dp])
    call feti_pairs_find(p)
    call feti_solve(p)
    call same(p, pair, FETI_PRESSURE, [3.0_dp, 3.0_dp, 3.0_dp], 'pressure across a gap')
    call same(p, pair, FETI_AREA, [0.5_dp, 1.0_dp, 0.5_dp], 'areas')
    call feti_pair_info(p, pair, facts)
    call require(facts%rows == 3 .and. facts%closed == 3 .and. facts%without == 0, 'counts of the pair')
    call require(abs(facts%force(2) - 6) <= 1e-9_dp .and. abs(facts%moment(3) - 6) <= 1e-9_dp, 'force and moment on the slave')
    call require(facts%pressure_node >= 1 .and. facts%pressure_node <= 3 .and. facts%depth_node == 0, 'nodes of the pair')
    call feti_surface_move(p, 1, at(0.0_dp))
    call feti_pairs_commit(p)
    call feti_pairs_find(p)
    call feti_solve(p)
    call same(p, pair, FETI_FORCE, [2.0_dp, 3.5_dp, 2.0_dp], 'force without a gap')
    call feti_problem_destroy(p)
  end subroutine

  subroutine a_strip_slips_and_sticks
    type(feti_problem) :: p
    real(dp) :: shear(2, 3), all_in_one(6)
    integer :: pair

    call strips(p, 0.0_dp, FETI_NODE_TO_FACE, pair)
    call feti_pair_set(p, pair, 'friction', 0.5_dp)
    call feti_pair_set(p, pair, 'offset', [0.0_dp, 0.0_dp, 0.0_dp])
    call feti_body_load(p, 2, [4.0_dp, -3.0_dp, 2.0_dp, -6.0_dp, 0.0_dp, -3.0_dp])
    call feti_pairs_find(p)
    call feti_solve(p)
    call same(p, pair, FETI_CLOSED, [3.0_dp, 2.0_dp, 2.0_dp], 'states')
    call feti_pair_field(p, pair, FETI_SHEAR, shear)
    call feti_pair_field(p, pair, FETI_SHEAR, all_in_one)
    call require(maxval(abs(shear(1, :) - [-1.5_dp, -1.0_dp, 0.0_dp])) <= 1e-9_dp, 'shear')
    call require(all(abs(all_in_one - reshape(shear, [6])) <= 0), 'another form of a field')
    call feti_problem_destroy(p)
  end subroutine

  subroutine a_tie_carries_tension
    type(feti_problem) :: p
    integer :: pair

    call strips(p, 0.0_dp, FETI_NODE_TO_FACE + FETI_TIED, pair)
    call feti_body_load(p, 2, [0.0_dp, 0.0_dp, 0.0_dp, 6.0_dp, 0.0_dp, 0.0_dp])
    call feti_pairs_find(p)
    call feti_solve(p)
    call same(p, pair, FETI_FORCE, [0.0_dp, -3.0_dp, 0.0_dp], 'tension')
    call feti_problem_destroy(p)
  end subroutine

  !> A plane that rises by .5, a tool of one line, a large circle.
  subroutine rigid_surfaces_carry_all
    type(feti_problem) :: p
    real(dp) :: u(6)
    integer :: slave, plane, tool, circle, pair, other, data

    call bodies(p)
    call feti_surface_add(p, 2, flat, int(dof, int64), slave)
    call feti_surface_faces(p, slave, FETI_LINE2, lines)
    call feti_surface_rigid(p, FETI_PLANE, ground, plane)
    call feti_surface_rigid(p, FETI_SPHERE, [1.0_dp, -9.0_dp, 5.0_dp], circle)
    call feti_surface_add(p, reshape([-1.0_dp, -0.25_dp, 3.0_dp, -0.25_dp], [2, 2]), tool)
    call feti_surface_faces(p, tool, FETI_LINE2, reshape([2, 1], [2, 1]))
    call feti_surface_counts(p, circle, data=data)
    call require(data == 3, 'a circle has three numbers')
    call feti_pair_add(p, slave, plane, FETI_NODE_TO_FACE, 1.0_dp, pair)
    call feti_pair_add(p, slave, tool, FETI_NODE_TO_FACE, 1.0_dp, other)
    call feti_pair_add(p, slave, circle, FETI_NODE_TO_FACE, 1.0_dp, other)
    call feti_body_load(p, 2, [0.0_dp, -3.0_dp, 0.0_dp, -6.0_dp, 0.0_dp, -3.0_dp])
    call feti_surface_move(p, plane, [7.0_dp, 0.5_dp, 0.0_dp, 2.0_dp])
    call feti_pairs_find(p)
    call feti_solve(p)
    call feti_displacement(p, 2, u)
    call require(maxval(abs(u(2::2) - 0.5_dp)) <= 1e-9_dp, 'the plane has risen')
    call feti_pair_set(p, pair, 'on', 0.0_dp)
    call feti_pairs_find(p)
    call feti_solve(p)
    call feti_displacement(p, 2, u)
    call require(maxval(abs(u(2::2) + 0.25_dp)) <= 1e-9_dp, 'the tool carries the rest')
    call feti_problem_destroy(p)
  end subroutine

  subroutine what_does_not_fit_is_refused
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    real(dp) :: wide(4, 2)
    integer :: pair, new, stat
    character(len=200) :: text

    new = -5
    call strips(p, 0.0_dp, FETI_NODE_TO_FACE, pair)
    call feti_surface_add(p, 2, flat, dof(:1, :), new, stat)
    call require(stat == FETI_ARGUMENT - 7, 'unknowns of one direction')
    call feti_surface_add(p, 2, flat, dof(:, :2), new, stat)
    call require(stat == FETI_ARGUMENT - 7, 'unknowns of two nodes')
    call feti_surface_add(p, 3, flat, dof, new, stat)
    call require(stat == FETI_ARGUMENT - 2, 'a body that is not there')
    call feti_surface_add(p, flat, 10 * dof, new, stat)
    call feti_last_error_detail(detail)
    call require(stat == FETI_ARGUMENT - 7 .and. detail%node == 1, 'an unknown that is not there')
    call feti_surface_faces(p, 1, FETI_TRI3, lines, stat)
    call require(stat == FETI_ARGUMENT - 5, 'triangles of two nodes')
    call feti_surface_add(p, flat, new)
    call feti_surface_faces(p, new, FETI_LINE2, reshape([1, 2, 4, 3], [2, 2]), stat, text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_ARGUMENT - 5 .and. detail%face == 2 .and. index(text, 'face 2') > 0, 'a node that is not there')
    call feti_surface_rigid(p, FETI_SPHERE, ground(:2), new, stat)
    call require(stat == FETI_ARGUMENT - 4, 'a sphere of two numbers')
    call feti_surface_rigid(p, FETI_LINE2, ground, new, stat)
    call require(stat == FETI_ARGUMENT - 3, 'a line is not rigid')
    call feti_surface_move(p, 1, flat(:, :2), stat)
    call require(stat == FETI_ARGUMENT - 3, 'positions of two nodes')
    call feti_surface_move(p, 1, ground, stat)
    call require(stat == FETI_ARGUMENT - 3, 'data of a surface that is not rigid')
    call feti_surface_move(p, 0, flat, stat)
    call require(stat == FETI_ARGUMENT - 2, 'surface 0')
    call feti_pair_add(p, 1, 1, FETI_NODE_TO_FACE, 0.5_dp, new, stat=stat)
    call require(stat == FETI_UNSUPPORTED, 'a surface that meets itself')
    call feti_pair_set(p, pair, 'offset', [0.0_dp, 1.0_dp], stat, text)
    call require(stat == FETI_ARGUMENT - 4 .and. index(text, 'pair 1') > 0, 'two offsets of three nodes')
    call feti_pair_set(p, pair, 'stiffness', 1.0_dp, stat)
    call require(stat == FETI_ARGUMENT - 3, 'a number that pairs do not have')
    call feti_pairs_find(p)
    call feti_solve(p)
    call feti_pair_field(p, pair, FETI_SHEAR, wide, stat)
    call require(stat == FETI_ARGUMENT - 5, 'vectors of four numbers')
    call feti_pair_field(p, pair, FETI_SHEAR, wide(:2, :), stat)
    call require(stat == FETI_ARGUMENT - 4, 'vectors of two nodes')
    call feti_problem_destroy(p)
  end subroutine

end program
