#!/bin/sh
# pkg_config.sh PREFIX ROOT WORK: example 01 built in C and in Fortran with what pkg-config says, then run.
set -eu
export PKG_CONFIG_PATH="$1/lib/pkgconfig"
mkdir -p "$3"
cd "$3"
flags=$(pkg-config --cflags feti_contact)
libs=$(pkg-config --libs feti_contact)
modules=$(pkg-config --variable=fortransources feti_contact)
rpath="-Wl,-rpath,$(pkg-config --variable=libdir feti_contact)"
"${CC:-cc}" $flags "$2/examples_c/01_spring_and_block.c" "$2/examples_c/demo.c" -o c $libs "$rpath" -lm
./c
"${FC:-gfortran}" $modules "$2/examples_fortran/demo.f90" "$2/examples_fortran/01_spring_and_block.f90" -o fortran $libs "$rpath"
./fortran
