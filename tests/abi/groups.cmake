# Groups of bodies that no row joins, rows that never close, the estimated error of forces.
add_executable(c_groups c/groups.c)
target_link_libraries(c_groups PRIVATE handover_c)
add_executable(fortran_groups fortran/groups.f90)
set_target_properties(fortran_groups PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/groups_modules")
target_link_libraries(fortran_groups PRIVATE handover_fortran)
claim_silent("C: a group of bodies without an answer leaves the others theirs, rows never close at c = infinity"
             $<TARGET_FILE:c_groups>)
claim_silent("Fortran: a group of bodies without an answer leaves the others theirs, rows never close at c = infinity"
             $<TARGET_FILE:fortran_groups>)
claim_clean("valgrind finds nothing in the C driver of groups" $<TARGET_FILE:c_groups>)
