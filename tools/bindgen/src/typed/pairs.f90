contains
  !> The same number for all nodes of the pair.
  recursive subroutine set_one(p, pair, name, value, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: pair
    character(len=*), intent(in) :: name
    real(real64), intent(in) :: value
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call set_all(p, pair, name, [value], stat, errmsg)
  end subroutine
