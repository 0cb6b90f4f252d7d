#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# A nonlinear image's header, compiled on the host, finds the equilibrium that `pzs` found, bit for bit: dead loads,
# actuation, follower loads, contact and open electrodes. Where float cannot carry the scene the header does not compile in float.
#   B (build directory), PZS from the environment
: "${B:=build}"
: "${PZS:=$B/pzs}"
. tests/gates/common.sh

cat >"$scratch/program.c" <<'EOT'
#include <stdio.h>
#include <string.h>
#include "t.h"
static pzs_real model_work[T_MODEL_BYTES / sizeof(pzs_real) + 1], solver_work[T_SOLVER_BYTES / sizeof(pzs_real) + 1];
static pzs_real output[T_ALL_OUTPUTS];
#if T_FOLLOWERS > 0
static pzs_follower_load load[T_FOLLOWERS];
#endif
#ifdef T_CONTACT_BYTES
static pzs_real contact_work[T_CONTACT_BYTES / sizeof(pzs_real) + 1];
static pzs_contact contact;
#endif
#ifdef T_ELECTRODES
static pzs_real circuit_work[T_CIRCUIT_BYTES / sizeof(pzs_real) + 1];
static pzs_circuit circuit;
#endif

static pzs_status options(pzs_solver *solver)
{
    pzs_status status = PZS_OK;
#if T_FOLLOWERS > 0
    for (int k = 0; k < T_FOLLOWERS && status == PZS_OK; k++) status = pzs_attach_follower(solver, &load[k], &t_follower[k]);
#endif
#ifdef T_CONTACT_BYTES
    if (status == PZS_OK) status = pzs_attach_contact(solver, &contact, &t_contact_face, &t_body, contact_work, sizeof contact_work);
    contact.settings.stiffness = T_CONTACT_STIFFNESS;
#endif
#ifdef T_ELECTRODES
    if (status == PZS_OK) status = pzs_attach_circuit(solver, &circuit, &t_electrodes, circuit_work, sizeof circuit_work);
#endif
    (void)solver;
    return status;
}

int main(void)
{
    pzs_model model;
    pzs_solver solver;
    pzs_status status = pzs_model_init(&model, &t_structure, model_work, sizeof model_work);
    if (status == PZS_OK) status = pzs_solver_init(&solver, &model, &t_nonlinear, solver_work, sizeof solver_work);
    if (status == PZS_OK) status = options(&solver);
    if (status != PZS_OK) return printf("init: %s\n", pzs_status_text(status)), 1;
#ifdef ATTACH_ONLY
    return 0;
#endif
    solver.settings.load_steps = T_LOAD_STEPS;
    solver.settings.extrapolated_iterations = T_EXTRAPOLATED_ITERATIONS;
    solver.settings.ramp_solves = T_RAMP_SOLVES;
    solver.settings.tolerance = T_TOLERANCE;
    solver.settings.solve_limit = T_SOLVE_LIMIT;
    status = pzs_equilibrium(&solver, t_full_input);
    if (PZS_IS_ERROR(status)) return printf("equilibrium: %s\n", pzs_status_text(status)), 1;
    pzs_observe(&t_structure, solver.info.displacement, output);
    for (int i = 0; i < T_ALL_OUTPUTS; i++) printf("%.17g\n", (double)output[i]);
    return memcmp(output, t_reached, sizeof output) != 0;
}
EOT

# compile BITS [FLAG]
compile() {
    "$CC" -std=c99 -O1 -Iinclude -I"$scratch" -DPZS_NONLINEAR=1 -DPZS_REAL_BITS="$1" ${2:+"$2"} "$scratch/program.c" \
        "$B/$1/libpiezoshape.a" -lm -o "$scratch/program" 2>"$scratch/found"
}

# same NAME PZS_ARGUMENTS...
same() {
    name=$1
    shift
    "$PZS" tables "$@" --image nonlinear --prefix t -o "$scratch/t.h" >"$scratch/told" 2>"$scratch/found" && compile 64 &&
        "$scratch/program" >"$scratch/found"
    tap $? "$name: the equilibrium of pzs, bit for bit"
}

