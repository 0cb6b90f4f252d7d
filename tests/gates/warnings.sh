#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every compiler, precision, tile and option: no warning.
. tests/gates/common.sh

# check NAME COMPILER TARGET-FLAGS PRECISIONS: all combinations in one result. The sources are compiled for the default tile
# and parsed for the other ones, whose libraries `make unit` compiles.
check() {
    tap_needs "$2" "$1" || return 0
    for bits in $4; do
        for choice in 0 1 modes; do
            compile "$2" "$3" "$choice" -DPZS_REAL_BITS="$bits" -DPZS_TILE=4 || echo "with $bits bits, options $choice"
        done
        for tile in 8 16; do
            # shellcheck disable=SC2046,SC2086
            "$2" ${3%%-fstack-usage*} $strict $include -fsyntax-only $(options 1) -DPZS_REAL_BITS="$bits" -DPZS_TILE="$tile" $(sources 1) ||
                echo "with $bits bits, tile $tile"
        done
    done >"$scratch/found" 2>&1
    [ ! -s "$scratch/found" ]
    tap $? "$1, $4 bits, tiles 4 8 16, options off and on"
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
        "$CLANG" -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -fsyntax-only -DPZS_NONLINEAR=1 -DPZS_MODES=1 \
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
