#!/bin/sh
# says.sh DOCUMENT WHICH PROGRAM: what the program prints is block WHICH of the language text in the document, which may break lines.
set -eu
words() { tr -s '[:space:]' ' '; }
said=$(awk -v language=text -v which="$2" -f "$(dirname "$0")/block.awk" "$1" | words)
printed=$({ "$3" 2> /dev/null || true; } | words)
[ "$printed" = "$said" ] || { printf 'printed, but not in %s: %s\n' "$1" "$printed"; exit 1; }
