#!/bin/sh
# called.sh TRACER HEADER DATA FOLDER PREFIX: the drivers FOLDER/PREFIX* that end well call every function of the header with
# status FETI_OK, by the notes of the library TRACER, which is loaded before. Exit 1 names the functions that none calls.
set -eu
[ $# -eq 5 ] || { echo "usage: called.sh TRACER HEADER DATA FOLDER PREFIX" >&2; exit 2; }
work=$(mktemp -d)
golden=$(cd "$(dirname "$0")/../data" && pwd)/problem_v1.feti
trap 'rm -rf "$work"' EXIT

sed '/^#include/d' "$2" | ${CC:-cc} -E -P -x c - | grep -o 'feti_[A-Za-z0-9_]*(' | tr -d '(' | sort -u > "$work/missing"

# called TRACER DRIVER ARGUMENT...: the driver ends well, with the tracer before the library.
called() {
    tracer=$1
    shift
    (cd "$work" && FETI_TRACE="$work/trace" LD_PRELOAD="$tracer" "$@" > printed 2>&1)
}

[ -s "$work/missing" ] || { echo "no function in the header" >&2; exit 1; }
for driver in "$4/$5"*; do
    case $driver in
        # Generated calls, whose results nobody compares; hosts that limit their memory, fork, trap, or stop.
        *_arguments_matrix|*_misuse|*_old_callers|*_memory|*_malloc_fails|*_fork|*_dlopen|*_repeat|*_floating_point|*_fpe_trap|*_stop_on_error) continue ;;
        *) [ -f "$driver" ] && [ -x "$driver" ] || continue ;;
    esac
    rm -f "$work/trace"
    called "$1" "$driver" "$3" || called "$1" "$driver" "$3" "$work" "$golden" || continue
    sort -u "$work/trace" > "$work/called"
    comm -23 "$work/missing" "$work/called" > "$work/rest"
    mv "$work/rest" "$work/missing"
    [ -s "$work/missing" ] || exit 0
done
echo "called by no driver $5*: $(tr '\n' ' ' < "$work/missing")" >&2
exit 1
