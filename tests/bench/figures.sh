#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Load-displacement curves of the dissertation's figures: for each a table FIGURE.csv and, but for figure 13c, a picture
# FIGURE.html; TAP lines with the end of each curve and its reference. A curve fails that does not reach the full load, or
# ends more than 2 % from the reference that its scene states.
#   usage: figures.sh [FOLDER [FIGURE ...]]     folder of the tables, default build/figures; figures, default all
#   PZS, B  the program, default B/pzs; folder of the build, default build
set -u
cd "$(dirname "$0")/../.."
PZS=${PZS:-${B:-build}/pzs}
folder=${1:-${B:-build}/figures}
[ $# -eq 0 ] || shift
wanted=${*:-4c 5b 8c 8c-soft 10b 11b 12b 13b 13c}
failed=0 number=0
mkdir -p "$folder" || exit 1

# tap WORD FIGURE TEXT: ok or not ok
tap() {
    number=$((number + 1))
    echo "$1 $number - figure $2: $3"
    [ "$1" = ok ] || failed=1
}

# draw_path FIGURE SCENE: follow the load path of a scene to its full load.
draw_path() {
    table=$folder/$1.csv said=$folder/$1.txt
    if ! "$PZS" solve "$2" --path --csv-dir "$folder/$1" --report "$folder/$1.html" >"$said" 2>&1; then
        tap 'not ok' "$1" "$(tail -1 "$said")"
        return
    fi
    mv "$folder/$1/path.csv" "$table" && rm -r "${folder:?}/$1"
    if [ "$(tail -1 "$table" | cut -d, -f1)" != 1 ]; then
        tap 'not ok' "$1" 'the curve ends before the full load'
    elif ! awk '/, ratio [0-9]/ && ($NF < 0.98 || $NF > 1.02) {bad = 1} END {exit bad}' "$said"; then
        tap 'not ok' "$1" 'the end is more than 2 % from its reference'
    else
        tap ok "$1" "scene $2, $(($(grep -c . "$table") - 1)) points in $table"
    fi
    sed -n 's/^  \(.*, ratio .*\)/# \1/p' "$said"
}

# draw_voltages FIGURE: displacements of the forced hyperboloid against the voltage of its patches, one equilibrium for each.
draw_voltages() {
    scene=hyperboloid-patches table=$folder/$1.csv said=$folder/$1.txt
    echo 'voltage (V),A (cm),B (cm),C (cm),D (cm)' >"$table"
    for voltage in 0 245 490 735 980 1225 1470 1715 1960; do
        if ! "$PZS" solve "$scene" --set "actuators.v.applied=[$voltage, -$voltage]" >"$said" 2>&1; then
            tap 'not ok' "$1" "$voltage V: $(tail -1 "$said")"
            return
        fi
        awk -v voltage="$voltage" '/^  [ABCD]  / {line = line "," $2} END {print voltage line}' "$said" >>"$table"
    done
    tap ok "$1" "scene $scene, $(($(grep -c . "$table") - 1)) points in $table"
    sed -n '2p;$s/^/# /p' "$table" | sed 's/^\([^#]\)/# \1/'
}

for figure in $wanted; do
    case $figure in
    4c) draw_path 4c hemisphere ;;
    5b) draw_path 5b annular-plate ;;
    8c) draw_path 8c hyperboloid ;;
    8c-soft) draw_path 8c-soft hyperboloid-soft ;;
    10b) draw_path 10b torus-pressure ;;
    11b) draw_path 11b torus-contact ;;
    12b) draw_path 12b tyre-section ;;
    13b) draw_path 13b hyperboloid-patches ;;
    13c) draw_voltages 13c ;;
    *) tap 'not ok' "$figure" 'no such figure; known: 4c 5b 8c 8c-soft 10b 11b 12b 13b 13c' ;;
    esac
done
exit $failed
