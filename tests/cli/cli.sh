#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# The command line as a user meets it: results, exit codes, messages with line and column, files never half written.
set -u
cd "$(dirname "$0")/../.."
B=${B:-build}
PZS=${PZS:-$B/pzs}
dir=$(mktemp -d "${TMPDIR:-/tmp}/pzs-XXXXXX") # no dot: cfitsio takes ".Z" in a path for an ending
trap 'rm -rf "$dir"' EXIT
n=0

# check NAME STATUS: one TAP line
check() {
    n=$((n + 1))
    if [ "$2" -eq 0 ]; then echo "ok $n - $1"; else echo "not ok $n - $1"; sed 's/^/# /' "$dir/out" "$dir/err" 2>/dev/null | tail -n 5; fi
}

# run EXPECTED_EXIT ARGUMENTS: output in $dir/out and $dir/err
run() {
    want=$1
    shift
    "$PZS" "$@" >"$dir/out" 2>"$dir/err"
    [ $? -eq "$want" ]
}

# says TEXT: the last run's standard error is one line that holds the text
says() {
    [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -qF -- "$1" "$dir/err"
}

# json EXPRESSION: true of the last run's JSON, as j
json() {
    /usr/bin/python3 -c "import json,sys; j=json.load(open('$dir/out')); sys.exit(not ($1))"
}

# scene FILE: a small sound scene that the bad ones are made from
scene() {
    cat >"$1" <<'EOT'
name: small
surface: {type: plate}
mesh:
  theta1: {from: 0, to: 1, elements: 4}
  theta2: {from: 0, to: 1, elements: 4}
materials:
  steel: {E: 2e11, nu: 0.3}
layers:
  - {material: steel, thickness: 0.01}
supports:
  - {edge: theta1-, fix: clamped}
loads:
  - {face: outer, pressure: 1}
outputs:
  - {name: tip, u3: middle, at: {theta1: 1, theta2: 1}}
EOT
}

# bad NAME SED_SCRIPT TEXT: the changed scene is refused with exit code 2 and that text
bad() {
    scene "$dir/good.yaml"
    sed "$2" "$dir/good.yaml" >"$dir/bad.yaml"
    run 2 solve "$dir/bad.yaml" --report "$dir/bad.html" && says "$3" && ! ls "$dir"/bad.html* >/dev/null 2>&1
    check "refused: $1" $?
}

run 0 --help && grep -q 'Examples:' "$dir/out"; check '--help teaches by example' $?
run 2; check 'no arguments: usage, exit code 2' $?
run 2 sovle plate-50-patches && says "unknown command 'sovle'"; check 'unknown command' $?
run 2 sovle plate-50-patches && says "did you mean 'solve'"; check 'a command mistyped' $?
run 2 solve plate-50-patches --reprot x.html && says "did you mean '--report'"; check 'an option mistyped' $?
run 2 solve plate-50-patchs && says "did you mean 'plate-50-patches'"; check 'a scene mistyped' $?
run 2 tables hemisphere -o "$dir/t.h" --image liner && says "control, linear or nonlinear, not 'liner' (did you mean 'linear'?)"; check 'a choice mistyped' $?
run 2 tables hemisphere -o "$dir/t.h" --level linear && says '--level is now --image' && [ ! -e "$dir/t.h" ]; check 'a renamed option' $?
run 2 solve xyzzy && says 'xyzzy' && ! says 'did you mean'; check 'a scene that is near none' $?
coarse='--set mesh.theta1.elements=2 --set mesh.theta2.elements=2 --set patches.0.grid=[2,2] --set patches.1.grid=[2,2] --set compare=[]'
# shellcheck disable=SC2086
run 3 check plate-50-patches $coarse --set 'control={rate: 1000, clock: 16 MHz}' --json && says 'more than the' && json 'all(abs(sum(p["blocks"].values())+p["rest"]-p["all"])<1 for p in j["tick"]["instructions"].values()) and not j["tick"]["holds"] and len(j["tick"]["instructions"])==2'
check 'a rate that the processor cannot hold is refused, with the instructions of each block' $?
# shellcheck disable=SC2086
run 3 tables plate-50-patches $coarse --set 'control={rate: 1000, clock: 16 MHz}' -o "$dir/slow.h" && says 'more than the' && [ ! -e "$dir/slow.h" ]
check 'no tables for a rate that the processor cannot hold' $?
run 0 check plate-closed-loop --set control.rate=4 --set dynamics='{damping: 0.2}' --set simulate.sensors.range=0.1mm --json && json "[round(w['value'], 9) for w in j['warnings'] if w['rule'] == 'sensor_range'] == [20]" &&
    run 0 check plate-closed-loop --set control.rate=4 --set dynamics='{damping: 0.2}' --set simulate.sensors.range=2.1mm --json && json "'sensor_range' not in [w['rule'] for w in j['warnings']]"
check 'a range of the sensors below the target is warned of' $?
run 2 solve plate-50-patches --report && says 'a value is missing'; check 'an option without its value' $?
run 2 list plate-50-patches && says 'takes no argument'; check 'a command without argument' $?
run 0 --version && [ "$(cat "$dir/out")" = "pzs $(sed -n 's/^#define PZS_VERSION_TEXT "\(.*\)"/\1/p' include/pzs_version.h)" ]; check '--version' $?
"$PZS" --help >"$dir/all" && run 0 -h && cmp -s "$dir/out" "$dir/all" && run 0 help && cmp -s "$dir/out" "$dir/all"; check '-h and help are --help' $?
[ "$(awk 'length > 110' "$dir/all" | wc -l)" -eq 0 ]; check 'the help fits a terminal' $?
commands=$(sed -n 's/^  pzs \([a-z]*\) .*/\1/p' "$dir/all" | sort -u)
for c in $commands; do
    run 0 help "$c" && cp "$dir/out" "$dir/one" && run 0 "$c" --help && cmp -s "$dir/out" "$dir/one" && run 0 "$c" x -h && cmp -s "$dir/out" "$dir/one" &&
        grep -q "^usage: pzs $c" "$dir/one" && grep -q '^Examples:' "$dir/one" && grep -q "^  pzs $c" "$dir/one"
    check "help of $c" $?
done
run 0 help tables && grep -q '^  --image' "$dir/out" && ! grep -q -e '--csv' "$dir/out"; check 'the help of a command has its options alone' $?
run 2 help solv && says "did you mean 'solve'"; check 'help of a command mistyped' $?
"$PZS" man >"$dir/pzs.1"; { ! command -v groff >/dev/null || [ -z "$(groff -man -ww -z "$dir/pzs.1" 2>&1)" ]; } &&
    [ -z "$(for c in $commands; do grep -q "^.fB$c.fR" "$dir/pzs.1" || echo "$c"; done)" ] && [ "$(grep -c '^.fB' "$dir/pzs.1")" -eq $(($(echo "$commands" | wc -w) + $(grep -c '^  -' "$dir/all"))) ]
check 'the manual page has every command and option' $?
# complete WORD...: what bash offers for the last word
complete() {
    bash -c '. "$1"; shift; COMP_WORDS=(pzs "$@"); COMP_CWORD=$#; _pzs; echo "${COMPREPLY[*]}"' sh "$dir/pzs.bash" "$@"
}
if command -v bash >/dev/null; then
    "$PZS" completion >"$dir/pzs.bash" && ln -sf "$(realpath "$PZS")" "$dir/pzs" && PATH="$dir:$PATH" && : >"$dir/a.html" &&
        [ "$(complete so)" = solve ] && [ "$(complete solve --rep)" = --report ] && [ "$(complete tables x --image no)" = nonlinear ] &&
        [ "$(complete shape plate-50)" = plate-50-patches ] && [ "$(complete help ch)" = check ] && [ "$(complete solve x --csv)" = --csv-dir ] &&
        [ "$(complete solve x --report "$dir/a.h")" = "$dir/a.html" ]
    check 'bash completes commands, options, choices, scenes and files' $?
fi
# Reports: laws of report_check.py on the files of this folder
law() { file=$1; shift; /usr/bin/python3 tests/cli/report_check.py "$dir/$file" "$@" 2>"$dir/err"; }
# Starting scenes: every choice of the help is a valid scene whose shape is found, with comments, not too long
# (those without a structure are checked below).
for kind in $("$PZS" help new | sed -n 's/^usage: pzs new \[\([^]]*\)\].*/\1/p' | tr '|' '\n' | grep -v -e measured -e poke); do
    "$PZS" new "$kind" >"$dir/$kind.yaml" && run 0 check "$dir/$kind.yaml" && run 0 shape "$dir/$kind.yaml" --json && json "j['scene'] == '$kind' and 0 < j['shape_error'] < .1" &&
        run 0 solve "$dir/$kind.yaml" && [ "$(wc -l <"$dir/$kind.yaml")" -le 56 ] && [ "$(grep -c '#' "$dir/$kind.yaml")" -ge 12 ] && [ "$(awk 'length > 100' "$dir/$kind.yaml" | wc -l)" -eq 0 ]
    check "new $kind" $?
    for c in check solve shape; do
        run 0 "$c" "$dir/$kind.yaml" --strict || break
    done
    check "new $kind: no warnings" $?
    run 0 modes "$dir/$kind.yaml" --number 3 --json &&
        json "len(j['frequency']) == 3 and 0 < min(j['frequency']) and 0 < j['mass']"
    check "new $kind: modes, so that every material has a density" $?
    run 0 shape "$dir/$kind.yaml" --limit 1000 && grep -q '^  optimum within limits .* \.\. 240 ' "$dir/out"
    check "new $kind: the field narrows wide limits" $?
done
run 0 new && cmp -s "$dir/out" "$dir/plate.yaml"; check 'new without an argument is a plate' $?
run 0 new measured-matrix && mv "$dir/out" "$dir/measured-matrix.csv" && run 0 new measured && mv "$dir/out" "$dir/measured.yaml" &&
    run 0 check "$dir/measured.yaml" --strict && grep -qF 'rank 7' "$dir/out"; check 'new measured is valid with its matrix' $?
run 0 check "$dir/measured.yaml" --set target.free=[] --set influence.drop_below=0.2 && grep -qF 'entries count as zero in the controller' "$dir/out" &&
    grep -qE 'they move output .* by [0-9.e-]+ mm, [0-9.]+ of the target' "$dir/out" && run 0 check "$dir/measured.yaml" --set target.free=[] --set influence.drop_below=0.2 --json && json "j['dropped_error'] > 0" &&
    run 3 check "$dir/measured.yaml" --set influence.drop_below=0.2 && says 'reacts to the free functions of the target' &&
    run 2 check "$dir/measured.yaml" --set influence.drop_below=0.7 && says 'must be from 0 to 0.5'
check 'drop_below leaves out small entries with the largest error, and is refused above 0.5' $?
run 0 check "$dir/measured.yaml" --set 'influence.tied={pair: [e4, e1], rest: [e5, e6]}' --set simulate.events=[] && grep -qF '19 outputs, 5 actuators' "$dir/out" &&
    grep -qx '  tied: pair = e1 + e4' "$dir/out" && grep -qx '  tied: rest = e5 + e6' "$dir/out" &&
    run 0 shape "$dir/measured.yaml" --set 'influence.tied={pair: [e1, e4]}' --set 'limits.each=[{actuator: e4, voltage: [-3, 2]}]' --limit 60 --json &&
    json "j['voltages']['pair'] == 2 and j['narrower'] == 1 and j['amplifiers'] == 6" &&
    run 2 check "$dir/measured.yaml" --set 'influence.tied={pair: [e1, e4], other: [e4]}' && says "'e4' is in the groups 'pair' and 'other'" &&
    run 2 simulate "$dir/measured.yaml" --set 'influence.tied={pair: [e1, e2]}' && says "'e2' is tied to others; write the group, 'pair'" &&
    run 0 tables "$dir/measured.yaml" --set 'influence.tied={pair: [e1, e4]}' --set 'safety={park: {pair: 5}}' --prefix tied -o "$dir/tied.h" && grep -q 'tied_park\[6\]' "$dir/tied.h"
check 'tied actuators are one amplifier, with the narrowest limits' $?
curve='influence={file: measured-matrix.csv, scale: 6e-6, curve: quadratic}' unipolar='limits.voltage=[0, 200]' raised='target={value: "1.5e-3 + 8e-6*(x^2 - y^2)"}'
run 0 check "$dir/measured.yaml" --set "$curve" --set "$unipolar" --set "$raised" && grep -qF 'actuator curves: the effect is the square of the voltage' "$dir/out" &&
    grep -qE '^    curve inverse +[0-9]+' "$dir/out" &&
    run 0 shape "$dir/measured.yaml" --set "$curve" --set "$unipolar" --set "$raised" --limit 60 --json && json "j['limits'] == [0, 60] and max(j['voltages'].values()) == 60 and min(j['voltages'].values()) >= 0" &&
    run 0 simulate "$dir/measured.yaml" --set "$curve" --set "$unipolar" --set "$raised" --set simulate.events=[] --set simulate.plant.curve_error=0.1 --json && json "j['phases'][0]['controller']['settled'] >= 0" &&
    run 0 tables "$dir/measured.yaml" --set "$curve" --set "$unipolar" --prefix curved -o "$dir/curved.h" && grep -q '^#define CURVED_CURVES 1' "$dir/curved.h" && grep -qF '{&pzs_curve_inverse_block, &curved_actuator_curves}' "$dir/curved.h" &&
    run 2 check "$dir/measured.yaml" --set "$curve" && says "curve: quadratic, but 'centre' goes down to -60 V"
check 'quadratic actuators: check, shape, simulate and tables; both signs are refused' $?
cp "$dir/measured-matrix.csv" "$dir/twin.csv"
run 2 check "$dir/measured.yaml" --set 'simulate.plant={curve_error: 0.1}' && says 'add influence.curve' &&
    run 2 calibrate "$dir/measured.yaml" --set "$curve" --set "$unipolar" --voltages "$dir/measured-matrix.csv" --shapes "$dir/twin.csv" && says 'influence.curve'
check 'an error of a curve needs a curve, and calibrate has none' $?
same=$(printf '{frequency: %s, shape: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19], response: [1e-6, 0, 0, 0, 0, 0, 0]}, ' 100 '100.0 Hz')
run 2 check "$dir/measured.yaml" --set "influence.modes=[${same%, }]" && says 'modes 1 and 2 have the same frequency and the same shape, but for a factor; remove one of them'
check 'a measured mode given twice is refused with the cure' $?
sed '/^target:/d; /^simulate:/,$d' "$dir/measured.yaml" >"$dir/aimless.yaml"
run 2 shape "$dir/aimless.yaml" && says 'no target: add `target: {value: ...}`, a formula of the coordinates, a list or a file with a number for each output' &&
    run 2 simulate "$dir/aimless.yaml" --set 'simulate={ticks: 3}' && says 'add target: {value: ...}, a formula of the coordinates'
check 'a measured matrix without a target: the message says what such a target is' $?
run 2 check "$dir/measured.yaml" --set 'safety={park: -60.00001}' && says 'park: -60.00001 V is outside the limits of centre, -60 to 60; write'
check 'a park voltage just beyond its limit is told with all its digits' $?
run 2 check plate-closed-loop --set simulate.sensors.delay=17 && says 'must be from 0 to 16 ticks; lower control.rate where readings are older'
check 'too old readings are refused with the cure' $?
gate='control={rate: 50, sensor_gate: true}'
run 0 check plate-50-patches --set "$gate" --json && json "j['sensor_gate']['judged']==121 and j['sensor_gate']['most']==4 and j['sensor_gate']['moved']<.03" &&
    run 0 check plate-few-sensors --set control.sensor_gate=true && grep -qF 'No sensor is judged by the others' "$dir/out" &&
    run 2 simulate plate-50-patches --set 'simulate={ticks: 9, events: [{at: 1, wrong_sensors: 0, ticks: 3}]}' && says 'wrong sensors need an error' &&
    run 2 simulate plate-50-patches --set 'simulate={ticks: 9, events: [{at: 1, target: 1, error: 3}]}' && says "'error' belongs to wrong_sensors"
check 'check tells what the sensor gate finds; wrong sensors need an error' $?
gate='control={rate: 1000, sensor_gate: true}'
run 0 check plate-50-patches --set "$gate" --json && json "j['certificate']['storms_gated']==0 and j['certificate']['wrong_sensor_moves']<.02" &&
    run 0 check plate-50-patches --set "$gate" --set 'simulate={ticks: 9, sensors: {range: 0.002}}' && grep -qF 'OF THESE STORMS IT TAKES HEALTHY READINGS AWAY; state larger ranges' "$dir/out" &&
    run 0 check plate-50-patches --set "control={rate: 1000}" --set "simulate={ticks: 9, sensors: {range: 0.08}}" --json && json "j['certificate']['wrong_sensor_moves']>1"
check 'the certificate runs the sensor gate in its storms, and one sensor at the end of its range' $?
wrong='simulate={ticks: 100, events: [{at: 40, wrong_sensors: 0, error: 0.01, ticks: 30}]}' gate='control={sensor_gate: true}'
right() { json "max(p['controller']['worst'] for p in j['phases'][1:]) < 1.05 * j['phases'][0]['controller']['steady']"; }
run 0 simulate "$dir/measured.yaml" --set "$gate" --set "$wrong" --json && right && run 0 simulate "$dir/measured.yaml" --set "$gate" --set "$wrong" --set influence.drop_below=0.2 --json && right &&
    run 0 simulate "$dir/measured.yaml" --set "$gate" --set "$wrong" --set "$curve" --set "$unipolar" --set "$raised" --json && right
check 'a sensor gate with a measured matrix, with small entries that count as zero, and with actuator curves' $?
gate='control={rate: 1000, sensor_gate: true}' wrong='{at: 300, wrong_sensors: 0, error: 0.05, ticks: 60}' slow='--set limits.voltage=[-300,300] --set limits.step_limit=20'
hysteresis='hysteresis={range: [-300, 300], slopes: [0.37, 0.43, 0.44, 0.5], slack: [40, 120, 240], above: [0.1, 0.2, 0.2], below: [0.1, 0.2, 0.2], offset: -3, creep_time: [1], creep: [0.03]}'
# shellcheck disable=SC2086
for device in '' '--device host-32'; do
    run 0 simulate plate-50-patches $slow --set "$gate" --set "$hysteresis" --set target.free=[piston] $device --json \
        --set "simulate={ticks: 500, sensors: {noise: 1e-7, delay: 2}, amplifiers: {step: 0.05}, events: [$wrong]}" && right
    check "a sensor gate with late readings, hysteresis, free functions and converter steps $device" $?
done
gains='control.modal_gains={modes: 4, gain: [0.6, 0.4, 0.3, 0.2], leak: 0.002, other_gain: 0.1}'
run 0 check "$dir/measured.yaml" --set "$gains" && grep -qF 'gains of modes: 4 singular vectors of the influence matrix, gain 0.2 to 0.6, leak 0.002; the rest: gain 0.1, leak 0' "$dir/out" &&
    run 0 check "$dir/measured.yaml" --set "$gains" --json && json "j['modal_gains']['gain']==[.6,.4,.3,.2] and abs(j['modal_gains']['growth']-.92)<1e-6 and abs(j['modal_gains']['noise']-.6/(.602*1.398)**.5)<1e-9" &&
    run 2 check "$dir/measured.yaml" --set 'control.modal_gains={modes: 8}' && says '8 modes, but 7 amplifiers can move' &&
    run 3 tables "$dir/measured.yaml" --set 'control.modal_gains={gain: 1.6}' -o "$dir/gains.h" && says 'write a gain of at most 1.5' && [ ! -e "$dir/gains.h" ] &&
    run 0 simulate "$dir/measured.yaml" --set "$gains" --set simulate.ticks=300 --set 'simulate.sensors.delay=1' --json && json "j['phases'][1]['controller']['steady'] < 1.05 * j['phases'][1]['optimum']"
check 'gains of modes: check, simulate, refusals' $?
for device in host-32 host-64; do run 0 simulate "$dir/measured.yaml" --set "$gains" --device $device; check "gains of modes: $device" $?; done
run 3 check plate-50-patches --set 'control={rate: 1000, modal_gains: {gain: 0.3}}' && says 'lower the gains, or remove control.modal_gains so that the tick damps vibration' &&
    run 0 check plate-50-patches --set 'control={rate: 1000, modal_gains: {gain: 0.0002}}' && grep -qF 'and does not damp' "$dir/out"
check 'gains of modes with vibration: the loop is assessed with them' $?
run 2 solve "$dir/measured.yaml" && says 'needs a structure'; check 'solve of a measured matrix is refused by name' $?
run 2 modes "$dir/measured.yaml" && says 'need a structure'; check 'modes of a measured matrix are refused by name' $?
for image in linear nonlinear; do
    run 2 tables "$dir/measured.yaml" --image $image -o "$dir/t.h" && says 'needs a structure' && [ ! -e "$dir/t.h" ]
    check "a $image image of a measured matrix is refused by name" $?
done
run 0 simulate "$dir/measured.yaml" --set simulate.ticks=300 --json && json "j['phases'][1]['controller']['steady'] < 1.03 * j['phases'][1]['optimum']"
check 'new measured: the supervisor lets the loop go on without an announced dead amplifier' $?
for kind in plate mirror panel measured; do
    run 0 tables "$dir/$kind.yaml" --prefix p -o "$dir/t.h" && grep -q '{&pzs_supervisor_block, &p_supervision},' "$dir/t.h" &&
        run 0 tables "$dir/$kind.yaml" --prefix p -o "$dir/t.h" --set safety=none && ! grep -q supervisor "$dir/t.h" || break
done
check 'new ...: the tables have a supervisor, but not with safety: none' $?
rm -f "$dir/t.h"
rows='limits.difference={limit: 10}'
run 0 shape "$dir/measured.yaml" --set "$rows" && grep -q 'limits between amplifiers (difference, sum): [1-9][0-9]* of 6 bind: centre - e1' "$dir/out"
check 'shape names the limits between amplifiers that bind' $?
run 0 simulate "$dir/measured.yaml" --set "$rows" && grep -q '^ *0 limits between amplifiers violated$' "$dir/out" && run 0 tables "$dir/measured.yaml" --set "$rows" -o "$dir/rows.h" &&
    gcc -std=c99 -Wall -Werror -Iinclude -x c -fsyntax-only -Wno-unused "$dir/rows.h"
check 'simulate and tables with limits between amplifiers' $?
run 2 shape "$dir/measured.yaml" --set "$rows" --set 'limits.each=[{actuator: e1, hold: 30}, {actuator: e3, hold: 0}]' &&
    says 'no voltages keep these limits' && says 'e1 - e2 from -10 to 10; e2 - e3 from -10 to 10; widen'
check 'limits between amplifiers that clash are named' $?
run 2 check "$dir/measured.yaml" --set "$rows" --set 'safety={selftest: {amplitude: 5}}' && says 'do not go together with safety.selftest'
check 'limits between amplifiers beside a self-test' $?
absolute='limits.absolute_sum={limit: 20, actuators: [e1, e2, e3], weights: [1, 2, 1]}'
run 0 shape "$dir/measured.yaml" --set "$absolute" --set "$rows" && grep -q 'absolute sum): [1-9] of 7 bind: .*|e1| + |e2| + |e3|' "$dir/out" &&
    run 0 simulate "$dir/measured.yaml" --set "$absolute" && grep -q '^ *0 limits between amplifiers violated$' "$dir/out" && run 0 tables "$dir/measured.yaml" --set "$absolute" -o "$dir/rows.h" &&
    grep -q ' 1, &pzs_absolute_rows_calls,' "$dir/rows.h" && gcc -std=c99 -Wall -Wextra -Werror -Iinclude -x c -fsyntax-only -Wno-unused "$dir/rows.h"
check 'shape, simulate and tables with a limit of a sum of absolute values' $?
run 2 shape "$dir/measured.yaml" --set 'limits.absolute_sum={limit: 20}' --set 'limits.each=[{actuator: e1, hold: 30}]' && says '|centre| + |e1| + |e2| + ... + |e6| up to 20; widen' &&
    run 2 shape "$dir/measured.yaml" --set 'limits.absolute_sum={limit: 20, weights: [1, 2]}' && says '2 weights for 7 amplifiers' &&
    run 2 shape "$dir/measured.yaml" --set 'limits.sum={voltage: [-5, 5], actuators: [e1, e1]}' && says "item 2 of 'actuators' repeats an amplifier"
check 'limits of sums of absolute values that are wrong or clash' $?
mkdir "$dir/odd*" && cp "$dir/measured-matrix.csv" "$dir/odd*/" &&
    run 0 tables "$dir/measured.yaml" --set 'influence.file=odd*/measured-matrix.csv' -o "$dir/odd.h" && gcc -std=c99 -Wall -Werror -Iinclude -x c -fsyntax-only -Wno-unused "$dir/odd.h"
check 'tables: a file name that holds the end of a comment does not end the comment' $?
run 0 shape "$dir/measured.yaml" --limit 60 --limit 30 --npz "$dir/a.npz" --csv-dir "$dir/arrays" --report "$dir/m.html" --svg "$dir/m.svg" &&
    /usr/bin/python3 tests/cli/arrays_check.py "$dir/a.npz" "$dir/arrays"; check 'shapes in .npz and CSV are influence times voltages' $?
/usr/bin/python3 tests/cli/report_check.py "$dir/m.html" xml && /usr/bin/python3 tests/cli/report_check.py "$dir/m.svg" xml
check 'the report of a measured matrix is well-formed' $?
run 0 simulate "$dir/measured.yaml" --npz "$dir/s.npz" --csv "$dir/s.csv" && /usr/bin/python3 tests/cli/arrays_check.py "$dir/s.npz" "$dir/s.csv" ticks
check 'the ticks in .npz are those of --csv' $?
run 0 solve bimorph-sensor --json --npz "$dir/b.npz" && cp "$dir/out" "$dir/b.json" &&
    [ "$(/usr/bin/python3 tests/cli/arrays_check.py "$dir/b.npz" "$dir/b.json" outputs)" = 'm V V V V V C' ]
check 'the outputs in .npz are those of --json, voltages and charges too' $?
run 0 new poke-voltages && mv "$dir/out" "$dir/voltages.csv" && run 0 new poke-shapes && mv "$dir/out" "$dir/shapes.csv" &&
    run 0 calibrate "$dir/measured.yaml" --voltages "$dir/voltages.csv" --shapes "$dir/shapes.csv" -o "$dir/matrix.csv" && grep -qF 'fault: e4 is dead' "$dir/out" &&
    run 0 check "$dir/measured.yaml" --set influence.file=matrix.csv --set influence.scale=1; check 'calibrate names a dead actuator and writes a matrix' $?
run 0 calibrate "$dir/measured.yaml" --voltages "$dir/voltages.csv" --shapes "$dir/shapes.csv" -o "$dir/matrix.csv" && grep -qF 'in a scene, without scale' "$dir/out" &&
    ! grep -q '^warning' "$dir/out"; check 'calibrate says that its matrix needs no scale' $?
tac "$dir/shapes.csv" | grep -v '^[#a-z]' >"$dir/turned.csv" && run 0 calibrate --voltages "$dir/voltages.csv" --shapes "$dir/turned.csv" && grep -q '^warning: the shapes do not follow' "$dir/out" &&
    run 0 calibrate --voltages "$dir/voltages.csv" --shapes "$dir/shapes.csv" && ! grep -q '^warning' "$dir/out"; check 'calibrate warns of shapes in another order than the voltages' $?
awk -F, -v OFS=, 'NR == 4 { $5 *= 1000 } 1' "$dir/shapes.csv" >"$dir/outlier.csv"
run 0 calibrate --voltages "$dir/voltages.csv" --shapes "$dir/outlier.csv" && grep -q '^warning: line 4, column 5 of the shapes is .* times .*leave this poke out of both files' "$dir/out" &&
    run 0 calibrate --voltages "$dir/voltages.csv" --shapes "$dir/outlier.csv" --json && json "len(j['outliers']) == 1" &&
    run 0 calibrate --voltages "$dir/voltages.csv" --shapes "$dir/shapes.csv" --json && json "j['outliers'] == []"
check 'calibrate names a reading 1000 times too large' $?
printf '10 0 0\n0 10 0\n10 10 0\n5 -10 0\n' >"$dir/v0.csv"
printf '1 2\n2 1\n3 3\n-1.5 0\n' >"$dir/x0.csv"
run 2 calibrate --voltages "$dir/v0.csv" --shapes "$dir/x0.csv" && says 'the voltage of v3 is 0 in all 4 pokes'
check 'calibrate names an actuator that no poke moves' $?
/usr/bin/python3 -c "
import sys
for line in open(sys.argv[1]): print(','.join('%.9g' % (1000 * float(x)) for x in line.split(',')))" "$dir/shapes.csv" >"$dir/micrometres.csv" &&
    run 0 calibrate "$dir/measured.yaml" --voltages "$dir/voltages.csv" --shapes "$dir/micrometres.csv" &&
    grep -qF 'times those of the scene; write shapes in its unit of length, mm' "$dir/out"
check 'calibrate notices shapes in another unit than the scene' $?
# 400 pokes of the matrix of measured.yaml with a drift, and 0.2 of the voltage of e1 on e4
/usr/bin/python3 - "$dir" <<'POKES'
import csv, random, sys
random.seed(2)
matrix = [[1e-3 * float(x) for x in row[2:]] for row in list(csv.reader(open(sys.argv[1] + '/measured-matrix.csv')))[1:]]
for row in matrix:
    row[1] += 0.2 * row[4]
voltages = [[random.uniform(-50, 50) for _ in matrix[0]] for _ in range(400)]
open(sys.argv[1] + '/many-v.csv', 'w').write(''.join(','.join('%.9g' % v for v in line) + '\n' for line in voltages))
open(sys.argv[1] + '/many-x.csv', 'w').write(''.join(','.join('%.9g' % (
    sum(b * v for b, v in zip(row, line)) + 3e-6 * k + random.gauss(0, 1e-6)) for row in matrix) + '\n'
    for k, line in enumerate(voltages)))
POKES
run 0 calibrate "$dir/measured.yaml" --voltages "$dir/many-v.csv" --shapes "$dir/many-x.csv" &&
    grep -qF 'drift of the shapes: 3e-06 mm a poke' "$dir/out" && grep -qF 'cross-talk, 0.2 of the voltage of e1 acts on e4' "$dir/out" &&
    run 0 calibrate "$dir/measured.yaml" --voltages "$dir/many-v.csv" --shapes "$dir/many-x.csv" --json &&
    json "abs(j['drift'] - 3e-6) < 5 * j['drift_error'] and abs(j['memory']) < 5 * j['memory_error'] and abs(j['noise'] - 1e-6) < 5e-8 and len(j['faults']) == 1"
check 'calibrate: 400 pokes, drift and cross-talk' $?
run 2 calibrate --voltages "$dir/voltages.csv" && says '--shapes FILE'; check 'calibrate without shapes says what is missing' $?
head -c 100000000 /dev/zero >"$dir/huge.csv"
run 2 check "$dir/measured.yaml" --set influence.file=huge.csv && says 'huge.csv: it has 95.4 MB'; check '100 MB are refused by their size' $?
rm -f "$dir/huge.csv"
# Scenes in the words of version 0.1: the migrated scene gives the tables of the shipped one, but for the hash of the file
for s in plate-50-patches plate-closed-loop plate-few-sensors hyperboloid-patches; do
    set -- --set name=$s
    [ $s != plate-closed-loop ] || set -- --set 'simulate.events=[]' # the shipped scene has another schedule
    run 2 check "tests/cli/old_scenes/$s.yaml" && says 'is now called' && run 0 migrate "tests/cli/old_scenes/$s.yaml" && cp "$dir/out" "$dir/new.yaml" &&
        run 0 migrate "$dir/new.yaml" && cmp -s "$dir/out" "$dir/new.yaml" && run 0 --migrate "$dir/new.yaml" && cmp -s "$dir/out" "$dir/new.yaml" &&
        for scene in "$dir/new.yaml" "$s"; do
            run 0 tables "$scene" "$@" --image linear --quasi-static --prefix t -o "$dir/t.h" || break
            sed -E 's/^( *[0-9]+u, )0x[0-9a-f]+u, PZS_BY_BITS/\1HASH/; s/lost ticks/missed ticks/' "$dir/t.h" >"$dir/$(basename "$scene").h"
        done && [ "$(grep -c HASH "$dir/$s.h")" -ge 2 ] && cmp -s "$dir/new.yaml.h" "$dir/$s.h"
    check "migrated scene $s: the same tables" $?
done
run 0 migrate scordelis-lo && cmp -s "$dir/out" host_tools/scenes/scordelis-lo.yaml; check 'migrate: a scene that needs nothing is printed unchanged' $?
run 2 migrate && says 'name a scene'; check 'migrate without a scene' $?
run 0 check tests/rigs/scenes/outline-plate.yaml --json && json "abs(j['electrode_areas']['up'][0] / (0.01 * 3.141592653589793) - 1) < 1e-12"
check 'check tells the areas of electrodes of any outline' $?
run 0 check tests/rigs/scenes/smeared-plate.yaml --json && json "(lambda s: s['upper']['elements']==20 and 0<s['upper']['least_share']<1e-3 and .5<s['upper']['most_share']<1 and s['lower']['elements']==12)(j['smeared_stiffness'])"
check 'check --json: elements with smeared stiffness' $?
run 0 solve tests/rigs/scenes/smeared-plate.yaml --report "$dir/r.html" &&
    grep -q "layer 'upper': stiffness is smeared over 20 elements of which patches cover" "$dir/out" &&
    grep -q 'the error near their outlines is of the size of an element' "$dir/out" && grep -q 'The stiffness of the layer upper is smeared over 20 elements' "$dir/r.html"
check 'solve and its report tell where stiffness is smeared' $?
run 0 schema && cmp -s "$dir/out" host_tools/scenes/scene.schema.json; check 'scene.schema.json is what pzs schema writes (else: make schema)' $?
/usr/bin/python3 tests/cli/schema.py "$PZS" host_tools/scenes/scene.schema.json "${SCHEMA_EVERY:-25}" tests/cli/schema/scenes.yaml host_tools/scenes/*.yaml >"$dir/out" 2>"$dir/err"
check 'schema and reader agree on every shipped scene and on changed ones' $?
run 0 keys limits && grep -q '^  rate_limit .*number above 0, unit as V/s' "$dir/out" && run 0 help keys && grep -q '^  rate_limit ' "$dir/out" && grep -q '^simulate ' "$dir/out"
run 0 keys loads && grep -q '^  point  *one of 3 mappings$' "$dir/out" && [ "$(sed -n '/^  point /,/^  line /p' "$dir/out" | grep -c -x -e '    either' -e '    or')" -eq 3 ]; check 'keys: mappings of which one is written are kept apart' $?
check 'keys lists the keys of a scene' $?
run 2 keys limit && says "no section 'limit' (did you mean 'limits'?)"; check 'keys of a mistyped section' $?
run 2 new mirrow && says "did you mean 'mirror'"; check 'new of a mistyped scene' $?
run 2 shape plate-50-patches --limit -3 && says '--limit'; check 'negative limit' $?
run 2 shape plate-50-patches --limit nan && says '--limit'; check 'limit that is not a number' $?
for limit in inf -inf 0 1e999 junk '' 5,-5 1,2,3 1, ,1 1,inf nan,1; do
    run 2 shape plate-50-patches --limit "$limit" && says "--limit"; check "bad limit '$limit'" $?
done
run 0 shape plate-50-patches --limit -50,300 --limit 400 --set materials.G1195.field_limit=1.2e6 --set 'limits.each=[{actuator: v_1_1, hold: 0}, {actuator: v_1_2, voltage: [-10, 10]}]' --json &&
    json "all(r['voltages']['v_1_1']==0 for r in j['results'][:7]) and all(abs(r['voltages']['v_1_2'])<=10 for r in j['results'][1:7]) and all(-50<=v<=300 for r in j['results'][1:4] for v in r['voltages'].values()) and all(abs(v)<=300.0001 for r in j['results'][4:7] for v in r['voltages'].values())"
check 'the narrowest limit wins: held, own, field, --limit' $?
run 2 shape plate-50-patches --limit 30,90 --set 'limits.each=[{actuator: v_2_3, voltage: [-80, 20]}]' && says 'v_2_3 has no voltage left'; check 'limits that do not overlap name the amplifier' $?
run 0 shape plate-50-patches --limit 200 --set 'target.value=0.1*x*(y-0.1)+1e-4' && grep -q '11 of 121 target rows lie on constrained dof and cannot move, 11 of them' "$dir/out" && grep -q 'with them it would be 10.645%' "$dir/out"
check 'target rows that cannot move are reported' $?
run 0 shape plate-50-patches --limit 200 --set 'target.free=[piston]' --json && json "j['free_functions']==1 and j['fixed_rows']==11 and j['fixed_rows_off']==0 and j['shape_error_all_rows']>0" &&
    cp "$dir/out" "$dir/free" && run 0 shape plate-50-patches --limit 200 --set 'target.value=0.1*x*(y-0.1)+1e-2' --set 'target.free=[piston]' --json &&
    json "abs(j['shape_error']/json.load(open('$dir/free'))['shape_error']-1)<1e-9"
check 'a free piston in the target costs nothing' $?
run 2 tables plate-50-patches --quasi-static --set 'target.free=[tip]' --image linear -o "$dir/free.h" && says 'target.free' && [ ! -e "$dir/free.h" ] &&
    run 0 tables plate-50-patches --quasi-static --set 'target.free=[tip]' -o "$dir/free.h" && grep -q 'without the free functions of the target' "$dir/free.h"
check 'free functions: carried by the control image, refused by the linear one' $?
run 2 simulate plate-closed-loop --set 'target.free=[piston]' --set 'simulate.events=[{at: 9, dead: [v_1_1], announced: detected}]' && says 'announced: detected'; check 'free functions and the fault detector: exit 2' $?
run 2 solve no-such-scene && says 'no-such-scene'; check 'unknown scene' $?
run 0 list && [ "$(wc -l <"$dir/out")" -ge 9 ]; check 'list names the shipped scenes' $?
for s in $("$PZS" list | cut -d' ' -f1); do
    run 0 check "$s"; check "shipped scene is sound: $s" $?
done

run 0 solve scordelis-lo --json && json "abs(j['ratios']['edge']-.9853)<6e-5 and j['dof']==1872"; check 'solve --json' $?
common='scene nodes elements element_types dof half_bandwidth real_bits kinematics condition'
for k in 'scordelis-lo' 'hemisphere'; do
    run 0 solve $k --json && json "not [k for k in '$common load_steps linear_solves iterations residual negative_pivots outputs seconds'.split() if k not in j] and all(j['seconds'][k]>=0 for k in 'assemble factor solve total'.split()) and all(type(v) is float for v in j['outputs'].values())"
    check "keys of solve --json: $k" $?
done
run 0 solve scordelis-lo --json && json "0 < j['solver_residual'] < 1e-6 and 0 < j['solver_error_estimate'] < 1e-6 and 'error' not in j" &&
    run 0 solve scordelis-lo --report "$dir/r.html" && grep -q '^  linear solve: solver residual .*, solver error estimate .* in the energy norm' "$dir/out" &&
    grep -q '^  discretisation error: not part of these figures; --error estimates it' "$dir/out" && grep -q 'Solver residual' "$dir/r.html" && grep -q 'Solver error estimate' "$dir/r.html" &&
    run 0 solve hemisphere && grep -q 'solver residual .* of the load$' "$dir/out" && grep -q '^  discretisation error: not part' "$dir/out"
check 'errors of the solver are called so, and the discretisation error is said to be missing' $?
run 0 check plate-50-patches && grep -q '^  control  *[0-9]' "$dir/out" && grep -q '^  linear  *[0-9]' "$dir/out"; check 'check tells what each image needs' $?
run 0 check plate-50-patches && grep -q '^  limit_field: host_tools/scenes/plate-50-patches.yaml:34:' "$dir/out"
check 'the path of a shipped scene in a message begins at the current folder' $?
run 0 check plate-50-patches --json && json "j['images']['control']['flash']['double']==8*(121*25+25*25+2*121+4*25) and j['images']['linear']['ram']['double']>2*j['images']['linear']['ram']['float']-4000"; check 'check --json' $?
run 0 shape plate-50-patches --limit 200 --limit 100 --json && json "abs(j['results'][0]['shape_error']-.05538)<1e-5"; check 'shape without limits .05538' $?
json "not [k for k in '$common voltages shape_error shape_error_before clipped_error active kkt'.split() if k not in j] and len(j['voltages'])==25 and j['shape_error']==j['results'][1]['shape_error'] and j['clipped_error']==j['results'][2]['shape_error'] and abs(j['shape_error_before']-1)<1e-12"; check 'keys of shape --json' $?
json "abs(j['results'][1]['shape_error']-.08975)<1e-5 and j['results'][1]['active']==6"; check 'shape within 200 V .08975, 6 active' $?
json "abs(j['results'][2]['shape_error']-.520)<5e-4"; check 'clipped .520' $?
json "abs(j['regularised_error']-.15939)<1e-5 and j['results'][3]['shape_error']==j['regularised_error'] and j['results'][3]['name']=='regularised, then clipped' and 1e-3<j['results'][3]['regularisation']<1e-2"; check 'regularised with the best parameter, then clipped .159' $?
json "abs(j['results'][4]['shape_error']-.36114)<1e-5"; check 'shape within 100 V .36114' $?
json "max(abs(v) for v in j['results'][1]['voltages'].values())<=200 and j['results'][1]['kkt']<=1e-9"; check 'no voltage beyond 200 V by one bit, KKT 1e-9' $?
json "[r for r in j['results'] if r['name']=='published'][0]['shape_error'] > .0705"; check 'published voltages beside' $?
run 0 shape mirror --set mesh.theta1.elements=10 --set mesh.theta2.elements=16 --limit 30 --limit 100 --json && json "len(j['modes'])==14 and all(m['unconstrained_error']<=l['shape_error']*(1+1e-9)<=l['regularised_error']*(1+1e-8)<=l['clipped_error']*(1+2e-8) for m in j['modes'] for l in m['limits']) and [l['limits'][1] for l in j['modes'][0]['limits']]==[30,100]"; check 'modes of shape --json' $?
run 0 shape stack-mirror --report "$dir/k.html" && grep -q 'Z4 defocus' "$dir/out" && [ "$(grep -c '<g><title>s_[0-9]*_1: ' "$dir/k.html")" -ge 148 ]
check 'stacks are drawn in their places' $?
run 0 solve stack-mirror --set 'loads=[{temperature: 20}]' --json && /usr/bin/python3 -c 'import json, sys
force = json.load(sys.stdin)["springs"]
sys.exit(not (len(force["s"]) == 37 and max(abs(x) for own in force.values() for x in own) < 1e-6))' <"$dir/out"
check 'solve lists forces of springs; a determinate mount has none under heat' $?
run 0 shape mirror --report "$dir/m.html" && grep -q 'Z11 spherical .* 3.959% .* 185.851%' "$dir/out" && grep -q 'Mode by mode' "$dir/m.html"; check 'modes as a table and a picture' $?
run 0 solve bimorph-sensor --json && json "abs(j['outputs']['V1']/292.351-1)<1e-6 and j['electrodes']['s_1_1']['circuit']=='open' and abs(j['electrodes']['s_1_1']['capacitance_held']/1.062e-11-1)<1e-12 and 1<j['open_over_short_stiffness']<1.01"; check 'electrodes of solve --json' $?
run 0 solve bimorph-sensor && grep -q '^  s_1_1 *open *2.923510e+02' "$dir/out" && grep -q 'stiffer than short' "$dir/out"; check 'electrodes of solve' $?
run 0 solve crawley-lazarus --report "$dir/c.html" && grep -q 'Along lines' "$dir/c.html"; check 'curves along lines' $?
run 0 solve clamped-plate --set element=improved --set materials.plate.nu=0.49; check '--set changes the scene' $?

# Outputs at several nodes or electrodes: every value comes out, and each is that of an output at its node alone
several='outputs=[{name: all, contact: pressure, at: nodes}, {name: edge, contact: pressure, edge: theta2-}, {name: nodes, contact: nodes},
    {name: part, contact: pressure, at: {theta1: [0.5, 0.7]}}, {name: u, u3: outer, edge: theta2-}, {name: one, contact: pressure, at: {theta1: pi/5, theta2: 0}}]'
run 0 solve ring-contact --set "$several" --json && json "(lambda o, p:
    len(o['all']) == 62 and len(o['edge']) == 31 and len(o['part']) == 4 and sum(v != 0 for v in o['all']) == o['nodes'] > 0 and
    [e['value'] for e in p['all']] == o['all'] and sorted(p['u'][0]) == ['theta1', 'theta2', 'value', 'x', 'y', 'z'] and
    p['edge'] == [e for e in p['all'] if e['theta2'] == 0] and p['part'] == [e for e in p['all'] if .5 <= e['theta1'] <= .7] and
    o['one'] == [e['value'] for e in p['edge'] if abs(e['theta1']-3.14159265/5) < 1e-6][0] == max(o['all']) > 0 and
    all(abs(e['x']**2 + e['y']**2 - 1e4) < 1e-9 and e['z'] == e['theta2'] for e in p['all']))(j['outputs'], j['output_places'])"
check 'contact pressures of an edge, a region and all nodes in JSON' $?
run 0 solve ring-contact --set "$several" && [ "$(awk '/ theta1 .* all$/ {on = 1; next} /^  [a-z]/ {on = 0} on' "$dir/out" | wc -l)" -eq 62 ] &&
    grep -q '^ *6.283185e-01  0.000000e+00   8.090170e+01  5.877853e+01  0.000000e+00 * 1.039' "$dir/out"
check 'the same as a table with the coordinates of the nodes' $?
run 0 solve bimorph-sensor --set 'outputs=[{name: V, voltage: s}, {name: Q, charge: s}]' --json && json "
    [e['electrode'] for e in j['output_places']['V']] == list(j['electrodes']) and len(j['outputs']['V']) == len(j['outputs']['Q']) == 5 and
    [e['value'] for e in j['output_places']['V']] == j['outputs']['V'] == [e['voltages'] for e in j['electrodes'].values()]" &&
    run 0 solve bimorph-sensor --set 'outputs=[{name: V, voltage: s}]' && [ "$(grep -c '^    s_[1-5]_1  *[0-9.e+]*$' "$dir/out")" -eq 5 ]
check 'the voltages of several electrodes under their names' $?
run 0 shape plate-50-patches --set 'outputs.0={name: rim, u3: middle, edge: theta1+}' --json && json "
    len(j['results'][1]['outputs']['rim']) == 11 and [e['value'] for e in j['output_places']['rim']] == j['outputs']['rim'] and j['outputs'] == j['results'][1]['outputs']" &&
    run 0 shape plate-50-patches --set 'outputs.0={name: rim, u3: middle, edge: theta1+}' && [ "$(awk '/ theta1 .* rim$/ {on = 1; next} /^$/ {on = 0} on' "$dir/out" | wc -l)" -eq 11 ]
check 'shape: an output of an edge has all its nodes' $?

run 0 tables plate-50-patches --quasi-static --prefix a -o "$dir/one.h" && run 0 tables plate-50-patches --quasi-static --prefix a -o "$dir/two.h" && cmp -s "$dir/one.h" "$dir/two.h"
check 'the same scene gives the same tables' $?
run 2 tables plate-50-patches && says '-o FILE'; check 'tables without -o' $?
run 0 tables plate-50-patches --quasi-static --prefix a -o - && cmp -s "$dir/out" "$dir/one.h" && grep -q 'control image' "$dir/err" && [ ! -e - ]; check 'tables on standard output, the summary beside them' $?
run 0 solve scordelis-lo --vtu "$dir/a.vtu" && run 0 solve scordelis-lo --vtu - && cmp -s "$dir/out" "$dir/a.vtu"; check 'a VTU file on standard output' $?
run 2 solve scordelis-lo --npz - && says 'binary file' && run 2 fmu plate-50-patches --plant -o - && says 'binary file' && run 2 solve scordelis-lo --csv-dir - && says 'several files' &&
    run 2 solve scordelis-lo --json --vtu - && says '--json goes to standard output' && run 2 solve scordelis-lo --svg - --vtu - && says 'one name'
check 'what standard output cannot take is refused by name' $?
run 1 tables plate-50-patches --quasi-static -o "$dir/none/x.h" && says 'cannot write'; check 'tables into no folder' $?
run 1 shape none.yaml --report "$dir/none/x.html" && says 'cannot write' && run 1 shape none.yaml --npz '' && says "cannot write ''"
check 'a file that cannot be written is refused before the computation' $?
run 0 solve scordelis-lo --report "$dir/r.html" --vtu "$dir/r.vtu" && [ -s "$dir/r.html" ] && [ -s "$dir/r.vtu" ] && ! ls "$dir"/*.part >/dev/null 2>&1
check 'report and VTU file are whole' $?

scene "$dir/good.yaml"; run 0 solve "$dir/good.yaml"; check 'the small scene is sound' $?
run 0 solve "$dir/good.yaml" --set 'units={length: m, force: N}' --set 'layers.0.thickness=1 cm' --set 'materials.steel.E=200 GPa' --json && json "j['warnings']==[]" && cp "$dir/out" "$dir/units"
check 'numbers with units, and no warnings' $?
run 0 solve "$dir/good.yaml" --json && /usr/bin/python3 -c "import json,sys; a,b=(json.load(open('$dir/'+f))['outputs'] for f in ('out','units')); sys.exit(a!=b)"
check 'numbers with units: the same bits as without' $?
run 2 solve "$dir/good.yaml" --set 'layers.0.thickness=1 cm' && says 'add length: mm to units'; check 'a unit in a scene without units' $?
run 0 solve bimorph-sensor --json && json "[w['rule'] for w in j['warnings']]==['displacement'] and abs(j['warnings'][0]['value']-9.9)<.01 and j['warnings'][0]['limit']==1"; check 'warnings of solve --json' $?
run 0 solve bimorph-sensor && grep -q '^Warnings:$' "$dir/out" && grep -q '^  displacement: .*use kinematics: nonlinear' "$dir/out" && [ ! -s "$dir/err" ]; check 'warnings of solve' $?
run 1 solve bimorph-sensor --strict && grep -q '^Warnings:$' "$dir/out" && run 0 solve scordelis-lo --set loads.0.z=-9 --strict && ! grep -q Warnings "$dir/out"; check 'warnings are failures under --strict' $?
run 1 modes plate-50-patches --strict --set materials.G1195.density=7.6 && grep -q '^  light_material: .*G1195' "$dir/out" && run 0 modes plate-50-patches --json --set materials.G1195.density=7.6 && json "any(w['rule']=='light_material' for w in j['warnings'])"; check 'modes: a density in a wrong unit is a warning' $?
run 0 check plate-50-patches --json && json "[(w['rule'],w['value'],w['line']) for w in j['warnings']]==[('limit_field',2.4e6,34)]"; check 'warnings of check --json' $?
run 0 shape plate-50-patches --json && json "[w['rule'] for w in j['warnings']]==['limit_field','displacement']"; check 'warnings of shape --json' $?
bad 'unknown key' 's/supports:/suports:/' ":10:"
bad 'missing material' 's/{material: steel/{material: brass/' ':9:'
bad 'zero thickness' 's/0\.01/0/' ':9:'
bad 'negative stiffness' 's/2e11/-2e11/' ':7:'
bad 'incompressible' 's/nu: 0.3/nu: 0.5/' ':7:'
bad 'NaN' 's/2e11/.nan/' ':7:'
bad '1e308' 's/0\.01/1e308/' ':9:'
bad 'loose structure' 's/fix: clamped/fix: [u1]/' 'add supports'
bad 'no supports' '/supports/,/fix/d' 'supports'
bad 'inverted mesh' 's/theta1: {from: 0, to: 1/theta1: {from: 1, to: 0/' ':4:'
bad 'mesh through a pole' 's/type: plate/type: polar/' 'A2 = 0'
bad 'point off the mesh' 's/at: {theta1: 1,/at: {theta1: 0.9,/' ':15:'
bad 'infinite load' 's/pressure: 1/pressure: 1\/x/' 'finite'
bad 'syntax' 's/{edge/[edge/' ':1'
bad 'too many unknowns' 's/elements: 4/elements: 200/' 'elements'
head -c 100000000 /dev/zero | tr '\0' 'a' >"$dir/huge.yaml"
began=$(date +%s); run 2 check "$dir/huge.yaml" && [ $(($(date +%s) - began)) -lt 3 ]; check 'a file of 100 MB is refused at once' $?
rm -f "$dir/huge.yaml"
head -c 20000 /dev/urandom >"$dir/noise.yaml"; run 2 check "$dir/noise.yaml"; check 'binary noise' $?
: >"$dir/empty.yaml"; run 2 check "$dir/empty.yaml"; check 'empty file' $?
run 2 check "$dir" ; check 'a folder' $?
echo kept >"$dir/kept.html"; run 2 solve "$dir/bad.yaml" --report "$dir/kept.html"; grep -q kept "$dir/kept.html"; check 'an earlier file survives a failure' $?

# Tables and library tied together
cat >"$dir/p.c" <<'EOT'
#include "a.h"
int main(void) { static char work[1 << 20]; pzs_control c; return (int)pzs_control_init(&c, &a_problem, 0, work, sizeof work); }
EOT
sed 's/PZS_TABLE_FORMAT != [0-9]*/PZS_TABLE_FORMAT != 0/' "$dir/one.h" >"$dir/a.h"
! gcc -std=c99 -Iinclude -I"$dir" -c "$dir/p.c" -o "$dir/p.o" 2>/dev/null; check 'tables of another format do not compile' $?
cp "$dir/one.h" "$dir/a.h"
gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=64 "$dir/p.c" "$B/64/libpiezoshape.a" -lm -o "$dir/p" && "$dir/p"; check 'a double program runs on its tables' $?
gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=32 "$dir/p.c" "$B/32/libpiezoshape.a" -lm -o "$dir/p" && "$dir/p"; check 'a float program runs on the same tables' $?
! gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=32 "$dir/p.c" "$B/64/libpiezoshape.a" -lm -o "$dir/p" 2>/dev/null; check 'a float program does not link with the double library' $?

cat >"$dir/q.c" <<'EOT'
#include "q.h"
static double work[1 << 18];
int main(void)
{
    pzs_model m;
    pzs_control c;
    pzs_status status = pzs_model_init(&m, &q_structure, work, sizeof work);
    static pzs_real b[Q_INPUTS * Q_OUTPUTS], more[Q_CONTROL_BYTES / sizeof(pzs_real) + 1];
    if (status == PZS_OK) status = pzs_assemble(&m, 0, 0);
    if (status == PZS_OK) status = pzs_factor(&m);
    if (status == PZS_OK) status = pzs_influence(&m, b);
    return status != PZS_OK ? (int)status : (int)pzs_control_init(&c, &q_problem, b, more, sizeof more);
}
EOT
run 0 tables plate-50-patches --quasi-static --set element=improved --set 'limits.voltage=[-0.0, 3]' --image linear --prefix q -o "$dir/q.h"
for bits in 32 64; do
    gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits "$dir/q.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/q" && "$dir/q"
    check "a linear image of the improved element starts, $bits bits" $?
done
run 0 tables plate-50-patches --quasi-static --set 'loads=[{face: outer, pressure: 5}]' --prefix q -o "$dir/loaded.h"; sed -n '/q_target/,$p' "$dir/loaded.h" >"$dir/loaded.target"; sed -n '/q_target/,$p' "$dir/q.h" >"$dir/unloaded.target"
! cmp -s "$dir/loaded.target" "$dir/unloaded.target"; check "the firmware's target allows for the loads" $?
run 2 tables plate-50-patches --quasi-static --prefix Pzs -o "$dir/t.h" && says 'prefix'; check "the library's own prefix is refused" $?
run 2 solve "$dir/good.yaml" --report "$dir/one" --vtu "$dir/one" && says 'one name'; check 'two outputs under one name' $?
run 2 solve "$dir/good.yaml" --report "$dir/good.yaml" && says 'one name'; check 'a report over the scene itself' $?
run 2 solve "$dir/good.yaml" --report "$dir/./good.yaml" && says 'one name' && run 2 solve "$dir/good.yaml" --report "$dir/new" --vtu "$dir/./new" && says 'one name'
check 'one file by two paths' $?
run 2 solve "$dir/good.yaml" --csv "$dir/x.csv" && says '--csv belongs to simulate' && run 2 check "$dir/good.yaml" --report "$dir/x.html" && says 'belongs to solve'
check 'an option of another command' $?
scene "$dir/far.yaml"; sed -i 's/pressure: 1/pressure: 1e40/; 1a kinematics: nonlinear' "$dir/far.yaml"; run 1 solve "$dir/far.yaml" && says 'far.yaml:3:10: '; check 'a load beyond every equilibrium: exit 1, with a place' $?
run 1 shape plate-50-patches --set kinematics=nonlinear --set mesh.theta1.elements=5 --set mesh.theta2.elements=5 --set 'equilibrium={linear_solves: 1}' && says 'limit on linear solves reached'
check 'a shape without an equilibrium: exit 1' $?
run 0 solve ring-contact --set kinematics=auto --json && json "j['kinematics']=='nonlinear' and abs(j['outputs']['A']/-198.02-1)<1e-4"
check 'contact needs no linear answer beside it' $?
# touch_body FACE BODY MOVE: the small plate with a body over its outer face, at z = 0.005
touch_body() {
    scene "$dir/touch.yaml"
    sed -i "1a kinematics: nonlinear\ncontact: {face: $1, body: $2, move: $3}" "$dir/touch.yaml"
}
solve_touching() { run "$1" solve "$dir/touch.yaml"; }
ball='{type: sphere, point: [0.6, 0.4, 0.1], radius: 0.03}'
touch_body outer "$ball" '[0, 0, -0.08]'
solve_touching 1 && says 'touch.yaml:3:10: the contact body would enter the shell: element 9 ' \
    && says '(theta1 = 0.5 to 0.75, theta2 = 0.25 to 0.5), at (0.6' && says 'between the nodes' && says 'refine the mesh'
check 'a ball between nodes is refused with element and place' $?
touch_body outer "$ball" '[0, 0, -0.8]'
solve_touching 1 && says 'between the nodes'
check 'a ball that would jump through a plate is refused' $?
roller='{type: cylinder, point: [0.5, 0, -0.2], axis: [0, 1, 0], radius: 0.1}'
touch_body outer "$roller" '[0, 0, 0.3]'
solve_touching 1 && says 'of the inner face' && says 'it comes from behind'
check 'a body from behind is refused' $?
touch_body outer '{type: psi, value: (x-0.6)^2+(y-0.4)^2+4*(z-0.1)^2-0.03^2}' '[0, 0, -0.8]'
solve_touching 1 && says 'between the nodes'
check 'a body by a formula is refused likewise' $?
touch_body outer '{type: sphere, point: [0.6, 0.4, 0.3], radius: 0.03}' '[100, 0, 0]'
run 0 solve "$dir/touch.yaml" --json && json "j['load_steps']==1 and j['steps_shortened']==0"
check 'a body that passes by is let go' $?
touch_body outer '{type: sphere, point: [1, 0.5, 3], radius: 0.3}' '[0, 0, -2.8]'
solve_touching 0 && grep -q 'load steps\{0,1\} shortened for it' "$dir/out"
check 'load steps are added for a body that moves far' $?
base='{type: cylinder, point: [200.5, 0, 0], axis: [0, 0, 1], radius: 100}'
run 0 solve ring-contact --set "contact.body=$base" \
    && grep -q 'WARNING: a part of the shell that faces away' "$dir/out"
check 'a ring pressed through itself is told' $?
"$PZS" solve scordelis-lo --json >/dev/full 2>"$dir/err"; [ $? -eq 1 ] && says 'standard output'; check 'a full standard output is an error' $?
mkfifo "$dir/pipe"; cat "$dir/pipe" >"$dir/read" & run 0 solve "$dir/good.yaml" --vtu "$dir/pipe"; wait; [ -p "$dir/pipe" ] && grep -q '<Points>' "$dir/read"; check 'a pipe stays a pipe' $?
{ sed '/^compare:/,$d' host_tools/scenes/plate-50-patches.yaml; echo compare:; for i in $(seq 80); do echo "  - {name: c$i, values: [$(seq -s, 25)]}"; done; } >"$dir/many.yaml"
run 0 shape "$dir/many.yaml" --json && json "len(j['results'])==84"; check 'eighty sets of volts to compare' $?
run 2 shape plate-50-patches --set 'limits.each=[{actuator: v_1_1, hold: 1e6}]' --set materials.G1195.field_limit=1e6 && says 'v_1_1'; check 'hold beyond the depolarisation field names the amplifier' $?
cat >"$dir/tube.yaml" <<'EOT'
name: tube
surface: {type: cylinder, radius: 1, axial: theta1}
mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {from: 0, to: 2*pi, elements: 16}}
materials: {m: {E: 1e9, nu: 0.3}}
layers: [{material: m, thickness: 0.01}]
supports: [{edge: theta1-, fix: clamped}]
loads: [{face: outer, pressure: 1}]
outputs: [{name: a, u3: middle, at: {theta1: 2, theta2: 0}}, {name: b, u3: middle, at: {theta1: 2, theta2: 2*pi}}]
EOT
run 0 solve "$dir/tube.yaml" --json && json "j['outputs']['a']==j['outputs']['b'] and j['nodes']==80"; check 'a closed tube is closed' $?
run 0 solve "$dir/tube.yaml" --set 'outputs.1={name: b, u3: middle, at: {theta1: [2, 2], theta2: [2*pi, 2*pi]}}' --json && json "j['outputs']['a']==j['outputs']['b']"
check 'a region on the seam holds the nodes of the seam' $?
run 0 solve "$dir/tube.yaml" --set 'supports.1={edge: theta2+, fix: clamped}' --json && json "j['outputs']['a']==0"; check 'a support on the seam holds from either side' $?
run 2 solve "$dir/tube.yaml" --set mesh.theta2.elements=2 && says 'at least 3'; check 'two elements around are refused' $?
run 0 tables plate-50-patches --quasi-static --set 'limits.voltage=[-133.3, 133.3]' --set limits.step_limit=0.1 --prefix a -o "$dir/a.h"
cat >"$dir/l.c" <<'EOT'
#include "a.h"
static double work[1 << 16];
int main(void)
{
    pzs_control c;
    for (int k = 0; k < A_INPUTS; k++)
        if ((double)a_lower[k] < -133.3 || (double)a_upper[k] > 133.3 || (double)a_step_limit[k] > 0.1) return 9;
    return (int)pzs_control_init(&c, &a_problem, 0, work, sizeof work) + (a_target[0] > 1);
}
EOT
for bits in 32 64; do
    gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits "$dir/l.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/l" && "$dir/l"
    check "limits are rounded inwards, $bits bits" $?
