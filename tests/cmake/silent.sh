#!/bin/sh
# Runs a command that must succeed and print nothing, neither to stdout nor to stderr.
printed=$("$@" 2>&1)
code=$?
[ -z "$printed" ] || { printf 'printed:\n%s\n' "$printed"; exit 1; }
exit $code
