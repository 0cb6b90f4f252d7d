#!/bin/sh
# What the library calls outside itself: a short list of leaf functions, and in float builds no double arithmetic.
. tests/gates/common.sh

leaf='memcpy memmove memset sqrt sqrtf fabs fabsf'
integer='__aeabi_uldivmod __aeabi_ldivmod __aeabi_lmul __aeabi_uidiv __aeabi_idiv __aeabi_uidivmod __aeabi_idivmod'

# check NAME COMPILER NM ALLOWED FLAGS...
check() {
    name=$1 compiler=$2 nm=$3 allowed=$4
    shift 4
    tap_needs "$compiler" "$name" || return 0
    rm -f "$scratch"/*.o
    for file in $(sources 0); do
        # shellcheck disable=SC2086
        if ! "$compiler" -std=c99 -O2 -fno-math-errno -ffp-contract=off $include "$@" -c "$file" \
            -o "$scratch/$(basename "$file" .c).o" 2>"$scratch/found"; then
            tap 1 "$name"
            return 0
        fi
    done
    "$nm" "$scratch"/*.o | awk 'NF == 3 && $2 ~ /[A-Z]/ { print $3 }' | sort -u >"$scratch/own"
    for file in "$scratch"/*.o; do
        "$nm" -u "$file" | awk -v file="$(basename "$file")" '{ print $2, file }'
    done | awk -v own="$scratch/own" -v allowed="$allowed" '
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
    "$NM" "$scratch"/*.o 2>/dev/null | awk '$2 ~ /^[bBdDC]$/ { print $3 " is writable data" }' >"$scratch/found"
    [ ! -s "$scratch/found" ]
    tap $? 'no writable data'
}

check 'host, float' "$CC" "$NM" "$leaf" -DPZS_REAL_BITS=32
check 'host, double' "$CC" "$NM" "$leaf" -DPZS_REAL_BITS=64
globals
# shellcheck disable=SC2086
check 'Cortex-M4F, float: no double arithmetic' "$ARM_CC" "$ARM_NM" "$leaf $integer" $m4 -DPZS_REAL_BITS=32
soft='__aeabi_dadd __aeabi_dsub __aeabi_drsub __aeabi_dmul __aeabi_ddiv __aeabi_dcmpeq __aeabi_dcmplt __aeabi_dcmple
    __aeabi_dcmpge __aeabi_dcmpgt __aeabi_dcmpun __aeabi_i2d __aeabi_ui2d __aeabi_d2iz __aeabi_d2uiz __aeabi_ul2d __aeabi_l2d'
# shellcheck disable=SC2086
check 'Cortex-M4F, double by software' "$ARM_CC" "$ARM_NM" "$leaf $integer $soft" $m4 -DPZS_REAL_BITS=64
# shellcheck disable=SC2086
check 'Cortex-M7, double' "$ARM_CC" "$ARM_NM" "$leaf $integer" $m7 -DPZS_REAL_BITS=64
tap_end
