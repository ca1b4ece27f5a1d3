#!/bin/sh
# same_forces.sh PROGRAM OTHER: both end with exit code 0 and a demo line that is ok, and apart from it and the names of pictures print the
# same lines, in which a number differs by at most 1e-8 of the largest one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for which in 1 2; do
    "$1" "$work" "$work" > "$work/log" || { cat "$work/log"; exit 1; }
    grep -q '^demo .* ok *$' "$work/log" || { cat "$work/log"; exit 1; }
    grep -v '^demo \|^picture ' "$work/log" > "$work/$which"
    shift
done
[ -s "$work/1" ] || { echo "no numbers printed"; exit 1; }
paste -d '|' "$work/1" "$work/2" | awk -F '|' '
    { n = split($1, a, /[ :]+/); m = split($2, b, /[ :]+/)
      if (n != m) { print; bad = 1 }
      for (k = 1; k <= n; k++) {
          number = a[k] ~ /^-?[0-9]+[.]?[0-9]*$/
          if (number && a[k] * a[k] > most * most) most = a[k]
          if (!number && a[k] != b[k]) { print; bad = 1 }
          if (number) { count++; off = a[k] - b[k]; if (off * off > worst * worst) worst = off }
      } }
    END {
        if (count < 20 || worst * worst > 1e-16 * most * most) { print "largest difference " worst " of " most; bad = 1 }
        exit bad
    }'
