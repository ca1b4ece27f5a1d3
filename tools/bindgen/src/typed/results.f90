
  !> Time and memory of a phase of a setup or a solve.
  type :: feti_phase
    character(len=:), allocatable :: name
    !> Wall time in the last setup or solve.
    real(real64) :: seconds = 0
    !> Bytes of the data that the phase computed and keeps; 0: not counted.
    integer(int64) :: bytes = 0
  end type
contains
  !> Phase k, from 1 to the number of phases, in the last setup or solve.
  recursive subroutine phase_at(p, k, phase, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: k
    type(feti_phase), intent(out) :: phase
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_phase) :: found
    integer(c_int32_t) :: status

    found%struct_size = c_sizeof(found)
    status = feti_phase_at(handle_of(p), int(k - 1, c_int64_t), found)
    if (status == FETI_OK) then
      phase%name = f_text(found%name)
      phase%seconds = found%seconds
      phase%bytes = found%bytes
    end if
    call finish(status, stat, errmsg)
  end subroutine
