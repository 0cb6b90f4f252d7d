#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The sensor gate of generated tables in both precisions: single faults of six kinds, and healthy sensors.
#   sh tests/target/gate.sh [TICKS]   default 40000; a million takes a minute
: "${B:=build}" "${MAKE:=make}"
: "${PZS:=$B/pzs}"
. tests/gates/common.sh

"$PZS" tables plate-50-patches --set 'limits.voltage=[-300,300]' --set limits.step_limit=20 --set safety=none \
    --set 'control={rate: 1000, sensor_gate: true}' --image control --prefix demo -o "$scratch/tables.h" >"$scratch/found" 2>&1
tap $? 'tables with a sensor gate'
for bits in 32 64; do
    "$MAKE" --no-print-directory -s B="$B" "$B/$bits/libpiezoshape.a" >"$scratch/found" 2>&1 &&
        "$CC" -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -O2 -DPZS_REAL_BITS=$bits -DPZS_NONLINEAR=1 \
            -Iinclude -I"$scratch" -DDEMO_TABLES='"tables.h"' tests/bench/sweep_gate_tables.c "$B/$bits/libpiezoshape.a" -lm \
            -o "$scratch/sweep" >"$scratch/found" 2>&1 && "$scratch/sweep" "${1:-40000}" >"$scratch/found" 2>&1
    tap $? "$bits bits: wrong sensors are found, healthy ones are not"
    cat "$scratch/found"
done
tap_end
