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
      call finish(feti_body_values(handle_of(p), int(body - 1, c_int64_t), size(val, kind=c_int64_t), val), stat, errmsg)
    end if
  end subroutine

  !> feti_body_values may receive a temporary copy made by the compiler, which the library must not borrow.
  recursive logical function is_borrowed(p, body)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    type(feti_body_facts) :: facts

    facts%struct_size = c_sizeof(facts)
    facts%borrowed = 0
    is_borrowed = feti_body_info(handle_of(p), int(body - 1, c_int64_t), facts) == FETI_OK .and. facts%borrowed > 0
  end function
