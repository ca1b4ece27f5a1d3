#!/bin/sh
# prototypes.sh HEADER MODULE: the prototypes and structs that gfortran derives from the Fortran module are those of the
# header: same functions, argument by argument, and same members in the same order. Exit 1 names each difference.
set -eu
[ $# -eq 2 ] || { echo "usage: prototypes.sh HEADER MODULE" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# One line `item <tab> type` per result, argument and member.
list() {
    sed '/^#include/d' "$1" | ${CC:-cc} -E -P -x c - | awk -f "$here/declarations.awk"
}
${FC:-gfortran} -fc-prototypes -fsyntax-only -J "$work" "$2" > "$work/module.h"
list "$1" > "$work/header"
list "$work/module.h" > "$work/module"

awk -F '\t' '
    # type(c_ptr) is void *: it stands for any pointer, and for any pointer to a pointer where it is passed by reference.
    function agree(c, fortran) {
        return c == fortran || (fortran == "void *" && c ~ /\*$/) || (fortran == "void **" && c ~ /\*\*$/)
    }
    function report(line) { print line > "/dev/stderr"; differences++ }
    FILENAME != ARGV[1] { module[$1] = $2; next }
    { header[$1] = $2; items++ }
    END {
        if (items == 0) report("no declaration in the header")
        for (item in header) {
            if (!(item in module)) report(item ": not in the module")
            else if (!agree(header[item], module[item]))
                report(item ": header `" header[item] "`, module `" module[item] "`")
        }
        for (item in module) if (!(item in header)) report(item ": not in the header")
        exit differences > 0
    }' "$work/header" "$work/module"
