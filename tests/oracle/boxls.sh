#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The answers of test_control to its 10,000 random problems against scipy's exact bounded least squares, both precisions.
exec sh tests/oracle/both_precisions.sh control boxls.py --all
