#!/bin/sh
# same.sh EXPECTED PROGRAM...: every program prints the forces and displacements that are right, and nothing else.
set -eu
expected=$1
shift
for program in "$@"; do
    "$program" >"$program.log" 2>&1 || { echo "$program failed:"; cat "$program.log"; exit 1; }
    diff "$expected" "$program.log" || { echo "$program does not print what is right"; exit 1; }
    echo "$program: right"
done
