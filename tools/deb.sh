#!/bin/sh
# deb.sh WORK: Debian packages of the library, its development files and its documents, in WORK, from a copy of the tree with vendored
# crates and Debian's own Rust, without network; lintian finds no error in them; installed, they serve a host in C and one in
# Fortran, and the program solves a problem file. With KEEP=1 they stay installed. DEBFULLNAME and DEBEMAIL name the maintainer; without them the address is a placeholder,
# which lintian is told to accept. Root is needed to install; otherwise the packages are unpacked into WORK/root.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
rm -rf "${work:?}"/*
rust="rustc cargo"
dpkg --compare-versions "$(apt-cache policy rustc | sed -n 's/.*Candidate: //p')" ge 1.85 || rust="rustc-web cargo-web"
# shellcheck disable=SC2086 # one word per package
"$root/tools/setup.sh" debhelper dpkg-dev lintian $rust

"$root/tools/vendored.sh" "$work/feti-contact"
cd "$work/feti-contact"
cp -R packaging/debian debian
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
maintainer="${DEBFULLNAME:-The authors of feti-contact} <${DEBEMAIL:-feti-contact@localhost}>"
sed -i "s/@VERSION@/$version/; s/@DATE@/$(date -R ${SOURCE_DATE_EPOCH:+-d @$SOURCE_DATE_EPOCH})/; s/@MAINTAINER@/$maintainer/" debian/changelog.in debian/control
mv debian/changelog.in debian/changelog
sed 's/^$/./; s/^/ /' LICENSE-MIT >"$work/mit"
sed -i -e "/@MIT@/r $work/mit" -e '/@MIT@/d' debian/copyright
rm "$work/mit"
alone=
[ "$(id -u)" -ne 0 ] || ! unshare -n true 2>/dev/null || alone="unshare -n"
$alone dpkg-buildpackage --build=binary --no-sign >"$work/log" 2>&1 || { tail -n 40 "$work/log"; exit 1; }
cd "$work"
rm -rf feti-contact
address=
[ -n "${DEBEMAIL-}" ] || address="--suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,mail-address-loops-or-bounces"
# shellcheck disable=SC2086 # words
lintian --fail-on error --allow-root $address ./*.changes

# Hosts, built with what a user of the packages writes.
cp "$root"/tests/packaging/host.* .
packages=$(ls ./*.deb | grep -v dbgsym)
for package in $packages; do dpkg-deb --extract "$package" root; done
lib=$work/root/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
if [ "$(id -u)" -eq 0 ]; then
    # shellcheck disable=SC2086 # one word per package
    dpkg --install $packages >>log
    man feti_solve >/dev/null
else export PKG_CONFIG_PATH="$lib/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$work/root" LD_LIBRARY_PATH="$lib"
fi
cc host.c $(pkg-config --cflags --libs feti_contact) -o host_c
gfortran $(pkg-config --variable=fortransources feti_contact) host.f90 $(pkg-config --libs feti_contact) -o host_fortran
sh "$root/tests/packaging/same.sh" host.expected ./host_c ./host_fortran
root/usr/bin/feti-contact solve "$root/tests/data/problem_v1.feti" >>log
if [ "$(id -u)" -eq 0 ] && [ -z "${KEEP-}" ]; then
    # shellcheck disable=SC2046 # one word per package
    dpkg --purge $(for package in $packages; do dpkg-deb --field "$package" Package; done) >>log
fi
echo "the library needs glibc $(objdump -T "$lib"/libfeti_contact.so.*.*.* | grep -o 'GLIBC_[0-9.]*' | sort -Vu | sed -n '$s/GLIBC_//p')"
rm -rf root
ls -l ./*.deb
