#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# What the library calls outside itself: a short list of leaf functions, and in float builds no double arithmetic.
# What an image holds: of the nonlinear path nothing in a linear one, of its options nothing that is not attached.
. tests/gates/common.sh

leaf='memcpy memmove memset sqrt sqrtf fabs fabsf'
integer='__aeabi_uldivmod __aeabi_ldivmod __aeabi_lmul __aeabi_uidiv __aeabi_idiv __aeabi_uidivmod __aeabi_idivmod'

# check NAME COMPILER NM ALLOWED TARGET_FLAGS BITS: the linear library, with modes, and with all options
check() {
    check_one 0 "$@"
    what=$1
    shift
    check_one modes "$what, modes" "$@"
    check_one 1 "$what, nonlinear" "$@"
}

check_one() {
    choice=$1
    shift
    name=$1 nm=$3 allowed=$4
    tap_needs "$2" "$name" || return 0
    if ! compile "$2" "$5" "$choice" -DPZS_REAL_BITS="$6" 2>"$scratch/found"; then
        tap 1 "$name"
        return 0
    fi
    xargs "$nm" <"$scratch/objects" | awk 'NF == 3 && $2 ~ /[A-Z]/ { print $3 }' | sort -u >"$scratch/own"
    while read -r file; do
        "$nm" -u "$file" | awk -v file="$(basename "${file%-*}")" '{ print $2, file }'
    done <"$scratch/objects" | awk -v own="$scratch/own" -v allowed="$allowed" '
        BEGIN {
            while ((getline line < own) > 0) known[line] = 1
            n = split(allowed, word, " ")
            for (i = 1; i <= n; i++) known[word[i]] = 1
        }
        !($1 in known) { print $2 " calls " $1 }' >"$scratch/found"
    [ ! -s "$scratch/found" ]
    tap $? "$name"
}

# Writable data in the library would be a hidden global.
globals() {
    xargs "$NM" <"$scratch/objects" 2>/dev/null | awk '$2 ~ /^[bBdDC]$/ { print $3 " is writable data" }' >"$scratch/found"
    [ ! -s "$scratch/found" ]
    tap $? 'no writable data'
}

# Names that the objects $2... of the last check define, under $scratch/$1.
defined() {
    list=$1
    shift
    for object in "$@"; do grep "/$object-" "$scratch/objects"; done | xargs "$ARM_NM" | awk 'NF == 3 && $2 ~ /[A-Z]/ { print $3 }' | sort >"$scratch/$list"
}

# holds IMAGE LIST: how many names of a list are in an image of the demonstration
holds() {
    "$ARM_NM" "${B:-build}/firmware/$1.elf" | awk 'NF == 3 { print $3 }' | sort | comm -12 - "$scratch/$2" | wc -l
}

# The images of the demonstration, after a nonlinear check for the target has left its objects.
images() {
    linear='mps2-an386-control mps2-an386-linear5 mps2-an500-linear'
    nonlinear='mps2-an386-hemisphere4 mps2-an500-hemisphere4 mps2-an500-reshape'
    tap_needs "$ARM_CC" 'images' || return 0
    {
        echo "${B:-build}/firmware/m4-32/libpzs.a"
        for image in $linear $nonlinear; do echo "${B:-build}/firmware/$image.elf"; done
    } | xargs "${MAKE:-make}" --no-print-directory -s "B=${B:-build}" >"$scratch/found" 2>&1 || { tap 1 'images build'; return 0; }
    defined path nonlinear influence_at shell_at
    defined options face follower contact contact_check electric
    for image in $linear; do
        echo "$(holds "$image" path) of the path, $(holds "$image" options) of its options" >"$scratch/found"
        [ "$(holds "$image" path)" -eq 0 ] && [ "$(holds "$image" options)" -eq 0 ]
        tap $? "$image holds nothing of the nonlinear path"
    done
    for image in $nonlinear; do
        echo "$(holds "$image" path) of the path, $(holds "$image" options) of its options" >"$scratch/found"
        [ "$(holds "$image" path)" -gt 0 ] && [ "$(holds "$image" options)" -eq 0 ]
        tap $? "$image holds the path, and no follower load or contact"
    done
}

# blocks NAME LIST FUNCTION...: a control image of a list of blocks has these functions of the options, and no others.
blocks() {
    name=$1
    list=$2
    shift 2
    tap_needs "$ARM_CC" "$name" || return 0
    cat >"$scratch/image.c" <<EOT
#include "pzs.h"
extern const pzs_problem problem;
extern const void *const tables;
pzs_loop loop;
int main(void)
{
    static double work[100];
    const pzs_block blocks[] = {$list};
    (void)pzs_loop_init(&loop, blocks, sizeof blocks / sizeof *blocks, 0, work, sizeof work);
    return (int)pzs_loop_tick(&loop, (const pzs_real *)work, 0);
}
EOT
    # shellcheck disable=SC2086
    "$ARM_CC" -std=c99 -Os -ffunction-sections -fdata-sections $m4 $include -DPZS_REAL_BITS=32 -nostartfiles -Wl,--gc-sections \
        -Wl,--entry=main -Wl,--defsym=problem=0 -Wl,--defsym=tables=0 "$scratch/image.c" "${B:-build}/firmware/m4-32/libpzs.a" -lm \
        -o "$scratch/image.elf" 2>"$scratch/found" || { tap 1 "$name"; return 0; }
    "$ARM_NM" "$scratch/image.elf" | awk '{ print $NF }' |
        grep -x 'pzs_optimise_rows\|pzs_estimate_tick\|pzs_feed_forward\|pzs_quantise\|pzs_fault_detector_tick' | sort >"$scratch/found"
    printf '%s\n' "$@" | sed '/^$/d' | sort | cmp -s - "$scratch/found"
    tap $? "$name: ${*:-nothing}"
}

check 'host, float' "$CC" "$NM" "$leaf" "$on_host" 32
check 'host, double' "$CC" "$NM" "$leaf" "$on_host" 64
globals
check 'Cortex-M4F, float: no double arithmetic' "$ARM_CC" "$ARM_NM" "$leaf $integer" "$on_m4" 32
soft='__aeabi_dadd __aeabi_dsub __aeabi_drsub __aeabi_dmul __aeabi_ddiv __aeabi_dcmpeq __aeabi_dcmplt __aeabi_dcmple
    __aeabi_dcmpge __aeabi_dcmpgt __aeabi_dcmpun __aeabi_i2d __aeabi_ui2d __aeabi_d2iz __aeabi_d2uiz __aeabi_ul2d __aeabi_l2d'
check 'Cortex-M4F, double by software' "$ARM_CC" "$ARM_NM" "$leaf $integer $soft" "$on_m4" 64
check 'Cortex-M7, double' "$ARM_CC" "$ARM_NM" "$leaf $integer" "$on_m7" 64
images
step='{&pzs_step_block, &problem}'
blocks "the step alone holds of the options" "$step"
blocks 'with an estimator' "{&pzs_estimator_block, &tables}, $step" pzs_estimate_tick
blocks 'with known loads' "{&pzs_feed_forward_block, &tables}, $step" pzs_feed_forward
blocks 'with amplifiers' "$step, {&pzs_amplifier_block, &tables}" pzs_quantise
blocks 'with a fault detector' "$step, {&pzs_fault_detector_block, &tables}" pzs_fault_detector_tick
tap_end
