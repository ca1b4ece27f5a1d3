# claim("<what holds>" command ...): a test named by its claim. It passes when the command exits with 0.
function(claim name)
  add_test(NAME "${name}" COMMAND ${ARGN})
  set_tests_properties("${name}" PROPERTIES TIMEOUT 600)
endfunction()

# claim_silent: the same, and nothing is written to stdout or stderr.
function(claim_silent name)
  claim("${name}" sh "${PROJECT_ROOT}/tests/cmake/silent.sh" ${ARGN})
endfunction()

# claim_clean: the same under valgrind: no invalid access, nothing lost.
function(claim_clean name)
  claim("${name}" "${VALGRIND}" -q --error-exitcode=9 --leak-check=full
        --show-leak-kinds=definite,indirect --errors-for-leak-kinds=definite,indirect ${ARGN})
endfunction()
