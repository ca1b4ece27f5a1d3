#!/bin/sh
# make.sh HOSTS PREFIX: the host with plain make and pkg-config, in a folder outside the source tree, the installation moved.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$2" "$work/moved"
cp "$1"/host.* "$1/make/Makefile" "$work"
cd "$work"
PKG_CONFIG_PATH="$work/moved/lib/pkgconfig" make >log 2>&1 || { cat log; exit 1; }
sh "$1/same.sh" host.expected ./host_c ./host_static ./host_wholly_static ./host_fortran ./host_fortran_static
for program in host_static host_wholly_static host_fortran_static; do
    ! readelf -dW $program | grep -q 'NEEDED.*feti_contact' || { echo "$program needs the shared library"; exit 1; }
done
