!> FORTRAN 77 interface: options by name. A refused name or value leaves the option unchanged. See docs/fortran77.md.

!> Sets the option name to a number: d.
recursive subroutine ftsetd(ip, name, d, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: name
  real(c_double), intent(in) :: d
  integer, intent(out) :: ierr

  ierr = told(feti_set_f64(handle(ip), c_text(name), d))
end subroutine

!> Sets the option name to an integer: i.
recursive subroutine ftseti(ip, name, i, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip, i
  character(len=*), intent(in) :: name
  integer, intent(out) :: ierr

  ierr = told(feti_set_i64(handle(ip), c_text(name), wide(i)))
end subroutine

!> Sets the option name to a text: text without its trailing blanks.
recursive subroutine ftsetc(ip, name, text, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: name, text
  integer, intent(out) :: ierr

  ierr = told(feti_set_str(handle(ip), c_text(name), c_text(text)))
end subroutine

!> Reads the option name, a number: d.
recursive subroutine ftgetd(ip, name, d, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: name
  real(c_double), intent(inout) :: d
  integer, intent(out) :: ierr

  ierr = told(feti_get_f64(handle(ip), c_text(name), d))
end subroutine

!> Reads the option name, an integer: i.
recursive subroutine ftgeti(ip, name, i, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: name
  integer, intent(inout) :: i
  integer, intent(out) :: ierr
  integer(c_int64_t) :: found

  ierr = told(feti_get_i64(handle(ip), c_text(name), found))
  if (ierr == FETI_OK) call fit(found, i, ierr)
end subroutine

!> Reads the option name, a text: text, truncated or padded with blanks, and its full length l.
recursive subroutine ftgetc(ip, name, text, l, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: name
  character(len=*), intent(inout) :: text
  integer, intent(inout) :: l
  integer, intent(out) :: ierr
  character(kind=c_char), target :: buffer(len(text) + 1)
  integer(c_int64_t) :: length

  ierr = told(feti_get_str(handle(ip), c_text(name), c_loc(buffer), size(buffer, kind=c_int64_t), length), [1, 2, 3, 3, 4])
  if (ierr == FETI_OK) call fit(length, l, ierr)
  if (ierr == FETI_OK) text = f_text(c_loc(buffer))
end subroutine

!> Number of options.
recursive subroutine ftoptn(n)
  use feti_contact_f77_base
  implicit none
  integer, intent(out) :: n

  n = clipped(feti_option_count())
end subroutine

!> Option k, from 1: name, one sentence doc, type ityp (FTODBL, FTOINT, FTOCHR), range rmin to rmax of a number, and its
!> default in dflt, idflt or cdflt, depending on the type.
recursive subroutine ftopta(k, name, doc, ityp, rmin, rmax, dflt, idflt, cdflt, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: k
  character(len=*), intent(inout) :: name, doc, cdflt
  integer, intent(inout) :: ityp, idflt
  real(c_double), intent(inout) :: rmin, rmax, dflt
  integer, intent(out) :: ierr
  type(feti_option) :: found

  found%struct_size = storage_size(found, c_int64_t) / 8
  ierr = told(feti_option_at(from_zero(k), found))
  if (ierr /= FETI_OK) return
  name = f_text(found%name)
  doc = f_text(found%doc)
  cdflt = f_text(found%default_str)
  ityp = int(found%type)
  rmin = found%minimum
  rmax = found%maximum
  dflt = found%default_f64
  idflt = clipped(found%default_i64)
end subroutine

!> Sets several options with one text, such as 'tolerance=1e-8 threads=4': all or none.
recursive subroutine ftsett(ip, text, ierr)
  use feti_contact_f77_base
  implicit none
  integer, intent(in) :: ip
  character(len=*), intent(in) :: text
  integer, intent(out) :: ierr

  ierr = told(feti_set_text(handle(ip), c_text(text)))
end subroutine
