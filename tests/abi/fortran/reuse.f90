!> Nothing is computed twice: what a change of the problem costs, by the counters of feti_info.
!>
!> Eight bars of nine unknowns, springs of stiffness 1 from the ground to the first and from each to the next, pushed
!> towards an obstacle at 1 in front of every unknown but the last.
program reuse
  use, intrinsic :: iso_fortran_env, only: int64
  use case_problem, only: require
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0), bars = 8, nodes = 9, first_rows = nodes - 1

  type(feti_problem) :: p
  integer(int64) :: before(4) = 0
  integer :: b, body

  call feti_problem_create(p)
  do b = 1, bars
    call feti_body_add(p, nodes, body)
    call give_stiffness(b, 1.0_dp)
    call give_load(b, 0.5_dp)
  end do
  call give_rows(1, first_rows)
  ! the last but one stands at the obstacle, the last goes on by 0.5 / 1
  call check_step([1, 1, bars * first_rows, 0], 1.5_dp, 'eight equal bars')

  do b = 1, bars
    call give_load(b, 0.75_dp)
  end do
  call check_step([0, 0, 0, 0], 1.75_dp, 'new loads')

  do b = 1, bars
    call give_stiffness(b, 1 + (b - 1) / 16.0_dp)
    call give_load(b, 0.75_dp * (1 + (b - 1) / 16.0_dp))
  end do
  call check_step([0, bars - 1, (bars - 1) * first_rows, first_rows], 1.75_dp, 'new values')

  call give_rows(nodes, nodes)
  call check_step([0, 0, bars * nodes, 0], 1.0_dp, 'new rows')

  call feti_rows_clear(p, FETI_INEQUALITY)
  call give_rows(1, nodes)
  call check_step([0, 0, 0, bars * nodes], 1.0_dp, 'the same rows again')
  call feti_problem_destroy(p)

contains

  subroutine give_stiffness(body, stiffness)
    integer, intent(in) :: body
    real(dp), intent(in) :: stiffness
    real(dp) :: k(nodes, nodes)
    integer :: i

    k = 0
    do i = 1, nodes
      k(i, i) = merge(2, 1, i < nodes) * stiffness
    end do
    do i = 2, nodes
      k(i, i - 1) = -stiffness
      k(i - 1, i) = -stiffness
    end do
    call feti_body_stiffness(p, body, k, FETI_FULL)
  end subroutine

  subroutine give_load(body, load)
    integer, intent(in) :: body
    real(dp), intent(in) :: load
    real(dp) :: f(nodes)

    f = 0
    f(nodes) = load
    call feti_body_load(p, body, f)
  end subroutine

  !> u <= 1 for unknowns first to last of every bar.
  subroutine give_rows(first, last)
    integer, intent(in) :: first, last
    integer :: i, j, m

    m = bars * (last - first + 1)
    call feti_rows_add(p, FETI_INEQUALITY, [(i, i = 1, m + 1)], [((j, i = first, last), j = 1, bars)], &
      [((i, i = first, last), j = 1, bars)], [(1.0_dp, i = 1, m)], [(1.0_dp, i = 1, m)])
  end subroutine

  !> Solves; it costs these analyses, factorisations, columns computed and kept, and every bar ends where it does by hand.
  subroutine check_step(wanted, by_hand, what)
    integer, intent(in) :: wanted(4)
    real(dp), intent(in) :: by_hand
    character(*), intent(in) :: what
    type(feti_info) :: info
    integer(int64) :: all(4)
    real(dp) :: u(nodes)
    integer :: b

    call feti_solve(p, info)
    all = [info%analyses, info%factorisations, info%columns_computed, info%columns_kept]
    call require(.not. any(all - before /= wanted), what // ': not what it should cost')
    before = all
    do b = 1, bars
      call feti_displacement(p, b, u)
      call require(abs(u(nodes) - by_hand) <= 1e-7_dp, what // ': a bar does not end where it should')
    end do
  end subroutine

end program