done

for s in $("$PZS" list | cut -d' ' -f1); do
    run 0 solve "$s" --report "$dir/s.html" --svg "$dir/s.svg" && law s.html xml && law s.svg xml
    check "solve: pictures of $s are well-formed, without NaN" $?
done
for s in mirror plate-50-patches; do
    run 0 shape $s --report "$dir/s.html" --svg "$dir/s.svg" && law s.html xml && law s.svg xml &&
        law s.html text $("$PZS" shape $s --json | /usr/bin/python3 -c 'import json,sys; print(*json.load(sys.stdin)["voltages"])')
    check "shape: pictures of $s are well-formed, every amplifier is named" $?
done
law s.html uniform && law s.html contrast; check 'colours are perceptually uniform, texts stand out' $?
law s.html text 'Regularised, then clipped' 'piezoshape 0' '4.14×10⁹' '1 mm' '250 µm' '43.47 µm' '0.1*x*(y-0.1)' 'pzs shape plate-50-patches'; check 'report: readable lengths, RMS, target, materials, command' $?
rings=tests/rigs/scenes/electrode-rings.yaml
run 0 shape $rings --report "$dir/s.html" --svg "$dir/s.svg" && law s.html xml && law s.svg xml && law s.html ring ring && law s.html ring 'w<&>' &&
    law s.svg ring ring && law s.html over && law s.svg over
