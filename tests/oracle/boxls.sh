#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The answers of test_control to its 10,000 random problems against scipy's exact bounded least squares, both precisions.
B=${B:-build}
dump=$(mktemp)
trap 'rm -f "$dump"' EXIT
n=0
for bits in 64 32; do
    n=$((n + 1))
    said=$("$B/test/control-$bits" "$dump" >/dev/null 2>&1 && /usr/bin/python3 tests/oracle/boxls.py "$dump" --all) && word=ok || word='not ok'
    echo "$word $n - $bits bits: $said"
done
echo "1..$n"
