! What calls tell, kept by a module procedure.
module writers
  use feti_contact
  implicit none
  private
  public :: book, note

  type :: book
    integer :: lines = 0, steps = 0, fail_at = 0
    character(len=400) :: first = '', last = ''
  end type

contains

  integer function note(level, text, data)
    integer, intent(in) :: level
    character(len=*), intent(in) :: text
    class(*), intent(inout) :: data

    note = 0
    select type (data)
    type is (book)
      data%lines = data%lines + 1
      if (data%lines == 1) data%first = text
      data%last = text
      if (level == FETI_LOG_STEP) data%steps = data%steps + 1
      if (data%lines == data%fail_at) note = 5
    type is (integer)
      note = 98
    class default
      note = 99
    end select
  end function

end module

program log_lines
  use case_reader
  use case_problem, only: data_folder, handed_over, require
  use feti_contact
  use writers
  implicit none

  type(contact_case) :: wall
  type(feti_problem) :: p
  type(feti_info) :: info
  type(feti_error_detail) :: detail
  type(book), target :: heard
  character(len=300) :: text
  integer :: stat

  call read_case(data_folder(), 'p1_P3', wall)
  call handed_over(p, wall)

  call feti_on_log(p, note, FETI_LOG_RESULT, heard)
  call feti_solve(p)
  call require(heard%lines == 1 .and. index(heard%first, 'solved: ') == 1, 'the result is not one line: ' // heard%first)

  heard = book()
  call feti_on_log(p, note, FETI_LOG_STEP, heard)
  call feti_solve(p, info)
  call require(heard%steps == info%steps .and. heard%lines > heard%steps + 3, 'not every step was told')
  call require(index(heard%first, 'feti-contact ') == 1, 'the first line: ' // heard%first)
  call require(index(heard%last, 'solved: ') == 1, 'the last line: ' // heard%last)

  heard = book(fail_at=2)
  call feti_solve(p, info, stat, text)
  call feti_last_error_detail(detail)
  call require(stat == FETI_CALLBACK .and. abs(detail%value - 5) <= 0, 'a failure was not reported: ' // trim(text))
  call feti_on_log(p, note, 9, heard, stat, text)
  call require(stat == FETI_ARGUMENT - 3, 'level 9 was taken: ' // trim(text))

  ! without data, after some had been given
  call feti_on_log(p, note, FETI_LOG_RESULT)
  call feti_solve(p, info, stat, text)
  call feti_last_error_detail(detail)
  call require(stat == FETI_CALLBACK .and. abs(detail%value - 99) <= 0, 'data that were not given: ' // trim(text))

  heard = book()
  call feti_on_log(p)
  call feti_solve(p)
  call require(heard%lines == 0, 'a function that was taken away is still called')
  call feti_problem_destroy(p)
  call feti_on_log(p, note, FETI_LOG_RESULT, heard, stat, text)
  call require(stat == FETI_HANDLE, 'a destroyed problem took a function')
end program
