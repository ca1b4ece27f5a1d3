# Small problems on several threads, what the ABI costs, and a driver that breaks the contract for make sanitize.
foreach(driver overhead short_array)
  add_executable(c_${driver} c/${driver}.c)
  target_include_directories(c_${driver} PRIVATE c)
  target_link_libraries(c_${driver} PRIVATE feti_contact::feti_contact m)
endforeach()
add_executable(c_threads_small c/threads_small.c)
target_link_libraries(c_threads_small PRIVATE handover_c Threads::Threads)

claim("C: the smallest problem comes and goes two thousand times with the same answer" $<TARGET_FILE:c_overhead> 2000)
claim_silent("C: small problems on two threads, their own and a shared one, are solved or refused as busy"
             $<TARGET_FILE:c_threads_small>)
claim("helgrind finds nothing in small problems on two threads but what it cannot know of Rust's locks"
      "${VALGRIND}" -q --tool=helgrind --history-level=none --error-exitcode=9
      --suppressions=${CMAKE_CURRENT_SOURCE_DIR}/helgrind.supp $<TARGET_FILE:c_threads_small>)
