#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The margin of a loop against errors of its influence matrix, which `pzs check` prints, against numpy; and the regularisation that it names.
PZS=${1:-build/pzs}
dir=$(mktemp -d) && trap 'rm -rf "$dir"' EXIT
/usr/bin/python3 tests/oracle/matrix_errors.py "$PZS" "$dir"
