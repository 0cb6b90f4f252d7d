#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The random loops of test_modal_gains against a leaky integrator in numpy, inside limits by scipy's bounded least squares, both precisions.
exec sh tests/oracle/both_precisions.sh modal_gains modal_gains.py
