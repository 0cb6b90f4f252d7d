#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Start-up on each board under QEMU: memory and FPU ready, exit codes and faults reach the shell.
#   ARM_CC, QEMU, B (build directory), CI from the environment; TAP on stdout
: "${QEMU:=qemu-system-arm}" "${B:=build}"
. tests/gates/common.sh

# run MACHINE SCRIPT BOARD FLAGS PROGRAM: the exit code of one program
run() {
    # shellcheck disable=SC2086
    "$ARM_CC" -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic $4 -Ifirmware_demo/boards -DPROGRAM="$5" \
        firmware_demo/boards/start.c "firmware_demo/boards/$3.c" tests/target/start_program.c \
        -nostartfiles -Lfirmware_demo/boards -Tfirmware_demo/boards/"$2".ld -o "$scratch/program.elf" >&2 || return 125
    timeout 60 "$QEMU" -M "$1" -kernel "$scratch/program.elf" -nographic -monitor none -serial stdio \
        -semihosting-config enable=on,target=native </dev/null >"$scratch/found" 2>&1
}

# check NAME WANTED MACHINE SCRIPT BOARD FLAGS PROGRAM; WANTED "fault": any non-zero code but the program's own
check() {
    name="$3: $1"
    wanted=$2
    shift 2
    run "$@"
    code=$?
    if [ "$wanted" = fault ]; then
        [ "$code" -eq 70 ] || [ "$code" -ge 128 ] # 70: fault handler; 134: QEMU saw the processor lock up
    else
        [ "$code" -eq "$wanted" ]
    fi
    tap $? "$name (exit $code)"
}

board() {
    check 'data, bss, FPU and stack paint' 0 "$@" 1
    check 'exit code of main' 3 "$@" 2
    check 'a fault ends the run' 70 "$@" 3
    check 'a stack overflow ends the run' fault "$@" 4
    check 'a write right below the stack ends the run' 70 "$@" 5
    check 'a write far below the stack ends the run' 70 "$@" 6
}

if tap_needs "$ARM_CC" 'start-up' && tap_needs "$QEMU" 'start-up'; then
    board netduinoplus2 netduinoplus2 board_netduinoplus2 "$m4"
    board mps2-an386 mps2_an386 board_mps2 "$m4"
    board mps2-an500 mps2_an500 board_mps2 "$m7"
fi
tap_end
