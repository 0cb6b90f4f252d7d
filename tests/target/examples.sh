#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The examples of firmware_demo/examples: each at most 60 lines, built by its own Makefile, run under QEMU to exit 0.
#   ARM_CC, QEMU, B, CI from the environment; TAP on stdout
: "${QEMU:=qemu-system-arm}" "${B:=build}"
. tests/gates/common.sh
tool=$(realpath "${PZS:-$B/pzs}")

# example NAME LINE: the line that it prints
example() {
    at=firmware_demo/examples/$1
    [ "$(cat "$at"/main.* | wc -l)" -le 60 ] && [ "$(wc -l <"$at/Makefile")" -le 60 ]
    tap $? "$1: at most 60 lines"
    "${MAKE:-make}" --no-print-directory -s -C "$at" "O=$scratch/$1" "TOOL=$tool" "CROSS=${ARM_CC%gcc}" >"$scratch/found" 2>&1
    tap $? "$1 builds"
    timeout 120 "${MAKE:-make}" --no-print-directory -s -C "$at" "O=$scratch/$1" "TOOL=$tool" "QEMU=$QEMU" run >"$scratch/found" 2>&1 &&
        tr -d '\r' <"$scratch/found" | grep -q "^$2\$"
    tap $? "$1 runs: $2"
}

# holds NAME SYMBOL: whether an example has a symbol
holds() {
    "$ARM_NM" "$scratch/$1/firmware.elf" | awk '{ print $NF }' | grep -qx "$2"
}

# A copy elsewhere needs nothing but the variables of its Makefile.
copied() {
    top=$(pwd)
    cp -r firmware_demo/examples/control "$scratch/copy"
    (cd "$scratch/copy" && timeout 120 "${MAKE:-make}" --no-print-directory -s "PZS=$top" "TOOL=$tool" "QEMU=$QEMU" run) >"$scratch/found" 2>&1
    tap $? 'a copy of control builds and runs elsewhere'
}

# A copy with a matrix and a target of the user: files of any name, and new tables after a change of one.
own_files() {
    cp -r firmware_demo/examples/measured "$scratch/own"
    (cd "$scratch/own" && mv mirror-matrix.csv B.csv && seq 19 | sed 's/$/e-4/' >target.csv &&
        sed -i 's/mirror-matrix.csv/B.csv/; s/^target:.*/target: {value: {file: target.csv}}/' mirror.yaml &&
        "${MAKE:-make}" -s "PZS=$top" "TOOL=$tool" build/mirror.h && cp build/mirror.h before.h && touch -d '1 minute ago' build/mirror.h &&
        seq 19 | sed 's/$/e-5/' >target.csv && "${MAKE:-make}" -s "PZS=$top" "TOOL=$tool" build/mirror.h && ! cmp -s before.h build/mirror.h) \
        >"$scratch/found" 2>&1
    tap $? 'measured takes files of any name, and makes the tables anew when one has changed'
}

if tap_needs "$ARM_CC" 'examples' && tap_needs "$QEMU" 'examples'; then
    example control 'loop: ok, every voltage inside its limits'
    example control-cpp ok
    example linear ok
    example nonlinear ok
    example measured ok
    example calibrate ok
    example missed-ticks 'damped, 100 ticks missed'
    holds control pzs_step_block && ! holds control pzs_estimator_block && ! holds control pzs_feed_forward_block &&
        ! holds control pzs_amplifier_block && ! holds control pzs_fault_detector_block
    tap $? 'control holds the step and no other block'
    holds control-cpp pzs_estimator_block && holds control-cpp pzs_amplifier_block && ! holds control-cpp pzs_fault_detector_block &&
        ! holds control-cpp pzs_fault_detector_init
    tap $? 'control-cpp holds the blocks of its list and no fault detector'
    ! "$ARM_CC" -std=c99 $m4 $include -Ifirmware_demo/boards -I"$scratch/control" -DPZS_REAL_BITS=64 -fsyntax-only \
        firmware_demo/examples/control/main.c 2>"$scratch/found" && grep -q 'needs another precision' "$scratch/found"
    tap $? 'control does not compile in another precision than it asks for'
    copied
    own_files
fi
tap_end
