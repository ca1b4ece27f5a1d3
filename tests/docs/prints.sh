#!/bin/sh
# prints.sh PROGRAM DOCUMENT: the program ends with success, and what it prints is what the document says, between ticks.
set -eu
printed=$("$1")
grep -qF "\`$printed\`" "$2" || { echo "printed, but not in $2: $printed"; exit 1; }