# attached ARRAY SCENE: an option's tables are accepted in both precisions, and refused with a number of ARRAY changed.
attached() {
    "$PZS" tables "$2" --image nonlinear --prefix t -o "$scratch/t.h" >"$scratch/told" 2>"$scratch/found" || return 1
    for bits in 64 32; do
        compile $bits -DATTACH_ONLY && "$scratch/program" >"$scratch/found" || return 1
    done
    sed "/ t_$1\\[/,/};/ s/PZS_R(\\([0-9]\\)/PZS_R(1\\1/" "$scratch/t.h" >"$scratch/damaged"
    mv "$scratch/damaged" "$scratch/t.h"
    for bits in 64 32; do
        compile $bits -DATTACH_ONLY || return 1
        "$scratch/program" >"$scratch/found"
        grep -q 'init: tables do not match their checksum' "$scratch/found" || return 1
    done
}

# Largest difference of the program's outputs from those of pzs solve, over the largest.
off_solved() {
    /usr/bin/python3 -c 'import json, sys
solved = [x for row in json.load(open(sys.argv[1]))["outputs"].values() for x in (row if isinstance(row, list) else [row])]
program = [float(x) for x in open(sys.argv[2])]
assert len(solved) == len(program) > 0
print(max(abs(a - b) for a, b in zip(program, solved)) / max(abs(x) for x in solved))' "$scratch/solved" "$scratch/found"
}

same 'dead loads' hemisphere --set mesh.theta1.elements=4 --set mesh.theta2.elements=4
"$PZS" solve hemisphere --set mesh.theta1.elements=4 --set mesh.theta2.elements=4 --json >"$scratch/solved"
off=$(off_solved)
[ "$off" = 0.0 ]
tap $? "dead loads: the numbers of pzs solve, off by $off"
# A thin shell multiplies the rounding of tables and sums by about L/h, here 250.
compile 32 && { "$scratch/program" >"$scratch/found"; off=$(off_solved); } && awk -v off="$off" 'BEGIN { exit !(off < 1000 * 2 ^ -23) }' &&
    grep -q 'float or double' "$scratch/told"
tap $? "dead loads in float: off by $off"
same 'actuation' roll-up
! compile 32 && grep -q 'the equilibrium solver needs double' "$scratch/found" && grep -q 'refused in float' "$scratch/told"
tap $? 'roll-up: above the rule, refused in float'
same 'loads that rise over two solves' hemisphere --set mesh.theta1.elements=4 --set mesh.theta2.elements=4 --set 'equilibrium={ramp_solves: 2}'
same 'loads that rise over as many solves as pzs finds' hyperboloid-soft --set mesh.theta1.elements=8 --set mesh.theta2.elements=8 --set equilibrium.load_steps=1
grep -q 'T_RAMP_SOLVES 8$' "$scratch/t.h"
tap $? 'the tables carry the number of solves over which loads rise'
same 'follower load' ring-follower
same 'contact' ring-contact
for table in 'follower_pressure_0 torus-pressure' 'contact_area torus-contact'; do
    # shellcheck disable=SC2086
    attached $table
    tap $? "$table: accepted in either precision, refused where damaged"
done
same 'compact element types, follower load, contact' wing-panel --quasi-static --compact --set kinematics=nonlinear --set 'loads=[{face: outer, pressure: 200,
    follower: pressure}]' --set 'contact={face: outer, body: {type: sphere, point: [0.36, 0.54, 0.4195], radius: 0.4}}'
grep -q 'NULL, NULL, t_compact_types, t_nodes' "$scratch/t.h"
tap $? 'compact tables hold no full element types'
same 'springs and stacks' tests/rigs/scenes/spring-plate.yaml --set kinematics=nonlinear --set 'springs=[{at: nodes, along: z, stiffness: 1e6, per: area},
    {at: nodes, along: [1, 1, 0], stiffness: 1e6, per: area}, {at: nodes, along: [1, -1, 0], stiffness: 1e6, per: area}]' --set 'actuators=[{name: s,
    stacks: {points: [[0.3, 0.3], [0.8, 0.1]], along: z, stiffness: 1e6, stroke: 1e-6}, applied: 50}]'
