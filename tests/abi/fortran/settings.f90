!> What is set is what is read, of every type; unknowns to fix are those that were chosen; the version is the header's.
program settings
  use case_problem, only: require
  use feti_contact
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0)

  call options_are_read_as_they_were_set
  call chosen_unknowns_are_fixed
  call require(feti_version_number() == 10000 * FETI_CONTACT_VERSION_MAJOR + 100 * FETI_CONTACT_VERSION_MINOR &
    + FETI_CONTACT_VERSION_PATCH, 'the version is another one')

contains

  subroutine options_are_read_as_they_were_set
    type(feti_problem) :: p
    character(len=:), allocatable :: word, level
    real(dp) :: gamma
    integer :: threads
    integer(int64) :: limit

    call feti_problem_create(p)
    call feti_set(p, 'gamma', 2.5_dp)
    call feti_set(p, 'steps', 2)
    call feti_set(p, 'threads', 3)
    call feti_set(p, 'memory_limit', 8000000000_int64)
    call feti_set(p, 'start', 'previous')
    call feti_get(p, 'gamma', gamma)
    call feti_get(p, 'threads', threads)
    call feti_get(p, 'memory_limit', limit)
    call feti_get(p, 'start', word)
    call feti_set(p, 'log_level', 'step')
    call feti_get(p, 'log_level', level)
    call require(level == 'step', 'a text is read otherwise: ' // level)
    call require(abs(gamma - 2.5_dp) <= 0.0_dp .and. threads == 3 .and. limit == 8000000000_int64, 'a number is read otherwise')
    call require(word == 'previous' .and. len(word) == 8, 'a text is read otherwise: ' // word)
    call feti_problem_destroy(p)
  end subroutine

  !> Two unknowns joined by a spring: either may be held in K+.
  subroutine chosen_unknowns_are_fixed
    type(feti_problem) :: p
    integer :: body, k, fixed(1)
    real(dp) :: x(2, 1), y(2, 1)

    call feti_problem_create(p)
    call feti_body_add(p, 2, body)
    call feti_body_stiffness(p, body, reshape([4.0_dp, -4.0_dp, -4.0_dp, 4.0_dp], [2, 2]), FETI_FULL)
    call feti_body_null_space(p, body, reshape([1.0_dp, 1.0_dp], [2, 1]), FETI_EXACT)
    do k = 1, 2
      call feti_body_fixing_set(p, body, [k])
      call feti_body_fixing(p, body, fixed)
      call require(fixed(1) == k, 'another unknown is held')
      x(:, 1) = [-8.0_dp, 8.0_dp]
      call feti_body_kplus(p, body, x, y)
      call require(abs(y(2, 1) - y(1, 1) - 2.0_dp) <= 1e-14_dp, 'K+ is wrong')
    end do
    call feti_problem_destroy(p)
  end subroutine
end program