check 'report: an electrode that closes on itself is drawn' $?
"$PZS" new mirror >"$dir/wide-rings.yaml"
run 0 shape "$dir/wide-rings.yaml" --set patches.p.grid=[4,1] --limit 8 --report "$dir/wide.html" && law wide.html over && law wide.html value v_4_1 &&
    law wide.html ring v_1_1 && law wide.html ring v_2_1 && law wide.html ring v_3_1 && law wide.html ring v_4_1
check 'report: the voltages of rings are written inside them, over all patches' $?
run 0 shape "$dir/wide-rings.yaml" --set 'patches=[{name: p, layer: back, plane: xy, outlines: [{rings: {radii: [0.01, 0.02, 0.03, 0.04], sectors: [1, 1, 1]}}]}]' --limit 8 --report "$dir/wide.html" &&
    law wide.html over && law wide.html apart 3; check 'report: the voltages of rings of any outline are written apart' $?
run 0 shape disc-61-hexagons --limit 20 --svg "$dir/d.svg" && grep -q 'scale(0.86)' "$dir/d.svg" && ! grep -q 'scale(1)' "$dir/d.svg"; check 'report: an electrode without a hole is not taken for a ring' $?
law s.html value ring && law s.html text '3.372 nm' '9.434 nm' 'rings <of> tests & co' "full of < > & \" '" 'm < & s' 'l<1>' 'w<&>'; check 'report: a value at its limit is written; markup in names is text' $?
run 0 shape heated-patches --report "$dir/s.html" --svg "$dir/s.svg" && grep -q '^  temperatures  *limits (K)' "$dir/out" &&
    law s.html xml && law s.svg xml && law s.html text 'Temperatures by amplifier' 'Largest temperature' '7.246 K' '± 50 K' && ! law s.html text '7.246 V' && ! law s.html text '50 V' && law s.svg text 'Temperatures of the amplifiers' 'heat_3_1: 7.246 K'
