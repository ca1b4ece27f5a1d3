!> Progress functions, cancelling, saved states and the diagnosis through the typed face: module procedures with data of
!> any type, everything counted from 1.
module watchers
  use feti_contact
  implicit none
  private
  public :: diary, note, refuse_calls, solve_another, fail

  !> What a progress function keeps.
  type :: diary
    type(feti_problem) :: problem
    integer :: calls = 0, cancel_at = 0, busy = 0, last_step = 0
    logical :: by_call = .false.
  end type

contains

  !> Counts the calls; cancels at one of them, by its result or by feti_cancel.
  integer function note(now, data)
    type(feti_progress), intent(in) :: now
    class(*), intent(inout) :: data

    note = 0
    select type (data)
    type is (diary)
      data%calls = data%calls + 1
      data%last_step = int(now%steps)
      if (now%phase == FETI_PHASE_SETUP .and. .not. (now%fraction >= 0 .and. now%fraction <= 1)) note = -2
      if (data%calls == data%cancel_at) then
        note = 1
        if (data%by_call) then
          call feti_cancel(data%problem)
          note = 0
        end if
      end if
    class default
      note = -99
    end select
  end function

  !> Calls on the same problem from inside are refused.
  integer function refuse_calls(now, data)
    type(feti_progress), intent(in) :: now
    class(*), intent(inout) :: data
    integer :: stat

    refuse_calls = 0
    if (now%struct_size <= 0) refuse_calls = -1
    select type (data)
    type is (diary)
      call feti_solve(data%problem, stat=stat)
      if (stat == FETI_BUSY) data%busy = data%busy + 1
    end select
  end function

  !> Solves another problem from inside, which this function watches, too.
  recursive integer function solve_another(now, data)
    type(feti_progress), intent(in) :: now
    class(*), intent(inout) :: data

    solve_another = 0
    if (now%struct_size <= 0) solve_another = -1
    select type (data)
    type is (diary)
      data%calls = data%calls + 1
      if (data%calls == 1) call feti_solve(data%problem)
    end select
  end function

  !> Given without data: what it gets is of no type that a host can name.
  integer function fail(now, data)
    type(feti_progress), intent(in) :: now
    class(*), intent(inout) :: data

    fail = -1
    select type (data)
    type is (integer)
      fail = -2
    type is (diary)
      fail = -3
    class default
      if (now%phase == FETI_PHASE_SETUP) fail = -5
    end select
  end function

end module

program watched
  use case_reader
  use case_problem, only: data_folder, handed_over, require, spring_and_block
  use feti_contact
  use watchers
  implicit none

  type(contact_case) :: wall
  character(len=300) :: text
  integer :: stat

  call read_case(data_folder(), 'p1_P3', wall)
  call steps_are_told_and_cancelled
  call phases_are_told
  call copies_share_the_function
  call failures_and_calls_from_inside
  call another_problem_is_solved_from_inside
  call states_come_back
  call diagnosis_counts_from_one

