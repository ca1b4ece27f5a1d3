#!/bin/sh
# fails.sh DOCUMENT WHICH PROGRAM...: every program fails, and block WHICH of the language text in the document is what they print, one
# after the other. The block may break lines.
set -eu
words() { tr -s '[:space:]' ' '; }
document=$1
said=$(awk -v language=text -v which="$2" -f "$(dirname "$0")/block.awk" "$1" | words)
shift 2
# gfortran: no backtrace, and the text before the line of error stop
export GFORTRAN_ERROR_BACKTRACE=0 GFORTRAN_UNBUFFERED_PRECONNECTED=1
printed=$(for program in "$@"; do
    if "$program" 2>&1; then echo "$program does not fail"; fi
done | words)
[ "$printed" = "$said" ] || { printf 'printed, but not in %s: %s\n' "$document" "$printed"; exit 1; }
