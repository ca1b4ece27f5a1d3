!> Contact rows and equality rows of module feti_contact. A host uses feti_contact, not this module.
!>
!> The library copies all arrays. Bodies, unknowns and rows count from 1; rows are numbered for each kind separately:
!> FETI_INEQUALITY (B u <= c) and FETI_EQUALITY (H u = h). A refused call leaves the problem unchanged. `stat` and
!> `errmsg`: see feti_contact_base.
module feti_contact_rows
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_loc, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  use feti_contact_base, only: address_of, feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_OK, &
    c_rows_add_i32 => feti_rows_add_i32, &
    c_rows_add_i64 => feti_rows_add_i64, &
    c_rows_clear => feti_rows_clear, &
    c_rows_compliance => feti_rows_compliance, &
    c_rows_rhs => feti_rows_rhs
  implicit none
  private
  public :: rows_add, rows_rhs, rows_compliance, rows_clear

  !> Rows B u <= c (kind FETI_INEQUALITY) or H u = h (FETI_EQUALITY), added after the rows of earlier calls.
  !>
  !> call feti_rows_add(p, kind, row_ptr, body, dof, val, rhs, first): row i holds the entries row_ptr(i) ..
  !>   row_ptr(i+1)-1 of body, dof and val: coefficient val of unknown dof of that body. Repeated entries add up.
  !> call feti_rows_add(p, kind, row_ptr, dof, val, rhs, first): dof is the host's number of the unknown
  !>   (feti_body_numbering) or, without such numbers, counts the unknowns of all bodies consecutively.
  !>
  !> row_ptr has one more entry than there are rows; row_ptr, body and dof are all int32 or all int64. rhs: gaps c or
  !> values h, one per row, length; absent: zero. first: number of the first new row of its kind.
  interface rows_add
    module procedure rows_int32, rows_int64, concatenated_int32, concatenated_int64
  end interface