contains

  !> Forces of the contact rows after a solve that must work.
  function forces(p) result(lambda)
    type(feti_problem), intent(in) :: p
    real(dp) :: lambda(size(wall%c))

    call feti_solve(p)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
  end function

  subroutine steps_are_told_and_cancelled
    type(feti_problem) :: p
    type(feti_info) :: info
    type(diary), target :: book
    real(dp) :: wanted(size(wall%c))

    call handed_over(p, wall)
    wanted = forces(p)
    book%problem = p
    call feti_on_progress(p, note, book)
    call feti_solve(p, info)
    call require(book%calls == info%steps .and. book%last_step == info%steps, 'not every step was told')

    book%calls = 0
    book%cancel_at = 3
    call feti_solve(p, info, stat, text)
    call require(stat == FETI_CANCELLED .and. info%steps == 3, 'not cancelled by the result: ' // trim(text))
    book%calls = 0
    book%by_call = .true.
    call feti_solve(p, info, stat, text)
    call require(stat == FETI_CANCELLED .and. info%steps == 3, 'not cancelled by feti_cancel: ' // trim(text))

    call feti_on_progress(p)
    book%calls = 0
    call require(maxval(abs(forces(p) - wanted)) <= 0, 'other bits after a cancelled solve')
    call require(book%calls == 0, 'a function that was taken away is still called')
    call feti_problem_destroy(p)
  end subroutine

  !> Implicit dual operators give the same forces; every phase has its name, time and bytes.
  subroutine phases_are_told
    type(feti_problem) :: p
    type(feti_info) :: info
    type(feti_phase) :: phase
    real(dp) :: wanted(size(wall%c)), found(size(wall%c)), seconds
    integer :: count, k

    call handed_over(p, wall)
    call feti_set(p, 'dual_operator', 'explicit')
    wanted = forces(p)
    call feti_set(p, 'dual_operator', 'implicit')
    call feti_solve(p, info)
    call feti_multipliers(p, FETI_INEQUALITY, found)
    call require(maxval(abs(found - wanted)) <= 1e-9_dp*maxval(abs(wanted)), 'implicit operators give other forces')
    call require(info%explicit_operators == 0 .and. info%implicit_operators == info%bodies, 'operators are not implicit')
    call require(info%factor_bytes > 0 .and. info%operator_bytes == 0, 'wrong bytes')

    call feti_phase_count(p, count)
    seconds = 0
    do k = 1, count
      call feti_phase_at(p, k, phase)
      call require(len(phase%name) > 3, 'a phase without a name')
      if (phase%name == 'factorisation') call require(phase%bytes == info%factor_bytes, 'wrong bytes of the factors')
      seconds = seconds + phase%seconds
    end do
    call require(seconds > 0 .and. seconds <= 1.001_dp*(info%seconds_setup + info%seconds_solve), 'wrong times')
    call feti_phase_at(p, count + 1, phase, stat, text)
    call require(stat == FETI_ARGUMENT - 2, 'a phase beyond the last one: ' // trim(text))
    call feti_problem_destroy(p)
  end subroutine

  !> A copy is another name: what is given to one holds for the other, and destroying either ends both.
  subroutine copies_share_the_function
    type(feti_problem) :: p, copy
    type(diary), target :: book

    call handed_over(p, wall)
    copy = p
    call feti_on_progress(copy, note, book)
    call feti_solve(p)
    call require(book%calls > 2, 'the function given to a copy is not called')
    call feti_problem_destroy(copy)
    call feti_on_progress(p, note, book, stat, text)
    call require(stat == FETI_HANDLE, 'a destroyed problem took a function')
    call feti_problem_destroy(p, stat, text)
    call require(stat == FETI_HANDLE, 'destroyed twice')
  end subroutine

  subroutine failures_and_calls_from_inside
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    type(diary), target :: book

    call handed_over(p, wall)
    call feti_on_progress(p, note, book)
    call feti_on_progress(p, fail)
    call feti_setup(p, stat, text)
    call require(stat == FETI_CALLBACK, 'a failure of the function was not reported: ' // trim(text))
    call feti_last_error_detail(detail)
    call require(abs(detail%value + 5) <= 0 .and. detail%function == 'feti_setup', 'the detail lacks the number')

    book%problem = p
    call feti_on_progress(p, refuse_calls, book)
    call feti_solve(p)
    call require(book%busy > 2, 'a solve inside a solve was not refused')
    call feti_problem_destroy(p)
  end subroutine

  subroutine another_problem_is_solved_from_inside
    type(feti_problem) :: p
    type(diary), target :: book
    real(dp) :: outer(size(wall%c)), inner(size(wall%c))

    call handed_over(p, wall)
    call handed_over(book%problem, wall)
    call feti_on_progress(p, solve_another, book)
    call feti_on_progress(book%problem, solve_another, book)
    outer = forces(p)
    call require(book%calls > 2, 'not heard')
    call feti_multipliers(book%problem, FETI_INEQUALITY, inner)
    call require(sum(outer) > 0 .and. maxval(abs(inner - outer)) <= 0, 'other bits inside')
    call feti_problem_destroy(book%problem)
    call feti_problem_destroy(p)
  end subroutine

  subroutine states_come_back
    type(feti_problem) :: p
    type(feti_info) :: cold, warm
    real(dp), dimension(size(wall%c)) :: before, now
    integer :: id, other

    call handed_over(p, wall)
    before = forces(p)
    call feti_state_save(p, id)
    call feti_state_save(p, other)
    call require(id == 1 .and. other == 2, 'states do not count from 1')
    call feti_rows_rhs(p, FETI_INEQUALITY, 1, wall%c + 1e-3_dp)
    call feti_solve(p, cold)
    call feti_state_restore(p, id)
    call feti_multipliers(p, FETI_INEQUALITY, now)
    call require(maxval(abs(now - before)) <= 0, 'the answer has not come back')
    call require(maxval(abs(forces(p) - before)) <= 0, 'other bits after a state came back')

    call feti_set(p, 'start', 'previous')
    call feti_solve(p, warm)
    call require(3*warm%dual_applications <= cold%dual_applications, 'the saved multipliers were not used')
    call feti_set(p, 'start', 'cold')
    call feti_start_from(p, FETI_INEQUALITY, before(2:), stat, text)
    call require(stat == FETI_ARGUMENT - 3, 'start values of the wrong number: ' // trim(text))
    call feti_start_from(p, FETI_INEQUALITY, before)
    call feti_solve(p, warm)
    call require(warm%dual_applications < cold%dual_applications, 'the start values were not used')

    call feti_state_drop(p, id)
    call feti_state_restore(p, id, stat, text)
    call require(stat == FETI_ARGUMENT - 2, 'a dropped state came back')
    call feti_rows_clear(p, FETI_INEQUALITY)
    call feti_state_restore(p, other)
    call require(maxval(abs(forces(p) - before)) <= 0, 'the rows of a state have not come back')
    call feti_body_add(p, 1, id)
    call feti_state_restore(p, other, stat, text)
    call require(stat == FETI_STATE .and. index(text, 'bodies were added') > 0, 'other bodies: ' // trim(text))
    call feti_problem_destroy(p)
  end subroutine

  !> Spring and block: the load pulls the block away; then two rows contradict each other.
  subroutine diagnosis_counts_from_one
    type(feti_problem) :: p
    type(feti_findings) :: found
    real(dp) :: v(2)
    real(dp), allocatable :: weight(:)
    integer, allocatable :: row(:)

    call spring_and_block(p, [1000.0_dp, 4000.0_dp], 100.0_dp, 0.5_dp)
    call feti_diagnosis(p, found, stat, text)
    call require(stat == FETI_STATE, 'a diagnosis before the first solve')
    call feti_solve(p, stat=stat, errmsg=text)
    call feti_diagnosis(p, found)
    call require(found%status == FETI_LOAD_NOT_HELD .and. found%body == 2, 'the diagnosis does not name body 2')
    call require(found%row == 0 .and. found%component == 0 .and. found%dof >= 1, 'what does not apply is not 0')
    call feti_diagnosis_motion(p, 2, v)
    call require(maxval(abs(v - 1)) < 1e-12_dp, 'wrong motion')

    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1, 1], [-2.0_dp, 2.0_dp], [-8.0_dp])
    call feti_solve(p, stat=stat, errmsg=text)
    call require(stat == FETI_GAPS_CONTRADICT, 'rows that contradict each other: ' // trim(text))
    call feti_diagnosis(p, found)
    call require(found%kind == FETI_INEQUALITY .and. found%row == 1 .and. found%rows_involved == 2, 'wrong rows')
    call feti_diagnosis_rows(p, FETI_INEQUALITY, row, weight)
    call require(all(row == [1, 2]) .and. maxval(abs(weight - [1.0_dp, 0.5_dp])) < 1e-9_dp, 'wrong list of rows')
    call feti_diagnosis_rows(p, FETI_EQUALITY, row, weight)
    call require(size(row) == 0 .and. size(weight) == 0, 'equality rows where there are none')
    call feti_problem_destroy(p)
  end subroutine

end program
