!> Every form in which the module takes a problem gives the same answer: int32 and int64, lower, upper and full, dense,
!> sections of arrays that are not contiguous, bodies named or counted through, options of every type.
program input_forms
  use case_problem, only: require
  use feti_contact
  use, intrinsic :: iso_fortran_env, only: int32, int64
  implicit none
  integer, parameter :: dp = kind(1.0d0)

  call stiffness_forms_agree
  call row_forms_agree
  call sections_agree
  call fixing_dofs_are_taken
  call right_hand_sides_change
  call settings_are_listed_set_and_read
  call the_version_is_told

contains

  !> Spring (1 unknown, held, 1000 N/mm) and block (2 unknowns, floating): everything but the block's stiffness and rows.
  subroutine begin(p)
    type(feti_problem), intent(out) :: p
    real(dp) :: held(1, 0)
    integer :: body

    call feti_problem_create(p)
    call feti_body_add(p, 1, body)
    call require(body == 1, 'the first body is not number 1')
    call feti_body_add(p, 2, body)
    call require(body == 2, 'the second body is not number 2')
    call feti_body_stiffness(p, 1, reshape([1000.0_dp], [1, 1]), FETI_FULL)
    call feti_body_null_space(p, 1, held, FETI_EXACT)
    call feti_body_null_space(p, 2, reshape([1.0_dp, 1.0_dp], [2, 1]), FETI_EXACT)
    call feti_body_load(p, 2, [0.0_dp, -100.0_dp])
  end subroutine

  subroutine add_stiffness(p)
    type(feti_problem), intent(in) :: p

    call feti_body_stiffness(p, 2, [1, 2, 4], [1, 1, 2], [4000.0_dp, -4000.0_dp, 4000.0_dp], FETI_LOWER)
  end subroutine

  subroutine add_rows(p)
    type(feti_problem), intent(in) :: p

    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1, 1], [1.0_dp, -1.0_dp], [0.5_dp])
  end subroutine

  !> By hand: spring end -0.1, gap 0.5 closed, block squeezed by 0.025; then the problem is given back.
  subroutine finish(p, what)
    type(feti_problem), intent(inout) :: p
    character(len=*), intent(in) :: what
    real(dp) :: lambda(1), u(3)

    call feti_solve(p)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call feti_displacement(p, 1, u(:1))
    call feti_displacement(p, 2, u(2:))
    call require(abs(lambda(1) - 100) < 1e-7_dp, what // ': wrong contact force')
    call require(maxval(abs(u - [-0.1_dp, -0.6_dp, -0.625_dp])) < 1e-9_dp, what // ': wrong displacement')
    call feti_problem_destroy(p)
  end subroutine

  !> Either unknown of the block may be held in K+, and the library's own choice comes back.
  subroutine fixing_dofs_are_taken
    type(feti_problem) :: p
    integer :: k, own(1), held(1), none(0)

    do k = 1, 2
      call begin(p)
      call add_stiffness(p)
      call add_rows(p)
      call feti_body_fixing(p, 2, own)
      call feti_body_fixing_set(p, 2, [k])
      call feti_body_fixing(p, 2, held)
      call require(held(1) == k, 'the unknown held is not the one given')
      if (k == 2) then
        call feti_body_fixing_set(p, 2, none)
        call feti_body_fixing(p, 2, held)
        call require(held(1) == own(1), 'the unknown held is not the one of the library')
      end if
      call finish(p, 'fixing unknowns')
    end do
  end subroutine

  subroutine stiffness_forms_agree
    type(feti_problem) :: p
    real(dp), parameter :: s = 4000
    integer :: form

    do form = 1, 6
      call begin(p)
      select case (form)
      case (1)
        call feti_body_stiffness(p, 2, [1_int64, 2_int64, 4_int64], [1_int64, 1_int64, 2_int64], [s, -s, s], FETI_LOWER)
      case (2)
        call feti_body_stiffness(p, 2, [1_int32, 3_int32, 4_int32], [2_int32, 1_int32, 2_int32], [-s, s, s], FETI_UPPER)
      case (3)
        call feti_body_stiffness(p, 2, [1, 3, 5], [1, 2, 1, 2], [s, -s, -s, s], FETI_FULL)
      case (4)
        call feti_body_stiffness(p, 2, reshape([s, -s, -s, s], [2, 2]), FETI_FULL)
      case (5)
        call feti_body_stiffness(p, 2, reshape([s, -s, 1e30_dp, s], [2, 2]), FETI_LOWER)
      case (6)
        call feti_body_stiffness(p, 2, reshape([s, 1e30_dp, -s, s], [2, 2]), FETI_UPPER)
      end select
      call add_rows(p)
      call finish(p, 'form of the stiffness number ' // achar(iachar('0') + form))
    end do
  end subroutine

  subroutine row_forms_agree
    type(feti_problem) :: p
    integer :: form, first

    do form = 1, 4
      call begin(p)
      call add_stiffness(p)
      select case (form)
      case (1)
        call feti_rows_add(p, FETI_INEQUALITY, [1_int64, 3_int64], [1_int64, 2_int64], [1_int64, 1_int64], &
          [1.0_dp, -1.0_dp], [0.5_dp], first)
      case (2)
        call feti_rows_add(p, FETI_INEQUALITY, [1_int64, 3_int64], [1_int64, 2_int64], [1.0_dp, -1.0_dp], [0.5_dp], first)
      case (3)
        call feti_rows_add(p, FETI_INEQUALITY, [1_int32, 3_int32], [1_int32, 2_int32], [1.0_dp, -1.0_dp], [0.5_dp], first)
      case (4)
        ! An entry given twice adds up: 0.25 + 0.75.
        call feti_rows_add(p, FETI_INEQUALITY, [1, 4], [1, 1, 2], [1, 1, 1], [0.25_dp, 0.75_dp, -1.0_dp], [0.5_dp], first)
      end select
      call require(first == 1, 'the first row is not number 1')
      call finish(p, 'form of the rows number ' // achar(iachar('0') + form))
    end do
  end subroutine

  !> Every second element, a corner of a larger matrix, coordinates without their third row.
  subroutine sections_agree
    type(feti_problem) :: p
    real(dp) :: wide(6), large(5, 5), positions(3, 4), spread_u(4), alpha(1), kept(1)
    integer :: labels(6)

    call begin(p)
    large = 1e30_dp
    large(2:4:2, 2:4:2) = reshape([4000.0_dp, -4000.0_dp, -4000.0_dp, 4000.0_dp], [2, 2])
    call feti_body_stiffness(p, 2, large(2:4:2, 2:4:2), FETI_FULL)
    wide = [0.0_dp, 1e30_dp, 1e30_dp, -100.0_dp, 1e30_dp, 1e30_dp]
    call feti_body_load(p, 2, wide(1:4:3))
    positions = 1e30_dp
    positions(1, :) = [0.0_dp, 1e30_dp, 10.0_dp, 1e30_dp]
    labels = [1, 99, 2, 99, 99, 99]
    call feti_body_coordinates(p, 2, labels(1:3:2), [1, 1], positions(:1, 1:3:2))
    large(1, 1:2) = 1
    call feti_body_null_space(p, 2, reshape(large(1, 1:2), [2, 1]), FETI_EXACT)
    labels = [1, 99, 3, 99, 99, 99]
    wide = [1.0_dp, 1e30_dp, 1e30_dp, -1.0_dp, 1e30_dp, 0.5_dp]
    call feti_rows_add(p, FETI_INEQUALITY, labels(1:3:2), [1, 2], [1, 1], wide(1:4:3), wide(6:6))
    call feti_solve(p)
    spread_u = 7
    call feti_displacement(p, 2, spread_u(1:3:2))
    call require(maxval(abs(spread_u - [-0.6_dp, 7.0_dp, -0.625_dp, 7.0_dp])) < 1e-9_dp, 'u is not written into a section')
    call feti_amplitudes(p, 2, alpha)
    kept = alpha
    call require(abs(kept(1)) < huge(1.0_dp), 'the amplitude is not a number')
    call finish(p, 'sections')
  end subroutine

  !> A new gap is a new load case; cleared rows are numbered from 1 again.
  subroutine right_hand_sides_change
    type(feti_problem) :: p
    real(dp) :: u(2)
    integer :: first, rows

    call begin(p)
    call add_stiffness(p)
    call add_rows(p)
    call feti_rows_rhs(p, FETI_INEQUALITY, 1, [1.5_dp])
    call feti_solve(p)
    call feti_displacement(p, 2, u)
    call require(maxval(abs(u - [-1.6_dp, -1.625_dp])) < 1e-9_dp, 'a new gap gives the wrong displacement')
    call feti_rows_clear(p, FETI_INEQUALITY)
    call feti_counts(p, rows=rows)
    call require(rows == 0, 'rows remain after feti_rows_clear')
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1, 1], [1.0_dp, -1.0_dp], [0.5_dp], first)
    call require(first == 1, 'rows are not numbered from 1 again')
    call finish(p, 'rows given again')
  end subroutine

  subroutine settings_are_listed_set_and_read
    type(feti_problem) :: p
    type(feti_option) :: option
    real(dp) :: tolerance
    integer(int32) :: steps, base
    integer(int64) :: memory
    integer :: k, stat, found

    call feti_problem_create(p)
    found = 0
    do k = 1, feti_option_count()
      call feti_option_at(k, option)
      call require(len(option%doc) > 0, option%name // ' has no description')
      if (option%name == 'tolerance') then
        found = k
        call feti_get(p, 'tolerance', tolerance)
        call require(option%type == FETI_OPTION_F64 .and. abs(option%default_real - tolerance) <= 0, &
          'a new problem does not have the default of tolerance')
        call require(option%minimum < tolerance .and. tolerance < option%maximum, 'the default of tolerance is out of range')
      end if
    end do
    call require(found > 0, 'tolerance is not listed')
    call feti_option_at(feti_option_count() + 1, option, stat)
    call require(stat < FETI_ARGUMENT, 'a setting beyond the last one is told')

    call feti_set(p, 'tolerance', 1e-11_dp)
    call feti_get(p, 'tolerance', tolerance)
    call require(abs(tolerance - 1e-11_dp) <= 0, 'tolerance is not what was set')
    call feti_set(p, 'max_steps', 123)
    call feti_get(p, 'max_steps', steps)
    call require(steps == 123, 'max_steps is not what was set')
    call feti_set(p, 'memory_limit', 2_int64**40)
    call feti_get(p, 'memory_limit', memory)
    call require(memory == 2_int64**40, 'memory_limit is not what was set')
    steps = 5
    call feti_get(p, 'memory_limit', steps, stat)
    call require(stat == FETI_OVERFLOW .and. steps == 5, 'a number too large for int32 is handed out')
    call feti_get(p, 'index_base', base)
    call require(base == 1, 'texts do not count from 1')
    call feti_problem_destroy(p)
  end subroutine

  subroutine the_version_is_told
    character(len=20) :: expected

    write (expected, '(i0, 2(".", i0))') FETI_CONTACT_VERSION_MAJOR, FETI_CONTACT_VERSION_MINOR, FETI_CONTACT_VERSION_PATCH
    call require(feti_version() == expected, 'the library has another version than the module')
    call require(feti_version_number() == 10000 * FETI_CONTACT_VERSION_MAJOR + 100 * FETI_CONTACT_VERSION_MINOR &
      + FETI_CONTACT_VERSION_PATCH, 'wrong version number')
  end subroutine

end program
