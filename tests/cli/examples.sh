#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every example of `pzs --help`, of the help of each command, of README.md, of the guide (host_tools/README.md) and of the
# reference (host_tools/REFERENCE.md) runs. The commands and programs are taken from the texts, so that a new example is
# tested as soon as it is written.
#   EXAMPLE_SECONDS  time limit of one example
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh
seconds=${EXAMPLE_SECONDS:-300}
guide=host_tools/README.md
reference=host_tools/REFERENCE.md

# Lines of a help text below `Examples:` (or `Example:`) that call pzs.
help_examples() {
    "$PZS" --help >"$dir/help"
    for command in $(sed -n 's/^  pzs \([a-z]*\) .*/\1/p' "$dir/help" | sort -u); do
        "$PZS" help "$command" >>"$dir/help"
    done
    awk '/^Examples?:/ {on = 1; next} /^[^ ]/ {on = 0} on && /^  pzs /' "$dir/help" | sed 's/^  //'
}

# Indented lines of a text that are shell commands, without their comments, in the order of the text.
shell_lines() {
    awk '/^```/ {code = !code; next} !code' "$1" |
        sed -n 's/^    \(\(build\/[a-z]*\|make\|gcc\|g++\|gmsh\|cp\|sh\|\.\/[a-z-]*\)\( .*\)\{0,1\}\)$/\1/p' | sed 's/  *# .*//'
}

# Commands of a text between back quotes. One that is only mentioned by its name has to have a help.
quoted_commands() {
    awk '/^```/ {code = !code; next} !code' "$1" |
        grep -o '`\(build/\|make \|pzs \|sh tests/\)[^`]*`' | tr -d '`' | sed 's/^\(build\/\)\{0,1\}pzs \([a-z]*\)$/pzs help \2/'
}

