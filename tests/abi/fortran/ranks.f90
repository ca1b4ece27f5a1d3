!> Functions of the host in Fortran for messages: the other rank returns every message as it is, which is an answer to the end of the
!> service. A problem without lent bodies is solved as ever.
module echo
  use, intrinsic :: iso_c_binding
  implicit none

  !> What has been sent and not received.
  type :: channel
    integer(c_int8_t) :: bytes(1000) = 0
    integer :: waiting = 0, sent = 0, received = 0, released = 0
  end type

contains

  recursive integer(c_int32_t) function send_bytes(user, rank, bytes, data) bind(C)
    type(c_ptr), value :: user, data
    integer(c_int32_t), value :: rank
    integer(c_int64_t), value :: bytes
    type(channel), pointer :: to
    integer(c_int8_t), pointer :: given(:)

    call c_f_pointer(user, to)
    call c_f_pointer(data, given, [bytes])
    send_bytes = 1
    if (rank /= 1 .or. to%waiting + bytes > size(to%bytes)) return
    to%bytes(to%waiting + 1:to%waiting + int(bytes)) = given
    to%waiting = to%waiting + int(bytes)
    to%sent = to%sent + 1
    send_bytes = 0
  end function

  recursive integer(c_int32_t) function flush_bytes(user) bind(C)
    type(c_ptr), value :: user

    flush_bytes = merge(0, 1, c_associated(user))
  end function

  recursive integer(c_int32_t) function receive_bytes(user, rank, bytes, data) bind(C)
    type(c_ptr), value :: user, data
    integer(c_int32_t), value :: rank
    integer(c_int64_t), value :: bytes
    type(channel), pointer :: from
    integer(c_int8_t), pointer :: taken(:)

    call c_f_pointer(user, from)
    call c_f_pointer(data, taken, [bytes])
    receive_bytes = 1
    if (rank /= 1 .or. bytes > from%waiting) return
    taken = from%bytes(:int(bytes))
    from%bytes(:from%waiting - int(bytes)) = from%bytes(int(bytes) + 1:from%waiting)
    from%waiting = from%waiting - int(bytes)
    from%received = from%received + 1
    receive_bytes = 0
  end function

  recursive subroutine release(user) bind(C)
    type(c_ptr), value :: user
    type(channel), pointer :: of

    call c_f_pointer(user, of)
    of%released = of%released + 1
  end subroutine

end module

program ranks
  use, intrinsic :: iso_c_binding
  use echo
  use feti_contact
  implicit none
  type(channel), target :: other
  type(feti_communicator) :: by
  type(feti_problem) :: p
  integer :: stat

  by%struct_size = 0 ! set by the procedures
  by%rank = 0
  by%size = 2
  by%local_size = 1
  by%reserved0 = 0
  by%user = c_loc(other)
  by%send = c_funloc(send_bytes)
  by%flush = c_funloc(flush_bytes)
  by%receive = c_funloc(receive_bytes)
  by%release = c_funloc(release)
  by%reserved = c_null_ptr

  call feti_problem_create(p)
  call feti_communicator_set(p, by)
  call feti_communicator_set(p, by, stat)
  if (stat /= FETI_STATE) error stop 'a second table is taken'
  call feti_serve(by)
  if (other%sent == 0 .or. other%received == 0 .or. other%waiting /= 0) error stop 'no message'
  if (other%released /= 0) error stop 'released too early'
  call feti_problem_destroy(p)
  if (other%released /= 1) error stop 'not released once'

  by%rank = 2
  call feti_serve(by, stat)
  if (stat /= FETI_ARGUMENT - 1) error stop 'a rank beyond the size is taken'
end program
