#!/bin/sh
# install.sh ROOT WORK: make install below a DESTDIR puts library, links, header, Fortran sources, pkg-config and CMake files;
# make uninstall leaves no file behind.
set -eu
rm -rf "$2"
make -C "$1" --no-print-directory install PREFIX=/opt/feti DESTDIR="$2" >/dev/null
prefix=$2/opt/feti
for file in lib/libfeti_contact.so lib/libfeti_contact.a include/feti_contact.h lib/pkgconfig/feti_contact.pc \
            lib/cmake/feti_contact/feti_contact-config.cmake share/feti_contact/fortran/feti_contact.f90; do
    [ -s "$prefix/$file" ] || { echo "$file was not installed"; exit 1; }
done
! grep -rq '@[A-Z]*@' "$prefix/lib/pkgconfig" "$prefix/lib/cmake" || { echo "a template was not filled in"; exit 1; }
make -C "$1" --no-print-directory uninstall PREFIX=/opt/feti DESTDIR="$2" >/dev/null
left=$(find "$2" ! -type d)
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
