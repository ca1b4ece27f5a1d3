#!/bin/sh
# installed.sh PREFIX WORK: the installed examples, copied with their data, are built and run by their own makefiles.
set -eu
export PKG_CONFIG_PATH="$1/lib/pkgconfig"
rm -rf "$2"
mkdir -p "$2"
cp -R "$1/share/doc/feti-contact/examples_c" "$1/share/doc/feti-contact/examples_fortran" "$1/share/doc/feti-contact/data" "$2"
for language in c fortran; do
    folder=$2/examples_$language more= logs=7
    [ $language = c ] || more=20_skyline_host.log logs=8
    # Those that read data are there among them, and one without; 07 and 20 are FORTRAN 77.
    make -s -C "$folder" 01_spring_and_block.log 02_membranes.log 03_hertz_cylinder.log 04_three_bodies.log 05_two_cylinders.log \
        07_own_factorisation.log 09_write_read_check.log $more >"$folder/made" 2>&1 || { cat "$folder/made"; exit 1; }
    for log in "$folder"/*.log; do
        grep -q '^demo .* ok$' "$log" || { echo "$log:"; cat "$log"; exit 1; }
    done
    [ "$(ls "$folder"/*.log | wc -l)" -eq $logs ] && [ -s "$folder"/pictures/hertz_pressure*.svg ] || { ls "$folder"; exit 1; }
done
