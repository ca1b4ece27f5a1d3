#!/bin/sh
# offline.sh ROOT WORK [ARCHIVE]: a copy of the tree with the crates that cargo vendor has put into it, or an archive of make release, is
# built and installed without network and without what cargo has stored before, for a target that CARGO_BUILD_TARGET names; a host
# prints what is right, and the library has the version of ROOT. Optimisation is left out: it is the way that counts.
set -eu
root=$1 work=$2
rm -rf "$work"
mkdir -p "$work/home" "$work/tree"
if [ $# -gt 2 ]; then tar -xzf "$3" -C "$work/tree" --strip-components=1
else "$root/tools/vendored.sh" "$work/tree"
fi
cd "$work/tree"
# A network of its own, with nothing in it, where the system lets us have one.
alone=
! unshare -n true 2>/dev/null || alone="unshare -n"
export CARGO_HOME="$work/home" CARGO_TARGET_DIR="$work/target" CARGO_NET_OFFLINE=true
CARGO_BUILD_TARGET=$(rustc -vV | sed -n 's/^host: //p')
export CARGO_BUILD_TARGET CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_DEBUG=0 CARGO_PROFILE_RELEASE_INCREMENTAL=false
$alone make --no-print-directory install PREFIX="$work/installed" >/dev/null
cd "$work"
cc -I installed/include tree/tests/packaging/host.c -o host -Linstalled/lib -lfeti_contact "-Wl,-rpath,$work/installed/lib"
sh tree/tests/packaging/same.sh tree/tests/packaging/host.expected ./host
echo 'extern int puts(const char *); int main(void) { return puts(feti_version()) < 0; }' |
    cc -x c -include feti_contact.h -I installed/include - -o version -Linstalled/lib -lfeti_contact "-Wl,-rpath,$work/installed/lib"
grep -qx "version = \"$(./version)\"" "$root/Cargo.toml"
rm -rf "$work/target" "$work/tree"
