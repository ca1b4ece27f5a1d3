#!/bin/sh
# fpm_from_pypi.sh VENV: fpm, the Fortran package manager, comes from PyPI into VENV, once; prints the name of the program.
set -eu
version=0.12.0
[ -x "$1/bin/fpm" ] || { python3 -m venv "$1" && "$1/bin/pip" install --quiet --disable-pip-version-check "fpm==$version"; } >&2
echo "$1/bin/fpm"
