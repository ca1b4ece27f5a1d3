!> Bodies by their elements, of module feti_contact. A host uses feti_contact, not this module.
!>
!> The library adds up all matrices at once, so the host may reuse its arrays after each call. Bodies, elements and
!> unknowns count from 1. A refused call leaves the problem unchanged. The compiler copies arrays that are not contiguous.
!> `stat` and `errmsg`: see feti_contact_base.
module feti_contact_elements
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  use feti_contact_base, only: feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_FULL, FETI_OK, &
    c_body_element => feti_body_element, &
    c_body_elements => feti_body_elements, &
    c_body_elements_size => feti_body_elements_size, &
    c_body_held_forces => feti_body_held_forces, &
    c_body_mesh_i32 => feti_body_mesh_i32, &
    c_body_mesh_i64 => feti_body_mesh_i64, &
    c_body_pieces => feti_body_pieces
  implicit none
  private
  public :: body_mesh, body_element, body_elements, body_elements_size, body_held_forces, body_pieces

  !> The connectivity of the elements of a body: the first step of giving K by elements, instead of feti_body_stiffness.
  !>
  !> call feti_body_mesh(p, body, ptr, dof): element e joins the entries ptr(e) .. ptr(e+1)-1 of dof, in the order of the rows
  !>   of its matrix; ptr(elements+1); counted from 1, int32 or int64.
  !>
  !> A number below 1 means a held unknown, whose row and column are left out: 0 means held unknown 1, -1 means held
  !> unknown 2, and so on. If feti_body_held_forces is not used, all of them may be 0. Give option pieces and
  !> feti_body_coordinates before the first matrix, because the cut depends on them. Another call with the same
  !> connectivity begins a new pass with the same pattern and the same cut.
  interface body_mesh
    module procedure mesh_int32, mesh_int64
  end interface

  !> The matrices of a block of elements, beginning with element `first`, one after the other; give every element once in
  !> a pass.
  !>
  !> call feti_body_elements(p, body, first, count, ke, storage): ke(:) has the matrices of `count` elements; FETI_FULL: n x n
  !>   each; FETI_LOWER or FETI_UPPER: that triangle column by column, n (n + 1) / 2 numbers each.
  !> call feti_body_elements(p, body, first, ke): ke(n,n,count), all of one size.
  interface body_elements
    module procedure elements_packed, elements_full
  end interface

