#!/bin/bash
# The C and Fortran drivers with the library under AddressSanitizer, leaks included: sanitize.sh <build folder> <ctest folder>
# The drivers are those of ctest; the library of the fuzzer is loaded before the installed one, and the runtime of Rust's
# sanitizer before both (gcc's is another version). A driver that hands over an array one number too short, and a program
# that loses memory, must be reported, or the rest would prove nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$1 ctest=$2
programs=$(tools/fuzz/build.sh)
library=$programs/libfeti_contact.so runtime=$build/libasan_runtime.so
mkdir -p "$build"

# The runtime comes as an archive for executables; what such a one runs before all else has no place in a library.
cp "$(rustc --print sysroot)/lib/rustlib/x86_64-unknown-linux-gnu/lib/librustc-stable_rt.asan.a" "$build/runtime.a"
ar d "$build/runtime.a" asan_preinit.cpp.o
cc -shared -o "$runtime" -Wl,--whole-archive "$build/runtime.a" -Wl,--no-whole-archive -lpthread -ldl -lrt -lm

export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1
export LSAN_OPTIONS=suppressions=$PWD/tools/fuzz/leaks.supp:print_suppressions=0
# must_report TEXT PROGRAM: the program is reported under the sanitizer.
must_report() {
    local said
    said=$(LD_PRELOAD=$runtime:$library "$2" 2>&1 || true)
    case $said in *"$1"*) ;; *) echo "no report of $1: $said" >&2; exit 1 ;; esac
}
echo 'void *malloc(unsigned long); char *p; int main(void) { p = malloc(8); p = 0; return 0; }' > "$build/leak.c"
cc -O0 -o "$build/leak" "$build/leak.c"
must_report heap-buffer-overflow "$ctest/abi/c_short_array"
must_report LeakSanitizer "$build/leak"

# sanitized LEAKS TESTS [NOT]: tests of ctest under the sanitizer, leaks looked for or not.
sanitized() {
    ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=$1 LD_PRELOAD=$runtime:$library ctest --test-dir "$ctest" -R "$2" -E "${3:-^$}" \
        --output-on-failure -O "$build/ctest_$1.log" > /dev/null \
        || { grep -h -A 40 -F '***' "$build/ctest_$1.log" | head -n 100; exit 1; }
}
# Not under the sanitizer: drivers with limits of their own on memory, another loader, compilers, valgrind, the tracer, which
# runs the drivers again, and one that asks for more memory than there can be, of which the sanitizer warns. Without a search
# for leaks: a forked child, where the stacks of other threads are gone.
skipped='address space|whichever malloc fails|no number is cut|leave no memory|loaded, unloaded|without a warning|the chapter lists|succeeds in a driver|of a fork'
sanitized 1 '^(C|Fortran|FORTRAN 77|example)' "$skipped"
sanitized 0 'of a fork'
echo "sanitize $(date -u +%F) $(cat "$build"/ctest_?.log | grep -c ' Passed ') claims without a report"
