!> Common parts of the FORTRAN 77 interface: conversions between the host's INTEGER and the library's integers, statuses,
!> texts. A host calls the external subroutines FT... of the files feti_contact_f77_*.f90 and needs no module.
!>
!> This interface is shipped as source: compiled with the host's flags, its INTEGER is the host's INTEGER of 4 or 8 bytes.
!> No number is truncated silently. A number from the host that is too large is replaced by a number that the library
!> refuses. A result that does not fit INTEGER, or a 32-bit label, gives status FTEFIT; in arrays of counts (INFO and
!> similar arrays) such a result becomes the largest INTEGER.
module feti_contact_f77_base
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int32_t, c_int64_t, c_intptr_t, c_loc, c_ptr, &
    c_f_pointer, c_f_procpointer, c_funloc, c_null_char, c_null_funptr, c_null_ptr
  use feti_contact_base, only: c_text, f_text
  use feti_contact_c
  implicit none
  public
  include 'feti_contact_f77.inc'

  !> For index arrays of the host.
  interface feti_body_stiffness
    procedure feti_body_stiffness_i32, feti_body_stiffness_i64
  end interface
  !> For index arrays of the host.
  interface feti_body_stiffness_split
    procedure feti_body_stiffness_split_i32, feti_body_stiffness_split_i64
  end interface
  !> For index arrays of the host.
  interface feti_body_stiffness_skyline
    procedure feti_body_stiffness_skyline_i32, feti_body_stiffness_skyline_i64
  end interface
  !> For index arrays of the host.
  interface feti_body_stiffness_triplets
    procedure feti_body_stiffness_triplets_i32, feti_body_stiffness_triplets_i64
  end interface
  !> For index arrays of the host.
  interface feti_body_mesh
    procedure feti_body_mesh_i32, feti_body_mesh_i64
  end interface
  !> For index arrays of the host.
  interface feti_body_numbering
    procedure feti_body_numbering_i32, feti_body_numbering_i64
  end interface
  !> For index arrays of the host.
  interface feti_dof_table
    procedure feti_dof_table_i32, feti_dof_table_i64
  end interface
  !> For index arrays of the host.
  interface feti_surface_faces
    procedure feti_surface_faces_i32, feti_surface_faces_i64
  end interface
  !> For index arrays of the host.
  interface feti_rows_add
    procedure feti_rows_add_i32, feti_rows_add_i64
  end interface
  !> For index arrays of the host.
  interface feti_friction_add
    procedure feti_friction_add_i32, feti_friction_add_i64
  end interface

  !> Statuses of this interface itself, in the order FTEISZ, FTEDSZ, FTEFIT.
  character(len=*), parameter :: own_text(3) = [character(len=110) :: &
    'FTNEW: INTEGER of the host and of the FORTRAN 77 face differ in size: compile both with the same flags', &
    'FTNEW: DOUBLE PRECISION of the host has not 8 bytes: compile it without -fdefault-real-8 or the like', &
    'a number does not fit: one of the library into the host''s INTEGER, or the label of a node into 32 bits']

