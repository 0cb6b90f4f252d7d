#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The random loops of test_modal_gains against a leaky integrator in numpy, inside limits by scipy's bounded least squares, both precisions.
B=${B:-build}
dump=$(mktemp)
trap 'rm -f "$dump"' EXIT
n=0
for bits in 64 32; do
    n=$((n + 1))
    said=$("$B/test/modal_gains-$bits" "$dump" >/dev/null 2>&1 && /usr/bin/python3 tests/oracle/modal_gains.py "$dump") && word=ok || word='not ok'
    echo "$word $n - $bits bits: $said"
done
echo "1..$n"
