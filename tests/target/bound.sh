#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Instructions of each block of the control tick, counted under QEMU, against their upper bounds (host_tools/tables/loop_work.c),
# and its voltages and findings bit by bit against those of the same program on this computer.
#   sh tests/target/bound.sh [full | long]
#     without a word  the loop of the demonstration and five other loops in 2,000 ticks (the last one 8,500), bounds of the
#                     Cortex-M4F; on the Cortex-M7 the bits of the first loop alone
#     full            every block in 20,000 ticks, bounds of both processors
#     long            the loop of the demonstration in 1,000,000 ticks, Cortex-M4F
# tests/bench/count_blocks.c searches for the longest tick. A count above its bound is a failure. TAP lines, and the counts as comments.
: "${QEMU:=qemu-system-arm}" "${B:=build}" "${PYTHON:=/usr/bin/python3}" "${MAKE:=make}"
: "${PZS:=$B/pzs}"
. tests/gates/common.sh

limits='--set limits.voltage=[-300,300] --set limits.step_limit=20'
flags='-std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off -Iinclude'
program='tests/bench/count_blocks.c firmware_demo/demos/print.c'
board='firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c'
patience=300
mode=${1:-short}
case $mode in
short) ticks=2000 ;;
full) ticks=20000 ;;
long) ticks=1000000 patience=7200 ;;
*)
    echo "bound.sh: '$mode' is not a mode; write full, long or nothing" >&2
    exit 2
    ;;
esac

demo='damped loop with supervisor'
# The loop of the demonstration: 1000 ticks a second at 168 MHz are 84,000 instructions of two cycles each.
most_warm=45000
bound_below=84000

# run_board LIBRARY MACHINE SCRIPT FLAGS...: counts and checksum of the loop in $scratch/tables.h under QEMU
run_board() {
    library=$B/firmware/$1/libpzs.a machine=$2 script=$3
    shift 3
    : >"$scratch/counts"
    # shellcheck disable=SC2086
    "$ARM_CC" "$@" $flags -I"$scratch" -DSEARCHED=$ticks -DDEMO_TABLES='"tables.h"' -nostartfiles -Lfirmware_demo/boards \
        -T"firmware_demo/boards/$script.ld" -Wl,--gc-sections $program $board "$library" -lm -o "$scratch/count.elf" &&
        timeout $patience "$QEMU" -M "$machine" -icount shift=10 -kernel "$scratch/count.elf" -nographic -monitor none -serial stdio \
            -semihosting-config enable=on,target=native </dev/null 2>/dev/null | tr -d '\r' >"$scratch/counts"
}

# same NAME BITS: the checksums of the voltages and findings of all ticks are those of the same program on this computer, and no tick
# has failed
same() {
    # shellcheck disable=SC2086
    "$CC" $flags -O2 -DPZS_REAL_BITS="$2" -I"$scratch" -DSEARCHED=$ticks -DDEMO_TABLES='"tables.h"' $program firmware_demo/boards/board_host.c \
        "$B/$2/libpiezoshape.a" -lm -o "$scratch/host" >>"$scratch/found" 2>&1 && "$scratch/host" >"$scratch/host.counts"
    sed -n 's/^bits/board: &/p' "$scratch/counts" >>"$scratch/found"
    sed -n 's/^bits/host: &/p' "$scratch/host.counts" >>"$scratch/found"
    awk '$1 == "bits" { split($NF, status, "="); is_good = status[1] == "status" && status[2] < 64; lines[FILENAME] = $0 }
        END { exit !is_good || lines[ARGV[1]] != lines[ARGV[2]] }' "$scratch/host.counts" "$scratch/counts"
    tap $? "$1, $ticks ticks: the bits of this computer"
    rm -f "$scratch/host" "$scratch/host.counts"
}

# Bounds as lines `name number`, on a Cortex-M4F from the comments of the tables, on another processor from `pzs check --json`.
bounds_of_tables() {
    sed -n 's|^    /\* .*: at most \([0-9]*\) instructions in a tick, \([0-9]*\) of them .*|all \1\nloop \2|p
        s|^    {&pzs_\([a-z_]*\)_block, .*}, /\* at most \([0-9]*\) instructions of this block in a tick \*/|\1 \2|p' "$scratch/tables.h" >"$scratch/bounds"
}
bounds_of_check() {
    "$PZS" check "$@" --json 2>/dev/null | "$PYTHON" -c '
import json, sys
bound = json.load(sys.stdin)["tick"]["instructions"]["cortex_m7"]
for name, most in dict(bound["blocks"], loop=bound["rest"], all=bound["all"]).items():
    print(name, round(most))' >"$scratch/bounds"
}

