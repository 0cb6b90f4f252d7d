#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Layout: every C source is as clang-format lays it out (.clang-format), and no line of a source exceeds 100 columns.
: "${CLANG_FORMAT:=clang-format}"
. tests/gates/common.sh
files=$(git ls-files '*.c' '*.h' ':!host_tools/tables/example.h')
if tap_needs "$CLANG_FORMAT" 'layout'; then
    # shellcheck disable=SC2086
    "$CLANG_FORMAT" --dry-run -Werror $files >"$scratch/found" 2>&1
    tap $? 'layout of clang-format (else: make format)'
fi
# shellcheck disable=SC2086
LC_ALL=C.UTF-8 grep -nE '^.{101,}' $files >"$scratch/found"
[ ! -s "$scratch/found" ]
tap $? 'lines of at most 100 columns'
tap_end
