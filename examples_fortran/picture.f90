!> Pictures of the answer: an SVG plot of points against curves.
module picture
  use case_reader, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  implicit none
  private
  public :: picture_svg, open_picture

  ! The sheet and its margins, in SVG units.
  real(dp), parameter :: width = 720, height = 480, left = 80, right = 20, top = 64, bottom = 64
  character(len=7), parameter :: colours(5) = ['#1f5fa8', '#c03a1d', '#2a8a4a', '#8a4fb0', '#b8860b']

  !> The plotted range: x from low to high over the width, y from bottom <= 0 to ceiling over the height.
  type :: frame
    real(dp) :: low, high, bottom, ceiling
  end type

contains

  !> Writes folder/name: points (x, y), the curve (curve_x, curve_y) called theory, title, names of the axes with units. Behind a
  !> NaN the next curve begins, and the next points; each curve and its points have a colour of their own. names: of the curves,
  !> if there are several.
  subroutine picture_svg(folder, name, title, x_name, y_name, theory, x, y, curve_x, curve_y, names)
    character(len=*), intent(in) :: folder, name, title, x_name, y_name, theory
    real(dp), intent(in) :: x(:), y(:), curve_x(:), curve_y(:)
    character(len=*), intent(in), optional :: names(:)
    type(frame) :: range
    real(dp) :: step
    integer :: unit, i, k

    associate (all_x => [pack(x, .not. ieee_is_nan(x)), pack(curve_x, .not. ieee_is_nan(curve_x))], &
               all_y => [pack(y, .not. ieee_is_nan(y)), pack(curve_y, .not. ieee_is_nan(curve_y))])
      range = frame(minval(all_x), maxval(all_x), min(0.0_dp, minval(all_y)), maxval(all_y))
    end associate
    step = round_step(range%ceiling - range%bottom)
    range%ceiling = step * ceiling(1.02_dp * range%ceiling / step)
    range%bottom = step * floor(1.02_dp * range%bottom / step)
    call open_picture(folder, name, unit)
    write (unit, '(a)') '<svg xmlns="http://www.w3.org/2000/svg" width="720" height="480" viewBox="0 0 720 480" ' // &
      'font-family="sans-serif" font-size="14">', '<rect width="100%" height="100%" fill="#fff"/>'
    call write_text(unit, width / 2, 28.0_dp, title)
    call write_text(unit, (left + width - right) / 2, height - 18, x_name)
    write (unit, '(3a)') '<text transform="translate(20 232) rotate(-90)" text-anchor="middle">', y_name, '</text>'
    call draw_axes(unit, range)
    k = 1
    call begin_curve(unit, k)
    do i = 1, size(curve_x)
      if (.not. ieee_is_nan(curve_x(i))) then
        write (unit, '(f0.2, a, f0.2)') place_x(range, curve_x(i)), ',', place_y(range, curve_y(i))
      else if (i < size(curve_x)) then
        k = k + 1
        write (unit, '(a)') '"/>'
        call begin_curve(unit, k)
      end if
    end do
    write (unit, '(a)') '"/>'
    k = merge(1, 2, present(names))   ! the points of a curve alone have another colour
    do i = 1, size(x)
      if (ieee_is_nan(x(i))) then
        k = k + 1
      else
        call draw_point(unit, k, place_x(range, x(i)), place_y(range, y(i)))
      end if
    end do
    if (present(names)) then
      write (unit, '(a)') '<text x="80" y="462">points: computed</text>', &
        '<text x="700" y="462" text-anchor="end">curves: ' // theory // '</text>'
      do k = 1, size(names)
        associate (at => left + (k - 1) * (width - left - right) / size(names))
          call begin_curve(unit, k)
          write (unit, '(f0.1, a, f0.1, a)') at, ',47 ', at + 24, ',47"/>'
          call draw_point(unit, k, at + 12, 47.0_dp)
          write (unit, '(a, f0.1, 3a)') '<text y="52" x="', at + 32, '">', trim(names(k)), '</text>'
        end associate
      end do
    else
      write (unit, '(a)') '<text x="80" y="462" fill="#c03a1d">points: computed</text>', &
        '<text x="700" y="462" text-anchor="end" fill="#1f5fa8">curve: ' // theory // '</text>'
    end if
    write (unit, '(a)') '</svg>'
    close (unit)
  end subroutine

  !> Then come the points of the curve and '"/>'.
  subroutine begin_curve(unit, k)
    integer, intent(in) :: unit, k

    write (unit, '(3a)') '<polyline fill="none" stroke="', colours(mod(k - 1, 5) + 1), '" stroke-width="2" points="'
  end subroutine

  subroutine draw_point(unit, k, x, y)
    integer, intent(in) :: unit, k
    real(dp), intent(in) :: x, y

    write (unit, '(3a, f0.2, a, f0.2, a)') '<circle fill="', colours(mod(k - 1, 5) + 1), '" r="3.2" cx="', x, '" cy="', y, '"/>'
  end subroutine

  !> Grid lines at round steps, with their numbers.
  subroutine draw_axes(unit, range)
    integer, intent(in) :: unit
    type(frame), intent(in) :: range
    real(dp) :: step
    integer :: i

    step = round_step(range%high - range%low)
    do i = ceiling(range%low / step), floor(range%high / step)
      call draw_line(unit, place_x(range, i * step), top, place_x(range, i * step), height - bottom)
      call write_text(unit, place_x(range, i * step), height - bottom + 18, figure(i * step))
    end do
    step = round_step(range%ceiling - range%bottom)
    do i = ceiling(range%bottom / step), floor(range%ceiling / step)
      call draw_line(unit, left, place_y(range, i * step), width - right, place_y(range, i * step))
      call write_text(unit, left - 28, place_y(range, i * step) + 4, figure(i * step))
    end do
  end subroutine

  subroutine draw_line(unit, x1, y1, x2, y2)
    integer, intent(in) :: unit
    real(dp), intent(in) :: x1, y1, x2, y2

    write (unit, '(4(a, f0.1), a)') '<line stroke="#ccc" x1="', x1, '" y1="', y1, '" x2="', x2, '" y2="', y2, '"/>'
  end subroutine

  subroutine write_text(unit, x, y, text)
    integer, intent(in) :: unit
    real(dp), intent(in) :: x, y
    character(len=*), intent(in) :: text

    write (unit, '(2(a, f0.1), 3a)') '<text text-anchor="middle" x="', x, '" y="', y, '">', trim(text), '</text>'
  end subroutine

  !> A number of an axis: whole where it is whole, two decimals otherwise.
  function figure(x) result(text)
    real(dp), intent(in) :: x
    character(len=12) :: text

    if (abs(x - nint(x)) < 1e-9_dp) then
      write (text, '(i0)') nint(x)
    else
      write (text, '(f12.2)') x
      text = adjustl(text)
    end if
  end function

  !> A round step (1, 2 or 5 times a power of ten) that divides the length into at most six parts.
  pure real(dp) function round_step(length)
    real(dp), intent(in) :: length
    real(dp) :: parts

    round_step = 10.0_dp**floor(log10(length / 6))
    parts = length / (6 * round_step)
    if (parts > 5) then
      round_step = 10 * round_step
    else if (parts > 2) then
      round_step = 5 * round_step
    else if (parts > 1) then
      round_step = 2 * round_step
    end if
  end function

  pure real(dp) function place_x(range, x)
    type(frame), intent(in) :: range
    real(dp), intent(in) :: x

    place_x = left + (x - range%low) / (range%high - range%low) * (width - left - right)
  end function

  pure real(dp) function place_y(range, y)
    type(frame), intent(in) :: range
    real(dp), intent(in) :: y

    place_y = height - bottom - (y - range%bottom) / (range%ceiling - range%bottom) * (height - top - bottom)
  end function

  !> Opens folder/name for writing and prints its name.
  subroutine open_picture(folder, name, unit)
    character(len=*), intent(in) :: folder, name
    integer, intent(out) :: unit
    integer :: status

    open (newunit=unit, file=folder // '/' // name, action='write', status='replace', iostat=status)
    if (status /= 0) then
      print '(4a)', folder, '/', name, ' cannot be written'
      error stop 1
    end if
    print '(4a)', 'picture ', folder, '/', name
  end subroutine

end module
