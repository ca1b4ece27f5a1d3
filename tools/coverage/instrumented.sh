#!/bin/sh
# The compiler for the library itself; what it depends on is compiled as ever.
compiler=$1
shift
exec "$compiler" "$@" -C instrument-coverage
