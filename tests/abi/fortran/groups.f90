!> Groups of bodies that no row joins, through the typed face: one without an answer leaves the other its own; a row with
!> c = +infinity never closes; the estimated error of the forces on a body.
program groups_driver
  use, intrinsic :: iso_fortran_env, only: dp => real64
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_positive_inf, ieee_value
  use case_problem, only: require, spring_and_block
  use feti_contact
  implicit none
  integer :: stat
  character(len=400) :: text

  call one_group_without_an_answer
  call a_row_that_never_closes

contains

  !> Springs 2 (bodies 1, 3) with blocks of two unknowns joined by 4 (bodies 2, 4) pressed against them by 6 at distance 1:
  !> lambda = 6, u = -3; -4, -5.5.
  subroutine springs_and_blocks(p, groups)
    type(feti_problem), intent(inout) :: p
    integer, intent(in) :: groups

    call spring_and_block(p, [2.0_dp, 4.0_dp], -6.0_dp, 1.0_dp)
    if (groups == 2) call spring_and_block(p, [2.0_dp, 4.0_dp], -6.0_dp, 1.0_dp, more=.true.)
  end subroutine

  subroutine force_error_on(p, body, force_error)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(dp), intent(out) :: force_error
    type(feti_body_facts) :: facts

    call feti_body_info(p, body, facts)
    force_error = facts%force_error
  end subroutine

  subroutine one_group_without_an_answer
    type(feti_problem) :: p
    type(feti_info) :: info
    type(feti_findings) :: found
    real(dp) :: u(6), v(2), lambda(2), gap(2), force_error(2)
    integer :: state(2)

    call springs_and_blocks(p, 2)
    call force_error_on(p, 1, force_error(1))
    call require(ieee_is_nan(force_error(1)), 'an error of forces before a solve')
    call feti_body_load(p, 4, [0.0_dp, 6.0_dp])
    call feti_solve(p, info, stat, text)
    call require(stat == FETI_LOAD_NOT_HELD .and. info%status == stat, 'the second block does not escape')
    call require(index(text, 'body 4') > 0, 'another body: ' // trim(text))
    call require(info%worst <= 1 .and. info%active == 1 .and. info%bodies == 4, 'figures of the first group')
    call require(abs(info%energy + 19.5_dp) <= 1e-9_dp, 'energy of the first group')
    call feti_displacement(p, 2, v)
    call require(all(abs(v - [-4.0_dp, -5.5_dp]) <= 1e-9_dp), 'displacement of the first block')
    call feti_displacement(p, 4, v, stat, text)
    call require(stat == FETI_STATE, 'a displacement of the block that escapes')
    call feti_displacement(p, u)
    call require(all(ieee_is_finite(u(1:3))) .and. all(ieee_is_nan(u(4:6))), 'displacement of all bodies')
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(abs(lambda(1) - 6) <= 1e-9_dp .and. ieee_is_nan(lambda(2)), 'forces')
    call feti_gaps(p, gap)
    call require(abs(gap(1)) <= 1e-9_dp .and. ieee_is_nan(gap(2)), 'gaps')
    call feti_active(p, state)
    call require(all(state == [FETI_ROW_CLOSED, FETI_ROW_UNKNOWN]), 'states')
    call force_error_on(p, 2, force_error(1))
    call force_error_on(p, 4, force_error(2))
    call require(force_error(1) <= 1e-9_dp .and. ieee_is_nan(force_error(2)), 'errors of the forces')
    call feti_diagnosis(p, found)
    call require(found%status == FETI_LOAD_NOT_HELD .and. found%body == 4, 'diagnosis of another body')
    call feti_problem_destroy(p)
  end subroutine

  subroutine a_row_that_never_closes
    type(feti_problem) :: p
    type(feti_info) :: info
    real(dp) :: never, lambda(2), gap(2)
    integer :: state(2)

    never = ieee_value(never, ieee_positive_inf)
    call springs_and_blocks(p, 1)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1, 1], [1.0_dp, -1.0_dp], [never])
    call feti_solve(p, info)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call feti_gaps(p, gap)
    call feti_active(p, state)
    call require(abs(lambda(1) - 6) <= 1e-9_dp .and. .not. abs(lambda(2)) > 0, 'forces beside a row that never closes')
    call require(gap(2) > huge(never) .and. state(2) == FETI_ROW_OPEN .and. info%active == 1, 'the row that never closes')
    call feti_rows_rhs(p, FETI_INEQUALITY, 2, [-0.5_dp])
    call feti_solve(p)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(abs(lambda(2) - 6) <= 1e-9_dp .and. .not. abs(lambda(1)) > 0, 'the row is on')
    call feti_rows_rhs(p, FETI_INEQUALITY, 2, [never])
    call feti_solve(p)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(abs(lambda(1) - 6) <= 1e-9_dp .and. .not. abs(lambda(2)) > 0, 'the row is off again')
    call feti_problem_destroy(p)
  end subroutine
end program