check 'report: what heaters give is a temperature in K' $?
run 0 solve bare-bimorph --report "$dir/s.html" && grep -q 'bare outer face of layer 2 upper: -3.263484e+00 .. 3.263484e+00 V' "$dir/out" && law s.html xml &&
    law s.html text 'Electric potential of layer 1 lower, inner face' 'Electric potential of layer 2 upper, outer face' '3.263 V'
check 'report: maps of the potentials of faces without electrode' $?
run 0 solve $rings --set 'loads=[{face: outer, pressure: 1000}]' --report "$dir/s<&>.html" && law 's<&>.html' xml && law 's<&>.html' text 's<&>.html' '24 values' 'o<&>'
check 'report: outputs at several nodes as a table, markup in the command line is text' $?
run 0 shape plate-50-patches --limit 400 --report "$dir/s.html" --set 'target.value=0.1*x*(y-0.1)+1e-4' --set 'target.free=[piston]' --set 'limits.each=[{actuator: v_1_1, hold: 200}, {actuator: v_1_2, voltage: [-10, 10]}]' &&
    law s.html value v_1_2 && ! law s.html value v_1_1 && law s.html text 'with narrower limits than the table says (own limits, field_limit): 1; held: 1' 'target and error: piston'
check 'report: the limits that each amplifier obeyed, free functions' $?
run 0 shape $rings --limit 15 --report "$dir/s.html" --set 'layers=[{name: "l<1>", material: "m < & s", thickness: 2e-4}, {material: glass, thickness: 1.5e-3}, {name: top, material: "m < & s", thickness: 1e-4}]' \
    --set patches.thin.layer=top --set 'materials.m < & s.field_limit=1e5' && law s.html value ring
