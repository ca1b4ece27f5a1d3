# Nodes with friction, in C and in Fortran; in FORTRAN 77 with the other calls.
c_drivers(friction)
fortran_drivers(friction)

claim_silent("C: a block sticks, slips, slips back and comes back, nodes are written and read, with the forces by hand"
             $<TARGET_FILE:c_friction>)
claim_silent("Fortran: a block sticks, slips, slips back and comes back, and nodes that do not fit are refused from 1"
             $<TARGET_FILE:fortran_friction>)
claim_clean("valgrind finds nothing in the C driver of friction" $<TARGET_FILE:c_friction>)
