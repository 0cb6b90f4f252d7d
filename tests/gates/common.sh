# SPDX-License-Identifier: BSD-2-Clause
# TAP for the gates: sourced by each, run from the top of the project.
#   CC, CLANG, ARM_CC, ARM_NM, NM   compilers and their nm
#   CI                              if set, a missing tool fails instead of being skipped
set -u
: "${CC:=gcc}" "${CLANG:=clang}" "${NM:=nm}" "${ARM_CC:=arm-none-eabi-gcc}" "${ARM_NM:=arm-none-eabi-nm}"
tap_count=0
tap_failed=0
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT

m4='-mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16'
m7='-mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16'
include='-Iinclude'

# Library sources with PZS_NONLINEAR $1 (0 or 1).
sources() {
    for file in lib/*/*.c; do
        case $file in
        lib/nonlinear/*) [ "$1" = 1 ] && echo "$file" ;;
        *) echo "$file" ;;
        esac
    done
}

# Result $1 (0 is good) of a check named $2; what it found stands in $scratch/found.
tap() {
    tap_count=$((tap_count + 1))
    if [ "$1" -eq 0 ]; then
        echo "ok $tap_count - $2"
    else
        tap_failed=$((tap_failed + 1))
        echo "not ok $tap_count - $2"
        if [ -s "$scratch/found" ]; then sed 's/^/# /' "$scratch/found"; fi
    fi
}

# The check named $2 needs the tool $1. True if it is there; else skipped, or failed in CI.
tap_needs() {
    if command -v "$1" >/dev/null 2>&1; then return 0; fi
    if [ -n "${CI:-}" ]; then
        echo "$1 is missing" >"$scratch/found"
        tap 1 "$2"
    else
        tap_count=$((tap_count + 1))
        echo "ok $tap_count - $2 # SKIP $1 is missing"
    fi
    return 1
}

tap_end() {
    echo "1..$tap_count"
    [ "$tap_failed" -eq 0 ]
}
