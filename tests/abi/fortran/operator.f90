!> A host with factorisations of its own through the typed face: module procedures with data of any type. By hand: a
!> spring and a block, then the membranes of p1_P3 with dense Cholesky factors (first argument: the data folder).
module own_factor
  use feti_contact
  implicit none
  private
  public :: factor, springs, factorise, solve_dense, multiply_dense, solve_springs, multiply_springs, solve_without_data
  integer, parameter :: dp = kind(1.0d0)

  !> K of all bodies, and L with L L' = K + rho Q Q', Q an orthonormal basis of the null space.
  type :: factor
    type(feti_problem) :: problem
    type(dense), allocatable :: body(:)
    integer :: calls = 0, busy = 0
  end type

  type, public :: dense
    real(dp), allocatable :: k(:, :), l(:, :)
  end type

  !> The spring of stiffness 1000, and a block: bar of stiffness 4000 between two unknowns, the first held in K+.
  type :: springs
    integer :: reply = 0, calls = 0
    real(dp) :: kplus_is = 1, k_is = 1
  end type

contains

  !> One body: k(n,n), null space r(n,:).
  subroutine factorise(k, r, this)
    real(dp), intent(in) :: k(:, :), r(:, :)
    type(dense), intent(out) :: this
    real(dp) :: q(size(r, 1), size(r, 2)), rho
    integer :: i, j, n

    n = size(k, 1)
    rho = sum([(k(i, i), i=1, n)]) / n
    q = r
    this%k = k
    this%l = k
    do j = 1, size(q, 2)
      do i = 1, j - 1
        q(:, j) = q(:, j) - dot_product(q(:, i), q(:, j)) * q(:, i)
      end do
      q(:, j) = q(:, j) / norm2(q(:, j))
      this%l = this%l + rho * matmul(q(:, j:j), transpose(q(:, j:j)))
    end do
    do j = 1, n
      this%l(j:, j) = this%l(j:, j) - matmul(this%l(j:, :j - 1), this%l(j, :j - 1))
      this%l(j:, j) = this%l(j:, j) / sqrt(this%l(j, j))
    end do
  end subroutine

  integer function solve_dense(body, x, y, data)
    integer, intent(in) :: body
    real(dp), intent(in), contiguous :: x(:, :)
    real(dp), intent(inout), contiguous :: y(:, :)
    class(*), intent(inout) :: data
    integer :: i, j, n, stat

    solve_dense = -1
    n = size(x, 1)
    select type (data)
    type is (factor)
      y = x
      associate (l => data%body(body)%l)
        do j = 1, size(y, 2)
          do i = 1, n
            y(i, j) = y(i, j) / l(i, i)
            y(i + 1:, j) = y(i + 1:, j) - y(i, j) * l(i + 1:, i)
          end do
          do i = n, 1, -1
            y(i, j) = (y(i, j) - dot_product(l(i + 1:, i), y(i + 1:, j))) / l(i, i)
          end do
        end do
      end associate
      data%calls = data%calls + 1
      call feti_solve(data%problem, stat=stat)
      if (stat == FETI_BUSY) data%busy = data%busy + 1
      solve_dense = 0
    end select
  end function

  integer function multiply_dense(body, x, y, data)
    integer, intent(in) :: body
    real(dp), intent(in), contiguous :: x(:, :)
    real(dp), intent(inout), contiguous :: y(:, :)
    class(*), intent(inout) :: data

    multiply_dense = -1
    select type (data)
    type is (factor)
      y = matmul(data%body(body)%k, x)
      multiply_dense = 0
    end select
  end function

  integer function solve_springs(body, x, y, data)
    integer, intent(in) :: body
    real(dp), intent(in), contiguous :: x(:, :)
    real(dp), intent(inout), contiguous :: y(:, :)
    class(*), intent(inout) :: data

    solve_springs = -1
    select type (data)
    type is (springs)
      if (body == 1) y = data%kplus_is * x / 1000
      if (body == 2) y(2, :) = data%kplus_is * x(2, :) / 4000
      data%calls = data%calls + 1
      solve_springs = data%reply
    end select
  end function

  integer function multiply_springs(body, x, y, data)
    integer, intent(in) :: body
    real(dp), intent(in), contiguous :: x(:, :)
    real(dp), intent(inout), contiguous :: y(:, :)
    class(*), intent(inout) :: data

    multiply_springs = -1
    select type (data)
    type is (springs)
      if (body == 1) y = data%k_is * 1000 * x
      if (body == 2) y = data%k_is * 4000 * matmul(reshape([1.0_dp, -1.0_dp, -1.0_dp, 1.0_dp], [2, 2]), x)
      multiply_springs = 0
    end select
  end function

  !> Given without data: what it gets is of no type that a host can name.
  integer function solve_without_data(body, x, y, data)
    integer, intent(in) :: body
    real(dp), intent(in), contiguous :: x(:, :)
    real(dp), intent(inout), contiguous :: y(:, :)
    class(*), intent(inout) :: data

    solve_without_data = -1
    y = x / 1000
    select type (data)
    type is (integer)
      solve_without_data = -2
    class default
      if (body == 1) solve_without_data = 0
    end select
  end function

end module

program operator
  use case_reader
  use case_problem, only: data_folder, handed_over, require, spring_and_block
  use feti_contact
  use own_factor
  implicit none

  call by_hand
  call wrong_and_failing_functions
  if (command_argument_count() > 0) call membranes

