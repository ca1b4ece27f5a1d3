#!/bin/sh
# components.sh PREFIX: find_package says what it lacks: component Fortran in a project without that language, a component that
# does not exist, another minor version before 1.0; and is content with C alone, or with Fortran as an option.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# asks ARGUMENTS: configures a project in C that asks for the package.
asks() {
    printf 'cmake_minimum_required(VERSION 3.22)\nproject(host LANGUAGES C)\nfind_package(feti_contact %s)\n' "$1" >"$work/CMakeLists.txt"
    cmake -S "$work" -B "$work/build" "-DCMAKE_PREFIX_PATH=$prefix" >"$work/log" 2>&1
}
prefix=$1
says() { tr -s ' \n' ' ' <"$work/log" | grep -q "$1" || { echo "not said: $1"; cat "$work/log"; exit 1; }; }
asks "0.2 REQUIRED" || { cat "$work/log"; exit 1; }
asks "0.2 REQUIRED COMPONENTS C OPTIONAL_COMPONENTS Fortran" || { cat "$work/log"; exit 1; }
! asks "0.2 REQUIRED COMPONENTS C Fortran" || { echo "Fortran without the language"; exit 1; }
says "enable_language(Fortran) before find_package"
! asks "0.2 REQUIRED COMPONENTS Ada" || { echo "there is no component Ada"; exit 1; }
says "no component Ada: there are C, Fortran and MPI"
! asks "0.9 REQUIRED" || { echo "0.9 is another interface"; exit 1; }
says "version: 0.2"
