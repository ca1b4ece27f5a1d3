!> Stiffness matrices of module feti_contact. A host uses feti_contact, not this module.
!>
!> The library copies all arrays except those given to feti_body_stiffness_borrow, so the host may reuse them after each
!> call. Sizes are taken from the arrays and compared with the n of feti_body_add. Bodies and unknowns count from 1. A
!> refused call leaves the problem unchanged. The compiler copies arrays that are not contiguous. `stat` and `errmsg`: see
!> feti_contact_base.
module feti_contact_stiffness
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_sizeof
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  use feti_contact_base, only: feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_BORROW, FETI_COPY, FETI_OK, FETI_STATE, feti_body_facts, &
    c_body_info => feti_body_info, &
    c_body_stiffness_dense => feti_body_stiffness_dense, &
    c_body_stiffness_i32 => feti_body_stiffness_i32, &
    c_body_stiffness_i64 => feti_body_stiffness_i64, &
    c_body_stiffness_split_i32 => feti_body_stiffness_split_i32, &
    c_body_stiffness_split_i64 => feti_body_stiffness_split_i64, &
    c_body_values => feti_body_values, &
    c_body_values_dense => feti_body_values_dense, &
    c_body_values_split => feti_body_values_split
  implicit none
  private
  public :: body_stiffness, body_stiffness_split, body_values, body_values_split
  public :: body_stiffness_borrow, body_values_borrow

  !> Stiffness of a body, n x n, force / length; a second call replaces the first.
  !>
  !> call feti_body_stiffness(p, body, row_ptr, col, val, storage): by rows, row i holds the entries
  !>   row_ptr(i) .. row_ptr(i+1)-1 of col and val; row_ptr(n+1); all counted from 1, int32 or int64.
  !> call feti_body_stiffness(p, body, k, storage): the whole matrix k(n,n).
  !>
  !> storage: FETI_FULL, or FETI_LOWER or FETI_UPPER (only this triangle is given; of k(n,n) only this triangle is read).
  !> If the host stores the columns of the lower triangle, use FETI_UPPER, because they are the rows of the upper
  !> triangle.
  interface body_stiffness
    module procedure stiffness_int32, stiffness_int64, stiffness_dense
  end interface

  !> Stiffness of a body whose diagonal diag(n) is a separate array; row_ptr, col and val are as for feti_body_stiffness,
  !> but without diagonal entries.
  !>
  !> call feti_body_stiffness_split(p, body, diag, row_ptr, col, val, storage): row_ptr and col int32 or int64.
  interface body_stiffness_split
    module procedure split_int32, split_int64
  end interface

  !> Works like feti_body_stiffness by rows, but the library uses the values in the array of the pointer val without a
  !> copy, if storage is FETI_LOWER, columns ascend and every row ends with its diagonal entry. Otherwise it copies
  !> everything (see feti_body_info).
  !>
  !> call feti_body_stiffness_borrow(p, body, row_ptr, col, val, storage): row_ptr and col int32 or int64.
  !>
  !> The array must exist until the matrix is replaced or the problem is destroyed: allocate it through the pointer, or
  !> give it the target attribute in a main program, in a module or with save. Do not use a local variable without save,
  !> which ends with its procedure, or a dummy argument, whose actual argument may be a copy. The host may change the
  !> values only between two calls, and its next call for the problem must then be feti_body_values_borrow.
  interface body_stiffness_borrow
    module procedure borrow_int32, borrow_int64
  end interface

  !> New values for a stiffness matrix with its existing pattern; the next setup costs one numeric factorisation of the
  !> body.
  !>
  !> call feti_body_values(p, body, val): for a matrix by rows, val in the same order as in the first call.
  !> call feti_body_values(p, body, k): for a matrix k(n,n), in the same storage.
  interface body_values
    module procedure values_by_rows, values_dense
  end interface

