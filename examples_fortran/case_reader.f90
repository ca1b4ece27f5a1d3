!> Reads a case folder of plain text files into arrays: what a host code has in memory when it comes to contact.
!>
!> K1.mtx, K2.mtx, ...  stiffness of each body (force / length), MatrixMarket coordinate, symmetric (lower triangle) or general
!> R1.mtx, ...          null-space basis of that body, n x r, MatrixMarket array; no file: the body is held
!> B.mtx, c.txt         contact rows B u <= c (c: gaps, length);  H.mtx, h.txt: equality rows H u = h, where present
!> f.txt                loads (force);  u_ref.txt, lambda_ref.txt, mu_ref.txt: the reference solution
!> dofs.txt             node, direction, x, y, z of every unknown, where known
!> elements.txt         body and nodes of every element, where known; pictures alone need them
!>
!> Unknowns are the bodies one after the other; every index counts from 1.
module case_reader
  implicit none
  private
  public :: sparse_matrix, case_body, contact_case, read_case, read_vector
  public :: multiply, multiply_transposed, dense_of, is_dense

  integer, parameter, public :: dp = kind(1.0d0)

  !> Rows one after the other: row i holds the entries row_ptr(i) .. row_ptr(i+1)-1 of col and val.
  !> symmetric: only the lower triangle is stored.
  type :: sparse_matrix
    integer :: rows = 0, cols = 0
    logical :: symmetric = .false.
    integer, allocatable :: row_ptr(:), col(:)
    real(dp), allocatable :: val(:)
  end type

  !> One body: n unknowns at offset+1 .. offset+n, its stiffness, its null space n x r (r = 0: held).
  type :: case_body
    integer :: n = 0, offset = 0
    type(sparse_matrix) :: k
    real(dp), allocatable :: null_space(:, :)
  end type

  !> A whole case; h, H and mu_ref have no rows where the case has no equalities; node is empty without dofs.txt.
  type :: contact_case
    integer :: n = 0
    type(case_body), allocatable :: body(:)
    type(sparse_matrix) :: contact, equality
    real(dp), allocatable :: f(:), c(:), h(:), u_ref(:), lambda_ref(:), mu_ref(:)
    integer, allocatable :: node(:), dir(:)
    real(dp), allocatable :: xyz(:, :)
    !> 20 x elements: nodes through all bodies, in the order of VTK, behind them 0.
    integer, allocatable :: element(:, :), element_body(:)
  end type

