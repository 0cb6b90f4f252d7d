#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare what the sensor gate made of the readings that test_sensor_gate wrote with least squares of numpy.

    test_sensor_gate FILE; sensor_gate.py FILE

The file is doubles: sensors, inputs, most, ratio, machine epsilon, cases, then the influence matrix, weights and thresholds, and for each case and
sensor its reading, its state (0 used, 1 missing, 3 contradicted) and what the gate passes on.

Here each set of excluded sensors has a fit of its own: least squares of the other readings by the columns of the influence matrix. The residual
of a sensor over the root of the part of its own error that shows in it is its studentised residual; the largest one is excluded next. A set
explains the readings if each of its errors reaches its threshold and `ratio` times the largest studentised residual that is left.
"""
import sys

import numpy as np

LEAST = 0.05


def fit(columns, readings, out):
    """Residuals of all sensors from the fit to those that are not `out`, and the free part of each of the others."""
    inside = np.setdiff1d(np.arange(len(readings)), out)
    q = np.linalg.qr(columns[inside])[0]
    coefficients = np.linalg.lstsq(columns[inside], readings[inside], rcond=None)[0]
    free = np.zeros(len(readings))
    free[inside] = 1 - np.sum(q * q, 1)
    return readings - columns @ coefficients, free


def suspect(residual, free):
    shown = np.where(free >= LEAST, np.abs(residual) / np.sqrt(np.maximum(free, LEAST)), 0)
    return int(np.argmax(shown)), shown.max()


def gate(columns, readings, threshold, most, ratio):
    """Contradicted sensors, fitted values of all, and how near the decisions were (1: a tie)."""
    missing = [i for i in range(len(readings)) if not np.isfinite(readings[i])]
    known = np.where(np.isfinite(readings), readings, 0)
    out, best, near = list(missing), [], 0.0
    residual, free = fit(columns, known, out)
    fitted = known - residual
    at, left = suspect(residual, free)
    while len(out) < most and left > 0:
        needed = np.abs(residual[at]) / free[at] / threshold[at]
        near = max(near, min(needed, 1 / needed))
        if needed < 1:
            break
        out.append(at)
        residual, free = fit(columns, known, out)
        at, left = suspect(residual, free)
        chosen = [i for i in out if i not in missing]
        margins = [np.abs(residual[i]) / max(threshold[i], ratio * left) for i in chosen]
        near = max(near, min(min(margins), 1 / min(margins)))
        if min(margins) >= 1:
            best, fitted = chosen, known - residual
    return sorted(best), missing, fitted, near


def main():
    data = np.fromfile(sys.argv[1])
    sensors, inputs, most, ratio, epsilon, cases = (int(x) if x >= 1 else x for x in data[:6])
    at = 6
    columns = data[at:at + sensors * inputs].reshape(sensors, inputs)
    at += sensors * inputs
    weight, threshold = data[at:at + sensors], data[at + sensors:at + 2 * sensors]
    at += 2 * sensors
    ticks = data[at:].reshape(cases, sensors, 3)
    failed = ties = gated = 0
    worst = 0.0
    for number, tick in enumerate(ticks):
        readings, states, passed = tick.T
        chosen, missing, fitted, near = gate(weight[:, None] * columns, weight * readings, threshold, most, ratio)
        if near > 1 - 1e4 * epsilon:
            ties += 1
            continue
        found = list(np.flatnonzero(states > 1))
        gated += len(found) > 0
        expected = readings.copy()
        for i in chosen + missing:
            expected[i] = fitted[i] / weight[i]
        size = np.nanmax(np.abs(readings)) * 4 * sensors * epsilon
        error = np.abs(passed - expected).max() / size if found == chosen else np.inf
        worst = max(worst, error)
        if not error <= 1:
            failed += 1
            print(f'case {number}: gated {found}, numpy {chosen}, {error:.3g} of the rounding bound')
    print(f'{cases} sets of readings, {gated} with gated sensors, {ties} too near to call; at most {worst:.2g} of the rounding bound')
    sys.exit(failed > 0 or gated < cases / 4)


if __name__ == '__main__':
    main()
