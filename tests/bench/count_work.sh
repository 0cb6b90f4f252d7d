#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Instructions of control ticks with targets that jump, under QEMU, float on a Cortex-M4F; TAP lines.
#   count_work.sh PZS      PZS makes the tables
# The target is a worst tick of 64,000 instructions with the work limit: 84,000 at 168 MHz, 1 kHz and two cycles an
# instruction, less 20,000 for the blocks around the control step.
set -u
B=${B:-build}
CC=${ARM_CC:-arm-none-eabi-gcc}
dir=$B/bench/device
mkdir -p "$dir"
flags='-std=c99 -Os -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off -Iinclude -DPZS_REAL_BITS=32'
m4='-mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16'
n=0

"$1" tables plate-50-patches --quasi-static --set limits.step_limit=20 --image control --prefix demo -o "$dir/count_work.h" >/dev/null ||
    { echo 'not ok 1 - tables'; exit 1; }

# row LIMIT TARGET
row() {
    n=$((n + 1))
    # shellcheck disable=SC2086
    $CC $m4 $flags -I"$dir" -DLIMIT="$1" -DDEMO_TABLES='"count_work.h"' -nostartfiles -Lfirmware_demo/boards \
        -Tfirmware_demo/boards/mps2_an386.ld -Wl,--gc-sections tests/bench/count_work.c firmware_demo/demos/print.c \
        lib/core/*.c lib/control/*.c firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/work.elf" ||
        { echo "not ok $n - build"; return; }
    timeout 300 "${QEMU:-qemu-system-arm}" -M mps2-an386 -icount shift=10 -kernel "$dir/work.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null 2>/dev/null | tr -d '\r' >"$dir/out"
    sed 's/[a-z_]*=//g' "$dir/out" | awk -v n=$n -v limit="$1" -v target="$2" '
        $1 == "count" { sum += $3; rows++; if ($4 > most) { most = $4; work = $5 } if ($6 > most_work) most_work = $6 }
        END { printf "%s %d - Cortex-M4F, float, work limit %s: %d instructions mean, %d worst%s, with %d multiply-adds (most %d)\n",
              rows && (!target || most <= target) ? "ok" : "not ok", n, limit ? limit : "default", rows ? sum / rows : 0, most,
              target ? " (target " target ")" : "", work, most_work }'
    sed -n 's/^count/#  /p' "$dir/out"
}

row 0 0
row 5685 64000
echo "1..$n"
