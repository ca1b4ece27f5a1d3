#!/bin/sh
# assets.sh ROOT WORK: what c/Cargo.toml has cargo-c install below share is what make install puts there, but the page of the program.
set -eu
cd "$1"
mkdir -p "$2"
sed -n 's/^ *{ from = "\.\.\/\([^"]*\)", to = "\([^"]*\)" },$/\1 \2/p' c/Cargo.toml | while read -r from to; do
    for file in $from; do [ ! -f "$file" ] || echo "/usr/share/$to/${file##*/}"; done
done | sort >"$2/cargo.files"
env PREFIX=/usr DESTDIR= LIBDIR= INCLUDEDIR= DATADIR= DOCDIR= MANDIR= RELEASE=. tools/install.sh list |
    grep '^/usr/share/' | grep -v '/man/man1/' | sort >"$2/make.files"
[ -s "$2/make.files" ] && diff "$2/make.files" "$2/cargo.files"