contains

  subroutine check_answer(p, after)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: after
    real(dp) :: u(2), lambda(1)

    call feti_solve(p)
    call feti_displacement(p, 2, u)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(abs(lambda(1) - 100) <= 1e-8_dp, 'wrong contact force after ' // after)
    call require(maxval(abs(u - [-0.6_dp, -0.625_dp])) <= 1e-10_dp, 'wrong displacement after ' // after)
  end subroutine

  subroutine by_hand
    type(feti_problem) :: p
    type(springs), target :: host, other
    real(dp) :: y(1, 1)

    call spring_and_block(p, [1000.0_dp, 4000.0_dp], -100.0_dp, 0.5_dp, matrices=.false.)
    call feti_body_operator(p, 1, [1000.0_dp], solve_springs, multiply_springs, data=host)
    call feti_body_operator(p, 2, [4000.0_dp, 4000.0_dp], solve_springs, multiply_springs, .true., host)
    call check_answer(p, 'functions')
    call feti_body_kplus(p, 1, reshape([2000.0_dp], [1, 1]), y)
    call require(abs(y(1, 1) - 2) <= 0, 'wrong K+')
    host%calls = 0
    call feti_body_operator(p, 1, [1000.0_dp], solve_springs, multiply_springs, data=other)
    call feti_body_operator(p, 2, [4000.0_dp, 4000.0_dp], solve_springs, multiply_springs, data=other)
    call check_answer(p, 'other functions')
    call require(host%calls == 0 .and. other%calls > 0, 'functions that were replaced are still called')
    call feti_body_stiffness(p, 1, [1, 2], [1], [1000.0_dp], FETI_LOWER)
    call check_answer(p, 'a matrix in place of functions')
    call feti_problem_destroy(p)
  end subroutine

  subroutine wrong_and_failing_functions
    type(feti_problem) :: p, none
    type(feti_error_detail) :: detail
    type(springs), target :: host
    character(len=300) :: text
    integer :: stat

    call spring_and_block(p, [1000.0_dp, 4000.0_dp], -100.0_dp, 0.5_dp, matrices=.false.)
    call feti_body_operator(p, 2, [4000.0_dp, 4000.0_dp], solve_springs, multiply_springs, data=host)
    call feti_body_operator(p, 1, [1000.0_dp], solve_without_data, multiply_springs, stat=stat)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(stat == FETI_CALLBACK .and. index(text, 'body 1') > 0 .and. index(text, 'returned -1') > 0, &
      'a function without its data: ' // trim(text))
    call feti_body_operator(p, 1, [1000.0_dp], solve_springs, multiply_springs, data=host)
    host%reply = 7
    call feti_solve(p, stat=stat, errmsg=text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_CALLBACK .and. nint(detail%value) == 7 .and. detail%body == 1, 'a failure: ' // trim(text))
    host = springs(kplus_is=2)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(stat == FETI_CALLBACK .and. index(text, 'no inverse of its K') > 0, 'a wrong inverse: ' // trim(text))
    host = springs(kplus_is=-1, k_is=-1)
    call feti_solve(p, stat=stat, errmsg=text)
    call require(stat == FETI_INDEFINITE, 'a negative stiffness: ' // trim(text))
    host = springs()
    call check_answer(p, 'wrong functions')

    call feti_body_operator(p, 3, [1.0_dp], solve_springs, multiply_springs, stat=stat)
    call require(stat == FETI_ARGUMENT - 2, 'a body that is none')
    call feti_body_operator(p, 2, [1.0_dp], solve_springs, multiply_springs, data=host, stat=stat, errmsg=text)
    call require(stat == FETI_ARGUMENT - 3, 'a diagonal of another body: ' // trim(text))
    call feti_body_operator(p, 2, [1.0_dp, -1.0_dp], solve_springs, multiply_springs, data=host, stat=stat, errmsg=text)
    call require(stat == FETI_ARGUMENT - 4, 'a negative diagonal: ' // trim(text))
    call feti_body_operator(none, 2, [1.0_dp], solve_springs, multiply_springs, stat=stat)
    call require(stat == FETI_HANDLE, 'no problem')
    call check_answer(p, 'refused functions')
    call feti_problem_destroy(p)
  end subroutine

  !> Forces of p1_P3 with factors of the host; inside its functions the problem is busy.
  subroutine membranes
    type(feti_problem) :: p
    type(contact_case) :: case
    type(factor), target :: host
    real(dp), allocatable :: lambda(:), diag(:), k(:, :)
    integer :: b, i

    call read_case(data_folder(), 'p1_P3', case)
    call handed_over(p, case)
    host%problem = p
    allocate (host%body(size(case%body)), lambda(size(case%c)))
    do b = 1, size(case%body)
      k = dense_of(case%body(b)%k)
      if (case%body(b)%k%symmetric) then
        do i = 1, case%body(b)%n
          k(i, i + 1:) = k(i + 1:, i)
        end do
      end if
      call factorise(k, case%body(b)%null_space, host%body(b))
      diag = [(host%body(b)%k(i, i), i=1, case%body(b)%n)]
      call feti_body_operator(p, b, diag, solve_dense, multiply_dense, data=host)
    end do
    call feti_solve(p)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call require(maxval(abs(lambda - case%lambda_ref)) <= 1e-7_dp * maxval(abs(case%lambda_ref)), 'wrong forces')
    call require(host%calls > 0 .and. host%busy == host%calls, 'the problem was not busy')
    call feti_problem_destroy(p)
  end subroutine

end program