# compare NAME: print the counts of each block beside its bound; fail where one is above its bound or missing
compare() {
    awk 'NR == FNR { most[$1] = $2; blocks++; next }
        $1 == "count" && $2 != "bytes" {
            split($4, worst, "="); split($5, warm, "=")
            bound = most[$2 == "led" ? "all" : $2]
            is_above = worst[2] > bound + 0
            above += is_above
            blocks -= $2 != "led"
            printf "#   %-15s warm %8d  worst %8d  bound %9d  %s\n", $2, warm[2], worst[2], bound, is_above ? "ABOVE" : ""
        }
        END { exit above > 0 || blocks != 0 || FNR == 0 }' "$scratch/bounds" "$scratch/counts"
    tap $? "$1, $ticks ticks: no count above its bound"
}

# loop NAME SCENE OPTIONS...: tables, counts, bounds and bits of one loop
loop() {
    name=$1
    shift
    rm -f "$scratch/tables.h"
    : >"$scratch/bounds"
    "$PZS" tables "$@" --image control --prefix demo -o "$scratch/tables.h" >/dev/null 2>"$scratch/found"
    # shellcheck disable=SC2086
    run_board m4-32 mps2-an386 mps2_an386 $m4 -DPZS_REAL_BITS=32 -Os >>"$scratch/found" 2>&1
    bounds_of_tables
    compare "$name, Cortex-M4F, float"
    same "$name, Cortex-M4F, float" 32
    cp "$scratch/bounds" "$scratch/m4.bounds"
    cp "$scratch/counts" "$scratch/m4.counts"
    [ "$mode" = full ] || [ "$mode $name" = "short $demo" ] || return 0
    # shellcheck disable=SC2086
    run_board m7-64 mps2-an500 mps2_an500 $m7 -DPZS_REAL_BITS=64 -O2 >"$scratch/found" 2>&1
    same "$name, Cortex-M7, double" 64
    [ "$mode" = full ] || return 0
    bounds_of_check "$@"
    compare "$name, Cortex-M7, double"
}

# figures: what the README states of the loop of the demonstration, whose bounds and counts `loop` has kept
figures() {
    awk -v most=$most_warm -v below=$bound_below '
        NR == FNR { bound = $1 == "all" ? $2 : bound; next }
        $1 == "count" && $2 == "all" { split($5, part, "="); warm = part[2] }
        END {
            printf "%d instructions warm, at most %d; bound %d, below %d\n", warm, most, bound, below
            exit !(warm > 0 && warm <= most && bound > 0 && bound < below)
        }' "$scratch/m4.bounds" "$scratch/m4.counts" >"$scratch/found"
    tap $? "the same, Cortex-M4F: at most $most_warm instructions warm, bound below $bound_below"
}

