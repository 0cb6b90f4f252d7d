#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every compiler, precision, tile and option: no warning.
. tests/gates/common.sh

# check NAME COMPILER TARGET-FLAGS PRECISIONS: all combinations in one result.
check() {
    tap_needs "$2" "$1" || return 0
    for bits in $4; do
        for choice in '4 0' '8 0' '16 0' '4 1'; do
            compile "$2" "$3" "${choice#* }" -DPZS_REAL_BITS="$bits" -DPZS_TILE="${choice% *}" ||
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
    x86_64-*) compile "$2" "$on_host" 0 -DPZS_REAL_BITS=64 -DPZS_WIDE=1 >"$scratch/found" 2>&1 ;;
    esac
    tap $? "$1, 64 bits, PZS_WIDE"
}

# The host tool, which gcc builds, with clang; the Makefile gives it its folders.
if tap_needs "$CLANG" 'clang, host tool'; then
    # shellcheck disable=SC2016
    ls host_tools/*/*.c | CLANG=$CLANG xargs -n 12 -P 2 sh -c 'for file; do
        "$CLANG" -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -fsyntax-only -DPZS_NONLINEAR=1 \
            -DSCENE_PLACE=\"\" -DSCENE_FOLDER=\"\" -DSOURCE_FOLDER=\"\" -Iinclude "$file"
    done' each >"$scratch/found" 2>&1
    [ ! -s "$scratch/found" ]
    tap $? 'clang, host tool'
fi
check 'gcc, host' "$CC" "$on_host" '32 64'
check 'clang, host' "$CLANG" "$on_host" '32 64'
wide 'gcc, host' "$CC"
wide 'clang, host' "$CLANG"
check 'gcc, Cortex-M4F' "$ARM_CC" "$on_m4" 32
check 'gcc, Cortex-M7' "$ARM_CC" "$on_m7" '32 64'
tap_end
