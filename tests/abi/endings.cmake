# How solves end, rows that just touch, where null spaces come from.
add_executable(c_endings c/endings.c)
target_link_libraries(c_endings PRIVATE handover_c)
claim_silent("C: a limit on steps, a load that is not quite held, a row that just touches and the source of a null space are told"
             $<TARGET_FILE:c_endings>)
