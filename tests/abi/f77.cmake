# FORTRAN 77 hosts: fixed form, default INTEGER of 4 and of 8 bytes, the face compiled with the host's flags.
set(F77 "${CMAKE_CURRENT_SOURCE_DIR}/f77")
set(FETI_FORTRAN "${FETI_PREFIX}/share/feti_contact/fortran")
file(GLOB f77_face CONFIGURE_DEPENDS "${FETI_FORTRAN}/feti_contact_c.f90" "${FETI_FORTRAN}/feti_contact_base.f90"
     "${FETI_FORTRAN}/feti_contact_f77_*.f90")

# f77_face(NAME FLAGS...): the face as a library of that name.
function(f77_face name)
  add_library(${name} STATIC ${f77_face})
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}_modules")
  target_compile_options(${name} PRIVATE ${ARGN})
  target_include_directories(${name} INTERFACE "${FETI_FORTRAN}")
  target_link_libraries(${name} PUBLIC feti_contact::feti_contact)
endfunction()

# f77_program(NAME FACE FLAGS SOURCE...): a program of fixed-form sources, compiled with these flags, and that face.
function(f77_program name face flags)
  list(TRANSFORM ARGN PREPEND "${F77}/" OUTPUT_VARIABLE sources)
  add_executable(${name} ${sources})
  target_compile_options(${name} PRIVATE -std=legacy ${flags})
  target_link_libraries(${name} PRIVATE ${face})
endfunction()

f77_face(f77_face_4)
f77_face(f77_face_8 -fdefault-integer-8)
foreach(bytes 4 8)
  set(flags)
  if(bytes EQUAL 8)
    set(flags -fdefault-integer-8)
  endif()
  f77_program(f77_three_bodies_${bytes} f77_face_${bytes} "${flags}" three_bodies.f reader.f)
  f77_program(f77_calls_${bytes} f77_face_${bytes} "${flags}" calls.f findings.f kept.f elements.f friction.f numbers.f surfaces.f small.f reader.f)
  f77_program(f77_watched_${bytes} f77_face_${bytes} "${flags}" watched.f small.f reader.f)
  f77_program(f77_saved_${bytes} f77_face_${bytes} "${flags}" saved.f small.f reader.f)
  claim_silent("FORTRAN 77, INTEGER of ${bytes} bytes: a problem is written, read back and solved, lines are told"
               $<TARGET_FILE:f77_saved_${bytes}> "${CMAKE_CURRENT_BINARY_DIR}/f77_saved_${bytes}.feti")
  f77_program(f77_refused_${bytes} f77_face_${bytes} "${flags}" refused.f small.f reader.f)
  claim_silent("FORTRAN 77, INTEGER of ${bytes} bytes: three bodies press on each other with the known forces"
        sh "${F77}/prints.sh" $<TARGET_FILE:f77_three_bodies_${bytes}> "${FETI_DATA}")
  claim_silent("FORTRAN 77, INTEGER of ${bytes} bytes: every subroutine succeeds, with the result by hand" $<TARGET_FILE:f77_calls_${bytes}>)
  claim_silent("FORTRAN 77, INTEGER of ${bytes} bytes: an external function hears, cancels and fails" $<TARGET_FILE:f77_watched_${bytes}>)
  claim_silent("FORTRAN 77, INTEGER of ${bytes} bytes: a refused call counts its arguments and changes nothing" $<TARGET_FILE:f77_refused_${bytes}>)
endforeach()
f77_program(f77_wide f77_face_8 -fdefault-integer-8 wide.f small.f reader.f)
claim_silent("FORTRAN 77, INTEGER of 8 bytes: no number is cut to 32 bits" $<TARGET_FILE:f77_wide>)
claim_clean("valgrind finds nothing in the FORTRAN 77 driver of all subroutines" $<TARGET_FILE:f77_calls_4>)
claim_clean("valgrind finds nothing in the FORTRAN 77 driver of refused calls, INTEGER of 8 bytes" $<TARGET_FILE:f77_refused_8>)
claim_clean("valgrind finds nothing in the FORTRAN 77 driver of progress" $<TARGET_FILE:f77_watched_4>)

# Sizes that do not fit: -1001 is FTEISZ, -1002 FTEDSZ.
f77_program(f77_sizes_host_8 f77_face_4 -fdefault-integer-8 sizes.f reader.f)
f77_program(f77_sizes_face_8 f77_face_8 "" sizes.f reader.f)
f77_program(f77_sizes_quad f77_face_4 -fdefault-real-8 sizes.f reader.f)
f77_face(f77_face_quad -fdefault-integer-8 -fdefault-real-8)
f77_program(f77_sizes_quad_both f77_face_quad "-fdefault-integer-8;-fdefault-real-8" sizes.f reader.f)
claim_silent("FORTRAN 77: a host with INTEGER of 8 bytes is told that the face has 4" $<TARGET_FILE:f77_sizes_host_8> -1001)
claim_silent("FORTRAN 77: a host with INTEGER of 4 bytes is told that the face has 8" $<TARGET_FILE:f77_sizes_face_8> -1001)
claim_silent("FORTRAN 77: a host with DOUBLE PRECISION of 16 bytes is told so" $<TARGET_FILE:f77_sizes_quad> -1002)
claim_silent("FORTRAN 77: it is told so by a face with the same flags" $<TARGET_FILE:f77_sizes_quad_both> -1002)
claim_clean("valgrind finds nothing where sizes differ" $<TARGET_FILE:f77_sizes_face_8> -1001)
f77_face(f77_face_real_8 -fdefault-real-8 -fdefault-double-8)
f77_program(f77_calls_real_8 f77_face_real_8 "-fdefault-real-8;-fdefault-double-8" calls.f findings.f kept.f elements.f friction.f numbers.f surfaces.f small.f reader.f)
claim_silent("FORTRAN 77: REAL of 8 bytes beside DOUBLE PRECISION of 8 is no difference" $<TARGET_FILE:f77_calls_real_8>)

claim_silent("FORTRAN 77: the face compiles without a warning, names have at most 6 characters, the include file both forms"
             sh "${F77}/strict.sh" "${FETI_FORTRAN}" "${F77}")
claim_silent("FORTRAN 77: the chapter lists every subroutine with its arguments, and its example gives its numbers"
             sh "${F77}/docs.sh" "${FETI_PREFIX}" "${PROJECT_ROOT}/docs/fortran77.md")
