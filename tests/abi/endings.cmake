# How solves end, rows that just touch, where null spaces come from.
c_drivers(endings)
claim_silent("C: a limit on steps, a load that is not quite held, a row that just touches and the source of a null space are told"
             $<TARGET_FILE:c_endings>)
