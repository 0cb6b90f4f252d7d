#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every test, one summary: N passed, N failed.
# Each part prints TAP lines (ok ..., not ok ...) or CMocka's own; a part that dies counts as failed.
set -u
export CI=1 # a missing compiler fails a gate
cd "$(dirname "$0")/.."
B=${B:-build}
log=$B/test-log
mkdir -p "$log"
passed=0
failed=0

# part NAME COMMAND...: run, count, show what failed
part() {
    name=$1
    shift
    began=$(date +%s)
    CMOCKA_MESSAGE_OUTPUT=TAP "$@" >"$log/$name.txt" 2>&1
    status=$?
    good=$(grep -c '^ok ' "$log/$name.txt")
    bad=$(grep -c '^not ok ' "$log/$name.txt")
    if [ $status -ne 0 ] && [ "$bad" -eq 0 ]; then
        bad=1
        echo "--- $name ended with $status"
        tail -n 30 "$log/$name.txt"
    elif [ "$bad" -gt 0 ]; then
        echo "--- $name"
        grep -A 6 '^not ok ' "$log/$name.txt" | head -n 60
    elif [ "$good" -eq 0 ]; then
        bad=1
        echo "--- $name ran no test"
    fi
    passed=$((passed + good))
    failed=$((failed + bad))
    printf '%-28s %4d passed %4d failed  %3d s\n' "$name" "$good" "$bad" $(($(date +%s) - began))
}

# aside NAME COMMAND...: run beside the other parts; `result NAME` waits for it and prints what it printed
aside() {
    name=$1
    shift
    rm -f "$log/$name.code"
    "$@" >"$log/$name.aside" 2>&1
    echo $? >"$log/$name.code"
}
result() {
    until [ -f "$log/$1.code" ]; do sleep 1; done
    cat "$log/$1.aside"
    return "$(cat "$log/$1.code")"
}

part build sh -c '"${MAKE:-make}" --no-print-directory -s -j2 all unit san && echo "ok 1 - builds without warnings"'
rm -f "$log"/*.code
(
    aside target-units sh tests/target/units.sh
    aside gate-warnings sh tests/gates/warnings.sh
    aside gate-symbols sh tests/gates/symbols.sh
    aside oracle sh -c 'cd tests/oracle && /usr/bin/python3 check_oracle.py'
    aside oracle-nonlinear sh -c 'cd tests/oracle && /usr/bin/python3 check_nonlinear.py'
    aside scipy sh tests/oracle/boxls.sh
    aside gmsh sh tests/cli/gmsh.sh
    aside packages sh tests/cli/packages.sh
    aside fmu sh tests/cli/fmu.sh
) &
for program in "$B"/test/*; do
    case $program in *.d|*.o) continue ;; esac
    part "$(basename "$program")" "$program"
done
part tiles sh tests/gates/tiles.sh
part cli sh tests/cli/cli.sh
part examples sh tests/cli/examples.sh
part measured sh tests/bench/measured.sh --check
part install sh tests/cli/install.sh
for gate in tests/gates/*.sh; do
    case $(basename "$gate" .sh) in
    common) ;;
    warnings | symbols) part "gate-$(basename "$gate" .sh)" result "gate-$(basename "$gate" .sh)" ;;
    *) part "gate-$(basename "$gate" .sh)" sh "$gate" ;;
    esac
done
for name in oracle oracle-nonlinear scipy gmsh packages fmu; do
    part "$name" result "$name"
done
part target-start sh tests/target/start.sh
part target-units result target-units
part target-loop sh tests/target/loop.sh
part target-examples sh tests/target/examples.sh
part target-bound sh tests/target/bound.sh
part qemu "${MAKE:-make}" --no-print-directory -s qemu
part size "${MAKE:-make}" --no-print-directory -s size
echo
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
