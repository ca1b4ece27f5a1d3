!> 14 A block given by its elements, which the library cuts into pieces.
!>
!> A block of 1 m x 1 m x 1 m (E = 2.1e5 MN/m^2, nu = .3) is clamped on its face x = 0; 10 MN on its top press it onto a rigid,
!> slightly curved obstacle below it. The host has an assembly loop and equation numbers, in which held unknowns are 0, -1, ...,
!> but no sparse matrix: it passes one element after the other.
!>
!> The example solves the problem twice: cut into eight pieces (option pieces), and as a whole, with equal displacements. The
!> forces of the clamp, which feti_body_held_forces returns, and the forces of the obstacle balance the load.
program block_by_elements
  use demo, only: demo_error, demo_line, demo_stop, demo_value, picture_folder
  use vtu_picture, only: nan_of, picture_answer, picture_grid, picture_hexahedron, picture_mesh
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: n = 10, line = n + 1, nodes = line**3, elements = n**3, own = 24

  real(dp), parameter :: young = 2.1e5_dp, poisson = 0.3_dp   ! MN/m^2, -

  !> Answer of one solve: u by equations; forces, gaps, states of the rows on the nodes of the bottom; forces of the clamp, piece of
  !> every equation.
  type :: answer
    real(dp), allocatable :: u(:), contact(:), gap(:), clamp(:)
    integer, allocatable :: piece(:), state(:)
    integer :: pieces
    type(feti_info) :: info
  end type

  integer :: equation(3, nodes), unknowns, held
  type(answer) :: cut, whole
  real(dp) :: contact, clamp
  integer :: a, d

  unknowns = 0
  held = 0
  do a = 1, nodes
    do d = 1, 3
      if (mod(a - 1, line) == 0) then
        equation(d, a) = -held
        held = held + 1
      else
        unknowns = unknowns + 1
        equation(d, a) = unknowns
      end if
    end do
  end do
  call solve(8, cut)
  call solve(1, whole)

  contact = sum(cut%contact)
  clamp = sum(cut%clamp(3::3)) ! the held unknowns of a node are x, y, z
  call demo_value('elements', real(elements, dp), '-')
  call demo_value('held unknowns', real(held, dp), '-')
  call demo_value('pieces', real(cut%pieces, dp), '-')
  call demo_value('pieces of the whole block', real(whole%pieces, dp), '-')
  call demo_value('load', -10.0_dp, 'MN')
  call demo_value('force of the obstacle', contact, 'MN')
  call demo_value('force of the clamp', clamp, 'MN')
  call demo_value('nodes in contact', real(count(cut%contact > 1e-6_dp), dp), '-')
  call demo_value('largest settlement', -1e6_dp * minval([(at(cut%u, a, 3), a = 1, nodes)]), 'um')
  call draw(picture_folder(), cut)
  call demo_line('14_block_by_elements', cut%info, demo_error(cut%u, whole%u), whole%info%status == FETI_OK .and. &
    cut%pieces == 8 .and. whole%pieces == 1 .and. abs(contact + clamp - 10) <= 1e-6_dp)

