#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# `pzs simulate --device`: the firmware of each board in the loop, its plant on this computer, the same bits as without it.
#   ARM_CC, QEMU, B, CI from the environment; TAP on stdout
: "${QEMU:=qemu-system-arm}" "${B:=build}"
. tests/gates/common.sh
PZS=${PZS:-$B/pzs}
export ARM_CC QEMU

# 200 ticks with an order of every kind to the controller: late and missing measurements, held and released electrodes.
events='[{at: 30, load: 0, factor: 2}, {at: 50, target: 0.5}, {at: 70, missing_sensors: 0.3, ticks: 20}, {at: 95, missing_sensors: 1, ticks: 3}, '\
'{at: 100, missed_ticks: 10}, {at: 115, dead: [v_1_1, v_3_2], announced: detected}, {at: 160, alive: [v_1_1, v_3_2]}, '\
'{at: 165, stuck: [v_2_4], announced: 3}, {at: 172, target: -0.5}]'

# The shape from few sensors, known and unknown loads, whole steps, a watch, lost and missing readings.
few='[{at: 0, load: 0, factor: 0, feed_forward: true}, {at: 40, load: 0, factor: 1, feed_forward: true}, {at: 70, missing_sensors: 0.3, ticks: 10}, '\
'{at: 80, load: 0, factor: 2}, {at: 90, missing_sensors: 1, ticks: 4}, {at: 110, missed_ticks: 10}, {at: 125, dead: [v_1_1], announced: detected}, '\
'{at: 160, alive: [v_1_1]}, {at: 165, target: 0.5}]'

# loop NAME ARGUMENTS: the loop's volts in NAME.csv, its summary in NAME.json
loop() {
    name=$1
    shift
    "$PZS" simulate plate-closed-loop --set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear \
        --set simulate.plant.inertia=false --set simulate.plant.hysteresis=0 \
        --set simulate.ticks=200 --set simulate.sensors.delay=1 --set "simulate.events=$events" --json --csv "$scratch/$name.csv" "$@" \
        >"$scratch/$name.json" 2>"$scratch/found"
}

# loop_few NAME ARGUMENTS: the same of the scene with few sensors
loop_few() {
    name=$1
    shift
    "$PZS" simulate plate-few-sensors --set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear \
        --set simulate.plant.inertia=false --set simulate.plant.hysteresis=0 \
        --set simulate.ticks=200 --set "simulate.events=$few" --json --csv "$scratch/$name.csv" "$@" \
        >"$scratch/$name.json" 2>"$scratch/found"
}

# loop_damped NAME ARGUMENTS: the damped tick on a plant with inertia, which misses six ticks
damped='[{at: 0, load: 0, factor: 0}, {at: 40, target: -0.5}, {at: 70, missed_ticks: 6}, {at: 90, missing_sensors: 0.3, ticks: 5}]'
loop_damped() {
    name=$1
    shift
    "$PZS" simulate plate-closed-loop --set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear \
        --set simulate.ticks=120 --set "simulate.events=$damped" --json --csv "$scratch/$name.csv" "$@" >"$scratch/$name.json" 2>"$scratch/found"
}

# count FILE KEY: the first number of a key
count() {
    sed -n "s/^.*\"$2\": \([0-9]*\).*$/\1/p" "$1" | head -n 1
}

# board NAME OTHER: every tick the bits of the same C on this computer, and the file of another run
board() {
    loop "$1" --device "$1" && [ "$(count "$scratch/$1.json" device_same)" = 190 ] && cmp "$scratch/$1.csv" "$scratch/$2.csv" >"$scratch/found" 2>&1
    tap $? "$1: 190 ticks, all with the bits of the same C here"
}

# board_few NAME OTHER: as board, of few sensors
board_few() {
    loop_few "few-$1" --device "$1" && [ "$(count "$scratch/few-$1.json" device_same)" = 190 ] &&
        cmp "$scratch/few-$1.csv" "$scratch/few-$2.csv" >"$scratch/found" 2>&1
    tap $? "$1: the same from few sensors, with a known load"
}

# loop_rows: a measured mirror whose neighbours differ by at most 10 V
loop_rows() {
    "$PZS" new measured >"$scratch/measured.yaml" && "$PZS" new measured-matrix >"$scratch/measured-matrix.csv" &&
        "$PZS" simulate "$scratch/measured.yaml" --set 'limits.difference={limit: 10}' --set limits.step_limit=3 \
            --device netduinoplus2 --json --csv "$scratch/rows.csv" >"$scratch/rows.json" 2>"$scratch/found"
}

# loop_sparse NAME ARGUMENTS: a measured mirror of 36 actuators, each of which moves few of 100 outputs
loop_sparse() {
    name=$1
    shift
    awk 'BEGIN {
        for (i = 0; i < 100; i++)
            for (k = 0; k < 36; k++) {
                x = i % 10 / 1.8 - k % 6; y = int(i / 10) / 1.8 - int(k / 6)
                printf "%.9g%s", 1e-6 * exp(-3 * (x * x + y * y)), k < 35 ? "," : "\n"
            }
    }' >"$scratch/narrow.csv"
    printf '%s\n' 'name: narrow' 'units: {length: m, force: N, voltage: V, temperature: K}' \
        'influence: {file: narrow.csv, drop_below: 0.02}' 'limits: {voltage: [-40, 40], step_limit: 20}' \
        'target: {value: 3e-5}' 'simulate: {ticks: 60, plant: {gain: 0.9}, events: [{at: 30, target: -1}]}' >"$scratch/narrow.yaml"
    "$PZS" simulate "$scratch/narrow.yaml" --json --csv "$scratch/$name.csv" "$@" >"$scratch/$name.json" 2>"$scratch/found"
}

