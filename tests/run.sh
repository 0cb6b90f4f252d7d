#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Every test, one summary: N passed, N failed.
# Each part prints TAP lines (ok ..., not ok ...) or CMocka's own; a part that dies counts as failed. After the build, two
# parts run at a time; each takes the next of the queue, in which the longest come first.
set -u
export CI=1 # a missing compiler fails a gate
cd "$(dirname "$0")/.."
export B="${B:-build}"
export FW_OBJECTS="$B/firmware" # a firmware that a test builds takes the objects compiled here
log=$B/test-log
make="${MAKE:-make} --no-print-directory -s"
rm -rf "$log"
mkdir -p "$log/queue"
parts=0

# run_part NAME COMMAND: run, count, show what failed
run_part() {
    name=$1
    began=$(date +%s)
    CMOCKA_MESSAGE_OUTPUT=TAP sh -c "$2" >"$log/$name.txt" 2>&1
    status=$?
    good=$(grep -c '^ok ' "$log/$name.txt")
    bad=$(grep -c '^not ok ' "$log/$name.txt")
    {
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
        printf '%-28s %4d passed %4d failed  %3d s\n' "$name" "$good" "$bad" $(($(date +%s) - began))
    } >"$log/$name.said"
    echo "$good $bad" >"$log/$name.count"
    cat "$log/$name.said"
}

# part NAME COMMAND: put it into the queue
part() {
    parts=$((parts + 1))
    printf '%s\n%s\n' "$1" "$2" >"$log/queue/$parts"
}

# Take parts from the queue until it is empty. Only one lane can make the folder of a part.
lane() {
    number=1
    while [ "$number" -le "$parts" ]; do
        if mkdir "$log/queue/$number.taken" 2>/dev/null; then
            run_part "$(sed -n 1p "$log/queue/$number")" "$(sed -n 2p "$log/queue/$number")"
        fi
        number=$((number + 1))
    done
}

run_part build "$make -j2 all unit san firmware loop-objects && echo 'ok 1 - builds without warnings'"
part cli 'sh tests/cli/cli.sh'
part target-units 'sh tests/target/units.sh'
part gate-warnings 'sh tests/gates/warnings.sh'
part examples 'sh tests/cli/examples.sh'
part oracle-nonlinear 'cd tests/oracle && /usr/bin/python3 check_nonlinear.py'
part target-loop 'sh tests/target/loop.sh'
part oracle 'cd tests/oracle && /usr/bin/python3 check_oracle.py'
part gate-symbols 'sh tests/gates/symbols.sh'
for gate in tests/gates/*.sh; do
    case $(basename "$gate" .sh) in
    common | symbols | warnings) ;;
    *) part "gate-$(basename "$gate" .sh)" "sh $gate" ;;
    esac
done
part target-examples 'sh tests/target/examples.sh'
part qemu "$make qemu"
part packages 'sh tests/cli/packages.sh'
part fmu 'sh tests/cli/fmu.sh'
part install 'sh tests/cli/install.sh'
part measured 'sh tests/bench/measured.sh --check'
part figures 'sh tests/bench/figures.sh'
part scipy 'sh tests/oracle/boxls.sh'
part scipy-curves "/usr/bin/python3 tests/oracle/curves.py $B/pzs"
part integrators 'sh tests/oracle/modal_gains.sh'
part matrix-errors 'sh tests/oracle/matrix_errors.sh'
part rivals 'sh tests/oracle/rivals.sh'
part exact-modes 'sh tests/oracle/exact_modes.sh'
part gates 'sh tests/oracle/sensor_gate.sh'
part device-modes 'sh tests/oracle/device_modes.sh'
part target-gate 'sh tests/target/gate.sh'
part gmsh 'sh tests/cli/gmsh.sh'
part target-start 'sh tests/target/start.sh'
part target-bound 'sh tests/target/bound.sh'
for program in "$B"/test/*; do
    case $program in *.d | *.o) continue ;; esac
    part "$(basename "$program")" "$program"
done
lane &
lane
wait
run_part size "$make size"
echo
cat "$log"/*.count | awk '{ passed += $1; failed += $2 } END { print passed " passed, " failed " failed"; exit failed > 0 }'
