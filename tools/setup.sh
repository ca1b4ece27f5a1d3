#!/bin/sh
# Installs what the examples and tests need beside Rust, gcc and GNU make, and the packages named as arguments.
# Does nothing when all is there.
set -eu
packages="gfortran cmake libsuitesparse-dev libopenblas-dev valgrind pkg-config abigail-tools python3-venv $*"

missing=
for package in $packages; do
    case $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true) in
        installed) ;;
        *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then as_root=env
elif command -v sudo >/dev/null 2>&1; then as_root="sudo env"
else
    echo "Missing packages:$missing. Neither root nor sudo here; run as root:" >&2
    echo "apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages" >&2
    exit 1
fi
$as_root apt-get update
# shellcheck disable=SC2086 # one word per package
$as_root DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages
