#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The architecture: a room includes only the rooms that its README.md names after "May include:", and the include
# graph of the files has no circle. gcc -MM lists what each file includes, directly or not.
. tests/gates/common.sh

rooms=$(git ls-files --cached --others --exclude-standard '*.[ch]' 2>/dev/null | sed 's|/[^/]*$||' | sort -u)

# Lines "FILE INCLUDED" for the file $1 with PZS_NONLINEAR $2; generated tables include pzs.h alone.
includes() {
    "$CC" -std=c99 -MM -MG -Iinclude -DDEMO_TABLES='"pzs.h"' -DPZS_NONLINEAR="$2" "$1" 2>/dev/null |
        tr -d '\\' | tr ' ' '\n' | grep '\.h$' | xargs -r realpath -e -q --relative-to=. |
        sed "s|^|$1 |" | grep -v "^$1 $1\$"
}

# Lines "FILE INCLUDED" of direct includes between the project's own files.
direct() {
    sed -n "s|^#include \"\([^\"]*\)\".*|${1%/*}/\1|p" "$1" | xargs -r realpath -e -q --relative-to=. |
        sed "s|^|$1 |"
}

tap_needs "$CC" 'rooms' || { tap_end; exit; }

for room in $rooms; do
    files=$(ls "$room"/*.[ch] 2>/dev/null) || continue
    case $room in
    tests/* | tests) continue ;; # tests may include everything
    esac
    readme=$room/README.md
    case $room in
    firmware_demo/examples/*) readme=firmware_demo/examples/README.md ;;
    esac
    if [ ! -f "$readme" ]; then
        echo "$room has no README.md" >"$scratch/found"
        tap 1 "$room"
        continue
    fi
    allowed=$(sed -n 's/^May include: *//p' "$readme" | tr -d '`.,' | tr '\n' ' ')
    for file in $files; do
        includes "$file" 0
        includes "$file" 1
    done | sort -u | while read -r file header; do
        case " $room $allowed " in
        *" $(dirname "$header") "*) ;;
        *) echo "$file includes $header" ;;
        esac
    done >"$scratch/found"
    [ ! -s "$scratch/found" ] && [ -n "$allowed" ] && [ "$(wc -l <"$readme")" -le 40 ]
    tap $? "$room includes: $allowed"
done

# The top level holds the files and folders of the project and nothing else, such as output written by mistake.
git ls-files --cached --others --exclude-standard 2>/dev/null | sed 's|/.*||' | sort -u |
    grep -v -x -e '\.ci' -e '\.clang-format' -e '\.editorconfig' -e '\.gitignore' -e '[A-Z]*\.md' -e LICENSE -e Makefile \
        -e firmware_demo -e host_tools -e include -e lib -e tests >"$scratch/found"
[ ! -s "$scratch/found" ]
tap $? 'nothing but the project at the top level'

# A file and its header count as one: NAME.c and NAME.h.
for file in $(git ls-files --cached --others --exclude-standard '*.[ch]'); do
    [ -f "$file" ] && direct "$file"
done | sed 's/\.[ch]\( \|$\)/\1/g' | awk '$1 != $2 { print $2, $1 }' | sort -u >"$scratch/pairs"
tsort "$scratch/pairs" >/dev/null 2>"$scratch/found"
[ -s "$scratch/pairs" ] && [ ! -s "$scratch/found" ]
tap $? "no circle among $(wc -l <"$scratch/pairs") includes"

# The stages after the design take what the scene says from the design. plant.c changes a copy of the scene, from which
# it builds a design of its own.
grep -nE '(->|\.|\b)scene(->|\.[a-z_]+ )' host_tools/fmu/*.c host_tools/report/*.c host_tools/simulate/*.c host_tools/tables/*.c \
    host_tools/text/*.c host_tools/vtk/*.c | grep -v '^host_tools/simulate/plant\.c' | grep -vE ':[0-9]+: *(/?\*|.*[a-z0-9]->scene,)' >"$scratch/found"
[ ! -s "$scratch/found" ]
tap $? "fmu, report, simulate, tables, text and vtk do not reach into a scene"
tap_end
