!> Bodies of module feti_contact. A host uses feti_contact, not this module.
!>
!> The library copies all arrays, so the host may reuse them after each call. Sizes are taken from the arrays and compared
!> with the n of feti_body_add. Bodies and unknowns count from 1. A refused call leaves the problem unchanged. The
!> compiler copies arrays that are not contiguous. `stat` and `errmsg`: see feti_contact_base.
module feti_contact_bodies
  use, intrinsic :: iso_c_binding, only: c_int32_t, c_int64_t, c_loc, c_null_ptr, c_ptr, c_sizeof
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  use feti_contact_base, only: body_index, feti_problem, finish, handle_of, refuse
  use feti_contact_c, only: FETI_ALL, FETI_OK, FETI_OVERFLOW, feti_body_facts, &
    c_body_add => feti_body_add, &
    c_body_components => feti_body_components, &
    c_body_coordinates => feti_body_coordinates, &
    c_body_coordinates_flags => feti_body_coordinates_flags, &
    c_body_fixing_set => feti_body_fixing_set, &
    c_body_info => feti_body_info, &
    c_body_load => feti_body_load, &
    c_body_null_space => feti_body_null_space, &
    c_body_null_space_get => feti_body_null_space_get, &
    c_body_no_null_space => feti_body_no_null_space, &
    c_body_numbering_i32 => feti_body_numbering_i32, &
    c_body_numbering_i64 => feti_body_numbering_i64
  implicit none
  private
  public :: body_add, body_null_space, body_no_null_space, body_null_space_get
  public :: body_coordinates, body_coordinates_flags, body_fixing_set, body_load
  public :: body_numbering, body_components, body_info, feti_body_facts

  !> Load, force; without a call f = 0. A second call replaces the first.
  !>
  !> call feti_body_load(p, body, f): the load f(n) of one body.
  !> call feti_body_load(p, f): the loads of all bodies, f(number) with the numbers of feti_body_numbering (entries that
  !>   belong to no unknown are ignored); without numbers one body after the other.
  interface body_load
    module procedure load_one, load_all
  end interface

  !> The host's own numbers of the unknowns of a body, number(n), from 1, int32 or int64; each number names one unknown in
  !> the whole problem. Calls without a body (feti_body_load, feti_displacement, feti_reaction, feti_rows_add) then use
  !> these numbers; either all bodies or none must have them. If option glue = 1 was set before, unknowns of several
  !> bodies with the same number move together; a load on this number acts on the first body, and a reaction is the sum
  !> over all these bodies.
  interface body_numbering
    module procedure numbering_int32, numbering_int64
  end interface

  !> Positions of the unknowns, to be given instead of a null space: the library takes the rigid body motions as
  !> candidates. If you give neither positions nor a null space, the library finds the null space from K.
  !>
  !> call feti_body_coordinates(p, body, node, dir, xyz): node(n): any label of 32 bits, equal for the unknowns of one node;
  !>   dir(n): 1 to 3 displacement, 4 to 6 rotation; both int32 or int64; xyz(dim,n): position, length, dim 1 to 3.
  interface body_coordinates
    module procedure coordinates_int32, coordinates_int64
  end interface

contains

  !> Adds a body with n unknowns; body: its number, from 1; 0 after a failure.
  recursive subroutine body_add(p, n, body, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: n
    integer, intent(out) :: body
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: id
    integer(c_int32_t) :: status

    body = 0
    status = c_body_add(handle_of(p), int(n, c_int64_t), id)
    if (status == FETI_OK) body = int(id) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> Motions without strain energy, K R = 0: the columns of R(n,r), length per unit amplitude.
  !>
  !> flags: with FETI_EXACT, R spans the whole null space (r = 0: K is not singular). With FETI_CANDIDATES, the null space
  !> lies in the span of R, and the library finds the part that the supports leave free. The library verifies both claims.
  !> With FETI_SOFT, weak springs, rounding or geometric stiffness may resist or drive these motions; the library computes
  !> the exact motions from K. If a body has neither a null space nor coordinates, the library finds the null space from
  !> K.
  recursive subroutine body_null_space(p, body, R, flags, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous, target :: R(:, :)
    integer(c_int32_t), intent(in) :: flags
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: address

    address = c_null_ptr
    if (size(R) > 0) address = c_loc(R)
    call finish(c_body_null_space(handle_of(p), int(body - 1, c_int64_t), size(R, 2, c_int64_t), &
      size(R, 1, c_int64_t), address, size(R, 1, c_int64_t), flags), stat, errmsg)
  end subroutine

  !> The body has no null space: its supports hold it, K is not singular, which feti_setup checks.
  recursive subroutine body_no_null_space(p, body, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_no_null_space(handle_of(p), int(body - 1, c_int64_t)), stat, errmsg)
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
    status = c_body_null_space_get(handle_of(p), int(body - 1, c_int64_t), int(n, c_int64_t), columns, &
      c_null_ptr, int(n, c_int64_t))
    if (status == FETI_OK) then
      allocate (R(n, columns))
      if (size(R) > 0) status = c_body_null_space_get(handle_of(p), int(body - 1, c_int64_t), int(n, c_int64_t), &
        columns, c_loc(R), int(n, c_int64_t))
    end if
    call finish(status, stat, errmsg)
  end subroutine

  !> int32 labels and directions.
  recursive subroutine coordinates_int32(p, body, node, dir, xyz, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int32), intent(in), contiguous :: node(:), dir(:)
    real(real64), intent(in), contiguous :: xyz(:, :)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    if (size(dir) /= size(node)) then
      call refuse(6, 'feti_body_coordinates: dir and node differ in size', stat, errmsg)
    else if (size(xyz, 2) /= size(node)) then
      call refuse(7, 'feti_body_coordinates: xyz has not one column per entry of node', stat, errmsg)
    else
      call finish(c_body_coordinates(handle_of(p), int(body - 1, c_int64_t), size(xyz, 1, c_int32_t), &
        size(node, kind=c_int64_t), node, dir, xyz, size(xyz, 1, c_int64_t)), stat, errmsg)
    end if
  end subroutine

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

  !> How the library uses the rigid body motions that the coordinates of a body give, whether the coordinates come before
  !> or after this call. flags: FETI_CANDIDATES is the default; with FETI_EXACT, the body floats as a whole, and setup refuses
  !> it if K resists one of the motions; with FETI_SOFT, weak springs, rounding or geometric
  !> stiffness may resist or drive the motions, and the library computes the exact motions from K.
  recursive subroutine body_coordinates_flags(p, body, flags, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(c_int32_t), intent(in) :: flags
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_coordinates_flags(handle_of(p), int(body - 1, c_int64_t), flags), stat, errmsg)
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
    call finish(c_body_fixing_set(handle_of(p), int(body - 1, c_int64_t), size(dof, kind=c_int64_t), c_loc(numbers)), &
      stat, errmsg)
  end subroutine

  !> The load of one body.
  recursive subroutine load_one(p, body, f, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    real(real64), intent(in), contiguous :: f(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_load(handle_of(p), body_index(body), size(f, kind=c_int64_t), f), stat, errmsg)
  end subroutine

  !> The values of all bodies, with the numbers of the host.
  recursive subroutine load_all(p, f, stat, errmsg)
    type(feti_problem), intent(in) :: p
    real(real64), intent(in), contiguous :: f(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_load(handle_of(p), FETI_ALL, size(f, kind=c_int64_t), f), stat, errmsg)
  end subroutine

  !> int32 numbers.
  recursive subroutine numbering_int32(p, body, number, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int32), intent(in), contiguous :: number(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_numbering_i32(handle_of(p), int(body - 1, c_int64_t), size(number, kind=c_int64_t), number, &
      1_c_int32_t), stat, errmsg)
  end subroutine

  !> int64 numbers.
  recursive subroutine numbering_int64(p, body, number, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer(int64), intent(in), contiguous :: number(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg

    call finish(c_body_numbering_i64(handle_of(p), int(body - 1, c_int64_t), size(number, kind=c_int64_t), number, &
      1_c_int32_t), stat, errmsg)
  end subroutine

  !> The connected part of every unknown of a body, component(n); the parts are numbered from 1 in the order of their
  !> first unknowns. The stiffness matrix must have been given.
  recursive subroutine body_components(p, body, component, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    integer, intent(inout) :: component(:)
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int64_t), allocatable :: found(:)
    integer(c_int32_t) :: status

    allocate (found(size(component)))
    status = c_body_components(handle_of(p), int(body - 1, c_int64_t), size(found, kind=c_int64_t), found)
    if (status == FETI_OK) component = int(found) + 1
    call finish(status, stat, errmsg)
  end subroutine

  !> What is known about a body; shared_with counts from 1; 0: none.
  recursive subroutine body_info(p, body, facts, stat, errmsg)
    type(feti_problem), intent(in) :: p
    integer, intent(in) :: body
    type(feti_body_facts), intent(inout) :: facts
    integer, intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: status

    facts%struct_size = c_sizeof(facts)
    status = c_body_info(handle_of(p), int(body - 1, c_int64_t), facts)
    if (status == FETI_OK) facts%shared_with = facts%shared_with + 1
    call finish(status, stat, errmsg)
  end subroutine

end module