same 'oblique supports' tests/rigs/scenes/spring-plate.yaml --set kinematics=nonlinear --set 'loads=[{face: middle, z: 1e5}]' --set 'supports=[{edge:
    theta1-, fix: along, direction: [1, 2, 2]}, {edge: theta1+, fix: across, direction: [1, 0.3, -0.2]}, {at: {theta1: 0, theta2: 0},
    fix: flat}]'
same 'open electrodes' bimorph-sensor --set kinematics=nonlinear
same 'electrodes of any outline, one of them open' tests/rigs/scenes/outline-plate.yaml --set kinematics=nonlinear --set 'patches=[{name: up,
    layer: upper, outlines: [{circle: {centre: [0.2, 0.15], radius: 0.1}}, {inside: x - 0.33}]}, {name: low, layer: lower, outlines: [{polygon: [[0.03,
    0.02], [0.35, 0.11], [0.1, 0.27]]}]}]' --set 'sensors=[{name: s, drives: [{patches: low}]}]' --set 'outputs=[{name: w, u3: middle, at: nodes}]'
same 'patches with smeared stiffness' tests/rigs/scenes/smeared-plate.yaml --compact --set kinematics=nonlinear --set 'loads=[{temperature: 20}]'
"$PZS" tables annular-plate --image nonlinear --prefix t -o "$scratch/t.h" >"$scratch/told" && ! compile 32 &&
    grep -q 'the equilibrium solver needs double' "$scratch/found"
tap $? "annular-plate is refused in float: $(tail -n 1 "$scratch/told")"

# A linear image whose tables hold open electrodes: the device's influence matrix, without the columns and rows that are no
# amplifiers and no target nodes, is that of pzs shape.
cat >"$scratch/linear.c" <<'EOT'
#include <stdio.h>
#include "t.h"
static pzs_real model_work[T_MODEL_BYTES / sizeof(pzs_real) + 1], electric_work[T_ELECTRIC_BYTES / sizeof(pzs_real) + 1];
static pzs_real influence[T_ALL_OUTPUTS][T_ALL_INPUTS];

int main(void)
{
    pzs_model model;
    pzs_electric electric;
    pzs_status status = pzs_model_init(&model, &t_structure, model_work, sizeof model_work);
    if (status == PZS_OK) status = pzs_assemble(&model, NULL, NULL);
    if (status == PZS_OK) status = pzs_factor(&model);
    if (status == PZS_OK) status = pzs_influence(&model, influence[0]);
    if (status == PZS_OK) status = pzs_electric_init(&electric, &model, &t_electrodes, electric_work, sizeof electric_work);
    if (status == PZS_OK) status = pzs_electric_factor(&electric);
    if (status == PZS_OK) status = pzs_influence_open(&electric, influence[0]);
    for (int i = 0; i < T_OUTPUTS; i++)
        for (int k = 0; k < T_INPUTS; k++) printf("%.17g\n", (double)influence[i][k]);
    return status;
}
EOT
set -- tests/rigs/scenes/outline-plate.yaml --set 'patches=[{name: up, layer: upper, grid: [2, 2]}, {name: low, layer: lower, grid: [2, 2]}]' \
    --set 'sensors=[{name: s, drives: [{patches: low}]}]' --set 'target={u3: middle, edge: theta1+, value: 1e-4}'
"$PZS" tables "$@" --image linear --prefix t -o "$scratch/t.h" >"$scratch/told" 2>"$scratch/found" &&
    "$PZS" shape "$@" --npz "$scratch/t.npz" >"$scratch/told" 2>"$scratch/found" && cp "$scratch/linear.c" "$scratch/program.c" && compile 64 &&
    "$scratch/program" >"$scratch/found" && /usr/bin/python3 -c 'import sys, numpy as np
host, device = np.load(sys.argv[1])["influence"], np.loadtxt(sys.argv[2])
sys.exit(not abs(device - host.ravel()).max() <= 1e-12 * abs(host).max() > 0)' "$scratch/t.npz" "$scratch/found"
tap $? 'linear image with open electrodes: the influence matrix of pzs shape'

