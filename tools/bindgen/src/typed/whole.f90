!> Contact problems by FETI duality, for Fortran hosts: the typed Fortran interface of libfeti_contact.
!>
!>   minimise 1/2 u'Ku - f'u  over all u with  B u <= c  and  H u = h
!>
!> K is the stiffness of several bodies, which may float; lambda >= 0 are the forces of the contact rows.
!>
!>   use feti_contact
!>   type(feti_problem) :: p
!>   call feti_problem_create(p)
!>   call feti_set(p, 'tolerance', 1d-10)
!>   call feti_body_add(p, n, body)                                        ! for each body
!>   call feti_body_stiffness(p, body, row_ptr, col, val, FETI_LOWER)
!>   call feti_body_null_space(p, body, R, FETI_EXACT)
!>   call feti_body_load(p, body, f)
!>   call feti_rows_add(p, FETI_INEQUALITY, row_ptr, dof, val, c)
!>   call feti_solve(p)
!>   call feti_displacement(p, body, u)
!>   call feti_multipliers(p, FETI_INEQUALITY, lambda)
!>   call feti_problem_destroy(p)
!>
!> Names and meanings are the same as for the C functions in feti_contact.h. All numbers count from 1: bodies, unknowns,
!> rows, the indices inside arrays and the places in errors. Sizes are taken from the arrays. The library copies all
!> arrays. Index arrays are int32 or int64. A kind, a storage, a flag or a level is int32 like its constants, even if the
!> default INTEGER has 8 bytes. The last arguments of every subroutine are the optional stat and errmsg. With stat the
!> host decides how to react to a failure (feti_last_error_detail returns the place); without stat a failure prints its
!> text and stops the program. The module of each procedure, named below, describes it with shapes and units.
module feti_contact
