!> With the fixing dofs of the library held, CHOLMOD gives the same K+ f, the same F = [B; H] K+ [B; H]' and the same
!> right-hand side d = [B; H] K+ f - [c; h].
!> cholmod_oracle [data folder [case ...]]
program cholmod_oracle
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int32_t, c_int64_t, c_ptr
  use case_problem
  use case_reader
  use feti_contact
  implicit none

  ! cholmod_shim.h
  interface
    !> Factor of the n x n matrix given by the rows of its lower triangle, without the unknowns dof(1..held); NULL where
    !> it is not positive definite. Indices count from base.
    function shim_factorise(n, row_ptr, col, val, held, dof, base) bind(C, name='shim_factorise')
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      integer(c_int64_t), value :: n, held
      integer(c_int32_t), intent(in) :: row_ptr(*), col(*)
      real(c_double), intent(in) :: val(*)
      integer(c_int64_t), intent(in) :: dof(*)
      integer(c_int32_t), value :: base
      type(c_ptr) :: shim_factorise
    end function

    !> x(n) solves K x = b(n) on the unknowns that are not held and is zero on the held ones.
    function shim_solve(factor, b, x) bind(C, name='shim_solve')
      import :: c_double, c_int32_t, c_ptr
      type(c_ptr), value :: factor
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int32_t) :: shim_solve
    end function

    subroutine shim_release(factor) bind(C, name='shim_release')
      import :: c_ptr
      type(c_ptr), value :: factor
    end subroutine
  end interface

  character(len=20), parameter :: all_cases(10) = [character(len=20) :: 'p1_P1', 'p1_P3', 'p1_P3_galerkin', 'p2_A', &
    'p2_B1', 'p2_B2', 'p3_2block', 'p3_3block', 'hertz_cylinder', 'three_bodies']
  character(len=20), allocatable :: names(:)
  integer :: i

  call choose_cases(all_cases, names)
  do i = 1, size(names)
    call check_case(trim(names(i)))
  end do
  deallocate (names)

contains

  subroutine check_case(name)
    character(len=*), intent(in) :: name
    type(contact_case) :: this
    type(feti_problem) :: p
    real(dp), allocatable :: columns(:, :), f(:, :), d(:), y(:)
    integer :: b, m

    call read_case(data_folder(), name, this)
    call feti_problem_create(p)
    call hand_over(p, this, from_basis)
    call feti_setup(p)

    m = size(this%c) + size(this%h)
    allocate (f(m, m), source=0.0_dp)
    allocate (y(m), source=0.0_dp)
    allocate (d, source=-[this%c, this%h])
    do b = 1, size(this%body)
      call transpose_rows(this, b, columns)
      call add_body(name, p, this, b, columns, f, y)
    end do
    d = d + y
    call compare_operator(name, p, f)
    call compare_right_hand_side(name, p, this, d, y)
    call feti_problem_destroy(p)
  end subroutine

  !> F_p = B_p K_p+ B_p' added to f, B_p K_p+ f_p added to y; columns: B_p', n x m. K+ f of the library is compared.
  subroutine add_body(name, p, this, b, columns, f, y)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    integer, intent(in) :: b
    real(dp), intent(in) :: columns(:, :)
    real(dp), intent(inout) :: f(:, :), y(:)
    real(dp) :: load(this%body(b)%n, 1), displacement(this%body(b)%n), kplus_f(this%body(b)%n, 1)
    real(dp), allocatable :: solved(:, :)
    type(c_ptr) :: factor
    integer :: j

    call factorise_with_held_dofs(name, p, this, b, factor)
    load(:, 1) = body_of(this, b, this%f)
    call require(shim_solve(factor, load, displacement) == 0, name // ': CHOLMOD does not solve')
    allocate (solved(size(columns, 1), size(columns, 2)))
    do j = 1, size(columns, 2)
      call require(shim_solve(factor, columns(:, j), solved(:, j)) == 0, name // ': CHOLMOD does not solve')
    end do
    call shim_release(factor)

    call feti_body_kplus(p, b, load, kplus_f)
    call require(largest(kplus_f(:, 1) - displacement) <= 1e-10_dp * largest(displacement), &
      name // ': K+ f differs by ' // number(largest(kplus_f(:, 1) - displacement)))
    f = f + matmul(transpose(columns), solved)
    y = y + matmul(transpose(columns), displacement)
  end subroutine

  !> CHOLMOD's factor of the stiffness of body b with the fixing dofs of the library held.
  subroutine factorise_with_held_dofs(name, p, this, b, factor)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    integer, intent(in) :: b
    type(c_ptr), intent(out) :: factor
    integer :: fixing(size(this%body(b)%null_space, 2))

    call feti_body_fixing(p, b, fixing)
    associate (k => this%body(b)%k)
      call require(all(fixing >= 1 .and. fixing <= k%rows), name // ': a fixing dof is none of the body')
      call require(k%symmetric, name // ': the stiffness is not given by its lower triangle')
      factor = shim_factorise(int(k%rows, c_int64_t), k%row_ptr, k%col, k%val, size(fixing, kind=c_int64_t), &
        int(fixing, c_int64_t), 1_c_int32_t)
    end associate
    call require(c_associated(factor), name // ': CHOLMOD finds the stiffness with held dofs not positive definite')
  end subroutine

  !> The part of [B; H] that acts on body b, transposed: n x m.
  subroutine transpose_rows(this, b, columns)
    type(contact_case), intent(in) :: this
    integer, intent(in) :: b
    real(dp), allocatable, intent(out) :: columns(:, :)

    allocate (columns(this%body(b)%n, size(this%c) + size(this%h)), source=0.0_dp)
    call scatter(this%contact, this%body(b)%offset, columns(:, :size(this%c)))
    call scatter(this%equality, this%body(b)%offset, columns(:, size(this%c) + 1:))
  end subroutine

  subroutine scatter(rows, offset, columns)
    type(sparse_matrix), intent(in) :: rows
    integer, intent(in) :: offset
    real(dp), intent(inout) :: columns(:, :)
    integer :: i, e, j

    do i = 1, rows%rows
      do e = rows%row_ptr(i), rows%row_ptr(i + 1) - 1
        j = rows%col(e) - offset
        if (j >= 1 .and. j <= size(columns, 1)) columns(j, i) = columns(j, i) + rows%val(e)
      end do
    end do
  end subroutine

  !> |dF_ij| <= 1e-10 sqrt(F_ii F_jj), column by column.
  subroutine compare_operator(name, p, f)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    real(dp), intent(in) :: f(:, :)
    real(dp) :: x(size(f, 1)), y(size(f, 1)), root(size(f, 1)), error
    integer :: j

    root = [(sqrt(max(0.0_dp, f(j, j))), j=1, size(root))]
    do j = 1, size(x)
      x = 0
      x(j) = 1
      call feti_dual_apply(p, x, y)
      error = maxval(abs(y - f(:, j)) - 1e-10_dp * root * root(j))
      call require(error <= 0, name // ': F differs from CHOLMOD''s beyond 1e-10 by ' // number(error))
    end do
  end subroutine

  !> d = [B; H] K+ f - [c; h]; y: its first part.
  subroutine compare_right_hand_side(name, p, this, d, y)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    real(dp), intent(in) :: d(:), y(:)
    real(dp) :: found(size(d))

    call feti_dual_rhs(p, found)
    call require(largest(found - d) <= 1e-10_dp * (largest(y) + largest(this%c) + largest(this%h)), &
      name // ': the dual right-hand side differs by ' // number(largest(found - d)))
  end subroutine

end program
