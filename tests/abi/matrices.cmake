# Every function of the header, called rightly and wrongly; the programs are generated from c/src whenever it changes.
find_program(CARGO cargo REQUIRED)
file(GLOB_RECURSE generator_reads CONFIGURE_DEPENDS "${PROJECT_ROOT}/c/src/*.rs" "${PROJECT_ROOT}/tools/bindgen/src/*.rs")
set(calls "${CMAKE_CURRENT_BINARY_DIR}/generated/calls.c")
set(trace "${CMAKE_CURRENT_BINARY_DIR}/generated/trace.c")
set(bindgen "${CARGO}" run --quiet --release --locked -p feti-bindgen --)
add_custom_command(OUTPUT "${calls}" "${trace}" DEPENDS ${generator_reads} WORKING_DIRECTORY "${PROJECT_ROOT}" VERBATIM
                   COMMAND ${bindgen} --calls "${calls}" COMMAND ${bindgen} --trace "${trace}"
                   COMMENT "Generating calls of every function")
add_library(calls STATIC "${calls}" c/calls.c)
target_include_directories(calls PUBLIC c)
target_link_libraries(calls PUBLIC feti_contact::feti_contact m)

foreach(driver arguments_matrix misuse old_callers)
  add_executable(c_${driver} c/${driver}.c)
  target_link_libraries(c_${driver} PRIVATE calls)
endforeach()
target_link_libraries(c_misuse PRIVATE Threads::Threads)

claim_silent("C: every argument of every function, wrong in every way, is refused by its number and changes nothing"
             $<TARGET_FILE:c_arguments_matrix>)
claim_silent("C: every function says of NULL, dead, foreign and busy handles what they are, and writes nothing"
             $<TARGET_FILE:c_misuse>)
claim_silent("C: structs of older and newer headers are filled as far as they go" $<TARGET_FILE:c_old_callers>)
claim_clean("valgrind finds nothing in calls with wrong arguments" $<TARGET_FILE:c_arguments_matrix>)
claim_clean("valgrind finds nothing in calls with bad handles" $<TARGET_FILE:c_misuse>)
claim_clean("valgrind finds nothing in calls with structs of other sizes" $<TARGET_FILE:c_old_callers>)

c_drivers(settings)
fortran_drivers(settings)
claim_silent("C: what is set is what is read" $<TARGET_FILE:c_settings>)
claim_silent("Fortran: what is set is what is read, and chosen unknowns are fixed" $<TARGET_FILE:fortran_settings>)

# ---- nothing is untested: the drivers, which compare results, call every function with success
add_library(trace MODULE "${trace}")
add_dependencies(trace calls) # one of them runs the generator
target_include_directories(trace PRIVATE "${FETI_INCLUDE}")
target_link_libraries(trace PRIVATE ${CMAKE_DL_LIBS})
foreach(language C Fortran)
  string(TOLOWER "${language}_" prefix)
  claim("${language}: every function of the header succeeds in a driver"
        sh "${CMAKE_CURRENT_SOURCE_DIR}/called.sh" $<TARGET_FILE:trace> "${FETI_INCLUDE}/feti_contact.h" "${FETI_DATA}"
        "${CMAKE_CURRENT_BINARY_DIR}" ${prefix})
endforeach()
