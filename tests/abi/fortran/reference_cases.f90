!> Every reference case solves through the Fortran module to its known solution, and the certificate passes; with the
!> null spaces given, and with nothing said about them.
!> reference_cases [data folder [case ...]]
program reference_cases
  use case_problem
  use case_reader
  use feti_contact
  implicit none
  character(len=20), parameter :: all_cases(10) = [character(len=20) :: 'p1_P1', 'p1_P3', 'p1_P3_galerkin', 'p2_A', &
    'p2_B1', 'p2_B2', 'p3_2block', 'p3_3block', 'hertz_cylinder', 'three_bodies']
  character(len=20), allocatable :: names(:)
  integer :: i

  call choose_cases(all_cases, names)
  do i = 1, size(names)
    call check_case(trim(names(i)), from_basis)
    call check_case(trim(names(i)), from_nothing)
  end do
  deallocate (names)

contains

  subroutine check_case(name, source)
    character(len=*), intent(in) :: name
    integer, intent(in) :: source
    type(contact_case) :: this
    type(feti_problem) :: p
    type(feti_info) :: info
    real(dp), allocatable :: u(:), lambda(:), mu(:)

    call read_case(data_folder(), name, this)
    call feti_problem_create(p)
    call hand_over(p, this, source)
    call feti_solve(p, info)
    allocate (u(this%n), lambda(size(this%c)), mu(size(this%h)))
    call displacements(p, this, u)
    call feti_multipliers(p, FETI_INEQUALITY, lambda)
    call feti_multipliers(p, FETI_EQUALITY, mu)

    call check_sizes(name, p, this, info)
    call check_certificate(name, p, u, lambda, mu)
    call check_reference(name, p, this)
    call require(largest(lambda - this%lambda_ref) <= 1e-7_dp * largest(this%lambda_ref), &
      name // ': contact forces differ by ' // number(largest(lambda - this%lambda_ref)))
    call require(largest(mu - this%mu_ref) <= 1e-7_dp * largest(this%mu_ref), &
      name // ': forces of the equality rows differ by ' // number(largest(mu - this%mu_ref)))
    call require(info%undetermined == merge(2, 0, name == 'p2_B2'), name // ': wrong number of undetermined modes')
    if (info%undetermined > 0) then
      call check_up_to_rigid_motions(name, this, u - this%u_ref)
    else
      call require(largest(u - this%u_ref) <= 1e-8_dp * largest(this%u_ref), &
        name // ': displacements differ by ' // number(largest(u - this%u_ref)))
    end if
    call check_rows(name, p, this, u, info)
    call check_reactions(name, p, this, u, lambda, mu)
    call feti_problem_destroy(p)
  end subroutine

  !> info and feti_counts tell the sizes of the case.
  subroutine check_sizes(name, p, this, info)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    type(feti_info), intent(in) :: info
    integer :: found(4), expected(4), modes, b

    call feti_counts(p, found(1), found(2), found(3), found(4))
    expected = [size(this%body), this%n, size(this%c), size(this%h)]
    modes = sum([(size(this%body(b)%null_space, 2), b=1, size(this%body))])
    call require(info%status == FETI_OK, name // ': info%status is not FETI_OK')
    call require(all(found == expected), name // ': feti_counts tells other sizes')
    call require(all([info%bodies, info%dofs, info%rows, info%equalities] == expected) &
      .and. info%floating_modes == modes, name // ': info tells other sizes')
  end subroutine

  !> Every entry passes at 1e-8 for the answer; a force moved by a thousandth of the largest does not pass.
  subroutine check_certificate(name, p, u, lambda, mu)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    real(dp), intent(in) :: u(:), lambda(:), mu(:)
    type(feti_certificate) :: certificate
    real(dp) :: wrong(size(lambda))

    call feti_check(p, u, lambda, mu, certificate)
    call require(abs(certificate%limit - 1e-8_dp) <= 0 .and. certificate%passed == 1 .and. certificate%worst <= 1, &
      name // ': the certificate does not pass, worst entry / limit ' // number(certificate%worst))
    call require(certificate%equilibrium_body >= 0 .and. certificate%penetration_row <= size(lambda), &
      name // ': the certificate names a place outside the problem')

    wrong = lambda
    wrong(maxloc(lambda)) = 1.001_dp * maxval(lambda)
    call feti_check(p, u, wrong, mu, certificate)
    call require(certificate%passed == 0 .and. certificate%worst > 1, name // ': a wrong force passes')
  end subroutine

  !> The answer of another code is certified as well: the reference solution passes.
  subroutine check_reference(name, p, this)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    type(feti_certificate) :: certificate

    call feti_check(p, this%u_ref, this%lambda_ref, this%mu_ref, certificate)
    call require(certificate%passed == 1, name // ': the reference solution does not pass, balance ' // &
      number(certificate%balance) // ', worst entry / limit ' // number(certificate%worst))
  end subroutine

  !> u differs from the reference by rigid motions that no row sees.
  subroutine check_up_to_rigid_motions(name, this, du)
    character(len=*), intent(in) :: name
    type(contact_case), intent(in) :: this
    real(dp), intent(in) :: du(:)
    real(dp), allocatable :: rest(:), q(:, :)
    integer :: b, i, j, sweep

    call require(largest(multiply(this%contact, du)) <= 1e-8_dp * largest(this%u_ref), name // ': B u differs')
    do b = 1, size(this%body)
      allocate (q, source=this%body(b)%null_space)
      allocate (rest, source=body_of(this, b, du))
      do j = 1, size(q, 2)
        do sweep = 1, 2
          do i = 1, j - 1
            q(:, j) = q(:, j) - q(:, i) * dot_product(q(:, i), q(:, j))
          end do
        end do
        q(:, j) = q(:, j) / norm2(q(:, j))
        rest = rest - q(:, j) * dot_product(q(:, j), rest)
      end do
      call require(largest(rest) <= 1e-8_dp * largest(this%u_ref), name // ': u differs beside rigid motions')
      deallocate (q, rest)
    end do
  end subroutine

  !> slack = c - B u; a row with a clear force is closed, a row with a clear gap is open.
  subroutine check_rows(name, p, this, u, info)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    real(dp), intent(in) :: u(:)
    type(feti_info), intent(in) :: info
    real(dp) :: slack(size(this%c)), gap(size(this%c)), length
    integer :: state(size(this%c))

    call feti_gaps(p, slack)
    call feti_active(p, state)
    gap = this%c - multiply(this%contact, u)
    length = largest(u) + largest(this%c)
    call require(largest(slack - gap) <= 1e-12_dp * length, name // ': feti_gaps is not c - B u')
    call require(all(state == FETI_ROW_CLOSED .or. this%lambda_ref <= 1e-6_dp * largest(this%lambda_ref)), &
      name // ': a row that bears a force is not closed')
    call require(all(state == FETI_ROW_OPEN .or. gap <= 1e-6_dp * length), name // ': an open row is closed')
    call require(count(state == FETI_ROW_CLOSED) == info%active, name // ': info%active is not the number of closed rows')
  end subroutine

  !> The force of the rows on the bodies is -B'lambda and -H'mu, and K u = f + r.
  subroutine check_reactions(name, p, this, u, lambda, mu)
    character(len=*), intent(in) :: name
    type(feti_problem), intent(in) :: p
    type(contact_case), intent(in) :: this
    real(dp), intent(in) :: u(:), lambda(:), mu(:)
    real(dp) :: contact(this%n), both(this%n), force(this%n)
    real(dp), allocatable :: r(:), residual(:)
    integer :: b

    contact = -multiply_transposed(this%contact, lambda)
    both = contact - multiply_transposed(this%equality, mu)
    force = this%f + both
    do b = 1, size(this%body)
      allocate (r(this%body(b)%n), residual(this%body(b)%n))
      call feti_reaction(p, FETI_INEQUALITY, b, r)
      call require(largest(r - body_of(this, b, contact)) <= 1e-12_dp * largest(contact), &
        name // ': the contact reaction is not -B''lambda')
      call feti_reaction(p, 0, b, r)
      call require(largest(r - body_of(this, b, both)) <= 1e-12_dp * largest(both), &
        name // ': the reaction is not -B''lambda - H''mu')
      residual = stiffness_times(this%body(b)%k, body_of(this, b, u)) - body_of(this, b, force)
      call require(largest(residual) <= 1e-7_dp * largest(force), &
        name // ': K u differs from f + r by ' // number(largest(residual)))
      deallocate (r, residual)
    end do
  end subroutine

end program
