# ---- other ranks, without MPI: messages run by functions of the host (tests/mpi has MPI)
c_drivers(ranks)
fortran_drivers(ranks)
target_link_libraries(c_ranks PRIVATE Threads::Threads)
claim_silent("C: another rank serves until rank 0 ends it, functions run in the environment of the host, their failure has its status"
             $<TARGET_FILE:c_ranks>)
claim_silent("Fortran: bodies are lent and the service ended by functions of the host" $<TARGET_FILE:fortran_ranks>)
claim_clean("valgrind finds nothing in the C driver of other ranks" $<TARGET_FILE:c_ranks>)