contains

  !> Reads all files of the folder directory/name; stops with the name of the file that is missing.
  subroutine read_case(directory, name, this)
    character(len=*), intent(in) :: directory, name
    type(contact_case), intent(out) :: this
    character(len=:), allocatable :: folder
    integer :: p

    folder = trim(directory) // '/' // trim(name) // '/'
    allocate (this%body(count_bodies(folder)))
    do p = 1, size(this%body)
      call read_body(folder, p, this%n, this%body(p))
      this%n = this%n + this%body(p)%n
    end do
    call read_sparse(folder // 'B.mtx', this%contact)
    call read_vector(folder // 'c.txt', this%c)
    call read_vector(folder // 'f.txt', this%f)
    call read_vector(folder // 'u_ref.txt', this%u_ref)
    call read_vector(folder // 'lambda_ref.txt', this%lambda_ref)
    if (exists(folder // 'H.mtx')) then
      call read_sparse(folder // 'H.mtx', this%equality)
      call read_vector(folder // 'h.txt', this%h)
      call read_vector(folder // 'mu_ref.txt', this%mu_ref)
    else
      this%equality%cols = this%n
      allocate (this%equality%row_ptr(1), source=1)
      allocate (this%equality%col(0), this%equality%val(0), this%h(0), this%mu_ref(0))
    end if
    call read_dofs(folder // 'dofs.txt', this)
    call read_elements(folder // 'elements.txt', this)
  end subroutine

  !> y = A x.
  function multiply(a, x) result(y)
    type(sparse_matrix), intent(in) :: a
    real(dp), intent(in) :: x(:)
    real(dp) :: y(a%rows)
    integer :: i, k

    do i = 1, a%rows
      y(i) = 0
      do k = a%row_ptr(i), a%row_ptr(i + 1) - 1
        y(i) = y(i) + a%val(k) * x(a%col(k))
      end do
    end do
  end function

  !> y = A' x.
  function multiply_transposed(a, x) result(y)
    type(sparse_matrix), intent(in) :: a
    real(dp), intent(in) :: x(:)
    real(dp) :: y(a%cols)
    integer :: i, k

    y = 0
    do i = 1, a%rows
      do k = a%row_ptr(i), a%row_ptr(i + 1) - 1
        y(a%col(k)) = y(a%col(k)) + a%val(k) * x(i)
      end do
    end do
  end function

  !> True when more than nine tenths of the entries are stored: boundary element and condensed bodies.
  logical function is_dense(a)
    type(sparse_matrix), intent(in) :: a
    real(dp) :: entries

    entries = real(a%rows, dp) * real(a%cols, dp)
    if (a%symmetric) entries = entries / 2
    is_dense = size(a%val) > 0.9_dp * entries
  end function

  !> The stored entries in a full array, rows x cols; entries not stored are zero.
  function dense_of(a) result(full)
    type(sparse_matrix), intent(in) :: a
    real(dp), allocatable :: full(:, :)
    integer :: i, k

    allocate (full(a%rows, a%cols), source=0.0_dp)
    do i = 1, a%rows
      do k = a%row_ptr(i), a%row_ptr(i + 1) - 1
        full(i, a%col(k)) = a%val(k)
      end do
    end do
  end function

  !> One number a line, as many as the file holds.
  subroutine read_vector(path, x)
    character(len=*), intent(in) :: path
    real(dp), allocatable, intent(out) :: x(:)
    character(len=80) :: line
    integer :: unit, i, n, io

    call open_text(path, unit)
    n = 0
    do
      read (unit, '(a)', iostat=io) line
      if (io /= 0) exit
      if (len_trim(line) > 0) n = n + 1
    end do
    rewind (unit)
    allocate (x(n))
    do i = 1, n
      read (unit, *) x(i)
    end do
    close (unit)
  end subroutine

  subroutine read_body(folder, p, offset, body)
    character(len=*), intent(in) :: folder
    integer, intent(in) :: p, offset
    type(case_body), intent(out) :: body

    body%offset = offset
    call read_sparse(folder // numbered('K', p), body%k)
    body%n = body%k%rows
    if (exists(folder // numbered('R', p))) then
      call read_array(folder // numbered('R', p), body%null_space)
    else
      allocate (body%null_space(body%n, 0))
    end if
  end subroutine

  !> MatrixMarket coordinate file to rows; the entries of a row keep their order in the file.
  subroutine read_sparse(path, a)
    character(len=*), intent(in) :: path
    type(sparse_matrix), intent(out) :: a
    integer, allocatable :: row(:), col(:), next(:)
    real(dp), allocatable :: val(:)
    integer :: unit, entries, k

    call open_text(path, unit)
    call skip_header(unit, a%symmetric)
    read (unit, *) a%rows, a%cols, entries
    allocate (row(entries), col(entries), val(entries))
    do k = 1, entries
      read (unit, *) row(k), col(k), val(k)
    end do
    close (unit)
    allocate (a%row_ptr(a%rows + 1), source=0)
    allocate (a%col(entries), a%val(entries))
    do k = 1, entries
      a%row_ptr(row(k) + 1) = a%row_ptr(row(k) + 1) + 1
    end do
    a%row_ptr(1) = 1
    do k = 1, a%rows
      a%row_ptr(k + 1) = a%row_ptr(k + 1) + a%row_ptr(k)
    end do
    allocate (next, source=a%row_ptr)
    do k = 1, entries
      a%col(next(row(k))) = col(k)
      a%val(next(row(k))) = val(k)
      next(row(k)) = next(row(k)) + 1
    end do
  end subroutine

  !> MatrixMarket array file, column by column.
  subroutine read_array(path, x)
    character(len=*), intent(in) :: path
    real(dp), allocatable, intent(out) :: x(:, :)
    integer :: unit, rows, cols, i, j

    call open_text(path, unit)
    call skip_header(unit)
    read (unit, *) rows, cols
    allocate (x(rows, cols))
    do j = 1, cols
      do i = 1, rows
        read (unit, *) x(i, j)
      end do
    end do
    close (unit)
  end subroutine

  !> node, direction (1 to 3), x, y, z of every unknown; one comment line comes first.
  subroutine read_dofs(path, this)
    character(len=*), intent(in) :: path
    type(contact_case), intent(inout) :: this
    integer :: unit, i

    if (.not. exists(path)) then
      allocate (this%node(0), this%dir(0), this%xyz(3, 0))
      return
    end if
    allocate (this%node(this%n), this%dir(this%n), this%xyz(3, this%n))
    call open_text(path, unit)
    call skip_header(unit)
    do i = 1, this%n
      read (unit, *) this%node(i), this%dir(i), this%xyz(:, i)
    end do
    close (unit)
  end subroutine

  !> The number of elements, then body, number of nodes and nodes of each.
  subroutine read_elements(path, this)
    character(len=*), intent(in) :: path
    type(contact_case), intent(inout) :: this
    character(len=200) :: line
    integer :: unit, elements, nodes, e

    elements = 0
    if (exists(path)) then
      call open_text(path, unit)
      call skip_header(unit)
      read (unit, *) elements
    end if
    allocate (this%element(20, elements), source=0)
    allocate (this%element_body(elements))
    do e = 1, elements
      read (unit, '(a)') line
      read (line, *) this%element_body(e), nodes
      read (line, *) this%element_body(e), nodes, this%element(:nodes, e)
    end do
    if (elements > 0) close (unit)
  end subroutine

  !> Moves behind the lines that start with % or #; symmetric: one of them says so.
  subroutine skip_header(unit, symmetric)
    integer, intent(in) :: unit
    logical, intent(out), optional :: symmetric
    character(len=80) :: line

    if (present(symmetric)) symmetric = .false.
    do
      read (unit, '(a)') line
      if (line(1:1) /= '%' .and. line(1:1) /= '#') exit
      if (present(symmetric) .and. index(line, ' symmetric') > 0) symmetric = .true.
    end do
    backspace (unit)
  end subroutine

  subroutine open_text(path, unit)
    character(len=*), intent(in) :: path
    integer, intent(out) :: unit

    if (.not. exists(path)) then
      print '(3a)', 'case_reader: ', path, ' not found ("make data" unpacks the case folders)'
      error stop 2
    end if
    open (newunit=unit, file=path, status='old', action='read')
  end subroutine

  logical function exists(path)
    character(len=*), intent(in) :: path

    inquire (file=path, exist=exists)
  end function

  integer function count_bodies(folder)
    character(len=*), intent(in) :: folder

    count_bodies = 0
    do while (exists(folder // numbered('K', count_bodies + 1)))
      count_bodies = count_bodies + 1
    end do
  end function

  !> K1.mtx, K2.mtx, ...
  function numbered(letter, p) result(name)
    character(len=1), intent(in) :: letter
    integer, intent(in) :: p
    character(len=:), allocatable :: name
    character(len=12) :: digits

    write (digits, '(i0)') p
    name = letter // trim(digits) // '.mtx'
  end function

end module
