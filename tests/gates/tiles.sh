#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Volts of long walks have the same bits whatever the tile: programs of test_step built with several. TAP lines.
set -u
B=${B:-build}
n=0
for pair in '32 32t8' '64 64t16'; do
    n=$((n + 1))
    one=${pair% *}
    other=${pair#* }
    "$B/test/step-$one" bits >"$B/bits-$one.txt" && "$B/test/step-$other" bits >"$B/bits-$other.txt" &&
        [ -s "$B/bits-$one.txt" ] && cmp -s "$B/bits-$one.txt" "$B/bits-$other.txt" && printf 'ok' || printf 'not ok'
    echo " $n - volts of $one and $other have the same bits"
done
echo "1..$n"
