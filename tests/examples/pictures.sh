#!/bin/sh
# pictures.sh FOLDER PYTHON: meshio, which is put into the folder PYTHON once, reads every VTK file below FOLDER (pictures.py); every
# SVG file is closed and has finite numbers, axes with units and a legend.
set -eu
version=5.3.5
here=$(dirname "$0")
[ -f "$2/$version" ] || {
    python3 -m venv --clear "$2"
    "$2/bin/pip" install --quiet --disable-pip-version-check "meshio==$version"
    touch "$2/$version"
}
list=$1/list
find "$1" -name '*.svg' | sort >"$list"
[ "$(wc -l <"$list")" -ge 12 ] || { echo "pictures are missing:"; cat "$list"; exit 1; }
while read -r picture; do
    case $picture in
    */hertz_pressure* | */hertz_by_*) set -- "$1" "$2" 'pressure / MPa' 'x / mm' 'Hertz' ;;
    */hertz_convergence*) set -- "$1" "$2" 'log10(residual / limit)' 'step' 'limit' ;;
    */cattaneo_mindlin_shear*) set -- "$1" "$2" 'shear / (mu p0)' 'x / mm' 'Cattaneo, Mindlin' ;;
    */cattaneo_mindlin_loop*) set -- "$1" "$2" 'push / (mu P)' 'shift / um' 'Cattaneo, Mindlin' ;;
    *) echo "$picture is not expected"; exit 1 ;;
    esac
    for part in "$3" "$4" "$5" '<svg ' '</svg>' '<polyline' '<circle'; do
        grep -q "$part" "$picture" || { echo "$picture lacks $part"; exit 1; }
    done
    ! grep -qi '[ "=,-]nan\|[ "=,-]inf[^a-z]' "$picture" || { echo "$picture has numbers that are not finite"; exit 1; }
done <"$list"
"$2/bin/python" "$here/pictures.py" "$1"
