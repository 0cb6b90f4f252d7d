#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Instructions of one Newton system and where they go, counted by callgrind:  count_path.sh PROGRAM [DEVICE_OUTPUT]
# PROGRAM is run_path.c without AVX-512, which valgrind does not know; DEVICE_OUTPUT what the demonstration's
# nonlinear image printed under QEMU. The judging tangent at the end of a load step counts as a system. Valgrind would
# count a memset by rep stosb as one instruction a byte, so glibc is told not to use it.
set -u
command -v valgrind >/dev/null || { echo 'no valgrind: no instructions counted'; exit 0; }
program=$1
out=$1.callgrind
export GLIBC_TUNABLES=glibc.cpu.x86_rep_stosb_threshold=1000000000

# count WHAT OPTIONS: runs the program on "$scene" $settings and shows the costs. The edges of the call graph hold what each
# function cost its callers. WHAT is system, or process for all of it.
count() {
    # shellcheck disable=SC2086
    found=$(valgrind -q --tool=callgrind --callgrind-out-file="$out" --compress-strings=no --compress-pos=no $2 \
        "$program" "$scene" $settings) || { echo "count_path.sh: $scene $settings failed"; exit 1; }
    awk -v what="$1" -v scene="$title" -v found="$found" '
        function show(part, cost_of_part) { text = text sprintf(" %s %.1f %%,", part, 100 * cost_of_part / all); rest += cost_of_part }
        /^fn=/ { from = substr($0, 4) }
        /^cfn=/ { to = substr($0, 5) }
        /^calls=/ { split($1, n, "="); calls[to] += n[2]; getline; cost[to] += $2; edge[from " " to] += $2 }
        END {
            split(found, word, " ")
            if (what == "process") {
                all = cost["main"]
                show("scene read", cost["scene_read"])
                show("stiffness of the kinds at rest", cost["shell_stiffness"])
                show("checksums", cost["guard_structure_crc"])
                show("rest of mesh and tables", cost["design_build"] - cost["shell_stiffness"] - edge["design_build guard_structure_crc"])
                show("equilibrium", cost["pzs_equilibrium"])
                printf "%s, the whole process: %d instructions;", scene, all
            } else {
                all = cost["pzs_equilibrium"]
                systems = calls["shell_system"] / word[2]
                show("element systems", cost["shell_system"])
                show("added to the envelope", cost["model_add_matrix"])
                show("cleared and scaled", cost["linalg_clear"] + cost["linalg_apply_scale"])
                show("factor", cost["linalg_factor"])
                show("solve", cost["model_backsolve"])
                show("resultants extrapolated", cost["shell_resultants"] - edge["shell_system shell_resultants"])
                printf "%s, %d unknowns: one element system %d, one Newton system %d instructions;", scene, word[4],
                       cost["shell_system"] / calls["shell_system"], all / systems
            }
            printf "%s rest %.1f %%\n", text, 100 - 100 * rest / all
        }' "$out"
}

# row SCENE ELEMENT ELEMENTS1 ELEMENTS2 [path=value ...]
row() {
    scene=$1 title="$1 $3x$4 $2"
    settings="element=$2 mesh.theta1.elements=$3 mesh.theta2.elements=$4"
    shift 4
    settings="$settings $*"
    count system '--collect-atstart=no --toggle-collect=pzs_equilibrium'
}

row hemisphere published 16 16
echo 'The meshes that reach 2 % and .5 % of the converged answer first'
row hemisphere improved 12 8
row annular-plate improved 2 16
row hemisphere improved 16 10
count process ''
row annular-plate improved 5 18 mesh.theta1.centre=1.4 mesh.theta2.grading=4
count process ''
[ $# -lt 2 ] || sed -n 's/^cost equilibrium loads.* system=\([0-9]*\).*/hemisphere 4x4 on a Cortex-M7 under QEMU, double: one Newton system \1 instructions/p' "$2"
