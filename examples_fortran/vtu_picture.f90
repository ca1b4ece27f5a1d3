!> Pictures of the answer as VTK XML (.vtu, ASCII), which ParaView opens; its filter Warp By Vector deforms them.
module vtu_picture
  use case_reader, only: contact_case, dp
  use picture, only: open_picture
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  implicit none
  private
  public :: picture_case, picture_mesh, picture_step, picture_pvd, picture_grid, picture_answer, nan_of
  public :: vtu_begin, vtu_doubles, vtu_integers, vtu_next, vtu_end

  !> The numbers that VTK has for cells.
  integer, parameter, public :: picture_line = 3, picture_quad = 9, picture_hexahedron = 12, picture_triangle6 = 22, &
    picture_quad8 = 23, picture_tetrahedron10 = 24, picture_hexahedron20 = 25

  !> The cells of all bodies.
  type :: picture_grid
    real(dp), allocatable :: xyz(:, :)      ! 3 x nodes, length, undeformed
    integer, allocatable :: corner(:, :)    ! 20 x cells: nodes from 1 in the order of VTK, behind them 0
    integer, allocatable :: kind(:), body(:)
  end type

  !> What a solve has come to, for all bodies.
  type :: picture_answer
    real(dp), allocatable :: u(:, :), force(:, :)   ! 3 x nodes: displacement, length; contact force
    real(dp), allocatable :: push(:), gap(:)        ! nodes: force and gap of the row at the node; NaN without a row
    integer, allocatable :: state(:)                ! nodes: FETI_ROW_OPEN, ..; -1 without a row
    integer, allocatable :: piece(:)                ! cells: the piece of a body that is cut, from 0; not allocated: no body is
    real(dp) :: shear_modulus = 0, lame = 0         ! shear_modulus 0: no stress is written
    logical :: large = .false.   ! large displacements of St. Venant and Kirchhoff's material; areas are those of displaced faces
  end type

  ! The faces of elements, by the places of their nodes: corners, then the middles of the edges.
  integer, parameter :: face_of_quad(2, 4) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])
  integer, parameter :: face_of_tetrahedron(6, 4) = reshape([1, 3, 2, 7, 6, 5, 1, 2, 4, 5, 9, 8, 2, 3, 4, 6, 10, 9, &
    3, 1, 4, 7, 8, 10], [6, 4])
  integer, parameter :: face_of_hexahedron(8, 6) = reshape([1, 4, 3, 2, 12, 11, 10, 9, 5, 6, 7, 8, 13, 14, 15, 16, &
    1, 2, 6, 5, 9, 18, 13, 17, 2, 3, 7, 6, 10, 19, 14, 18, 3, 4, 8, 7, 11, 20, 15, 19, 4, 1, 5, 8, 12, 17, 16, 20], [8, 6])
  ! Quadrilateral and hexahedra: the nodes' places in [-1, 1]^3. Tetrahedron: the corners at the ends of a middle node's edge.
  integer, parameter :: place(3, 20) = reshape([-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, &
    -1, 1, 1, 0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, -1, -1, 0, 1, -1, 0, 1, 1, 0, &
    -1, 1, 0], [3, 20])
  real(dp), parameter :: identity(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1] * 1.0_dp, [3, 3])
  integer, parameter :: ends(2, 5:10) = reshape([1, 2, 2, 3, 1, 3, 1, 4, 2, 4, 3, 4], [2, 6])

