#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare `pzs shape` on actuators with curves with scipy's bounded least squares in effects and the inverse of the curve.

    curves.py PZS [COUNT]; TAP lines

Each scene has a random matrix, a random target, random voltage limits and one of: the square, a table for all actuators, a table
for each. The oracle evaluates the curve itself, with numpy. Its voltages need not be ours where the Hessian is nearly singular,
so the objectives are compared; voltages at a limit have the effect of the limit in scipy's solution, too.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.optimize import lsq_linear

HEAD = """name: random
units: {length: m, force: N, voltage: V, temperature: K}
"""
# scipy's bounds are open for points near them; both objectives agree to this part of the squared target.
TOLERANCE = 1e-11


class Square:
    key = 'quadratic'

    def __init__(self, rng, n):
        self.lower = rng.uniform(0, 50, n) * (rng.random(n) < 0.5)
        self.upper = self.lower + rng.uniform(20, 200, n)

    def effect(self, k, v):
        return v * v


class Table:
    def __init__(self, rng, n, each, folder):
        points = rng.integers(2, 20)
        self.voltage = np.cumsum(np.append(rng.uniform(-150, 20), rng.uniform(1, 40, points)))
        sets = n if each else 1
        steps = np.diff(self.voltage) * 10 ** rng.uniform(-2, 0, (sets, points))
        rows = np.cumsum(np.hstack([rng.uniform(-3, 3, (sets, 1)), steps]), axis=1) * 10 ** rng.uniform(-6, 6)
        self.points = rows * (-1 if rng.random() < 0.3 else 1)
        a, b = np.sort(rng.uniform(0, 1, (2, n)), axis=0)
        span = self.voltage[-1] - self.voltage[0]
        self.lower, self.upper = self.voltage[0] + a * span, self.voltage[0] + b * span
        whole = rng.random(n) < 0.5
        self.lower[whole], self.upper[whole] = self.voltage[0], self.voltage[-1]
        names = ','.join(f'v{k + 1}' for k in range(n)) if each else 'e'
        np.savetxt(folder / 'curve.csv', np.vstack([self.voltage, self.points]).T, '%.17g', ',', header='v,' + names, comments='')
        self.key = '{file: curve.csv}'

    def effect(self, k, v):
        return np.interp(v, self.voltage, self.points[k if len(self.points) > 1 else 0])


def problem(rng, folder, number):
    n = int(rng.integers(1, 12))
    m = n + int(rng.integers(0, 15))
    curve = Square(rng, n) if number % 3 == 0 else Table(rng, n, number % 3 == 2, folder)
    ends = np.array([[curve.effect(k, curve.lower[k]), curve.effect(k, curve.upper[k])] for k in range(n)])
    matrix = rng.normal(size=(m, n)) * 10 ** rng.uniform(-9, 3)
    target = matrix @ (ends[:, 0] + rng.uniform(-0.5, 1.5, n) * (ends[:, 1] - ends[:, 0])) + 0.1 * rng.normal(size=m) * np.abs(matrix @ ends[:, 1]).mean()
    np.savetxt(folder / 'matrix.csv', matrix, '%.17g', ',')
    each = ', '.join(f'{{actuator: v{k + 1}, voltage: [{float(low)!r}, {float(high)!r}]}}'
                     for k, (low, high) in enumerate(zip(curve.lower, curve.upper)))
    (folder / 'scene.yaml').write_text(
        HEAD + f'influence: {{file: matrix.csv, curve: {curve.key}}}\n'
        f'limits: {{voltage: [{float(curve.lower.min())!r}, {float(curve.upper.max())!r}], each: [{each}]}}\n'
        f'target: {{value: [{", ".join(repr(float(t)) for t in target)}]}}\n')
    return curve, matrix, target, ends


def oracle(matrix, target, ends):
    low, high = ends.min(axis=1), ends.max(axis=1)
    scale = high - low
    found = lsq_linear(matrix * scale, target - matrix @ low, (0, 1), method='bvls', tol=1e-15, max_iter=3000)
    return low + np.clip(found.x, 0, 1) * scale


def main():
    pzs, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 120
    rng = np.random.default_rng(7)
    worst, failed, limits, inner = 0.0, 0, 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for number in range(count):
            curve, matrix, target, ends = problem(rng, folder, number)
            said = subprocess.run([pzs, 'shape', str(folder / 'scene.yaml'), '--json'], capture_output=True, text=True)
            if said.returncode:
                print(f'# problem {number}: {said.stderr.strip()}')
                failed += 1
                continue
            volts = np.array(list(json.loads(said.stdout)['voltages'].values()))
            effect = np.array([curve.effect(k, v) for k, v in enumerate(volts)])
            ours = np.sum((matrix @ effect - target) ** 2)
            theirs = np.sum((matrix @ oracle(matrix, target, ends) - target) ** 2)
            excess = (ours - theirs) / np.sum(target ** 2)
            worst = max(worst, excess)
            at_limit = (volts == curve.lower) | (volts == curve.upper)
            limits += np.count_nonzero(at_limit)
            inner += np.count_nonzero(~at_limit)
            if excess > TOLERANCE or not (np.all(volts >= curve.lower) and np.all(volts <= curve.upper)):
                failed += 1
                print(f'# problem {number}: ours {ours:.17g}, scipy {theirs:.17g}, volts {volts}')
    good = failed == 0 and limits > count and inner > count
    print(f'{"ok" if good else "not ok"} 1 - {count} mirrors with actuator curves against scipy: objective above it by at most {worst:.1e} of the '
          f'target; {limits} voltages at a limit to the bit, {inner} inside')
    print('1..1')
    return not good


if __name__ == '__main__':
    sys.exit(main())
