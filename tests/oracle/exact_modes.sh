#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Natural frequencies against exact solutions in scipy: open electrodes, thick plates.
B=${B:-build}
n=0
for name in open_modes thick_modes; do
    n=$((n + 1))
    said=$(/usr/bin/python3 -B tests/oracle/$name.py "$B/pzs") && word=ok || word='not ok'
    echo "$word $n - $name: $said"
done
echo "1..$n"
