#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The .geo files beside the scenes make meshes that the scenes accept, in every format that Gmsh writes and pzs reads,
# and the committed meshes are of these files. Without Gmsh the committed meshes are tested alone.
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh

# elements SCENE: number of elements and nodes that check prints
elements() {
    "$PZS" check "$1" 2>&1 | tee "$dir/said" | sed -n 's/^  \([0-9]*\) elements from .*, \([0-9]*\) nodes.*/\1 \2/p'
}

for geo in host_tools/scenes/*.geo; do
    name=$(basename "$geo" .geo)
    committed=$(elements "host_tools/scenes/$name.yaml")
    [ -n "$committed" ]; check "$name: the committed mesh: $committed elements, nodes" $?
    if ! command -v gmsh >/dev/null 2>&1; then
        n=$((n + 1))
        echo "ok $n - $name: made by Gmsh # SKIP no gmsh"
        continue
    fi
    for form in msh41 'msh41 -bin' 'msh22' 'msh22 -bin' inp; do
        [ "$name" = wing-panel ] || [ "$form" = msh41 ] || continue # every format once
        file=$name.msh
        cp "host_tools/scenes/$name.yaml" "$dir/$name.yaml"
        # shellcheck disable=SC2086
        gmsh -2 "$geo" -format $form -o "$dir/$file" >"$dir/said" 2>&1
        now=$(elements "$dir/$name.yaml")
        [ "${now%% *}" = "${committed%% *}" ]; check "$name from gmsh -format $form: $now elements, nodes" $?
    done
done
echo "1..$n"
