#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Instructions of a control tick with everything beside it, under QEMU: float on a Cortex-M4F, double on a Cortex-M7.
#   count_tick.sh PZS      PZS makes the tables; TAP lines
set -u
B=${B:-build}
CC=${ARM_CC:-arm-none-eabi-gcc}
dir=$B/bench/device
mkdir -p "$dir"
flags="-std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off -Iinclude -I$dir"
rest='tests/bench/count_tick.c firmware_demo/demos/print.c'
rest="$rest $(echo lib/core/*.c lib/control/*.c lib/model/*.c)"
n=0

"$1" tables plate-50-patches --quasi-static --set 'loads=[{face: outer, pressure: 20}]' --set 'limits.voltage=[-300, 300]' --set limits.step_limit=20 \
    --set 'outputs=[{name: tip, u3: middle, edge: theta1+}]' --set 'estimate={readings: [{output: tip, noise: 1e-7}]}' \
    --image control --prefix demo -o "$dir/count_tick.h" >/dev/null || { echo 'not ok 1 - tables'; exit 1; }

"$1" tables plate-50-patches --set 'limits.voltage=[-300, 300]' --set limits.step_limit=20 --set 'control={rate: 1000}' \
    --image control --prefix demo -o "$dir/count_damped.h" >/dev/null || { echo 'not ok 1 - tables of a damped tick'; exit 1; }

# A ceramic with 20 % of hysteresis and creep, as identified from a sweep of Preisach's relays: 8 plays, 3 creeps.
"$1" tables plate-50-patches --quasi-static --set 'limits.voltage=[-300, 300]' --set limits.step_limit=20 \
    --set 'hysteresis={range: [-300, 300], slopes: [0.368547, 0.426044, 0.437888, 0.503396], slack: [19.091, 47.0075, 79.6316, 115.746, 154.699, 196.076, 239.583, 285], above: [0.082997, 0.18585, 0.337765, 0.194578, 0.0411033, 0.0167373, 0.00482822, 0.0381532], below: [0.0661642, 0.149027, 0.290258, 0.153003, 0.00975122, 0, 0, 0.0376249], offset: -2.96617, creep_time: [0.1, 1, 10], creep: [0.0340785, 0.00622968, 0.136663]}' \
    --image control --prefix demo -o "$dir/count_hysteresis.h" >/dev/null || { echo 'not ok 1 - tables of a ceramic'; exit 1; }

# row NAME BITS LEVEL MACHINE SCRIPT PROCESSOR...: $program with the tables $tables.h
row() {
    n=$((n + 1))
    name=$1 bits=$2 level=$3 machine=$4 script=$5
    shift 5
    sources=$(echo "$rest" | sed "s/count_tick.c/$program.c/")
    # shellcheck disable=SC2086
    $CC "$@" $flags -DPZS_REAL_BITS="$bits" "$level" -DDEMO_TABLES="\"$tables.h\"" -nostartfiles -Lfirmware_demo/boards -T"firmware_demo/boards/$script.ld" \
        -Wl,--gc-sections $sources firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/tick.elf" &&
        gcc $flags -DPZS_REAL_BITS="$bits" -O2 -DDEMO_TABLES="\"$tables.h\"" $sources firmware_demo/boards/board_host.c -lm -o "$dir/tick" ||
        { echo "not ok $n - build"; return; }
    timeout 120 "${QEMU:-qemu-system-arm}" -M "$machine" -icount shift=10 -kernel "$dir/tick.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null 2>/dev/null | tr -d '\r' >"$dir/out"
    "$dir/tick" | grep '^bits' >"$dir/host"
    grep '^bits' "$dir/out" | cmp -s - "$dir/host" && same=ok || same='not ok'
    echo "$same $n - $name, $bits bits, $level: $(sed -n 's/^bits //p' "$dir/out"), bits of the host"
    sed -n 's/^count \([a-z_]*\) */#   \1: /p' "$dir/out"
    sed -n 's/^count all mean=\([0-9]*\) worst=\([0-9]*\)/\1 \2/p' "$dir/out" | awk '{
        printf "#   estimate for real parts, two cycles an instruction: %.0f ticks/s at 168 MHz, %.0f at 480 MHz (worst tick)\n", 168e6 / 2 / $2, 480e6 / 2 / $2 }'
}

# pair NAME BITS LEVEL MACHINE SCRIPT BLOCKS PROCESSOR...: a tick through pzs_loop against the calls made by hand
pair() {
    n=$((n + 1))
    name=$1 bits=$2 level=$3 machine=$4 script=$5 blocks=$6
    shift 6
    sources=$(echo "$rest" | sed 's/count_tick.c/count_loop.c/')
    # shellcheck disable=SC2086
    $CC "$@" $flags -DPZS_REAL_BITS="$bits" "$level" -DBLOCKS="$blocks" -DDEMO_TABLES='"count_tick.h"' -nostartfiles -Lfirmware_demo/boards \
        -T"firmware_demo/boards/$script.ld" -Wl,--gc-sections $sources firmware_demo/boards/start.c firmware_demo/boards/board_mps2.c -lm -o "$dir/loop.elf" ||
        { echo "not ok $n - build"; return; }
    timeout 120 "${QEMU:-qemu-system-arm}" -M "$machine" -icount shift=10 -kernel "$dir/loop.elf" -nographic -monitor none \
        -serial stdio -semihosting-config enable=on,target=native </dev/null 2>/dev/null | tr -d '\r' >"$dir/out"
    grep -q 'different=0' "$dir/out" && same=1 || same=0
    sed -n 's/^count hand=\([0-9]*\) loop=\([0-9]*\) hand_worst=\([0-9]*\) loop_worst=\([0-9]*\) gate=\([0-9]*\).*/\1 \2 \3 \4 \5/p' "$dir/out" |
        awk -v n=$n -v same=$same -v name="$name, $bits bits, $level, blocks: $blocks" '
            { guard = $2 - $1 - $5; good = same && guard <= 6000 && $5 <= 2500; seen = 1
              printf "%s %d - %s: pzs_loop %d instructions, by hand %d: last gate %d (target 2500), restore and scrub %d (target 6000), worst %d and %d, bits %s\n",
                     good ? "ok" : "not ok", n, name, $2, $1, $5, guard, $4, $3, same ? "the same" : "DIFFER" }
            END { if (!seen) print "not ok " n " - " name ": no count" }'
}

program=count_tick
tables=count_tick
row Cortex-M4F 32 -Os mps2-an386 mps2_an386 -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
row Cortex-M7 64 -O2 mps2-an500 mps2_an500 -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16
# The loop of a scene block by block.
program=count_blocks
tables=count_damped
row 'Cortex-M4F, damped' 32 -Os mps2-an386 mps2_an386 -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
row 'Cortex-M7, damped' 64 -O2 mps2-an500 mps2_an500 -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16
tables=count_hysteresis
row 'Cortex-M4F, compensated' 32 -Os mps2-an386 mps2_an386 -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
row 'Cortex-M7, compensated' 64 -O2 mps2-an500 mps2_an500 -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16
for blocks in 1 5; do
    pair Cortex-M4F 32 -Os mps2-an386 mps2_an386 $blocks -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
    pair Cortex-M7 64 -O2 mps2-an500 mps2_an500 $blocks -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16
done
echo "1..$n"