if tap_needs "$ARM_CC" 'bounds' && tap_needs "$QEMU" 'bounds'; then
    "$MAKE" --no-print-directory -s B="$B" "$B/firmware/m4-32/libpzs.a" "$B/firmware/m7-64/libpzs.a" "$B/32/libpiezoshape.a" \
        "$B/64/libpiezoshape.a" >"$scratch/found" 2>&1
    tap $? 'library builds for both processors and for this computer'
    # shellcheck disable=SC2086
    loop "$demo" plate-50-patches $limits --set 'control={rate: 1000, clock: 168 MHz}'
    figures
    if [ "$mode" != long ]; then
        # shellcheck disable=SC2086
        loop 'sensor gate' plate-50-patches $limits --set 'control={rate: 400, clock: 168 MHz, sensor_gate: true}'
        # shellcheck disable=SC2086
        loop 'late readings' plate-50-patches $limits --set 'control={rate: 900, clock: 168 MHz}' --set 'simulate={ticks: 100, sensors: {delay: 2}}'
        # shellcheck disable=SC2086
        loop 'amplifiers that lag' plate-50-patches $limits --set 'control={rate: 850, clock: 168 MHz}' \
            --set 'simulate={ticks: 100, amplifiers: {bandwidth: 10}}'
        # shellcheck disable=SC2086
        loop 'hysteresis' plate-50-patches $limits --set 'control={rate: 500, clock: 168 MHz}' --set \
            'hysteresis={range: [-300, 300], slopes: [0.368547, 0.426044, 0.437888, 0.503396], slack: [19.091, 47.0075, 79.6316, 115.746, 154.699, 196.076, 239.583, 285], above: [0.082997, 0.18585, 0.337765, 0.194578, 0.0411033, 0.0167373, 0.00482822, 0.0381532], below: [0.0661642, 0.149027, 0.290258, 0.153003, 0.00975122, 0, 0, 0.0376249], offset: -2.96617, creep_time: [0.1, 1, 10], creep: [0.0340785, 0.00622968, 0.136663]}'
        [ "$mode" = full ] || ticks=8500 # in which test pulses find the dead electrode
        # shellcheck disable=SC2086
        loop 'governor, self-test, fault detector with pulses' plate-50-patches $limits --set 'control={rate: 300, clock: 168 MHz, moving_target: true}' \
            --set 'safety={selftest: {amplitude: 20, pulse_ticks: 16}}' --set 'simulate={ticks: 100, events: [{at: 10, dead: [v_1_1], announced: detected}]}'
    fi
    if [ "$mode" = full ]; then
        # shellcheck disable=SC2086
        loop 'slow damped loop, whose optimiser may work long' plate-50-patches $limits --set 'control={rate: 400, clock: 168 MHz}'
        # shellcheck disable=SC2086
        loop 'gains and leaks of modes' plate-50-patches $limits \
            --set 'control={rate: 0.2, modal_gains: {modes: 20, gain: 0.5, leak: 0.01, other_gain: 0.2, other_leak: 0.02}}'
        # shellcheck disable=SC2086
        loop 'free functions' plate-50-patches $limits --set 'control={rate: 800, clock: 168 MHz}' --set 'target.free=[piston, tip, tilt]'
        # shellcheck disable=SC2086
        loop 'free functions, without a damper' plate-50-patches $limits --set 'control={rate: 0.2}' --set 'safety={}' \
            --set 'target.free=[piston]'
        # shellcheck disable=SC2086
        loop 'without supervisor' plate-50-patches $limits --set 'control={rate: 1000, clock: 168 MHz}' --set safety=none
        # shellcheck disable=SC2086
        loop 'fault detector with pulses' plate-50-patches $limits --set 'control={rate: 300, clock: 168 MHz}' \
            --set 'simulate={ticks: 100, events: [{at: 10, dead: [v_1_1], announced: detected}]}'
        # shellcheck disable=SC2086
        loop 'fault detector with pulses, hysteresis' plate-50-patches $limits --set 'control={rate: 300, clock: 168 MHz}' \
            --set 'hysteresis={range: [-300, 300], slopes: [0.36, 0.36, 0.36, 0.36], slack: [37.5, 75, 112.5, 150], above: [0.16, 0.16, 0.16, 0.16]}' \
            --set 'simulate={ticks: 100, events: [{at: 10, dead: [v_1_1], announced: detected}]}'
        loop 'few sensors, known load, converter steps' plate-few-sensors
        loop 'three sensors' tests/rigs/scenes/three-sensors.yaml
        loop 'nine amplifiers, free functions' tests/rigs/scenes/free-dish.yaml
        loop 'eight amplifiers, two modes' tests/rigs/scenes/twisted-blade.yaml
        loop 'three amplifiers, fault detector with pulses' tests/rigs/scenes/slow-beam.yaml --set mesh.theta1.elements=12 \
            --set 'patches=[{name: pu, layer: up, grid: [3, 1]}, {name: pl, layer: low, grid: [3, 1]}]' \
            --set 'simulate={ticks: 100, events: [{at: 10, dead: [v_1_1], announced: detected}]}'
        ticks=2001
        loop 'many amplifiers, no mode observed' mirror --set 'control={rate: 2000}'
        loop 'late readings without a damper, fault detector' mirror --set 'loads=[{face: outer, pressure: 1}]' --set 'control={rate: 20, clock: 168 MHz}' \
            --set 'simulate={ticks: 100, sensors: {delay: 2}, amplifiers: {step: 0.05}, events: [{at: 10, load: 0, factor: 1, feed_forward: true}, {at: 10, dead: [v_1_1], announced: detected}]}'
        loop 'limits between amplifiers' mirror --set 'control={rate: 10, clock: 168 MHz}' \
            --set 'limits={voltage: [-50, 50], step_limit: 5, difference: {limit: 30}}'
        loop 'limits of sums of absolute values' mirror --set 'control={rate: 2, clock: 168 MHz}' \
            --set 'limits={voltage: [-50, 50], step_limit: 5, absolute_sum: {limit: 150}, sum: {voltage: [-100, 100]}}' \
            --set 'simulate={ticks: 100, amplifiers: {step: 0.05}}'
    fi
fi
tap_end
