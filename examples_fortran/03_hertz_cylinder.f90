!> 03 A cylinder on a block: matrices of a finite element code, the answer compared with Hertz.
!>
!> A punch crowned like a cylinder of radius R = 10 mm is pressed on a block with P = 2265.6 N per mm of
!> thickness, plane strain, E = 210000 MPa and nu = .3 for both. CalculiX wrote the stiffness matrices.
!> The meshes do not match: a contact row joins one node of the punch with the two nodes of the block
!> next to it,
!>
!>     (weights . u_y of the block) - u_y of the punch <= gap      (mm)
!>
!> Both matrices come without supports, each body with its three rigid motions as null space. The
!> supports (block: bottom; punch: sideways on its axis) are equality rows H u = 0.
!>
!> Hertz:  E* = E / (2 (1 - nu^2)),  half width b = sqrt(4 P R / (pi E*)),  peak p0 = 2 P / (pi b),
!>         p(x) = p0 sqrt(1 - x^2/b^2).
module hertz_steps
  use case_reader, only: dp
  use feti_contact, only: feti_progress, FETI_PHASE_SOLVE
  implicit none

  !> The steps of the solve, and the residual after each step relative to the limit that ends the solve.
  type :: steps_taken
    integer :: steps = 0
    real(dp) :: residual(1000) = 0
  end type

contains

  !> The library calls it at every step; 0: the solve continues.
  integer function note(now, data)
    type(feti_progress), intent(in) :: now
    class(*), intent(inout) :: data

    note = 0
    select type (data)
    type is (steps_taken)
      if (now%phase /= FETI_PHASE_SOLVE .or. data%steps == size(data%residual)) return
      data%steps = data%steps + 1
      data%residual(data%steps) = now%residual
    end select
  end function

end module

program hertz_cylinder
  use case_reader
  use demo
  use feti_contact
  use hertz_steps
  use picture
  use vtu_picture
  implicit none
  real(dp), parameter :: pi = acos(-1.0_dp)
  real(dp), parameter :: radius = 10, young = 210000, poisson = 0.3_dp  ! mm, MPa, -
  type(feti_problem) :: problem
  type(feti_info) :: info
  type(contact_case) :: host
  type(steps_taken), target :: taken
  real(dp), allocatable :: u(:), lambda(:), slack(:), force(:)
  integer, allocatable :: state(:)
  real(dp) :: error
  logical :: agrees
  integer :: b

  call read_case(data_folder(), 'hertz_cylinder', host)
  if (size(host%body) /= 2 .or. size(host%node) == 0) call demo_stop('hertz_cylinder is not complete')

  call feti_problem_create(problem)
  call hand_over

  ! The library calls note at every step. A function of the host is a procedure of a module, not of a program.
  call feti_on_progress(problem, note, taken)
  call feti_solve(problem, info)
  call feti_on_progress(problem)
  call draw_convergence

  ! Sections of an array may be handed over as they are: u holds the bodies one after the other.
  allocate (u(host%n), force(host%n), lambda(size(host%c)), slack(size(host%c)), state(size(host%c)))
  do b = 1, 2
    call feti_displacement(problem, b, u(first(b):last(b)))
  end do
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)
  call feti_active(problem, state)

  call compare(agrees)

  ! feti_reaction: what the rows of one kind do to a body, here -B'lambda. (N)
  do b = 1, 2
    call feti_reaction(problem, FETI_INEQUALITY, b, force(first(b):last(b)))
  end do
  call feti_gaps(problem, slack)  ! open gaps (mm)
  call picture_case(picture_folder(), 'hertz_cylinder_fortran.vtu', host, young / (2 * (1 + poisson)), u, force, &
    lambda, slack, state)
  call feti_problem_destroy(problem)

  error = max(demo_error(lambda, host%lambda_ref), demo_error(u, host%u_ref))
  deallocate (u, lambda, slack, force, state)
  call demo_line('03_hertz_cylinder', info, error, agrees)

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

  !> Bodies are numbered as the case numbers them, because they are added in turn.
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
    ! B and H count the unknowns through all bodies: no array of bodies.
    call feti_rows_add(problem, FETI_INEQUALITY, host%contact%row_ptr, host%contact%col, host%contact%val, host%c)
    call feti_rows_add(problem, FETI_EQUALITY, host%equality%row_ptr, host%equality%col, host%equality%val, host%h)
  end subroutine

  !> Prints the comparison with Hertz and draws it. agrees: width and peak to 2 %, force to 1e-6.
  subroutine compare(agrees)
    logical, intent(out) :: agrees
    real(dp) :: x(size(host%c)), length(size(host%c)), pressure(size(host%c))
    real(dp) :: half_width, applied, modulus, hertz_width, hertz_peak

    call contact_places(x)
    call tributary(x, length)
    pressure = lambda / length  ! thickness 1 mm
    half_width = sum(length, mask=state == FETI_ROW_CLOSED) / 2
    applied = -sum(host%f)
    modulus = young / (2 * (1 - poisson**2))
    hertz_width = sqrt(4 * applied * radius / (pi * modulus))
    hertz_peak = 2 * applied / (pi * hertz_width)
    call demo_value('half width', half_width, 'mm')
    call demo_value('half width after Hertz', hertz_width, 'mm')
    call demo_value('peak pressure', maxval(pressure), 'MPa')
    call demo_value('peak pressure after Hertz', hertz_peak, 'MPa')
    call demo_value('total contact force', sum(lambda), 'N')
    call demo_value('applied force', applied, 'N')
    call draw_pressure(x, pressure, hertz_width, hertz_peak)
    agrees = abs(half_width / hertz_width - 1) < 0.02_dp .and. abs(maxval(pressure) / hertz_peak - 1) < 0.02_dp &
      .and. abs(sum(lambda) / applied - 1) < 1e-6_dp
  end subroutine

  !> x of the punch's node in each contact row; the rows run from left to right. (mm)
  subroutine contact_places(x)
    real(dp), intent(out) :: x(:)
    integer :: row, e

    x = 0
    do row = 1, size(x)
      do e = host%contact%row_ptr(row), host%contact%row_ptr(row + 1) - 1
        if (host%contact%col(e) <= host%body(1)%n) x(row) = host%xyz(1, host%contact%col(e))
      end do
    end do
  end subroutine

  !> The length of surface that belongs to each node: half way to each neighbour. (mm)
  subroutine tributary(x, length)
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: length(:)
    integer :: row

    do row = 1, size(x)
      length(row) = (x(min(row + 1, size(x))) - x(max(row - 1, 1))) / 2
    end do
  end subroutine

  !> Logarithm of the residual of every step, relative to the limit that ends the solve; the line of the limit ends one step
  !> behind the last point, which thus lies inside the axes.
  subroutine draw_convergence
    integer :: i

    call picture_svg(picture_folder(), 'hertz_convergence_fortran.svg', 'Convergence: the residual of every step', 'step', &
      'log10(residual / limit)', 'limit', [(real(i, dp), i = 1, taken%steps)], log10(taken%residual(:taken%steps)), &
      [0.0_dp, real(taken%steps + 1, dp)], [0.0_dp, 0.0_dp])
  end subroutine

  !> Contact pressure of every node within 1.5 b against the ellipse of Hertz.
  subroutine draw_pressure(x, pressure, half_width, peak)
    real(dp), intent(in) :: x(:), pressure(:), half_width, peak
    integer, parameter :: samples = 301
    real(dp) :: curve_x(samples), curve_y(samples)
    logical :: near(size(x))
    integer :: i

    near = abs(x) <= 1.5_dp * half_width
    curve_x = [(1.5_dp * half_width * (2 * real(i - 1, dp) / (samples - 1) - 1), i = 1, samples)]
    curve_y = peak * sqrt(max(0.0_dp, 1 - (curve_x / half_width)**2))
    call picture_svg(picture_folder(), 'hertz_pressure_fortran.svg', 'Contact pressure of the cylinder', &
      'x / mm', 'pressure / MPa', 'Hertz', pack(x, near), pack(pressure, near), curve_x, curve_y)
  end subroutine

end program
