#!/bin/sh
# symbols.sh LIBRARY HEADER MODULE: the library exports the functions of the header, the Fortran module binds the same
# ones, and the library exports nothing else. Exit 1 names each difference.
set -eu
[ $# -eq 3 ] || { echo "usage: symbols.sh LIBRARY HEADER MODULE" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

${NM:-nm} -D --defined-only "$1" | awk '{ sub(/@.*/, "", $NF); print $NF }' | sort -u > "$work/library"
sed '/^#include/d' "$2" | ${CC:-cc} -E -P -x c - | grep -o 'feti_[A-Za-z0-9_]*(' | tr -d '(' | sort -u > "$work/header"
sed -n 's/^[^!]*name="\([^"]*\)").*/\1/p' "$3" | sort -u > "$work/module"

fail=0
# only_in A B: the names of A that B lacks.
only_in() {
    names=$(comm -23 "$work/$1" "$work/$2" | tr '\n' ' ')
    [ -z "$names" ] || { echo "in the $1, not in the $2: $names" >&2; fail=1; }
}
[ -s "$work/header" ] || { echo "no function in the header" >&2; fail=1; }
only_in library header
only_in header library
only_in header module
only_in module header
exit $fail
