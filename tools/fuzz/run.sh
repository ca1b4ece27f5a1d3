#!/bin/bash
# Runs the targets of the fuzzer one after the other: run.sh <seconds each> <work folder> [target ...]
# New inputs go to the work folder, the corpus of the repository stays. A crash, a call of more than 10 seconds, a leak or a
# report of the sanitizer ends with its input in the work folder and status 1.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=$1 work=$2
shift 2
programs=$(tools/fuzz/build.sh)
[ $# -gt 0 ] || set -- calls file text
# Allocations that no small problem needs fail, as under memory limits.
export ASAN_OPTIONS=allocator_may_return_null=1:max_allocation_size_mb=512:detect_stack_use_after_return=0:quarantine_size_mb=1:thread_local_quarantine_size_kb=64:malloc_context_size=6
status=0
for target; do
    mkdir -p "$work/$target"
    log=$work/$target.log
    (cd "$work" && nice -n 19 "$programs/$target" "$target" "$OLDPWD/fuzz/corpus/$target" -max_total_time="$seconds" \
        -timeout=10 -rss_limit_mb=0 -max_len=512 -len_control=20 -print_final_stats=1 \
        -artifact_prefix="$target-" > "$log" 2>&1) || { status=1; tail -n 40 "$log"; }
    done=$(sed -n 's/stat::number_of_executed_units: *//p' "$log")
    echo "fuzz $target $(date -u +%F) executions ${done:-0} $(grep '^certified' "$log" | tail -n 1)"
done
exit $status
