#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The random readings of test_sensor_gate against least squares in numpy, in both precisions.
exec sh tests/oracle/both_precisions.sh sensor_gate sensor_gate.py
