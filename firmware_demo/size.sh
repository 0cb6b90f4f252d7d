#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Flash and RAM of each image and flash of each library object, against committed budgets.
#   size.sh DIRECTORY BUDGET IMAGE...      SIZE (default arm-none-eabi-size) from the environment
# An image's stack is what it used in its last run (IMAGE.out); its RAM is data, bss and that stack.
set -u
dir=$1
budget=$2
shift 2
: "${SIZE:=arm-none-eabi-size}"

{
    for image in "$@"; do
        echo "stack $image $(sed -n 's/^cost stack used=\([0-9]*\).*/\1/p' "$dir/$image.out")"
        "$SIZE" -A "$dir/$image.elf" | awk -v image="$image" '
            $1 == ".vectors" || $1 == ".text" || $1 == ".rodata" { flash += $2 }
            $1 == ".data" { flash += $2; ram += $2 }
            $1 == ".bss" { ram += $2 }
            $1 == ".large" { large += $2 }
            END { print "image", image, flash, ram, large + 0 }'
    done
    for library in "$dir"/m*-*/libpzs.a; do
        name=${library%/libpzs.a}
        "$SIZE" "$library" | awk -v library="${name##*/}" '
            NR > 1 { print "object", library "/" $6, $1 + $2, $2 + $3 }'
    done
} | awk -v budget="$budget" '
    # One fault for each column above its budget, or without one.
    function check(column, value, limit) {
        if (limit == "") faults = faults sprintf(": no budget for %s %d", column, value)
        else if (value > limit) faults = faults sprintf(": %s %d exceeds %d", column, value, limit)
    }
    function verdict() {
        if (faults == "") passed++
        else failed++
        verdicts = verdicts (faults == "" ? "ok " : "not ok ") $1 " " $2 faults "\n"
        faults = ""
    }
    # Name of the line for an object: its own, or that of a library with one of its options, or with none.
    function budgeted(name,    own) {
        if (("object", name, 3) in limit) return name
        own = name
        sub(/-all/, "-nonlinear", name)
        if (("object", name, 3) in limit) return name
        name = own
        sub(/-all/, "-modes", name)
        if (("object", name, 3) in limit) return name
        sub(/-(nonlinear|modes)/, "", name)
        return name
    }
    BEGIN {
        while ((getline line < budget) > 0) {
            if (line ~ /^#/ || line !~ /[^ ]/) continue
            split(line, word, " ")
            for (i = 3; i <= 6; i++) limit[word[1], word[2], i] = word[i]
        }
        printf "%-30s %8s %8s %8s %8s   (bytes)\n", "", "flash", "ram", "large", "stack"
    }
    $1 == "stack" { stack = $3; next }
    $1 == "image" {
        if (stack == "") faults = ": it reported no stack"
        printf "%-30s %8d %8d %8d %8d\n", $2, $3, $4 + stack, $5, stack
        check("flash", $3, limit["image", $2, 3])
        check("ram", $4 + stack, limit["image", $2, 4])
        check("large", $5, limit["image", $2, 5])
        check("stack", stack + 0, limit["image", $2, 6])
        verdict()
    }
    $1 == "object" {
        printf "%-30s %8d %8d\n", $2, $3, $4
        name = budgeted($2)
        check("flash", $3, limit["object", name, 3])
        check("ram", $4, 0)
        verdict()
    }
    END { printf "\n%s%d passed, %d failed\n", verdicts, passed, failed; exit failed > 0 }'
