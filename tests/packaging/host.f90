!> A host in Fortran: the problem of host.c, the same lines of output. Without stat a refused call ends the program.
program host
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  type(feti_problem) :: problem
  type(feti_info) :: info
  integer :: spring, block
  real(dp) :: u1(1), u(2), force(1)

  call feti_problem_create(problem)
  call feti_body_add(problem, 1, spring)
  call feti_body_add(problem, 2, block)
  call feti_body_stiffness(problem, spring, [1, 2], [1], [1000.0_dp], FETI_LOWER)
  call feti_body_stiffness(problem, block, [1, 2, 4], [1, 1, 2], [4000.0_dp, -4000.0_dp, 4000.0_dp], FETI_LOWER)
  call feti_body_load(problem, block, [0.0_dp, -100.0_dp])
  call feti_rows_add(problem, FETI_INEQUALITY, [1, 3], [spring, block], [1, 1], [1.0_dp, -1.0_dp], [0.5_dp])
  call feti_solve(problem, info)
  call feti_displacement(problem, spring, u1)
  call feti_displacement(problem, block, u)
  call feti_multipliers(problem, FETI_INEQUALITY, force)
  call feti_problem_destroy(problem)
  print '(a,f12.6)', 'force', force
  print '(a,3f12.6)', 'u', u1, u
end program
