#!/bin/bash
# The corpus of the repository anew: corpus.sh <folder of found inputs> [target ...]. Of what <folder>/<target> and the corpus
# hold, as few inputs as reach every branch that all of them reach.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
found=$(realpath "$1")
shift
programs=$(tools/fuzz/build.sh)
[ $# -gt 0 ] || set -- calls file text
export ASAN_OPTIONS=allocator_may_return_null=1:max_allocation_size_mb=512:detect_leaks=0
for target; do
    few=$(mktemp -d)
    nice "$programs/$target" -set_cover_merge=1 -use_counters=0 -timeout=10 -rss_limit_mb=0 -max_len=512 \
        "$few" "fuzz/corpus/$target" "$found/$target" > /dev/null 2>&1
    rm -r "fuzz/corpus/$target"
    mv "$few" "fuzz/corpus/$target"
    chmod 755 "fuzz/corpus/$target"
    echo "corpus $target $(ls "fuzz/corpus/$target" | wc -l) inputs, $(cat "fuzz/corpus/$target"/* | wc -c) bytes"
done
