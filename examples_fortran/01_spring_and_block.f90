!> 01 Spring and block: the smallest contact problem, and the fifteen calls of a complete program.
!>
!>     wall |--/\/\/\--o u1      gap c      u2 [ block ] u3  <--- F
!>            spring k                        stiffness s
!>
!> The wall holds the spring. The block floats: only the contact holds it. A force F pushes the block
!> to the left, across the open gap, against the spring. By hand:
!>
!>     contact force  lambda = F                the block is in balance
!>     spring end     u1 = -F/k
!>     block, front   u2 = u1 - c               the gap is closed
!>     block, rear    u3 = u2 - F/s             the block itself is compressed
!>
!> Units: N and mm. Everything counts from 1, as in Fortran.
program spring_and_block
  use demo
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  real(dp), parameter :: k = 1000, s = 4000, c = 0.5_dp, force = 100  ! N/mm, N/mm, mm, N
  type(feti_problem) :: problem
  type(feti_info) :: info
  integer :: spring, block
  real(dp) :: shift(2, 1), spring_u(1), block_u(2), lambda(1), u(3), by_hand(3)

  ! 1. A problem. Every call takes it first. Every call may end with stat and errmsg, as allocate does;
  !    these examples leave them out: should a call fail, the program stops with the library's text.
  call feti_problem_create(problem)

  ! 2. Settings have names. This one says how exactly the contact forces are computed.
  call feti_set(problem, 'tolerance', 1e-10_dp)

  ! 3. Two bodies with 1 and 2 unknowns; the library numbers them 1 and 2.
  call feti_body_add(problem, 1, spring)
  call feti_body_add(problem, 2, block)

  ! 4. Their stiffness matrices, by rows. Row i holds the entries row_ptr(i) to row_ptr(i+1)-1.
  !    Of a symmetric matrix the lower triangle is enough: FETI_LOWER.
  !
  !        K_spring = [ k ]        K_block = [  s  .  ]
  !                                          [ -s  s  ]
  call feti_body_stiffness(problem, spring, [1, 2], [1], [k], FETI_LOWER)
  call feti_body_stiffness(problem, block, [1, 2, 4], [1, 1, 2], [s, -s, s], FETI_LOWER)

  ! 5. The motions that cost no energy: K R = 0. None for the spring, which the wall holds;
  !    the block moves as a whole, R = (1, 1)'. FETI_EXACT: this is the whole null space.
  shift(:, 1) = 1
  call feti_body_no_null_space(problem, spring)
  call feti_body_null_space(problem, block, shift, FETI_EXACT)

  ! 6. The load: F to the left on the rear of the block. A body without a call has no load.
  call feti_body_load(problem, block, [0.0_dp, -force])

  ! 7. The contact row: the spring end must stay to the left of the block,
  !
  !        u1 - u2 <= c
  !
  !    Each entry names a body, an unknown of that body, and its coefficient.
  call feti_rows_add(problem, FETI_INEQUALITY, [1, 3], [spring, block], [1, 1], [1.0_dp, -1.0_dp], [c])

  ! 8. Solve. info tells what was done and how well the answer satisfies the conditions of contact.
  call feti_solve(problem, info)

  ! 9. The answer: displacements per body, one contact force per row.
  call feti_displacement(problem, spring, spring_u)
  call feti_displacement(problem, block, block_u)
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)

  ! 10. Give everything back.
  call feti_problem_destroy(problem)

  call demo_value('contact force', lambda(1), 'N')
  call demo_value('spring end u1', spring_u(1), 'mm')
  call demo_value('block front u2', block_u(1), 'mm')
  call demo_value('block rear u3', block_u(2), 'mm')

  u = [spring_u, block_u]
  by_hand = [-force / k, -force / k - c, -force / k - c - force / s]
  call demo_line('01_spring_and_block', info, max(demo_error(lambda, [force]), demo_error(u, by_hand)), .true.)
end program
