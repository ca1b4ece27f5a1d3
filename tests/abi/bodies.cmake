# ---- bodies: values, forms of a matrix, numbering
foreach(driver values)
  add_executable(c_${driver} c/${driver}.c)
  target_link_libraries(c_${driver} PRIVATE handover_c)
endforeach()
foreach(driver values)
  add_executable(fortran_${driver} fortran/${driver}.f90)
  set_target_properties(fortran_${driver} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${driver}_modules")
  target_link_libraries(fortran_${driver} PRIVATE handover_fortran)
endforeach()

claim_silent("C: new values on an old pattern cost one factorisation, refused ones nothing" $<TARGET_FILE:c_values>)
claim_silent("Fortran: new values on an old pattern cost one factorisation, refused ones nothing" $<TARGET_FILE:fortran_values>)
claim_clean("valgrind finds nothing in the C driver of new values" $<TARGET_FILE:c_values>)
