#!/bin/sh
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
    function check(kind, name, column, value, limit) {
        if (limit == "") { printf "not ok %s %s: no budget for %s %d\n", kind, name, column, value; failed++ }
        else if (value > limit) { printf "not ok %s %s: %s %d exceeds %d\n", kind, name, column, value, limit; failed++ }
        else passed++
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
        if (stack == "") { printf "not ok image %s: it reported no stack\n", $2; failed++ }
        printf "%-30s %8d %8d %8d %8d\n", $2, $3, $4 + stack, $5, stack
        check("image", $2, "flash", $3, limit["image", $2, 3])
        check("image", $2, "ram", $4 + stack, limit["image", $2, 4])
        check("image", $2, "large", $5, limit["image", $2, 5])
        check("image", $2, "stack", stack + 0, limit["image", $2, 6])
    }
    $1 == "object" {
        printf "%-30s %8d %8d\n", $2, $3, $4
        check("object", $2, "flash", $3, limit["object", $2, 3])
        check("object", $2, "ram", $4, 0)
    }
    END { printf "%d passed, %d failed\n", passed, failed; exit failed > 0 }'
