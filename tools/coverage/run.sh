#!/bin/bash
# Lines of c/src that the Rust tests and the C and Fortran drivers run. run.sh <build folder> <ctest folder>
# The drivers are those of ctest; the instrumented library is loaded before the installed one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$1 ctest=$2 target=${CARGO_TARGET_DIR:-target}
rm -rf "$build"
mkdir -p "$build/profiles"
cargo build --release --locked --quiet --manifest-path tools/coverage/Cargo.toml --target-dir "$target"

export RUSTC_WORKSPACE_WRAPPER=$PWD/tools/coverage/instrumented.sh LLVM_PROFILE_FILE=$build/compiling-%m.profraw
cargo build --release --locked -p feti-contact-c
cp "$target/release/libfeti_contact.so" "$build/"
cargo test --release --locked -p feti-contact-c -p feti-contact-c-rlib --lib --test fuzz --no-run --message-format=json \
    | sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' > "$build/tests"
unset RUSTC_WORKSPACE_WRAPPER

# Runs of the same binary add to one of four files.
export LLVM_PROFILE_FILE=$build/profiles/%4m.profraw
while read -r test; do
    "$test" --quiet > "$build/test.log" 2>&1 || { tail -n 30 "$build/test.log"; exit 1; }
done < "$build/tests"
# Not: valgrind (another loader), a driver out of memory, what only compiles, and the tracer, which runs the drivers again.
LD_PRELOAD=$build/libfeti_contact.so ctest --test-dir "$ctest" -R '^(C|Fortran|FORTRAN 77|example)' \
    -E 'address space|without a warning|succeeds in a driver' --output-on-failure --quiet -O "$build/ctest.log" \
    || { grep -A 30 'Failed' "$build/ctest.log" | head -n 60; exit 1; }
# shellcheck disable=SC2046 # one word per test program
"$target/release/feti-coverage" c/src 90 "$build/libfeti_contact.so" $(cat "$build/tests") -- "$build"/profiles/*.profraw
