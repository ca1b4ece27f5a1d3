contains
  !> Positions x(dim,nodes) of all nodes of the surface, length.
  recursive subroutine move_nodes(p, surface, x, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: surface
    real(real64), intent(in), contiguous :: x(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status
    integer(c_int64_t), target :: nodes

    nodes = 0
    status = feti_surface_counts(handle_of(p), int(surface - 1, c_int64_t), c_null_ptr, c_loc(nodes), c_null_ptr, &
      c_null_ptr)
    if (status /= FETI_OK) then
      call finish(status, stat, errmsg)
    else if (nodes == 0 .or. size(x, 2, c_int64_t) /= nodes) then
      call refuse(3, 'feti_surface_move: x has not one column per node', stat, errmsg)
    else
      call finish(feti_surface_move(handle_of(p), int(surface - 1, c_int64_t), x, size(x, 1, c_int64_t)), stat, errmsg)
    end if
  end subroutine

  !> data: as in feti_surface_rigid.
  recursive subroutine move_rigid(p, surface, data, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: surface
    real(real64), intent(in), contiguous :: data(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status
    integer(c_int64_t), target :: numbers

    numbers = 0
    status = feti_surface_counts(handle_of(p), int(surface - 1, c_int64_t), c_null_ptr, c_null_ptr, c_null_ptr, &
      c_loc(numbers))
    if (status /= FETI_OK) then
      call finish(status, stat, errmsg)
    else if (numbers == 0 .or. size(data, kind=c_int64_t) /= numbers) then
      call refuse(3, 'feti_surface_move: x is not the data of this rigid surface', stat, errmsg)
    else
      call finish(feti_surface_move(handle_of(p), int(surface - 1, c_int64_t), data, size(data, kind=c_int64_t)), stat, errmsg)
    end if
  end subroutine
