#!/bin/sh
# binary.sh LIBRARY: libfeti_contact.so.MAJOR.MINOR.PATCH carries the soname libfeti_contact.so.MAJOR.MINOR, stays in memory
# after dlclose (its threads may still run) and asks for no executable stack.
set -eu
dynamic=$(readelf -dW "$1")
soname=$(basename "${1%.*}")
echo "$dynamic" | grep -q "SONAME.*\[$soname\]" || { echo "soname is not $soname: $dynamic"; exit 1; }
echo "$dynamic" | grep -q NODELETE || { echo "not linked with -z nodelete"; exit 1; }
if readelf -lW "$1" | grep GNU_STACK | grep -q RWE; then echo "executable stack"; exit 1; fi
