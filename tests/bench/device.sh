#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Instructions of the factor and of a control tick on a Cortex-M7 under QEMU.
# TAP lines; the targets are instructions per multiply-add of the unpadded band, 197,176.
set -u
B=${B:-build}
CC=${ARM_CC:-arm-none-eabi-gcc}
dir=$B/bench/device
mkdir -p "$dir"
m7='-mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16'
flags='-std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off -Iinclude'
rest='tests/bench/count_linalg.c lib/core/guard.c firmware_demo/demos/print.c'
n=0

# row BITS LEVEL TARGET
row() {
    n=$((n + 1))
    # shellcheck disable=SC2086
    $CC $m7 $flags -DPZS_REAL_BITS="$1" "$2" -c lib/core/linalg.c -o "$dir/linalg.o" &&
        $CC $m7 $flags -DPZS_REAL_BITS="$1" -O2 -nostartfiles -Lfirmware_demo/boards -Tfirmware_demo/boards/mps2_an500.ld -Wl,--gc-sections \
            $rest "$dir/linalg.o" firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/count.elf" &&
        gcc $flags -DPZS_REAL_BITS="$1" -O2 $rest lib/core/linalg.c firmware_demo/boards/board_host.c -lm -o "$dir/count" || { echo "not ok $n - build"; return; }
    timeout 60 "${QEMU:-qemu-system-arm}" -M mps2-an500 -icount shift=10 -kernel "$dir/count.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null >"$dir/out" 2>/dev/null
    "$dir/count" | grep '^bits' >"$dir/host"
    grep '^bits' "$dir/out" | cmp -s - "$dir/host" && same=1 || same=0
    sed -n 's/^count factor=\([0-9]*\) solve=\([0-9]*\).*/\1 \2/p' "$dir/out" | awk -v n=$n -v bits="$1" -v level="$2" -v target="$3" -v same=$same '
        { per = $1 / 197176; good = same && (target == 0 || per <= target)
          printf "%s %d - Cortex-M7, %d bits, %s: factor %d instructions, %.3f a multiply-add%s, solve %d, bits %s\n", good ? "ok" : "not ok",
                 n, bits, level, $1, per, target ? " (target " target ")" : "", $2, same ? "of the host" : "DIFFER" }'
}

# The demonstration's control image, float, on the same processor: instructions of a control tick, 25 voltages, 121 outputs.
tick() {
    n=$((n + 1))
    demo='firmware_demo/demos/main.c firmware_demo/demos/drill.c firmware_demo/demos/print.c firmware_demo/demos/demo_control.c'
    # shellcheck disable=SC2086
    $CC $m7 $flags -I"${B:-build}/tables" -DPZS_REAL_BITS=32 -DDEMO_TABLES='"plate_control.h"' -Os -nostartfiles -Lfirmware_demo/boards \
        -Tfirmware_demo/boards/mps2_an500.ld -Wl,--gc-sections $demo lib/*/*.c firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/tick7.elf" &&
        gcc $flags -I"${B:-build}/tables" -DPZS_REAL_BITS=32 -DDEMO_TABLES='"plate_control.h"' -O2 $demo lib/*/*.c firmware_demo/boards/board_host.c \
            -lm -o "$dir/tick7" || { echo "not ok $n - build"; return; }
    timeout 60 "${QEMU:-qemu-system-arm}" -M mps2-an500 -icount shift=10 -kernel "$dir/tick7.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null 2>/dev/null | tr -d '\r' >"$dir/out"
    "$dir/tick7" | grep '^result' >"$dir/host"
    grep '^result' "$dir/out" | cmp -s - "$dir/host" && same=1 || same=0
    sed -n 's/^cost tick mean=\([0-9]*\) worst=\([0-9]*\) warm=\([0-9]*\).*/\1 \2 \3/p' "$dir/out" | awk -v n=$n -v same=$same '
        { printf "%s %d - Cortex-M7, 32 bits, -Os: control tick %d instructions warm (target 25000), %d mean, %d worst, bits %s\n",
                 same && $3 <= 25000 ? "ok" : "not ok", n, $3, $1, $2, same ? "of the host" : "DIFFER" }'
}

row 32 -O2 3.5
row 32 -Os 2.5
row 64 -O2 0
row 64 -Os 0
tick
echo "1..$n"
