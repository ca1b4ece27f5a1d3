# ---- bodies whose stiffness the host keeps
c_drivers(operator)
target_sources(c_operator PRIVATE c/skyline.c)
fortran_drivers(operator)

claim_silent("C: a host with its own factorisation gets the answer of matrices, on its thread or on any, in its environment, and may cancel, fail and ask from inside"
             $<TARGET_FILE:c_operator> "${FETI_DATA}" p1_P3 p2_B2 hertz_cylinder)
claim_silent("Fortran: module procedures multiply by K and K+ with data of any type, fail and are refused by name"
             $<TARGET_FILE:fortran_operator> "${FETI_DATA}")
claim_clean("valgrind finds nothing in the C driver of a host with its own factorisation" $<TARGET_FILE:c_operator> "${FETI_DATA}" p2_B2)
claim_clean("valgrind finds nothing in the Fortran driver of a host with its own factorisation" $<TARGET_FILE:fortran_operator>)
