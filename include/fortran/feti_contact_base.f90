!> The handle, the errors and the texts of module feti_contact. A host uses feti_contact, not this module.
!>
!> Every procedure of this interface is recursive, because a function of the host may call the library and several threads
!> may call it at the same time. The last two arguments of every procedure are `stat` and `errmsg`, both optional:
!>   stat present: it gets the status (0 is FETI_OK); a failed call changes nothing and can be repeated with corrected
!>   data. stat absent:  any status but FETI_OK prints the text on error_unit and ends the program with error stop 1.
!>   errmsg:       gets the text if the status is not FETI_OK, truncated or padded to its length; otherwise unchanged.
!> No function has a result of deferred length, because gfortran keeps such a result in static memory of the caller, which
!> is not thread-safe. If arrays do not match (for example a row pointer beyond the entries), this interface refuses them
!> itself: stat and errmsg report the error, but feti_last_error and feti_last_error_detail do not.
module feti_contact_base
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_int32_t, c_int64_t, c_loc, &
    c_null_char, c_null_ptr, c_ptr, c_size_t, c_sizeof, c_associated
  use, intrinsic :: iso_fortran_env, only: error_unit
  use feti_contact_c, only: FETI_ARGUMENT, FETI_OK, feti_progress, &
    c_error_detail => feti_error_detail, &
    c_last_error => feti_last_error, &
    c_last_error_detail => feti_last_error_detail, &
    c_problem_create => feti_problem_create, &
    c_problem_destroy => feti_problem_destroy, &
    c_problem_error => feti_problem_error, &
    c_set_i64 => feti_set_i64, &
    c_status_name => feti_status_name, &
    c_status_text => feti_status_text, &
    c_version => feti_version, &
    c_version_number => feti_version_number
  implicit none
  private
  public :: feti_problem, feti_error_detail, feti_progress
  public :: listener, log_procedure, progress_procedure, listener_of
  public :: host_operator, operator_procedure, keep_operator
  public :: problem_create, problem_destroy, problem_error
  public :: last_error, last_error_detail, status_name, status_text
  public :: version, version_number
  public :: handle_of, body_index, address_of, size_of, finish, refuse, c_text, f_text

  abstract interface
    !> A function of the host that is called for every step; it returns 0 to continue, > 0 to cancel, < 0 to report a
    !> failure. data: the data given to feti_on_progress.
    integer function progress_procedure(now, data)
      import :: feti_progress
      type(feti_progress), intent(in) :: now
      class(*), intent(inout) :: data
    end function

    !> A function of the host that receives a line of text; it returns 0 to continue and any other number to report a
    !> failure. level: FETI_LOG_RESULT, FETI_LOG_PHASE or FETI_LOG_STEP. data: the data given to feti_on_log.
    integer function log_procedure(level, text, data)
      integer, intent(in) :: level
      character(len=*), intent(in) :: text
      class(*), intent(inout) :: data
    end function

    !> A function of the host that multiplies by a matrix A that the host keeps, y = A x; it returns 0, or any other
    !> number to report a failure. body: from 1. x(n,nrhs), y(n,nrhs): nrhs is 1 to 32; y contains zeros on entry. data:
    !> the data given to feti_body_operator.
    integer function operator_procedure(body, x, y, data)
      import :: c_double
      integer, intent(in) :: body
      real(c_double), intent(in), contiguous :: x(:, :)
      real(c_double), intent(inout), contiguous :: y(:, :)
      class(*), intent(inout) :: data
    end function
  end interface

  interface
    !> Characters of a C string before its NUL.
    pure function strlen(string) bind(C, name='strlen')
      import :: c_ptr, c_size_t
      type(c_ptr), intent(in), value :: string
      integer(c_size_t) :: strlen
    end function
  end interface

  !> Placeholder for data that the host has not given; no type of the host matches it in select type.
  type :: no_data
  end type

  !> The functions and data of the host that feti_body_operator keeps for one body.
  type :: host_operator
    integer :: body = 0
    procedure(operator_procedure), pointer, nopass :: kplus => null(), k => null()
    class(*), pointer :: data => null()
    type(no_data) :: nothing
    !> The entry of the next body.
    type(host_operator), pointer :: next => null()
  end type

  !> Functions and data of the host: for feti_on_progress and feti_on_log, and a list for feti_body_operator.
  type :: listener
    procedure(progress_procedure), pointer, nopass :: hear => null()
    class(*), pointer :: data => null()
    procedure(log_procedure), pointer, nopass :: tell => null()
    class(*), pointer :: log_data => null()
    type(no_data) :: nothing
    type(host_operator), pointer :: operators => null()
  end type

  !> One contact problem. Copies of the variable refer to the same problem, which exists until feti_problem_destroy.
  type :: feti_problem
    private
    type(c_ptr) :: handle = c_null_ptr
    !> Shared by this variable and all its copies while the handle is valid.
    type(listener), pointer :: listener => null()
  end type

  !> What the last failed call of this thread found, and where. All numbers count from 1.
  type :: feti_error_detail
    !> Status of that call.
    integer :: status = 0
    !> Number of the refused argument in the C function of that name (the handle is 1); 0: none.
    integer :: argument = 0
    !> Body, component of the body, unknown of the body, row, position in the array; 0: does not apply.
    integer(c_int64_t) :: body = 0, component = 0, dof = 0, row = 0, entry = 0
    !> The value that was found (an index counts from 1) and the allowed value; NaN: does not apply.
    real(c_double) :: value = 0, limit = 0
    !> Name of the C function, blank padded.
    character(len=40) :: function = ''
    !> Element of the body, node with friction or of a surface, pair of surfaces, face of a surface; 0: does not apply.
    integer(c_int64_t) :: element = 0, node = 0, pair = 0, face = 0
  end type

