#!/bin/sh
# fpm.sh HOSTS PREFIX VENV: the host under fpm, outside the source tree, depends on the installed Fortran sources by path.
set -eu
fpm=$(sh "$1/fpm_from_pypi.sh" "$3")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$2" "$work/moved"
mkdir "$work/app"
cp "$1/host.f90" "$work/app"
cp "$1/host.expected" "$1/fpm/fpm.toml" "$work"
cd "$work"
export PKG_CONFIG_PATH="$work/moved/lib/pkgconfig"
rpath="-Wl,-rpath,$(pkg-config --variable=libdir feti_contact)"
"$fpm" install --prefix "$work/out" --link-flag "$(pkg-config --libs feti_contact) $rpath" >log 2>&1 || { cat log; exit 1; }
sh "$1/same.sh" host.expected out/bin/host
