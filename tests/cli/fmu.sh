#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# FMUs of plant and controller: coupled they have the bits of pzs simulate; order of calls, states, bad input; what pzs
# refuses; and, where FMPY names a Python with FMPy (python3 by default), what FMPy says, compiles and computes.
#   FMU_FLAGS    flags of the compiler for the FMUs
#   FMU_PRELOAD  library that Python loads first: libasan.so for FMUs with sanitizers
set -u
cd "$(dirname "$0")/../.."
. tests/cli/common.sh
FMPY=${FMPY:-python3}
export CFLAGS="${FMU_FLAGS:--O0} -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wno-unused-variable -Werror"

# loop ARGUMENTS: tests/cli/fmu_loop.py, with what it says in $dir/said
loop() {
    LD_PRELOAD=${FMU_PRELOAD:-} ASAN_OPTIONS=detect_leaks=0 /usr/bin/python3 tests/cli/fmu_loop.py "$@" >"$dir/said" 2>&1
}

# export_both NAME OPTIONS...: $dir/NAME-plant.fmu and $dir/NAME-controller.fmu with libraries
export_both() {
    name=$1
    shift
    "$PZS" fmu "$@" --plant --build -o "$dir/$name-plant.fmu" >"$dir/said" 2>&1 &&
        "$PZS" fmu "$@" --controller --build -o "$dir/$name-controller.fmu" >>"$dir/said" 2>&1
}

# coupled NAME EVENTS DELAY SCENE OPTIONS...: the FMUs of a scene give the bits of pzs simulate
coupled() {
    name=$1 events=$2 delay=$3
    shift 3
    set -- "$@" --set "simulate.events=$events"
    export_both "$name" "$@" && "$PZS" simulate "$@" --csv "$dir/$name.csv" >"$dir/said" 2>&1 &&
        loop coupled "$dir/$name-plant.fmu" "$dir/$name-controller.fmu" "$dir/$name.csv" "$events" "$delay"
}

# refuses TEXT ARGUMENTS...: pzs fmu ends with exit code 2 and one line that holds the text, and leaves no file
refuses() {
    text=$1
    shift
    "$PZS" fmu "$@" -o "$dir/refused.fmu" 2>"$dir/said" >/dev/null
    [ $? -eq 2 ] && [ "$(grep -c "^pzs:" "$dir/said")" -eq 1 ] && grep -qF -- "$text" "$dir/said" && ! ls "$dir"/refused.fmu* >/dev/null 2>&1
    check "refused: $text" $?
}

linear='simulate.plant={kinematics: linear, creep: 0.02, stiffness: 1.1, d: 0.8}'
small='--set mesh.theta1.elements=5 --set mesh.theta2.elements=5 --set simulate.influence=undeformed --set simulate.ticks=150'

# ---- the bits of pzs simulate ----------------------------------------------

# shellcheck disable=SC2086
coupled vibrating '[{at: 0, load: 0, factor: 0}, {at: 40, load: 0, factor: 1}, {at: 80, target: 0.5}, {at: 110, temperature: 30}]' 1 \
    plate-closed-loop $small --set "$linear" --set 'simulate.amplifiers={step: 0.05, dead_band: 0.1, bandwidth: 500}' \
    --set 'simulate.sensors={noise: 1e-7, drift: 1e-6, delay: 1, quantum: 1e-8, outliers: {chance: 0.01, size: 1e-6}}'
check 'a vibrating plant with every imperfection, a load, heat, late readings' $?
coupled few '[{at: 0, load: 0, factor: 0, feed_forward: true}, {at: 30, load: 0, factor: 0.5, feed_forward: true}, {at: 60, load: 0, factor: 1}]' 3 \
    plate-few-sensors --quasi-static --set simulate.influence=undeformed --set simulate.plant.kinematics=linear --set simulate.plant.inertia=false --set simulate.ticks=100
check 'a quasi-static plant, few sensors, a known load' $?
"$PZS" new measured >"$dir/measured.yaml" && "$PZS" new measured-matrix >"$dir/measured-matrix.csv" &&
    coupled measured '[{at: 50, target: -0.5}]' 0 "$dir/measured.yaml" --set safety=none --set 'limits.absolute_sum={limit: 60}' --set 'limits.difference={limit: 20}' \
        --set 'control.modal_gains={modes: [x, "x^2 - y^2"], gain: [0.5, 0.7], leak: 0.01, other_gain: 0.3}'
check 'a measured mirror with gains of modes, limits of differences and of a sum of absolute values' $?
coupled gate '[{at: 50, target: -0.5}]' 0 "$dir/measured.yaml" --set safety=none --set control.sensor_gate=true --set 'simulate.sensors.outliers={chance: 0.02, size: 0.01}'
check 'a sensor gate takes outliers of the plant away' $?
coupled curved '[{at: 50, target: 0.5}]' 0 "$dir/measured.yaml" --set safety=none --set influence.curve=quadratic --set 'limits.voltage=[0, 60]' \
    --set 'target.value=1e-3 + 8e-6*(x^2 - y^2)' --set 'simulate.plant={gain: 0.9, curve_error: 0.1}' --set 'simulate.amplifiers={step: 0.5, bandwidth: 100}'
