!> Size of every interoperable type and offset of its last component, in bytes, as Fortran sees them (layout.c compares).
!> Order: feti_error_detail, feti_option, feti_info, feti_certificate, feti_progress, feti_findings,
!> feti_phase, feti_body_facts, feti_pair_facts, feti_communicator.
subroutine layout_in_fortran(size, last) bind(C, name="layout_in_fortran")
  use, intrinsic :: iso_c_binding, only: c_int64_t, c_intptr_t, c_loc, c_ptr, c_sizeof
  use feti_contact_c, only: feti_body_facts, feti_certificate, feti_communicator, feti_error_detail, feti_findings, feti_info, &
    feti_option, feti_pair_facts, feti_phase, feti_progress
  implicit none
  integer(c_int64_t), intent(out) :: size(10), last(10)
  type(feti_error_detail), target :: detail
  type(feti_option), target :: option
  type(feti_info), target :: info
  type(feti_certificate), target :: certificate
  type(feti_progress), target :: progress
  type(feti_findings), target :: findings
  type(feti_phase), target :: phase
  type(feti_body_facts), target :: facts
  type(feti_pair_facts), target :: pair_facts
  type(feti_communicator), target :: communicator

  size = int([c_sizeof(detail), c_sizeof(option), c_sizeof(info), c_sizeof(certificate), &
    c_sizeof(progress), c_sizeof(findings), c_sizeof(phase), c_sizeof(facts), c_sizeof(pair_facts), &
    c_sizeof(communicator)], c_int64_t)
  last = [distance(c_loc(detail), c_loc(detail%face)), &
    distance(c_loc(option), c_loc(option%default_str)), &
    distance(c_loc(info), c_loc(info%seconds_leading)), &
    distance(c_loc(certificate), c_loc(certificate%pair_node)), &
    distance(c_loc(progress), c_loc(progress%fraction)), &
    distance(c_loc(findings), c_loc(findings%pair_node)), &
    distance(c_loc(phase), c_loc(phase%name)), &
    distance(c_loc(facts), c_loc(facts%pieces)), &
    distance(c_loc(pair_facts), c_loc(pair_facts%held_overlap)), &
    distance(c_loc(communicator), c_loc(communicator%reserved))]

contains

  !> Bytes from address a to address b.
  pure integer(c_int64_t) function distance(a, b)
    type(c_ptr), intent(in) :: a, b

    distance = int(transfer(b, 0_c_intptr_t) - transfer(a, 0_c_intptr_t), c_int64_t)
  end function

end subroutine
