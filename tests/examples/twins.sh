#!/bin/sh
# twins.sh C_PROGRAM FORTRAN_PROGRAM DATA PICTURES: both end with exit code 0 and a demo line that is ok, and apart from
# the demo line and the names of pictures they print the same lines.
set -eu
mkdir -p "$4/c" "$4/fortran"
"$1" "$3" "$4/c" >"$4/c.log" || { cat "$4/c.log"; exit 1; }
"$2" "$3" "$4/fortran" >"$4/fortran.log" || { cat "$4/fortran.log"; exit 1; }
for language in c fortran; do
    grep -q "^demo [0-9a-z_]* $language unknowns .* ok *\$" "$4/$language.log" || { cat "$4/$language.log"; exit 1; }
    grep -v '^demo \|^picture ' "$4/$language.log" | sed 's/ *$//' >"$4/$language.numbers"
done
[ -s "$4/c.numbers" ] || { echo "no numbers printed"; exit 1; }
diff "$4/c.numbers" "$4/fortran.numbers"
