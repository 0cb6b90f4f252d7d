#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Vibration with open electrodes against scipy's roots of the exact characteristic equations.
B=${B:-build}
said=$(/usr/bin/python3 -B tests/oracle/open_modes.py "$B/pzs") && word=ok || word='not ok'
echo "$word 1 - open electrodes: $said"
echo '1..1'
