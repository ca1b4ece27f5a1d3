# LLVM flang against the same library: all Fortran layers, the examples, the drivers in Fortran and in FORTRAN 77.
find_program(FLANG NAMES flang-new-19 REQUIRED)
set(flang_work "${CMAKE_CURRENT_BINARY_DIR}/flang")
set(flang_bin "${flang_work}/bin")

claim("flang: all Fortran layers, examples and drivers compile"
      sh "${CMAKE_CURRENT_SOURCE_DIR}/flang/build.sh" "${FLANG}" "${FETI_PREFIX}" "${PROJECT_ROOT}" "${flang_work}"
      $<TARGET_FILE:cholmod_shim> "${CHOLMOD}")
set_tests_properties("flang: all Fortran layers, examples and drivers compile" PROPERTIES FIXTURES_SETUP flang)

# flang_claim(NAME command...): holds once all is compiled.
function(flang_claim name)
  claim("flang: ${name}" ${ARGN})
  set_tests_properties("flang: ${name}" PROPERTIES FIXTURES_REQUIRED flang)
endfunction()

set(silent sh "${PROJECT_ROOT}/tests/cmake/silent.sh")
set(same_numbers sh "${PROJECT_ROOT}/tests/examples/twins.sh")
file(GLOB examples CONFIGURE_DEPENDS "${PROJECT_ROOT}/examples_fortran/[0-9]*.f90" "${PROJECT_ROOT}/examples_fortran/[0-9]*.f")
list(FILTER examples EXCLUDE REGEX "/(1[5-7]|20)_") # MPI has its modules from gfortran, 20 is below
foreach(path IN LISTS examples)
  get_filename_component(example "${path}" NAME_WE)
  flang_claim("example ${example} reaches the reference and prints the numbers of its twin in C"
              ${same_numbers} "$<TARGET_FILE:${example}_c>" "${flang_bin}/example_${example}" "${FETI_DATA}" "${flang_work}/pictures/${example}")
endforeach()
flang_claim("example 20 has the forces of example 18" sh "${PROJECT_ROOT}/tests/examples/same_forces.sh"
            "${flang_bin}/example_20_skyline_host" $<TARGET_FILE:18_sliding_blocks_c>)
foreach(driver reference_cases coordinates watched operator log cholmod_oracle)
  flang_claim("driver ${driver}" ${silent} "${flang_bin}/${driver}" "${FETI_DATA}")
endforeach()
foreach(driver input_forms errors compliance diagnosis reuse settings values numbering elements ranks surfaces)
  flang_claim("driver ${driver}" ${silent} "${flang_bin}/${driver}")
endforeach()
flang_claim("without stat a refused call ends the program with code 1" sh "${CMAKE_CURRENT_SOURCE_DIR}/stops.sh" "${flang_bin}/stop_on_error")
foreach(bytes 4 8)
  flang_claim("FORTRAN 77, INTEGER of ${bytes} bytes: three bodies press on each other with the known forces"
              sh "${CMAKE_CURRENT_SOURCE_DIR}/f77/prints.sh" "${flang_bin}/f77_three_bodies_${bytes}" "${FETI_DATA}")
  foreach(driver calls watched refused)
    flang_claim("FORTRAN 77, INTEGER of ${bytes} bytes: driver ${driver}" ${silent} "${flang_bin}/f77_${driver}_${bytes}")
  endforeach()
endforeach()
flang_claim("FORTRAN 77: a host with INTEGER of 8 bytes is told that the face has 4" ${silent} "${flang_bin}/f77_sizes" -1001)
