#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Voltages of the laws that the vibration damper is compared with, tick by tick, against numpy and scipy; TAP on stdout.
B=${B:-build}
dump=$(mktemp)
trap 'rm -f "$dump"' EXIT
"$B/test/rivals-64" "$dump" >/dev/null 2>&1 || echo "not ok - test_rivals failed"
/usr/bin/python3 -B tests/oracle/rivals.py "$dump"
