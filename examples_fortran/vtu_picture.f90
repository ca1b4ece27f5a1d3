!> Pictures of the answer as VTK XML (.vtu, ASCII), which ParaView opens; its filter Warp By Vector deforms them.
module vtu_picture
  use case_reader, only: contact_case, dp
  use picture, only: open_picture
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  implicit none
  private
  public :: picture_case, contact_of_nodes, vtu_begin, vtu_cells, vtu_doubles, vtu_integers, vtu_next, vtu_end

  !> Contact results at the nodes: every row belongs to one node, that of the body which has only one node in it.
  type :: contact_of_nodes
    !> Force of the row over the area (in the plane: length) that belongs to the node; 0 without a row.
    real(dp), allocatable :: pressure(:)
    !> Open gap, length; NaN without a row.
    real(dp), allocatable :: gap(:)
    !> FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK or FETI_ROW_UNKNOWN; -1 without a row.
    integer, allocatable :: state(:)
  end type

  ! Samples along each side of a contact surface in space.
  integer, parameter :: samples = 200
  ! Nodes of a hexahedron in half steps of a lattice, in the order of VTK: corners around the bottom and the top, then the middles
  ! of the edges around both and of those between.
  integer, parameter :: half(3, 20) = reshape([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, 2, 2, 0, 2, 2, 2, 2, 0, 2, 2, &
    1, 0, 0, 2, 1, 0, 1, 2, 0, 0, 1, 0, 1, 0, 2, 2, 1, 2, 1, 2, 2, 0, 1, 2, 0, 0, 1, 2, 0, 1, 2, 2, 1, 0, 2, 1], [3, 20])

