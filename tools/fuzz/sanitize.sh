#!/bin/bash
# C and Fortran drivers with the library under AddressSanitizer, leaks included: sanitize.sh <build folder>
# The library is that of the fuzzer. Its runtime is Rust's, linked into every driver: gcc's is another version. A driver that
# hands over an array one number too short must be reported, or the rest would prove nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$(realpath -m "$1")
programs=$(tools/fuzz/build.sh)
runtime=$(rustc --print sysroot)/lib/rustlib/x86_64-unknown-linux-gnu/lib/librustc-stable_rt.asan.a
library=$(ls -t "$programs"/deps/libfeti_contact*.so | head -n 1)
mkdir -p "$build/prefix"
make --no-print-directory stage data > /dev/null
cp -a build/stage/. "$build/prefix/"
cp "$library" "$(realpath "$build/prefix/lib/libfeti_contact.so")"
whole="-Wl,--whole-archive,$runtime,--no-whole-archive,--export-dynamic"
cmake -S tests -B "$build/ctest" -DCMAKE_PREFIX_PATH="$build/prefix" -DFETI_DATA="$PWD/build/data" \
    -DCMAKE_EXE_LINKER_FLAGS="$whole" -DCMAKE_C_STANDARD_LIBRARIES="-lpthread -ldl -lrt -lm" \
    -DCMAKE_Fortran_STANDARD_LIBRARIES="-lpthread -ldl -lrt -lm" > "$build/cmake.log"
cmake --build "$build/ctest" > "$build/build.log" 2>&1 || { tail -n 40 "$build/build.log"; exit 1; }

export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1
proof=$("$build/ctest/abi/c_short_array" 2>&1 || true)
case $proof in
    *heap-buffer-overflow*) ;;
    *) echo "no report of an array that is too short: $proof" >&2; exit 1 ;;
esac
# Not under the sanitizer: drivers with limits of their own on memory, another allocator or loader, and valgrind.
ctest --test-dir "$build/ctest" -R '^(C|Fortran)' -E 'address space|valgrind|leave no memory|loaded, unloaded|warning or a trampoline' \
    --output-on-failure
