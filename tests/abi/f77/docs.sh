#!/bin/sh
# docs.sh PREFIX CHAPTER: the chapter lists every subroutine of the face with its arguments and every constant, its example
# compiles with the installed sources and prints the numbers it promises, and its functions of the host compile.
set -eu
face=$1/share/feti_contact/fortran
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat "$face"/feti_contact_f77_*.f90 "$face"/../mpi/feti_contact_f77_*.f90 | sed -n 's/^recursive subroutine \(ft[a-z0-9]*(.*)\)$/`\1`/p' | tr '[:lower:]' '[:upper:]' | sort > subroutines
[ -s subroutines ] || { echo "no subroutine in the face"; exit 1; }
grep -o '^| `FT[^`]*`' "$2" | sed 's/^| //' | sort > listed
diff subroutines listed || { echo "subroutines (<) and the chapter (>) differ"; exit 1; }
for name in $(grep -v '^!' "$face/feti_contact_f77.inc" | grep -o 'FT[A-Z0-9]*' | sort -u); do
    grep -qw "$name" "$2" || { echo "constant $name is not in the chapter"; exit 1; }
done

sed -n '/^```fortran/,/^```$/p' "$2" | awk '/^```fortran/ { block++; next } /^```/ { next } { print > ("block" block ".f") }'
fc=${FC:-gfortran}
$fc -O2 -c "$face/feti_contact_c.f90" "$face/feti_contact_base.f90" "$face"/feti_contact_f77_*.f90
$fc -std=legacy -Wall -Werror -Wno-unused-dummy-argument -I"$face" -c block2.f block3.f
$fc -O2 -std=legacy -Wall -Werror -I"$face" block1.f feti_contact_*.o -L"$1/lib" -lfeti_contact -Wl,-rpath,"$1/lib" -o example
./example > printed
[ "$(tr -s ' \n' ' ' < printed)" = " force 10.0000 u(1) -0.3000 " ] || { cat printed; exit 1; }
