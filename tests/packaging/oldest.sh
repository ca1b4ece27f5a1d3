#!/bin/sh
# oldest.sh ROOT WORK: the oldest Rust that Cargo.toml names compiles the library without a warning, and a host prints what is right.
# The compiler is that of rustup or of the system where it has this version, else that of Debian's package rustc-web, unpacked into
# WORK. Without one of them the script says so and ends with 77.
set -eu
root=$1 work=$2
version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' "$root/Cargo.toml")
mkdir -p "$work"
cd "$work"
# is COMMAND...: a rustc of the version.
is() { "$@" --version 2>/dev/null | grep -q "^rustc $version\."; }

# unpacked: Debian's packages of the compiler; the library of LLVM that they want comes by tools/setup.sh.
unpacked() {
    full=$(apt-cache madison rustc-web | sed -n "s/.*| *\($version\.[^ ]*\) *|.*/\1/p" | head -n 1)
    [ -n "$full" ] || return 1
    "$root/tools/setup.sh" "$(apt-cache show "libstd-rust-web-$version" | sed -n 's/.*\(libllvm[0-9]*\).*/\1/p' | head -n 1)"
    apt-get download "rustc-web=$full" "libstd-rust-web-dev=$full" "libstd-rust-web-$version=$full" &&
        for package in *.deb; do dpkg-deb -x "$package" debian; done
    rm -f ./*.deb
}

if is rustup run "$version" rustc; then RUSTC=$(rustup which --toolchain "$version" rustc)
elif is /usr/bin/rustc; then RUSTC=/usr/bin/rustc
else
    RUSTC=$work/debian/usr/bin/rustc
    export LD_LIBRARY_PATH="$work/debian/usr/lib/$(uname -m)-linux-gnu"
    is "$RUSTC" || { unpacked >log 2>&1 && is "$RUSTC"; } || { cat log; echo "no Rust $version here"; exit 77; }
fi
"$RUSTC" --version
# Optimisation is left out: it is the language that counts.
export RUSTC CARGO_TARGET_DIR="$work/target" RUSTFLAGS="--deny warnings"
export CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_DEBUG=0 CARGO_PROFILE_RELEASE_INCREMENTAL=false
make -C "$root" --no-print-directory install PREFIX="$work/installed" DESTDIR= RELEASE="$work/target/release" >/dev/null
cc -I installed/include "$root/tests/packaging/host.c" -o host -Linstalled/lib -lfeti_contact "-Wl,-rpath,$work/installed/lib"
sh "$root/tests/packaging/same.sh" "$root/tests/packaging/host.expected" ./host
rm -rf "$work/target"
