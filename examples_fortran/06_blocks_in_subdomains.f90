!> 06 Two blocks, cut into squares: the secondary decomposition (11) of the paper.
!>
!> A block of 2 m x 1 m is clamped to the ground, a block of 2 m x 2 m lies on it and floats (plane strain,
!> E = 1e4 MN/m^2, nu = .25, 1 m thick); the top of the lower block is slightly hollow. 1 MN/m presses on the
!> left part of the upper block, so that the contact opens on the right.
!>
!> The example solves the problem twice: as two bodies, and as six squares with equal matrices. Equality rows H u = 0 join the
!> copies of a node; their multipliers may have any sign. At a node where four squares meet, all six pairs are joined, more
!> than needed: redundant rows are allowed. Both solutions have equal contact forces.
!>
!> The clamp is also given by equality rows, and so is one node that keeps the upper block from sliding.
program blocks_in_subdomains
  use demo
  use feti_contact
  use, intrinsic :: iso_fortran_env, only: int32
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer, parameter :: n = 6              ! elements along 1 m
  integer, parameter :: line = 2 * n + 1   ! nodes along 2 m
  integer, parameter :: squares = 6, most_copies = 4

  !> A rectangle of elements: its first node on the common grid, elements along x and y. Node (i, j) of it carries the
  !> unknowns 2 ((i-i0) (ny+1) + j-j0) + 1 and the next.
  type :: rectangle
    integer :: i0, j0, nx, ny
  end type

  type(rectangle), parameter :: whole(2) = [rectangle(0, 0, 2 * n, n), rectangle(0, n, 2 * n, 2 * n)]
  type(rectangle), parameter :: cut(squares) = [rectangle(0, 0, n, n), rectangle(n, 0, n, n), &
    rectangle(0, n, n, n), rectangle(n, n, n, n), rectangle(0, 2 * n, n, n), rectangle(n, 2 * n, n, n)]
  type(feti_info) :: info_whole, info_cut
  real(dp) :: by_whole(line), by_cut(line)

  call solve(whole, 1, info_whole, by_whole)
  call solve(cut, 2, info_cut, by_cut)

  call demo_value('equality rows of two blocks', real(info_whole%equalities, dp), '-')
  call demo_value('equality rows of six squares', real(info_cut%equalities, dp), '-')
  call demo_value('contact force', sum(by_cut), 'MN')
  call demo_value('nodes in contact', real(count(by_cut > 1e-6_dp), dp), '-')
  call demo_value('energy of two blocks', 1e6_dp * info_whole%energy, 'J')
  call demo_value('energy of six squares', 1e6_dp * info_cut%energy, 'J')
  call demo_line('06_blocks_in_subdomains', info_cut, demo_error(by_cut, by_whole), info_whole%status == FETI_OK)

contains

  !> parts(:lower) make the lower block, the others the upper one.
  subroutine solve(parts, lower, info, lambda)
    type(rectangle), intent(in) :: parts(:)
    integer, intent(in) :: lower
    type(feti_info), intent(out) :: info
    real(dp), intent(inout) :: lambda(:)
    type(feti_problem) :: problem
    integer :: p

    call feti_problem_create(problem)
    do p = 1, size(parts)
      call add_body(problem, parts(p))
    end do
    call add_equalities(problem, parts, lower)
    call add_contact(problem, parts, lower)
    call feti_solve(problem, info)
    call feti_multipliers(problem, FETI_INEQUALITY, lambda)
    call feti_problem_destroy(problem)
  end subroutine

  !> Unknown along x of node (i, j) of the grid in the rectangle, 0 where the node lies elsewhere.
  pure integer function unknown(r, i, j)
    type(rectangle), intent(in) :: r
    integer, intent(in) :: i, j
    integer :: k, l

    k = i - r%i0
    l = j - r%j0
    unknown = 0
    if (k >= 0 .and. l >= 0 .and. k <= r%nx .and. l <= r%ny) unknown = 2 * (k * (r%ny + 1) + l) + 1
  end function

  !> Stiffness of a square element, plane strain, 2 x 2 Gauss points, independent of the size. Corners (0,0), (1,0),
  !> (0,1), (1,1).
  function element() result(k)
    real(dp), parameter :: young = 1e4_dp, nu = 0.25_dp
    real(dp), parameter :: mu = young / (2 * (1 + nu)), la = young * nu / ((1 + nu) * (1 - 2 * nu))
    real(dp), parameter :: sign_of(0:1) = [-1.0_dp, 1.0_dp]
    real(dp) :: k(8, 8), g(2, 0:3), other
    integer :: point, c, a, p, q, d, e

    k = 0
    do point = 0, 3
      do c = 0, 3
        do a = 0, 1
          other = sign_of(ibits(c, 1 - a, 1)) * sign_of(ibits(point, 1 - a, 1))
          g(a + 1, c) = sign_of(ibits(c, a, 1)) * 0.5_dp * (1 + other / sqrt(3.0_dp))
        end do
      end do
      do p = 1, 8
        do q = 1, 8
          d = 1 + mod(p - 1, 2)
          e = 1 + mod(q - 1, 2)
          associate (u => g(:, (p - 1) / 2), v => g(:, (q - 1) / 2))
            k(p, q) = k(p, q) + 0.25_dp * (la * u(d) * v(e) + mu * u(e) * v(d))
            if (d == e) k(p, q) = k(p, q) + 0.25_dp * mu * dot_product(u, v)
          end associate
        end do
      end do
    end do
  end function

  !> Adds the rectangle as a body: dense matrix, coordinates in place of a null space, load on y = 3 m for x < .8 m.
  subroutine add_body(problem, r)
    type(feti_problem), intent(in) :: problem
    type(rectangle), intent(in) :: r
    real(dp), allocatable :: k(:, :), load(:), xyz(:, :)
    integer(int32), allocatable :: node(:), dir(:)
    real(dp) :: ke(8, 8)
    integer :: unknowns, body, i, j, c, d, at, dof(8)

    unknowns = 2 * (r%nx + 1) * (r%ny + 1)
    allocate (k(unknowns, unknowns), load(unknowns), xyz(2, unknowns), node(unknowns), dir(unknowns))
    k = 0
    load = 0
    ke = element()
    do i = r%i0, r%i0 + r%nx - 1
      do j = r%j0, r%j0 + r%ny - 1
        do c = 0, 3
          dof(2 * c + 1) = unknown(r, i + mod(c, 2), j + c / 2)
          dof(2 * c + 2) = dof(2 * c + 1) + 1
        end do
        k(dof, dof) = k(dof, dof) + ke
      end do
    end do
    do i = r%i0, r%i0 + r%nx
      do j = r%j0, r%j0 + r%ny
        do d = 1, 2
          at = unknown(r, i, j) + d - 1
          node(at) = i * (3 * n + 1) + j + 1
          dir(at) = d
          xyz(:, at) = [real(i, dp) / n, real(j, dp) / n]
          ! A node on the cut x = 1 m is not loaded: it needs no decision whose the load is.
          if (d == 2 .and. j == 3 * n .and. 5 * i < 4 * n) load(at) = -1.0_dp / n
        end do
      end do
    end do
    call feti_body_add(problem, unknowns, body)
    call feti_body_stiffness(problem, body, k, FETI_LOWER)
    call feti_body_coordinates(problem, body, node, dir, xyz)
    call feti_body_load(problem, body, load)
  end subroutine

  !> Adds one row u_a - u_b (b = 0: u_a alone) along direction d of node (i, j).
  subroutine add_row(problem, kind, parts, pair, i, j, d, rhs)
    type(feti_problem), intent(in) :: problem
    integer(int32), intent(in) :: kind
    type(rectangle), intent(in) :: parts(:)
    integer, intent(in) :: pair(2), i, j, d
    real(dp), intent(in) :: rhs
    integer :: entries, dof(2)

    entries = count(pair > 0)
    dof(1) = unknown(parts(pair(1)), i, j) + d - 1
    if (entries == 2) dof(2) = unknown(parts(pair(2)), i, j) + d - 1
    associate (val => [1.0_dp, -1.0_dp])
      call feti_rows_add(problem, kind, [1, entries + 1], pair(:entries), dof(:entries), val(:entries), [rhs])
    end associate
  end subroutine

  !> The parts from `first` to `last` that have node (i, j); how many.
  subroutine copies(parts, first, last, i, j, found, number)
    type(rectangle), intent(in) :: parts(:)
    integer, intent(in) :: first, last, i, j
    integer, intent(out) :: found(most_copies), number
    integer :: p

    number = 0
    found = 0
    do p = first, last
      if (unknown(parts(p), i, j) > 0) then
        number = number + 1
        found(number) = p
      end if
    end do
  end subroutine

  !> H u = 0: all pairs of copies within a block; the clamp at y = 0; one node of the upper block along x.
  subroutine add_equalities(problem, parts, lower)
    type(feti_problem), intent(in) :: problem
    type(rectangle), intent(in) :: parts(:)
    integer, intent(in) :: lower
    integer :: block, i, j, a, b, d, number, found(most_copies)

    do block = 0, 1
      do i = 0, line - 1
        do j = 0, 3 * n
          call copies(parts, merge(lower + 1, 1, block == 1), merge(size(parts), lower, block == 1), i, j, found, number)
          do a = 1, number
            do b = a + 1, number
              do d = 1, 2
                call add_row(problem, FETI_EQUALITY, parts, [found(a), found(b)], i, j, d, 0.0_dp)
              end do
            end do
          end do
          do d = 1, 2
            if (block == 0 .and. j == 0) call add_row(problem, FETI_EQUALITY, parts, [found(1), 0], i, j, d, 0.0_dp)
          end do
        end do
      end do
    end do
    call copies(parts, lower + 1, size(parts), 0, n, found, number)
    call add_row(problem, FETI_EQUALITY, parts, [found(1), 0], 0, n, 1, 0.0_dp)
  end subroutine

  !> Rows along y on y = 1 m: the lower block stays below the upper one; the gap grows towards the middle.
  subroutine add_contact(problem, parts, lower)
    type(feti_problem), intent(in) :: problem
    type(rectangle), intent(in) :: parts(:)
    integer, intent(in) :: lower
    integer :: i, number, below(most_copies), above(most_copies)
    real(dp) :: x

    do i = 0, line - 1
      x = real(i, dp) / n
      call copies(parts, 1, lower, i, n, below, number)
      call copies(parts, lower + 1, size(parts), i, n, above, number)
      call add_row(problem, FETI_INEQUALITY, parts, [below(1), above(1)], i, n, 2, 2e-5_dp * x * (2 - x))
    end do
  end subroutine

end program