contains

  !> int32 indices.
  recursive subroutine mesh_int32(p, body, ptr, dof, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int32), intent(in), contiguous :: ptr(:), dof(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(ptr) == 0) then
      call refuse(4, 'feti_body_mesh: ptr is empty, it has one entry more than the body has elements', stat, errmsg)
    else if (ptr(size(ptr)) - 1 > size(dof, kind=int64)) then
      call refuse(5, 'feti_body_mesh: ptr points behind the end of dof', stat, errmsg)
    else
      call finish(c_body_mesh_i32(handle_of(p), int(body - 1, c_int64_t), size(ptr, kind=c_int64_t) - 1, ptr, dof, &
        1_c_int32_t), stat, errmsg)
    end if
  end subroutine

  !> int64 indices.
  recursive subroutine mesh_int64(p, body, ptr, dof, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int64), intent(in), contiguous :: ptr(:), dof(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(ptr) == 0) then
      call refuse(4, 'feti_body_mesh: ptr is empty, it has one entry more than the body has elements', stat, errmsg)
    else if (ptr(size(ptr)) - 1 > size(dof, kind=int64)) then
      call refuse(5, 'feti_body_mesh: ptr points behind the end of dof', stat, errmsg)
    else
      call finish(c_body_mesh_i64(handle_of(p), int(body - 1, c_int64_t), size(ptr, kind=c_int64_t) - 1, ptr, dof, &
        1_c_int32_t), stat, errmsg)
    end if
  end subroutine

  !> The matrix ke(n,n) of element e, for a call in the host's assembly loop. The library adds the matrix at once and does
  !> not keep it. Give every element once in a pass; the first element after a complete pass begins the next pass, with
  !> new values for the same pattern and cut.
  recursive subroutine body_element(p, body, e, ke, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, e
    real(real64), intent(in), contiguous :: ke(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(ke, 1) /= size(ke, 2)) then
      call refuse(5, 'feti_body_element: ke is not square', stat, errmsg)
    else
      call finish(c_body_element(handle_of(p), int(body - 1, c_int64_t), int(e, c_int64_t) - 1, size(ke, 1, c_int64_t), ke, &
        size(ke, 1, c_int64_t)), stat, errmsg)
    end if
  end subroutine

  !> In any storage.
  recursive subroutine elements_packed(p, body, first, count, ke, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, first, count
    real(real64), intent(in), contiguous :: ke(:)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call add_block(p, body, [first, count], size(ke, kind=c_int64_t), ke, storage, stat, errmsg)
  end subroutine

  !> Whole matrices of one size.
  recursive subroutine elements_full(p, body, first, ke, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, first
    real(real64), intent(in), contiguous :: ke(:, :, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(ke, 1) /= size(ke, 2)) then
      call refuse(5, 'feti_body_elements: the matrices are not square', stat, errmsg)
    else
      call add_block(p, body, [first, size(ke, 3)], size(ke, kind=c_int64_t), ke, FETI_FULL, stat, errmsg)
    end if
  end subroutine

  !> block(1): the first element; block(2): the number of elements. The library returns how many values they have.
  recursive subroutine add_block(p, body, block, given, ke, storage, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, block(2)
    integer(c_int64_t), intent(in) :: given
    real(real64), intent(in) :: ke(*)
    integer(c_int32_t), intent(in) :: storage
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: first, count, needed
    integer(c_int32_t) :: status

    first = int(block(1), c_int64_t) - 1
    count = int(block(2), c_int64_t)
    ! what this refuses feti_body_elements refuses as well, by the numbers of its own arguments
    status = c_body_elements_size(handle_of(p), int(body - 1, c_int64_t), first, count, storage, needed)
    if (status == FETI_OK .and. needed /= given) then
      call refuse(5, 'feti_body_elements: ke has not as many entries as the matrices of the elements', stat, errmsg)
    else
      call finish(c_body_elements(handle_of(p), int(body - 1, c_int64_t), first, count, ke, storage), stat, errmsg)
    end if
  end subroutine

  !> How many values feti_body_elements expects for `count` elements, beginning with element `first`, in the given
  !> storage.
  recursive subroutine body_elements_size(p, body, first, count, storage, nnz, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, first, count
    integer(c_int32_t), intent(in) :: storage
    integer(c_int64_t), intent(inout) :: nnz
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_elements_size(handle_of(p), int(body - 1, c_int64_t), int(first, c_int64_t) - 1, &
      int(count, c_int64_t), storage, nnz), stat, errmsg)
  end subroutine

  !> Forces on the held unknowns in the last answer: r(k) = K_hf u of held unknown k, which has the number 1 - k in
  !> feti_body_mesh; force. This is the support reaction without the part of prescribed values and without loads on the
  !> held unknowns themselves.
  recursive subroutine body_held_forces(p, body, r, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(inout), contiguous :: r(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_held_forces(handle_of(p), int(body - 1, c_int64_t), size(r, kind=c_int64_t), r), stat, errmsg)
  end subroutine

  !> The piece of every unknown of a body, piece(n), from 1. An unknown of several pieces gets the first one; all are 1 if
  !> the body is not cut.
  recursive subroutine body_pieces(p, body, piece, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, intent(inout) :: piece(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable :: found(:)
    integer(c_int32_t) :: status

    allocate (found(size(piece)))
    status = c_body_pieces(handle_of(p), int(body - 1, c_int64_t), size(found, kind=c_int64_t), found)
    if (status == FETI_OK) piece = int(found) + 1
    call finish(status, stat, errmsg)
  end subroutine

end module
