# ---- faces compiled with flags of the host. Every check at run time: calls from inside a function of the host, and on threads
set(checks "-fcheck=all,no-array-temps")
file(GLOB typed_face CONFIGURE_DEPENDS "${FETI_FORTRAN}/feti_contact*.f90")
list(FILTER typed_face EXCLUDE REGEX "_f77_")

# typed_face(NAME FLAG SOURCE...): the typed face and these sources as a library of that name, compiled with this flag.
function(typed_face name flag)
  add_library(${name} STATIC ${typed_face} ${ARGN})
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}_modules")
  target_compile_options(${name} PUBLIC ${flag})
  target_include_directories(${name} PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/${name}_modules")
  target_link_libraries(${name} PUBLIC feti_contact::feti_contact)
endfunction()

typed_face(checked_fortran ${checks} "${PROJECT_ROOT}/examples_fortran/case_reader.f90" fortran/support/case_problem.f90)
foreach(driver watched operator log)
  add_executable(checked_${driver} fortran/${driver}.f90)
  set_target_properties(checked_${driver} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/checked_${driver}_modules")
  target_link_libraries(checked_${driver} PRIVATE checked_fortran)
  claim_silent("Fortran, compiled with -fcheck=all: driver ${driver}" $<TARGET_FILE:checked_${driver}> "${FETI_DATA}")
endforeach()

f77_face(f77_face_checked ${checks})
f77_program(f77_checked_together f77_face_checked "" together.f small.f reader.f)
claim_silent("FORTRAN 77, the face compiled with -fcheck=all: the host multiplies on several threads at a time" $<TARGET_FILE:f77_checked_together>)

# ---- the typed face with default INTEGER of 4 and of 8 bytes
typed_face(fortran_integers_8_face -fdefault-integer-8)
add_executable(fortran_integers_8 fortran/integers.f90)
target_link_libraries(fortran_integers_8 PRIVATE fortran_integers_8_face)
add_executable(fortran_integers_4 fortran/integers.f90)
target_link_libraries(fortran_integers_4 PRIVATE feti_contact::fortran)
foreach(bytes 4 8)
  claim_silent("Fortran, INTEGER of ${bytes} bytes: default integers, labels and states of both kinds" $<TARGET_FILE:fortran_integers_${bytes}>)
endforeach()
