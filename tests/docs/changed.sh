#!/bin/sh
# changed.sh DOCUMENT LANGUAGE EDIT...: the first code block of that language, changed by one command of sed -E after the other; exit
# status 1 if a command changes nothing.
set -eu
document=$1
block=$(awk -v language="$2" -v which=1 -f "$(dirname "$0")/block.awk" "$1")
shift 2
for edit in "$@"; do
    before=$block
    block=$(printf '%s\n' "$before" | sed -E "$edit")
    [ "$block" != "$before" ] || { echo "$document: nothing to change by $edit" >&2; exit 1; }
done
printf '%s\n' "$block"
