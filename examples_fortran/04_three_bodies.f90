!> 04 Three stacked blocks in space: meshes that do not match, two bodies that float.
!>
!> A base of 8-node bricks stands on the ground. On it lies a block of 10-node tetrahedra, and on that a block
!> of 20-node bricks; 100 MPa press on the part x > .4 mm of the top. CalculiX wrote the matrices, without
!> supports: each body comes with its six rigid motions. The supports are equality rows H u = 0 (the base is
!> clamped at its bottom; of the other bodies only the three motions in the plane are held: only contact resists
!> lift and tilt). Rows B u <= 0 join the nodes of one surface with the faces of the other; all gaps
!> are 0. Half of the top would lift off: the example computes how much of each interface stays closed.
program three_bodies
  use case_reader
  use demo
  use feti_contact
  use vtu_picture
  implicit none
  real(dp), parameter :: young = 210000, poisson = 0.3_dp  ! MPa, -: of all bodies
  type(feti_problem) :: problem
  type(feti_info) :: info
  type(contact_case) :: host
  real(dp), allocatable :: u(:), lambda(:), slack(:), force(:)
  integer, allocatable :: state(:)
  real(dp) :: error
  integer :: b

  call read_case(data_folder(), 'three_bodies', host)
  if (size(host%body) /= 3 .or. size(host%node) == 0) call demo_stop('three_bodies is not complete')

  call feti_problem_create(problem)
  call hand_over

  call feti_solve(problem, info)

  allocate (u(host%n), force(host%n), lambda(size(host%c)), slack(size(host%c)), state(size(host%c)))
  do b = 1, 3
    call feti_displacement(problem, b, u(first(b):last(b)))
  end do
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)

  call print_forces
  do b = 1, 3
    call feti_reaction(problem, FETI_INEQUALITY, b, force(first(b):last(b)))
  end do
  call feti_gaps(problem, slack)
  call feti_active(problem, state)
  call picture_case(picture_folder(), 'three_bodies_fortran.vtu', host, young / (2 * (1 + poisson)), u, force, &
    lambda, slack, state)
  call feti_problem_destroy(problem)

  error = max(demo_error(lambda, host%lambda_ref), demo_error(u, host%u_ref))
  deallocate (u, lambda, slack, force, state)
  call demo_line('04_three_bodies', info, error, .true.)

contains

  !> First and last unknown of body b.
  integer function first(b)
    integer, intent(in) :: b

    first = host%body(b)%offset + 1
  end function

  integer function last(b)
    integer, intent(in) :: b

    last = host%body(b)%offset + host%body(b)%n
  end function

  subroutine hand_over
    integer :: b, number

    do b = 1, size(host%body)
      associate (body => host%body(b), k => host%body(b)%k)
        call feti_body_add(problem, body%n, number)
        call feti_body_stiffness(problem, number, k%row_ptr, k%col, k%val, FETI_LOWER)
        call feti_body_null_space(problem, number, body%null_space, FETI_EXACT)
        call feti_body_load(problem, number, host%f(first(b):last(b)))
      end associate
    end do
    call feti_rows_add(problem, FETI_INEQUALITY, host%contact%row_ptr, host%contact%col, host%contact%val, host%c)
    call feti_rows_add(problem, FETI_EQUALITY, host%equality%row_ptr, host%equality%col, host%equality%val, host%h)
  end subroutine

  !> The rows point along z, so their forces add up to the load, on both interfaces.
  subroutine print_forces
    logical :: base(size(lambda)), upward(host%n)
    integer :: row

    ! A row that touches the base belongs to base and middle, otherwise to middle and top.
    do row = 1, size(lambda)
      base(row) = any(host%contact%col(host%contact%row_ptr(row):host%contact%row_ptr(row + 1) - 1) <= last(1))
    end do
    upward = host%dir == 3
    upward(:last(2)) = .false.
    call demo_value('force base on middle', sum(lambda, mask=base), 'N')
    call demo_value('force middle on top', sum(lambda, mask=.not. base), 'N')
    call demo_value('largest nodal contact force', maxval(lambda), 'N')
    call demo_value('lift of the top, largest', max(0.0_dp, maxval(u, mask=upward)), 'mm')
  end subroutine

end program
