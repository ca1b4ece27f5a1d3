! file DATA FOLDER: a problem goes through a file and solves to the same bits; damaged files and texts are refused.
program file
  use case_reader
  use case_problem, only: data_folder, handed_over, require
  use feti_contact
  implicit none

  character(len=500) :: folder
  character(len=:), allocatable :: path
  character(len=700) :: text
  integer :: stat

  call get_command_argument(2, folder)
  path = trim(folder) // '/problem.feti'
  call comes_back('p1_P3')
  call comes_back('three_bodies')
  call damaged_files
  call numbers_come_back
  call options_as_a_text
  deallocate (path)

contains

  subroutine comes_back(name)
    character(len=*), intent(in) :: name
    type(contact_case) :: host
    type(feti_problem) :: p, back
    type(feti_error_detail) :: detail
    real(dp), allocatable :: old(:), new(:)
    character(len=:), allocatable :: finish
    integer :: base

    call read_case(data_folder(), name, host)
    call feti_problem_create(back)
    call handed_over(p, host)
    call feti_set_text(p, 'finish = direct, tolerance = 1d-11')
    call feti_problem_write(p, path)
    call feti_problem_read(back, path)
    call feti_get(back, 'finish', finish)
    call feti_get(back, 'index_base', base)
    call require(finish == 'direct' .and. base == 1, 'options did not come back: ' // finish)
    allocate (old(size(host%c)), new(size(host%c)))
    call feti_solve(p)
    call feti_solve(back)
    call feti_multipliers(p, FETI_INEQUALITY, old)
    call feti_multipliers(back, FETI_INEQUALITY, new)
    call require(maxval(abs(old - new)) <= 0 .and. maxval(old) > 0, name // ' has other forces after reading')
    call feti_problem_read(back, path, stat, text)
    call require(stat == FETI_STATE, 'a file was read into a problem that is not empty: ' // trim(text))
    call feti_problem_read(p, path // '.none', stat, text)
    call feti_problem_destroy(p)
    call feti_problem_create(p)
    call feti_problem_read(p, path // '.none', stat, text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_IO .and. index(text, 'problem.feti.none: open: ') > 0, 'no file: ' // trim(text))
    call require(detail%function == 'feti_problem_read' .and. detail%entry == 0, 'wrong detail without a file')
    call feti_problem_destroy(p)
    call feti_problem_destroy(back)
  end subroutine

  subroutine damaged_files
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', action='readwrite')
    write (unit, pos=41) 'X'
    close (unit)
    call feti_problem_create(p)
    call feti_problem_read(p, path, stat, text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_IO .and. detail%entry >= 33, 'a damaged file: ' // trim(text))
    call require(index(text, 'byte') > 0 .and. index(text, path) > 0, 'no byte is named: ' // trim(text))
    open (newunit=unit, file=path, status='replace', action='write')
    write (unit, '(a)') 'this is a text, of more than the thirty-two bytes of a header'
    close (unit)
    call feti_problem_read(p, path, stat, text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_IO .and. detail%entry == 1, 'a text was read: ' // trim(text))
    call feti_problem_write(p, trim(folder) // '/none/problem', stat, text)
    call require(stat == FETI_IO .and. index(text, 'create') > 0, 'written to nowhere: ' // trim(text))
    call feti_problem_write(p, '', stat, text)
    call require(stat == FETI_ARGUMENT - 2, 'written without a name: ' // trim(text))
    call feti_problem_write(p, path)
    call feti_problem_read(p, path)
    open (newunit=unit, file=path, status='old')
    close (unit, status='delete')
    call feti_problem_destroy(p)
    call feti_problem_read(p, path, stat, text)
    call require(stat == FETI_HANDLE, 'read into a destroyed problem')
  end subroutine

  !> A spring k = 2 pulled by 6, its unknown number 4 of the host: u = 3.
  subroutine numbers_come_back
    type(feti_problem) :: p, back
    real(dp) :: u(4)
    integer :: body

    call feti_problem_create(p)
    call feti_problem_create(back)
    call feti_body_add(p, 1, body)
    call feti_body_stiffness(p, body, [1, 2], [1], [2d0], FETI_LOWER)
    call feti_body_numbering(p, body, [4])
    call feti_body_load(p, [0d0, 0d0, 0d0, 6d0])
    call feti_problem_write(p, path)
    call feti_problem_read(back, path)
    call feti_solve(back)
    u = 0
    call feti_displacement(back, u)
    call require(abs(u(4) - 3) < 1d-12, 'the numbers of the host did not come back')
    open (newunit=body, file=path, status='old')
    close (body, status='delete')
    call feti_problem_destroy(p)
    call feti_problem_destroy(back)
  end subroutine

  subroutine options_as_a_text
    type(feti_problem) :: p
    type(feti_error_detail) :: detail
    character(len=*), parameter :: wrong = 'threads=2 tolerence=1d-8'
    integer :: threads

    call feti_problem_create(p)
    call feti_set_text(p, 'threads=3 # of four' // new_line('a') // 'gamma=2d0')
    call feti_set_text(p, wrong, stat, text)
    call feti_last_error_detail(detail)
    call require(stat == FETI_ARGUMENT - 2 .and. detail%entry == index(wrong, 'tolerence'), 'wrong place: ' // trim(text))
    call require(index(text, 'byte 11') > 0 .and. index(text, 'tolerence') > 0, 'wrong text: ' // trim(text))
    call feti_get(p, 'threads', threads)
    call require(threads == 3, 'a refused text has set an option')
    call feti_problem_destroy(p)
  end subroutine

end program
