
  !> One setting as the library describes it.
  type :: feti_option
    character(len=:), allocatable :: name, doc
    !> FETI_OPTION_F64, FETI_OPTION_I64 or FETI_OPTION_STR.
    integer :: type = 0
    !> Range of a number.
    real(real64) :: minimum = 0, maximum = 0
    !> Default, in the field of its type.
    real(real64) :: default_real = 0
    integer(int64) :: default_integer = 0
    character(len=:), allocatable :: default_text
  end type
contains
  !> An option that is an integer.
  recursive subroutine set_int32(p, name, value, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: name
    integer(int32), intent(in) :: value
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call set_int64(p, name, int(value, int64), stat, errmsg)
  end subroutine

  !> Like the procedure above, with int64.
  recursive subroutine set_int64(p, name, value, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: name
    integer(int64), intent(in) :: value
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(feti_set_i64(handle_of(p), c_text(name), value), stat, errmsg)
  end subroutine

  !> FETI_OVERFLOW, with value unchanged, if the setting needs a larger integer.
  recursive subroutine get_int32(p, name, value, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: name
    integer(int32), intent(inout) :: value
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: wide
    integer(c_int32_t) :: status

    status = feti_get_i64(handle_of(p), c_text(name), wide)
    if (status /= FETI_OK) then
      call finish(status, stat, errmsg)
    else if (abs(wide) > huge(value)) then
      call finish(FETI_OVERFLOW, stat, errmsg, 'feti_get: ' // name // ' needs an integer(int64)')
    else
      value = int(wide, int32)
      call finish(FETI_OK, stat, errmsg)
    end if
  end subroutine

  !> value gets the length of the text.
  recursive subroutine get_text(p, name, value, stat, errmsg)
    type(feti_problem), intent(in) :: p
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(inout) :: value
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    character(kind=c_char), allocatable, target :: buffer(:)
    integer(c_int64_t) :: length
    integer(c_int32_t) :: status

    length = 0
    status = feti_get_str(handle_of(p), c_text(name), c_null_ptr, 0_c_int64_t, length)
    if (status == FETI_OK) then
      allocate (buffer(length + 1))
      status = feti_get_str(handle_of(p), c_text(name), c_loc(buffer), size(buffer, kind=c_int64_t), length)
      if (status == FETI_OK) value = f_text(c_loc(buffer))
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> Number of settings.
  recursive integer function option_count()
    option_count = int(feti_option_count())
  end function

  !> Setting k, from 1 to feti_option_count().
  recursive subroutine option_at(k, option, stat, errmsg)
    integer, intent(in) :: k
    type(feti_option), intent(out) :: option
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_option) :: found
    integer(c_int32_t) :: status

    found%struct_size = c_sizeof(found)
    status = feti_option_at(int(k - 1, c_int64_t), found)
    if (status == FETI_OK) then
      option%name = f_text(found%name)
      option%doc = f_text(found%doc)
      option%type = found%type
      option%minimum = found%minimum
      option%maximum = found%maximum
      option%default_real = found%default_f64
      option%default_integer = found%default_i64
      option%default_text = f_text(found%default_str)
    end if
    call finish(status, stat, errmsg)
  end subroutine
