#!/bin/sh
# prints.sh PROGRAM FOLDER: the program ends with 0 and prints 640 N, which is the load, on either interface.
set -eu
printed=$("$1" "$2") || { echo "$printed"; exit 1; }
[ "$(echo "$printed" | grep -c '\[N\]  640\.0000')" -eq 2 ] || { echo "$printed"; exit 1; }
