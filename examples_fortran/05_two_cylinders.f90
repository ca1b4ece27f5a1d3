!> 05 Two cylinders (Problem 2 of the paper): dense bodies, as boundary elements give them.
!>
!> Two discs of radius 1 mm (E = 2.1e5 N/mm^2, nu = .3, plane stress, 1 mm thick) are stacked on
!> rigid ground. Each disc has only its 72 boundary nodes and a dense symmetric matrix. The discs are held
!> sideways; vertically both may move as rigid bodies. A load presses on the top. Rows 1 to 7 join the
!> discs, rows 8 to 14 the lower disc and the ground; the gaps follow from the circles.
!>
!> The problem is solved first by the method of the paper to four digits, then by the default.
program two_cylinders
  use case_reader
  use demo
  use feti_contact
  implicit none
  integer, parameter :: between = 7  ! rows between the discs
  type(feti_problem) :: problem
  type(feti_info) :: info
  type(contact_case) :: host
  real(dp), allocatable :: u(:), lambda(:), by_paper(:)
  real(dp) :: error
  logical :: agrees
  integer :: b

  call read_case(data_folder(), 'p2_B1', host)
  if (size(host%body) /= 2 .or. size(host%c) /= 2 * between) call demo_stop('p2_B1 is not complete')

  call feti_problem_create(problem)
  call hand_over

  allocate (u(host%n), lambda(size(host%c)), by_paper(size(host%c)))
  call solve_as_in_the_paper

  call feti_solve(problem, info)
  do b = 1, size(host%body)
    associate (body => host%body(b))
      call feti_displacement(problem, b, u(body%offset + 1:body%offset + body%n))
    end associate
  end do
  call feti_multipliers(problem, FETI_INEQUALITY, lambda)
  call feti_problem_destroy(problem)

  call print_forces
  error = max(demo_error(lambda, host%lambda_ref), demo_error(u, host%u_ref))
  agrees = demo_error(by_paper, host%lambda_ref) < 1e-4_dp
  deallocate (u, lambda, by_paper)
  call demo_line('05_two_cylinders', info, error, agrees)

contains

  subroutine hand_over
    real(dp), allocatable :: k(:, :)
    integer :: b, number

    do b = 1, size(host%body)
      associate (body => host%body(b))
        ! The full matrix of a body, n x n, as a boundary element code has it.
        k = boundary_stiffness(body%k)
        call feti_body_add(problem, body%n, number)
        call feti_body_stiffness(problem, number, k, FETI_FULL)
        call feti_body_null_space(problem, number, body%null_space, FETI_EXACT)
        call feti_body_load(problem, number, host%f(body%offset + 1:body%offset + body%n))
      end associate
    end do
    call feti_rows_add(problem, FETI_INEQUALITY, host%contact%row_ptr, host%contact%col, host%contact%val, host%c)
  end subroutine

  function boundary_stiffness(k) result(full)
    type(sparse_matrix), intent(in) :: k
    real(dp) :: full(k%rows, k%rows)
    integer :: i, e

    full = 0
    do i = 1, k%rows
      do e = k%row_ptr(i), k%row_ptr(i + 1) - 1
        full(i, k%col(e)) = k%val(e)
        full(k%col(e), i) = k%val(e)
      end do
    end do
  end function

  !> The method and how far it is to go.
  subroutine choose(method, tolerance, certificate_tolerance)
    character(len=*), intent(in) :: method
    real(dp), intent(in) :: tolerance, certificate_tolerance

    call feti_set(problem, 'method', method)
    call feti_set(problem, 'tolerance', tolerance)
    call feti_set(problem, 'certificate_tolerance', certificate_tolerance)
  end subroutine

  !> Algorithm 3 with monotone proportioning. Its parameters are relative: no unit of the data matters.
  subroutine solve_as_in_the_paper
    call choose('paper-monotone', 1e-6_dp, 1e-4_dp)
    call feti_solve(problem, info)
    call feti_multipliers(problem, FETI_INEQUALITY, by_paper)
    call demo_value('paper: steps', real(info%steps, dp), '-')
    call choose('proportioning', 1e-12_dp, 1e-8_dp)
  end subroutine

  !> The largest nodal force between the discs and that of Hertz: his peak pressure times the spacing, 5 degrees.
  subroutine print_forces
    real(dp), parameter :: pi = acos(-1.0_dp), angle = pi / 36
    real(dp) :: load, half_width
    integer :: r

    load = sum([(lambda(r) * cos((r - 4) * angle), r = 1, between)])
    half_width = sqrt(4 * load * 0.5_dp / (pi * 0.5_dp * 2.1e5_dp))
    call demo_value('force between the discs', load, 'N')
    call demo_value('largest nodal force', maxval(lambda(:between)), 'N')
    call demo_value('nodal force after Hertz', angle * 2 * load / (pi * half_width), 'N')
    call demo_value('nodal force, paper''s method', maxval(by_paper(:between)), 'N')
  end subroutine

end program
