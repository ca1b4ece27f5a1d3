#!/bin/sh
# install.sh ROOT WORK: make install below a DESTDIR puts library, links, header, Fortran sources, pkg-config and CMake files,
# licences and documents, and nothing that names the DESTDIR or the source tree; distributions choose the folders; a tree may
# be moved. make uninstall removes exactly what was put: files of others in the same folders stay.
set -eu
root=$1 stage=$2
make_it() { make -C "$root" --no-print-directory "$@" DESTDIR="$stage" >/dev/null; }
# has FILE...: files that are there and not empty.
has() { for file in "$@"; do [ -s "$file" ] || { echo "$file was not installed"; exit 1; }; done; }

rm -rf "$stage"
make_it install PREFIX=/opt/feti
cd "$stage/opt/feti"
has lib/libfeti_contact.so lib/libfeti_contact.a bin/feti-contact share/man/man1/feti-contact.1 include/feti_contact.h include/feti_contact.hpp lib/pkgconfig/feti_contact.pc \
    lib/cmake/feti_contact/feti_contact-config.cmake share/feti_contact/fortran/feti_contact.f90 \
    share/feti_contact/fortran/fpm.toml share/feti_contact/mpi/feti_mpi.c share/feti_contact/mpi/feti_contact_mpi.h share/doc/feti-contact/LICENSE-MIT share/doc/feti-contact/LICENSE-THIRD-PARTY \
    share/doc/feti-contact/docs/licences.md share/doc/feti-contact/examples_c/Makefile \
    share/doc/feti-contact/data/three_bodies/K1.mtx.gz
for file in "$root"/include/fortran/*.f90 "$root"/include/fortran/*.inc; do
    [ ! -f "$file" ] || has "share/feti_contact/fortran/$(basename "$file")"
done
soname=$(readelf -dW lib/libfeti_contact.so | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')
[ "$(readlink lib/libfeti_contact.so)" = "$soname" ] || { echo "libfeti_contact.so does not point to $soname"; exit 1; }
[ -n "$(readlink "lib/$soname")" ] || { echo "$soname is no link"; exit 1; }
version=$(PKG_CONFIG_PATH=lib/pkgconfig pkg-config --modversion feti_contact)
for of in fortran mpi; do
    grep -qx "version = \"$version\"" share/feti_contact/$of/fpm.toml || { echo "fpm.toml of $of is not of version $version"; exit 1; }
done
texts="lib/pkgconfig lib/cmake share/feti_contact"
! grep -rq '@[A-Z]*@' $texts || { echo "a template was not filled in"; exit 1; }
! grep -rqF -e "$stage" -e "$root" -e /opt/feti $texts || { echo "a file names the place of installation"; exit 1; }

mkdir -p share/man/man3
echo "of make docs, which may be gone" >share/man/man3/feti_solve.3
echo "of another package" | tee include/other.h share/feti_contact/fortran/other.f90 share/man/man3/feti_other.3 \
    >lib/cmake/feti_contact/other.cmake
make_it uninstall PREFIX=/opt/feti
left=$(find . ! -type d | sort | tr '\n' ' ')
expected="./include/other.h ./lib/cmake/feti_contact/other.cmake ./share/feti_contact/fortran/other.f90 ./share/man/man3/feti_other.3 "
[ "$left" = "$expected" ] || { echo "left behind: $left"; exit 1; }
[ ! -d share/doc/feti-contact ] || { echo "an empty folder of ours is left"; exit 1; }
cd "$root"

# Folders named from where make is called; libraries without what only a debugger reads, and STRIP= leaves it in; the archive has no
# global symbols but the functions of the header.
rm -rf "$stage"
mkdir -p "$stage"
(cd "$stage" && PREFIX=relative DESTDIR='' "$root/tools/install.sh" install >/dev/null && has relative/lib/libfeti_contact.so)
make_it install PREFIX=/debug STRIP=
debug() { readelf -SW "$1" | grep -q '\.debug_info'; }
debug "$stage/debug/lib/libfeti_contact.so" || { echo "STRIP= strips all the same"; exit 1; }
! debug "$stage/relative/lib/libfeti_contact.so" || { echo "the shared library is not stripped"; exit 1; }
nm -D --defined-only "$stage/relative/lib/libfeti_contact.so" | awk '{ print $NF }' | sort >"$stage/exported"
nm -g --defined-only "$stage/relative/lib/libfeti_contact.a" | awk 'NF == 3 { print $3 }' | sort >"$stage/archived"
[ -s "$stage/exported" ] && diff "$stage/exported" "$stage/archived" || { echo "the archive has other symbols"; exit 1; }

# Folders as distributions have them, below PREFIX or not.
rm -rf "$stage"
folders="PREFIX=/usr LIBDIR=lib/x86_64-linux-gnu INCLUDEDIR=/usr/include/feti DATADIR=/srv/data DOCDIR=/usr/doc/feti"
make_it install $folders
has "$stage/usr/lib/x86_64-linux-gnu/libfeti_contact.so" "$stage/usr/include/feti/feti_contact.h" "$stage/usr/doc/feti/README.md"
say() { PKG_CONFIG_PATH="$stage/usr/lib/x86_64-linux-gnu/pkgconfig" pkg-config --variable="$1" feti_contact; }
[ "$(say libdir)" -ef "$stage/usr/lib/x86_64-linux-gnu" ] && [ "$(say includedir)" -ef "$stage/usr/include/feti" ] \
    && [ "$(say fortrandir)" = /srv/data/feti_contact/fortran ] && [ "$(say mpi_sources)" = /srv/data/feti_contact/mpi/feti_mpi.c ] || { echo "pkg-config: $(say libdir) $(say includedir) $(say fortrandir) $(say mpi_sources)"; exit 1; }
grep -qF '${CMAKE_CURRENT_LIST_DIR}/../../../..' "$stage"/usr/lib/*/cmake/feti_contact/feti_contact-config.cmake \
    || { echo "the CMake package does not lead from lib/<triplet> to the prefix"; exit 1; }
make_it uninstall $folders
left=$(find "$stage" ! -type d)
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
