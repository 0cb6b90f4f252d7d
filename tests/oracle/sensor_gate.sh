#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The random readings of test_sensor_gate against least squares in numpy, in both precisions.
B=${B:-build}
dump=$(mktemp)
trap 'rm -f "$dump"' EXIT
n=0
for bits in 64 32; do
    n=$((n + 1))
    said=$("$B/test/sensor_gate-$bits" "$dump" >/dev/null 2>&1 && /usr/bin/python3 tests/oracle/sensor_gate.py "$dump") && word=ok || word='not ok'
    echo "$word $n - $bits bits: $said"
done
echo "1..$n"
