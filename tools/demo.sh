#!/bin/sh
# Runs the examples: demo.sh <folder of programs> <data> <pictures>. Prints the demo line of each, then the
# pictures written, without the single steps of a .pvd. Everything an example prints is in <folder of programs>/<example>.log. Exit code 1 when an
# example fails, prints no demo line, or is short of its reference.
set -u
programs=$1 data=$2 pictures=$3
bad=0

mkdir -p "$pictures"
for program in "$programs"/*_c "$programs"/*_fortran; do
    log=$program.log
    "$program" "$data" "$pictures" >"$log" 2>&1
    code=$?
    grep '^demo ' "$log" || { echo "demo $(basename "$program") printed no line:"; cat "$log"; code=1; }
    [ $code -eq 0 ] && grep -q '^demo .* ok$' "$log" || bad=1
done
cat "$programs"/*.log | grep '^picture ' | grep -v '_[0-9]*\.vtu$' | sort -u
exit $bad
