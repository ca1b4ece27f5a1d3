!> What the examples share and a host would not need: the folders, printing, the demo line.
module demo
  use feti_contact
  implicit none
  private
  public :: data_folder, picture_folder, demo_stop, demo_error, demo_value, demo_line, power_of_ten

  integer, parameter :: dp = kind(1.0d0)

contains

  !> First argument of the command line: where the cases lie, build/data by default.
  function data_folder() result(folder)
    character(len=:), allocatable :: folder

    folder = argument(1, 'build/data')
  end function

  !> Second argument of the command line: where pictures go, build/pictures by default.
  function picture_folder() result(folder)
    character(len=:), allocatable :: folder

    folder = argument(2, 'build/pictures')
  end function

  function argument(k, default) result(text)
    integer, intent(in) :: k
    character(len=*), intent(in) :: default
    character(len=:), allocatable :: text
    character(len=1000) :: given

    call get_command_argument(k, given)
    text = default
    if (len_trim(given) > 0) text = trim(given)
  end function

  !> Ends the program with a text.
  subroutine demo_stop(text)
    character(len=*), intent(in) :: text

    print '(a)', text
    error stop 1
  end subroutine

  !> max |x - ref| / max |ref|: relative error of x against the reference.
  pure real(dp) function demo_error(x, ref)
    real(dp), intent(in) :: x(:), ref(:)

    demo_error = maxval(abs(x - ref))
    if (maxval(abs(ref)) > 0) demo_error = demo_error / maxval(abs(ref))
  end function

  !> Prints one result: name, value, unit. The C twin prints the same lines.
  subroutine demo_value(name, value, unit)
    character(len=*), intent(in) :: name, unit
    real(dp), intent(in) :: value
    character(len=32) :: label

    label = name
    print '(a32, f16.6, 1x, a)', label, value, unit
  end subroutine

  !> Prints the demo line. The program fails unless the library reports FETI_OK, its certificate passes,
  !> error <= 1e-7 and the example's own checks hold.
  subroutine demo_line(example, info, error, agrees)
    character(len=*), intent(in) :: example
    type(feti_info), intent(in) :: info
    real(dp), intent(in) :: error
    logical, intent(in) :: agrees
    real(dp) :: largest
    logical :: ok
    character(len=12) :: seconds

    largest = max(info%equilibrium, info%balance, info%penetration, info%equality, info%negative_force, &
      info%complementarity, info%duality_gap, info%friction_cone, info%friction_work, info%friction_stick)
    ok = agrees .and. info%status == FETI_OK .and. info%worst <= 1 .and. error <= 1e-7_dp
    write (seconds, '(f12.3)') info%seconds_setup + info%seconds_solve
    print '(3a, 3(a, i0), 7a)', 'demo ', example, ' fortran', ' unknowns ', info%dofs, ' rows ', info%rows, &
      ' active ', info%active, ' certificate ', power_of_ten(largest), ' error ', power_of_ten(error), &
      ' seconds ', trim(adjustl(seconds)), trim(merge(' ok   ', ' short', ok))
    if (.not. ok) error stop 1
  end subroutine

  !> Two digits and a power of ten, as C prints it: 4.9e-12.
  function power_of_ten(x) result(text)
    real(dp), intent(in) :: x
    character(len=7) :: text
    integer :: e

    write (text, '(es7.1e2)') x
    e = index(text, 'E')
    if (e > 0) text(e:e) = 'e'
  end function

end module