contains

  !> The handle of the library, from the number in the host's INTEGER.
  recursive type(c_ptr) function handle(ip)
    integer, intent(in) :: ip

    handle = transfer(int(ip, c_intptr_t), c_null_ptr)
  end function

  !> Number of a body, row or state, from 0; -2 for every invalid number, because -1 is FETI_ALL.
  recursive integer(c_int64_t) function from_zero(i)
    integer, intent(in) :: i

    from_zero = merge(int(i, c_int64_t) - 1, -2_c_int64_t, i >= 1)
  end function

  !> A body, or all bodies.
  recursive integer(c_int64_t) function body_or_all(i)
    integer, intent(in) :: i

    body_or_all = from_zero(i)
    if (i == FTALL) body_or_all = FETI_ALL
  end function

  !> A number of the host for the library.
  recursive integer(c_int64_t) function wide(i)
    integer, intent(in) :: i

    wide = int(i, c_int64_t)
  end function

  !> A number of 32 bits; a number that does not fit becomes the largest number of its sign, which no argument allows.
  recursive integer(c_int32_t) function narrow(i)
    integer, intent(in) :: i
    integer(c_int64_t), parameter :: largest = int(huge(1_c_int32_t), c_int64_t)

    narrow = int(max(-largest, min(largest, int(i, c_int64_t))), c_int32_t)
  end function

  !> n, or 0 if n exceeds the unknowns of all bodies: the library refuses 0 and does not read the host's arrays.
  recursive integer(c_int64_t) function readable(ip, n)
    integer, intent(in) :: ip, n
    integer(c_int64_t), target :: unknowns

    readable = 0
    if (feti_counts(handle(ip), c_null_ptr, c_loc(unknowns), c_null_ptr, c_null_ptr) /= FETI_OK) return
    if (wide(n) <= unknowns) readable = wide(n)
  end function

  !> A count; a count beyond the largest INTEGER becomes the largest INTEGER.
  recursive elemental integer function clipped(found)
    integer(c_int64_t), intent(in) :: found

    clipped = int(max(-int(huge(1), c_int64_t), min(int(huge(1), c_int64_t), found)))
  end function

  !> Sets i to the number found, or ierr to FTEFIT.
  recursive subroutine fit(found, i, ierr)
    integer(c_int64_t), intent(in) :: found
    integer, intent(inout) :: i, ierr

    if (abs(found) > int(huge(i), c_int64_t)) then
      ierr = FTEFIT
    else
      i = int(found)
    end if
  end subroutine

  !> Converts the first n numbers, all or none.
  recursive subroutine fit_all(found, n, i, ierr)
    integer(c_int64_t), intent(in) :: found(:)
    integer, intent(in) :: n
    integer, intent(inout) :: i(*), ierr

    if (any(found(:n) > int(huge(1), c_int64_t))) then
      ierr = FTEFIT
    else
      i(:n) = int(found(:n))
    end if
  end subroutine

  !> A list of which the library has written the first cap numbers, from 0: returns how many numbers there are, and the
  !> written ones from 1.
  recursive subroutine fit_list(count, cap, found, n, i, ierr)
    integer(c_int64_t), intent(in) :: count, found(:)
    integer, intent(in) :: cap
    integer, intent(inout) :: n, i(*), ierr

    call fit_all(found + 1, int(min(count, wide(cap))), i, ierr)
    if (ierr == FETI_OK) call fit(count, n, ierr)
  end subroutine

  !> Writes the first n of the counts.
  recursive subroutine give(found, n, i)
    integer(c_int64_t), intent(in) :: found(:)
    integer, intent(in) :: n
    integer, intent(inout) :: i(*)
    integer :: k

    do k = 1, min(n, size(found))
      i(k) = clipped(found(k))
    end do
  end subroutine

  !> Writes the numbers found, as many as fit into x(n).
  recursive subroutine give_reals(found, n, x)
    real(c_double), intent(in) :: found(:)
    integer, intent(in) :: n
    real(c_double), intent(inout) :: x(*)
    integer :: k

    do k = 1, min(n, size(found))
      x(k) = found(k)
    end do
  end subroutine

  !> The status for the host: argument k of the C function is argument place(k) of the subroutine; if place is absent,
  !> argument k.
  recursive integer function told(status, place)
    integer(c_int32_t), intent(in) :: status
    integer, intent(in), optional :: place(:)
    integer :: k

    told = int(status)
    if (status >= FETI_ARGUMENT .or. .not. present(place)) return
    k = int(FETI_ARGUMENT - status)
    if (k <= size(place)) told = int(FETI_ARGUMENT) - place(k)
  end function

  !> Address of an array of the host, NULL if it is absent.
  recursive type(c_ptr) function reals(x, present)
    real(c_double), intent(in), target :: x(*)
    logical, intent(in) :: present

    reals = c_null_ptr
    if (present) reals = c_loc(x(1))
  end function

  !> Address of an array of the host, NULL if it is absent.
  recursive type(c_ptr) function integers(i, present)
    integer, intent(in), target :: i(*)
    logical, intent(in) :: present

    integers = c_null_ptr
    if (present) integers = c_loc(i(1))
  end function

  !> For index arrays of the host: dof is an address, which tells no interface the size of the numbers.
  recursive integer(c_int32_t) function feti_surface_add(p, body, dim, nodes, x, ldx, dof, ldd, base, surface)
    type(c_ptr), intent(in) :: p, dof
    integer(c_int64_t), intent(in) :: body, nodes, ldx, ldd
    integer(c_int32_t), intent(in) :: dim, base
    real(c_double), intent(in) :: x(*)
    integer(c_int64_t), intent(inout) :: surface

    if (kind(base) == kind(1)) then
      feti_surface_add = feti_surface_add_i32(p, body, dim, nodes, x, ldx, dof, ldd, base, surface)
    else
      feti_surface_add = feti_surface_add_i64(p, body, dim, nodes, x, ldx, dof, ldd, base, surface)
    end if
  end function

  !> Text of the last error of this thread, padded with blanks or truncated; blank if ierr is not its status, as for
  !> FTEMEM of this interface itself.
  recursive subroutine give_last_error(status, text)
    integer, intent(in) :: status
    character(len=*), intent(inout) :: text
    character(kind=c_char), allocatable, target :: buffer(:)
    type(feti_error_detail) :: found
    integer(c_int64_t) :: length

    length = feti_last_error(c_null_ptr, 0_c_int64_t)
    found%struct_size = storage_size(found, c_int64_t) / 8
    if (feti_last_error_detail(found) /= FETI_OK) return
    if (status > FTEARG .and. status /= int(found%status)) return
    allocate (buffer(length + 1))
    length = feti_last_error(c_loc(buffer), size(buffer, kind=c_int64_t))
    found%struct_size = storage_size(found, c_int64_t) / 8
    if (feti_last_error_detail(found) /= FETI_OK) return
    if (status > FTEARG .and. status /= int(found%status)) return
    text = f_text(c_loc(buffer))
  end subroutine

end module
