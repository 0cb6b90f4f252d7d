#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The .geo files beside the scenes make meshes that the scenes accept, in every format that Gmsh writes and pzs reads,
# and the committed meshes are of these files. A wing skin, a dish and a box beam are solved and shaped, and their tables
# made, on such meshes. Without Gmsh the committed meshes are tested alone.
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh

# elements SCENE: number of elements and nodes that check prints
elements() {
    "$PZS" check "$1" 2>&1 | tee "$dir/said" | sed -n 's/^  \([0-9]*\) elements from .*, \([0-9]*\) nodes.*/\1 \2/p'
}

rigs=tests/rigs/scenes
for geo in host_tools/scenes/*.geo $rigs/*.geo; do
    name=$(basename "$geo" .geo)
    source=${geo%/*}
    committed=$(elements "$source/$name.yaml")
    [ -n "$committed" ]; check "$name: the committed mesh: $committed elements, nodes" $?
    cp "$source/$name.yaml" "$source/$name.msh" "$dir"
    if ! command -v gmsh >/dev/null 2>&1; then
        n=$((n + 1))
        echo "ok $n - $name: made by Gmsh # SKIP no gmsh"
        continue
    fi
    for form in 'msh41 -bin' 'msh22' 'msh22 -bin' inp msh41; do
        [ "$name" = wing-panel ] || [ "$form" = msh41 ] || continue # every format once
        # shellcheck disable=SC2086
        gmsh -2 "$geo" -format $form -o "$dir/$name.msh" >"$dir/said" 2>&1
        now=$(elements "$dir/$name.yaml")
        [ "${now%% *}" = "${committed%% *}" ]; check "$name from gmsh -format $form: $now elements, nodes" $?
    done
done

# number KEY: a number of the JSON that $dir/said holds
number() { sed -n "s/^  \"$1\": \([^,]*\),\{0,1\}$/\1/p" "$dir/said"; }

# on_mesh SCENE ACTUATORS: the scene is solved; the optimal voltages of its ACTUATORS meet their optimality conditions to
# rounding and leave no more than clipped ones, which leave less than none; and its tables have as many inputs
on_mesh() {
    cp "$rigs/$1.yaml" "$dir/$1.yaml"
    "$PZS" solve "$dir/$1.yaml" >"$dir/said" 2>&1; check "$1: solve" $?
    "$PZS" shape "$dir/$1.yaml" --json >"$dir/said" 2>&1
    error=$(number shape_error)
    [ "$(number amplifiers)" = "$2" ]; check "$1: $2 actuators" $?
    echo "$(number kkt) ${error:-1} $(number clipped_error) $(number shape_error_before)" |
        awk '{ exit !(NF == 4 && $1 < 1e-12 && $2 - $3 < 1e-12 && $3 < $4) }'
    check "$1: shape error $error" $?
    "$PZS" tables "$dir/$1.yaml" --quasi-static --prefix rig -o "$dir/rig.h" >"$dir/said" 2>&1 &&
        grep -q "^#define RIG_INPUTS $2$" "$dir/rig.h"
    check "$1: tables" $?
}
on_mesh wing-skin 8
on_mesh dish 19
on_mesh box-beam-patches 4
echo "1..$n"
