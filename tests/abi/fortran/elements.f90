!> Bodies by their elements, whole and cut, against the same bodies by matrices; input that is refused with its element and
!> loses nothing. Everything counts from 1.
!>
!> Body 1: a chain of 8 springs on the ground, k_e = 100 + 10 (e - 1); unknown i is the upper end of spring i, the ground is the
!> held unknown 1, which the connectivity has as 0. Element 9 is a spring of 5 between unknown 4 and the ground, with one unknown.
!> Body 2: a chain of 6 such springs, floating, pushed by 10 at its far end.
!> Row 1: u(8) of body 1 - u(1) of body 2 <= 0.1, so that lambda = 10.
program elements
  use case_problem, only: require
  use feti_contact
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  integer, parameter :: dp = kind(1.0d0), post_n = 8, bar_n = 7, pieces = 3
  integer, parameter :: springs(2) = [8, 6], unknowns(2) = [post_n, bar_n], number_of(2) = [9, 6]
  integer, parameter :: by_matrix = 0, one_by_one = 1, full = 2, lower = 3, upper = 4
  real(dp) :: u(post_n + bar_n), wanted(post_n + bar_n)
  type(feti_problem) :: p

  call begin(p, 0)
  call give(p, by_matrix, 1.0_dp)
  call solved(p, wanted)
  call feti_problem_destroy(p)
  call every_form
  call a_second_pass
  call refused

