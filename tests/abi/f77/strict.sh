#!/bin/sh
# strict.sh FACE DRIVERS: the face compiles without a warning, with INTEGER of 4 and 8 bytes, without trampolines, and keeps
# nothing in static memory; its symbols are FT and at most 4 more characters; the include file has the library's numbers, and
# serves fixed and free form; drivers call every subroutine there is; examples in fixed form compile without a warning.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
fc=${FC:-gfortran}
for flags in "-O2" "-O0 -fcheck=all,no-array-temps" "-O2 -fdefault-integer-8"; do
    # shellcheck disable=SC2086 # one word per flag
    $fc -std=f2018 -Wall -Wextra -pedantic -Werror -Werror=trampolines -fimplicit-none $flags -c "$1/feti_contact_c.f90" \
        "$1/feti_contact_base.f90" "$1"/feti_contact_f77_*.f90
    # its subroutines are called in tests/mpi
    $fc -std=f2018 -Wall -Wextra -pedantic -Werror -fimplicit-none $flags -c "$1/../mpi/feti_contact_f77_mpi.f90" -o mpi.o
    shared=$(${NM:-nm} -A feti_contact*.o | awk '$2 ~ /^[bd]$/')
    [ -z "$shared" ] || { echo "variables that threads share: $shared"; exit 1; }
done

fail() { echo "$*"; exit 1; }
${NM:-nm} --defined-only feti_contact_f77_*.o | awk '$2 == "T" && $3 !~ /^_/ { sub(/_$/, "", $3); print $3 }' | sort > names
[ -s names ] || fail "no subroutine in the face"
long=$(grep -vx 'ft[a-z0-9]\{1,4\}' names || true)
[ -z "$long" ] || fail "names that are not FT and 1 to 4 characters: $long"
tr '[:upper:]' '[:lower:]' < "$1/feti_contact_f77.inc" | grep -o '^ *parameter .*' | grep -o 'ft[a-z0-9]* = ' | tr -d ' =' | sort > constants
both=$(comm -12 names constants)
[ -z "$both" ] || fail "a subroutine and a constant of the same name: $both"
twice=$(uniq -d constants)
[ -z "$twice" ] || fail "constants defined twice: $twice"
awk 'length > 72 { print FILENAME ": line " FNR " is too long for fixed form"; bad = 1 } END { exit bad }' \
    "$1/feti_contact_f77.inc" "$2"/*.f

cat "$2"/*.f | grep -v '^[Cc*!]' | grep -io 'CALL *FT[A-Z0-9]*' | sed 's/.* *FT/ft/I' | tr '[:upper:]' '[:lower:]' | sort -u > called
missing=$(comm -23 names called)
[ -z "$missing" ] || fail "subroutines that no driver calls: $missing"

cat > free.f90 <<'END'
program numbers
  use feti_contact_c
  implicit none
  include 'feti_contact_f77.inc'
  integer, parameter :: here(36) = [FTOK, FTWITR, FTWTIM, FTWCAN, FTWSTL, FTWINA, FTWMAR, FTEMEM, FTEHDL, FTEBSY, FTECBK, &
    FTESTA, FTELNH, FTEGAP, FTENUL, FTEIND, FTEIO, FTEINT, FTEUNS, FTEOVF, FTEARG, FTKINE, FTKEQU, FTFULL, FTLOWR, FTUPPR, &
    FTEXCT, FTCAND, FTSOFT, FTOPEN, FTCLOS, FTWEAK, FTPSET, FTPSOL, FTTCG, FTTEXP]
  integer, parameter :: library(36) = [FETI_OK, FETI_ITERATIONS, FETI_TIME, FETI_CANCELLED, FETI_STALLED, FETI_INACCURATE, &
    FETI_MARGINAL, FETI_MEMORY, FETI_HANDLE, FETI_BUSY, FETI_CALLBACK, FETI_STATE, FETI_LOAD_NOT_HELD, FETI_GAPS_CONTRADICT, &
    FETI_NULL_SPACE, FETI_INDEFINITE, FETI_IO, FETI_INTERNAL, FETI_UNSUPPORTED, FETI_OVERFLOW, FETI_ARGUMENT, &
    FETI_INEQUALITY, FETI_EQUALITY, FETI_FULL, FETI_LOWER, FETI_UPPER, FETI_EXACT, FETI_CANDIDATES, FETI_SOFT, &
    FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK, FETI_PHASE_SETUP, FETI_PHASE_SOLVE, FETI_STEP_CONJUGATE_GRADIENT, &
    FETI_STEP_EXPANSION]
  integer, parameter :: more(37) = [FTSKDN, FTSKUP, FTTREL, FTODBL, FTOINT, FTOCHR, FTUNKN, FTESLD, FTKTAN, FTTNEW, FTFOPE, &
    FTFSTI, FTFSLI, FTFWEA, FTFUNK, FTECOM, FTLIN2, FTLIN3, FTTRI3, FTTRI6, FTQUA4, FTQUA8, FTQUA9, FTPOIN, FTPLAN, FTSPHE, &
    FTCYLI, FTNTOF, FTTIED, FTVFOR, FTVPRE, FTVSHE, FTVGAP, FTVSLI, FTVARE, FTVNOR, FTVCLO]
  integer, parameter :: others(37) = [FETI_SKYLINE_DOWN, FETI_SKYLINE_UP, &
    FETI_STEP_RELEASE, FETI_OPTION_F64, FETI_OPTION_I64, FETI_OPTION_STR, FETI_ROW_UNKNOWN, &
    FETI_SLIDES, FETI_TANGENTIAL, FETI_STEP_NEWTON, &
    FETI_FRICTION_OPEN, FETI_FRICTION_STICK, FETI_FRICTION_SLIP, FETI_FRICTION_WEAK, &
    FETI_FRICTION_UNKNOWN, FETI_COMMUNICATION, FETI_LINE2, FETI_LINE3, FETI_TRI3, FETI_TRI6, FETI_QUAD4, FETI_QUAD8, &
    FETI_QUAD9, FETI_POINT, FETI_PLANE, FETI_SPHERE, FETI_CYLINDER, FETI_NODE_TO_FACE, FETI_TIED, FETI_FORCE, FETI_PRESSURE, &
    FETI_SHEAR, FETI_GAP, FETI_SLIP, FETI_AREA, FETI_NORMAL, FETI_CLOSED]

  if (any(here /= library) .or. any(more /= others)) error stop 1
end program
END
$fc -fdefault-integer-8 -std=f2018 -Wall -pedantic -Werror -I"$1" free.f90 -o free
./free || fail "the include file and the library have different numbers"
printf "      PROGRAM FIXED\n      IMPLICIT NONE\n      INCLUDE 'feti_contact_f77.inc'\n      END\n" > fixed.f
$fc -std=legacy -Wall -Werror -I"$1" -c fixed.f
$fc -std=legacy -Wall -Werror -I"$1" -c "$2"/../../../examples_fortran/[0-9]*.f
