# Problems as files, options as a text, what calls tell in words.
c_drivers(file log)
fortran_drivers(file log)
set(FILES "${CMAKE_CURRENT_BINARY_DIR}/files")
file(MAKE_DIRECTORY "${FILES}/c" "${FILES}/fortran" "${FILES}/memory")

claim_silent("C: every reference case written and read solves to the same bits, damaged files are refused, options come as a text"
             $<TARGET_FILE:c_file> "${FETI_DATA}" "${FILES}/c" "${PROJECT_ROOT}/tests/data/problem_v1.feti")
claim_silent("C: results, warnings, phases and steps are told in words, and a function that fails ends the call"
             $<TARGET_FILE:c_log> "${FETI_DATA}")
claim_silent("Fortran: a reference case written and read solves to the same bits, damaged files and texts are refused from 1"
             $<TARGET_FILE:fortran_file> "${FETI_DATA}" "${FILES}/fortran")
claim_silent("Fortran: a module procedure gets results, phases and steps in words, and ends the call"
             $<TARGET_FILE:fortran_log> "${FETI_DATA}")
claim_clean("valgrind finds nothing in the C driver of files" $<TARGET_FILE:c_file> "${FETI_DATA}" "${FILES}/memory"
            "${PROJECT_ROOT}/tests/data/problem_v1.feti" p1_P3 p2_B2)
find_program(PYTHON3 python3)
if(PYTHON3)
  claim_silent("the reader in docs/file_format.md reads the file of format 1"
               sh "${CMAKE_CURRENT_SOURCE_DIR}/reader.sh" "${PROJECT_ROOT}/docs/file_format.md" "${PROJECT_ROOT}/tests/data/problem_v1.feti")
endif()
