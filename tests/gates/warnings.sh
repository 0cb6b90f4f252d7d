#!/bin/sh
# Every compiler, precision, tile and option: no warning.
. tests/gates/common.sh

all='-std=c99 -O2 -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wcast-align -Wcast-qual -Wpointer-arith -Wundef -Wvla -Wunused -Werror -pedantic -ffp-contract=off -fno-math-errno'

# check NAME COMPILER FLAGS...: all combinations in one result.
check() {
    name=$1 compiler=$2
    shift 2
    tap_needs "$compiler" "$name" || return 0
    : >"$scratch/found"
    for choice in "32 4 0" "32 8 0" "32 16 0" "64 4 0" "64 8 0" "64 16 0" "32 4 1" "64 4 1" "64 16 1"; do
        # shellcheck disable=SC2086
        set -- "$@" -- $choice
        flags='' bits='' tile='' nonlinear=''
        while [ "$1" != -- ]; do flags="$flags $1"; set -- "$@" "$1"; shift; done
        shift
        bits=$1 tile=$2 nonlinear=$3
        shift 3
        # shellcheck disable=SC2086
        (cd "$scratch" && "$compiler" $flags $all -I"$top/include" -I"$top/lib" -DPZS_REAL_BITS=$bits \
            -DPZS_TILE=$tile -DPZS_NONLINEAR=$nonlinear -c $(cd "$top" && sources $nonlinear | sed "s|^|$top/|")) \
            >>"$scratch/found" 2>&1 || echo "with $bits bits, tile $tile, nonlinear $nonlinear" >>"$scratch/found"
    done
    [ ! -s "$scratch/found" ]
    tap $? "$name"
}

top=$(pwd)
check 'gcc, host' "$CC"
check 'clang, host' "$CLANG"
# shellcheck disable=SC2086
{
    check 'gcc, Cortex-M4F' "$ARM_CC" $m4
    check 'gcc, Cortex-M7' "$ARM_CC" $m7
}
tap_end
