# Surfaces and pairs, in C and in Fortran; in FORTRAN 77 with the other calls.
c_drivers(surfaces wrong_surfaces)
fortran_drivers(surfaces)

claim_silent("C: strips press, slip, are tied, rest on a plane and come back by surfaces, with the pressures by hand" $<TARGET_FILE:c_surfaces>)
claim_silent("C: every mistake with surfaces and pairs is named by argument, pair, face and node, and changes nothing"
             $<TARGET_FILE:c_wrong_surfaces>)
claim_silent("Fortran: strips press, slip, are tied and rest on rigid surfaces, counted from 1, and what does not fit is refused"
             $<TARGET_FILE:fortran_surfaces>)
claim_clean("valgrind finds nothing in the C driver of surfaces" $<TARGET_FILE:c_surfaces>)
claim_clean("valgrind finds nothing in the C driver of mistakes with surfaces" $<TARGET_FILE:c_wrong_surfaces>)
claim_clean("valgrind finds nothing in the Fortran driver of surfaces" $<TARGET_FILE:fortran_surfaces>)
