#!/bin/sh
# release.sh OUT: what a release consists of, in OUT: the source archive with all crates, the Python wheel, Debian packages, the package of
# Spack with the checksum of the archive, and SHA256SUMS. It is made of what git has; one commit gives one source archive, bit by bit.
# The archive, unpacked, is built and installed without network, and its library has the version of the release.
set -eu
cd "$(dirname "$0")/.."
root=$PWD
[ -z "$(git status --porcelain)" ] || { echo "release.sh: commit first: a release is made of what git has" >&2; exit 1; }
rm -rf "$1"
mkdir -p "$1"
out=$(cd "$1" && pwd)
work=$out/work
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
name=feti-contact-$version
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH

tools/vendored.sh "$work/$name"
tar -C "$work" --format=gnu --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --mode=u+rw,a+rX,go-w \
    -cf "$work/source.tar" "$name"
gzip -n -9 <"$work/source.tar" >"$out/$name.tar.gz"
sed "s/@SHA256@/$(sha256sum <"$out/$name.tar.gz" | cut -d ' ' -f 1)/" packaging/spack/package.py >"$out/package.py"
rm -rf "${work:?}"
sh tests/packaging/offline.sh "$root" "$work/offline" "$out/$name.tar.gz"

python3 -m venv "$work/venv"
"$work/venv/bin/pip" wheel --quiet --no-deps --wheel-dir "$out" ./python
ls "$out"/feti_contact-"$version"-*.whl >/dev/null

tools/deb.sh "$work/deb"
mv "$work"/deb/*.deb "$out"
rm -rf "${work:?}"
cd "$out"
sha256sum ./* | sed 's|\./||' >"$out.sums"
mv "$out.sums" SHA256SUMS
cat SHA256SUMS
