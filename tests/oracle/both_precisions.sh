#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Compare the results that a test program writes to a file with a program in numpy, in double and in float; TAP on stdout.
#   both_precisions.sh TEST PROGRAM [OPTION...]     B (build folder) from the environment
B=${B:-build}
test=$1 program=$2
shift 2
dump=$(mktemp)
trap 'rm -f "$dump"' EXIT
n=0
for bits in 64 32; do
    n=$((n + 1))
    said=$("$B/test/$test-$bits" "$dump" >/dev/null 2>&1 && /usr/bin/python3 -B "tests/oracle/$program" "$dump" "$@") && word=ok || word='not ok'
    echo "$word $n - $bits bits: $said"
done
echo "1..$n"
