#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The architecture: a room includes only the rooms that its README.md names after "May include:", and the include
# graph of the files has no circle. gcc -MM lists what each file includes, directly or not.
. tests/gates/common.sh

rooms=$(git ls-files --cached --others --exclude-standard '*.[ch]' 2>/dev/null | sed 's|/[^/]*$||' | sort -u)

# A path without the parts that ".." takes back, for awk.
plain='
    function plain(path) {
        while (match(path, /[^\/.][^\/]*\/\.\.\//)) path = substr(path, 1, RSTART - 1) substr(path, RSTART + RLENGTH)
        return path
    }'

# Lines "FILE INCLUDED" for the files $2... with the options $1; generated tables include pzs.h alone.
includes() {
    choice=$1
    shift
    # shellcheck disable=SC2046
    "$CC" -std=c99 -MM -MG -Iinclude -DDEMO_TABLES='"pzs.h"' $(options "$choice") "$@" 2>/dev/null | awk "$plain"'
        { more = sub(/\\$/, ""); rule = rule " " $0 }
        more { next }
        {
            count = split(rule, word, " ")
            for (i = 3; i <= count; i++) if (word[i] ~ /\.h$/) print plain(word[2]), plain(word[i])
            rule = ""
        }'
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
    # shellcheck disable=SC2086
    { includes 0 $files; includes 1 $files; } | sort -u | while read -r file header; do
        case " $room $allowed " in
        *" ${header%/*} "*) ;;
        *) [ ! -f "$header" ] || echo "$file includes $header" ;;
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
git ls-files --cached --others --exclude-standard '*.[ch]' | xargs ls 2>/dev/null >"$scratch/files"
xargs awk "$plain"'
    FNR == 1 { folder = FILENAME; sub(/[^\/]*$/, "", folder) }
    match($0, /^#include "[^"]*"/) { print FILENAME, plain(folder substr($0, 11, RLENGTH - 11)) }' <"$scratch/files" |
    awk -v list="$scratch/files" 'BEGIN { while ((getline line <list) > 0) own[line] = 1 } $2 in own' |
    sed 's/\.[ch]\( \|$\)/\1/g' | awk '$1 != $2 { print $2, $1 }' | sort -u >"$scratch/pairs"
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
