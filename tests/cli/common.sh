# SPDX-License-Identifier: BSD-2-Clause
# What the tests of the command line share; sourced from the top folder of the project: the program, a scratch folder
# that is removed at the end, TAP lines, and the exit status.
B=${B:-build}
PZS=${PZS:-$B/pzs}
dir=$(mktemp -d "${TMPDIR:-/tmp}/pzs-XXXXXX")
trap 'rm -rf "$dir"' EXIT
n=0
failed=0

# check NAME STATUS: one TAP line; a failure shows the last lines of $dir/said
check() {
    n=$((n + 1))
    if [ "$2" -eq 0 ]; then
        echo "ok $n - $1"
    else
        failed=$((failed + 1))
        echo "not ok $n - $1"
        tail -n 8 "$dir/said" 2>/dev/null | sed 's/^/# /'
    fi
}

# skip NAME WHAT: one TAP line for a test that needs WHAT
skip() {
    n=$((n + 1))
    echo "ok $n - $1 # SKIP no $2"
}
