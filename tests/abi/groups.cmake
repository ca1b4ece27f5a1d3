# Groups of bodies that no row joins, rows that never close, the estimated error of forces.
c_drivers(groups)
fortran_drivers(groups)
claim_silent("C: a group of bodies without an answer leaves the others theirs, rows never close at c = infinity"
             $<TARGET_FILE:c_groups>)
claim_silent("Fortran: a group of bodies without an answer leaves the others theirs, rows never close at c = infinity"
             $<TARGET_FILE:fortran_groups>)
claim_clean("valgrind finds nothing in the C driver of groups" $<TARGET_FILE:c_groups>)
