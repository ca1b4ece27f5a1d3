# ---- bodies: values, forms of a matrix, numbering
c_drivers(values forms borrow numbering elements)
fortran_drivers(values numbering elements)

claim_silent("C: new values on an old pattern cost one factorisation, refused ones nothing" $<TARGET_FILE:c_values>)
claim_silent("C: a profile and triplets give the bits of rows, new values too, and refused ones lose nothing" $<TARGET_FILE:c_forms>)
claim_silent("C: borrowed values are not copied, rewritten in place they count for every body" $<TARGET_FILE:c_borrow>)
claim_silent("C: arrays over all unknowns go by the host's numbers, parts and facts of a body are told" $<TARGET_FILE:c_numbering>)
claim_silent("Fortran: new values, copied or borrowed, cost one factorisation, refused ones nothing" $<TARGET_FILE:fortran_values>)
claim_silent("Fortran: arrays over all unknowns go by the host's numbers, parts and facts of a body are told"
             $<TARGET_FILE:fortran_numbering>)
claim_clean("valgrind finds nothing in the C driver of new values" $<TARGET_FILE:c_values>)
claim_clean("valgrind finds nothing in the C driver of profiles and triplets" $<TARGET_FILE:c_forms>)
claim_clean("valgrind finds nothing in the C driver of borrowed values" $<TARGET_FILE:c_borrow>)
claim_clean("valgrind finds nothing in the C driver of numbers" $<TARGET_FILE:c_numbering>)
claim_clean("valgrind finds nothing in the Fortran driver of new and borrowed values" $<TARGET_FILE:fortran_values>)
claim_silent("C: bodies by their elements, whole and cut, have the answer of their matrices, what is refused loses nothing"
             $<TARGET_FILE:c_elements>)
claim_silent("Fortran: bodies by their elements, whole and cut, have the answer of their matrices, what is refused loses nothing"
             $<TARGET_FILE:fortran_elements>)
claim_clean("valgrind finds nothing in the C driver of elements" $<TARGET_FILE:c_elements>)
claim_clean("valgrind finds nothing in the Fortran driver of elements" $<TARGET_FILE:fortran_elements>)
