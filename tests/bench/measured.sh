#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The rows of tests/bench/README.md that take seconds, from the program itself.
#   measured.sh           print the rows
#   measured.sh --write   put them into the README, between its markers (make measured)
#   measured.sh --check   TAP: the README holds what the program prints
# Figures are cut to four digits, so that rounding on another machine does not show.
set -u
cd "$(dirname "$0")/../.."
B=${B:-build}
PZS=${PZS:-$B/pzs}
readme=tests/bench/README.md
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

# run ARGUMENTS: output in $dir/out; a failure ends the script, so that no row is made of nothing.
run() {
    "$PZS" "$@" >"$dir/out" 2>"$dir/err" || { echo "measured.sh: pzs $* failed: $(cat "$dir/err")" >&2; exit 1; }
    command="build/pzs $*"
}

# row WHAT REACHED: a line of the table; every part of REACHED has to be there.
row() {
    case $2 in
    *'?'*|'') echo "measured.sh: no figure for: $1 ($2)" >&2; exit 1 ;;
    esac
    echo "| $1 | $2 | \`$command\` |"
}

# digits NUMBER: with four digits, or ? where there is none
digits() {
    [ -n "${1:-}" ] && printf '%.4g' "$1" || printf '?'
}

# error NAME [LINE]: relative RMS error in % of a row of the table of voltages
error() {
    digits "$(sed -n "s/^ *$1  .* \([0-9.]*\)% .*/\1/p" "$dir/out" | sed -n "${2:-1}p")"
}

# mode NAME COLUMN: a percentage of a row of the table of modes
mode() {
    digits "$(grep "^ *$1 " "$dir/out" | grep -o '[0-9.]*%' | sed -n "$2p" | tr -d %)"
}

# phase TICK COLUMN: a percentage of a row of the table of phases
phase() {
    digits "$(grep "^ *$1 " "$dir/out" | sed 's/[0-9]*% of the sensors//' | grep -o '[0-9.]*%' | sed -n "$2p" | tr -d %)"
}

# found EXPRESSION: the group of a basic regular expression that a line of the output begins with
found() {
    text=$(sed -n "s/^$1.*/\1/p" "$dir/out" | head -n 1)
    echo "${text:-?}"
}

rows() {
    run shape plate-50-patches --limit 200
    row "plate with 25 pairs of patches within 200 V, relative RMS error" "optimum $(error 'optimum within limits') %, clipped least squares $(error 'clipped least squares') %, regularised with the best parameter, then clipped $(error 'regularised, then clipped') %"
    run shape plate-50-patches --limit 500
    row "the same within 500 V, where limits hardly matter" "$(error 'optimum within limits') %, $(error 'clipped least squares') %, $(error 'regularised, then clipped') %"
    run shape plate-50-patches --set kinematics=nonlinear
    row "the same plate with large rotation, within 600 V" "voltages of the linear model $(error 'linear optimum in limits') %, relinearised at the shape reached $(error 'optimum within limits') %"
    run shape mirror
    row "deformable mirror, 80 patches within 50 V: coma, spherical" "optimum $(mode 'Z7 coma y' 2) % and $(mode 'Z11 spherical' 2) %, clipped least squares $(mode 'Z7 coma y' 3) % and $(mode 'Z11 spherical' 3) %, regularised with the best parameter of each $(mode 'Z7 coma y' 4) % and $(mode 'Z11 spherical' 4) %"
    run solve hemisphere
    row "hemisphere under four forces, 16 x 16, published element" "$(found ' *\([0-9]*\) load step') load step, $(found '.* \([0-9]*\) linear ') linear solves, displacement $(found ' *A .* ratio \([0-9.]*\)') of the published one"
    run solve torus-contact
    row "inflated torus on a drum, stable equilibrium" "$(found ' *\([0-9]*\) load step') load step, $(found '.* \([0-9]*\) linear ') linear solves, $(found '.*(\([0-9]*\) negative pivots)') negative pivots"
    run solve scordelis-lo
    row "Scordelis-Lo roof, published element" "displacement $(found '.* ratio \([0-9.]*\)') of the reference"
    run modes plate-50-patches --number 1
    row "first natural frequency of the plate with 25 pairs" "$(found ' *1  *\([0-9.]*\) ') Hz"
    run check plate-50-patches
    row "control image of the plate with 25 pairs, float" "$(found ' *control  *\([0-9.]*\) ') KB of tables, $(found ' *control  *[0-9.]*  *[0-9.]*  *\([0-9.]*\) ') KB of RAM; without a vibration model stable up to $(found '.*rate up to \([0-9.]*\)') ticks a second"
    run check plate-closed-loop
    row "certificate of the damped tick, plate with 25 pairs, 1000 ticks a second" "$(found ' *\([0-9]* of [0-9]*\) storms settle') storms settle, also with readings $(found '.*with readings \([0-9]*\) tick') tick older; gain x $(found ' *Margins of the growth: gain x \([0-9.]*\)'), frequencies x $(found '.*frequencies x \([0-9.]*\)') to x $(found '.*frequencies x [0-9.]* to x \([0-9.]*[0-9]\)')"
    run simulate plate-closed-loop --set 'simulate.events=[]' --set simulate.ticks=300
    row "closed loop, plant with inertia: nonlinear, 10 % stiffer and 20 % weaker than the model, hysteresis 10 %, noise" "steady error $(phase 0 2) % where the optimum of that plant is $(phase 0 1) %, vibration $(phase 0 3) %"
    run simulate plate-closed-loop --set 'simulate.events=[]' --set simulate.ticks=300 --set simulate.plant.inertia=false --set simulate.plant.hysteresis=0
    row "the same, quasi-static plant without hysteresis" "steady error $(phase 0 2) % where the optimum of that plant is $(phase 0 1) %; clipped least squares $(phase 0 4) %, regularised with the best parameter $(phase 0 5) %"
}

rows >"$dir/rows" || exit 1
case ${1:-} in
--write)
    awk -v rows="$dir/rows" '
        /<!-- \/measured -->/ {skip = 0}
        !skip {print}
        /<!-- measured -->/ {
            print "| what | reached | command |\n|---|---|---|"
            while ((getline line <rows) > 0) print line
            skip = 1
        }' "$readme" >"$dir/new" && cat "$dir/new" >"$readme" ;;
--check)
    sed -n '/<!-- measured -->/,/<!-- \/measured -->/p' "$readme" | grep '`build/' >"$dir/told"
    n=0
    failed=0
    while IFS= read -r line; do
        n=$((n + 1))
        if grep -qxF -- "$line" "$dir/told"; then
            echo "ok $n - $line"
        else
            failed=1
            echo "not ok $n - the README has not (else: make measured): $line"
        fi
    done <"$dir/rows"
    n=$((n + 1))
    if [ "$(wc -l <"$dir/told")" -eq "$(wc -l <"$dir/rows")" ]; then
        echo "ok $n - as many rows"
    else
        failed=1
        echo "not ok $n - as many rows"
    fi
    echo "1..$n"
    exit "$failed" ;;
*) cat "$dir/rows" ;;
esac