check 'report: the field limit of one amplifier, within --limit and beyond the limits of the scene' $?
run 0 shape plate-50-patches --limit 200 --report "$dir/s.html" --set 'target.value=0.1*x*(y-0.1)+1e-4' &&
    law s.html text '11 of 121 target rows lie on constrained dof and cannot move' 'it would be 10.645%'
check 'report: target rows that cannot move' $?
run 0 solve hemisphere --report "$dir/s.html" && law s.html xml && law s.html text Warnings 'strain: ' 'principal strain of the solution'
check 'report: the list of warnings' $?
run 2 solve $rings --svg "$dir/one" --report "$dir/one" && says 'one name' && run 2 check $rings --svg "$dir/x.svg" && says 'belongs to solve'; check '--svg is checked like --report' $?

# simulate
quick='--set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear --set simulate.events=[] --set simulate.plant.inertia=false --set simulate.plant.hysteresis=0'
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $quick --set simulate.ticks=60 --json --csv "$dir/loop.csv" --report "$dir/loop.html" --svg "$dir/loop.svg" &&
    json "j['ticks'] == 60 and j['counts']['controller']['ran'] == 60 and j['counts']['controller']['beyond'] == 0 and
          j['phases'][0]['optimum'] <= j['phases'][0]['controller']['steady'] < j['phases'][0]['clipped']['steady'] / 2 and
          j['phases'][0]['controller']['steady'] < j['phases'][0]['regularised']['steady'] < j['phases'][0]['clipped']['steady']"
check 'simulate: optimum, controller and clipping in JSON' $?
[ "$(wc -l <"$dir/loop.csv")" -eq 61 ] && head -n 1 "$dir/loop.csv" | grep -q '^tick,time,error,vibration,active,iterations,status,missed_tick,v_1_1,.*,v_5_5$' &&
    [ "$(awk -F, '{print NF}' "$dir/loop.csv" | sort -u)" = 33 ]
check 'simulate: a CSV line a tick, a column a quantity' $?
for arm in automatic command; do
    # shellcheck disable=SC2086
    run 0 simulate plate-closed-loop $quick --set simulate.ticks=20 --set "safety={arm: $arm}" --csv "$dir/$arm.csv"
done
tail -n 1 "$dir/command.csv" | cut -d, -f3 | grep -q '^0\.0' && cmp -s "$dir/automatic.csv" "$dir/command.csv"
check 'simulate: a loop that waits for a command has it' $?
"$PZS" new panel >"$dir/zero.yaml"
run 0 simulate "$dir/zero.yaml" --quasi-static --set 'simulate={ticks: 2, plant: {inertia: false, hysteresis: 0}}' --csv "$dir/zero.csv" &&
    grep -q 'errors of the shape over the shape without voltages, because the target is zero' "$dir/out" && [ "$(sed -n 2p "$dir/zero.csv" | cut -d, -f3)" = 1 ]
check 'simulate: of a target of zero, errors over the shape without voltages' $?
run 0 shape "$dir/zero.yaml" && grep -q '^shape error 0.759% of the wanted change of shape' "$dir/out"
check 'shape: under loads, errors over the wanted change of shape' $?
law loop.html xml && law loop.svg xml && law loop.html text 'Voltages of the amplifiers' v_1_1 v_5_5 'pzs simulate plate-closed-loop' 'Regularised, then clipped' 'quasi-static plant, no inertia (the scene says inertia: false): each shape is an equilibrium. First natural frequency'
check 'simulate: report' $?
run 0 simulate tests/rigs/scenes/stiff-cantilever.yaml --set simulate.ticks=60 --set 'simulate.events=[]' --report "$dir/i.html" && law i.html inside; check 'simulate: the picture contains the whole target' $?
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $quick --set simulate.ticks=300 --set simulate.plant.inertia=true --set 'control.rate=0.25' --json --report "$dir/loop.html" &&
    json "j['dynamics'] == 'inertia' and j['plant_modes']['count'] == 100 and 15 < j['plant_modes']['first'] < 16.5 and
          len(j['history']['vibration']) == 300 and 0 < j['phases'][0]['controller']['vibration_worst'] < 2" &&
    law loop.html text 'plant with inertia: 100 modes'
check 'simulate: a plant with inertia, its modes and its vibration over time' $?
[ ! -s "$dir/err" ]; check 'simulate: no progress bar where standard error is no terminal' $?
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop ${quick% --set simulate.events*} --set 'safety={}'; check 'safety: no false alarm in the shipped schedule of faults' $?
run 0 simulate tests/rigs/scenes/stiff-cantilever.yaml
check 'safety: no false alarm where no mode is observed and static errors of the model fade slowly' $?
run 1 simulate tests/rigs/scenes/stiff-cantilever.yaml --set 'simulate.amplifiers={reversed: [v]}' && grep -q 'control was taken away' "$dir/err"
check 'safety: reversed amplifiers in such a loop' $?
run 0 simulate tests/rigs/scenes/storm-panel.yaml --set control.rate=168 --set 'target.value=1e-3*theta1^2' --set simulate.ticks=500
check 'safety: no false alarm by the hysteresis that a slow loop has not yet corrected' $?
damped='--set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear --set simulate.events=[]'
for hysteresis in 0 0.1 0.3; do
    # The ramp that follows the alarm takes 50 ticks.
    # shellcheck disable=SC2086
    run 1 simulate plate-closed-loop $damped --set simulate.ticks=301 --set 'simulate.amplifiers={step: 0.05, reversed: [v]}' --set "simulate.plant.hysteresis=$hysteresis" &&
        grep -q 'control was taken away.*cause: the structure moved against the shapes that the tables predict' "$dir/err"
    check "safety: reversed amplifiers raise the alarm within 250 ticks, hysteresis $hysteresis" $?
done
# Law of the ramp: in its tick n every voltage is 1 - n/50 of that before the ramp, to half a step of the converters, 0.05 V.
ramps() {
    awk -F, 'NR > 1 && $7 == 9 { n++ }
        NR > 1 { for (k = 9; k <= NF; k++) {
            if (n == 0) first[k] = $k
            off = $k - first[k] * (1 - n / 50); if (off * off > 0.026 ^ 2) bad = 1
            if (NR > 2 && ($k - last[k]) ^ 2 > 20.001 ^ 2) bad = 1
            last[k] = $k } }
        END { exit bad || n != 49 }' "$dir/beat.csv"
}
for beat in 0:0 0.3:3; do
    # shellcheck disable=SC2086
    run 1 simulate plate-closed-loop --quasi-static $damped --set 'safety={}' --set simulate.ticks=301 --set "simulate.plant.hysteresis=${beat%:*}" \
        --set "simulate.sensors.delay=${beat#*:}" --csv "$dir/beat.csv" &&
        grep -q 'control was taken away.*cause: the readings stayed too far from the shapes that the tables predict' "$dir/err" && ramps
    check "safety: a loop without vibration model raises the alarm within 250 ticks and ramps to 0 V, hysteresis ${beat%:*}, delay ${beat#*:}" $?
done
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $damped --set simulate.ticks=150000 --set 'simulate.faults={chance: 0.05, until: 149000}' --set 'safety={timeout: 400}' --set simulate.seed=2
check 'safety: no false alarm in 150,000 ticks of random faults' $?
# shellcheck disable=SC2086
wired="$quick --set simulate.ticks=20"
run 0 tables plate-closed-loop $quick --image control -o "$dir/pulses.h" --set 'simulate.events=[{at: 5, dead: [v_1_1], announced: detected}]' --set simulate.plant.inertia=true &&
    grep -q 'pzs_pulse_detector_block' "$dir/pulses.h" && ! grep -q 'pzs_fault_detector_block' "$dir/pulses.h"; check 'a damped loop has the fault detector with test pulses' $?
grep -q 'finds faults of 25 of 25 electrodes from 121 sensors, by test pulses of 213 ticks' "$dir/out"; check 'tables: electrodes whose faults the detector finds' $?
run 0 simulate plate-closed-loop --json --set simulate.ticks=4000 --set simulate.plant.kinematics=linear --set 'simulate.events=[{at: 1500, dead: [v_3_2], announced: detected}, {at: 1520, target: -0.5}]' &&
    json "j['counts']['controller']['detected'] == 1 and j['counts']['controller']['falsely_detected'] == 0"; check 'simulate: a damped loop finds a dead electrode' $?
run 0 simulate plate-closed-loop --json --set simulate.ticks=420 --set control='{rate: 300, moving_target: true}' --set kinematics=linear --set simulate.influence=undeformed \
    --set simulate.plant.kinematics=linear --set 'simulate.events=[{at: 0, load: 0, factor: 0}, {at: 100, dead: [v_1_1], announced: detected}]' &&
    json "j['counts']['controller']['detected'] == 1 and j['counts']['controller']['falsely_detected'] == 0"; check 'simulate: a loop with a governor finds a dead electrode' $?
run 0 check plate-closed-loop $quick --set 'safety={selftest: {amplitude: 5, pulse_ticks: 20}}' && grep -q 'pulses of 5 V, 20 ticks each, at most 6858 ticks' "$dir/out"
check 'self-test: check prints its duration' $?
run 0 simulate plate-closed-loop $wired --set 'safety={selftest: {amplitude: 20, pulse_ticks: 20}}' && grep -q 'self-test before the loop.*passed' "$dir/out"
check 'self-test: healthy wiring passes' $?
tested='safety={selftest: {amplitude: 20, pulse_ticks: 20}}'
run 0 simulate plate-closed-loop $wired --set "$tested" --json && grep -q '"verdict": "passed"' "$dir/out" && grep -q '"tested": 25' "$dir/out"; check 'self-test: --json tells the verdict' $?
run 1 simulate plate-closed-loop $wired --set "$tested" --set 'simulate.events=[{at: 0, dead: [v_1_1]}]' --json && json "j['selftest']['verdict'] == 'faulty' and j['selftest']['findings'] == 'v_1_1 does not respond'"
check 'self-test: --json tells the findings of a test that stops the loop' $?
run 0 tables plate-closed-loop $quick --set "$tested" --set 'simulate.sensors={noise: 1e-4}' --image control -o "$dir/noise.h" && grep -q 'warning: self-test: noise may hide the response of' "$dir/out"
check 'self-test: tables name the amplifiers that noise may hide' $?
run 1 simulate plate-closed-loop $wired --set "$tested" --set 'simulate.sensors={noise: 1e-3}' && grep -q 'self-test: vibration or noise hides the response of v_1_1, ' "$dir/err"
check 'self-test: noise above all responses does not pass' $?
run 0 check plate-closed-loop $quick --set "$tested" --set 'simulate.sensors={noise: 1e-6}' && grep -q 'noise may hide the response of .*pulse_ticks: [0-9]* suffices' "$dir/out"
check 'self-test: check names amplifiers that noise hides, and a cure' $?
run 0 check plate-closed-loop $quick --set 'safety={selftest: {amplitude: 5000}}' && grep -q 'half the voltage range allows no 5000 V' "$dir/out"
check 'self-test: check tells pulses that the limits cut' $?
run 1 simulate plate-closed-loop $wired --set "$tested" --set 'simulate.events=[{at: 0, missing_sensors: 0.1, ticks: 10}]' && grep -q 'self-test: sensor [0-9]* does not respond' "$dir/err"
check 'self-test: sensors missing at tick 0 are named' $?
for fault in 'amplifiers.reversed=[v_1_3]:v_1_3 is reversed' 'amplifiers.swapped=[v_1_3, v_2_2]:v_1_3 is swapped with v_2_2; v_2_2 is swapped with v_1_3' \
    'events=[{at: 0, dead: [v_3_3]}]:v_3_3 does not respond'; do
    run 1 simulate plate-closed-loop $wired --set 'safety={selftest: {amplitude: 20, pulse_ticks: 20}}' --set "simulate.${fault%%]:*}]" &&
        grep -qF "self-test: ${fault##*]:}" "$dir/err"
    check "self-test: ${fault##*]:}" $?
done
run 1 simulate plate-closed-loop $quick --set 'safety={}' --set 'simulate.amplifiers={reversed: [v]}' && grep -q 'control was taken away' "$dir/err"
check 'safety: reversed amplifiers end parked' $?
grep -q 'npz FILE.npz writes the [1-9][0-9]* ticks before' "$dir/err" && rm -rf "$dir/parked"* &&
    run 1 simulate plate-closed-loop $quick --set 'safety={}' --set 'simulate.amplifiers={reversed: [v]}' --csv "$dir/parked.csv" --csv-dir "$dir/parked" &&
    ticks=$(sed -n 's/.*the \([1-9][0-9]*\) ticks before are written/\1/p' "$dir/err") &&
    [ "$(wc -l <"$dir/parked.csv")" -eq $((ticks + 1)) ] && [ "$(wc -l <"$dir/parked/time.csv")" -ge "$ticks" ]
check 'safety: the ticks before the amplifiers were parked are written' $?
grep -qF 'cause: the readings stayed too far from the shapes that the tables predict' "$dir/err" &&
    run 1 simulate plate-closed-loop $quick --set 'safety={timeout: 5, ramp_ticks: 5}' --set simulate.ticks=30 --set 'simulate.events=[{at: 5, missing_sensors: 1, ticks: 20}]' &&
    grep -q 'tick 13: control was taken away.*cause: no usable readings, or no finite target, for safety.timeout ticks' "$dir/err"
check 'safety: simulate names the cause for which control was taken away' $?
run 2 check plate-closed-loop --set 'safety={timeout: -1}' && grep -q 'must be from 0 to 60000 ticks' "$dir/err"; check 'safety: a negative time-out is refused' $?
run 2 check plate-closed-loop --set 'safety={park: 400}' && says 'park: 400 V is outside the limits of v_1_1, -300 to 300; write' &&
    run 2 tables plate-closed-loop $quick --set 'safety={park: 100}' --set 'limits.sum={voltage: [-500, 500]}' -o "$dir/park.h" && says 'with all amplifiers at 100 V, v_1_1 + v_1_2 + v_1_3 + ... + v_5_5 leaves its limits, from -500 to 500' && [ ! -f "$dir/park.h" ]
