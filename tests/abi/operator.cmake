# ---- bodies whose stiffness the host keeps
add_executable(c_operator c/operator.c c/skyline.c)
target_link_libraries(c_operator PRIVATE handover_c Threads::Threads)
add_executable(fortran_operator fortran/operator.f90)
set_target_properties(fortran_operator PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/operator_modules")
target_link_libraries(fortran_operator PRIVATE handover_fortran)

claim_silent("C: a host with its own factorisation gets the answer of matrices, on its thread or on any, in its environment, and may cancel, fail and ask from inside"
             $<TARGET_FILE:c_operator> "${FETI_DATA}" p1_P3 p2_B2 hertz_cylinder)
claim_silent("Fortran: module procedures multiply by K and K+ with data of any type, fail and are refused by name"
             $<TARGET_FILE:fortran_operator> "${FETI_DATA}")
claim_clean("valgrind finds nothing in the C driver of a host with its own factorisation" $<TARGET_FILE:c_operator> "${FETI_DATA}" p2_B2)
claim_clean("valgrind finds nothing in the Fortran driver of a host with its own factorisation" $<TARGET_FILE:fortran_operator>)
