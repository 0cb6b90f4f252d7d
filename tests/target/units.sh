#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The unit tests that need nothing but the library, on the target under QEMU: the same files as on the host.
#   ARM_CC, QEMU, B, CI from the environment; TAP on stdout
: "${QEMU:=qemu-system-arm}" "${B:=build}"
. tests/gates/common.sh

memory='-Wl,--defsym=__flash=0,--defsym=__flash_size=0x200000,--defsym=__ram=0x20000000,--defsym=__ram_size=0x400000'

# build TEST PROCESSOR FLAGS BITS: random problems are fewer here than on the host
build() {
    # shellcheck disable=SC2046,SC2086
    compile "$ARM_CC" "$3 -fstack-usage -fcallgraph-info=su" 0 -DPZS_REAL_BITS="$4" &&
        "$ARM_CC" --specs=picolibc.specs --oslib=semihost --crt0=hosted $memory,--defsym=__stack_size=0x10000 \
            $3 -std=c99 -O2 -fno-math-errno -ffp-contract=off -DPZS_REAL_BITS="$4" -DRANDOM_PROBLEMS=60 -DLONG_TICKS=2000 -DMOST=200u \
            -DWALK_TICKS=20000 -DSEEDS=2u $include \
            -I"$B/cmocka-arm/source/include" "tests/unit/test_$1.c" tests/rigs/testdata.c $(cat "$scratch/objects") "$B/cmocka-arm/$2/cmocka.o" \
            -lm -o "$scratch/$1.elf"
}

# run TEST NAME MACHINE: the test's own lines as TAP, and one for how it ended
run() {
    timeout 300 "$QEMU" -M "$3" -kernel "$scratch/$1.elf" -nographic -monitor none -serial none \
        -semihosting-config "enable=on,target=native,arg=test" </dev/null >"$scratch/found" 2>&1
    code=$?
    sed -n 's/^\[ *OK \] //p' "$scratch/found" >"$scratch/passed"
    while read -r law; do tap 0 "$2: $law"; done <"$scratch/passed"
    [ "$code" -eq 0 ] && [ -s "$scratch/passed" ]
    tap $? "$2 ends with exit 0"
}

# check TEST: on both processors
check() {
    [ -f "tests/unit/test_$1.c" ] || return 0
    if build "$1" m4 "$m4" 32 2>"$scratch/found"; then
        run "$1" "$1 on Cortex-M4F, float" mps2-an386
    else
        tap 1 "$1 builds for Cortex-M4F, float"
    fi
    if build "$1" m7 "$m7" 64 2>"$scratch/found"; then
        run "$1" "$1 on Cortex-M7, double" mps2-an500
    else
        tap 1 "$1 builds for Cortex-M7, double"
    fi
}

if tap_needs "$ARM_CC" 'unit tests' && tap_needs "$QEMU" 'unit tests'; then
    if sh tests/target/cmocka.sh >"$scratch/found" 2>&1; then
        check linalg
        check control
        check sparse
        check tick
        check faults
        check estimate
        check loop_blocks
    else
        tap 1 'CMocka builds for the target'
    fi
fi
tap_end
