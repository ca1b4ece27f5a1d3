!> Compliant rows by hand to 1e-10: a spring between bodies, a bed of springs under a rigid punch (a linear law of
!> pressure and overclosure), an elastic support; rigid again they give the answer of rigid rows.
program compliance
  use case_problem, only: require, spring_and_block
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  real(dp), parameter :: close = 1e-10_dp

  call a_spring_between_spring_and_block
  call a_rigid_punch_on_a_bed_of_springs
  call an_elastic_support

contains

  !> 1000 N/mm at a wall, a block of 4000 N/mm pushed by 100 N across the gap 0.5: the block sinks in by 100/k.
  subroutine a_spring_between_spring_and_block
    type(feti_problem) :: p
    real(dp), parameter :: inv_k(4) = [0.0_dp, 1.0_dp, 1e-3_dp, 0.0_dp]
    real(dp) :: u(2), lambda(1), gap(1), image(1), rigid
    integer :: i

    call spring_and_block(p, [1000.0_dp, 4000.0_dp], -100.0_dp, 0.5_dp)
    do i = 1, size(inv_k)
      call feti_rows_compliance(p, FETI_INEQUALITY, 1, inv_k(i:i))
      call feti_solve(p)
      call feti_displacement(p, 2, u)
      call feti_multipliers(p, FETI_INEQUALITY, lambda)
      call feti_gaps(p, gap)
      call feti_dual_apply(p, [1.0_dp], image)
      if (i == 1) rigid = image(1)
      call require(abs(lambda(1) - 100) <= 100 * close, 'wrong contact force')
      call require(maxval(abs(u + 100 * inv_k(i) - [-0.6_dp, -0.625_dp])) <= close * (1 + 100 * inv_k(i)), 'wrong displacement')
      call require(abs(gap(1)) <= close * (1 + 100 * inv_k(i)), 'a gap is left')
      call require(abs(image(1) - rigid - inv_k(i)) <= close, 'F does not contain the compliance')
    end do
    call feti_problem_destroy(p)
  end subroutine

  !> One rigid unknown over springs k that begin at c: lambda = k max(0, u - c).
  subroutine a_rigid_punch_on_a_bed_of_springs
    type(feti_problem) :: p
    real(dp), parameter :: k(4) = [2.0_dp, 3.0_dp, 10.0_dp, 1.0_dp], c(4) = [0.0_dp, 0.5_dp, 1.25_dp, 4.0_dp]
    real(dp), parameter :: depth(5) = [0.1_dp, 0.5_dp, 0.75_dp, 2.0_dp, 7.0_dp]
    real(dp) :: u(1), lambda(4), pressure(4)
    integer :: body, i

    call feti_problem_create(p)
    call feti_body_add(p, 1, body)
    call feti_body_stiffness(p, 1, reshape([0.0_dp], [1, 1]), FETI_FULL)
    call feti_body_null_space(p, 1, reshape([1.0_dp], [1, 1]), FETI_EXACT)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 2, 3, 4, 5], [1, 1, 1, 1], [1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp], c)
    call feti_rows_compliance(p, FETI_INEQUALITY, 1, 1 / k(:2))
    call feti_rows_compliance(p, FETI_INEQUALITY, 3, 1 / k(3:))
    do i = 1, size(depth)
      pressure = k * max(0.0_dp, depth(i) - c)
      call feti_body_load(p, 1, [sum(pressure)])
      call feti_solve(p)
      call feti_displacement(p, 1, u)
      call feti_multipliers(p, FETI_INEQUALITY, lambda)
      call require(abs(u(1) - depth(i)) <= close * depth(i), 'wrong depth')
      call require(maxval(abs(lambda - pressure)) <= close * maxval(pressure), 'wrong pressure')
    end do
    call feti_problem_destroy(p)
  end subroutine

  !> Stiffness 2 under a load 3, the row 2 u - h = mu/4: mu = (3 - h) / 2.25, pulling and pushing.
  subroutine an_elastic_support
    type(feti_problem) :: p
    real(dp), parameter :: h(3) = [-1.0_dp, 3.0_dp, 7.0_dp]
    real(dp) :: held(1, 0), u(1), mu(1)
    integer :: body, i

    call feti_problem_create(p)
    call feti_body_add(p, 1, body)
    call feti_body_stiffness(p, 1, reshape([2.0_dp], [1, 1]), FETI_FULL)
    call feti_body_null_space(p, 1, held, FETI_EXACT)
    call feti_body_load(p, 1, [3.0_dp])
    call feti_rows_add(p, FETI_EQUALITY, [1, 2], [1], [2.0_dp])
    call feti_rows_compliance(p, FETI_EQUALITY, 1, [0.25_dp])
    do i = 1, size(h)
      call feti_rows_rhs(p, FETI_EQUALITY, 1, h(i:i))
      call feti_solve(p)
      call feti_displacement(p, 1, u)
      call feti_multipliers(p, FETI_EQUALITY, mu)
      call require(abs(mu(1) - (3 - h(i)) / 2.25_dp) <= close, 'wrong force of the support')
      call require(abs(u(1) - (3 - 2 * mu(1)) / 2) <= close, 'wrong displacement of the support')
    end do
    call feti_problem_destroy(p)
  end subroutine

end program