"$PZS" tables scordelis-lo --image nonlinear -o "$scratch/t.h" 2>"$scratch/found"
[ $? -eq 2 ] && grep -q 'kinematics: nonlinear' "$scratch/found"
tap $? 'a scene of linear kinematics is refused'

# Images with modes: the device finds the frequencies in its header, a linear one in both precisions and a nonlinear one in
# double, which the condition of this plate needs; without PZS_MODES the header does not compile.
cat >"$scratch/modes.c" <<'EOT'
#include <stdio.h>
#include "t.h"
static pzs_real model_work[T_MODEL_BYTES / sizeof(pzs_real) + 1], modes_work[T_MODES_BYTES / sizeof(pzs_real) + 1];

int main(void)
{
    pzs_model model;
    pzs_modes modes;
    pzs_status status = pzs_model_init(&model, &t_structure, model_work, sizeof model_work);
    if (status == PZS_OK) status = pzs_assemble(&model, NULL, NULL);
    if (status == PZS_OK) status = pzs_factor(&model);
    if (status == PZS_OK)
        status = pzs_modes_init(&modes, &model, &t_mass, T_MODES, T_MODES_VECTORS, modes_work, sizeof modes_work);
#ifdef T_MODES_OPEN
    static pzs_real open_work[T_MODES_OPEN_BYTES / sizeof(pzs_real) + 1];
    if (status == PZS_OK) status = pzs_modes_open_electrodes(&modes, &t_electrodes, t_modes_open, open_work, sizeof open_work);
#endif
    modes.settings.shift = T_MODES_SHIFT;
    if (status == PZS_OK) status = pzs_modes_find(&modes);
    printf("%s\n", pzs_status_text(status));
    for (uint16_t i = 0; i < T_MODES && status == PZS_OK; i++) {
        const pzs_real off = pzs_modes_frequency(&modes, i) / t_frequency[i] - 1;
        printf("%g %g\n", (double)t_frequency[i], (double)off);
        /* rounding errors of the projected matrix are relative to its largest eigenvalue, 1 / (w of the first mode)^2 */
        const pzs_real ratio = t_frequency[i] / t_frequency[0], most = 16 * PZS_EPSILON * (1 + ratio * ratio);
        if (!(off < most && off > -most)) return 1;
    }
    return status != PZS_OK;
}
EOT
# with_modes CIRCUIT IMAGE KINEMATICS BITS...: header of the image, program that compares the frequencies, and its run for each
# precision; CIRCUIT: as --electrodes
with_modes() {
    circuit=$1
    shift
    "$PZS" tables plate-50-patches --quasi-static --set kinematics="$2" --set mesh.theta1.elements=5 --set mesh.theta2.elements=5 --image "$1" \
        --compact --modes 6 --electrodes "$circuit" --set materials.G1195.permittivity=7.3e-9 --prefix t -o "$scratch/t.h" >"$scratch/told" 2>"$scratch/found" || return 1
    cp "$scratch/modes.c" "$scratch/program.c"
    shift 2
    ! compile 64 || return 1
    for bits in "$@"; do compile "$bits" -DPZS_MODES=1 && "$scratch/program" >"$scratch/found" || return 1; done
}
with_modes short linear linear 64 32
tap $? 'linear image with modes: the frequencies in its header'
with_modes short nonlinear nonlinear 64
tap $? 'nonlinear image with modes: the frequencies in its header'
with_modes open linear linear 64 32
tap $? 'linear image with modes and open electrodes: the frequencies in its header'
with_modes open nonlinear nonlinear 64
tap $? 'nonlinear image with modes and open electrodes: the frequencies in its header'

# The committed example is what the program writes today.
"${MAKE:-make}" --no-print-directory -s -n example-table | sed 's|-o [^ ]*|-o '"$scratch/example.h"'|' >"$scratch/command"
sh "$scratch/command" >"$scratch/found" 2>&1 && diff "$scratch/example.h" host_tools/tables/example.h >"$scratch/found"
tap $? 'host_tools/tables/example.h is what pzs writes (else: make example-table)'
tap_end
