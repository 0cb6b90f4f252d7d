#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The modes of test_modes against the eigenvalues of dense matrices in scipy, in both precisions.
exec sh tests/oracle/both_precisions.sh modes device_modes.py
