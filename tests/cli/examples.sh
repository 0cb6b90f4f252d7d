#!/bin/sh
# Every example of `pzs --help`, of the help of each command and of README.md runs: the commands and the C program are taken
# from the texts, so that a new example is tested as soon as it is written.
#   EXAMPLE_SECONDS  time limit of one example
set -u
cd "$(dirname "$0")/../.."
B=${B:-build}
PZS=${PZS:-$B/pzs}
seconds=${EXAMPLE_SECONDS:-300}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
n=0
failed=0

# check NAME STATUS: one TAP line
check() {
    n=$((n + 1))
    if [ "$2" -eq 0 ]; then
        echo "ok $n - $1"
    else
        failed=$((failed + 1))
        echo "not ok $n - $1"
        tail -n 5 "$dir/said" 2>/dev/null | sed 's/^/# /'
    fi
}

# Lines of a help text below `Examples:` (or `Example:`) that call pzs.
help_examples() {
    "$PZS" --help >"$dir/help"
    for command in $(sed -n 's/^  pzs \([a-z]*\) .*/\1/p' "$dir/help" | sort -u); do
        "$PZS" help "$command" >>"$dir/help"
    done
    awk '/^Examples?:/ {on = 1; next} /^[^ ]/ {on = 0} on && /^  pzs /' "$dir/help" | sed 's/^  //'
}

# Shell commands of the README: indented lines without their comments, and words between back quotes. A command that is
# only mentioned by its name has to have a help.
readme_commands() {
    awk '/^```/ {code = !code; next} !code' README.md >"$dir/prose"
    sed -n 's/^    \(\(build\/[a-z]*\|make\) .*\)/\1/p' "$dir/prose" | sed 's/  *#.*//'
    grep -o '`\(build/\|make \|pzs \)[^`]*`' "$dir/prose" | tr -d '`' | sed 's/^\(build\/\)\{0,1\}pzs \([a-z]*\)$/pzs help \2/'
}

# Programs that a firmware under QEMU needs.
has_qemu() {
    command -v qemu-system-arm >/dev/null 2>&1 && command -v arm-none-eabi-gcc >/dev/null 2>&1
}

# run_example COMMAND: in a folder of its own, where build/pzs and pzs are the program and my.yaml is a scene
run_example() {
    case $1 in
    *--device\ netduinoplus2*|*--device\ mps2*)
        if ! has_qemu; then
            n=$((n + 1))
            echo "ok $n - $1 # SKIP no QEMU or no compiler for it"
            return
        fi ;;
    esac
    (cd "$dir/here" && PATH="$dir/here/build:$PATH" timeout "$seconds" sh -c "$1") >"$dir/said" 2>&1 </dev/null
    check "$1" $?
}

# The programs and make targets that the README names exist.
run_other() {
    case $1 in
    make\ *) "${MAKE:-make}" -n B="$B" ${1#make } >"$dir/said" 2>&1 ;;
    *) program=${1%% *}
       "${MAKE:-make}" -n B="$B" "$B/${program#build/}" >"$dir/said" 2>&1 ;;
    esac
    check "make knows: $1" $?
}

mkdir -p "$dir/here/build"
case $PZS in
/*) ln -s "$PZS" "$dir/here/build/pzs" ;;
*) ln -s "$PWD/$PZS" "$dir/here/build/pzs" ;;
esac
cp host_tools/scenes/plate-50-patches.yaml "$dir/here/my.yaml"

help_examples >"$dir/helped"
readme_commands >"$dir/readme"
[ "$(wc -l <"$dir/helped")" -ge 6 ]; check 'the help has examples' $?
[ "$(grep -c 'pzs ' "$dir/readme")" -ge 6 ]; check 'README.md has examples' $?
sed 's/^build\///' "$dir/helped" "$dir/readme" | grep '^pzs ' | sort -u >"$dir/commands"
while read -r command; do
    run_example "$command"
done <"$dir/commands"
grep '^make \|^build/test/' "$dir/readme" | sort -u >"$dir/others"
while read -r command; do
    run_other "$command"
done <"$dir/others"

# The C programs of the README, each with the tables that the comment behind its #include names. They stay inside the limits.
awk -v dir="$dir" '/^```c/ {file = dir "/example" ++k ".c"; next} /^```/ {file = ""} file {print > file}' README.md
cat >"$dir/io.c" <<'EOT'
#include <math.h>
#include <stdlib.h>
#include "plate.h"
static int ticks;
void read_target(pzs_real *wanted);
void read_sensors(pzs_real *measured);
void write_amplifiers(const pzs_real *voltage);
void read_target(pzs_real *wanted) { for (int i = 0; i < PLATE_OUTPUTS; i++) wanted[i] = plate_target[i]; }
void read_sensors(pzs_real *measured) { for (int i = 0; i < PLATE_OUTPUTS; i++) measured[i] = i % 7 ? 0 : (pzs_real)NAN; }
void write_amplifiers(const pzs_real *voltage)
{
    for (int k = 0; k < PLATE_INPUTS; k++)
        if (!(voltage[k] >= plate_lower[k] && voltage[k] <= plate_upper[k])) exit(3);
    if (++ticks == 50) exit(0);
}
EOT
for example in "$dir"/example*.c; do
    tables=$(sed -n 's/.*\/\* *\(pzs tables [^*]*[^* ]\) *\*\/.*/\1/p' "$example" | head -n 1)
    (cd "$dir" && PATH="$dir/here/build:$PATH" sh -c "${tables:-false}") >"$dir/said" 2>&1
    check "tables of the README's C program: $tables" $?
    [ "$(wc -l <"$example")" -le 30 ] &&
        ${CC:-gcc} -std=c99 -Wall -Wextra -Iinclude -I"$dir" -DPZS_REAL_BITS=32 "$example" "$dir/io.c" lib/*/*.c -lm -o "$dir/example" >"$dir/said" 2>&1 &&
        "$dir/example"
    check "the README's C program, under 30 lines, compiles and runs" $?
done
echo "1..$n"
[ "$failed" -eq 0 ]
