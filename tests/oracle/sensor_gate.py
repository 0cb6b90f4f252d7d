#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare what the sensor gate made of the readings that test_sensor_gate wrote with least squares of numpy.

    test_sensor_gate FILE; sensor_gate.py FILE

The file is doubles: sensors, inputs, relations, quick, most, ratio, machine epsilon, cases, then the influence matrix, the parity table and the
thresholds, and for each case, tick and sensor its reading, its state (0 used, 1 missing, 3 contradicted) and what the gate passes on.

The parity table is checked first: its columns are orthogonal to the influence matrix, and its Gram matrix is a multiple of 1. Here each set of
suspected sensors has a fit of its own: least squares of the values of the parity relations by the rows of these sensors. The sensor whose row has
the largest cosine with what is left is suspected next, one in each tick. A set explains the readings if each of its errors reaches its threshold,
and its row times the error `ratio` times the norm of what is left.
"""
import sys

import numpy as np

LEAST = 0.02


def fit(rows, values, out):
    """Errors of the sensors `out`, and what they leave of the values of the parity relations."""
    if not out:
        return np.zeros(0), values
    errors = np.linalg.lstsq(rows[out].T, values, rcond=None)[0]
    return errors, values - errors @ rows[out]


class Gate:
    """The judgement of a sequence of ticks. `near`: how near a decision was (1: a tie)."""

    def __init__(self, rows, quick, threshold, most, ratio):
        self.rows, self.quick, self.threshold, self.most, self.ratio = rows, quick, threshold, most, ratio
        self.norm = np.linalg.norm(rows, axis=1)
        self.quiet = np.min(threshold * np.linalg.norm(rows[:, :quick], axis=1)) * (1 - 1e-5)
        self.gated, self.suspected, self.near = [], [], 0.0

    def decide(self, ratio):
        """Whether a ratio is at least 1."""
        self.near = max(self.near, min(ratio, 1 / ratio) if ratio > 0 else 0)
        return ratio >= 1

    def explains(self, out, errors, left):
        chosen = [k for k, i in enumerate(out) if i in self.suspected]
        margins = [np.abs(errors[k]) / max(self.threshold[out[k]], self.ratio * np.linalg.norm(left) / self.norm[out[k]]) for k in chosen]
        return bool(chosen) and self.decide(min(margins))

    def tick(self, readings):
        """Returns the readings that the gate passes on."""
        missing = [i for i in range(len(readings)) if not np.isfinite(readings[i])]
        self.suspected = [i for i in self.suspected if i not in missing]
        values = np.where(np.isfinite(readings), readings, 0) @ self.rows
        out = [i for i in missing if i not in self.gated] + self.gated + self.suspected
        passed = readings.copy()
        if len(out) > self.most:
            self.suspected = []
            passed[missing + self.gated] = np.nan
            return passed
        if not out and not self.decide(np.linalg.norm(values[:self.quick]) / self.quiet):
            return passed
        errors, left = fit(self.rows, values, out)
        out, errors = self.judge(values, out, errors, left)
        for k, i in enumerate(out):
            if i in missing or i in self.gated:
                passed[i] = (readings[i] if np.isfinite(readings[i]) else 0) - errors[k]
        return passed

    def judge(self, values, out, errors, left):
        if self.explains(out, errors, left):
            self.gated, self.suspected = self.gated + self.suspected, []
            return out, errors
        size = np.abs(self.rows @ left) / self.norm
        at = int(np.argmax(size))
        if not (self.decide(np.linalg.norm(left) / self.quiet) and self.decide(size[at] / self.norm[at] / self.threshold[at])):
            self.suspected = []
            return out, errors
        own = fit(self.rows, self.rows[at], out)[1]
        if len(out) >= self.most or not self.decide(own @ own / self.norm[at] ** 2 / LEAST):
            self.suspected = self.suspected[1:]
            return out, errors
        out, self.suspected = out + [at], self.suspected + [at]
        errors, left = fit(self.rows, values, out)
        if self.explains(out, errors, left):
            self.gated, self.suspected = self.gated + self.suspected, []
        else:
            small = [i for k, i in enumerate(out) if not self.decide(np.abs(errors[k]) / self.threshold[i])]
            self.suspected = [i for i in self.suspected if i not in small]
        return out, errors


def check_parity(columns, rows, epsilon):
    gram = rows.T @ rows
    size = gram[0, 0]
    assert np.abs(gram - size * np.eye(len(gram))).max() <= 64 * epsilon * size
    assert np.abs(rows.T @ columns).max() <= 8 * len(rows) * epsilon * np.abs(rows).max() * np.abs(columns).max()


def main():
    data = np.fromfile(sys.argv[1])
    sensors, inputs, relations, quick, most, ratio, epsilon, cases = (int(x) if x >= 1 else x for x in data[:8])
    at = 8
    columns = data[at:at + sensors * inputs].reshape(sensors, inputs)
    at += sensors * inputs
    rows = data[at:at + sensors * relations].reshape(sensors, relations)
    at += sensors * relations
    threshold = data[at:at + sensors]
    at += sensors
    cases_of = data[at:].reshape(cases, -1, sensors, 3)
    check_parity(columns, rows, epsilon)
    failed = ties = gated = 0
    worst = 0.0
    for number, ticks in enumerate(cases_of):
        gate = Gate(rows, quick, threshold, most, ratio)
        for tick in ticks:
            readings, states, passed = tick.T
            expected = gate.tick(readings)
            if gate.near > 1 - 1e4 * epsilon:
                ties += 1
                break
            found = sorted(np.flatnonzero(states > 1))
            chosen = sorted(i for i in gate.gated if np.isfinite(readings[i]))
            size = np.nanmax(np.abs(readings)) * 4 * sensors * epsilon / np.sqrt(LEAST)
            both = np.isfinite(expected)
            same = found == chosen and np.array_equal(both, np.isfinite(passed))
            error = np.abs(passed - expected)[both].max() / size if same else np.inf
            worst = max(worst, error)
            if not error <= 1:
                failed += 1
                print(f'case {number}: gated {found}, numpy {chosen}, {error:.3g} of the rounding bound')
                break
        gated += len(gate.gated) > 0
    print(f'{cases} sequences of readings, {gated} with gated sensors, {ties} too near to call; at most {worst:.2g} of the rounding bound')
    sys.exit(failed > 0 or gated < cases / 4)


if __name__ == '__main__':
    main()
