  !> Rows of one kind that contradict each other, with their weights w: over both kinds sum w b = 0 and sum w c < 0.
  !> Without a contradiction the redundant rows, each with its factor relative to the row that it repeats.
  recursive subroutine diagnosis_rows(p, kind, row, weight, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer(c_int32_t), intent(in) :: kind
    integer, allocatable, intent(out) :: row(:)
    real(real64), allocatable, intent(out) :: weight(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    real(real64), allocatable, target :: found(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = feti_diagnosis_rows(handle_of(p), kind, 0_c_int64_t, count, c_null_ptr, c_null_ptr)
    cap = count
    allocate (number(cap + 1), found(cap + 1))
    if (status == FETI_OK) status = feti_diagnosis_rows(handle_of(p), kind, cap, count, c_loc(number), c_loc(found))
    row = int(number(:cap)) + 1
    weight = found(:cap)
    call finish(status, stat, errmsg)
  end subroutine

  !> Equality rows that are linear combinations of the other equality rows.
  recursive subroutine diagnosis_dependent(p, row, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, allocatable, intent(out) :: row(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = feti_diagnosis_dependent(handle_of(p), 0_c_int64_t, count, c_null_ptr)
    cap = count
    allocate (number(cap + 1))
    if (status == FETI_OK) status = feti_diagnosis_dependent(handle_of(p), cap, count, c_loc(number))
    row = int(number(:cap)) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Bodies that no row touches.
  recursive subroutine diagnosis_untouched(p, body, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, allocatable, intent(out) :: body(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable, target :: number(:)
    integer(c_int64_t) :: cap, count
    integer(c_int32_t) :: status

    count = 0
    status = feti_diagnosis_untouched(handle_of(p), 0_c_int64_t, count, c_null_ptr)
    cap = count
    allocate (number(cap + 1))
    if (status == FETI_OK) status = feti_diagnosis_untouched(handle_of(p), cap, count, c_loc(number))
    body = int(number(:cap)) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Rigid body motion k among the motions that the last answer leaves undetermined: the body that moves fastest, and its
  !> motion(6), velocity of the origin and rotation about the axes; NaN without coordinates.
  recursive subroutine diagnosis_undetermined(p, k, body, motion, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: k
    integer, intent(out) :: body
    real(real64), intent(out) :: motion(6)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), target :: fastest
    real(real64), target :: found(6)
    integer(c_int32_t) :: status

    fastest = -1
    found = 0
    status = feti_diagnosis_undetermined(handle_of(p), int(k - 1, c_int64_t), c_loc(fastest), c_loc(found))
    body = int(fastest) + 1
    motion = found
    call finish(status, stat, errmsg)
  end subroutine
