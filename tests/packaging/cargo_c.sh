#!/bin/sh
# cargo_c.sh ROOT TOOLS WORK: cargo cinstall (cargo-c in TOOLS/bin) puts what make install does, but the CMake package and the program: the same
# files, soname, exported symbols, pkg-config answers; a host is built with it and prints what is right.
set -eu
root=$1 work=$3
PATH=$2/bin:$PATH
rm -rf "$work/by_make" "$work/by_cargo"
mkdir -p "$work"
make -C "$root" --no-print-directory install PREFIX=/usr LIBDIR=lib DESTDIR="$work/by_make" >/dev/null
# Without optimisation, which changes neither files nor symbols.
export CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_DEBUG=0 CARGO_PROFILE_RELEASE_INCREMENTAL=false
(cd "$root" && CARGO_TARGET_DIR="$work/target" cargo cinstall --release --locked --destdir "$work/by_cargo" --prefix /usr --libdir /usr/lib)

for way in make cargo; do
    prefix=$work/by_$way/usr
    { (cd "$prefix" && find . ! -type d ! -path './lib/cmake/*' ! -path './bin/*' ! -path './share/man/man1/*' | sort)
      readelf -dW "$prefix/lib/libfeti_contact.so" | sed -n 's/.*\(SONAME.*\)/\1/p; s/.*\(NODELETE\).*/\1/p'
      find "$prefix/lib" -type l -exec basename {} \; | sort | sed 's/^/a link: /'
      nm -D --defined-only "$prefix/lib/libfeti_contact.so" | awk '{ print $NF }' | sort
      for question in --modversion --cflags --libs; do
          PKG_CONFIG_PATH="$prefix/lib/pkgconfig" pkg-config --define-variable=prefix=/placed "$question" feti_contact | sed 's/ *$//'
      done
    } >"$work/$way.facts"
done
diff "$work/make.facts" "$work/cargo.facts" || { echo "make install (<) and cargo cinstall (>) differ"; exit 1; }

prefix=$work/by_cargo/usr
pkg() { PKG_CONFIG_PATH="$prefix/lib/pkgconfig" pkg-config --define-variable=prefix="$prefix" "$@" feti_contact; }
cp "$root"/tests/packaging/host.* "$work"
cd "$work"
cc $(pkg --cflags) host.c -o host_c $(pkg --libs) "-Wl,-rpath,$prefix/lib"
cc $(pkg --cflags) host.c -o host_static "$prefix/lib/libfeti_contact.a" $(pkg --static --libs | sed 's/-lfeti_contact//')
sh "$root/tests/packaging/same.sh" host.expected ./host_c ./host_static
