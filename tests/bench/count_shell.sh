#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Cost of the element at a shape under QEMU: floating-point operations, instructions, stack.
# TAP lines; targets: 45,000 operations for the system of an element with 7 unknowns a node, 14 KB of stack.
set -u
B=${B:-build}
CC=${ARM_CC:-arm-none-eabi-gcc}
dir=$B/bench/shell
mkdir -p "$dir"
sed 's/^stack_size.*/stack_size = 32K;/' firmware_demo/boards/mps2_an500.ld >"$dir/board.ld"
flags='-std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off -DPZS_NONLINEAR=1 -Iinclude'
lib='lib/model/shell.c lib/model/shell_skew.c lib/nonlinear/shell_at.c lib/core/guard.c'
rest='tests/bench/count_shell.c firmware_demo/demos/print.c'
hard='-mthumb -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16'
soft='-mthumb -mcpu=cortex-m7 -mfloat-abi=soft -Wl,--wrap=__aeabi_dadd,--wrap=__aeabi_dsub,--wrap=__aeabi_drsub,--wrap=__aeabi_dmul,--wrap=__aeabi_ddiv'
n=0

# row NAME BITS LEVEL TARGET_FLAGS MOST_IN_THE_SYSTEM
row() {
    n=$((n + 1))
    # shellcheck disable=SC2086
    $CC $4 $flags -DPZS_REAL_BITS="$2" "$3" -nostartfiles -Lfirmware_demo/boards -T"$dir/board.ld" -Wl,--gc-sections \
        $rest $lib firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/count.elf" &&
        gcc $flags -DPZS_REAL_BITS="$2" -O2 $rest $lib firmware_demo/boards/board_host.c -lm -o "$dir/count" || { echo "not ok $n - build"; return; }
    timeout 60 "${QEMU:-qemu-system-arm}" -M mps2-an500 -icount shift=10 -kernel "$dir/count.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null >"$dir/out" 2>/dev/null
    "$dir/count" | grep '^bits' >"$dir/host"
    grep '^bits' "$dir/out" | cmp -s - "$dir/host" && same=1 || same=0
    tr '=' ' ' <"$dir/out" | awk -v n=$n -v name="$1" -v bits="$2" -v level="$3" -v most="$5" -v same=$same '
        $1 == "count" { text = text sprintf("%s %d unknowns: system %d, resultants %d, force %d", text ? ";" : "", $3, $5, $7, $9) }
        $1 == "count" && $3 == 7 { system_ = $5 }
        $1 == "skewed" { text = text sprintf("; any quadrilateral: system %d, resultants %d, force %d", $5, $7, $9) }
        $1 == "stack" { stack = $3 }
        END { good = same && system_ > 0 && stack <= 14336 && (most == 0 || system_ <= most)
              printf "%s %d - %s, %d bits, %s:%s; stack %d bytes, bits %s\n", good ? "ok" : "not ok", n, name, bits, level, text,
                     stack, same ? "of the host" : "DIFFER" }'
}

row 'floating-point operations' 64 -O2 "$soft" 45000
row 'Cortex-M7 instructions' 64 -O2 "$hard" 0
row 'Cortex-M7 instructions' 64 -Os "$hard" 0
row 'Cortex-M7 instructions' 32 -O2 "$hard" 0
row 'Cortex-M7 instructions' 32 -Os "$hard" 0
echo "1..$n"
