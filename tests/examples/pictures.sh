#!/bin/sh
# pictures.sh FOLDER: every VTK file below the folder is complete (as many points, cells, types and vectors as announced,
# corners within the points, finite numbers), every SVG file is closed and has finite numbers, axes with units and a legend.
set -eu
list=$1/list
find "$1" -name '*.vtk' -o -name '*.svg' | sort >"$list"
[ "$(grep -c 'vtk$' "$1/list")" -ge 2 ] && [ "$(grep -c 'svg$' "$1/list")" -ge 3 ] || { echo "pictures are missing:"; cat "$1/list"; exit 1; }
while read -r picture; do
    case $picture in
    *.vtk) awk '
        function want(what, found, expected) { if (found != expected) { print FILENAME ": " found " " what ", expected " expected; bad = 1 } }
        function finish() { if (part == "POINTS") want("points", lines, points); if (part == "CELLS") { want("cells", lines, cells); want("numbers", numbers, announced) }
            if (part == "CELL_TYPES") want("cell types", lines, cells); if (part == "VECTORS") { want("vectors", lines, points); vectors++ } ; lines = 0; part = "" }
        FNR == 1 && !/^# vtk DataFile Version 3.0$/ { print FILENAME ": no VTK header"; bad = 1 }
        /nan|NaN|inf|Inf/ { print FILENAME ": line " FNR " is not finite"; bad = 1 }
        /^POINTS/ { finish(); part = $1; points = $2; next }
        /^CELLS/ { finish(); part = $1; cells = $2; announced = $3; next }
        /^CELL_TYPES/ { finish(); part = $1; next }
        /^VECTORS/ { finish(); part = $1; next }
        /^[A-Z]/ { finish(); next }
        part != "" { lines++ }
        part == "CELLS" { numbers += NF; for (k = 2; k <= NF; k++) if ($k < 0 || $k >= points) bad = 1; if (NF != $1 + 1) bad = 1 }
        END { finish(); want("vector fields", vectors, 2); exit bad || points < 1 || cells < 1 }' "$picture" || { echo "$picture"; exit 1; } ;;
    *.svg) case $picture in
           */hertz*) set -- 'pressure / MPa' 'x / mm' 'Hertz' ;;
           */cattaneo_mindlin_shear*) set -- 'shear / (mu p0)' 'x / mm' 'Cattaneo, Mindlin' ;;
           */cattaneo_mindlin_loop*) set -- 'push / (mu P)' 'shift / um' 'Cattaneo, Mindlin' ;;
           *) echo "$picture is not expected"; exit 1 ;;
           esac
           for part in "$@" '<svg ' '</svg>' '<polyline' '<circle'; do
               grep -q "$part" "$picture" || { echo "$picture lacks $part"; exit 1; }
           done
           ! grep -qi '[ "=,-]nan\|[ "=,-]inf[^a-z]' "$picture" || { echo "$picture has numbers that are not finite"; exit 1; } ;;
    esac
done <"$list"
