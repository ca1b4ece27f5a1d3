#!/bin/sh
# abi.sh write|check LIBRARY HEADER [BASELINE]: the binary interface, by libabigail, against the baseline of the library's soname
# in folder BASELINE (abi). What may come within a soname: further functions, further constants, members at the end of structs
# (they carry their size). Removed or changed functions, types and constants fail the check.
#
# Types come from the header, compiled by the C compiler into a library of empty functions (the debug information of Rust has
# other names for them, and changes with its compiler); that header and library have the same functions is another test.
set -eu
way=$1 library=$2 header=$3 baseline=${4:-$(dirname "$0")/../abi}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
soname=$(readelf -dW "$library" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')

# plain HEADER: its declarations, a member or a prototype to a line.
plain() { sed '/^#include/d' "$1" | ${CC:-cc} -E -P -x c - | sed ':join; /,$/ { N; s/,\n */, /; b join }'; }

# as_long_as OLD: standard input with no more members in a struct than it has in OLD; what has come at the end is left out.
as_long_as() {
    awk '/^typedef struct .*\{/ { name = $3; members = 0 }
         FNR == NR { if (/^  .*;/ && name != "") old[name] = ++members; if (/^}/) name = ""; next }
         /^  .*;/ && name in old && ++members > old[name] { next }
         /^}/ { name = "" }
         { print }' "$1" -
}

# described: the declarations of standard input as libabigail's XML.
described() {
    cat >"$work/declarations"
    # Every prototype with a body; 'typedef' and 'struct' begin what is none.
    { echo '#include <stdint.h>'
      cat "$work/declarations"
      tr '\n' ' ' <"$work/declarations" | sed 's/  */ /g; s/;/;\n/g' \
          | sed -n '/typedef\|struct [a-z_]* *{/d; /[ *]feti_[a-z0-9_]*(/s/;$/ { for (;;) ; }/p'
    } >"$work/empty.c"
    (cd "$work" && ${CC:-cc} -std=c99 -g -gdwarf-4 -O0 -fPIC -shared "-Wl,-soname,$soname" empty.c -o "$soname")
    abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-architecture --type-id-style hash "$work/$soname"
}

# prototypes HEADER: functions, of the host too, with the names of their parameters, which libabigail does not compare: two of
# one type may have changed places.
prototypes() { plain "$1" | grep 'feti_[a-z0-9_]*)\{0,1\}(' | sed 's/struct //g' | sort; }

# constants HEADER: their definitions, without the version.
constants() { ${CC:-cc} -E -dM -x c "$1" | grep '^#define FETI_' | grep -v FETI_CONTACT_ | sort; }

case $way in
write)
    plain "$header" | described >"$baseline/$soname.abi"
    { echo "#include <stdint.h>"; constants "$header"; plain "$header"; } >"$baseline/$soname.h"
    ;;
check)
    [ -f "$baseline/$soname.abi" ] || { echo "no baseline for $soname in $baseline: make abi"; exit 1; }
    plain "$baseline/$soname.h" >"$work/old"
    plain "$header" | as_long_as "$work/old" | described >"$work/now.abi"
    abidiff --no-added-syms "$baseline/$soname.abi" "$work/now.abi" >"$work/report" \
        || { cat "$work/report"; echo "the binary interface has changed within $soname"; exit 1; }
    for part in prototypes constants; do
        $part "$baseline/$soname.h" >"$work/before"
        $part "$header" >"$work/after"
        lost=$(comm -23 "$work/before" "$work/after")
        [ -z "$lost" ] || { echo "$part that are gone or have changed: $lost"; exit 1; }
    done
    ;;
*)
    echo "usage: abi.sh write|check LIBRARY HEADER [BASELINE]" >&2
    exit 2
    ;;
esac