contains

  !> Body and unknown of every entry, int32.
  recursive subroutine rows_int32(p, kind, row_ptr, body, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int32), intent(in), contiguous :: row_ptr(:), dof(:)
    integer(int32), intent(in), contiguous, target :: body(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: bodies

    bodies = c_null_ptr
    if (size(body) > 0) bodies = c_loc(body)
    if (size(body) /= size(dof)) then
      call refuse(5, 'feti_rows_add: body and dof differ in size', stat, errmsg)
    else
      call add_int32(p, kind, row_ptr, bodies, dof, val, rhs, first, stat, errmsg)
    end if
  end subroutine

  !> Body and unknown of every entry, int64.
  recursive subroutine rows_int64(p, kind, row_ptr, body, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int64), intent(in), contiguous :: row_ptr(:), dof(:)
    integer(int64), intent(in), contiguous, target :: body(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: bodies

    bodies = c_null_ptr
    if (size(body) > 0) bodies = c_loc(body)
    if (size(body) /= size(dof)) then
      call refuse(5, 'feti_rows_add: body and dof differ in size', stat, errmsg)
    else
      call add_int64(p, kind, row_ptr, bodies, dof, val, rhs, first, stat, errmsg)
    end if
  end subroutine

  !> Unknowns counted consecutively over all bodies, or given by the numbers of the host; int32.
  recursive subroutine concatenated_int32(p, kind, row_ptr, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int32), intent(in), contiguous :: row_ptr(:), dof(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call add_int32(p, kind, row_ptr, c_null_ptr, dof, val, rhs, first, stat, errmsg)
  end subroutine

  !> Like the procedure above, with int64.
  recursive subroutine concatenated_int64(p, kind, row_ptr, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int64), intent(in), contiguous :: row_ptr(:), dof(:)
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call add_int64(p, kind, row_ptr, c_null_ptr, dof, val, rhs, first, stat, errmsg)
  end subroutine

  !> bodies: address of one body number per entry, or NULL.
  recursive subroutine add_int32(p, kind, row_ptr, bodies, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int32), intent(in), contiguous :: row_ptr(:), dof(:)
    type(c_ptr), intent(in) :: bodies
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first, stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: start
    integer(c_int32_t) :: status
    character(len=:), allocatable :: fault
    integer :: entries, k

    entries = 0
    if (size(row_ptr) > 0) entries = row_ptr(size(row_ptr)) - 1
    call compare_sizes(size(row_ptr, kind=int64) - 1, int(entries, int64), size(dof, kind=int64), &
      size(val, kind=int64), rhs, k, fault)
    start = -1
    if (len(fault) > 0) then
      call refuse(k, fault, stat, errmsg)
    else
      status = c_rows_add_i32(handle_of(p), kind, size(row_ptr, kind=c_int64_t) - 1, row_ptr, &
        bodies, dof, val, 1_c_int32_t, address_of(rhs), c_loc(start))
      call finish(status, stat, errmsg)
    end if
    if (present(first)) first = int(start) + 1
  end subroutine

  !> Like the procedure above, for 8-byte integers.
  recursive subroutine add_int64(p, kind, row_ptr, bodies, dof, val, rhs, first, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer(int64), intent(in), contiguous :: row_ptr(:), dof(:)
    type(c_ptr), intent(in) :: bodies
    real(real64), intent(in), contiguous :: val(:)
    real(real64), intent(in), contiguous, optional, target :: rhs(:)
    integer, intent(out), optional :: first, stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: start
    integer(c_int32_t) :: status
    character(len=:), allocatable :: fault
    integer(int64) :: entries
    integer :: k

    entries = 0
    if (size(row_ptr) > 0) entries = row_ptr(size(row_ptr)) - 1
    call compare_sizes(size(row_ptr, kind=int64) - 1, entries, size(dof, kind=int64), size(val, kind=int64), &
      rhs, k, fault)
    start = -1
    if (len(fault) > 0) then
      call refuse(k, fault, stat, errmsg)
    else
      status = c_rows_add_i64(handle_of(p), kind, size(row_ptr, kind=c_int64_t) - 1, row_ptr, &
        bodies, dof, val, 1_c_int32_t, address_of(rhs), c_loc(start))
      call finish(status, stat, errmsg)
    end if
    if (present(first)) first = int(start) + 1
  end subroutine

  !> fault: describes a mismatch, empty if the arrays match; k: number of the wrong argument in the C function.
  recursive subroutine compare_sizes(rows, entries, dofs, vals, rhs, k, fault)
    integer(int64), intent(in) :: rows, entries, dofs, vals
    real(real64), intent(in), optional :: rhs(:)
    integer, intent(out) :: k
    character(len=:), allocatable, intent(out) :: fault

    k = 4
    fault = ''
    if (rows < 0) then
      fault = 'feti_rows_add: row_ptr is empty, it has one entry more than there are rows'
    else if (entries > min(dofs, vals)) then
      fault = 'feti_rows_add: row_ptr points behind the end of dof or val'
    end if
    if (.not. present(rhs)) return
    if (size(rhs, kind=int64) == rows .or. len(fault) > 0) return
    k = 9
    fault = 'feti_rows_add: rhs has not one entry per row'
  end subroutine

  !> New right-hand sides, rhs(:), length, for the rows first, first+1, ... of a kind.
  recursive subroutine rows_rhs(p, kind, first, rhs, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, intent(in) :: first
    real(real64), intent(in), contiguous :: rhs(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_rows_rhs(handle_of(p), kind, int(first - 1, c_int64_t), &
      size(rhs, kind=c_int64_t), rhs), stat, errmsg)
  end subroutine

  !> Makes rows first, first+1, ... of a kind springs, B u - c <= lambda/k or H u - h = mu/k: inv_k(:) = 1/k >= 0, length
  !> / force, 0 for a rigid row. New rows are rigid. The factors of the bodies stay valid; the last answer is dropped.
  recursive subroutine rows_compliance(p, kind, first, inv_k, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, intent(in) :: first
    real(real64), intent(in), contiguous :: inv_k(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_rows_compliance(handle_of(p), kind, int(first - 1, c_int64_t), &
      size(inv_k, kind=c_int64_t), inv_k), stat, errmsg)
  end subroutine

  !> Removes all rows of a kind; removing the contact rows also removes all nodes with friction.
  recursive subroutine rows_clear(p, kind, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_rows_clear(handle_of(p), kind), stat, errmsg)
  end subroutine

end module
