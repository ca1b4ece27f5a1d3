#!/bin/bash
# Lines of src/ffi that the Rust tests and the C and Fortran drivers run. run.sh <build folder> <ctest folder>
# The drivers are those of ctest; the instrumented library is put in the place of the installed one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$1 ctest=$2
rm -rf "$build"
mkdir -p "$build/profiles"
cargo build --release --locked --quiet --manifest-path tools/coverage/Cargo.toml --target-dir "${CARGO_TARGET_DIR:-target}"
report=${CARGO_TARGET_DIR:-target}/release/feti-coverage

export RUSTC_WORKSPACE_WRAPPER=$PWD/tools/coverage/instrumented.sh
export LLVM_PROFILE_FILE=$build/profiles/%p-%m.profraw
cargo build --release --locked --lib
cp "${CARGO_TARGET_DIR:-target}/release/libfeti_contact.so" "$build/"
cargo test --release --locked --lib --no-run --message-format=json 2>/dev/null \
    | sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' > "$build/tests"
rm -f "$build"/profiles/*
while read -r test; do "$test" ffi:: --quiet > /dev/null; done < "$build/tests"
unset RUSTC_WORKSPACE_WRAPPER
LD_PRELOAD=$build/libfeti_contact.so ctest --test-dir "$ctest" -R '^(C|Fortran|example)' -E 'memory|address space' \
    --output-on-failure --quiet -O "$build/ctest.log" || { tail -n 30 "$build/ctest.log"; exit 1; }
# shellcheck disable=SC2046 # one word per test program
"$report" src/ffi 90 "$build/libfeti_contact.so" $(cat "$build/tests") -- "$build"/profiles/*.profraw
