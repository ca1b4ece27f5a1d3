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
    status = feti_body_elements_size(handle_of(p), int(body - 1, c_int64_t), first, count, storage, needed)
    if (status == FETI_OK .and. needed /= given) then
      call refuse(5, 'feti_body_elements: ke has not as many entries as the matrices of the elements', stat, errmsg)
    else
      call finish(feti_body_elements(handle_of(p), int(body - 1, c_int64_t), first, count, ke, storage), stat, errmsg)
    end if
  end subroutine
