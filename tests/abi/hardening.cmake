# Small problems on several threads, what the ABI costs, and a driver that breaks the contract for make sanitize.
c_drivers(overhead short_array threads_small)

claim("C: the smallest problem comes and goes two thousand times with the same answer" $<TARGET_FILE:c_overhead> 2000)
claim_silent("C: small problems on two threads, their own and a shared one, are solved or refused as busy"
             $<TARGET_FILE:c_threads_small>)
claim("helgrind finds nothing in small problems on two threads but what it cannot know of Rust's locks"
      "${VALGRIND}" -q --tool=helgrind --history-level=none --error-exitcode=9
      "--suppressions=${FETI_PREFIX}/share/feti_contact/suppressions/helgrind.supp" $<TARGET_FILE:c_threads_small>)

# The same host under ThreadSanitizer, which sees the calls of memcpy and free of a library that is not compiled with it.
add_executable(c_threads_sanitized c/threads_small.c c/small.c)
target_include_directories(c_threads_sanitized PRIVATE c)
target_compile_options(c_threads_sanitized PRIVATE -fsanitize=thread)
target_link_options(c_threads_sanitized PRIVATE -fsanitize=thread)
target_link_libraries(c_threads_sanitized PRIVATE feti_contact::feti_contact Threads::Threads m)
claim_silent("ThreadSanitizer finds nothing in a host on two threads with the suppressions that are installed"
             "${CMAKE_COMMAND}" -E env
             "TSAN_OPTIONS=suppressions=${FETI_PREFIX}/share/feti_contact/suppressions/tsan.supp exitcode=9"
             $<TARGET_FILE:c_threads_sanitized>)
