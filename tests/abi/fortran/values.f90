!> New values on the pattern given last, by rows in 4 and 8 byte integers, sorted or not, and dense: the answer by hand at
!> the price of one factorisation.
!>
!> A bar of three unknowns, springs s(1) from the ground to the first, s(2) and s(3) between them, pulled by 1 at its end.
program values
  use case_problem, only: require
  use feti_contact
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0), n = 3
  real(dp), parameter :: first(n) = [1.0_dp, 2.0_dp, 4.0_dp], second(n) = [3.0_dp, 1.0_dp, 2.0_dp]
  integer, parameter :: ptr(4) = [1, 2, 4, 6], col(5) = [1, 1, 2, 2, 3], row(5) = [1, 2, 2, 3, 3]
  integer, parameter :: turned_col(5) = [1, 2, 1, 3, 2]
  integer, parameter :: full_ptr(4) = [1, 3, 6, 8], full_col(7) = [2, 1, 3, 2, 1, 3, 2], full_row(7) = [1, 1, 2, 2, 2, 3, 3]

  call by_rows
  call split
  call profile
  call triplets
  call dense
  call borrowed
  call refused

contains

  subroutine begin(p)
    type(feti_problem), intent(out) :: p
    real(dp) :: held(n, 0)
    integer :: body

    call feti_problem_create(p)
    call feti_body_add(p, n, body)
    call feti_body_null_space(p, body, held, FETI_EXACT)
    call feti_body_load(p, body, [0.0_dp, 0.0_dp, 1.0_dp])
  end subroutine

  pure function bar(s) result(k)
    real(dp), intent(in) :: s(n)
    real(dp) :: k(n, n)

    k = reshape([s(1) + s(2), -s(2), 0.0_dp, -s(2), s(2) + s(3), -s(3), 0.0_dp, -s(3), s(3)], [n, n])
  end function

  pure function entries(s, row, col) result(val)
    real(dp), intent(in) :: s(n)
    integer, intent(in) :: row(:), col(:)
    real(dp) :: val(size(row)), k(n, n)
    integer :: e

    k = bar(s)
    do e = 1, size(row)
      val(e) = k(row(e), col(e))
    end do
  end function

  !> Solves; it costs so many analyses and factorisations, and u = 1/s(1), 1/s(1) + 1/s(2), ...
  subroutine check_step(p, s, before, wanted, what)
    type(feti_problem), intent(in) :: p
    real(dp), intent(in) :: s(n)
    integer(int64), intent(inout) :: before(2)
    integer, intent(in) :: wanted(2)
    character(*), intent(in) :: what
    type(feti_info) :: info
    real(dp) :: u(n)

    call feti_solve(p, info)
    call feti_displacement(p, 1, u)
    call require(all(abs(u - [1 / s(1), 1 / s(1) + 1 / s(2), 1 / s(1) + 1 / s(2) + 1 / s(3)]) <= 1e-12_dp), what // ': wrong u')
    call require(.not. any([info%analyses, info%factorisations] - before /= wanted), what // ': not what it should cost')
    before = [info%analyses, info%factorisations]
  end subroutine

  subroutine by_rows
    type(feti_problem) :: p
    integer(int64) :: before(2)
    integer :: form
    real(dp) :: spread_val(9)

    do form = 1, 4
      before = 0
      call begin(p)
      select case (form)
      case (1)
        call feti_body_stiffness(p, 1, ptr, col, entries(first, row, col), FETI_LOWER)
      case (2)
        call feti_body_stiffness(p, 1, int(ptr, int64), int(col, int64), entries(first, row, col), FETI_LOWER)
      case (3)
        call feti_body_stiffness(p, 1, ptr, turned_col, entries(first, row, turned_col), FETI_LOWER)
      case (4)
        call feti_body_stiffness(p, 1, full_ptr, full_col, entries(first, full_row, full_col), FETI_FULL)
      end select
      call check_step(p, first, before, [1, 1], 'first values')
      select case (form)
      case (1)
        spread_val(1:9:2) = entries(second, row, col)
        call feti_body_values(p, 1, spread_val(1:9:2))
      case (2)
        call feti_body_values(p, 1, entries(second, row, col))
      case (3)
        call feti_body_values(p, 1, entries(second, row, turned_col))
      case (4)
        call feti_body_values(p, 1, entries(second, full_row, full_col))
      end select
      call check_step(p, second, before, [0, 1], 'second values')
      call feti_problem_destroy(p)
    end do
  end subroutine

  !> The diagonal in an array of its own.
  subroutine split
    type(feti_problem) :: p
    integer(int64) :: before(2)
    integer :: wide, stat
    real(dp) :: k(n, n), diag(n)
    integer, parameter :: ptr(4) = [1, 2, 3, 3], col(2) = [2, 3], row(2) = [1, 2]

    do wide = 0, 1
      before = 0
      call begin(p)
      if (wide == 0) then
        call feti_body_stiffness_split(p, 1, [3.0_dp, 6.0_dp, 4.0_dp], ptr, col, entries(first, row, col), FETI_UPPER)
      else
        call feti_body_stiffness_split(p, 1, [3.0_dp, 6.0_dp, 4.0_dp], int(ptr, int64), int(col, int64), &
          entries(first, row, col), FETI_UPPER)
      end if
      call check_step(p, first, before, [1, 1], 'first values beside a diagonal')
      k = bar(second)
      diag = [k(1, 1), k(2, 2), k(3, 3)]
      call feti_body_values_split(p, 1, diag, entries(second, row, col))
      call check_step(p, second, before, [0, 1], 'second values beside a diagonal')
      call feti_body_values(p, 1, [1.0_dp, 1.0_dp], stat)
      call require(stat == FETI_STATE, 'values without the diagonal')
      call feti_body_values_split(p, 1, diag(:2), entries(second, row, col), stat)
      call require(stat == FETI_ARGUMENT - 3, 'a diagonal too short')
      call feti_body_values_split(p, 1, diag, diag, stat)
      call require(stat == FETI_ARGUMENT - 5, 'too many values beside the diagonal')
      call feti_body_stiffness_split(p, 1, diag(:2), ptr, col, entries(second, row, col), FETI_UPPER, stat)
      call require(stat == FETI_ARGUMENT - 5, 'a diagonal that does not fit the rows')
      call feti_body_stiffness_split(p, 1, diag, ptr, col, diag(:1), FETI_UPPER, stat)
      call require(stat == FETI_ARGUMENT - 6, 'fewer values than the rows say')
      call feti_body_stiffness_split(p, 1, diag, ptr, [2, 2], entries(second, row, col), FETI_UPPER, stat)
      call require(stat == FETI_ARGUMENT - 6, 'an entry on the diagonal')
      call check_step(p, second, before, [0, 0], 'after refused calls')
      call feti_problem_destroy(p)
    end do
  end subroutine

  !> The columns of the upper triangle, from the diagonal upwards, and downwards beside a diagonal of its own.
  subroutine profile
    type(feti_problem) :: p
    integer(int64) :: before(2)
    integer :: wide, stat
    integer, parameter :: maxa(4) = [1, 2, 4, 6], row(5) = [1, 2, 1, 3, 2], col(5) = [1, 2, 2, 3, 3]
    integer, parameter :: beside(4) = [1, 1, 2, 3]

    do wide = 0, 1
      before = 0
      call begin(p)
      if (wide == 0) then
        call feti_body_stiffness_skyline(p, 1, maxa, entries(first, row, col), FETI_SKYLINE_UP)
      else
        call feti_body_stiffness_skyline(p, 1, int(maxa, int64), entries(first, row, col), FETI_SKYLINE_UP)
      end if
      call check_step(p, first, before, [1, 1], 'a profile')
      call feti_body_values(p, 1, entries(second, row, col))
      call check_step(p, second, before, [0, 1], 'new values of a profile')
      call feti_body_stiffness_skyline(p, 1, beside, entries(first, [1, 2], [2, 3]), FETI_SKYLINE_DOWN, &
        entries(first, [1, 2, 3], [1, 2, 3]))
      call check_step(p, first, before, [0, 1], 'a profile beside a diagonal')
      call feti_body_values_split(p, 1, entries(second, [1, 2, 3], [1, 2, 3]), entries(second, [1, 2], [2, 3]))
      call check_step(p, second, before, [0, 1], 'new values beside a diagonal')
      call feti_body_stiffness_skyline(p, 1, maxa, entries(first, row(:4), col(:4)), FETI_SKYLINE_UP, stat=stat)
      call require(stat == FETI_ARGUMENT - 5, 'fewer values than the profile says')
      call feti_body_stiffness_skyline(p, 1, maxa(:0), entries(first, row, col), FETI_SKYLINE_UP, stat=stat)
      call require(stat == FETI_ARGUMENT - 5, 'a profile without columns')
      call feti_body_stiffness_skyline(p, 1, beside, entries(first, [1, 2], [2, 3]), FETI_SKYLINE_UP, [1.0_dp], stat)
      call require(stat == FETI_ARGUMENT - 4, 'a diagonal too short')
      call check_step(p, second, before, [0, 0], 'after refused profiles')
      call feti_problem_destroy(p)
    end do
  end subroutine

  !> Two of the triplets stand at one place.
  subroutine triplets
    type(feti_problem) :: p
    integer(int64) :: before(2)
    integer :: wide, stat
    integer, parameter :: row(6) = [3, 2, 1, 3, 2, 2], col(6) = [2, 2, 1, 3, 1, 2]
    real(dp), parameter :: part(6) = [1.0_dp, 0.5_dp, 1.0_dp, 1.0_dp, 1.0_dp, 0.5_dp]

    do wide = 0, 1
      before = 0
      call begin(p)
      if (wide == 0) then
        call feti_body_stiffness_triplets(p, 1, n, row, col, part * entries(first, row, col), FETI_LOWER)
      else
        call feti_body_stiffness_triplets(p, 1, n, int(row, int64), int(col, int64), part * entries(first, row, col), &
          FETI_LOWER)
      end if
      call check_step(p, first, before, [1, 1], 'triplets')
      call feti_body_values(p, 1, part * entries(second, row, col))
      call check_step(p, second, before, [0, 1], 'new values of triplets')
      call feti_body_stiffness_triplets(p, 1, n, row, col(:5), part * entries(first, row, col), FETI_LOWER, stat)
      call require(stat == FETI_ARGUMENT - 6, 'fewer columns than rows')
      call feti_body_stiffness_triplets(p, 1, n, row, col, first, FETI_LOWER, stat)
      call require(stat == FETI_ARGUMENT - 7, 'fewer values than rows')
      call feti_body_stiffness_triplets(p, 1, n, row, col, part * entries(first, row, col), FETI_UPPER, stat)
      call require(stat == FETI_ARGUMENT - 6, 'triplets of the other triangle')
      call check_step(p, second, before, [0, 0], 'after refused triplets')
      call feti_problem_destroy(p)
    end do
  end subroutine

  subroutine dense
    type(feti_problem) :: p
    integer(int64) :: before(2)

    before = 0
    call begin(p)
    call feti_body_stiffness(p, 1, bar(first), FETI_UPPER)
    call check_step(p, first, before, [1, 1], 'first dense matrix')
    call feti_body_values(p, 1, bar(second))
    call check_step(p, second, before, [0, 1], 'second dense matrix')
    call feti_problem_destroy(p)
  end subroutine

  !> Values that stay with the host, in an array that the pointer has allocated: rewritten, refused, replaced.
  subroutine borrowed
    type(feti_problem) :: p
    type(feti_body_facts) :: facts
    character(200) :: text
    real(dp), pointer, contiguous :: val(:), other(:), nothing(:)
    integer(int64) :: before(2)
    integer :: stat, wide

    nothing => null()
    do wide = 0, 1
      before = 0
      allocate (val(5), other(5))
      call begin(p)
      val = entries(first, row, col)
      if (wide == 0) then
        call feti_body_stiffness_borrow(p, 1, ptr, col, val, FETI_LOWER)
      else
        call feti_body_stiffness_borrow(p, 1, int(ptr, int64), int(col, int64), val, FETI_LOWER)
      end if
      call feti_body_info(p, 1, facts)
      call require(facts%borrowed == 1, 'the values are copied')
      call check_step(p, first, before, [1, 1], 'borrowed values')
      val = entries(second, row, col)
      call feti_body_values_borrow(p, 1, val)
      call check_step(p, second, before, [0, 1], 'values rewritten in place')
      call feti_body_values(p, 1, entries(first, row, col), stat, text)
      call require(stat == FETI_STATE .and. index(text, 'feti_body_values_borrow') > 0, 'values of a copy: ' // text)
      other = entries(first, row, col)
      call feti_body_values_borrow(p, 1, other)
      deallocate (val)
      call check_step(p, first, before, [0, 1], 'values in another array')
      call feti_body_values_borrow(p, 1, nothing, stat)
      call require(stat == FETI_ARGUMENT - 4, 'values of a pointer that leads nowhere')
      call feti_body_stiffness_borrow(p, 1, ptr, col, nothing, FETI_LOWER, stat)
      call require(stat == FETI_ARGUMENT - 6, 'a matrix whose values lead nowhere')
      call feti_body_stiffness_borrow(p, 1, ptr + 1, col, other, FETI_LOWER, stat)
      call require(stat == FETI_ARGUMENT - 5, 'a matrix with too few values')
      call check_step(p, first, before, [0, 0], 'after refused calls')
      call feti_problem_destroy(p)
      deallocate (other)
    end do
  end subroutine

  !> Refused values cost nothing and change nothing; the text counts from 1.
  subroutine refused
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    character(200) :: text
    integer(int64) :: before(2)
    integer :: stat
    real(dp) :: k(n, n), val(5)

    before = 0
    k = bar(second)
    call begin(p)
    call feti_body_values(p, 1, [1.0_dp], stat, text)
    call require(stat == FETI_STATE .and. index(text, 'feti_body_stiffness') > 0, 'values without a matrix: ' // text)
    call feti_body_stiffness(p, 1, ptr, col, entries(first, row, col), FETI_LOWER)
    call check_step(p, first, before, [1, 1], 'before')
    call feti_body_values(p, 1, bar(second), stat, text)
    call require(stat == FETI_STATE .and. index(text, 'feti_body_values') > 0, 'values in another form: ' // text)
    call feti_body_values(p, 2, [1.0_dp], stat)
    call require(stat == FETI_ARGUMENT - 2, 'a body that is not there')
    call feti_body_values(p, 1, [1.0_dp], stat)
    call require(stat == FETI_ARGUMENT - 3, 'too few values')
    call feti_body_values(p, 1, k(:, 1:2), stat)
    call require(stat == FETI_ARGUMENT - 4, 'a matrix that is not square')
    val = entries(second, row, col)
    val(2) = ieee_value(1.0_dp, ieee_quiet_nan)
    call feti_body_values(p, 1, val, stat)
    call feti_last_error_detail(detail)
    call require(stat == FETI_ARGUMENT - 4 .and. detail%row == 2 .and. detail%entry == 2, 'a value that is not finite')
    call check_step(p, first, before, [0, 0], 'after refused values')
    call feti_problem_destroy(p)
  end subroutine

end program
