#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every compiler, precision, tile and option: no warning.
. tests/gates/common.sh

all='-std=c99 -O2 -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wcast-align -Wcast-qual -Wpointer-arith -Wundef -Wvla -Wunused -Werror -pedantic -ffp-contract=off -fno-math-errno'

# compile COMPILER TARGET-FLAGS BITS TILE NONLINEAR: objects go into the scratch directory.
compile() {
    # shellcheck disable=SC2086,SC2046
    (cd "$scratch" && "$1" $2 $all -I"$top/include" -DPZS_REAL_BITS="$3" -DPZS_TILE="$4" \
        -DPZS_NONLINEAR="$5" -c $(cd "$top" && sources "$5" | sed "s|^|$top/|"))
}

# check NAME COMPILER TARGET-FLAGS PRECISIONS: all combinations in one result.
check() {
    tap_needs "$2" "$1" || return 0
    for bits in $4; do
        for choice in '4 0' '8 0' '16 0' '4 1'; do
            compile "$2" "$3" "$bits" "${choice% *}" "${choice#* }" ||
                echo "with $bits bits, tile ${choice% *}, nonlinear ${choice#* }"
        done
    done >"$scratch/found" 2>&1
    [ ! -s "$scratch/found" ]
    tap $? "$1, $4 bits, tiles 4 8 16, nonlinear off and on"
}

# wide NAME COMPILER: the innermost loop of the factorisation for AVX2, where the compiler makes programs for x86-64.
wide() {
    tap_needs "$2" "$1" || return 0
    case $("$2" -dumpmachine) in
    x86_64-*) compile "$2" -DPZS_WIDE=1 64 4 0 >"$scratch/found" 2>&1 ;;
    esac
    tap $? "$1, 64 bits, PZS_WIDE"
}

top=$(pwd)
check 'gcc, host' "$CC" '' '32 64'
check 'clang, host' "$CLANG" '' '32 64'
wide 'gcc, host' "$CC"
wide 'clang, host' "$CLANG"
check 'gcc, Cortex-M4F' "$ARM_CC" "$m4" 32
check 'gcc, Cortex-M7' "$ARM_CC" "$m7" '32 64'
tap_end
