#!/bin/sh
# cmake.sh HOSTS installed PREFIX | source ROOT TARGET | fetch ROOT TARGET: the host under CMake, in a folder outside the source
# tree, with an installed library (moved before, so that nothing rests on the place of the installation) or one built along
# with it by cargo, whose results are in TARGET. The installed one serves a host that asks for Fortran 2008.
set -eu
hosts=$1 way=$2 place=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$hosts"/host.* "$hosts/cmake/CMakeLists.txt" "$work"
case $way in
installed)
    cp -R "$place" "$work/moved"
    cmake -S "$work" -B "$work/build" "-DCMAKE_PREFIX_PATH=$work/moved" -DCMAKE_Fortran_FLAGS=-std=f2008 >"$work/log"
    ;;
*)
    [ "$way" = source ] && fetch=OFF || fetch=ON
    cmake -S "$work" -B "$work/build" "-DFETI_CONTACT_SOURCE=$place" "-DFETI_CONTACT_TARGET_DIR=$4" -DFETCH=$fetch >"$work/log"
    ;;
esac || { cat "$work/log"; exit 1; }
cmake --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
sh "$hosts/same.sh" "$work/host.expected" "$work/build/host_c" "$work/build/host_static" "$work/build/host_fortran"
[ "$way" = installed ] || sh "$hosts/cmake_install.sh" "$work/build" "$place" "$work"
