# Nodes with friction, in C and in Fortran; in FORTRAN 77 with the other calls.
add_executable(c_friction c/friction.c)
target_link_libraries(c_friction PRIVATE handover_c)
add_executable(fortran_friction fortran/friction.f90)
set_target_properties(fortran_friction PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/friction_modules")
target_link_libraries(fortran_friction PRIVATE handover_fortran)

claim_silent("C: a block sticks, slips, slips back and comes back, nodes are written and read, with the forces by hand"
             $<TARGET_FILE:c_friction>)
claim_silent("Fortran: a block sticks, slips, slips back and comes back, and nodes that do not fit are refused from 1"
             $<TARGET_FILE:fortran_friction>)
claim_clean("valgrind finds nothing in the C driver of friction" $<TARGET_FILE:c_friction>)