check 'a measured mirror with quadratic actuators' $?
loop faults "$dir/vibrating-plant.fmu" "$dir/vibrating-controller.fmu"
check 'order of calls, states, instances, bad input' $?
"$PZS" fmu "$dir/measured.yaml" --controller --build --set simulate.sensors.delay=1 --set 'safety={park: {e1: -5, e4: 3 V}, ramp_ticks: 20}' -o "$dir/late.fmu" >"$dir/said" 2>&1 &&
    "$PZS" fmu "$dir/measured.yaml" --plant --build --set 'simulate.plant={gain: 1.2, hysteresis: 0}' --set simulate.sensors.noise=0 -o "$dir/calm.fmu" >"$dir/said" 2>&1 &&
    "$PZS" fmu "$dir/measured.yaml" --controller --build --set safety=none -o "$dir/punctual.fmu" >"$dir/said" 2>&1 &&
    loop together "$dir/calm.fmu" "$dir/late.fmu" "$dir/punctual.fmu" 0 -5 0 0 3 0 0
check 'both at once: the controller knows of the late tick; commands to the supervisor' $?

# ---- the archive -----------------------------------------------------------

"$PZS" fmu "$dir/measured.yaml" --plant -o "$dir/one.fmu" >"$dir/said" 2>&1 && "$PZS" fmu "$dir/measured.yaml" --plant -o "$dir/two.fmu" >"$dir/exported" 2>&1 &&
    cmp "$dir/one.fmu" "$dir/two.fmu" >"$dir/said"
check 'an equal scene gives equal bytes' $?
grep -q 'left out.*: 1$' "$dir/exported"
check 'events that are left out are counted' $?
unzip_text() { /usr/bin/python3 -c "import sys,zipfile; sys.stdout.write(zipfile.ZipFile(sys.argv[1]).read(sys.argv[2]).decode())" "$@"; }
unzip_text "$dir/one.fmu" modelDescription.xml >"$dir/xml" && grep -q 'name="voltage.e1"' "$dir/xml" && grep -q '<Unit name="mm"><BaseUnit m="1" factor="1e-3"/>' "$dir/xml" &&
    grep -q '<Unit name="V"><BaseUnit kg="1" m="2" s="-3" A="-1"/>' "$dir/xml" && unzip_text "$dir/one.fmu" documentation/licenses/license.txt | cmp -s - LICENSE
check 'names and units of the scene, and the licence' $?

# ---- what is refused -------------------------------------------------------

refuses 'either --plant or --controller' plate-closed-loop
refuses 'either --plant or --controller' plate-closed-loop --plant --controller
refuses 'the plant of an FMU is linear' plate-closed-loop --plant
refuses 'needs a tick rate' plate-50-patches --controller
refuses 'no plant without the section simulate' plate-50-patches --plant --set 'control={rate: 1000}'
CC=/nowhere/cc refuses 'could not be compiled' "$dir/measured.yaml" --plant --build
[ "$(grep -vc '^ ' "$dir/said")" -eq 1 ]; check 'a compiler that does not exist: one message, none of the shell' $?
PZS_SOURCES=/nowhere refuses 'PZS_SOURCES names the folder' "$dir/measured.yaml" --controller
mkdir "$dir/folder" && "$PZS" fmu "$dir/measured.yaml" --plant -o "$dir/folder" >"$dir/said" 2>&1 && [ -s "$dir/folder/measured_plant.fmu" ]
check 'a folder as output' $?
"$PZS" fmu plate-closed-loop --plant >"$dir/said" 2>&1; [ $? -eq 2 ] && grep -q -e '-o FILE' "$dir/said"; check 'an FMU without a file name' $?

# ---- FMPy ------------------------------------------------------------------

if "$FMPY" -c 'import fmpy' 2>/dev/null; then
    unset CFLAGS
    for kind in plant controller; do
        "$FMPY" -m fmpy validate "$dir/vibrating-$kind.fmu" >"$dir/said" 2>&1 && grep -q 'No problems found' "$dir/said"; check "FMPy: the $kind is valid" $?
        # shellcheck disable=SC2086
        "$PZS" fmu plate-closed-loop --$kind $small --set "$linear" --set 'simulate.events=[]' -o "$dir/$kind.fmu" >"$dir/said" 2>&1 &&
            "$FMPY" -m fmpy compile "$dir/$kind.fmu" >"$dir/said" 2>&1
        check "FMPy: the $kind compiles" $?
    done
    # shellcheck disable=SC2086
    "$PZS" simulate plate-closed-loop $small --set "$linear" --set 'simulate.events=[]' --csv "$dir/simulated.csv" >"$dir/said" 2>&1 &&
        "$FMPY" host_tools/fmu/closed_loop.py "$dir/plant.fmu" "$dir/controller.fmu" 150 >"$dir/coupled.csv" 2>"$dir/said" &&
        cut -d, -f9- "$dir/simulated.csv" | diff - "$dir/coupled.csv" >"$dir/said"
    check 'FMPy: the closed loop of the example has the same bits' $?
else
    for what in 'the plant is valid' 'the plant compiles' 'the controller is valid' 'the controller compiles' 'the example'; do
        skip "FMPy: $what" FMPy
    done
fi
echo "1..$n"
[ "$failed" -eq 0 ]
