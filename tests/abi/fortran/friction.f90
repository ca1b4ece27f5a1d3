!> Friction by hand to 1e-9, counted from 1: a block of three unknowns on springs of stiffness 2, pressed by 4 against a wall with
!> a coefficient of 0.5. Pushed by (0.6, 0.8) it sticks, pushed by (3, 4) it slips by (0.9, 1.2) under the force (1.2, 1.6), let
!> go it slips back. Laws, compliances, references and what is refused.
program friction
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use case_problem, only: require
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  real(dp), parameter :: none(2) = [0.0_dp, 0.0_dp], slid(2) = [0.9_dp, 1.2_dp], bound(2) = [1.2_dp, 1.6_dp]

  call a_block_sticks_slips_and_slips_back
  call laws_compliances_and_references_change
  call a_bound_acts_alone
  call what_does_not_fit_is_refused

contains

  !> The block with its node.
  subroutine block(p)
    type(feti_problem), intent(out) :: p
    integer :: body, first

    call feti_problem_create(p)
    call feti_body_add(p, 3, body)
    call feti_body_stiffness(p, 1, [1, 2, 3, 4], [1, 2, 3], [2.0_dp, 2.0_dp, 2.0_dp], FETI_LOWER)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 2], [3], [1.0_dp])
    call feti_friction_add(p, [1], [1, 2, 3], [1, 1], [1, 2], [1.0_dp, 1.0_dp], coefficient=[0.5_dp], first=first)
    call require(first == 1, 'nodes are not numbered from 1')
  end subroutine

  subroutine count_nodes(p, nodes, dim, text)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: nodes, dim
    character(len=*), intent(in) :: text
    integer :: found(2)

    call feti_friction_counts(p, found(1), found(2))
    call require(all(found == [nodes, dim]), text//': another number of nodes or tangential rows')
  end subroutine

  subroutine compare(p, force, slip, state, text)
    type(feti_problem), intent(in) :: p
    real(dp), intent(in) :: force(2), slip(2)
    integer(int32), intent(in) :: state
    character(len=*), intent(in) :: text
    type(feti_certificate) :: certificate
    real(dp) :: u(3), lambda(1), found(2, 1), flat(2), slips(2, 1), reaction(3)
    integer(int32) :: narrow(1)
    integer(int64) :: wide(1)

    call feti_multipliers(p, FETI_TANGENTIAL, found)
    call feti_multipliers(p, FETI_TANGENTIAL, flat)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call feti_friction_slips(p, slips)
    call feti_friction_states(p, narrow)
    call feti_friction_states(p, wide)
    call feti_displacement(p, 1, u)
    call feti_reaction(p, FETI_TANGENTIAL, 1, reaction)
    call require(maxval(abs(found(:, 1) - force)) <= 1e-9_dp, text//': wrong force')
    call require(maxval(abs(flat - found(:, 1))) <= 0 .and. maxval(abs(reaction(:2) + flat)) <= 0, text//': another form')
    call require(maxval(abs(slips(:, 1) - slip)) <= 1e-9_dp, text//': wrong slip')
    call require(narrow(1) == state .and. wide(1) == state, text//': wrong state')
    call feti_check_friction(p, u, lambda, u(:0), found, certificate)
    call require(certificate%passed == 1, text//': the certificate does not pass')
    found = found + 0.1_dp
    call feti_check_friction(p, u, lambda, u(:0), found, certificate)
    call require(certificate%passed == 0, text//': another force passes')
  end subroutine

  subroutine a_block_sticks_slips_and_slips_back
    type(feti_problem) :: p
    type(feti_info) :: info
    integer :: id, status

    call block(p)
    call feti_body_load(p, 1, [0.6_dp, 0.8_dp, 4.0_dp])
    call feti_friction_commit(p, stat=status)
    call require(status == FETI_STATE, 'a commit without an answer')
    call feti_solve(p, info)
    call require(info%nodes == 1 .and. info%sticking == 1, 'the node is not counted')
    call compare(p, [0.6_dp, 0.8_dp], none, FETI_FRICTION_STICK, 'stick')
    call feti_friction_commit(p)
    call feti_body_load(p, 1, [3.0_dp, 4.0_dp, 4.0_dp])
    call feti_solve(p)
    call compare(p, bound, slid, FETI_FRICTION_SLIP, 'slip')
    call feti_state_save(p, id)
    call feti_friction_commit(p)
    call feti_body_load(p, 1, [0.0_dp, 0.0_dp, 4.0_dp])
    call feti_solve(p)
    call compare(p, -bound, [-0.3_dp, -0.4_dp], FETI_FRICTION_SLIP, 'let go')
    call feti_state_restore(p, id)
    call compare(p, bound, slid, FETI_FRICTION_SLIP, 'restored')
    call feti_start_from(p, FETI_TANGENTIAL, reshape(bound, [2, 1]))
    call feti_solve(p)
    call compare(p, bound, slid, FETI_FRICTION_SLIP, 'from a start')
    call feti_problem_destroy(p)
  end subroutine

  !> A bound of 10 holds the push of 5; with C_t = 1/2 the force is half of it; s_old is where the block sticks.
  subroutine laws_compliances_and_references_change
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    integer :: status

    call block(p)
    call feti_body_load(p, 1, [3.0_dp, 4.0_dp, 4.0_dp])
    call feti_friction_law(p, 1, bound=[10.0_dp])
    call feti_solve(p)
    call compare(p, [3.0_dp, 4.0_dp], none, FETI_FRICTION_STICK, 'bound')
    call feti_friction_law(p, 1, [0.5_dp], [-1.0_dp], stat=status)
    call require(status == FETI_ARGUMENT - 5, 'a negative bound')
    call feti_last_error_detail(detail)
    call require(detail%node == 1 .and. detail%entry == 1, 'the node is not named')
    call feti_friction_compliance(p, 1, [0.5_dp])
    call feti_solve(p)
    call compare(p, [1.5_dp, 2.0_dp], none, FETI_FRICTION_STICK, 'elastic stick')
    call feti_friction_compliance(p, 1, [0.0_dp])
    call feti_friction_reference(p, 1, reshape([0.5_dp, 1.0_dp], [2, 1]))
    call feti_solve(p)
    call compare(p, [2.0_dp, 2.0_dp], none, FETI_FRICTION_STICK, 's_old')
    call count_nodes(p, 1, 2, 'in space')
    call feti_friction_clear(p)
    call count_nodes(p, 0, 0, 'cleared')
    call feti_friction_law(p, 1, [0.5_dp], stat=status)
    call require(status == FETI_ARGUMENT - 2, 'a node that is not there')
    call feti_problem_destroy(p)
  end subroutine

  !> Without a contact row, int64: pushed by 3 against a bound of 1.
  subroutine a_bound_acts_alone
    type(feti_problem) :: p
    real(dp) :: u(1), slip(1, 1)
    integer :: body

    call feti_problem_create(p)
    call feti_body_add(p, 1, body)
    call feti_body_stiffness(p, 1, reshape([2.0_dp], [1, 1]), FETI_FULL)
    call feti_body_load(p, 1, [3.0_dp])
    call feti_friction_add(p, [0_int64], [1_int64, 2_int64], [1_int64], [1.0_dp], bound=[1.0_dp])
    call count_nodes(p, 1, 1, 'in the plane')
    call feti_solve(p)
    call feti_displacement(p, 1, u)
    call feti_friction_slips(p, slip)
    call require(abs(u(1) - 1) <= 1e-9_dp .and. abs(slip(1, 1) - 1) <= 1e-9_dp, 'wrong slip under a bound')
    call feti_problem_destroy(p)
  end subroutine

  subroutine what_does_not_fit_is_refused
    type(feti_problem) :: p
    character(len=200) :: message
    real(dp) :: slip(2, 2)
    integer :: status

    call block(p)
    call feti_friction_add(p, [2], [1, 2, 3], [1, 2], [1.0_dp, 1.0_dp], stat=status, errmsg=message)
    call require(status == FETI_ARGUMENT - 4 .and. index(message, 'node 1') > 0, 'a contact row that is not there')
    call feti_friction_add(p, [0], [1, 2, 3, 4], [1, 2, 3], [1.0_dp, 1.0_dp, 1.0_dp], stat=status)
    call require(status == FETI_ARGUMENT - 5, 'three rows of a node')
    call feti_friction_add(p, [0], [1, 2, 9], [1, 2], [1.0_dp, 1.0_dp], stat=status)
    call require(status == FETI_ARGUMENT - 5, 'a pointer behind the end')
    call feti_friction_add(p, [0], [1, 2, 3], [1, 2], [1.0_dp, 1.0_dp], [0.5_dp, 0.5_dp], stat=status)
    call require(status == FETI_ARGUMENT - 10, 'two coefficients of a node')
    call feti_friction_add(p, [0], [1, 2, 3], [1, 2], [1.0_dp, 1.0_dp], bound=[0.5_dp, 0.5_dp], stat=status)
    call require(status == FETI_ARGUMENT - 11, 'two bounds of a node')
    call feti_friction_add(p, [0], [1, 2, 3], [1], [1, 2], [1.0_dp, 1.0_dp], stat=status)
    call require(status == FETI_ARGUMENT - 6, 'bodies and unknowns that differ')
    call feti_friction_law(p, 1, [0.5_dp], [0.5_dp, 0.5_dp], stat=status)
    call require(status == FETI_ARGUMENT - 5, 'coefficients and bounds that differ')
    call feti_rows_clear(p, FETI_TANGENTIAL, stat=status, errmsg=message)
    call require(status == FETI_ARGUMENT - 2 .and. index(message, 'feti_friction_clear') > 0, 'a kind that has no rows')
    call feti_body_load(p, 1, [0.6_dp, 0.8_dp, 4.0_dp])
    call feti_solve(p)
    call feti_friction_slips(p, slip, stat=status)
    call require(status == FETI_ARGUMENT - 2, 'slips of two nodes')
    call feti_rows_clear(p, FETI_INEQUALITY)
    call feti_friction_slips(p, slip, stat=status)
    call require(status == FETI_STATE, 'slips of nodes that went with their rows')
    call feti_problem_destroy(p)
  end subroutine

end program
