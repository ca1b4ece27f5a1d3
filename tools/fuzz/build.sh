#!/bin/bash
# The targets of the fuzzer and the library under AddressSanitizer, with counters for libFuzzer. The sanitizer and the
# counters are unstable options of a stable compiler: RUSTC_BOOTSTRAP allows them here, nowhere else. With --target build
# scripts are compiled without them. Prints the folder of the programs, in which the shared library is, too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../fuzz"
folder=${FUZZ_TARGET_DIR:-$(cd .. && realpath -m "${CARGO_TARGET_DIR:-target}")/fuzz}
export RUSTC_BOOTSTRAP=1 CARGO_TARGET_DIR=$folder
counters="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters"
counters="$counters -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
export RUSTFLAGS="-Zsanitizer=address $counters -Ccodegen-units=1 --cfg fuzzing"
nice cargo build --release --locked --target x86_64-unknown-linux-gnu ${JOBS:+-j$JOBS} >&2
# Overflow and assertions of the library are found as FETI_INTERNAL.
checked=()
for package in feti-contact feti-contact-c; do
    checked+=(--config "profile.release.package.$package.debug-assertions=true" --config "profile.release.package.$package.overflow-checks=true")
done
(cd .. && nice cargo build --release --locked --target x86_64-unknown-linux-gnu -p feti-contact-c "${checked[@]}" ${JOBS:+-j$JOBS} >&2)
echo "$folder/x86_64-unknown-linux-gnu/release"
