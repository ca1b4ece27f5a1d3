# ---- feti_contact.hpp: one driver by g++ (or what CMake takes) and by clang++, without a warning
find_program(CLANGXX NAMES clang++-19 clang++ REQUIRED)
set(cpp_warnings -Wall -Wextra -Wpedantic -Werror)
add_executable(cpp_problem cpp/problem.cpp)
target_compile_options(cpp_problem PRIVATE ${cpp_warnings})
target_include_directories(cpp_problem PRIVATE c)
target_link_libraries(cpp_problem PRIVATE feti_contact::feti_contact)
# The compilers are to warn of the header, which system headers are spared.
set_target_properties(cpp_problem PROPERTIES CXX_STANDARD 17 NO_SYSTEM_FROM_IMPORTED ON)

set(cpp_clang "${CMAKE_CURRENT_BINARY_DIR}/cpp_problem_clang")
add_custom_command(OUTPUT "${cpp_clang}" VERBATIM DEPENDS cpp/problem.cpp c/check.h "${FETI_INCLUDE}/feti_contact.hpp" "${FETI_LIBRARY}"
  COMMAND "${CLANGXX}" -std=c++17 ${cpp_warnings} -g "-I${FETI_INCLUDE}" "-I${CMAKE_CURRENT_SOURCE_DIR}/c" "${CMAKE_CURRENT_SOURCE_DIR}/cpp/problem.cpp"
          "${FETI_LIBRARY}" "-Wl,-rpath,${FETI_PREFIX}/lib" -o "${cpp_clang}")
add_custom_target(cpp_problem_clang ALL DEPENDS "${cpp_clang}")

# cpp_claims(COMPILER DRIVER): a claim for each subject of the driver.
function(cpp_claims compiler driver)
  claim_silent("${compiler}: the spring has its answer by hand, with 32 and 64 bits, containers, arrays, lists and pointers" ${driver} spring)
  claim_silent("${compiler}: a failure is thrown with status, argument, place and text, a status above 0 is returned" ${driver} errors)
  claim_silent("${compiler}: a problem moves with its functions; moved from, it is refused, and none is destroyed twice" ${driver} lives)
  claim_silent("${compiler}: what functions of the host throw arrives in the caller, and the problem is solved afterwards" ${driver} callbacks)
endfunction()
cpp_claims("C++" $<TARGET_FILE:cpp_problem>)
cpp_claims("clang++" "${cpp_clang}")
foreach(subject spring errors lives callbacks)
  claim_clean("valgrind finds nothing in C++: ${subject}" $<TARGET_FILE:cpp_problem> ${subject})
endforeach()
