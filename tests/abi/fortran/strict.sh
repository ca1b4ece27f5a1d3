#!/bin/sh
# strict.sh MODULES ROOT: the Fortran sources of the library, the examples and the drivers compile as Fortran 2008 without a
# warning, with and without run-time checks, and need no trampolines (an executable stack); the modules keep nothing in static
# memory, where threads would meet; the C layer is Fortran 2003. The FORTRAN 77 face is with tests/abi/f77/strict.sh.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
compiler="${FC:-gfortran} -Wall -Wextra -pedantic -Werror -Werror=trampolines -c"
face="$1/feti_contact_c.f90 $1/feti_contact_base.f90"
for file in "$1"/feti_contact_*.f90; do
    case $file in *_c.f90 | *_base.f90 | *_f77_*) ;; *) face="$face $file" ;; esac
done
examples="$2/examples_fortran/case_reader.f90 $2/examples_fortran/demo.f90 $2/examples_fortran/picture.f90 $2/examples_fortran/vtu_picture.f90"
drivers="$2/tests/abi/fortran/support/case_problem.f90"

$compiler -std=f2003 "$1/feti_contact_c.f90"
for checks in "-O2" "-O0 -fcheck=all,no-array-temps"; do
    # example 15 needs MPI: tests/mpi
    for file in $face "$1/feti_contact.f90" "$1/../mpi/feti_contact_mpi.f90" $examples $drivers "$2"/examples_fortran/0*.f90 "$2"/examples_fortran/1[1-4]*.f90 "$2"/tests/abi/fortran/*.f90; do
        $compiler -std=f2008 $checks "$file"
    done
    shared=$(${NM:-nm} -A feti_contact*.o | awk '$2 ~ /^[bd]$/')
    [ -z "$shared" ] || { echo "variables that threads share: $shared"; exit 1; }
done