contains

  !> Writes the elements of a case: displacement u (length) and contact force by unknowns, lambda (force), slack (gap, length) and
  !> state of every row.
  subroutine picture_case(folder, name, host, shear_modulus, u, force, lambda, slack, state)
    character(len=*), intent(in) :: folder, name
    type(contact_case), intent(in) :: host
    integer, intent(in) :: state(:)
    real(dp), intent(in) :: shear_modulus, u(:), force(:), lambda(:), slack(:)
    type(picture_grid) :: grid
    type(picture_answer) :: answer
    real(dp) :: factor
    integer :: dims, nodes, e, row, node

    dims = maxval(host%dir)
    nodes = host%n / dims
    allocate (grid%xyz, source=host%xyz(:, dims::dims))
    allocate (grid%corner, source=host%element)
    allocate (grid%body, source=host%element_body)
    allocate (grid%kind(size(grid%body)))
    do e = 1, size(grid%body)
      select case (count(grid%corner(:, e) > 0))
      case (4)
        grid%kind(e) = picture_quad
      case (8)
        grid%kind(e) = picture_hexahedron
      case (10)
        grid%kind(e) = picture_tetrahedron10
      case default
        grid%kind(e) = picture_hexahedron20
      end select
    end do
    answer%shear_modulus = shear_modulus
    allocate (answer%u, source=in_space(dims, u))
    allocate (answer%force, source=in_space(dims, force))
    allocate (answer%push(nodes), source=0.0_dp)
    allocate (answer%gap(nodes), source=nan_of())
    allocate (answer%state(nodes), source=-1)
    do row = 1, size(lambda)
      call find_node(host, dims, row, body_of_nodes(host, dims, row), node, factor)
      if (node == 0) cycle
      answer%push(node) = lambda(row) * factor
      answer%gap(node) = slack(row)
      answer%state(node) = state(row)
    end do
    call picture_mesh(folder, name, grid, answer)
  end subroutine

  !> Writes elements and, as cells of their own, those of their faces that may touch, all of whose nodes have a row. Numbers of
  !> cells: body, piece, von Mises stress of elements, contact pressure of faces; of nodes: displacement, contact_force, gap,
  !> contact (the state of the row).
  subroutine picture_mesh(folder, name, elements, answer)
    character(len=*), intent(in) :: folder, name
    type(picture_grid), intent(in) :: elements
    type(picture_answer), intent(in) :: answer
    type(picture_grid) :: all
    real(dp), allocatable :: stress(:), pressure(:)
    integer :: unit, e, cells

    cells = size(elements%kind)
    call add_faces(elements, answer%state, all)
    allocate (stress(size(all%kind)), source=nan_of())
    do e = 1, merge(cells, 0, answer%shear_modulus > 0)
      stress(e) = von_mises(elements, e, answer)
    end do
    call find_pressures(all, cells, answer, pressure)
    call vtu_begin(folder, name, all, unit)
    call vtu_doubles(unit, 'displacement', answer%u)
    call vtu_doubles(unit, 'contact_force', answer%force)
    call vtu_doubles(unit, 'gap', reshape(answer%gap, [1, size(answer%gap)]))
    call vtu_integers(unit, 'contact', answer%state)
    call vtu_next(unit, all)
    if (answer%shear_modulus > 0) call vtu_doubles(unit, 'von_mises', reshape(stress, [1, size(stress)]))
    call vtu_doubles(unit, 'pressure', reshape(pressure, [1, size(pressure)]))
    if (allocated(answer%piece)) call vtu_integers(unit, 'piece', [answer%piece, [(-1, e=cells + 1, size(all%kind))]])
    call vtu_end(unit)
  end subroutine

  !> The same for a step of a film of quadrilaterals in the plane with large displacements: stem_step.vtu. The first cells are body 1,
  !> the others body 2; corner: 4 x cells, nodes from 1; x, u, force: 2 x nodes, at rest, displacement (length), contact force; push,
  !> gap and state of nodes as in picture_answer.
  subroutine picture_step(folder, stem, step, first, corner, x, u, force, push, gap, state, shear_modulus, lame)
    character(len=*), intent(in) :: folder, stem
    integer, intent(in) :: step, first, corner(:, :), state(:)
    real(dp), intent(in) :: x(:, :), u(:, :), force(:, :), push(:), gap(:), shear_modulus, lame
    type(picture_grid) :: grid
    type(picture_answer) :: answer
    character(len=12) :: number
    integer :: c, cells

    cells = size(corner, 2)
    allocate (grid%xyz, source=in_space(2, reshape(x, [size(x)])))
    allocate (grid%corner(20, cells), source=0)
    grid%corner(:4, :) = corner
    allocate (grid%kind(cells), source=picture_quad)
    allocate (grid%body, source=[(merge(1, 2, c <= first), c=1, cells)])
    allocate (answer%u, source=in_space(2, reshape(u, [size(u)])))
    allocate (answer%force, source=in_space(2, reshape(force, [size(force)])))
    allocate (answer%push, source=push)
    allocate (answer%gap, source=gap)
    allocate (answer%state, source=state)
    answer%shear_modulus = shear_modulus
    answer%lame = lame
    answer%large = .true.
    write (number, '(i0)') step
    call picture_mesh(folder, stem // '_' // trim(number) // '.vtu', grid, answer)
  end subroutine

  !> Opens folder/name; then come numbers of the nodes, vtu_next, numbers of the cells, vtu_end.
  subroutine vtu_begin(folder, name, grid, unit)
    character(len=*), intent(in) :: folder, name
    type(picture_grid), intent(in) :: grid
    integer, intent(out) :: unit
    integer :: c, total

    call open_picture(folder, name, unit)
    write (unit, '(a)') '<?xml version="1.0"?>', '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">', &
      '<UnstructuredGrid>'
    write (unit, '(2(a, i0), a)') '<Piece NumberOfPoints="', size(grid%xyz, 2), '" NumberOfCells="', size(grid%kind), '">'
    write (unit, '(a)') '<Points>'
    call vtu_doubles(unit, 'Points', grid%xyz)
    write (unit, '(a)') '</Points>', '<Cells>'
    call begin_array(unit, 'Int64', 'connectivity', 1)
    do c = 1, size(grid%kind)
      write (unit, '(20(i0, 1x))') pack(grid%corner(:, c), grid%corner(:, c) > 0) - 1   ! VTK counts from 0
    end do
    write (unit, '(a)') '</DataArray>'
    call begin_array(unit, 'Int64', 'offsets', 1)
    total = 0
    do c = 1, size(grid%kind)
      total = total + count(grid%corner(:, c) > 0)
      write (unit, '(i0)') total
    end do
    write (unit, '(a)') '</DataArray>'
    call begin_array(unit, 'UInt8', 'types', 1)
    write (unit, '(i0)') grid%kind
    write (unit, '(a)') '</DataArray>', '</Cells>', '<PointData>'
  end subroutine

  !> Goes on from the nodes to the cells.
  subroutine vtu_next(unit, grid)
    integer, intent(in) :: unit
    type(picture_grid), intent(in) :: grid

    write (unit, '(a)') '</PointData>', '<CellData>'
    call vtu_integers(unit, 'body', grid%body)
  end subroutine

  subroutine vtu_end(unit)
    integer, intent(in) :: unit

    write (unit, '(a)') '</CellData>', '</Piece>', '</UnstructuredGrid>', '</VTKFile>'
    close (unit)
  end subroutine

  !> values(:,i): the components of node or cell i.
  subroutine vtu_doubles(unit, name, values)
    integer, intent(in) :: unit
    character(len=*), intent(in) :: name
    real(dp), intent(in) :: values(:, :)
    integer :: i

    call begin_array(unit, 'Float64', name, size(values, 1))
    do i = 1, size(values, 2)
      if (any(ieee_is_nan(values(:, i)))) then
        write (unit, '(a)') repeat('nan ', size(values, 1))
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

  !> Writes folder/stem.pvd, which ParaView opens as a film of stem_0.vtu, stem_1.vtu, .. at the times 0, 1, ..
  subroutine picture_pvd(folder, stem, steps)
    character(len=*), intent(in) :: folder, stem
    integer, intent(in) :: steps
    integer :: unit, step

    call open_picture(folder, stem // '.pvd', unit)
    write (unit, '(a)') '<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', '<Collection>'
    do step = 0, steps - 1
      write (unit, '(a, i0, 3a, i0, a)') '<DataSet timestep="', step, '" file="', stem, '_', step, '.vtu"/>'
    end do
    write (unit, '(a)') '</Collection>', '</VTKFile>'
    close (unit)
  end subroutine

  real(dp) function nan_of()
    nan_of = ieee_value(1.0_dp, ieee_quiet_nan)
  end function

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

  !> Gradient in the middle of an element of the shape function of its node i, in the element's own coordinates.
  pure function gradient(kind, i) result(g)
    integer, intent(in) :: kind, i
    real(dp) :: g(3)
    integer :: k

    select case (kind)
    case (picture_tetrahedron10)   ! N = L (2 L - 1), 4 L L', all L = 1/4: the corners have none
      g = 0
      if (i > 4) g = [(count(ends(:, i) == k + 1) - count(ends(:, i) == 1), k=1, 3)]
    case (picture_quad)
      g = [0.25_dp * place(:2, i), 0.0_dp]
    case (picture_hexahedron)
      g = 0.125_dp * place(:, i)
    case default
      g = merge(-0.125_dp, 0.25_dp, i <= 8) * place(:, i)
    end select
  end function

  !> Von Mises stress in the middle of an element, sqrt(3/2 s : s), of the deviator s of the stress, 2 G strain where displacements
  !> are small; plane strain in the plane.
  real(dp) function von_mises(grid, cell, answer)
    type(picture_grid), intent(in) :: grid
    integer, intent(in) :: cell
    type(picture_answer), intent(in) :: answer
    real(dp) :: places(3, 3), moved(3, 3), stress(3, 3), g(3)
    integer :: i, k, node

    places = 0
    moved = 0
    do i = 1, count(grid%corner(:, cell) > 0)
      g = gradient(grid%kind(cell), i)
      node = grid%corner(i, cell)
      do k = 1, 3
        places(:, k) = places(:, k) + grid%xyz(:, node) * g(k)
        moved(:, k) = moved(:, k) + answer%u(:, node) * g(k)
      end do
    end do
    if (grid%kind(cell) == picture_quad) places(3, 3) = 1
    moved = matmul(moved, inverse(places))   ! the gradient of u
    if (answer%large) then
      stress = cauchy(moved, answer)
    else
      stress = answer%shear_modulus * (moved + transpose(moved))
    end if
    stress = stress - (stress(1, 1) + stress(2, 2) + stress(3, 3)) / 3 * identity
    von_mises = sqrt(1.5_dp * sum(stress**2))
  end function

  !> Cauchy's stress F S F'/det F of St. Venant and Kirchhoff's material, from the gradient of u: F = I + grad u, Green's strain
  !> E = (F'F - I)/2, S = lame tr(E) I + 2 G E.
  function cauchy(grad, answer) result(stress)
    real(dp), intent(in) :: grad(3, 3)
    type(picture_answer), intent(in) :: answer
    real(dp) :: stress(3, 3), F(3, 3), strain(3, 3)

    F = identity + grad
    strain = (matmul(transpose(F), F) - identity) / 2
    stress = answer%lame * (strain(1, 1) + strain(2, 2) + strain(3, 3)) * identity + 2 * answer%shear_modulus * strain
    stress = matmul(F, matmul(stress, transpose(F))) / dot_product(F(:, 1), cross(F(:, 2), F(:, 3)))
  end function

  pure function inverse(a) result(b)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: b(3, 3)

    b(1, :) = cross(a(:, 2), a(:, 3))
    b(2, :) = cross(a(:, 3), a(:, 1))
    b(3, :) = cross(a(:, 1), a(:, 2))
    b = b / dot_product(a(:, 1), b(1, :))
  end function

  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3)

    c = cshift(a, 1) * cshift(b, 2) - cshift(a, 2) * cshift(b, 1)
  end function

  !> The elements, then their faces all of whose nodes have a row.
  subroutine add_faces(elements, state, all)
    type(picture_grid), intent(in) :: elements
    integer, intent(in) :: state(:)
    type(picture_grid), intent(out) :: all
    integer, allocatable :: corner(:, :), kind(:), body(:)
    integer :: e, cells

    cells = 0
    allocate (corner(20, 6 * size(elements%kind)), kind(6 * size(elements%kind)), body(6 * size(elements%kind)))
    do e = 1, size(elements%kind)
      select case (elements%kind(e))
      case (picture_quad)
        call add(face_of_quad, picture_line)
      case (picture_hexahedron)
        call add(face_of_hexahedron(:4, :), picture_quad)
      case (picture_tetrahedron10)
        call add(face_of_tetrahedron, picture_triangle6)
      case default
        call add(face_of_hexahedron, picture_quad8)
      end select
    end do
    allocate (all%xyz, source=elements%xyz)
    allocate (all%corner, source=reshape([elements%corner, corner(:, :cells)], [20, size(elements%kind) + cells]))
    allocate (all%kind, source=[elements%kind, kind(:cells)])
    allocate (all%body, source=[elements%body, body(:cells)])

  contains

    subroutine add(faces, face_kind)
      integer, intent(in) :: faces(:, :), face_kind
      integer :: f

      do f = 1, size(faces, 2)
        if (any(state(elements%corner(faces(:, f), e)) < 0)) cycle
        cells = cells + 1
        corner(:, cells) = 0
        corner(:size(faces, 1), cells) = elements%corner(faces(:, f), e)
        kind(cells) = face_kind
        body(cells) = elements%body(e)
      end do
    end subroutine

  end subroutine

  !> Pressure of every face behind the elements: its nodes share their forces among their faces by the area of these. NaN elsewhere.
  subroutine find_pressures(grid, elements, answer, pressure)
    type(picture_grid), intent(in) :: grid
    integer, intent(in) :: elements
    type(picture_answer), intent(in) :: answer
    real(dp), allocatable, intent(out) :: pressure(:)
    real(dp) :: around(size(answer%push)), at(3, size(answer%push)), area
    integer :: c, nodes

    at = grid%xyz
    if (answer%large) at = at + answer%u
    around = 0
    do c = elements + 1, size(grid%kind)
      associate (x => at(:, max(1, grid%corner(:4, c))), nodes_of => pack(grid%corner(:, c), grid%corner(:, c) > 0))
        select case (grid%kind(c))
        case (picture_line)   ! times thickness 1
          area = norm2(x(:, 2) - x(:, 1))
        case (picture_triangle6)
          area = norm2(cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))) / 2
        case default
          area = norm2(cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2))) / 2
        end select
        around(nodes_of) = around(nodes_of) + area
      end associate
    end do
    allocate (pressure(size(grid%kind)), source=nan_of())
    do c = elements + 1, size(grid%kind)
      nodes = count(grid%corner(:, c) > 0)
      pressure(c) = sum(answer%push(grid%corner(:nodes, c)) / around(grid%corner(:nodes, c)))
    end do
  end subroutine

  !> Rows join a node of one body with a face of another: the body that has one node only in every row of these two.
  integer function body_of_nodes(host, dims, row)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: dims, row
    real(dp) :: factor
    integer :: pair(2), other, node

    pair = pair_of(host, row)
    body_of_nodes = pair(1)
    do other = 1, size(host%c)
      if (any(pair_of(host, other) /= pair)) cycle
      call find_node(host, dims, other, pair(1), node, factor)
      if (node == 0) body_of_nodes = pair(2)
    end do
  end function

  !> First and last body of a row.
  function pair_of(host, row) result(pair)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: row
    integer :: pair(2)

    associate (col => host%contact%col(host%contact%row_ptr(row):host%contact%row_ptr(row + 1) - 1))
      pair = [count(host%body%offset < minval(col)), count(host%body%offset < maxval(col))]
    end associate
  end function

  !> The node of a body in a row, 0 if the row has several; the force on it over that of the row.
  subroutine find_node(host, dims, row, body, node, factor)
    type(contact_case), intent(in) :: host
    integer, intent(in) :: dims, row, body
    integer, intent(out) :: node
    real(dp), intent(out) :: factor
    integer :: e

    node = 0
    factor = 0
    do e = host%contact%row_ptr(row), host%contact%row_ptr(row + 1) - 1
      associate (col => host%contact%col(e))
        if (count(host%body%offset < col) /= body) cycle
        if (node > 0 .and. node /= (col - 1) / dims + 1) then
          node = 0
          return
        end if
        node = (col - 1) / dims + 1
        factor = hypot(factor, host%contact%val(e))
      end associate
    end do
  end subroutine

end module