# loop_curved NAME ARGUMENTS: electrostatic actuators from 0 to 200 V, on a mirror whose curves are another
loop_curved() {
    name=$1
    shift
    "$PZS" new measured >"$scratch/measured.yaml" && "$PZS" new measured-matrix >"$scratch/measured-matrix.csv" &&
        "$PZS" simulate "$scratch/measured.yaml" --set 'influence={file: measured-matrix.csv, scale: 6e-6, curve: quadratic}' \
            --set 'limits={voltage: [0, 200], step_limit: 30}' --set 'target={value: "1.5e-3 + 8e-6*(x^2 - y^2)"}' --set simulate.plant.curve_error=0.1 \
            --set 'simulate.events=[{at: 40, target: 0.5}, {at: 60, dead: [e3], announced: 2}, {at: 80, alive: [e3]}]' \
            --json --csv "$scratch/$name.csv" "$@" >"$scratch/$name.json" 2>"$scratch/found"
}

if tap_needs "$ARM_CC" 'loop' && tap_needs "$QEMU" 'loop'; then
    loop double
    tap $? 'the loop in double'
    [ "$(count "$scratch/double.json" detected)" = 2 ]
    tap $? 'both dead electrodes are found'
    board mps2-an500 double
    board netduinoplus2 netduinoplus2
    board mps2-an386 netduinoplus2
    loop_few few-double
    tap $? 'few sensors in double'
    board_few mps2-an500 double
    board_few netduinoplus2 netduinoplus2
    loop_damped damped --device netduinoplus2 && [ "$(count "$scratch/damped.json" device_same)" = 114 ] &&
        grep -q '"dynamics": "inertia"' "$scratch/damped.json" && tail -n 1 "$scratch/damped.csv" | awk -F, '{ exit !($4 < 0.05) }'
    tap $? 'netduinoplus2: the damped tick on a vibrating plant, 114 ticks with the bits of the same C here, vibration below 5 %'
    loop tested --device netduinoplus2 --set 'safety={selftest: {amplitude: 20, pulse_ticks: 16}}' && [ "$(count "$scratch/tested.json" device_same)" = 190 ] &&
        ! loop wired --device netduinoplus2 --set 'safety={selftest: {amplitude: 20, pulse_ticks: 16}}' --set 'simulate.amplifiers.reversed=[v_1_3]' &&
        grep -q 'self-test: ' "$scratch/found"
    tap $? 'netduinoplus2: a self-test with the bits of the same C here, and one that refuses a reversed wire'
    loop_rows && [ "$(count "$scratch/rows.json" device_same)" = 100 ] &&
        awk -F, 'NR > 1 { for (k = 10; k <= NF; k++) if ($k - $(k - 1) > 10 || $(k - 1) - $k > 10) exit 1 }' "$scratch/rows.csv"
    tap $? 'netduinoplus2: neighbours within 10 V, 100 ticks with the bits of the same C here'
    loop_sparse sparse-double && loop_sparse sparse-m7 --device mps2-an500 && "$PZS" tables "$scratch/narrow.yaml" -o "$scratch/narrow.h" >/dev/null &&
        grep -q 'pzs_sparse_influence_calls' "$scratch/narrow.h" && [ "$(count "$scratch/sparse-m7.json" device_same)" = 60 ] &&
        cmp "$scratch/sparse-double.csv" "$scratch/sparse-m7.csv" >"$scratch/found" 2>&1
    tap $? 'mps2-an500: sparse influence matrix, 60 ticks with the bits of the full matrix on this computer'
    loop_sparse sparse-m4 --device netduinoplus2 && [ "$(count "$scratch/sparse-m4.json" device_same)" = 60 ]
    tap $? 'netduinoplus2: sparse influence matrix, 60 ticks with the bits of the same C here'
    loop_curved curved-double && loop_curved curved-m7 --device mps2-an500 && [ "$(count "$scratch/curved-m7.json" device_same)" = 100 ] &&
        cmp "$scratch/curved-double.csv" "$scratch/curved-m7.csv" >"$scratch/found" 2>&1
    tap $? 'mps2-an500: quadratic actuators, 100 ticks with the bits of the loop on this computer'
    loop_curved curved-m4 --device netduinoplus2 && [ "$(count "$scratch/curved-m4.json" device_same)" = 100 ]
    tap $? 'netduinoplus2: quadratic actuators, 100 ticks with the bits of the same C here'
    ! cmp -s "$scratch/double.csv" "$scratch/netduinoplus2.csv"
    tap $? 'float and double differ'
    ARM_CC=false
    ! loop unbuilt --device netduinoplus2 && grep -q 'pzs: the firmware of netduinoplus2 could not be built' "$scratch/found" &&
        [ ! -e "$scratch/unbuilt.csv" ]
    tap $? 'a firmware that does not build ends the run with a message'
fi
tap_end
