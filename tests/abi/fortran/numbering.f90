!> The host's own numbers of the unknowns: loads, rows, displacements and reactions of all bodies at once; connected parts of
!> a body, and what the library knows about it. Everything counts from 1.
!>
!> A spring of stiffness 2 and a floating block of two unknowns joined by 4, a gap of 1 between them, load -6 on the end of
!> the block: lambda = 6, u = -3 and -4, -5.5. The host numbers them 5 and 1, 3.
program numbering
  use case_problem, only: require, spring_and_block
  use feti_contact
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  real(dp), parameter :: by_hand(6) = [-4.0_dp, 7.0_dp, -5.5_dp, 7.0_dp, -3.0_dp, 7.0_dp]
  real(dp), parameter :: forces(6) = [6.0_dp, 7.0_dp, 0.0_dp, 7.0_dp, -6.0_dp, 7.0_dp]

  call numbered
  call tabled
  call without_numbers
  call refused
  call parts_and_facts

contains

  subroutine begin(p)
    type(feti_problem), intent(out) :: p

    call spring_and_block(p, [2.0_dp, 4.0_dp], 0.0_dp, 1.0_dp)
    call feti_rows_clear(p, FETI_INEQUALITY)
  end subroutine

  subroutine numbered
    type(feti_problem) :: p
    real(dp) :: u(6), r(6)

    call begin(p)
    call feti_body_numbering(p, 1, [5])
    call feti_body_numbering(p, 2, [1_int64, 3_int64])
    call feti_body_load(p, [0.0_dp, 1e300_dp, -6.0_dp, 1e300_dp, 0.0_dp])
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [5, 1], [1.0_dp, -1.0_dp], [1.0_dp])
    call feti_solve(p)
    u = 7
    r = 7
    call feti_displacement(p, u)
    call feti_reaction(p, 0, r)
    call require(all(abs(u - by_hand) <= 1e-9_dp), 'numbered: wrong displacements')
    call require(all(abs(r - forces) <= 1e-9_dp), 'numbered: wrong reactions')
    call feti_problem_destroy(p)
  end subroutine

  !> The spring, both unknowns of the block, a driven one at .25, and the sum of the block's first and that, on which the row acts.
  subroutine tabled
    type(feti_problem) :: p
    real(dp) :: u(5), r(5)
    integer :: stat
    character(len=200) :: text

    call begin(p)
    call feti_dof_table(p, [1, 2, 3, 0, 0], [1, 1, 1, 1, 1, 3], [2, 4], [1.0_dp, 1.0_dp], [0.0_dp, 0.0_dp, 0.0_dp, 0.5_dp, 0.0_dp])
    call feti_body_load(p, [0.0_dp, 2.0_dp, -6.0_dp, 9.0_dp, -2.0_dp])
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 5], [1.0_dp, -1.0_dp], [0.75_dp])
    call feti_dof_table(p, int([1, 2, 3, 0, 0], int64), int([1, 1, 1, 1, 1, 3], int64), int([2, 4], int64), [1.0_dp, 1.0_dp], &
      [0.0_dp, 0.0_dp, 0.0_dp, 0.25_dp, 0.0_dp])
    call feti_dof_table(p, [1, 2, 3, 0, 0], [1, 1, 1, 1, 3], [2, 4], [1.0_dp, 1.0_dp], stat=stat, errmsg=text)
    call require(stat == FETI_ARGUMENT - 4, 'pointers for four unknowns')
    call feti_dof_table(p, [1, 2, 3, 0, 0], [1, 1, 1, 1, 1, 4], [2, 4], [1.0_dp, 1.0_dp], stat=stat)
    call require(stat == FETI_ARGUMENT - 4, 'pointers behind the terms')
    call feti_dof_table(p, [1, 2, 3, 0, 0], [1, 1, 1, 1, 1, 3], [2, 4], [1.0_dp, 1.0_dp], [0.0_dp], stat)
    call require(stat == FETI_ARGUMENT - 7, 'one constant')
    call feti_solve(p)
    call feti_displacement(p, u)
    call feti_reaction(p, 0, r)
    call require(all(abs(u - [-3.0_dp, -4.0_dp, -5.5_dp, 0.25_dp, -3.75_dp]) <= 1e-9_dp), 'by the table: wrong displacements')
    call require(all(abs(r - [-6.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 6.0_dp]) <= 1e-9_dp), 'by the table: wrong reactions')
    call feti_problem_destroy(p)
  end subroutine

  subroutine without_numbers
    type(feti_problem) :: p
    real(dp) :: u(3), r(3)

    call begin(p)
    call feti_body_load(p, [0.0_dp, 0.0_dp, -6.0_dp])
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [1.0_dp, -1.0_dp], [1.0_dp])
    call feti_solve(p)
    call feti_displacement(p, u)
    call feti_reaction(p, FETI_INEQUALITY, r)
    call require(all(abs(u - [-3.0_dp, -4.0_dp, -5.5_dp]) <= 1e-9_dp), 'one body after the other: wrong displacements')
    call require(all(abs(r - [-6.0_dp, 6.0_dp, 0.0_dp]) <= 1e-9_dp), 'one body after the other: wrong reactions')
    call feti_problem_destroy(p)
  end subroutine

  !> No number below 1 stands for all bodies, and a number that two bodies have is named.
  subroutine refused
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    real(dp) :: x(6)
    character(200) :: text
    integer :: stat, body

    call begin(p)
    x = 0
    call feti_body_load(p, 0, x(:3), stat)
    call require(stat == FETI_ARGUMENT - 2, 'body 0 stands for all bodies in feti_body_load')
    call feti_displacement(p, 0, x(:3), stat)
    call require(stat == FETI_ARGUMENT - 2, 'body 0 stands for all bodies in feti_displacement')
    call feti_reaction(p, 0, 0, x(:3), stat)
    call require(stat == FETI_ARGUMENT - 3, 'body 0 stands for all bodies in feti_reaction')
    call feti_body_numbering(p, 1, [2])
    call feti_body_load(p, x, stat, text)
    call require(stat == FETI_STATE .and. index(text, 'body 2') > 0, 'a body without numbers: ' // text)
    call feti_body_numbering(p, 2, [1, 2], stat)
    call feti_last_error_detail(detail)
    call require(stat == FETI_ARGUMENT - 4 .and. detail%body == 2 .and. detail%dof == 2 .and. detail%entry == 2, &
      'a number of two bodies')
    call feti_body_numbering(p, 2, [1_int64, 1_int64], stat)
    call require(stat == FETI_ARGUMENT - 4, 'a number of two unknowns')
    call feti_body_numbering(p, 2, [1], stat)
    call require(stat == FETI_ARGUMENT - 3, 'too few numbers')
    call feti_body_numbering(p, 2, [1, 3])
    call feti_body_load(p, x(:2), stat)
    call require(stat == FETI_ARGUMENT - 3, 'loads that end before the largest number')
    call feti_rows_add(p, FETI_EQUALITY, [1, 2], [4], [1.0_dp], stat=stat)
    call require(stat == FETI_ARGUMENT - 6, 'a row on a number that is not there')
    call feti_body_add(p, 1, body)
    call feti_body_load(p, x, stat)
    call require(stat == FETI_STATE, 'a further body without numbers')
    call feti_problem_destroy(p)
  end subroutine

  !> Unknowns 1 and 3 joined, 2 on the ground.
  subroutine parts_and_facts
    type(feti_problem) :: p
    type(feti_body_facts) :: facts
    integer :: body, part(3), stat

    call begin(p)
    call feti_body_add(p, 3, body)
    part = 7
    call feti_body_components(p, body, part, stat)
    call require(stat == FETI_STATE .and. all(part == 7), 'parts of a body without a matrix')
    call feti_body_info(p, body, facts)
    call require(facts%unknowns == 3 .and. facts%entries == -1 .and. facts%null_space == -1 .and. facts%shared_with == 0, &
      'facts of a body without a matrix')
    call feti_body_stiffness(p, body, [1, 2, 3, 5], [1, 2, 1, 3], [1.0_dp, 2.0_dp, -1.0_dp, 1.0_dp], FETI_LOWER)
    call feti_body_components(p, body, part)
    call require(all(part == [1, 2, 1]), 'wrong parts')
    call feti_setup(p)
    call feti_body_info(p, body, facts)
    call require(facts%entries == 4 .and. facts%components == 2 .and. facts%null_space == 1 .and. facts%borrowed == 0 .and. &
      facts%origin == FETI_ORIGIN_FOUND .and. facts%factor_entries > 0, 'wrong facts')
    call feti_body_info(p, 4, facts, stat)
    call require(stat == FETI_ARGUMENT - 2, 'facts of a body that is not there')
    call feti_body_components(p, body, part(:2), stat)
    call require(stat == FETI_ARGUMENT - 3, 'parts of too few unknowns')
    call feti_problem_destroy(p)
  end subroutine

end program
