#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Random faults on the demonstration plate, which vibrates and has hysteresis, under the supervisor.
#
#   random_faults.sh [SEEDS] [TICKS]   default: seeds 1 to 3, 1,000,000 ticks each, hysteresis 10 and 30 %
#
# Faults, targets and loads change in 5 % of the ticks: sensors missing or stuck, missed ticks, dead and stuck
# electrodes. Law: no voltage beyond a limit or a step limit, none that is not finite, control is never taken
# away, and no test of the polarity runs. After the faults, in the last 1000 ticks, the error of the shape returns to
# that of the optimum of the plant, to 0.002 % of the target with 10 % hysteresis and to 0.1 % with 30 %.
set -u
cd "$(dirname "$0")/../.."
B=${B:-build}
seeds=${1:-3}
ticks=${2:-1000000}
dir=$(mktemp -d "${TMPDIR:-/tmp}/pzs-XXXXXX")
trap 'rm -rf "$dir"' EXIT
bad=0
for seed in $(seq "$seeds"); do
    for width in 0.1 0.3; do
        "$B/pzs" simulate plate-closed-loop --set kinematics=linear --set simulate.influence=undeformed \
            --set simulate.plant.kinematics=linear --set 'simulate.events=[]' --set "simulate.ticks=$ticks" \
            --set "simulate.faults={chance: 0.05, until: $((ticks - 1000))}" --set 'safety={timeout: 400}' \
            --set "simulate.seed=$seed" --set "simulate.plant.hysteresis=$width" --json --csv "$dir/ticks.csv" \
            >"$dir/out.json" 2>"$dir/err"
        status=$?
        # The ticks in which the supervisor ramps to the park voltages have status 9, those of a test of the polarity 17.
        taken=$(awk -F, '$7 == 9 || $7 == 17' "$dir/ticks.csv" | wc -l)
        rm -f "$dir/ticks.csv"
        if [ $status -ne 0 ] || [ "$taken" -ne 0 ]; then
            echo "not ok - seed $seed, hysteresis $width: exit code $status, $taken ticks of a ramp or a test"
            sed 's/^/# /' "$dir/err"
            bad=1
            continue
        fi
        /usr/bin/python3 - "$dir/out.json" "$seed" "$width" <<'END' || bad=1
import json, sys
result = json.load(open(sys.argv[1]))
count, last = result['counts']['controller'], result['phases'][-1]
off = last['controller']['steady'] - last['optimum']
good = (count['beyond'] == count['beyond_rows'] == count['not_finite'] == count['out_of_iterations'] == 0
        and abs(off) < (2e-5 if float(sys.argv[3]) < 0.2 else 1e-3))
print('%s - seed %s, hysteresis %s: %d beyond a limit, %d not finite, ends %.2g of the target from the optimum'
      % ('ok' if good else 'not ok', sys.argv[2], sys.argv[3], count['beyond'], count['not_finite'], off))
sys.exit(not good)
END
    done
done
exit $bad
