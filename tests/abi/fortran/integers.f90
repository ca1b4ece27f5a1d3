!> Default INTEGER of 4 or of 8 bytes, by the flag of the host: the spring and the block of README.md with default integers
!> everywhere, constants where they are taken, labels and states of both kinds.
program integers
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1d0)
  integer, parameter :: node(2) = [7, 8], dir(2) = [1, 1]
  real(dp), parameter :: x(1, 2) = reshape([0.0_dp, 1.0_dp], [1, 2])
  type(feti_problem) :: p
  integer :: spring, block, first, stat, state(1), lines
  integer(int32) :: short(1)
  integer(int64) :: long(1)
  real(dp) :: u(2), r(2)
  character(len=200) :: text

  call feti_problem_create(p)
  call feti_set(p, 'threads', 1)
  call feti_body_add(p, 1, spring)
  call feti_body_add(p, 2, block)
  call feti_body_stiffness(p, spring, [1, 2], [1], [1000.0_dp], FETI_LOWER)
  call feti_body_stiffness(p, block, [1, 2, 4], [1, 1, 2], [4000.0_dp, -4000.0_dp, 4000.0_dp], FETI_LOWER)
  call feti_body_no_null_space(p, spring)
  call feti_body_coordinates(p, block, node, dir, x)
  call feti_body_load(p, block, [0.0_dp, -100.0_dp])
  call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [spring, block], [1, 1], [1.0_dp, -1.0_dp], [0.5_dp], first)
  call feti_on_log(p, level=FETI_LOG_STEP)
  call feti_solve(p)
  call feti_displacement(p, block, u)
  call holds(maxval(abs(u - [-0.6_dp, -0.625_dp])) < 1e-9_dp, 'displacement')
  call feti_reaction(p, FETI_INEQUALITY, block, r)
  call holds(maxval(abs(r - [100.0_dp, 0.0_dp])) < 1e-9_dp, 'reaction')

  call feti_active(p, state)
  call feti_active(p, short)
  call feti_active(p, long)
  call holds(state(1) == FETI_ROW_CLOSED .and. short(1) == state(1) .and. long(1) == state(1), 'state of the row')
  long = -5
  call feti_active(p, long(:0), stat, text)
  call holds(stat == FETI_ARGUMENT - 2 .and. long(1) == -5, 'no room for states: ' // text)
  call feti_body_coordinates(p, block, [1_int64, 2_int64**31], [1_int64, 1_int64], x, stat, text)
  call holds(stat == FETI_OVERFLOW .and. index(text, 'feti_body_coordinates: ') == 1, 'a label of 33 bits: ' // text)
  call feti_body_coordinates(p, block, [1_int64, 2_int64], [1_int64, 7_int64], x, stat, text)
  call holds(stat == FETI_ARGUMENT - 6, 'direction 7: ' // text)
  call feti_body_coordinates(p, block, [1_int64, 2_int64], [1_int64, 1_int64], x)
  call feti_solve(p)
  call feti_counts(p, rows=lines)
  call holds(lines == 1 .and. first == 1, 'rows')
  call feti_problem_destroy(p)

contains

  subroutine holds(condition, claim)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: claim

    if (condition) return
    print '(2a)', 'wrong: ', trim(claim)
    error stop 1
  end subroutine

end program
