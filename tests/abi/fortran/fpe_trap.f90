!> Compiled with -ffpe-trap=invalid,zero,overflow,underflow: the library traps nothing, leaves the traps of the host as they
!> are, raises none of its flags, and gives the bits that it gives without traps.
program fpe_trap
  use case_problem, only: require
  use feti_contact
  use, intrinsic :: ieee_arithmetic
  implicit none
  integer, parameter :: dp = kind(1.0d0), n = 30
  type(ieee_flag_type), parameter :: trapped(4) = [ieee_invalid, ieee_divide_by_zero, ieee_overflow, ieee_underflow]
  real(dp) :: with_traps(2 * n + 1), without(2 * n + 1)
  character(len=200) :: text
  integer :: stat

  call require(all_are_trapped(), 'the program is not compiled with traps')
  call bars_in_contact(with_traps)
  call refusals_are_reported
  call ieee_set_halting_mode(trapped, .false.)
  call bars_in_contact(without)
  call require(.not. maxval(abs(with_traps - without)) > 0, 'other bits with traps than without')
  call require(abs(with_traps(2 * n + 1) - 0.5_dp * (1 - 0.5_dp / n)) < 1e-9_dp, 'wrong contact force')

contains

  logical function all_are_trapped()
    logical :: halts(size(trapped))

    call ieee_get_halting_mode(trapped, halts)
    all_are_trapped = all(halts)
  end function

  !> Two rows of n unknowns, each joined by springs of stiffness 1 and held at one end; the end of the first is pushed by
  !> 1 against that of the second across the gap 0.5, so that u_1(n) = n (1 - lambda), u_2(n) = n lambda.
  subroutine bars_in_contact(answer)
    real(dp), intent(out) :: answer(:)
    type(feti_problem) :: p
    real(dp) :: val(2 * n - 1), load(n), none(n, 0)
    integer :: row_ptr(n + 1), col(2 * n - 1), body, number, i
    logical :: raised(size(ieee_all)), halts(size(trapped)), halts_after(size(trapped))

    row_ptr = [1, (2 * i, i = 1, n)]
    col = [1, (i - 1, i, i = 2, n)]
    val = [2.0_dp, (-1.0_dp, 2.0_dp, i = 2, n - 1), -1.0_dp, 1.0_dp]
    load = [(0.0_dp, i = 1, n - 1), 1.0_dp]
    call ieee_get_halting_mode(trapped, halts)
    call ieee_set_flag(ieee_all, .false.)
    call feti_problem_create(p)
    do body = 1, 2
      call feti_body_add(p, n, number)
      call feti_body_stiffness(p, body, row_ptr, col, val, FETI_LOWER)
      call feti_body_null_space(p, body, none, FETI_EXACT)
    end do
    call feti_body_load(p, 1, load)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [n, n], [1.0_dp, -1.0_dp], [0.5_dp])
    call feti_solve(p)
    call feti_displacement(p, 1, answer(:n))
    call feti_displacement(p, 2, answer(n + 1:2 * n))
    call feti_multipliers(p, FETI_INEQUALITY, answer(2 * n + 1:))
    call feti_problem_destroy(p)
    call ieee_get_flag(ieee_all, raised)
    call require(.not. any(raised), 'the library left floating-point flags')
    call ieee_get_halting_mode(trapped, halts_after)
    call require(all(halts .eqv. halts_after), 'the library changed what traps')
  end subroutine

  !> Numbers that trap as soon as they are computed with are refused in peace.
  subroutine refusals_are_reported
    type(feti_problem) :: p
    integer :: body

    call feti_problem_create(p)
    call feti_body_add(p, 2, body)
    call feti_body_load(p, body, [ieee_value(1.0_dp, ieee_signaling_nan), 1.0_dp], stat=stat, errmsg=text)
    call require(stat == FETI_ARGUMENT - 4, 'a load that is not a number: ' // trim(text))
    call feti_body_load(p, body, [ieee_value(1.0_dp, ieee_positive_inf), 1.0_dp], stat=stat, errmsg=text)
    call require(stat == FETI_ARGUMENT - 4, 'an infinite load: ' // trim(text))
    call feti_solve(p, stat=stat, errmsg=text)
    call require(stat == FETI_STATE, 'a body without stiffness: ' // trim(text))
    call require(all_are_trapped(), 'a refusal changed what traps')
    call feti_problem_destroy(p)
  end subroutine
end program
