#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Table of control laws in tests/bench/README.md, from the program that measures them (bench_laws.c).
#   laws.sh           print the rows
#   laws.sh --write   print them and put them into the README, between its markers (make bench-laws)
#   laws.sh --check   compare them with those in the README; TAP on stdout (make check-long)
set -u
cd "$(dirname "$0")/../.."
B=${B:-build}
readme=tests/bench/README.md
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

# Rows of the table in the README, without its two head lines.
stated() {
    sed -n '/<!-- laws -->/,/<!-- \/laws -->/p' "$readme" | grep '^|' | tail -n +3
}

# Two laws at a time.
count=$("$B/bench/laws") || exit 1
seq "$count" | xargs -P 2 -I '{}' sh -c '"$0" "$1" >"$2/$1"' "$B/bench/laws" '{}' "$dir" || exit 1
for number in $(seq "$count"); do
    cat "$dir/$number"
done >"$dir/rows"
if [ "${1:-}" = --check ]; then
    stated >"$dir/stated"
    diff "$dir/stated" "$dir/rows" >"$dir/differences"
    status=$?
    [ $status -eq 0 ] || printf 'not '
    echo "ok 1 - the $count control laws of tests/bench/README.md: the rows that are measured"
    sed 's/^/# /' "$dir/differences"
    exit $status
fi
cat "$dir/rows"
[ "${1:-}" = --write ] || exit 0
awk -v rows="$dir/rows" '
    /<!-- \/laws -->/ {skip = 0}
    !skip {print}
    /<!-- laws -->/ {
        print "| law | storms failed of 30 | worst end | with other targets, of 150 | readings one tick older, of 30 | target step | load step on the target | load step alone | impulse | offset | offset at limits | sine | noise | work | settings, for readings 0, 1 and 3 ticks old |"
        print "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
        while ((getline line <rows) > 0) print line
        skip = 1
    }' "$readme" >"$dir/new" && cat "$dir/new" >"$readme"