contains

  !> By rows, int32 indices.
  recursive subroutine stiffness_int32(p, body, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int32), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), intent(in), contiguous :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) == 0) then
      call refuse(4, 'feti_body_stiffness: row_ptr is empty, it has one entry more than the body has unknowns', &
        stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col), size(val))) then
      call refuse(5, 'feti_body_stiffness: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_i32(handle_of(p), int(body - 1, c_int64_t), size(row_ptr, kind=c_int64_t) - 1, &
        row_ptr, col, val, 1_c_int32_t, storage, FETI_COPY), stat, errmsg)
    end if
  end subroutine

  !> By rows, int64 indices.
  recursive subroutine stiffness_int64(p, body, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int64), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), intent(in), contiguous :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) == 0) then
      call refuse(4, 'feti_body_stiffness: row_ptr is empty, it has one entry more than the body has unknowns', &
        stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col, kind=int64), size(val, kind=int64))) then
      call refuse(5, 'feti_body_stiffness: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_i64(handle_of(p), int(body - 1, c_int64_t), size(row_ptr, kind=c_int64_t) - 1, &
        row_ptr, col, val, 1_c_int32_t, storage, FETI_COPY), stat, errmsg)
    end if
  end subroutine

  !> The whole matrix.
  recursive subroutine stiffness_dense(p, body, k, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: k(:, :)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(k, 1) /= size(k, 2)) then
      call refuse(4, 'feti_body_stiffness: k is not square', stat, errmsg)
    else
      call finish(c_body_stiffness_dense(handle_of(p), int(body - 1, c_int64_t), size(k, 1, c_int64_t), &
        k, size(k, 1, c_int64_t), storage, FETI_COPY), stat, errmsg)
    end if
  end subroutine

  !> int32 indices.
  recursive subroutine split_int32(p, body, diag, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: diag(:)
    integer(int32), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), intent(in), contiguous :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) /= size(diag) + 1) then
      call refuse(5, 'feti_body_stiffness_split: row_ptr has not one entry more than diag', stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col, kind=int64), size(val, kind=int64))) then
      call refuse(6, 'feti_body_stiffness_split: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_split_i32(handle_of(p), int(body - 1, c_int64_t), size(diag, kind=c_int64_t), &
        diag, row_ptr, col, val, 1_c_int32_t, storage, FETI_COPY), stat, errmsg)
    end if
  end subroutine

  !> int64 indices.
  recursive subroutine split_int64(p, body, diag, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: diag(:)
    integer(int64), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), intent(in), contiguous :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) /= size(diag) + 1) then
      call refuse(5, 'feti_body_stiffness_split: row_ptr has not one entry more than diag', stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col, kind=int64), size(val, kind=int64))) then
      call refuse(6, 'feti_body_stiffness_split: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_split_i64(handle_of(p), int(body - 1, c_int64_t), size(diag, kind=c_int64_t), &
        diag, row_ptr, col, val, 1_c_int32_t, storage, FETI_COPY), stat, errmsg)
    end if
  end subroutine

  !> int32 indices.
  recursive subroutine borrow_int32(p, body, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int32), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), pointer, contiguous, intent(in) :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) == 0) then
      call refuse(4, 'feti_body_stiffness_borrow: row_ptr is empty, it has one entry more than the body has unknowns', &
        stat, errmsg)
    else if (.not. associated(val)) then
      call refuse(6, 'feti_body_stiffness_borrow: val is not associated', stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col, kind=int64), size(val, kind=int64))) then
      call refuse(5, 'feti_body_stiffness_borrow: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_i32(handle_of(p), int(body - 1, c_int64_t), size(row_ptr, kind=c_int64_t) - 1, &
        row_ptr, col, val, 1_c_int32_t, storage, FETI_BORROW), stat, errmsg)
    end if
  end subroutine

  !> int64 indices.
  recursive subroutine borrow_int64(p, body, row_ptr, col, val, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int64), intent(in), contiguous :: row_ptr(:), col(:)
    real(real64), pointer, contiguous, intent(in) :: val(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(row_ptr) == 0) then
      call refuse(4, 'feti_body_stiffness_borrow: row_ptr is empty, it has one entry more than the body has unknowns', &
        stat, errmsg)
    else if (.not. associated(val)) then
      call refuse(6, 'feti_body_stiffness_borrow: val is not associated', stat, errmsg)
    else if (row_ptr(size(row_ptr)) - 1 > min(size(col, kind=int64), size(val, kind=int64))) then
      call refuse(5, 'feti_body_stiffness_borrow: row_ptr points behind the end of col or val', stat, errmsg)
    else
      call finish(c_body_stiffness_i64(handle_of(p), int(body - 1, c_int64_t), size(row_ptr, kind=c_int64_t) - 1, &
        row_ptr, col, val, 1_c_int32_t, storage, FETI_BORROW), stat, errmsg)
    end if
  end subroutine

  !> Values for a matrix by rows.
  recursive subroutine values_by_rows(p, body, val, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: val(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (is_borrowed(p, body)) then
      call finish(FETI_STATE, stat, errmsg, 'feti_body_values: the values are borrowed, new ones come by feti_body_values_borrow')
    else
      call finish(c_body_values(handle_of(p), int(body - 1, c_int64_t), size(val, kind=c_int64_t), val), stat, errmsg)
    end if
  end subroutine

  !> New values for a borrowed matrix: the host has rewritten the borrowed array, or val points to another array that
  !> replaces it. The rules of feti_body_stiffness_borrow apply to val. If the matrix is not borrowed, the values are
  !> copied.
  recursive subroutine body_values_borrow(p, body, val, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), pointer, contiguous, intent(in) :: val(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (.not. associated(val)) then
      call refuse(4, 'feti_body_values_borrow: val is not associated', stat, errmsg)
    else
      call finish(c_body_values(handle_of(p), int(body - 1, c_int64_t), size(val, kind=c_int64_t), val), stat, errmsg)
    end if
  end subroutine

  !> feti_body_values may receive a temporary copy made by the compiler, which the library must not borrow.
  recursive logical function is_borrowed(p, body)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    type(feti_body_facts) :: facts

    facts%struct_size = c_sizeof(facts)
    facts%borrowed = 0
    is_borrowed = c_body_info(handle_of(p), int(body - 1, c_int64_t), facts) == FETI_OK .and. facts%borrowed > 0
  end function

  !> Values for a matrix given as a whole.
  recursive subroutine values_dense(p, body, k, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: k(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(k, 1) /= size(k, 2)) then
      call refuse(4, 'feti_body_values: k is not square', stat, errmsg)
    else
      call finish(c_body_values_dense(handle_of(p), int(body - 1, c_int64_t), size(k, 1, c_int64_t), k, &
        size(k, 1, c_int64_t)), stat, errmsg)
    end if
  end subroutine

  !> New values for a matrix with a separate diagonal: diag(n), and val in the same order as in the first call.
  recursive subroutine body_values_split(p, body, diag, val, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: diag(:), val(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_values_split(handle_of(p), int(body - 1, c_int64_t), size(diag, kind=c_int64_t), diag, &
      size(val, kind=c_int64_t), val), stat, errmsg)
  end subroutine

end module