check 'safety: park voltages outside the limits are refused' $?
parked() { awk '/safe_park\[/ {on = 1; next} /};/ {on = 0} on' "$dir/safe.h" | grep -oE 'PZS_R\([^)]*|[-0-9.e+]+,' | sed 's/PZS_R(//; s/,//' | tr '\n' ' '; }
run 0 tables plate-closed-loop --quasi-static --set 'safety={park: {v: 20 V, v_1_2: -3.5, v_5_5: 0}, arm: command}' --prefix safe -o "$dir/safe.h" &&
    [ "$(parked | awk '{for (i = 1; i <= NF; i++) print $i + 0}' | tr '\n' ' ')" = "20 -3.5 $(printf '20 %.0s' $(seq 22))0 " ]
check 'safety: park voltages of actuators and amplifiers by name' $?
run 0 tables plate-closed-loop --quasi-static --set 'limits={voltage: [10, 300]}' --set 'safety={park: {v_1_2: 30}, arm: command}' --prefix safe -o "$dir/safe.h" &&
    [ "$(parked | awk '{for (i = 1; i <= NF; i++) print $i + 0}' | tr '\n' ' ')" = "10 30 $(printf '10 %.0s' $(seq 23))" ]
check 'safety: an amplifier without a park voltage parks nearest to 0' $?
run 2 check plate-closed-loop --set 'safety={park: {v_2_3: 400}}' && says 'park: 400 V is outside the limits of v_2_3, -300 to 300; write a voltage inside them, or leave its name out' &&
    run 2 check plate-closed-loop --set 'safety={park: {w: 1}}' && says "there is no actuator 'w'; the first one is 'v_1_1'" &&
    run 2 check plate-closed-loop --set 'safety={park: {v_1_1: high}}' && says 'high' &&
    run 2 check plate-closed-loop --set 'limits.each=[{actuator: v_1_1, hold: 5}]' --set 'safety={park: {v_1_1: 4}}' && says 'park: 4 V is outside the limits of v_1_1, 5 to 5' &&
    run 2 tables plate-closed-loop $quick --set 'safety={park: {v_1_1: 300, v_1_2: 290}}' --set 'limits.sum={voltage: [-500, 500]}' -o "$dir/park.h" &&
    says 'park: with the park voltages of all amplifiers, v_1_1 + v_1_2 + v_1_3 + ... + v_5_5 leaves its limits, from -500 to 500' && [ ! -f "$dir/park.h" ]
check 'safety: park voltages by name outside the limits are refused with the name' $?
run 1 simulate plate-closed-loop $quick --set 'safety={park: {v_1_1: 7.5, v_5_5: -2}}' --set 'simulate.amplifiers={reversed: [v]}' --set simulate.ticks=300 --csv "$dir/parked.csv" && grep -q 'control was taken away' "$dir/err" &&
    tail -n 2 "$dir/parked.csv" | awk -F, 'NR == 1 {split($0, before)} END {for (k = 9; k <= NF; k++) {park = k == 9 ? 7.5 : k == NF ? -2 : 0; off = 2 * $k - before[k] - park; if (off * off > 1e-18) bad = 1} exit bad || NF != 33}'
check 'safety: the ramp of simulate ends at park voltages by name' $?
run 0 tables plate-50-patches --quasi-static --set 'safety={arm: command}' --set 'limits={voltage: [20, 60], sum: {voltage: [600, 700]}}' --prefix high -o "$dir/high.h" &&
    awk '/high_park\[/ {on = 1; next} /};/ {on = 0} on' "$dir/high.h" | grep -o '(.*)' | tr -d '(),' | tr -s ' ' '\n' | sed 's/PZS_R//' | awk '$1 < 20 || $1 > 60 {bad = 1} {sum += $1} END {exit bad || sum < 600 || sum > 700}'
check 'safety: without a park voltage the amplifiers park inside all limits' $?
# The float nearest to 300.1 is above 300.1: limit and park voltage are rounded alike.
run 0 tables plate-closed-loop --quasi-static --set 'limits.voltage=[-300.1, 300.1]' --set 'safety={park: 300.1, arm: command}' --prefix safe -o "$dir/safe.h" &&
    printf '#include "pzs.h"\n#include "safe.h"\nstatic double work[SAFE_LOOP_BYTES / 8 + 2];\nstatic pzs_loop loop;\nint main(void) {\n%s\n%s\n%s\n}\n' \
        'const pzs_status s = pzs_loop_init(&loop, safe_blocks, SAFE_BLOCKS, NULL, work, sizeof work);' \
        'static const pzs_real wanted[SAFE_OUTPUTS]; if (s != PZS_OK) return 1;' \
        'return pzs_loop_tick(&loop, wanted, NULL) != PZS_W_PARKED;' >"$dir/safe.c" &&
    (for bits in 32 64; do gcc -std=c99 -DPZS_REAL_BITS=$bits -Iinclude -I"$dir" "$dir/safe.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/safe" && "$dir/safe" || exit 1; done)
check 'safety: its tables run in float and double' $?
ceramic='hysteresis={range: [-300, 300], slopes: [0.68, 0.68, 0.68, 0.68], slack: [37.5, 75, 112.5, 150], above: [0.08, 0.08, 0.08, 0.08], creep_time: [0.1, 1], creep: [0.01, 0.01]}'
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $quick --set "$ceramic" --set simulate.plant.hysteresis=0.1 --json && json "j['phases'][0]['controller']['steady'] < 1.02 * j['phases'][0]['optimum']"
check 'hysteresis: a compensated loop ends at the optimum within the stroke' $?
awk 'BEGIN { for (i = 0; i < 500; i++) print 300 * sin(i / 20) * (1 - i / 600) }' >"$dir/sweep.csv"
awk '{ print 1e-7 * $1 }' "$dir/sweep.csv" >"$dir/place.csv"
run 0 calibrate --hysteresis 1000 --voltages "$dir/sweep.csv" --shapes "$dir/place.csv" --json && json "abs(j['gain'] / 1e-7 - 1) < 1e-3 and j['fit_rms'] < 1e-3" &&
    run 0 calibrate --hysteresis 1000 --voltages "$dir/sweep.csv" --shapes "$dir/place.csv" -o "$dir/ceramic.yaml" && grep -q '^  slack: \[' "$dir/ceramic.yaml"
check 'hysteresis: identified from a sweep' $?
awk 'BEGIN { for (i = 0; i < 1000; i++) print i < 100 ? "0 0" : "10 0" }' >"$dir/steps.csv"
awk 'BEGIN { for (i = 0; i < 1000; i++) { t = (i - 100) / 1000; a = i < 100 ? 0 : exp(-3 * t) * cos(300 * t); b = i < 100 ? 0 : exp(-6 * t) * cos(700 * t)
    print 1 - a - b, 1 - a, 1 + a - b, 2 } }' >"$dir/ringing.csv"
run 0 calibrate --vibration 1000 --number 3 --voltages "$dir/steps.csv" --shapes "$dir/ringing.csv" --json &&
    json "len(j['modes']) == 2 and abs(j['modes'][0]['frequency'] / 47.7489 - 1) < 1e-4 and abs(j['modes'][1]['damping'] / 0.00857 - 1) < 1e-2" &&
    run 0 calibrate --vibration 1000 --voltages "$dir/steps.csv" --shapes "$dir/ringing.csv" -o "$dir/modes.yaml" &&
    grep -q 'not identified, because the 1 steps .* do not move column 2' "$dir/out" && ! grep -q response "$dir/modes.yaml" &&
    printf '1e-6 2e-6\n2e-6 1e-6\n1e-6 0\n0 1e-6\n' >"$dir/rung.csv" &&
    { printf 'name: rung\ncontrol: {rate: 1000}\nlimits: {voltage: [-9, 9]}\ntarget: {value: [1e-6, 1e-6, 1e-6, 0]}\n' && cat "$dir/modes.yaml" && echo '  file: rung.csv'; } >"$dir/rung.yaml" &&
    run 0 check "$dir/rung.yaml" && grep -q 'damps 2 modes from 47.7' "$dir/out"
check 'calibrate --vibration: modes of a record, and a scene with them' $?
awk '{ print 0 }' "$dir/steps.csv" >"$dir/never.csv"
run 0 calibrate --vibration 1000 --voltages "$dir/never.csv" --shapes "$dir/ringing.csv" && grep -q 'vibration_left: the modes leave' "$dir/err" &&
    run 0 calibrate --vibration 1000 --voltages "$dir/steps.csv" --shapes "$dir/ringing.csv" && ! grep -q . "$dir/err"
check 'calibrate --vibration: voltages that were never applied are warned of' $?
awk 'NR == 500 { $3 = "nan" } 1' "$dir/ringing.csv" >"$dir/gap.csv"
run 2 calibrate --vibration 1000 --voltages "$dir/steps.csv" --shapes "$dir/gap.csv" && says 'line 500, column 3 is nan; a record needs every sample: cut it before or behind this line in both files, or interpolate'
check 'calibrate --vibration: a missing sample is refused with the cure' $?
run 2 calibrate --vibration -1 --voltages "$dir/steps.csv" --shapes "$dir/ringing.csv" && says '--vibration is the samples a second of the record, not'
check 'calibrate --vibration: a rate below 0 is refused' $?
for rate in 1e-9 1e12; do
    run 2 calibrate --vibration $rate --voltages "$dir/steps.csv" --shapes "$dir/ringing.csv" && says 'Hz, and structures vibrate between 0.001 and 1e+07 Hz' &&
        run 2 calibrate --hysteresis $rate --voltages "$dir/sweep.csv" --shapes "$dir/place.csv" && says 'a sweep of 500 samples would last'
    check "calibrate: $rate samples a second are refused" $?
done
/usr/bin/python3 - "$dir" <<'POKES'
import sys, numpy
draw = numpy.random.default_rng(5)
voltage = draw.choice([-100., 100.], (200, 4))
shape = voltage @ draw.normal(size=(4, 3)) + draw.normal(size=(200, 3)) * [1, 5, 1]
numpy.savetxt(sys.argv[1] + '/few-v.csv', voltage, delimiter=',')
numpy.savetxt(sys.argv[1] + '/few-x.csv', shape, delimiter=',')
numpy.savetxt(sys.argv[1] + '/four-v.csv', 100 * numpy.eye(4), delimiter=',')
numpy.savetxt(sys.argv[1] + '/four-x.csv', shape[:4], delimiter=',')
POKES
run 0 calibrate --voltages "$dir/few-v.csv" --shapes "$dir/few-x.csv" --standard-errors "$dir/few-e.csv" &&
    /usr/bin/python3 - "$dir/few-e.csv" <<'ERRORS'
import sys, numpy
error = numpy.loadtxt(sys.argv[1], delimiter=',', skiprows=1)
assert error.shape == (3, 4) and abs(error * 100 * 200**0.5 / [[1], [5], [1]] - 1).max() < 0.2, error
ERRORS
check 'calibrate --standard-errors: the noise of each output' $?
run 2 calibrate --voltages "$dir/four-v.csv" --shapes "$dir/four-x.csv" --standard-errors "$dir/none.csv" && says 'measure more pokes than actuators' && [ ! -e "$dir/none.csv" ]
check 'calibrate --standard-errors: too few pokes are refused' $?
files="--voltages $dir/steps.csv --shapes $dir/ringing.csv"
# shellcheck disable=SC2086
{
    run 2 calibrate --vibration 1000 --hysteresis 1000 $files && says 'either --hysteresis or --vibration' &&
        run 2 calibrate --vibration 1000 $files --standard-errors "$dir/none.csv" && says 'only a matrix from pokes has' &&
        run 2 calibrate --number 3 $files && says 'only calibrate --vibration takes' &&
        run 2 calibrate plate-50-patches --vibration 1000 $files && says 'takes no scene' &&
        run 2 calibrate --set a=b $files && says 'there is none'
}
check 'calibrate: options that would be ignored are refused' $?
run 2 calibrate --hysteresis 0 --voltages "$dir/sweep.csv" --shapes "$dir/place.csv" && says '--hysteresis is the samples a second of the sweep, not'
check 'hysteresis: a sweep without a rate is refused' $?
run 0 tables plate-closed-loop --quasi-static --set "$ceramic" --prefix bent -o "$dir/bent.h" &&
    printf '#include "pzs.h"\n#include "bent.h"\nstatic double work[BENT_LOOP_BYTES / 8 + 2];\nstatic pzs_loop loop;\nint main(void) {\n%s\n%s\n%s\n}\n' \
        'const pzs_status s = pzs_loop_init(&loop, bent_blocks, BENT_BLOCKS, NULL, work, sizeof work);' \
        'static const pzs_real wanted[BENT_OUTPUTS]; if (s != PZS_OK) return 1;' \
        'return pzs_loop_tick(&loop, wanted, NULL) != PZS_OK;' >"$dir/bent.c" &&
    (for bits in 32 64; do gcc -std=c99 -DPZS_REAL_BITS=$bits -Iinclude -I"$dir" "$dir/bent.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/bent" && "$dir/bent" || exit 1; done)
check 'hysteresis: its tables run in float and double' $?
run 2 simulate plate-50-patches && says 'add `simulate: {ticks: 400}`'; check 'simulate without its section: exit 2' $?
run 2 simulate plate-closed-loop --device toaster && says "not 'toaster'"; check 'an unknown board: exit 2' $?
run 0 tables plate-closed-loop --quasi-static -o "$dir/target.h" && run 0 tables plate-closed-loop --quasi-static --set simulate.influence=undeformed -o "$dir/rest.h" &&
    grep -q 'influence\[3025\]' "$dir/target.h" && ! cmp -s "$dir/target.h" "$dir/rest.h"
check 'control tables have the influence that the simulation has' $?

# Signals and terminals
mkdir "$dir/signals"
for law in 'file:a signal leaves no part of a file, and the earlier file' 'device:a signal leaves no folder of a firmware' \
    'terminal:progress on a terminal after two seconds' 'quiet:no progress of a short command'; do
    /usr/bin/python3 tests/cli/interrupt.py "$PZS" "$dir/signals" "${law%%:*}" >"$dir/out" 2>"$dir/err"; check "${law#*:}" $?
done

# The README's table is what the demo prints, but for the last column: rounding differs between machines
run 0 shape plate-50-patches --limit 200 --limit 100 --limit 500
sed -n '/<!-- demo -->/,/^$/p' README.md | grep '%' | awk '{$NF = ""; print}' >"$dir/told"
grep -v 'target' "$dir/out" | grep '%' | awk '{$NF = ""; print}' | cmp -s - "$dir/told" && [ -s "$dir/told" ]; check "the README's table is the demo's" $?
# The texts of its picture too, but for the command, which is not drawn
texts() { grep -o '<text[^>]*>[^<]*' "$1" | sed 's/<[^>]*>//'; }
run 0 shape plate-50-patches --limit 200 --limit 100 --limit 500 --svg "$dir/demo.svg" && texts "$dir/demo.svg" >"$dir/drawn" &&
    texts host_tools/scenes/plate-50-patches.svg | cmp -s - "$dir/drawn" && [ "$(wc -l <"$dir/drawn")" -ge 25 ] && law demo.svg xml
check "the README's picture is the demo's (else: make demo, copy build/plate-50-patches.svg to host_tools/scenes)" $?

# vibration
run 0 modes plate-50-patches --number 5 --vtu "$dir/modes.vtu" && grep -q '^ *1 *15\.0' "$dir/out" && grep -q 'mode_5' "$dir/modes.vtu" &&
    grep -q 'Name="element_type"' "$dir/modes.vtu" && grep -q 'Name="patch_up"' "$dir/modes.vtu" && ! grep -q 'Name="voltage' "$dir/modes.vtu"; check 'modes: a table and a VTU file' $?
run 0 modes plate-50-patches --number 5 --json && json "all(abs(f/w-1)<.02 for f,w in zip(j['frequency'],[15,36,94,123,133])) and abs(j['mass']-.184)<1e-12 and len(j['modes'][4]['controllability'])==25 and len(j['frequency'])==5"; check 'modes --json' $?
run 0 modes plate-50-patches --set materials.G1195.permittivity=15.3e-9 --electrodes open --number 3 --json && json "j['open_electrodes']==25 and all(0<k<1 and abs(k-1+(s/f)**2)<1e-12 for k,s,f in zip(j['coupling_squared'],j['short_frequency'],j['frequency'])) and abs(j['short_frequency'][0]-15.0413)<1e-4" &&
    run 0 modes bimorph-sensor --set materials.PVDF.density=1780 --number 2 && grep -q 'coupling k2' "$dir/out" && grep -q '5 electrodes of sensors open' "$dir/out" &&
    run 0 modes bimorph-sensor --set materials.PVDF.density=1780 --number 2 --electrodes short && ! grep -q coupling "$dir/out" &&
    run 2 modes plate-50-patches --electrodes open && says 'has no capacitance' && run 2 modes plate-50-patches --electrodes shut && says 'open'; check 'modes --electrodes: short-circuit frequencies and coupling factors' $?