contains

  !> Number of characters of a C string, 0 for NULL. The length functions stand before the functions whose results use
  !> them, because gfortran otherwise treats them as procedures without an interface.
  recursive pure integer function length_of(address)
    type(c_ptr), intent(in) :: address

    length_of = 0
    if (c_associated(address)) length_of = int(strlen(address))
  end function

  !> Length of the name of a status.
  recursive pure integer function name_length(status)
    integer, intent(in) :: status

    name_length = length_of(c_status_name(int(status, c_int32_t)))
  end function

  !> Length of the sentence on a status.
  recursive pure integer function sentence_length(status)
    integer, intent(in) :: status

    sentence_length = length_of(c_status_text(int(status, c_int32_t)))
  end function

  !> Length of the version text.
  recursive pure integer function version_length()
    version_length = length_of(c_version())
  end function

  !> Creates an empty problem; texts and positions count from 1. On failure p is not a problem.
  recursive subroutine problem_create(p, stat, errmsg)
    type(feti_problem), intent(out) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    status = c_problem_create(p%handle)
    if (status == FETI_OK) then
      allocate (p%listener)
      status = c_set_i64(p%handle, c_text('index_base'), 1_c_int64_t)
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Frees the problem. Afterwards p is not a problem, and calls with its copies return FETI_HANDLE.
  recursive subroutine problem_destroy(p, stat, errmsg)
    type(feti_problem), intent(inout) :: p
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    status = c_problem_destroy(p%handle)
    if (status == FETI_OK) then
      do while (associated(p%listener%operators))
        call drop_operator(p%listener, p%listener%operators%body)
      end do
      deallocate (p%listener)
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Text of the last failed call of this problem; empty if no call failed. May be called while another thread solves.
  recursive subroutine problem_error(p, text, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=:), allocatable, intent(out) :: text
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    character(kind=c_char), allocatable, target :: buffer(:)
    integer(c_int64_t) :: length
    integer(c_int32_t) :: status

    text = ''
    length = 0
    status = c_problem_error(p%handle, c_null_ptr, 0_c_int64_t, length)
    if (status == FETI_OK) then
      allocate (buffer(length + 1))
      status = c_problem_error(p%handle, c_loc(buffer), size(buffer, kind=c_int64_t), length)
      if (status == FETI_OK) text = f_text(c_loc(buffer))
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Text of the last failed call of this thread; empty if no call failed.
  recursive subroutine last_error(text)
    character(len=:), allocatable, intent(out) :: text
    character(kind=c_char), allocatable, target :: buffer(:)
    integer(c_int64_t) :: length

    length = c_last_error(c_null_ptr, 0_c_int64_t)
    allocate (buffer(length + 1))
    length = c_last_error(c_loc(buffer), length + 1)
    text = f_text(c_loc(buffer))
  end subroutine

  !> Details of the last failed call of this thread.
  recursive subroutine last_error_detail(detail, stat, errmsg)
    type(feti_error_detail), intent(out) :: detail
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_error_detail), target :: found
    integer(c_int32_t) :: status

    found%struct_size = c_sizeof(found)
    status = c_last_error_detail(found)
    if (status == FETI_OK) then
      detail%status = found%status
      detail%argument = found%argument
      detail%body = found%body + 1
      detail%component = found%component + 1
      detail%dof = found%dof + 1
      detail%row = found%row + 1
      detail%entry = found%entry + 1
      detail%value = found%value
      detail%limit = found%limit
      detail%function = f_text(c_loc(found%function))
      detail%element = found%element + 1
      detail%node = found%node + 1
      detail%pair = found%pair + 1
      detail%face = found%face + 1
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Name of a status, such as FETI_LOAD_NOT_HELD.
  recursive function status_name(status) result(name)
    integer, intent(in) :: status
    character(len=name_length(status)) :: name

    name = f_text(c_status_name(int(status, c_int32_t)))
  end function

  !> One sentence on a status.
  recursive function status_text(status) result(text)
    integer, intent(in) :: status
    character(len=sentence_length(status)) :: text

    text = f_text(c_status_text(int(status, c_int32_t)))
  end function

  !> Version of the library, such as 0.2.0.
  recursive function version() result(text)
    character(len=version_length()) :: text

    text = f_text(c_version())
  end function

  !> 10000 major + 100 minor + patch.
  recursive integer function version_number()
    version_number = int(c_version_number())
  end function

  !> The handle for a C function.
  recursive type(c_ptr) function handle_of(p)
    type(feti_problem), intent(in) :: p

    handle_of = p%handle
  end function

  !> A body number for a C function that accepts FETI_ALL = -1; a number below 1 must not be taken for all bodies.
  recursive pure integer(c_int64_t) function body_index(body)
    integer, intent(in) :: body

    body_index = int(body, c_int64_t) - 1
    if (body < 1) body_index = body_index - 1
  end function

  !> Address of an array, or NULL if the array is absent.
  recursive type(c_ptr) function address_of(values)
    real(c_double), intent(in), contiguous, optional, target :: values(:)

    address_of = c_null_ptr
    if (.not. present(values)) return
    if (size(values) > 0) address_of = c_loc(values)
  end function

  !> Size of an array, or another number if the array is absent.
  recursive pure integer(c_int64_t) function size_of(values, absent)
    real(c_double), intent(in), optional :: values(:)
    integer(c_int64_t), intent(in) :: absent

    size_of = absent
    if (present(values)) size_of = size(values, kind=c_int64_t)
  end function

  !> The progress and log functions of a problem whose handle the library has just accepted.
  recursive function listener_of(p) result(found)
    type(feti_problem), intent(in) :: p
    type(listener), pointer :: found

    found => p%listener
  end function

  !> Keeps the functions of a body, which the library has just accepted, and replaces earlier ones.
  recursive subroutine keep_operator(p, new)
    type(feti_problem), intent(in) :: p
    type(host_operator), intent(inout), pointer :: new

    call drop_operator(p%listener, new%body)
    new%next => p%listener%operators
    p%listener%operators => new
  end subroutine

  !> Forgets the functions of a body, if there are any.
  recursive subroutine drop_operator(kept, body)
    type(listener), intent(inout) :: kept
    integer, intent(in) :: body
    type(host_operator), pointer :: found, before

    nullify (before)
    found => kept%operators
    do while (associated(found))
      if (found%body == body) exit
      before => found
      found => found%next
    end do
    if (.not. associated(found)) return
    if (associated(before)) then
      before%next => found%next
    else
      kept%operators => found%next
    end if
    deallocate (found)
  end subroutine

  !> Reports a status as described at the top of this module. text: the error that this interface found; absent: the error
  !> text of the library.
  recursive subroutine finish(status, stat, errmsg, text)
    integer(c_int32_t), intent(in) :: status
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    character(len=*), intent(in), optional :: text
    character(len=:), allocatable :: words

    if (present(stat)) stat = int(status)
    if (status == FETI_OK) return
    if (present(text)) then
      words = text
    else
      call last_error(words)
      if (len(words) == 0) words = status_text(int(status))
    end if
    if (present(errmsg)) errmsg = words
    if (present(stat)) return
    write (error_unit, '(3a)') status_name(int(status)), ': ', words
    error stop 1
  end subroutine

  !> Refuses argument k of the C function (the handle is 1) before the library is called; text names the array.
  recursive subroutine refuse(k, text, stat, errmsg)
    integer, intent(in) :: k
    character(len=*), intent(in) :: text
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(int(FETI_ARGUMENT - k, c_int32_t), stat, errmsg, text)
  end subroutine

  !> A C string: the text without trailing blanks and the NUL.
  recursive pure function c_text(text) result(string)
    character(len=*), intent(in) :: text
    character(kind=c_char, len=len_trim(text) + 1) :: string

    string = trim(text) // c_null_char
  end function

  !> The text of a C string, empty for NULL.
  recursive function f_text(address) result(text)
    type(c_ptr), intent(in) :: address
    character(len=length_of(address)) :: text
    character(kind=c_char), pointer :: string(:)
    integer :: i

    if (len(text) == 0) return
    call c_f_pointer(address, string, [len(text)])
    do i = 1, len(text)
      text(i:i) = string(i)
    end do
  end function

end module
