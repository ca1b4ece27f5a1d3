#!/bin/sh
# cmake_install.sh BUILD ROOT WORK: cmake --install puts the same files as make install, also below a DESTDIR.
set -eu
DESTDIR=$3/staged cmake --install "$1" --prefix /opt/host >"$3/log" || { cat "$3/log"; exit 1; }
(cd "$3/staged/opt/host" && find . ! -type d | sort) >"$3/by_cmake"
PREFIX='' "$2/tools/install.sh" list | sed 's/^/./' | sort >"$3/by_make"
diff "$3/by_make" "$3/by_cmake" || { echo "cmake --install and make install differ"; exit 1; }