contains

  !> Node (i, j, k) of the block, i, j, k from 0.
  pure integer function node(i, j, k)
    integer, intent(in) :: i, j, k

    node = i + line * (j + line * k) + 1
  end function

  !> Its place, m.
  pure function place(a) result(x)
    integer, intent(in) :: a
    real(dp) :: x(3)

    x = real([mod(a - 1, line), mod((a - 1) / line, line), (a - 1) / line**2], dp) / n
  end function

  !> Corner c of element e; it lies at bit 0, 1, 2 of c along x, y, z.
  pure integer function corner(e, c)
    integer, intent(in) :: e, c

    corner = node(mod(e - 1, n) + ibits(c, 0, 1), mod((e - 1) / n, n) + ibits(c, 1, 1), (e - 1) / n**2 + ibits(c, 2, 1))
  end function

  !> Stiffness of a cube of edge 1 / n, 2 x 2 x 2 Gauss points.
  pure subroutine element(ke)
    real(dp), intent(out) :: ke(own, own)
    real(dp), parameter :: young = 2.1e5_dp, nu = 0.3_dp
    real(dp), parameter :: mu = young / (2 * (1 + nu)), la = young * nu / ((1 + nu) * (1 - 2 * nu))
    real(dp), parameter :: weight = 1 / (8.0_dp * n)
    real(dp) :: g(3, 0:7), k
    integer :: point, c, a, b, p, q

    ke = 0
    do point = 0, 7
      do c = 0, 7
        do a = 0, 2
          g(a + 1, c) = 2 * ibits(c, a, 1) - 1
          do b = 0, 2
            if (b /= a) g(a + 1, c) = g(a + 1, c) * 0.5_dp * (1 + merge(1, -1, ibits(c, b, 1) == ibits(point, b, 1)) / sqrt(3.0_dp))
          end do
        end do
      end do
      do q = 0, own - 1
        do p = 0, own - 1
          associate (a => g(:, p / 3), b => g(:, q / 3))
            k = la * a(mod(p, 3) + 1) * b(mod(q, 3) + 1) + mu * a(mod(q, 3) + 1) * b(mod(p, 3) + 1)
            if (mod(p, 3) == mod(q, 3)) k = k + mu * (a(1) * b(1) + a(2) * b(2) + a(3) * b(3))
          end associate
          ke(p + 1, q + 1) = ke(p + 1, q + 1) + weight * k
        end do
      end do
    end do
  end subroutine

  !> Where every equation is: the cut and the rigid motions of the pieces follow from it.
  subroutine give_coordinates(problem, body)
    type(feti_problem), intent(in) :: problem
    integer, intent(in) :: body
    integer :: label(unknowns), dir(unknowns), a, d
    real(dp) :: xyz(3, unknowns)

    do a = 1, nodes
      do d = 1, 3
        if (equation(d, a) < 1) cycle
        label(equation(d, a)) = a
        dir(equation(d, a)) = d
        xyz(:, equation(d, a)) = place(a)
      end do
    end do
    call feti_body_coordinates(problem, body, label, dir, xyz)
  end subroutine

  !> Equations of the 24 unknowns of every element, then its matrix: the assembly loop of the host.
  subroutine give_elements(problem, body)
    type(feti_problem), intent(in) :: problem
    integer, intent(in) :: body
    integer :: ptr(elements + 1), e, c
    integer, allocatable :: dof(:)
    real(dp) :: ke(own, own)

    allocate (dof(own * elements))
    ptr = [(own * e + 1, e = 0, elements)]
    do e = 1, elements
      do c = 0, 7
        dof(ptr(e) + 3 * c:ptr(e) + 3 * c + 2) = equation(:, corner(e, c))
      end do
    end do
    call feti_body_mesh(problem, body, ptr, dof)
    do e = 1, elements
      call element(ke)
      call feti_body_element(problem, body, e, ke)
    end do
  end subroutine

  !> 10 MN down on the free nodes of the top, rows -u_z <= gap on the free nodes of the bottom; held nodes have no load and no row.
  subroutine give_load_and_obstacle(problem, body)
    type(feti_problem), intent(in) :: problem
    integer, intent(in) :: body
    real(dp) :: load(unknowns), gap
    integer :: i, j

    load = 0
    do j = 0, n
      do i = 1, n
        gap = 1e-5_dp + 1e-4_dp * ((real(i, dp) / n - 0.7_dp)**2 + (real(j, dp) / n - 0.5_dp)**2)
        load(equation(3, node(i, j, n))) = -10.0_dp / (n * line)
        call feti_rows_add(problem, FETI_INEQUALITY, [1, 2], [body], [equation(3, node(i, j, 0))], [-1.0_dp], [gap])
      end do
    end do
    call feti_body_load(problem, body, load)
  end subroutine

  subroutine solve(pieces, found)
    integer, intent(in) :: pieces
    type(answer), intent(out) :: found
    type(feti_problem) :: problem
    type(feti_body_facts) :: facts
    integer :: body

    allocate (found%u(unknowns), found%contact(n * line), found%gap(n * line), found%state(n * line), found%clamp(held), &
      found%piece(unknowns))
    call feti_problem_create(problem)
    call feti_set(problem, 'pieces', pieces)
    call feti_body_add(problem, unknowns, body)
    call give_coordinates(problem, body)
    call give_elements(problem, body)
    call give_load_and_obstacle(problem, body)
    call feti_solve(problem, found%info)
    call feti_displacement(problem, body, found%u)
    call feti_multipliers(problem, FETI_INEQUALITY, found%contact)
    call feti_gaps(problem, found%gap)
    call feti_active(problem, found%state)
    call feti_body_held_forces(problem, body, found%clamp)
    call feti_body_info(problem, body, facts)
    call feti_body_pieces(problem, body, found%piece)
    found%pieces = int(facts%pieces)
    call feti_problem_destroy(problem)
  end subroutine

  !> Value of unknown d of node a, 0 where it is held.
  pure real(dp) function at(u, a, d)
    real(dp), intent(in) :: u(:)
    integer, intent(in) :: a, d

    at = 0
    if (equation(d, a) > 0) at = u(equation(d, a))
  end function

  !> The elements with displacements, stresses and pieces, and what the contact does to them.
  subroutine draw(folder, found)
    character(len=*), intent(in) :: folder
    type(answer), intent(in) :: found
    integer, parameter :: around(8) = [0, 1, 3, 2, 4, 5, 7, 6] ! VTK goes around the bottom, then around the top
    type(picture_grid) :: grid
    type(picture_answer) :: shown
    integer :: a, c, d, e, row

    allocate (grid%xyz(3, nodes), shown%u(3, nodes), shown%push(nodes), shown%gap(nodes), shown%state(nodes))
    allocate (grid%corner(20, elements), grid%kind(elements), grid%body(elements), shown%piece(elements))
    allocate (shown%force(3, nodes), source=0.0_dp)
    shown%shear_modulus = young / (2 * (1 + poisson))
    do a = 1, nodes
      grid%xyz(:, a) = place(a)
      shown%u(:, a) = [(at(found%u, a, d), d = 1, 3)]
    end do
    shown%push = 0
    shown%gap = nan_of()
    shown%state = -1
    do row = 1, n * line ! on the bottom, whose lines of nodes begin with a held one
      a = row + 1 + (row - 1) / n
      shown%force(3, a) = found%contact(row)
      shown%push(a) = found%contact(row)
      shown%gap(a) = found%gap(row)
      shown%state(a) = found%state(row)
    end do
    grid%corner = 0
    grid%kind = picture_hexahedron
    grid%body = 1
    do e = 1, elements
      grid%corner(:8, e) = [(corner(e, around(c)), c = 1, 8)]
      ! An unknown of several pieces has the first of them, an unknown inside a piece has its own.
      shown%piece(e) = 0
      do c = 1, 8
        d = equation(1, grid%corner(c, e))
        if (d > 0) shown%piece(e) = max(shown%piece(e), found%piece(d) - 1)
      end do
    end do
    call picture_mesh(folder, 'block_in_pieces_fortran.vtu', grid, shown)
  end subroutine

end program
