# SPDX-License-Identifier: BSD-2-Clause
# TAP for the gates: sourced by each, run from the top of the project.
#   CC, CLANG, ARM_CC, ARM_NM, NM   compilers and their nm
#   B                               build folder, in which compile keeps objects
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

# Definitions of the options $1: 0 none, 1 all, modes PZS_MODES alone.
options() {
    case $1 in
    0) echo '-DPZS_NONLINEAR=0 -DPZS_MODES=0' ;;
    1) echo '-DPZS_NONLINEAR=1 -DPZS_MODES=1' ;;
    modes) echo '-DPZS_NONLINEAR=0 -DPZS_MODES=1' ;;
    esac
}

# Library sources with the options $1.
sources() {
    for file in lib/*/*.c; do
        case $file in
        lib/nonlinear/*) [ "$1" = 1 ] && echo "$file" ;;
        lib/modes/*) [ "$1" != 0 ] && echo "$file" ;;
        *) echo "$file" ;;
        esac
    done
}

# Every warning that the library is compiled with, and flags with which all gates share its objects.
strict='-std=c99 -O2 -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wcast-align -Wcast-qual -Wpointer-arith -Wundef -Wvla -Wunused -Werror -pedantic -ffp-contract=off -fno-math-errno -ffunction-sections'
# Without position independence a table of functions stays in read-only data.
on_host='-fno-pie'
# gcc writes the stack of each function and the call graph beside an object (NAME.ci).
on_m4="$m4 -fstack-usage -fcallgraph-info=su"
on_m7="$m7 -fstack-usage -fcallgraph-info=su"

# compile COMPILER TARGET_FLAGS OPTIONS DEFINITIONS...: the objects of the library, listed in $scratch/objects. They are
# kept in $B/gates under a checksum of the compiler, its flags and the text that the preprocessor makes of the source, so
# that no gate compiles again what another one has compiled, or what a definition does not change. The list of objects is
# kept under a checksum of the flags and of all sources, so that the preprocessor runs once for each choice of flags.
compile() {
    compiler=$1 target=$2 choice=$3
    shift 3
    store=${B:-build}/gates
    mkdir -p "$store"
    version=$("$compiler" -dumpfullversion 2>/dev/null || "$compiler" --version)
    everything=$({ echo "$compiler $version $target $strict $choice $*"; cat lib/*/*.[ch] include/*.h; } | md5sum)
    list=$store/${everything%% *}.list
    if [ -f "$list" ]; then
        cp "$list" "$scratch/objects"
        return 0
    fi
    : >"$scratch/objects"
    for file in $(sources "$choice"); do
        # shellcheck disable=SC2086
        text=$({ echo "$compiler $version $target $strict"; "$compiler" $target $strict $include $(options "$choice") "$@" -E "$file"; } | md5sum)
        object=$store/$(basename "$file" .c)-${text%% *}
        if [ ! -f "$object.o" ]; then
            # A compiler cache does not give the call graph back.
            # shellcheck disable=SC2086
            CCACHE_DISABLE=1 "$compiler" $target $strict $include $(options "$choice") "$@" -c "$file" -o "$object.$$.o" || return 1
            [ ! -f "$object.$$.ci" ] || mv "$object.$$.ci" "$object.ci"
            rm -f "$object.$$.su"
            mv "$object.$$.o" "$object.o"
        fi
        echo "$object.o" >>"$scratch/objects"
    done
    cp "$scratch/objects" "$list.$$" && mv "$list.$$" "$list"
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
