#!/bin/sh
# abi_gate.sh ROOT LIBRARY HEADER: the interface is that of the baseline, or more; and the check sees what breaks a host, in
# copies of the baseline that are changed by hand, and lets pass what does not.
set -eu
check="$1/tools/abi.sh check $2"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
$check "$3"

before=$1/abi/$(readelf -dW "$2" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p').h
# changed EXPRESSION: the baseline's header after a change, which must be one.
changed() { sed "$1" "$before" >"$work/header.h"; ! cmp -s "$before" "$work/header.h" || { echo "no change by $1"; exit 1; }; }
breaks() { changed "$2"; ! $check "$work/header.h" >"$work/log" 2>&1 || { echo "not seen: $1"; exit 1; }; }
passes() { changed "$2"; $check "$work/header.h" >"$work/log" 2>&1 || { echo "refused: $1"; cat "$work/log"; exit 1; }; }

breaks "a function is gone" '/^int32_t feti_cancel(/d'
breaks "a parameter has another type" 's/^int32_t feti_body_add(feti_problem \*p, int64_t n/int32_t feti_body_add(feti_problem *p, int32_t n/'
breaks "a parameter more" 's/^int32_t feti_cancel(/int32_t feti_cancel(int32_t reason, /'
breaks "parameters of one type have changed places" 's/^\(int32_t feti_rows_rhs(.*\)int64_t first, int64_t rows/\1int64_t rows, int64_t first/'
breaks "a function returns another type" 's/^int32_t feti_cancel(/int64_t feti_cancel(/'
breaks "a member in the middle" 's/^  int64_t cg_steps;/  int64_t before;\n  int64_t cg_steps;/'
breaks "a member is gone" '/^  int64_t operator_bytes;/d'
breaks "a member of another type" 's/^  int64_t cg_steps;/  double cg_steps;/'
breaks "members have changed places" 's/^  int64_t cg_steps;/  int64_t swapped;/; s/^  int64_t expansions;/  int64_t cg_steps;/; s/swapped/expansions/'
breaks "a member of another type in a struct that grows" 's/^  int64_t cg_steps;/  double cg_steps;/; s/^  int64_t friction_starts;/&\n  double more;/'
breaks "an array in a struct is longer" 's/^  double motion\[6\];/  double motion[7];/'
breaks "the function of the host has another parameter" 's/^typedef int32_t (\*feti_progress_fn)(void \*user,/& int32_t phase,/'
breaks "a constant has another value" 's/^#define FETI_LOWER 1/#define FETI_LOWER 3/'
breaks "a constant is gone" '/^#define FETI_MARGINAL /d'
passes "a function more" 's/^int32_t feti_cancel(/int32_t feti_new(feti_problem *p, double x);\nint32_t feti_cancel(/'
passes "a member at the end" 's|^  int64_t friction_starts;|&\n  double new_figure;|'
passes "a constant more" 's/^#define FETI_LOWER 1/#define FETI_LOWER 1\n#define FETI_NEW 77/'
