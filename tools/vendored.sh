#!/bin/sh
# vendored.sh TREE: copies this tree, as git has it or would take it, to TREE and puts the sources of all crates into it, so that cargo
# needs no network there.
set -eu
cd "$(dirname "$0")/.."
tree=$1
mkdir -p "$tree/.cargo"
git ls-files --cached --others --exclude-standard -z | xargs -0 sh -c 'for f; do [ ! -f "$f" ] || printf "%s\0" "$f"; done' sh |
    xargs -0 cp --parents -t "$tree"
cd "$tree"
cargo vendor --locked vendor >.cargo/config.toml 2>"$tree.log" || { cat "$tree.log" >&2; exit 1; }
