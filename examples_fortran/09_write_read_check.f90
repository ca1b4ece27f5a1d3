!> 09 Write a problem, read it back, check the answer: what a bug report needs.
!>
!> The problem of example 04 (three blocks, two of them floating) goes into one file and from there into a second
!> problem, as for a colleague who receives the file. The second problem solves to the same bits. feti_check needs no solve of
!> its own: it checks the answer of the first problem in the second problem, and refuses it if a contact force is one per
!> cent too large, or if a node has moved by a micrometre.
program write_read_check
  use case_reader
  use demo
  use feti_contact
  implicit none
  type(feti_problem) :: first, second
  type(feti_info) :: info
  type(feti_certificate) :: solved, pushed, moved
  type(contact_case) :: host
  character(len=:), allocatable :: file
  real(dp), allocatable, dimension(:) :: u, lambda, mu, u2, lambda2, mu2
  real(dp) :: error
  logical :: same
  integer :: row

  call read_case(data_folder(), 'three_bodies', host)
  if (size(host%body) /= 3) call demo_stop('three_bodies is not complete')
  file = picture_folder() // '/three_bodies_fortran.feti'

  call hand_over(first)
  call feti_problem_write(first, file)
  call feti_problem_create(second)
  call feti_problem_read(second, file)

  call solve(second, u2, lambda2, mu2)
  call solve(first, u, lambda, mu)
  same = all(abs(u - u2) <= 0) .and. all(abs(lambda - lambda2) <= 0) .and. all(abs(mu - mu2) <= 0)
  if (same) then
    print '(a)', 'the problem that was read solves to the same bits'
  else
    print '(a)', 'the problem that was read differs'
  end if
  error = max(demo_error(lambda, host%lambda_ref), demo_error(u, host%u_ref))

  call feti_check(second, u, lambda, mu, solved)
  row = maxloc(lambda, 1)
  lambda(row) = lambda(row) * 1.01_dp
  call feti_check(second, u, lambda, mu, pushed)
  lambda(row) = lambda(row) / 1.01_dp
  u(host%n) = u(host%n) + 1e-3_dp ! mm
  call feti_check(second, u, lambda, mu, moved)
  call print_table

  call feti_problem_destroy(first)
  call feti_problem_destroy(second)
  deallocate (file, u, lambda, mu, u2, lambda2, mu2)
  call demo_line('09_write_read_check', info, error, &
    same .and. solved%passed == 1 .and. pushed%passed == 0 .and. moved%passed == 0)

contains

  subroutine hand_over(problem)
    type(feti_problem), intent(out) :: problem
    integer :: b, number

    call feti_problem_create(problem)
    do b = 1, size(host%body)
      associate (body => host%body(b), k => host%body(b)%k)
        call feti_body_add(problem, body%n, number)
        call feti_body_stiffness(problem, number, k%row_ptr, k%col, k%val, FETI_LOWER)
        call feti_body_null_space(problem, number, body%null_space, FETI_EXACT)
        call feti_body_load(problem, number, host%f(body%offset + 1:body%offset + body%n))
      end associate
    end do
    call feti_rows_add(problem, FETI_INEQUALITY, host%contact%row_ptr, host%contact%col, host%contact%val, host%c)
    call feti_rows_add(problem, FETI_EQUALITY, host%equality%row_ptr, host%equality%col, host%equality%val, host%h)
    call feti_set_text(problem, 'tolerance=1e-12 finish=direct   # what the report is about')
  end subroutine

  subroutine solve(problem, u, lambda, mu)
    type(feti_problem), intent(in) :: problem
    real(dp), allocatable, intent(out) :: u(:), lambda(:), mu(:)
    integer :: b

    allocate (u(host%n), lambda(size(host%c)), mu(size(host%h)))
    call feti_solve(problem, info)
    do b = 1, size(host%body)
      associate (body => host%body(b))
        call feti_displacement(problem, b, u(body%offset + 1:body%offset + body%n))
      end associate
    end do
    call feti_multipliers(problem, FETI_INEQUALITY, lambda)
    call feti_multipliers(problem, FETI_EQUALITY, mu)
  end subroutine

  subroutine print_row(name, a, b, c)
    character(len=*), intent(in) :: name
    real(dp), intent(in) :: a, b, c
    character(len=20) :: label

    label = name
    print '(a20, 3a12)', label, power_of_ten(a), power_of_ten(b), power_of_ten(c)
  end subroutine

  !> One column for each answer; an entry passes when it is at most the limit.
  subroutine print_table
    character(len=20) :: label

    label = 'certificate'
    print '(a20, 3a12)', label, 'as solved', 'force +1 %', 'moved 1 um'
    call print_row('equilibrium', solved%equilibrium, pushed%equilibrium, moved%equilibrium)
    call print_row('balance', solved%balance, pushed%balance, moved%balance)
    call print_row('penetration', solved%penetration, pushed%penetration, moved%penetration)
    call print_row('equality', solved%equality, pushed%equality, moved%equality)
    call print_row('negative force', solved%negative_force, pushed%negative_force, moved%negative_force)
    call print_row('complementarity', solved%complementarity, pushed%complementarity, moved%complementarity)
    call print_row('limit', solved%limit, pushed%limit, moved%limit)
    label = 'verdict'
    print '(a20, 3a12)', label, verdict(solved), verdict(pushed), verdict(moved)
  end subroutine

  function verdict(certificate) result(word)
    type(feti_certificate), intent(in) :: certificate
    character(len=7) :: word

    word = ' passes'
    if (certificate%passed == 0) word = 'refused'
  end function

end program