contains

  !> Writes folder/name: nodes at xyz, displacement u (length) and contact force (force) on every node as vectors; pressure, gap
  !> and state from lambda (force), slack (gap, length) and state of every contact row. A body whose nodes run line after line in
  !> the plane is drawn by quadrilaterals, one whose nodes lie on a lattice in space by hexahedra (every stride-th plane has
  !> corners), any other by its nodes.
  subroutine picture_case(folder, name, host, stride, u, force, lambda, slack, state)
    character(len=*), intent(in) :: folder, name
    type(contact_case), intent(in) :: host
    integer, intent(in) :: stride(:), state(:)
    real(dp), intent(in) :: u(:), force(:), lambda(:), slack(:)
    type(contact_of_nodes) :: contact
    integer, allocatable :: cell(:, :), body(:)
    integer :: unit, dims, nodes, i, b, before

    dims = maxval(host%dir)
    nodes = host%n / dims
    allocate (cell(20, 0), body(0))
    do b = 1, size(host%body)
      before = size(cell, 2)
      call append_cells(host, b, dims, stride(b), cell)
      body = [body, [(b, i = before + 1, size(cell, 2))]]
    end do
    call find_contact(host, dims, lambda, slack, state, contact)
    call vtu_begin(folder, name, nodes, size(cell, 2), unit)
    call vtu_doubles(unit, 'Points', 3, host%xyz(:, dims::dims))
    call vtu_cells(unit, cell)
    call vtu_doubles(unit, 'displacement', 3, in_space(dims, u))
    call vtu_doubles(unit, 'contact_force', 3, in_space(dims, force))
    call vtu_doubles(unit, 'pressure', 1, reshape(contact%pressure, [1, nodes]))
    call vtu_doubles(unit, 'gap', 1, reshape(contact%gap, [1, nodes]))
    call vtu_integers(unit, 'contact', contact%state)
    call vtu_next(unit)
    call vtu_integers(unit, 'body', body)
    call vtu_end(unit)
  end subroutine

  !> Opens folder/name; then come the points, the cells, numbers of the nodes, vtu_next, numbers of the cells, vtu_end.
  subroutine vtu_begin(folder, name, nodes, cells, unit)
    character(len=*), intent(in) :: folder, name
    integer, intent(in) :: nodes, cells
    integer, intent(out) :: unit

    call open_picture(folder, name, unit)
    write (unit, '(a)') '<?xml version="1.0"?>', '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">', &
      '<UnstructuredGrid>'
    write (unit, '(2(a, i0), a)') '<Piece NumberOfPoints="', nodes, '" NumberOfCells="', cells, '">'
    write (unit, '(a)') '<Points>'
  end subroutine

  !> Ends the points; cell(:,i): nodes of a cell from 0, behind them -1.
  subroutine vtu_cells(unit, cell)
    integer, intent(in) :: unit, cell(:, :)
    integer :: corners(size(cell, 2)), offsets(size(cell, 2)), types(size(cell, 2)), i, total

    corners = count(cell >= 0, dim=1)
    types = 1
    where (corners == 4) types = 9
    where (corners == 8) types = 12
    where (corners == 20) types = 25
    total = 0
    do i = 1, size(corners)
      total = total + corners(i)
      offsets(i) = total
    end do
    write (unit, '(a)') '</Points>', '<Cells>'
    call begin_array(unit, 'Int64', 'connectivity', 1)
    do i = 1, size(corners)
      write (unit, '(20(i0, 1x))') cell(:corners(i), i)
    end do
    write (unit, '(a)') '</DataArray>'
    call begin_array(unit, 'Int64', 'offsets', 1)
    write (unit, '(i0)') offsets
    write (unit, '(a)') '</DataArray>'
    call begin_array(unit, 'UInt8', 'types', 1)
    write (unit, '(i0)') types
    write (unit, '(a)') '</DataArray>', '</Cells>', '<PointData>'
  end subroutine

  !> Goes on from the nodes to the cells.
  subroutine vtu_next(unit)
    integer, intent(in) :: unit

    write (unit, '(a)') '</PointData>', '<CellData>'
  end subroutine

  subroutine vtu_end(unit)
    integer, intent(in) :: unit

    write (unit, '(a)') '</CellData>', '</Piece>', '</UnstructuredGrid>', '</VTKFile>'
    close (unit)
  end subroutine

  !> values(components,n).
  subroutine vtu_doubles(unit, name, components, values)
    integer, intent(in) :: unit, components
    character(len=*), intent(in) :: name
    real(dp), intent(in) :: values(:, :)
    integer :: i

    call begin_array(unit, 'Float64', name, components)
    do i = 1, size(values, 2)
      if (any(ieee_is_nan(values(:, i)))) then
        write (unit, '(a)') repeat('nan ', components)
      else
        write (unit, '(3es17.8e3)') values(:, i)
      end if
    end do
    write (unit, '(a)') '</DataArray>'
  end subroutine

  subroutine vtu_integers(unit, name, values)
    integer, intent(in) :: unit, values(:)
    character(len=*), intent(in) :: name

    call begin_array(unit, 'Int32', name, 1)
    write (unit, '(i0)') values
    write (unit, '(a)') '</DataArray>'
  end subroutine

  subroutine begin_array(unit, kind_name, name, components)
    integer, intent(in) :: unit, components
    character(len=*), intent(in) :: kind_name, name

    write (unit, '(5a, i0, a)') '<DataArray type="', kind_name, '" Name="', name, '" NumberOfComponents="', components, &
      '" format="ascii">'
  end subroutine

  !> Three components of every node, the third 0 in the plane.
  pure function in_space(dims, from) result(vectors)
    integer, intent(in) :: dims
    real(dp), intent(in) :: from(:)
    real(dp) :: vectors(3, size(from) / dims)

    vectors = 0
    vectors(:dims, :) = reshape(from, [dims, size(from) / dims])
  end function

  !> Adds the cells of body b, nodes counted from 0 through all bodies as VTK does; -1: no more nodes.
  subroutine append_cells(host, b, dims, stride, cell)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: b, dims, stride
    integer, allocatable, intent(inout) :: cell(:, :)
    integer, allocatable :: more(:, :)
    integer :: before, nodes, line, i, j

    before = host%body(b)%offset / dims
    nodes = host%body(b)%n / dims
    associate (xyz => host%xyz(:, host%body(b)%offset + 1:host%body(b)%offset + host%body(b)%n:dims))
      line = count_line(xyz(1, :))
      if (dims == 2 .and. line > 1 .and. mod(nodes, line) == 0) then
        allocate (more(20, (nodes / line - 1) * (line - 1)), source=-1)
        do i = 1, nodes / line - 1
          do j = 1, line - 1
            more(:4, (i - 1) * (line - 1) + j) = before + line * (i - 1) + j - 1 + [0, line, line + 1, 1]
          end do
        end do
      else
        if (dims == 3) call find_hexahedra(xyz, stride, before, more)
        if (.not. allocated(more)) then
          allocate (more(20, nodes), source=-1)
          more(1, :) = [(before + i - 1, i = 1, nodes)]
        end if
      end if
    end associate
    cell = reshape([cell, more], [20, size(cell, 2) + size(more, 2)])
  end subroutine

  !> Nodes with the x of the first one, up to the first that differs.
  pure integer function count_line(x)
    real(dp), intent(in) :: x(:)

    count_line = 1
    do while (count_line < size(x))
      if (abs(x(count_line + 1) - x(1)) > 0) exit
      count_line = count_line + 1
    end do
  end function

  !> The hexahedra of nodes on a lattice; not allocated where the lattice is far larger than the body.
  subroutine find_hexahedra(xyz, stride, before, cell)
    real(dp), intent(in) :: xyz(:, :)
    integer, intent(in) :: stride, before
    integer, allocatable, intent(out) :: cell(:, :)
    integer, allocatable :: node(:, :, :)
    integer :: plane(3, size(xyz, 2)), planes(3), corners, cells, found(20), i, j, k, c

    do k = 1, 3
      call number_planes(xyz(k, :), plane(k, :), planes(k))
    end do
    if (product(planes) > 8 * size(xyz, 2)) return
    allocate (node(planes(1), planes(2), planes(3)), source=-1)
    do i = 1, size(xyz, 2)
      node(plane(1, i), plane(2, i), plane(3, i)) = before + i - 1
    end do
    corners = merge(20, 8, stride == 2)
    cells = 0
    allocate (cell(20, product(planes)), source=-1)
    do i = 1, planes(1) - stride, stride
      do j = 1, planes(2) - stride, stride
        do k = 1, planes(3) - stride, stride
          do c = 1, corners
            found(c) = node(i + stride * half(1, c) / 2, j + stride * half(2, c) / 2, k + stride * half(3, c) / 2)
          end do
          if (any(found(:corners) < 0)) cycle
          cells = cells + 1
          cell(:corners, cells) = found(:corners)
        end do
      end do
    end do
    cell = cell(:, :cells)
  end subroutine

  !> The number of the plane that each coordinate lies in, of all planes. Coordinates of one plane differ by at most 1e-6 of the
  !> body's length along the axis.
  subroutine number_planes(x, plane, planes)
    real(dp), intent(in) :: x(:)
    integer, intent(out) :: plane(:), planes
    real(dp) :: at, tolerance

    tolerance = 1e-6_dp * (maxval(x) - minval(x))
    planes = 0
    at = minval(x)
    do
      planes = planes + 1
      where (x >= at - tolerance) plane = planes
      if (all(x <= at + tolerance)) exit
      at = minval(x, mask=x > at + tolerance)
    end do
  end subroutine

  subroutine find_contact(host, dims, lambda, slack, state, contact)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: dims, state(:)
    real(dp), intent(in) :: lambda(:), slack(:)
    type(contact_of_nodes), intent(out) :: contact
    integer :: node(size(lambda)), pair(2, size(lambda)), r
    real(dp) :: factor(size(lambda)), area(size(lambda))

    allocate (contact%pressure(host%n / dims), source=0.0_dp)
    allocate (contact%gap(host%n / dims), source=ieee_value(1.0_dp, ieee_quiet_nan))
    allocate (contact%state(host%n / dims), source=-1)
    do r = 1, size(lambda)
      call place_row(host, dims, r, node(r), pair(:, r), factor(r))
    end do
    if (dims == 2) then
      call find_lengths(host%xyz(1, dims * node), pair, area)
    else
      call find_areas(host%xyz(:2, dims * node), pair, area)
    end if
    do r = 1, size(lambda)
      contact%pressure(node(r)) = 0
      if (area(r) > 0) contact%pressure(node(r)) = lambda(r) * factor(r) / area(r)
      contact%gap(node(r)) = slack(r)
      contact%state(node(r)) = state(r)
    end do
  end subroutine

  !> The node of a row, its body and the other one, and the force on the node over that of the row.
  subroutine place_row(host, dims, row, node, pair, factor)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: dims, row
    integer, intent(out) :: node, pair(2)
    real(dp), intent(out) :: factor
    integer :: e

    associate (from => host%contact%row_ptr(row), to => host%contact%row_ptr(row + 1) - 1)
      associate (nodes => (host%contact%col(from:to) - 1) / dims + 1, val => host%contact%val(from:to), &
                 bodies => [(body_of(host, host%contact%col(e)), e = from, to)])
        pair = bodies(1)
        do e = 1, size(bodies)
          pair(1) = bodies(e)
          node = nodes(e)
          if (all(nodes == node .or. bodies /= pair(1))) exit
        end do
        do e = 1, size(bodies)
          if (bodies(e) /= pair(1)) pair(2) = bodies(e)
        end do
        factor = sqrt(sum(val**2, mask=nodes == node))
      end associate
    end associate
  end subroutine

  pure integer function body_of(host, unknown)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: unknown

    body_of = size(host%body)
    do while (host%body(body_of)%offset >= unknown)
      body_of = body_of - 1
    end do
  end function

  !> In the plane: half way to the neighbours of the same pair of bodies along x.
  subroutine find_lengths(x, pair, length)
    real(dp), intent(in) :: x(:)
    integer, intent(in) :: pair(:, :)
    real(dp), intent(out) :: length(:)
    logical :: same(size(x))
    real(dp) :: left, right
    integer :: r

    do r = 1, size(x)
      same = pair(1, :) == pair(1, r) .and. pair(2, :) == pair(2, r)
      left = x(r)
      right = x(r)
      if (any(same .and. x < x(r))) left = maxval(x, mask=same .and. x < x(r))
      if (any(same .and. x > x(r))) right = minval(x, mask=same .and. x > x(r))
      length(r) = (right - left) / 2
    end do
  end subroutine

  !> In space, on a surface z = const: samples of the rectangle around the nodes of a pair of bodies go to the nearest of them.
  subroutine find_areas(xy, pair, area)
    real(dp), intent(in) :: xy(:, :)
    integer, intent(in) :: pair(:, :)
    real(dp), intent(out) :: area(:)
    logical :: done(size(area)), same(size(area))
    real(dp) :: low(2), high(2), at(2)
    integer :: first, i, j, nearest

    area = 0
    done = .false.
    do first = 1, size(area)
      if (done(first)) cycle
      same = pair(1, :) == pair(1, first) .and. pair(2, :) == pair(2, first)
      done = done .or. same
      low = [minval(xy(1, :), mask=same), minval(xy(2, :), mask=same)]
      high = [maxval(xy(1, :), mask=same), maxval(xy(2, :), mask=same)]
      do j = 0, samples - 1
        do i = 0, samples - 1
          at = low + (high - low) * [i + 0.5_dp, j + 0.5_dp] / samples
          nearest = minloc((xy(1, :) - at(1))**2 + (xy(2, :) - at(2))**2, dim=1, mask=same)
          area(nearest) = area(nearest) + product(high - low) / samples**2
        end do
      end do
    end do
  end subroutine

end module
