!> Coordinates instead of null spaces, and neither of them, give the same answer, with the supports as equality rows and with the
!> supported unknowns struck out of K; only the rigid motions that the supports allow are in the null spaces.
!> coordinates [data folder]
program coordinates
  use case_problem
  use case_reader
  use feti_contact
  implicit none

  call check_both('hertz_cylinder', [3, 3], [1, 0])
  call check_both('three_bodies', [6, 6, 6], [0, 3, 3])
  call a_driven_block_is_held_by_the_spring

contains

  !> A spring 2 on the ground and, across a gap of 1, a block joined by 4, driven by .25 at its near end and pressed by 6:
  !> u = -25/7; -32/7, -85/14, by hand. K of the block is indefinite, and the spring holds what it drives.
  subroutine a_driven_block_is_held_by_the_spring
    type(feti_problem) :: p
    integer :: spring, block, stat
    real(dp) :: u(2)

    call feti_problem_create(p)
    call feti_body_add(p, 1, spring)
    call feti_body_stiffness(p, spring, reshape([2.0_dp], [1, 1]), FETI_FULL)
    call feti_body_add(p, 2, block)
    call feti_body_stiffness(p, block, reshape([3.75_dp, -4.0_dp, -4.0_dp, 4.0_dp], [2, 2]), FETI_FULL)
    call feti_body_load(p, block, [0.0_dp, -6.0_dp])
    call feti_rows_add(p, FETI_INEQUALITY, [1, 3], [spring, block], [1, 1], [1.0_dp, -1.0_dp], [1.0_dp])
    call feti_body_coordinates(p, block, [1, 2], [1, 1], reshape([5.0_dp, 6.0_dp], [1, 2]))
    call feti_solve(p, stat=stat)
    call require(stat == FETI_INDEFINITE, 'a driven block whose motion is a candidate is not refused')
    call feti_body_coordinates_flags(p, block, FETI_SOFT)
    call feti_solve(p)
    call feti_displacement(p, block, u)
    call require(largest(u + [32.0_dp / 7, 85.0_dp / 14]) <= 1e-12_dp, 'a driven block goes elsewhere')
    call feti_body_coordinates_flags(p, block, FETI_EXACT)
    call feti_solve(p, stat=stat)
    call require(stat == FETI_NULL_SPACE, 'a driven block floats as a whole')
    call feti_body_coordinates_flags(p, block, FETI_EXACT - 1, stat)
    call require(stat == FETI_ARGUMENT - 3, 'flags of coordinates are not checked')
    call feti_problem_destroy(p)
  end subroutine

  !> free, held: dimensions of the null spaces without supports and with the supported unknowns struck out.
  subroutine check_both(name, free, held)
    character(len=*), intent(in) :: name
    integer, intent(in) :: free(:), held(:)
    type(contact_case) :: this, struck

    call read_case(data_folder(), name, this)
    call check(name, this, free, from_coordinates)
    call check(name // ' from nothing', this, free, from_nothing)
    call strike_supports(this, struck)
    call require(size(struck%h) == 0 .and. struck%n < this%n, name // ': no supports were struck out')
    call check(name // ' with struck supports', struck, held, from_coordinates)
    call check(name // ' with struck supports from nothing', struck, held, from_nothing)
  end subroutine

  subroutine check(name, this, modes, source)
    character(len=*), intent(in) :: name
    type(contact_case), intent(in) :: this
    integer, intent(in) :: modes(:), source
    type(feti_problem) :: p
    type(feti_info) :: info
    real(dp) :: u(this%n), lambda(size(this%c))

    call feti_problem_create(p)
    call hand_over(p, this, source)
    call check_null_spaces(name, p, this, modes)
    call feti_solve(p, info)
    call displacements(p, this, u)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(info%floating_modes == sum(modes), name // ': info%floating_modes is wrong')
    call require(info%worst <= 1, name // ': the certificate does not pass')
    call require(largest(lambda - this%lambda_ref) <= 1e-7_dp * largest(this%lambda_ref), &
      name // ': contact forces differ by ' // number(largest(lambda - this%lambda_ref)))
    call require(largest(u - this%u_ref) <= 1e-8_dp * largest(this%u_ref), &
      name // ': displacements differ by ' // number(largest(u - this%u_ref)))
    call feti_problem_destroy(p)
  end subroutine

  !> The dimension of each null space, and K R = 0.
  subroutine check_null_spaces(name, p, this, modes)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    integer, intent(in) :: modes(:)
    real(dp), allocatable :: r(:, :)
    integer :: b, j

    call feti_setup(p)
    do b = 1, size(this%body)
      call feti_body_null_space_get(p, b, this%body(b)%n, r)
      call require(size(r, 1) == this%body(b)%n .and. size(r, 2) == modes(b), &
        name // ': a null space has the wrong dimension')
      do j = 1, size(r, 2)
        call require(largest(stiffness_times(this%body(b)%k, r(:, j))) <= &
          1e-9_dp * largest(this%body(b)%k%val) * largest(r(:, j)), name // ': K R is not zero')
      end do
    end do
  end subroutine

  !> The same case without the unknowns that a row of H (one entry, h = 0) holds, and without H.
  subroutine strike_supports(this, struck)
    type(contact_case), intent(in) :: this
    type(contact_case), intent(out) :: struck
    logical :: kept(this%n)
    integer :: new(this%n), b, first, last

    kept = .true.
    kept(this%equality%col) = .false.
    call number_kept(kept, new)
    struck = this
    struck%n = count(kept)
    do b = 1, size(this%body)
      first = this%body(b)%offset + 1
      last = this%body(b)%offset + this%body(b)%n
      struck%body(b)%offset = count(kept(:first - 1))
      struck%body(b)%n = count(kept(first:last))
      call keep_columns(this%body(b)%k, kept(first:last), new(first:last) - struck%body(b)%offset, struck%body(b)%k)
      call keep_rows(kept(first:last), struck%body(b)%k)
    end do
    call keep_columns(this%contact, kept, new, struck%contact)
    struck%f = pack(this%f, kept)
    struck%u_ref = pack(this%u_ref, kept)
    struck%node = pack(this%node, kept)
    struck%dir = pack(this%dir, kept)
    struck%xyz = reshape(pack(this%xyz, spread(kept, 1, 3)), [3, struck%n])
    struck%equality%rows = 0
    struck%h = [real(dp) ::]
    struck%mu_ref = [real(dp) ::]
  end subroutine

  !> new(i): number of unknown i among those kept.
  subroutine number_kept(kept, new)
    logical, intent(in) :: kept(:)
    integer, intent(out) :: new(:)
    integer :: i

    do i = 1, size(kept)
      new(i) = count(kept(:i))
    end do
  end subroutine

  !> The entries of a in the columns kept, with their new numbers; the rows stay.
  subroutine keep_columns(a, kept, new, b)
    type(sparse_matrix), intent(in) :: a
    logical, intent(in) :: kept(:)
    integer, intent(in) :: new(:)
    type(sparse_matrix), intent(out) :: b
    integer :: i

    b%rows = a%rows
    b%cols = count(kept)
    b%symmetric = a%symmetric
    allocate (b%row_ptr(a%rows + 1))
    b%row_ptr(1) = 1
    do i = 1, a%rows
      b%row_ptr(i + 1) = b%row_ptr(i) + count(kept(a%col(a%row_ptr(i):a%row_ptr(i + 1) - 1)))
    end do
    b%val = pack(a%val, kept(a%col))
    b%col = new(pack(a%col, kept(a%col)))
  end subroutine

  !> Strikes the rows that are not kept.
  subroutine keep_rows(kept, a)
    logical, intent(in) :: kept(:)
    type(sparse_matrix), intent(inout) :: a
    logical :: stays(size(a%val))
    integer :: i, rows

    rows = 0
    do i = 1, a%rows
      stays(a%row_ptr(i):a%row_ptr(i + 1) - 1) = kept(i)
    end do
    do i = 1, a%rows
      if (.not. kept(i)) cycle
      rows = rows + 1
      a%row_ptr(rows + 1) = a%row_ptr(rows) + a%row_ptr(i + 1) - a%row_ptr(i)
    end do
    a%rows = rows
    a%row_ptr = a%row_ptr(:rows + 1)
    a%val = pack(a%val, stays)
    a%col = pack(a%col, stays)
  end subroutine

end program
