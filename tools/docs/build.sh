#!/bin/bash
# tools/docs/build.sh TOOLS PROFILE TARGET: the documents in build/docs, with mdbook and ford of the folder TOOLS and cargo's profile and
# target folder, checked page by page; prints the seconds of each part and of all.
set -euo pipefail
tools=$1 profile=$2 target=$3 docs=build/docs cargo=${CARGO:-cargo}

part() {
    local began=$SECONDS
    "$1"
    echo "docs: $1 $((SECONDS - began)) s"
}

to() { # a page that leads to another one
    echo "<meta http-equiv=\"refresh\" content=\"0; url=$2\">" > "$docs/$1"
}

reference() {
    rm -rf $docs
    "$cargo" run --profile "$profile" --locked --quiet -p feti-bindgen -- --pages $docs/reference
    "$cargo" run --profile "$profile" --locked --quiet -p feti-reference -- $docs/reference
    mv $docs/reference/man $docs/man
    install -D -m 644 program/feti-contact.1 $docs/man/man1/feti-contact.1
}

book() {
    python3 tools/docs/stage.py $docs/reference $docs/source
    cp docs/book/book.toml docs/book/book.css docs/book/search.js $docs
    "$tools/bin/mdbook" build $docs
    to index.html book/start.html
}

fortran() {
    python3 tools/docs/fortran.py sources $docs/fortran_sources
    "$tools/ford/bin/ford" --quiet docs/book/ford.md
    python3 tools/docs/fortran.py pages $docs/fortran
}

rust() {
    RUSTDOCFLAGS='-D warnings' "$cargo" doc --no-deps --locked --quiet
    cp -R "$target/doc" $docs/rust
    to rust/index.html feti_contact/index.html
}

names() {
    python3 tools/docs/names.py $docs
}

links() {
    python3 tools/docs/check_links.py markdown .
    python3 tools/docs/check_links.py html $docs
    ! grep -rlE '\|---|<em>[^<]*[|+^=()]' --include='*.html' $docs/book # a table that is none, emphasis in a formula
}

browser() {
    tools/setup.sh chromium
    python3 tests/docs/browser.py chromium
    python3 tests/docs/search.py $docs chromium
    python3 tools/docs/browser.py $docs chromium
}

for name in reference book fortran rust names links browser; do part "$name"; done
echo "docs: all $SECONDS s"