contains

  !> Bodies, load, row; no matrix yet.
  subroutine begin(p, wished)
    type(feti_problem), intent(out) :: p
    integer, intent(in) :: wished
    real(dp) :: load(bar_n), x(1, post_n)
    integer :: body, i, k

    call feti_problem_create(p)
    call feti_set(p, 'pieces', wished)
    do k = 1, 2
      call feti_body_add(p, unknowns(k), body)
      x(1, :) = [(real(i + 8 * (k - 1), dp), i = 1, post_n)]
      call feti_body_coordinates(p, body, [(i, i = 1, unknowns(k))], [(1, i = 1, unknowns(k))], x(:, :unknowns(k)))
    end do
    load = 0
    load(bar_n) = -10
    call feti_body_load(p, 2, load)
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [1, 2], [post_n, 1], [1.0_dp, -1.0_dp], [0.1_dp])
  end subroutine

  !> Matrix of element e of a body: a spring, or the one to the ground.
  pure function element(body, e) result(ke)
    integer, intent(in) :: body, e
    real(dp), allocatable :: ke(:, :)

    if (e > springs(body)) then
      ke = reshape([5.0_dp], [1, 1])
    else
      ke = (100 + 10 * (e - 1)) * reshape([1.0_dp, -1.0_dp, -1.0_dp, 1.0_dp], [2, 2])
    end if
  end function

  !> What the elements of a body join.
  pure subroutine connectivity(body, ptr, dof)
    integer, intent(in) :: body
    integer, allocatable, intent(out) :: ptr(:), dof(:)
    integer :: e

    ptr = [(2 * e - 1, e = 1, springs(body) + 1)]
    dof = [([e - 2 + body, e - 1 + body], e = 1, springs(body))]
    if (body == 1) then
      ptr = [ptr, ptr(size(ptr)) + 1]
      dof = [dof, 4]
    end if
  end subroutine

  !> Both bodies in a form, every element `factor` times as stiff.
  subroutine give(p, form, factor)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: form
    real(dp), intent(in) :: factor
    integer :: body

    do body = 1, 2
      if (form == by_matrix) then
        call give_matrix(p, body)
      else
        call give_mesh(p, body, form)
        call give_elements(p, body, form, factor)
      end if
    end do
  end subroutine

  subroutine give_matrix(p, body)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, allocatable :: ptr(:), dof(:)
    real(dp) :: k(unknowns(body), unknowns(body)), ke(2, 2)
    integer :: e, i, j

    call connectivity(body, ptr, dof)
    k = 0
    do e = 1, number_of(body)
      ke(:ptr(e + 1) - ptr(e), :ptr(e + 1) - ptr(e)) = element(body, e)
      do j = 1, ptr(e + 1) - ptr(e)
        do i = 1, ptr(e + 1) - ptr(e)
          associate (row => dof(ptr(e) + i - 1), column => dof(ptr(e) + j - 1))
            if (row > 0 .and. column > 0) k(row, column) = k(row, column) + ke(i, j)
          end associate
        end do
      end do
    end do
    call feti_body_stiffness(p, body, k, FETI_FULL)
  end subroutine

  subroutine give_mesh(p, body, form)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, form
    integer, allocatable :: ptr(:), dof(:)

    call connectivity(body, ptr, dof)
    if (form == full .or. form == upper) then
      call feti_body_mesh(p, body, int(ptr, int64), int(dof, int64))
    else
      call feti_body_mesh(p, body, ptr, dof)
    end if
  end subroutine

  !> A pass over all elements.
  subroutine give_elements(p, body, form, factor)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, form
    real(dp), intent(in) :: factor
    real(dp) :: block(2, 2, 4), one(2, 2)
    real(dp), allocatable :: ke(:)
    integer(int64) :: nnz
    integer :: e

    if (form == one_by_one) then
      do e = number_of(body), 1, -1
        call feti_body_element(p, body, e, factor * element(body, e))
      end do
    else if (form == full) then
      do e = 1, 4
        block(:, :, e) = factor * element(body, e)
      end do
      call feti_body_elements(p, body, 1, block)
      do e = 5, number_of(body)
        ke = factor * reshape(element(body, e), [size(element(body, e))])
        call feti_body_elements(p, body, e, 1, ke, FETI_FULL)
      end do
    else
      allocate (ke(0))
      do e = 1, number_of(body)
        if (e > springs(body)) then
          ke = [ke, 5 * factor]
        else
          one = factor * element(body, e)
          ke = [ke, one(1, 1), one(2, 1), one(2, 2)]
        end if
      end do
      call feti_body_elements_size(p, body, 1, number_of(body), merge(FETI_LOWER, FETI_UPPER, form == lower), nnz)
      call require(nnz == size(ke), 'wrong size of a block')
      call feti_body_elements(p, body, 1, number_of(body), ke, merge(FETI_LOWER, FETI_UPPER, form == lower))
    end if
  end subroutine

  subroutine solved(p, u)
    type(feti_problem), intent(in) :: p
    real(dp), intent(out) :: u(:)
    real(dp) :: lambda(1)

    call feti_solve(p)
    call feti_displacement(p, 1, u(:post_n))
    call feti_displacement(p, 2, u(post_n + 1:))
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(abs(lambda(1) - 10) <= 1e-8_dp, 'wrong force')
  end subroutine

  subroutine every_form
    type(feti_body_facts) :: facts
    integer :: form, wished, piece(post_n), part
    real(dp) :: r(2)

    do form = one_by_one, upper
      do wished = 1, pieces, pieces - 1
        call begin(p, wished)
        call give(p, form, 1.0_dp)
        call solved(p, u)
        call require(all(abs(u - wanted) <= 1e-9_dp), 'elements and matrix have different answers')
        call feti_body_info(p, 1, facts)
        call require(facts%pieces == wished, 'wrong number of pieces')
        call feti_body_pieces(p, 1, piece)
        call require(all([(any(piece == part), part = 1, wished)]) .and. all(piece >= 1 .and. piece <= wished), 'wrong pieces')
        r = 7
        call feti_body_held_forces(p, 1, r)
        call require(abs(r(1) + 100 * u(1)) <= 1e-9_dp .and. abs(r(2)) <= 0, 'wrong force of the ground')
        call feti_problem_destroy(p)
      end do
    end do
  end subroutine

  subroutine a_second_pass
    type(feti_info) :: first, second
    real(dp) :: lambda(1)

    call begin(p, pieces)
    call give(p, one_by_one, 1.0_dp)
    call feti_solve(p, first)
    call give_elements(p, 1, lower, 2.0_dp)
    call feti_solve(p, second)
    call feti_displacement(p, 1, u(:post_n))
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(all(abs(2 * u(:post_n) - wanted(:post_n)) <= 1e-9_dp), 'a body twice as stiff')
    call require(second%analyses == first%analyses, 'new values on an old pattern were analysed')
    call feti_problem_destroy(p)
  end subroutine

  subroutine refused
    integer, allocatable :: ptr(:), dof(:)
    real(dp) :: ke(2, 2), bad(2, 2), x(bar_n, 1)
    integer :: stat, e, piece(post_n)

    call begin(p, pieces)
    ke = element(1, 2)
    call feti_body_element(p, 1, 2, ke, stat)
    call named(stat, FETI_STATE, 0)
    call feti_body_pieces(p, 1, piece, stat)
    call named(stat, FETI_STATE, 0)
    call connectivity(1, ptr, dof)
    call feti_body_mesh(p, 1, ptr(:0), dof, stat)
    call require(stat == FETI_ARGUMENT - 4, 'no positions')
    call feti_body_mesh(p, 1, ptr, dof(:3), stat)
    call require(stat == FETI_ARGUMENT - 5, 'positions behind the end')
    call feti_body_mesh(p, 1, ptr, dof + 1, stat)
    call named(stat, FETI_ARGUMENT - 5, 8)
    call feti_body_mesh(p, 1, ptr - 1, dof, stat)
    call named(stat, FETI_ARGUMENT - 4, 1)
    call feti_body_mesh(p, 1, ptr, dof)
    do e = 9, 3, -1
      call feti_body_element(p, 1, e, element(1, e))
    end do
    call feti_body_element(p, 1, 1, element(1, 1))
    call feti_body_element(p, 1, 3, ke, stat)
    call named(stat, FETI_STATE, 3)
    bad = ke
    bad(1, 2) = 0
    call feti_body_element(p, 1, 2, bad, stat)
    call named(stat, FETI_ARGUMENT - 5, 2)
    bad(1, 2) = ieee_value(bad(1, 2), ieee_quiet_nan)
    call feti_body_element(p, 1, 2, bad, stat)
    call named(stat, FETI_ARGUMENT - 5, 2)
    call feti_body_element(p, 1, 2, ke(:, :1), stat)
    call require(stat == FETI_ARGUMENT - 5, 'a matrix that is not square')
    call feti_body_element(p, 1, 2, ke(:1, :1), stat)
    call named(stat, FETI_ARGUMENT - 4, 2)
    call feti_body_element(p, 1, 0, ke, stat)
    call named(stat, FETI_ARGUMENT - 3, 0)
    call feti_body_element(p, 1, 10, ke, stat)
    call named(stat, FETI_ARGUMENT - 3, 0)
    call feti_body_elements(p, 1, 2, 1, [1.0_dp, 2.0_dp], FETI_LOWER, stat)
    call require(stat == FETI_ARGUMENT - 5, 'a block of another size')
    call feti_body_elements(p, 1, 10, 1, [1.0_dp], FETI_LOWER, stat)
    call named(stat, FETI_ARGUMENT - 3, 0)
    call feti_body_elements(p, 1, 8, 3, [1.0_dp], FETI_LOWER, stat)
    call require(stat == FETI_ARGUMENT - 4, 'a block beyond the last element')
    call feti_body_elements(p, 1, 2, 1, [1.0_dp], 9, stat)
    call require(stat == FETI_ARGUMENT - 6, 'storage 9')
    call feti_body_elements(p, 1, 2, reshape(ke, [1, 4, 1]), stat)
    call require(stat == FETI_ARGUMENT - 5, 'matrices that are not square')
    call feti_solve(p, stat=stat)
    call named(stat, FETI_STATE, 2)
    call feti_body_element(p, 1, 2, ke)
    call give_mesh(p, 2, lower)
    call give_elements(p, 2, lower, 1.0_dp)
    call solved(p, u)
    call require(all(abs(u - wanted) <= 1e-9_dp), 'refused input has changed the answer')
    x = 0
    call feti_body_kplus(p, 2, x, x, stat)
    call require(stat == FETI_STATE, 'K+ of a body that is cut')
    call feti_problem_destroy(p)
  end subroutine

  !> This status, and an error that names this element.
  subroutine named(stat, status, e)
    integer, intent(in) :: stat, status, e
    type(feti_error_detail) :: detail
    character(len=:), allocatable :: text

    call feti_last_error(text)
    call feti_last_error_detail(detail)
    call require(stat == status .and. detail%element == e, text)
  end subroutine

end program
