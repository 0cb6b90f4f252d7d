#!/bin/sh
# Instructions of one Newton system and where they go, counted by callgrind:  count_path.sh PROGRAM [DEVICE_OUTPUT]
# PROGRAM is count_path.c without AVX-512, which valgrind does not know; DEVICE_OUTPUT what the demonstration's
# nonlinear image printed under QEMU. The judging tangent at the end of a load step counts as a system. Valgrind would
# count a memset by rep stosb as one instruction a byte, so glibc is told not to use it.
set -u
command -v valgrind >/dev/null || { echo 'no valgrind: no instructions counted'; exit 0; }
out=$1.callgrind
export GLIBC_TUNABLES=glibc.cpu.x86_rep_stosb_threshold=1000000000

# row SCENE ELEMENTS1 ELEMENTS2: the edges of the call graph hold what each function cost its callers
row() {
    found=$(valgrind -q --tool=callgrind --callgrind-out-file="$out" --compress-strings=no --compress-pos=no \
        --collect-atstart=no --toggle-collect=pzs_equilibrium "$program" "$@") || { echo "count_path.sh: $* failed"; exit 1; }
    awk -v scene="$1 $2x$3" -v found="$found" '
        /^fn=/ { from = substr($0, 4) }
        /^cfn=/ { to = substr($0, 5) }
        /^calls=/ { split($1, n, "="); calls[to] += n[2]; getline; cost[to] += $2; edge[from " " to] += $2 }
        END {
            split(found, word, " ")
            systems = calls["shell_system"] / word[4]
            all = cost["pzs_equilibrium"] / systems
            own["element systems"] = cost["shell_system"]
            own["added to the envelope"] = cost["model_add_matrix"]
            own["cleared and scaled"] = cost["linalg_clear"] + cost["linalg_apply_scale"]
            own["factor"] = cost["linalg_factor"]
            own["solve"] = cost["model_backsolve"]
            own["resultants extrapolated"] = cost["shell_resultants"] - edge["shell_system shell_resultants"]
            printf "%s, %d unknowns: one element system %d, one Newton system %d instructions;", scene, word[6],
                   cost["shell_system"] / calls["shell_system"], all
            count = split("element systems,added to the envelope,cleared and scaled,factor,solve,resultants extrapolated", name, ",")
            for (i = 1; i <= count; i++) {
                printf " %s %.1f %%,", name[i], 100 * own[name[i]] / systems / all
                rest += own[name[i]]
            }
            printf " rest %.1f %%\n", 100 - 100 * rest / systems / all
        }' "$out"
}

program=$1
row hemisphere 16 16
row annular-plate 10 40
[ $# -lt 2 ] || sed -n 's/^cost equilibrium loads.* system=\([0-9]*\).*/hemisphere 4x4 on a Cortex-M7 under QEMU, double: one Newton system \1 instructions/p' "$2"
