#!/bin/sh
# stops.sh PROGRAM: it ends with exit code 1, prints nothing to stdout and the library's text to stderr.
set -u
text=$("$1" 2>&1 >/dev/null)
code=$?
[ $code -eq 1 ] || { echo "exit code $code"; exit 1; }
[ -z "$("$1" 2>/dev/null)" ] || { echo "printed to stdout"; exit 1; }
echo "$text" | grep -q body || { echo "no text of the library: $text"; exit 1; }