for scene in plate-50-patches wing-panel tests/rigs/scenes/stretched-strip.yaml; do
    run 0 modes "$scene" --number 4 --report "$dir/v.html" --svg "$dir/v.svg" && law v.html xml && law v.svg xml && grep -q 'Natural frequencies' "$dir/v.html" &&
        [ "$(grep -c 'Mode shape in space' "$dir/v.html")" -ge 4 ] && grep -q '>mode 4, ' "$dir/v.svg"; check "modes: report and picture of ${scene##*/}" $?
done
"$PZS" new measured-matrix >"$dir/measured-matrix.csv" && "$PZS" new measured >"$dir/with-modes.yaml" &&
    run 0 modes "$dir/with-modes.yaml" --set "influence.modes=[{frequency: 50, damping: 0.01, shape: [$(seq -s , 0 18)]}]" --report "$dir/v.html" --svg "$dir/v.svg" && law v.html xml && law v.svg xml; check 'modes: report and picture of measured modes' $?
run 0 modes plate-50-patches --set supports=[] --number 7 --json && json "j['damping'][:6]==[None]*6 and j['damping'][6]==.005 and j['rigid']==6" &&
    run 0 modes cantilever --set kinematics=linear --set materials.strip.density=1 --number 1 --json && json "abs(abs(j['modes'][0]['observability']['end up'][0])-1)<1e-6"; check 'modes --json: damping, outputs in a mode whose largest displacement is 1' $?
run 2 modes scordelis-lo && says "no density in material 'concrete'"; check 'modes without a density: exit 2, with the cure' $?
run 0 solve scordelis-lo --error --json && json "(lambda e: abs(e['extrapolated']/-.3013-1)<.007 and abs(e['value']+.29797)<1e-5 and abs(e['extrapolated']+.3013)<e['uncertainty'] and 1.5<e['order']<2.5)(j['discretisation']['results']['edge']) and j['discretisation']['meshes']==[[16,16],[8,8],[4,4]]"; check 'solve --error: the converged value lies inside' $?
run 0 solve scordelis-lo --error && grep -q 'extrapolated' "$dir/out"; check 'solve --error: a table' $?
run 0 shape plate-50-patches --error --json && json "j['discretisation']['results']['shape error']['value']==j['shape_error']"; check 'shape --error' $?
for size in 20 40; do "$PZS" shape plate-50-patches --error --json --set mesh.theta1.elements=$size --set mesh.theta2.elements=$size >"$dir/matrix-$size.json"; done
run 0 shape plate-50-patches --error --json && json "(lambda of: len(of[10])==27 and sum(abs(of[m][n]['extrapolated']-of[40][n]['extrapolated'])<=of[m][n]['uncertainty'] for m in (10,20) for n in of[m])>=.95*54 and abs((sum(of[40][n]['value']**2 for n in of[40] if n[:2]=='v_')/25)**.5/of[40]['influence matrix']['value']-1)<1e-9)({10: j['discretisation']['results'], **{m: json.load(open('$dir/matrix-%d.json'%m))['discretisation']['results'] for m in (20,40)}})"; check 'shape --error: 95 % of the intervals of the influence matrix hold' $?
run 0 modes plate-50-patches --number 2 --error --json && json "j['discretisation']['results']['mode 2']['value']==j['frequency'][1]"; check 'modes --error' $?
run 0 solve hinged-roof --path --set mesh.theta1.elements=8 --set mesh.theta2.elements=8 --json && json "[e['type'] for e in j['path']['events']]==['limit point']*2 and abs(j['path']['events'][0]['load_factor']*3000/2225-1)<.01 and j['path']['complete'] and j['path']['points'][0]['outputs']['centre']==0"; check 'solve --path' $?
run 0 solve ring-contact --path --json && json "j['path']['equal_load_steps'] and [p['outputs']['nodes'] for p in j['path']['points']][:2]==[0,1] and len(j['path']['points'])==21" && run 0 solve ring-contact --path && grep -q '21 points in equal load steps' "$dir/out"; check 'solve --path with contact' $?
run 0 solve ring-contact --vtu "$dir/f.vtu" && run 0 solve ring-contact --json && /usr/bin/python3 -c "
import json, re, sys
text = open(sys.argv[1]).read(); total = json.load(open(sys.argv[2]))['reactions']
def summed(name):
    value = [float(x) for x in re.search('Name=\"' + name + '\"[^>]*>([^<]*)<', text).group(1).split()]
    return [sum(value[i::3]) for i in range(3)]
for name, key in (('reaction', 'held'), ('contact_force', 'contact')):
    assert max(abs(a - b) for a, b in zip(summed(name), total[key]['force'])) < 1e-5 * abs(total['contact']['force'][0])" "$dir/f.vtu" "$dir/out"; check 'VTU file: the forces of supports and contact at the nodes sum to the totals' $?
# images: a cube of influence functions, a mask and a target as .npy and, where FITS is read, packed FITS
/usr/bin/python3 - "$dir" <<'IMAGES'
import gzip, sys, numpy
folder = sys.argv[1]
x, y = numpy.meshgrid(numpy.linspace(-1, 1, 7), numpy.linspace(-1, 1, 7))
mask = x**2 + y**2 <= 1.01
cube = numpy.array([numpy.exp(-((x - a)**2 + (y - b)**2) / 0.3) for a in (-0.6, 0, 0.6) for b in (-0.6, 0, 0.6)])
target = 10 * (x**2 - y**2)
cube[:, ~mask] = numpy.nan
numpy.save(folder + '/cube.npy', cube)
numpy.save(folder + '/mask.npy', mask)
numpy.save(folder + '/image.npy', target)
numpy.savetxt(folder + '/flat.csv', cube[:, mask].T, delimiter=',')
numpy.savetxt(folder + '/flat-target.csv', target[mask])
cards = ['SIMPLE  =                    T', 'BITPIX  =                  -64', 'NAXIS   =                    3'] + \
    ['NAXIS%d  = %20d' % (k + 1, n) for k, n in enumerate(cube.shape[::-1])] + ['END']