# named_blocks TEXT FOLDER: each block of code below a line <!-- file: NAME --> becomes that file.
named_blocks() {
    awk -v folder="$2" '
        /^<!-- file: / {name = $3; next}
        /^```/ {file = file == "" && name != "" ? folder "/" name : ""; name = ""; next}
        file != "" {print > file}' "$1"
}

# Programs that a firmware under QEMU needs.
has_qemu() {
    command -v qemu-system-arm >/dev/null 2>&1 && command -v arm-none-eabi-gcc >/dev/null 2>&1
}

# The library for a Cortex-M4F is compiled once: the Makefiles of the firmware examples link it in place of the sources that
# they name. tests/target/examples.sh runs these Makefiles as they stand.
arm=$B/firmware/m4-32/libpzs.a
boards=$PWD/firmware_demo/boards
! has_qemu || "${MAKE:-make}" -s B="$B" "$arm" >"$dir/said" 2>&1
arm_sources="$(realpath "$arm" 2>/dev/null)\\ $boards/start.c\\ $boards/board_mps2.c"

# run_example FOLDER COMMAND: in a folder where build/pzs and pzs are the program
run_example() {
    case $2 in
    *--device\ netduinoplus2*|*--device\ mps2*|make\ -C*)
        if ! has_qemu; then
            n=$((n + 1))
            echo "ok $n - $2 # SKIP no QEMU or no compiler for it"
            return
        fi ;;
    esac
    case $2 in
    gmsh\ *|*disc-plate*)
        if ! command -v gmsh >/dev/null 2>&1; then
            n=$((n + 1))
            echo "ok $n - $2 # SKIP no gmsh"
            return
        fi ;;
    esac
    case $2 in
    make\ -C*) flags=SOURCES=$arm_sources ;;
    *) flags= ;;
    esac
    (unset PZS B; cd "$1" && MAKEFLAGS=$flags PATH="$1/build:$PATH" timeout "$seconds" sh -c "$2") >"$dir/said" 2>&1 </dev/null
    check "$2" $?
}

# The programs, scripts and make targets that the texts name exist.
run_other() {
    case $1 in
    make\ *) "${MAKE:-make}" -n B="$B" ${1#make } >"$dir/said" 2>&1 ;;
    sh\ *) file=${1#sh }
       [ -f "${file%% *}" ] ;;
    *) built=${1%% *}
       "${MAKE:-make}" -n B="$B" "$B/${built#build/}" >"$dir/said" 2>&1 ;;
    esac
    check "exists: $1" $?
}

case $PZS in
/*) program=$PZS ;;
*) program=$PWD/$PZS ;;
esac
mkdir -p "$dir/here/build" "$dir/guide/build"
ln -s "$program" "$dir/here/build/pzs"
ln -s "$program" "$dir/guide/build/pzs"
for folder in include lib firmware_demo; do
    ln -s "$PWD/$folder" "$dir/guide/$folder"
done
case $B in
/*) ln -s "$B/32" "$dir/guide/build/32" ;;
*) ln -s "$PWD/$B/32" "$dir/guide/build/32" ;;
esac
cp host_tools/scenes/plate-50-patches.yaml "$dir/here/my.yaml"
"$PZS" new poke-voltages >"$dir/here/voltages.csv"; "$PZS" new poke-shapes >"$dir/here/shapes.csv"

# ---- help and README.md ---------------------------------------------------

named_blocks README.md "$dir/here"
help_examples >"$dir/helped"
{
    shell_lines README.md
    quoted_commands README.md
    for scene in "$dir"/here/[!m]*.yaml; do
        printf 'pzs %s\n' "check ${scene##*/}" "shape ${scene##*/}"
    done
} >"$dir/readme"
[ "$(wc -l <"$dir/helped")" -ge 6 ]; check 'the help has examples' $?
[ "$(grep -c 'pzs ' "$dir/readme")" -ge 6 ]; check 'README.md has examples' $?
[ "$(wc -l <README.md)" -le 150 ]; check 'README.md has at most 150 lines' $?
sed 's/^build\///' "$dir/helped" "$dir/readme" | grep '^pzs ' | sort -u >"$dir/commands"
while read -r command; do
    run_example "$dir/here" "$command"
done <"$dir/commands"

# ---- the guide: its lines in their order, in one folder ------------------

named_blocks "$guide" "$dir/guide"
for text in "$guide" "$reference"; do shell_lines "$text"; done | grep -v '^make [^-]' >"$dir/guided"
[ "$(wc -l <"$dir/guided")" -ge 20 ]; check 'the guide has examples' $?
while read -r command; do
    # What was run above is not run again.
    grep -qxF -- "${command#build/}" "$dir/commands" && ! echo "$command" | grep -q '>\| -o ' && continue
    run_example "$dir/guide" "$command"
done <"$dir/guided"

# ---- programs and targets that any README names --------------------------

{
    grep '^make \|^sh \|^build/test/' "$dir/readme"
    for text in "$guide" "$reference"; do
        shell_lines "$text" | grep '^make [^-]'
        quoted_commands "$text"
    done
    for text in tests/bench/README.md CONTRIBUTING.md; do
        [ ! -f "$text" ] || { shell_lines "$text"; quoted_commands "$text"; }
    done
} | grep '^make [^-]\|^sh \|^build/test/' | sort -u >"$dir/others"
while read -r command; do
    run_other "$command"
done <"$dir/others"
# Commands of pzs in other texts: the command and its scene exist.
: >"$dir/checked"
for text in "$guide" "$reference" tests/bench/README.md CONTRIBUTING.md; do
    [ ! -f "$text" ] || quoted_commands "$text"
done | sed 's/^build\///' | grep '^pzs ' | sort -u >"$dir/mentioned"
while read -r command; do
    # shellcheck disable=SC2086
    set -- $command
    case $2 in
    check|solve|shape|modes|tables|simulate)
        # One check of each scene is enough.
        grep -qxF -- "$3" "$dir/checked" || { "$program" check "$3" >"$dir/said" 2>&1 && echo "$3" >>"$dir/checked"; } ;;
    help) "$program" help "${3:-}" >"$dir/said" 2>&1 || "$program" help >"$dir/said" 2>&1 ;;
    *) "$program" help "$2" >"$dir/said" 2>&1 ;;
    esac
    check "exists: $command" $?
done <"$dir/mentioned"
# Links between the texts.
for text in README.md CHANGELOG.md CONTRIBUTING.md "$guide" "$reference" tests/bench/README.md lib/model/THEORY.md; do
    [ -f "$text" ] || continue
    grep -o '](\([^)#:]*\)[^):]*)' "$text" | sed 's/](\([^)#]*\).*/\1/' | while read -r link; do
        [ -e "$(dirname "$text")/$link" ] || echo "$text: $link"
    done
done >"$dir/said"
[ ! -s "$dir/said" ]; check 'links between the texts' $?

# ---- the C program of README.md --------------------------------------------

# Each with the tables that the comment behind its #include names. They stay inside the limits.
awk -v dir="$dir" '/^```c$/ {file = dir "/example" ++k ".c"; next} /^```/ {file = ""} file {print > file}' README.md
cat >"$dir/io.c" <<'EOT'
#include <math.h>
#include <stdlib.h>
#include "plate.h"
static int ticks;
void read_target(pzs_real *wanted);
void read_sensors(pzs_real *measured);
void write_amplifiers(const pzs_real *voltage);
void read_target(pzs_real *wanted) { for (int i = 0; i < PLATE_OUTPUTS; i++) wanted[i] = plate_target[i]; }
void read_sensors(pzs_real *measured) { for (int i = 0; i < PLATE_READINGS; i++) measured[i] = i % 7 ? 0 : (pzs_real)NAN; }
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
        ${CC:-gcc} -std=c99 -Wall -Wextra -Werror -Iinclude -I"$dir" -DPZS_REAL_BITS=32 "$example" "$dir/io.c" "$B/32/libpiezoshape.a" -lm -o "$dir/example" >"$dir/said" 2>&1 &&
        "$dir/example"
    check "the README's C program, under 30 lines, compiles and runs" $?
done
echo "1..$n"
[ "$failed" -eq 0 ]
