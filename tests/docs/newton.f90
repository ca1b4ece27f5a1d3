!> The fragment of docs/newton.md in the surroundings that the chapter takes for granted: it compiles.
subroutine iteration(p, body, val, f, row_ptr, body_of, dof, val_of_rows, gap, lambda, d, stat)
  use feti_contact
  implicit none
  integer, parameter :: dp = kind(1d0)
  type(feti_problem), intent(in) :: p
  integer, intent(in) :: body, row_ptr(:), body_of(:), dof(:)
  real(dp), intent(in) :: val(:), f(:), val_of_rows(:), gap(:)
  real(dp), intent(inout) :: lambda(:), d(:)
  integer, intent(out) :: stat
  type(feti_info) :: info

  include 'fragment_3.inc'
end subroutine
