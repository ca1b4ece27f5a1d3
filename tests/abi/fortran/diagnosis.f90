!> Diagnoses through the typed face: the body that escapes, rows that contradict each other, motions left undetermined,
!> redundant and dependent rows, untouched bodies, all counted from 1.
program diagnosis_driver
  use, intrinsic :: iso_fortran_env, only: dp => real64
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use case_problem, only: require, spring_and_block
  use feti_contact
  implicit none
  integer :: stat
  character(len=400) :: text

  call a_body_escapes
  call rows_contradict_each_other
  call an_answer_leaves_things_open

contains

  !> A spring at a wall, a bar that rests on it, and a bar along y that nothing touches; u_1 - u_2 <= 0.1 and three times
  !> the same, u_2 = u_3 (the ends of the bar) and the sum of both ends twice.
  subroutine spring_and_bars(p)
    type(feti_problem), intent(inout) :: p
    integer :: bar

    call spring_and_block(p, [2.0_dp, 4.0_dp], 0.0_dp, 0.1_dp)
    call feti_body_add(p, 2, bar)
    call feti_body_stiffness(p, bar, [1, 2, 4], [1, 1, 2], [4.0_dp, -4.0_dp, 4.0_dp], FETI_LOWER)
    call feti_body_null_space(p, bar, reshape([1.0_dp, 1.0_dp], [2, 1]), FETI_EXACT)
    call feti_body_coordinates(p, 2, [1, 2], [1, 1], reshape([5.0_dp, 6.0_dp], [1, 2]))
    call feti_body_coordinates(p, 3, [1, 2], [2, 2], reshape([0.0_dp, 1.0_dp, 0.0_dp, 2.0_dp], [2, 2]))
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [3.0_dp, -3.0_dp], [0.3_dp])
  end subroutine

  subroutine a_body_escapes
    type(feti_problem) :: p
    type(feti_findings) :: found
    real(dp) :: v(2)

    call spring_and_bars(p)
    call feti_body_load(p, 2, [0.0_dp, 6.0_dp])
    call feti_solve(p, stat=stat)
    call require(stat == FETI_LOAD_NOT_HELD, 'the bar does not escape')
    call feti_diagnosis(p, found)
    call require(found%body == 2 .and. abs(found%margin - 1) < 1e-12_dp, 'another body, or another margin')
    call require(all(abs(found%motion - [1, 0, 0, 0, 0, 0]) < 1e-9_dp), 'another rigid motion')
    call feti_diagnosis_motion(p, 2, v)
    call require(all(abs(v - 1) < 1e-12_dp), 'another motion')
    call feti_problem_destroy(p)
  end subroutine

  subroutine rows_contradict_each_other
    type(feti_problem) :: p
    type(feti_findings) :: found
    integer, allocatable :: row(:)
    real(dp), allocatable :: weight(:)

    call spring_and_bars(p)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [-2.0_dp, 2.0_dp], [-2.0_dp])
    call feti_solve(p, stat=stat)
    call require(stat == FETI_GAPS_CONTRADICT, 'no contradiction')
    call feti_diagnosis(p, found)
    call require(found%kind == FETI_INEQUALITY .and. found%rows_involved == 2 .and. found%margin > 0, 'other findings')
    call feti_diagnosis_rows(p, FETI_INEQUALITY, row, weight)
    call require(size(row) == 2 .and. row(2) == 3, 'other rows')
    call require(any(abs(maxval(weight) - [1.0_dp]) < 1e-12_dp), 'weights are not scaled')
    call feti_problem_destroy(p)
  end subroutine

  subroutine an_answer_leaves_things_open
    type(feti_problem) :: p
    type(feti_findings) :: found
    integer, allocatable :: list(:)
    real(dp), allocatable :: weight(:)
    real(dp) :: motion(6), v(2)
    integer :: body

    call spring_and_bars(p)
    call feti_body_load(p, 2, [0.0_dp, -6.0_dp])
    call feti_rows_add(p, FETI_EQUALITY, [1, 3, 5, 7], [4, 5, 1, 4, 1, 5], &
      [1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp], [0.0_dp, 0.0_dp, 0.0_dp])
    call feti_solve(p)
    call feti_diagnosis_dependent(p, list)
    call require(size(list) == 1, 'not one dependent row')
    if (size(list) == 1) call require(list(1) >= 1 .and. list(1) <= 3, 'the dependent row is none of the three')
    call feti_rows_clear(p, FETI_EQUALITY)
    call feti_solve(p)
    call feti_diagnosis_dependent(p, list)
    call require(size(list) == 0, 'dependent rows where there are none')

    call feti_diagnosis(p, found)
    call require(found%undetermined == 1 .and. found%untouched_body == 3 .and. found%redundant_rows == 1, 'other findings')
    call require(found%doubtful_bodies == 0 .and. found%doubtful_body == 0, 'doubts about a matrix of all digits')
    call require(ieee_is_nan(found%margin), 'a margin of an answer')
    call feti_diagnosis_rows(p, FETI_INEQUALITY, list, weight)
    call require(size(list) == 1 .and. all(list == 2) .and. all(abs(weight - 3) < 1e-12_dp), 'another redundant row')
    call feti_diagnosis_untouched(p, list)
    call require(size(list) == 1 .and. all(list == 3), 'another untouched body')
    call feti_diagnosis_undetermined(p, 1, body, motion)
    call require(body == 3 .and. all(abs(motion - [0, 1, 0, 0, 0, 0]) < 1e-9_dp), 'another undetermined motion')
    call feti_diagnosis_undetermined_motion(p, 1, 3, v)
    call require(all(abs(v - 1) < 1e-12_dp), 'the undetermined motion moves otherwise')
    call feti_diagnosis_undetermined_motion(p, 1, 2, v)
    call require(all(abs(v) < 1e-12_dp), 'a body that rests moves')
    call feti_diagnosis_undetermined(p, 2, body, motion, stat, text)
    call require(stat == FETI_ARGUMENT - 2, 'a motion that is not there: ' // trim(text))
    call feti_problem_destroy(p)
  end subroutine
end program
