  !> int64 labels and directions. FETI_OVERFLOW if a value needs more than 32 bits; the body then keeps its previous data.
  recursive subroutine coordinates_int64(p, body, node, dir, xyz, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int64), intent(in), contiguous :: node(:), dir(:)
    real(real64), intent(in), contiguous :: xyz(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(int64), parameter :: most = huge(1_int32)

    if (any(node < -most .or. node > most) .or. any(dir < -most .or. dir > most)) then
      call finish(FETI_OVERFLOW, stat, errmsg, 'feti_body_coordinates: a number of node or dir needs more than 32 bits')
    else
      call coordinates_int32(p, body, int(node, int32), int(dir, int32), xyz, stat, errmsg)
    end if
  end subroutine

  !> The null space that the library uses for a body with n unknowns: R is allocated n x r.
  recursive subroutine body_null_space_get(p, body, n, R, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body, n
    real(real64), allocatable, intent(out), target :: R(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: columns
    integer(c_int32_t) :: status

    columns = 0
    status = feti_body_null_space_get(handle_of(p), int(body - 1, c_int64_t), int(n, c_int64_t), columns, &
      c_null_ptr, int(n, c_int64_t))
    if (status == FETI_OK) then
      allocate (R(n, columns))
      if (size(R) > 0) status = feti_body_null_space_get(handle_of(p), int(body - 1, c_int64_t), int(n, c_int64_t), &
        columns, c_loc(R), int(n, c_int64_t))
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> The unknowns that K+ holds, dof(r), where r is the dimension of the null space; with size 0 the library chooses them.
  !> The choice affects the iterations of the paper's methods in printed units, but neither forces nor displacements.
  recursive subroutine body_fixing_set(p, body, dof, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, intent(in) :: dof(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: numbers(max(1, size(dof)))

    numbers = 0
    numbers(:size(dof)) = int(dof, c_int64_t) - 1
    call finish(feti_body_fixing_set(handle_of(p), int(body - 1, c_int64_t), size(dof, kind=c_int64_t), c_loc(numbers)), &
      stat, errmsg)
  end subroutine
