#!/bin/sh
# build.sh COMPILER PREFIX ROOT WORK [OBJECT...]: compiles all Fortran layers, the examples and the drivers of tests/abi with
# one compiler and links them with the installed library below PREFIX: WORK/bin. Objects: what the driver cholmod_oracle
# needs beside. Warnings are in WORK/words; any error ends it.
set -eu
fc=$1 prefix=$2 root=$3 work=$4
shift 4
face=$prefix/share/feti_contact/fortran
link="-L$prefix/lib -lfeti_contact -Wl,-rpath,$prefix/lib"
rm -rf "$work"
mkdir -p "$work/bin"
cd "$work"

# run COMMAND...: its words are kept, and to stdout when it fails.
run() {
    "$@" > last 2>&1 || { cat last; exit 1; }
    cat last >> words
}

# into FOLDER FLAGS FILE...: compiles the files in their order into FOLDER, modules and objects.
into() {
    folder=$1 flags=$2
    shift 2
    mkdir -p "$folder"
    for file in "$@"; do
        # shellcheck disable=SC2086 # one word per flag
        (cd "$folder" && "$fc" $flags -I"$face" -c "$file") > last 2>&1 || { cat last; exit 1; }
        cat last >> words
    done
}

typed="$face/feti_contact_c.f90 $face/feti_contact_base.f90"
for file in "$face"/feti_contact_[a-z]*.f90; do
    case $file in *_c.f90 | *_base.f90 | *_f77_*) ;; *) typed="$typed $file" ;; esac
done
f77="$face/feti_contact_f77_base.f90"
for file in "$face"/feti_contact_f77_*.f90; do
    [ "$file" = "$f77" ] || f77="$f77 $file"
done
examples=$root/examples_fortran
# shellcheck disable=SC2086 # one word per file
into typed -O1 $typed "$face/feti_contact.f90" "$examples/case_reader.f90" "$examples/demo.f90" "$examples/picture.f90" \
    "$examples/vtu_picture.f90" \
    "$root/tests/abi/fortran/support/case_problem.f90"
# shellcheck disable=SC2086
into f77_4 -O1 "$face/feti_contact_c.f90" "$face/feti_contact_base.f90" $f77
# shellcheck disable=SC2086
into f77_8 "-O1 -fdefault-integer-8" "$face/feti_contact_c.f90" "$face/feti_contact_base.f90" $f77

# program NAME FILE [OBJECT...]: a program of one file with the typed face.
program() {
    name=$1 file=$2
    shift 2
    mkdir -p "$name"
    # shellcheck disable=SC2086
    run "$fc" -O1 -Ityped -I"$face" -J"$name" "$file" typed/*.o "$@" $link -o "bin/$name"
}
# example 15 needs MPI
for file in "$examples"/0*.f90 "$examples"/1[1-489]*.f90; do program "example_$(basename "$file" .f90)" "$file"; done
for file in "$examples"/[0-9]*.f; do
    # shellcheck disable=SC2086
    run "$fc" -O1 -I"$face" "$file" f77_4/*.o $link -o "bin/example_$(basename "$file" .f)"
done
for file in "$root"/tests/abi/fortran/*.f90; do
    name=$(basename "$file" .f90)
    case $name in
        cholmod_oracle) program "$name" "$file" "$@" ;;
        fpe_trap) ;; # traps are set by a flag of gfortran
        *) program "$name" "$file" ;;
    esac
done

for bytes in 4 8; do
    flags=-O1
    [ $bytes -eq 4 ] || flags="-O1 -fdefault-integer-8"
    into "fixed_$bytes" "$flags" "$root"/tests/abi/f77/*.f
    for name in three_bodies calls watched refused; do
        parts=
        [ $name != calls ] || parts="fixed_$bytes/findings.o fixed_$bytes/kept.o fixed_$bytes/elements.o fixed_$bytes/numbers.o fixed_$bytes/friction.o fixed_$bytes/surfaces.o"
        # shellcheck disable=SC2086
        run "$fc" fixed_$bytes/$name.o $parts fixed_$bytes/small.o fixed_$bytes/reader.o f77_$bytes/*.o $link -o bin/f77_${name}_$bytes
    done
done
# shellcheck disable=SC2086
run "$fc" fixed_8/sizes.o fixed_8/reader.o f77_4/*.o $link -o bin/f77_sizes
