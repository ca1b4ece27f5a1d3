!> A refused call has its status, a text that names the place counting from 1, changes nothing, and the problem is
!> corrected and solved afterwards.
program errors
  use case_problem, only: require, spring_and_block
  use feti_contact
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=*), parameter :: untouched = 'untouched'
  character(len=300) :: text
  integer :: stat

  call refused_input_is_corrected_and_solved
  call arrays_that_do_not_fit_are_refused
  call order_of_calls_is_checked
  call bad_physics_is_named
  call destroyed_handles_are_refused
  call texts_fit_the_variable_of_the_host
  call a_panic_is_a_status

contains

  !> The status of the last call is this one.
  subroutine expect(status, what)
    integer, intent(in) :: status
    character(len=*), intent(in) :: what
    character(len=12) :: found

    write (found, '(i0)') stat
    call require(stat == status, what // ': status ' // trim(found) // ', text: ' // trim(text))
    if (status == FETI_OK) call require(text == untouched, what // ': errmsg was set by a call that worked')
    if (status /= FETI_OK) call require(text /= untouched, what // ': errmsg was not set')
    text = untouched
  end subroutine

  !> Argument k of the C function was refused; all words are in the text, and the detail names the function.
  subroutine expect_refused(k, function, words)
    integer, intent(in) :: k
    character(len=*), intent(in) :: function, words(:)
    type(feti_error_detail) :: detail
    integer :: i

    do i = 1, size(words)
      call require(index(text, trim(words(i))) > 0, function // ': no "' // trim(words(i)) // '" in: ' // trim(text))
    end do
    call expect(FETI_ARGUMENT - k, function)
    call feti_last_error_detail(detail)
    call require(detail%function == function, function // ': the detail names ' // trim(detail%function))
    call require(detail%argument == k .and. detail%status == FETI_ARGUMENT - k, function // ': wrong argument in the detail')
  end subroutine

  !> The index that was refused, as the program gave it; from 1.
  subroutine expect_index(number)
    integer, intent(in) :: number
    type(feti_error_detail) :: detail

    call feti_last_error_detail(detail)
    call require(nint(detail%value) == number, trim(detail%function) // ': the detail has another index than the call')
  end subroutine

  !> Spring and block of every test here, with this force on the rear of the block; nothing has failed yet.
  subroutine begin(p, force)
    type(feti_problem), intent(out) :: p
    real(dp), intent(in) :: force

    text = untouched
    call spring_and_block(p, [1000.0_dp, 4000.0_dp], force, 0.5_dp)
  end subroutine

  !> Solves and compares with the answer by hand for 100 N to the left.
  subroutine solve_and_compare(p, what)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: what
    real(dp) :: lambda(1), u(2)

    call feti_solve(p, stat=stat, errmsg=text)
    call expect(FETI_OK, what)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call feti_displacement(p, 2, u)
    call require(abs(lambda(1) - 100) < 1e-7_dp, what // ': wrong contact force afterwards')
    call require(maxval(abs(u - [-0.6_dp, -0.625_dp])) < 1e-9_dp, what // ': wrong displacement afterwards')
  end subroutine

  subroutine refused_input_is_corrected_and_solved
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    real(dp) :: nan

    nan = ieee_value(1.0_dp, ieee_quiet_nan)
    call begin(p, -100.0_dp)

    call feti_body_load(p, 2, [1.0_dp, 2.0_dp, 3.0_dp], stat, text)
    call expect_refused(3, 'feti_body_load', ['body 2', '3     ', '2     '])

    call feti_body_load(p, 2, [1.0_dp, nan], stat, text)
    call expect_refused(4, 'feti_body_load', ['2'])
    call feti_last_error_detail(detail)
    call require(detail%dof == 2 .or. detail%entry == 2, 'the detail does not name entry 2')
    call require(detail%body == 2 .and. detail%row == 0, 'the detail does not name body 2 alone')

    call feti_body_load(p, 33, [1.0_dp], stat, text)
    call expect_refused(2, 'feti_body_load', ['33'])
    call expect_index(33)
    call feti_body_load(p, 0, [1.0_dp], stat, text)
    call expect_refused(2, 'feti_body_load', ['body is below the first number'])

    call feti_body_stiffness(p, 2, [1, 2, 4], [1, 1, 77], [4000.0_dp, -4000.0_dp, 4000.0_dp], FETI_LOWER, stat, text)
    call expect_refused(5, 'feti_body_stiffness_i32', ['entry 3', 'body 2 ', 'row 2  '])
    call expect_index(77)

    call feti_body_stiffness(p, 2, [1, 2, 4], [2, 1, 2], [4000.0_dp, -4000.0_dp, 4000.0_dp], FETI_LOWER, stat, text)
    call expect_refused(5, 'feti_body_stiffness_i32', ['body 2', 'row 1 '])

    call feti_body_stiffness(p, 2, [1, 2, 4], [1, 1, 2], [4000.0_dp, nan, 4000.0_dp], FETI_LOWER, stat, text)
    call expect_refused(6, 'feti_body_stiffness_i32', ['body 2'])

    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 44], [1, 1], [1.0_dp, -1.0_dp], stat=stat, errmsg=text)
    call expect_refused(5, 'feti_rows_add_i32', ['row 1  ', 'entry 2'])
    call expect_index(44)

    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 55], [1.0_dp, -1.0_dp], stat=stat, errmsg=text)
    call expect_refused(6, 'feti_rows_add_i32', ['row 1  ', 'entry 2'])
    call expect_index(55)
    call feti_body_numbering(p, 2, [0, 1], stat, text)
    call expect_refused(4, 'feti_body_numbering_i32', ['body 2 ', 'entry 1'])
    call expect_index(0)
    call feti_body_fixing_set(p, 2, [3], stat, text)
    call expect_refused(4, 'feti_body_fixing_set', ['entry 1'])
    call expect_index(3)
    call feti_state_restore(p, 5, stat, text)
    call expect_refused(2, 'feti_state_restore', ['no state has this number'])
    call expect_index(5)

    call feti_rows_compliance(p, FETI_INEQUALITY, 1, [-0.5_dp], stat, text)
    call expect_refused(5, 'feti_rows_compliance', ['row 1  ', 'entry 1'])
    call feti_rows_compliance(p, FETI_INEQUALITY, 2, [0.5_dp], stat, text)
    call expect_refused(3, 'feti_rows_compliance', ['1'])
    call feti_rows_compliance(p, 7, 1, [0.5_dp], stat, text)
    call expect_refused(2, 'feti_rows_compliance', ['7'])

    call feti_set(p, 'no_such_option', 1.0_dp, stat, text)
    call expect_refused(2, 'feti_set_f64', ['no_such_option'])
    call feti_set(p, 'tolerance', -1.0_dp, stat, text)
    call expect_refused(3, 'feti_set_f64', ['tolerance'])

    call solve_and_compare(p, 'after refused input')
    call feti_problem_destroy(p)
  end subroutine

  !> The face compares the lengths that the C function cannot see.
  subroutine arrays_that_do_not_fit_are_refused
    type(feti_problem) :: p
    integer :: none(0)
    real(dp) :: y(2, 1)

    call begin(p, -100.0_dp)
    call feti_body_stiffness(p, 2, [1, 2, 4], [1, 1], [1.0_dp, 1.0_dp], FETI_LOWER, stat, text)
    call expect(FETI_ARGUMENT - 5, 'row_ptr behind the end of col')
    call feti_body_stiffness(p, 2, none, [1], [1.0_dp], FETI_LOWER, stat, text)
    call expect(FETI_ARGUMENT - 4, 'empty row_ptr')
    call feti_body_stiffness(p, 2, reshape([1.0_dp, 2.0_dp], [2, 1]), FETI_LOWER, stat, text)
    call expect(FETI_ARGUMENT - 4, 'a dense matrix that is not square')
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1.0_dp], stat=stat, errmsg=text)
    call expect(FETI_ARGUMENT - 4, 'row_ptr behind the end of val')
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1.0_dp, 1.0_dp], [1.0_dp, 1.0_dp], stat=stat, errmsg=text)
    call expect(FETI_ARGUMENT - 9, 'two right-hand sides for one row')
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1], [1, 1], [1.0_dp, 1.0_dp], stat=stat, errmsg=text)
    call expect(FETI_ARGUMENT - 5, 'one body for two entries')
    call feti_body_coordinates(p, 2, [1, 2], [1, 1], reshape([0.0_dp], [1, 1]), stat, text)
    call expect(FETI_ARGUMENT - 7, 'one position for two unknowns')
    call solve_and_compare(p, 'after arrays that do not fit')
    call feti_body_kplus(p, 2, reshape([1.0_dp], [1, 1]), y, stat, text)
    call expect(FETI_ARGUMENT - 7, 'x and y of different shape')
    call feti_problem_destroy(p)
  end subroutine

  !> Results before a solve and a solve before the data are FETI_STATE and say what is missing.
  subroutine order_of_calls_is_checked
    type(feti_problem) :: p
    type(feti_info) :: info
    real(dp) :: u(2)
    integer :: body

    text = untouched
    call feti_problem_create(p)
    call feti_body_add(p, 2, body)
    call feti_solve(p, info, stat, text)
    call require(index(text, 'body 1') > 0, 'the text does not name body 1: ' // trim(text))
    call expect(FETI_STATE, 'solve before the stiffness')
    call require(info%status == FETI_STATE, 'info is not written by a failed solve')
    u = 7
    call feti_displacement(p, 1, u, stat, text)
    call expect(FETI_STATE, 'displacement before solve')
    call require(all(abs(u - 7) <= 0), 'a failed call wrote a result')
    call feti_problem_destroy(p)
  end subroutine

  !> A load that nothing holds names the body; a null space that is not one and a negative spring are refused.
  subroutine bad_physics_is_named
    type(feti_problem) :: p
    type(feti_error_detail) :: detail

    call begin(p, 100.0_dp)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(index(text, 'body 2') > 0, 'the text does not name body 2: ' // trim(text))
    call expect(FETI_LOAD_NOT_HELD, 'a load that pulls the block away')
    call feti_last_error_detail(detail)
    call require(detail%status == FETI_LOAD_NOT_HELD .and. detail%body == 2, 'the detail does not name body 2')
    call require(detail%argument == 0 .and. detail%function == 'feti_solve', 'the detail names an argument')
    call feti_body_load(p, 2, [0.0_dp, -100.0_dp], stat, text)
    call expect(FETI_OK, 'the corrected load')
    call solve_and_compare(p, 'after a load that is not held')

    call feti_body_null_space(p, 2, reshape([1.0_dp, 2.0_dp], [2, 1]), FETI_EXACT)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(index(text, 'body 2') > 0, 'the text does not name body 2: ' // trim(text))
    call expect(FETI_NULL_SPACE, 'a null space that is not one')
    call feti_body_null_space(p, 2, reshape([1.0_dp, 1.0_dp], [2, 1]), FETI_EXACT)
    call solve_and_compare(p, 'after a wrong null space')

    call feti_body_stiffness(p, 1, [1, 2], [1], [-1000.0_dp], FETI_LOWER)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(index(text, 'body 1, dof 1') > 0, 'the text does not name body 1, dof 1: ' // trim(text))
    call expect(FETI_INDEFINITE, 'a negative spring')
    call feti_body_stiffness(p, 1, [1, 2], [1], [1000.0_dp], FETI_LOWER)
    call solve_and_compare(p, 'after a negative spring')
    call feti_problem_destroy(p)
  end subroutine

  !> A copy is another name of the same problem: destroyed once, gone for both.
  subroutine destroyed_handles_are_refused
    type(feti_problem) :: p, copy, never_created
    integer :: body

    call begin(p, -100.0_dp)
    copy = p
    call solve_and_compare(copy, 'through a copy')
    call feti_problem_destroy(p, stat, text)
    call expect(FETI_OK, 'destroy')
    call feti_problem_destroy(p, stat, text)
    call expect(FETI_HANDLE, 'destroy twice')
    call feti_problem_destroy(copy, stat, text)
    call expect(FETI_HANDLE, 'destroy a copy of a destroyed problem')
    body = 5
    call feti_body_add(copy, 1, body, stat, text)
    call expect(FETI_HANDLE, 'a copy of a destroyed problem')
    call require(body == 0, 'a failed feti_body_add gave a body')
    call feti_solve(never_created, stat=stat, errmsg=text)
    call expect(FETI_HANDLE, 'a problem that was never created')
  end subroutine

  !> errmsg is cut or padded; feti_last_error and feti_problem_error give the whole text.
  subroutine texts_fit_the_variable_of_the_host
    type(feti_problem) :: p
    character(len=:), allocatable :: whole, of_problem
    character(len=9) :: short
    type(feti_error_detail) :: detail

    call begin(p, -100.0_dp)
    short = untouched
    call feti_body_load(p, 2, [1.0_dp], stat, short)
    call feti_last_error(whole)
    call require(len(whole) > 9 .and. short == whole(:min(9, len(whole))), 'errmsg is not the beginning of the text')
    call feti_problem_error(p, of_problem)
    call require(of_problem == whole, 'the texts of the problem and of the thread differ')
    call feti_last_error_detail(detail)
    call require(detail%component == 0 .and. detail%entry == 0, 'what does not apply is not 0')
    call require(feti_status_name(FETI_LOAD_NOT_HELD) == 'FETI_LOAD_NOT_HELD', 'wrong name of a status')
    call require(feti_status_name(FETI_ARGUMENT - 3) == 'FETI_ARGUMENT', 'wrong name of a refused argument')
    call require(len(feti_status_text(FETI_STATE)) > 10, 'no text for a status')
    call feti_problem_destroy(p)
  end subroutine

  !> After a panic inside the library the problem can only be destroyed; other problems work.
  subroutine a_panic_is_a_status
    type(feti_problem) :: p, other
    real(dp) :: lambda(1)

    call begin(other, -100.0_dp)
    call begin(p, -100.0_dp)
    call feti_set(p, 'fault_injection', 1)
    call feti_solve(p, stat=stat, errmsg=text)
    call expect(FETI_INTERNAL, 'a panic')
    call feti_multipliers(p, FETI_INEQUALITY, lambda, stat, text)
    call expect(FETI_INTERNAL, 'a result after a panic')
    call feti_problem_destroy(p, stat, text)
    call expect(FETI_OK, 'destroy after a panic')
    call solve_and_compare(other, 'after a panic in another problem')
    call feti_problem_destroy(other)
  end subroutine

end program
