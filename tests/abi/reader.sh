#!/bin/sh
# reader.sh DOCS FILE: the reader in docs/file_format.md, which is no part of the library, finds the sections of the file.
set -eu
sections=$(sed -n '/^```python/,/^```$/p' "$1" | sed '1d;$d' | python3 - "$2" | cut -d ' ' -f 1 | tr '\n' ' ')
[ "$sections" = "OPTS BODY STIF NULL BODY STIF NULL COOR FIXD LOAD ROWS ROWS " ] || { echo "found: $sections"; exit 1; }
