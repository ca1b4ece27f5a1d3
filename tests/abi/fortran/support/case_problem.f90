!> What the drivers share: handing a whole case to the library, and stopping with a text when a claim does not hold.
module case_problem
  use case_reader
  use feti_contact
  implicit none
  private
  public :: require, largest, data_folder, choose_cases, spring_and_block, handed_over
  public :: hand_over, hand_over_body, hand_over_rows, body_of, displacements, number, stiffness_times

  !> Where a body gets its null space from: its basis as the exact one, or the coordinates of its unknowns.
  integer, parameter, public :: from_basis = 1, from_coordinates = 2, from_nothing = 3

contains

  !> Ends the program with exit code 1 and the text when the condition does not hold.
  subroutine require(condition, text)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: text

    if (condition) return
    print '(a)', text
    error stop 1
  end subroutine

  !> max |x_i|, 0 for an empty array.
  pure real(dp) function largest(x)
    real(dp), intent(in) :: x(:)

    largest = 0
    if (size(x) > 0) largest = maxval(abs(x))
  end function

  !> A figure for a failure text.
  function number(x) result(text)
    real(dp), intent(in) :: x
    character(len=10) :: text

    write (text, '(es10.3)') x
  end function

  !> First command argument, or build/data.
  function data_folder() result(folder)
    character(len=:), allocatable :: folder
    character(len=1000) :: argument

    call get_command_argument(1, argument)
    folder = 'build/data'
    if (len_trim(argument) > 0) folder = trim(argument)
  end function

  !> The case names of the command line behind the data folder, or all of the given ones.
  subroutine choose_cases(all_cases, names)
    character(len=*), intent(in) :: all_cases(:)
    character(len=20), allocatable, intent(out) :: names(:)
    integer :: i

    if (command_argument_count() < 2) then
      allocate (names(size(all_cases)))
      names(:) = all_cases
      return
    end if
    allocate (names(command_argument_count() - 1))
    do i = 1, size(names)
      call get_command_argument(i + 1, names(i))
    end do
  end subroutine

  !> A problem by hand: a spring k(1) of one unknown at a wall, held, and a block of two unknowns joined by k(2), floating, behind
  !> a gap; force: on the far end of the block, towards the spring where negative. Bodies 1 and 2 of a new problem, or with
  !> `more` the next ones of p; with matrices = .false. without their stiffness.
  subroutine spring_and_block(p, k, force, gap, more, matrices)
    type(feti_problem), intent(inout) :: p
    real(dp), intent(in) :: k(2), force, gap
    logical, intent(in), optional :: more, matrices
    real(dp) :: held(1, 0)
    integer :: spring, block

    if (.not. present(more)) call feti_problem_create(p)
    call feti_body_add(p, 1, spring)
    call feti_body_add(p, 2, block)
    if (.not. present(matrices)) then
      call feti_body_stiffness(p, spring, [1, 2], [1], k(1:1), FETI_LOWER)
      call feti_body_stiffness(p, block, [1, 2, 4], [1, 1, 2], k(2) * [1, -1, 1], FETI_LOWER)
    end if
    call feti_body_null_space(p, spring, held, FETI_EXACT)
    call feti_body_null_space(p, block, reshape([1.0_dp, 1.0_dp], [2, 1]), FETI_EXACT)
    call feti_body_load(p, block, [0.0_dp, force])
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [spring, block], [1, 1], [1.0_dp, -1.0_dp], [gap])
  end subroutine

  !> A new problem with the whole case, its null spaces given.
  subroutine handed_over(p, this)
    type(feti_problem), intent(out) :: p
    type(contact_case), intent(in) :: this

    call feti_problem_create(p)
    call hand_over(p, this, from_basis)
  end subroutine

  !> Bodies, loads, contact rows and equality rows of a case.
  subroutine hand_over(p, this, source)
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    integer, intent(in) :: source
    integer :: b, body

    do b = 1, size(this%body)
      call hand_over_body(p, this, b, source, body)
      call require(body == b, 'bodies are not numbered from 1')
    end do
    call hand_over_rows(p, FETI_INEQUALITY, this%contact, this%c)
    call hand_over_rows(p, FETI_EQUALITY, this%equality, this%h)
  end subroutine

  !> Body b of a case: stiffness (dense where it is full), null space, load.
  subroutine hand_over_body(p, this, b, source, body)
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    integer, intent(in) :: b, source
    integer, intent(out) :: body
    integer :: dim, storage

    associate (part => this%body(b), k => this%body(b)%k)
      storage = merge(FETI_LOWER, FETI_FULL, k%symmetric)
      call feti_body_add(p, part%n, body)
      if (is_dense(k)) then
        call feti_body_stiffness(p, body, dense_of(k), storage)
      else
        call feti_body_stiffness(p, body, k%row_ptr, k%col, k%val, storage)
      end if
      if (source == from_coordinates) then
        dim = merge(3, 2, maxval(this%dir) == 3)
        call feti_body_coordinates(p, body, this%node(part%offset + 1:part%offset + part%n), &
          this%dir(part%offset + 1:part%offset + part%n), this%xyz(1:dim, part%offset + 1:part%offset + part%n))
      else if (source == from_basis) then
        call feti_body_null_space(p, body, part%null_space, FETI_EXACT)
      end if
      call feti_body_load(p, body, this%f(part%offset + 1:part%offset + part%n))
    end associate
  end subroutine

  !> Rows over the unknowns of all bodies one after the other; nothing where there are none.
  subroutine hand_over_rows(p, kind, rows, rhs)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: kind
    type(sparse_matrix), intent(in) :: rows
    real(dp), intent(in) :: rhs(:)
    integer :: first

    if (rows%rows == 0) return
    call feti_rows_add(p, kind, rows%row_ptr, rows%col, rows%val, rhs, first)
    call require(first == 1, 'rows are not numbered from 1')
  end subroutine

  !> The part of x that belongs to body b.
  function body_of(this, b, x) result(part)
    type(contact_case), intent(in) :: this
    integer, intent(in) :: b
    real(dp), intent(in) :: x(:)
    real(dp) :: part(this%body(b)%n)

    part = x(this%body(b)%offset + 1:this%body(b)%offset + this%body(b)%n)
  end function

  !> K x for a stiffness of which the lower triangle or all of it is stored.
  function stiffness_times(k, x) result(y)
    type(sparse_matrix), intent(in) :: k
    real(dp), intent(in) :: x(:)
    real(dp) :: y(k%rows)
    integer :: i, e

    y = multiply(k, x)
    if (.not. k%symmetric) return
    y = y + multiply_transposed(k, x)
    do i = 1, k%rows
      do e = k%row_ptr(i), k%row_ptr(i + 1) - 1
        if (k%col(e) == i) y(i) = y(i) - k%val(e) * x(i)
      end do
    end do
  end function

  !> Displacements of all bodies one after the other.
  subroutine displacements(p, this, u)
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    real(dp), intent(out) :: u(:)
    integer :: b

    do b = 1, size(this%body)
      call feti_displacement(p, b, u(this%body(b)%offset + 1:this%body(b)%offset + this%body(b)%n))
    end do
  end subroutine

end module