data = cube.astype('>f8').tobytes()
text = ''.join(card.ljust(80) for card in cards)
with gzip.open(folder + '/cube.fits.gz', 'wb') as file:
    file.write(text.ljust(-len(text) // 2880 * -2880).encode() + data + bytes(-len(data) % 2880))
for name, influence, wanted in (('flat', '{file: flat.csv}', 'flat-target.csv'),
                                ('cube', '{file: cube.npy, rows: actuators, mask: {file: mask.npy}}', 'image.npy'),
                                ('fits', '{file: cube.fits.gz, rows: actuators, mask: {file: mask.npy}}', 'image.npy')):
    open(folder + '/image-%s.yaml' % name, 'w').write(
        'name: image\nunits: {length: um, force: N, voltage: V, temperature: K}\ninfluence: %s\n'
        'limits: {voltage: [-5, 5]}\ntarget: {value: {file: %s}}\n' % (influence, wanted))
IMAGES
run 0 shape "$dir/image-flat.yaml" --json && cp "$dir/out" "$dir/flat.json" && run 0 shape "$dir/image-cube.yaml" --json &&
    json "j['results'][1]['voltages']==json.load(open('$dir/flat.json'))['results'][1]['voltages']"
check 'a cube of influence functions, a mask and a target as images are those of lists' $?
if ldd "$PZS" | grep -q cfitsio; then
    run 0 shape "$dir/image-fits.yaml" --json && json "j['results'][1]['voltages']==json.load(open('$dir/flat.json'))['results'][1]['voltages']"
    check 'a FITS cube packed by gzip' $?
    mkdir "$dir/a.Zoo" && cp "$dir/image-fits.yaml" "$dir/cube.fits.gz" "$dir/mask.npy" "$dir/image.npy" "$dir/a.Zoo" &&
        { run 0 shape "$dir/a.Zoo/image-fits.yaml" || { run 2 shape "$dir/a.Zoo/image-fits.yaml" && says 'rename the folder'; }; }
    check 'a path that cfitsio takes for another format is named' $? # cfitsio 4.2 does
else
    skip 'a FITS cube packed by gzip' cfitsio
    skip 'a path that cfitsio takes for another format is named' cfitsio
fi
# a VTU file of shape: displacements and target with units, what lies in each cell; a measured matrix has points as cells
run 0 shape plate-50-patches --limit 200 --vtu "$dir/p.vtu" --npz "$dir/p.npz" && run 0 shape "$dir/measured.yaml" --vtu "$dir/m.vtu" --npz "$dir/m.npz" && /usr/bin/python3 -c "
import sys, xml.etree.ElementTree as tree, numpy
def read(name):
    piece = tree.parse(name).find('.//Piece')
    size = dict(Points=int(piece.get('NumberOfPoints')), PointData=int(piece.get('NumberOfPoints')), CellData=int(piece.get('NumberOfCells')))
    values = {a.get('Name'): numpy.array(a.text.split(), float) for part in piece for a in part}
    for part in piece:
        for a in part:
            assert part.tag not in size or len(values[a.get('Name')]) == size[part.tag] * int(a.get('NumberOfComponents'))
    return size, values
size, plate = read(sys.argv[1]); z = numpy.load(sys.argv[2])
assert {'element_type', 'present_lower', 'patch_up', 'voltage_low_(V)', 'displacement_(m)'} <= set(plate)
for e in range(100):
    volt = z['voltage'][1][int(plate['patch_up'][e]) - 1]
    assert abs(plate['voltage_up_(V)'][e] - volt) < 1e-6 and abs(plate['voltage_low_(V)'][e] + volt) < 1e-6
assert sorted(set(plate['patch_up'])) == list(range(1, 26)) and (plate['present_lower'] == 1).all()
assert abs(plate['misfit_(m)'] - plate['shape_(m)'] + plate['target_(m)']).max() < 1e-10
assert abs(numpy.sort(plate['shape_(m)']) - numpy.sort(z['shape'][1])).max() < 1e-10
size, mirror = read(sys.argv[3]); z = numpy.load(sys.argv[4])
assert size['CellData'] == 19 and (mirror['types'] == 1).all() and (mirror['offsets'] == range(1, 20)).all()
assert (mirror['connectivity'] == range(19)).all() and abs(mirror['shape_(mm)'] - z['shape'][1]).max() < 1e-9
assert abs(mirror['displacement_(mm)'][2::3] - z['shape'][1]).max() < 1e-9" "$dir/p.vtu" "$dir/p.npz" "$dir/m.vtu" "$dir/m.npz"
check 'VTU file of shape: target, patches and voltages, points of a measured matrix' $?
# stresses: the pressure on the outer face is the stress 33 there; the report, VTU and arrays have the layers of the plate
run 0 solve tests/rigs/scenes/sine-strip.yaml --stress --json && json "(lambda s: abs(s['largest_stress']['33']['value']-1)<.01 and s['largest_stress']['33']['face']=='outer' and (s['largest_stress']['11']['layer'],s['largest_stress']['11']['face']) in (('upper','outer'),('lower','inner')) and len(s['layers'])==2 and abs(abs(s['largest_stress']['11']['value'])/61.00-1)<.002)(j['stress'])"; check 'solve --stress --json: extremes and places' $?
run 0 solve plate-50-patches --stress --set actuators.0.applied=100 --set 'materials.G1195.strength={tension: 40 MPa}' --vtu "$dir/s.vtu" --npz "$dir/s.npz" --report "$dir/s.html" && grep -q 'reserve, Tsai-Hill' "$dir/out" && grep -q 'Use of the strength' "$dir/s.html" && law s.html xml &&
    /usr/bin/python3 -c "
import sys, xml.etree.ElementTree as tree, numpy
piece = tree.parse(sys.argv[1]).find('.//Piece')
points, cells = int(piece.get('NumberOfPoints')), int(piece.get('NumberOfCells'))
size = dict(Points=points, PointData=points, CellData=cells)
assert points >= 121 and all(len(a.text.split()) == int(a.get('NumberOfComponents'))*size[part.tag]
                            for part in piece if part.tag in size for a in part)
assert any(a.get('Name').startswith('stress_') and a.get('Name').endswith('_(N/m2)') for a in piece.find('CellData'))
z = numpy.load(sys.argv[2])
assert z['stress'].shape == z['strain'].shape and z['stress_resultant'].shape == (cells, 8)" "$dir/s.vtu" "$dir/s.npz"; check 'solve --stress: report, VTU, arrays' $?
# a reserve factor below 1: the warning names component and place, and its value is that of the layer
run 1 solve plate-50-patches --stress --strict --json --set actuators.0.applied=100 --set 'materials.G1195.strength={tension: 7 kPa}' --set materials.G1195.E=1e8 && json "min(w['value'] for w in j['warnings'] if w['rule']=='stress_reserve')==min(l['reserve']['value'] for l in j['stress']['layers'] if 'reserve' in l)" && grep -q 'most by stress [12][12] (' "$dir/out" &&
    run 0 solve plate-50-patches --stress --set actuators.0.applied=100 --set 'materials.G1195.strength={tension: 40 MPa}' && ! grep -q stress_reserve "$dir/out"; check 'solve --stress: a reserve factor below 1 is a warning' $?
run 2 shape plate-50-patches --stress && says 'belongs to solve'; check '--stress of another command' $?
run 0 solve hinged-roof --path --set mesh.theta1.elements=8 --set mesh.theta2.elements=8 --csv-dir "$dir/path" --report "$dir/path.html" && head -1 "$dir/path/path.csv" | grep -qx 'load factor,negative pivots,centre (mm)' && /usr/bin/python3 tests/cli/report_check.py "$dir/path.html" xml && /usr/bin/python3 tests/cli/report_check.py "$dir/path.html" text 'Load path' 'Load factor over centre (mm)' 'limit point 0.7' && grep -q '^    centre  *-1' "$dir/out"; check 'solve --path: the curve as a picture, its columns and critical points' $?
run 0 solve tests/rigs/scenes/column.yaml --branch -1 --json && json "j['path']['complete'] and j['path']['branch_from_point']>1 and all(p['negative_pivots']==0 for p in j['path']['points'][j['path']['branch_from_point']:])" && run 1 solve tests/rigs/scenes/column.yaml --branch 2 && says 'the load path has 1 bifurcation' && run 2 solve ring-contact --branch 1 && says 'needs the arc-length method' && run 2 solve hinged-roof --branch 0 && says 'number of a bifurcation'; check 'solve --branch' $?
run 2 solve scordelis-lo --path && says 'needs kinematics: nonlinear'; check 'solve --path: a linear scene' $?
run 1 solve tests/rigs/scenes/pulled-cylinder.yaml --strict && grep -q '^  path: .*twice as many load steps' "$dir/out"; check 'solve: an answer off the load path is a warning' $?
run 2 solve bimorph-actuator --error && says 'mesh.theta1 has 5 elements, which cannot be halved'; check 'solve --error: a mesh that cannot be halved' $?
run 2 solve mirror --error && says 'no output with a single value'; check 'solve --error: no output' $?
run 2 solve tests/rigs/scenes/holed-panel.yaml --error && says 'a mesh of a panel, of a disc or from a file has no coarser meshes'; check 'solve --error: a panel' $?
run 2 modes plate-50-patches --number 0 && says '--number' && run 2 modes plate-50-patches --number 2.5 && says '--number' && run 2 check plate-50-patches --number 3 && says 'belongs to modes'; check 'modes: a wrong number' $?
run 0 tables plate-closed-loop -o "$dir/damped.h" && cp "$dir/out" "$dir/damped.out" && grep -q 'pzs_vibration_block' "$dir/damped.h" &&
    grep -q '9 modes from 15.04 to 314.2 Hz, at 1000 ticks a second' "$dir/damped.h" && ! grep -q QUASI_STATIC "$dir/damped.h"; check 'tables of an unstable loop damp vibration' $?
run 0 tables plate-closed-loop --set control.moving_target=true -o "$dir/x.h" && grep -q 'pzs_governor_block' "$dir/x.h"; check 'tables of a moving target have a governor' $?
run 0 tables plate-closed-loop --set dynamics='{damping: 0.2}' --set control.rate=4 -o "$dir/x.h" && ! grep -q QUASI_STATIC "$dir/x.h"; check 'tables of a stable loop' $?
run 0 tables plate-50-patches --quasi-static --image linear --modes 3 --prefix t -o "$dir/modes.h" && grep -q '^#define T_MODES_VECTORS 14' "$dir/modes.h" && grep -q 'static const pzs_mass t_mass' "$dir/modes.h" &&
    grep -q '3 vibration modes, 14 Lanczos vectors: workspace' "$dir/out" && grep -q 'element mass matrices: 1,' "$dir/out" && run 0 tables plate-50-patches --quasi-static --image linear --modes 3 --set 'masses=[{at: {theta1: 0.1, theta2: 0.1}, mass: 0.01}]' --prefix t -o "$dir/x.h" && grep -q 'element mass matrices: 2,' "$dir/out"
check 'tables --modes: equal elements share a mass matrix, a concentrated mass has its own' $?
run 0 tables vlasov-plate --set kinematics=nonlinear --set materials.plate.E=100 --set materials.plate.density=1 --image nonlinear --modes 3 --prefix t -o "$dir/x.h" && sed -n '/t_reached_frequency\[3\]/{n;p;}' "$dir/x.h" | tr -d ' ,PZS_R(' | tr ')' '\n' >"$dir/device" &&
    run 0 modes vlasov-plate --set kinematics=nonlinear --set materials.plate.E=100 --set materials.plate.density=1 --number 3 --json && python3 -c '
import json, sys
device = [float(line) for line in open(sys.argv[1]) if line.strip()]
host = json.load(open(sys.argv[2]))["frequency"]
sys.exit(not (len(host) == 3 and all(abs(a / b - 1) < 1e-9 for a, b in zip(device, host, strict=True)) and host[0] > 1.5))' "$dir/device" "$dir/out"
check 'tables --modes of a nonlinear image: frequencies about the equilibrium, those of pzs modes' $?
# first_frequency [CIRCUIT]: of the header and of pzs modes, equal; CIRCUIT as --electrodes
first_frequency() {
    circuit=${1:+--electrodes $1}
    # shellcheck disable=SC2086
    run 0 tables bimorph-sensor --quasi-static --set materials.PVDF.density=1780 --image linear --modes 2 --prefix t $circuit -o "$dir/open.h" &&
        device=$(sed -n '/t_frequency\[2\]/{n;p;}' "$dir/open.h" | sed 's/^ *PZS_R(\([^)]*\)).*/\1/') &&
        run 0 modes bimorph-sensor --set materials.PVDF.density=1780 --number 2 --json $circuit && json "abs($device/j['frequency'][0]-1)<1e-12"
}
first_frequency && grep -q '^#define T_MODES_OPEN 5' "$dir/open.h" && first_frequency open && grep -q 't_modes_open\[5\]' "$dir/open.h" && first_frequency short &&
    ! grep -q MODES_OPEN "$dir/open.h"; check 'tables --modes --electrodes: the circuits and frequencies of pzs modes' $?
run 0 tables plate-50-patches --quasi-static --image linear --modes 2 --prefix t --electrodes open --set materials.G1195.permittivity=7.3e-9 -o "$dir/open.h" && grep -q '^#define T_MODES_OPEN 25' "$dir/open.h" &&
    grep -q 't_electrodes = {' "$dir/open.h" && grep -q '^25 open electrodes: workspace [0-9.]* KB more in float' "$dir/out" &&
    run 2 tables plate-50-patches --quasi-static --image linear --modes 2 --electrodes open -o "$dir/x.h" && grep -q 'open electrode v_1_1 has no capacitance' "$dir/err" &&
    run 2 tables plate-50-patches --quasi-static --image linear --electrodes open -o "$dir/x.h" && grep -qF "needs '--modes'" "$dir/err"; check 'tables --modes --electrodes open: amplifiers, too; refused without permittivity' $?
run 2 tables plate-50-patches --quasi-static --modes 3 -o "$dir/x.h" && says 'needs --image linear or nonlinear' && run 2 tables plate-50-patches --quasi-static --image linear --modes 201 -o "$dir/x.h" && says '--modes is a whole number' &&
    run 2 tables clamped-plate --image linear --modes 3 -o "$dir/x.h" && says 'no density in material' && run 2 modes plate-50-patches --modes 3 && says 'belongs to tables'; check 'tables --modes: refused without masses, for a control image, for no number' $?
grep -q '^#define PLATE_CLOSED_LOOP_QUASI_STATIC 1' "$dir/target.h" && grep -q 'has no vibration model' "$dir/target.h"; check '--quasi-static marks the header' $?
rm -f "$dir/none.h"
for image in control linear nonlinear; do
    run 3 tables plate-50-patches $coarse --set kinematics=auto --image $image -o "$dir/none.h" && [ ! -e "$dir/none.h" ] &&
        tail -n 1 "$dir/err" | grep -q 'the scene has densities (first mode 14.95 Hz), but no tick rate: .*write control: {rate: ...}, in ticks a second, or say --quasi-static' || break
    run 0 tables plate-50-patches $coarse --set kinematics=auto --image $image --quasi-static --prefix p -o "$dir/none.h" &&
        grep -q '^#define P_QUASI_STATIC 1$' "$dir/none.h" && grep -q 'written with --quasi-static: the tick damps no vibration' "$dir/none.h" || break
    rm -f "$dir/none.h"
done
[ ! -e "$dir/none.h" ]; check 'tables of a structure with densities need a tick rate or --quasi-static, in every image' $?
run 3 tables plate-50-patches $coarse --set 'control={modal_gains: {gain: 0.5}}' -o "$dir/none.h" && tail -n 1 "$dir/err" | grep -q 'nothing tells whether the loop with these gains of modes is stable'
check 'tables with gains of modes need a tick rate or --quasi-static' $?
run 0 tables plate-50-patches --quasi-static -o "$dir/none.h" && grep -q 'no vibration model, as --quasi-static asks for' "$dir/out" && grep -q 'stable up to 0.27 ticks a second' "$dir/out" &&
    run 0 tables free-form-panel -o "$dir/none.h" && grep -q 'vibration is not known: .* no density in materials' "$dir/out"
check 'tables say why the tick has no vibration model' $?
ones=$(printf '1,%.0s' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18)
run 0 new measured && cp "$dir/out" "$dir/even.yaml" && run 0 new measured-matrix && cp "$dir/out" "$dir/measured-matrix.csv" &&
    run 0 tables "$dir/even.yaml" --set 'target.free=[piston]' --set 'control={rate: 1000}' --set "influence.modes=[{frequency: 100, shape: [${ones}1]}, {frequency: 100, shape: [${ones}1.001]}]" -o "$dir/even.h" &&
    grep -q 'damps no mode, none moves the target enough' "$dir/out" && grep -q 'no mode moves the target enough to be observed' "$dir/even.h" && grep -q 'mode_share' "$dir/out"
check 'slow modes that the target does not see are not called too fast' $?
awk -F, 'NR > 1 { print 1 - ($1 * $1 + $2 * $2) / 150 "," $1 / 9 }' "$dir/measured-matrix.csv" >"$dir/mode-shapes.csv"
late='influence.modes=[{frequency: 212, shape: {file: mode-shapes.csv, column: 1}}, {frequency: 480, shape: {file: mode-shapes.csv, column: 2}}]'
run 3 check "$dir/even.yaml" --set 'control={rate: 2000}' --set "$late" --set simulate.sensors.delay=16 --json && says 'the damped tick is not safe at 2000 ticks a second' &&
    json "j['certificate']['stable'] is False" && run 3 tables "$dir/even.yaml" --set 'control={rate: 2000}' --set "$late" --set simulate.sensors.delay=16 -o "$dir/late.h" &&
    [ ! -e "$dir/late.h" ] && run 0 check "$dir/even.yaml" --set 'control={rate: 2000}' --set "$late" --set simulate.sensors.delay=1
check 'check, tables: a loop that is not safe has an exit code of its own' $?
run 0 check plate-closed-loop --json && cp "$dir/out" "$dir/check.json" && json "j['certificate']['stable'] is True and j['certificate']['storms']==30 and j['certificate']['storms_failed']==0 and
    0.9<j['certificate']['radius']<1 and 1.33<j['certificate']['margin']['gain']<5 and j['certificate']['readings_older']>=1 and j['certificate']['margin']['delay']==j['certificate']['readings_older'] and j['certificate']['readings_newer']==0 and j['certificate']['modes_observed']==9 and 0.5<j['certificate']['load_step_periods']<=2 and not j['certificate']['load_step_longer'] and
    j['certificate']['margin']['frequency'][0]<0.9 and j['certificate']['margin']['frequency'][1]>1.1 and j['certificate']['rate_from']<500 and j['certificate']['rate_to']>1500"
check 'check --json: certificate of the damped loop' $?
light=tests/rigs/scenes/storm-light.yaml
run 3 check "$light" && says 'no limits.regularisation up to 0.01 makes it safe; try ' && ! says 'write limits' && says '(growth and two of the storms pass there, so that the loop may be stable)' &&
    run 3 check "$light" --set control.rate=2245 --set limits.step_limit=20 --set simulate.sensors.delay=1 && ! says '(growth' && ! says 'another rate' && grep -q 'No other tick rate passes growth and two storms' "$dir/out"
check 'check: an unsafe loop is given no regularisation and no rate that do not help' $?
run 3 check tests/rigs/scenes/storm-springs.yaml && says 'the cause is target.free: remove it' && run 0 check tests/rigs/scenes/storm-springs.yaml --set 'target.free=[]'
check 'check: free functions of the target that make the loop unstable are named' $?
panel=tests/rigs/scenes/storm-panel.yaml
run 0 check "$panel" --set 'loads=[{face: outer, pressure: 300}]' && grep -q 'sudden_loads: .*the loads move the target nodes by 0.0002669 .*random signs by 0.0003477: 0.76' "$dir/out" &&
    run 0 check "$panel" --set 'loads=[{face: outer, pressure: 100}]' && ! grep -q 'sudden_loads' "$dir/out"
check 'check: loads so large that the supervisor misses reversed amplifiers are warned of' $?
run 3 check tests/rigs/scenes/storm-panel.yaml --set limits.step_limit=0.2 --json && json "j['certificate']['load_step_periods']>=8 and j['certificate']['load_step_longer']"; check 'check --json: a load step that takes longer than is simulated' $?
grep -q '#define PLATE_CLOSED_LOOP_STORMS_FAILED 0' "$dir/damped.h" && grep -q '30 of 30 storms' "$dir/damped.h" &&
    grep -q '#define PLATE_CLOSED_LOOP_READINGS_OLDER 1' "$dir/damped.h" && grep -q '#define PLATE_CLOSED_LOOP_LOAD_STEP_PERIODS PZS_R(1[.]' "$dir/damped.h"; check 'tables: the header carries the certificate' $?
grep -q 'Storms (stress tests: .*' "$dir/damped.h" && ! grep -q '^ [*].* $' "$dir/damped.h"; check 'tables: the comments of the certificate have no blanks at their ends' $?
quiet='--set kinematics=linear --set simulate.influence=undeformed --set simulate.plant.kinematics=linear'
# shellcheck disable=SC2086
run 3 tables plate-few-sensors $quiet --set 'estimate.readings=[{output: tip, noise: 1e-6}]' --set estimate.tolerance=0.99 -o "$dir/unsafe.h" &&
    says 'after a storm of targets at gain' && says '(allowed: 0.05)' && [ ! -e "$dir/unsafe.h" ]
check 'tables: a damped loop that fails a storm is refused by name' $?
cp "$dir/check.json" "$dir/out" && json "j['vibration']['radius']>1.5 and j['vibration']['stable'] is False and 0<j['vibration']['rate_to']<15 and abs(j['vibration']['frequency'][0]-15.04)<.1"; check 'check --json: verdict on the loop' $?
run 0 check plate-closed-loop --set control.rate=0.25 && grep -q 'the loop is stable' "$dir/out" && grep -q 'Every rate up to' "$dir/out"; check 'check: a rate that is stable' $?
run 0 check scordelis-lo && grep -q "vibration not known: .*'concrete'" "$dir/out"; check 'check names the densities that are missing' $?
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $quick --set simulate.ticks=20 && grep -q 'quasi-static plant, no inertia' "$dir/out" && grep -q 'vibration grows' "$dir/out"; check 'simulate says that its plant has no inertia' $?
# shellcheck disable=SC2086
run 0 simulate plate-closed-loop $quick --set simulate.ticks=20 --set materials.G1195.density=0 --json --report "$dir/loop.html" && json "j['dynamics']=='quasi-static' and 'G1195' in j['vibration']['missing']" && grep -q 'quasi-static plant' "$dir/loop.html"; check 'simulate without a density says so' $?

# The header wires a loop: its blocks, exactly the bytes they need, names, the tick rate; as C and as C++
cat >"$dir/wire.c" <<'EOT'
#include "w.h"
#define REALS (W_LOOP_BYTES / sizeof(pzs_real))
static pzs_real work[REALS + 1];
static pzs_loop loop;
int main(void)
{
    if (pzs_loop_init(&loop, w_blocks, W_BLOCKS, NULL, work, W_LOOP_BYTES - 1) != PZS_E_WORKSPACE) return 1;
    if (loop.info.where != (int32_t)W_LOOP_BYTES) return 2;
    if (pzs_loop_init(&loop, w_blocks, W_BLOCKS, NULL, work, W_LOOP_BYTES) != PZS_OK) return 3;
    return W_INPUT_v_5_5 != W_INPUTS - 1 || W_TICK_RATE < 1000 || W_BLOCKS != BLOCKS || loop.info.control == NULL;
}
EOT
# A damped loop has the fault detector with test pulses, the damper and a supervisor.
for case in plate-few-sensors:5:--quasi-static plate-closed-loop:4:--quasi-static plate-few-sensors:5: plate-closed-loop:6:; do
    scene=${case%%:*} blocks=${case#*:} option=${case##*:}
    blocks=${blocks%:*}
    set -- --set simulate.amplifiers.step=0.1 --set "simulate.events=[{at: 3, load: 0, factor: 1, feed_forward: true}, {at: 9, dead: [v_1_1], announced: detected}]"
    [ $scene = plate-closed-loop ] || set --
    # shellcheck disable=SC2086
    run 0 tables $scene "$@" $option --prefix w -o "$dir/w.h"
    for bits in 32 64; do
        gcc -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits -DBLOCKS="$blocks" "$dir/wire.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/wire" 2>"$dir/err" &&
            "$dir/wire" && g++ -x c++ -std=c++11 -pedantic -Wall -Wextra -Werror -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits -DBLOCKS="$blocks" -fsyntax-only "$dir/wire.c" 2>"$dir/err"
        check "$scene $option: the header wires a loop of $blocks blocks, $bits bits" $?
    done
done
# check prints the memory of the loop as the header has it; in float, where pointers of this computer count, at most 3 % more
printf '#include <stdio.h>\n#include "damped.h"\nint main(void) { printf("%%lu", (unsigned long)PLATE_CLOSED_LOOP_LOOP_BYTES); return 0; }\n' >"$dir/size.c"
grep -q 'damps 9 modes from 15.04 to 314.2 Hz' "$dir/damped.out"; check 'tables: prints the modes that the tick damps' $?
for bits in 32 64; do
    gcc -std=c99 -Wall -Wextra -Werror -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits "$dir/size.c" "$B/$bits/libpiezoshape.a" -lm -o "$dir/size" && "$dir/size" >"$dir/size-$bits"
done
cp "$dir/check.json" "$dir/out" && json "j['images']['control']['ram']['double']==$(cat "$dir/size-64") and $(cat "$dir/size-32")<=j['images']['control']['ram']['float']<=1.03*$(cat "$dir/size-32")"
check 'check: RAM of the whole loop' $?
for bits in 32 64; do
    ! gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=$bits -DBLOCKS=5 "$dir/wire.c" "$B/$((96 - bits))/libpiezoshape.a" -lm -o "$dir/wire" 2>"$dir/err" && grep -q "pzs_loop_init_$bits" "$dir/err"
    check "a program with a loop in $bits bits does not link with the other library" $?
done
! gcc -std=c99 -Iinclude -I"$dir" -DPZS_REAL_BITS=64 -DBLOCKS=5 -DW_REAL_BITS=32 -fsyntax-only "$dir/wire.c" 2>"$dir/err" && grep -q 'needs another precision' "$dir/err"
check 'a program that asks for float does not compile in double' $?
echo "1..$n"
