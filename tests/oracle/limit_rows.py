#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare voltages within limit rows with least distance programming by non-negative least squares.

    test_limit_rows FILE COUNT; limit_rows.py FILE

Each record is doubles: inputs, outputs, rows, rows of absolute values (the last ones), regularisation, B, W, e, lower, upper, reference voltages, rows (dense),
their lowest and highest sums, voltages. With the factor R of the Hessian the problem is min |R v - c| with G v >= h, which
Lawson and Hanson (chapter 23) turn into non-negative least squares. Hessians with a condition above 1e8 are left to the
duality gap that the test program computes itself. The objective may exceed scipy's by 1e-9 of the squared target error.
"""
import sys

import numpy as np
from scipy.optimize import nnls

TOLERANCE = 1e-9


def records(path):
    data = np.fromfile(path)
    at = 0
    while at < len(data):
        n, m, rows, absolute, effort = int(data[at]), int(data[at + 1]), int(data[at + 2]), int(data[at + 3]), data[at + 4]
        at += 5
        parts = []
        for size in (n * m, m, m, n, n, n, rows * n, rows, rows, n):
            parts.append(data[at:at + size])
            at += size
        b, weight, e, lower, upper, reference, a, low, high, voltage = parts
        a = a.reshape(rows, n)
        yield effort, b.reshape(m, n), weight, e, lower, upper, reference, a, low, high, rows - absolute, voltage


def least_distance(r, c, g, h):
    """The voltages that minimise |r v - c| with g v >= h."""
    y = np.linalg.solve(r, c)
    gr = np.linalg.solve(r.T, g.T).T
    d = h - g @ y
    scale = 1 / np.maximum(np.linalg.norm(gr, axis=1), 1e-300)
    gr, d = gr * scale[:, None], d * scale
    size = max(np.abs(d).max(), 1e-300)
    u, _ = nnls(np.vstack([gr.T, d / size]), np.append(np.zeros(len(c)), 1), maxiter=100 * len(d))
    # The step -rest[:-1] / rest[-1] loses digits where rest[-1] is small: it left rows broken by 1e-8 of the voltages.
    # The shortest step that meets the rows with a multiplier is the same step, to rounding.
    step, _, _, _ = np.linalg.lstsq(gr[u > 0], d[u > 0], rcond=None)
    return y + np.linalg.solve(r, step)


def least_distance_absolute(r, c, g, h, weights, most):
    """The same, also with weights |v| <= most: half spaces sign(v) weights v <= most are added until all hold."""
    for _ in range(2000):
        v = least_distance(r, c, g, h)
        sums = weights @ np.abs(v)
        broken = np.flatnonzero(sums > most * (1 + 1e-13))
        if len(broken) == 0:
            return v
        g = np.vstack([g, -weights[broken] * np.where(v < 0, -1, 1)])
        h = np.concatenate([h, -most[broken]])
    return None


def main():
    count = left_out = failed = 0
    worst = 0.0
    for number, (effort, b, weight, e, lower, upper, reference, a, low, high, first, voltage) in enumerate(records(sys.argv[1])):
        a, low, high, weights, most = a[:first], low[:first], high[:first], a[first:], high[first:]
        stacked = np.vstack([weight[:, None] * b, np.sqrt(effort) * np.eye(len(voltage))])
        wanted = np.concatenate([weight * e, np.sqrt(effort) * reference])
        r = np.linalg.qr(stacked, mode='r')
        if np.linalg.cond(r) > 1e4:
            left_out += 1
            continue
        c = np.linalg.solve(r.T, stacked.T @ wanted)
        g = np.vstack([np.eye(len(voltage)), -np.eye(len(voltage)), a, -a])
        h = np.concatenate([lower, -upper, low, -high])
        keep = np.isfinite(h) & (np.abs(g).sum(axis=1) > 0)
        best = least_distance_absolute(r, c, g[keep], h[keep], weights, most)
        if best is None:
            left_out += 1
            continue
        ours, theirs = np.sum((stacked @ voltage - wanted) ** 2), np.sum((stacked @ best - wanted) ** 2)
        excess = (ours - theirs) / max(np.sum((weight * e) ** 2), ours)
        count += 1
        worst = max(worst, excess)
        inside = np.all(voltage >= lower) and np.all(voltage <= upper) and np.all(weights @ np.abs(voltage) <= most * (1 + 1e-14))
        if excess > TOLERANCE or not inside:
            failed += 1
            print(f'problem {number}: ours {ours:.17g}, scipy {theirs:.17g}')
    print(f'{count} problems against scipy: objective above by at most {worst:.2g} of the squared target error, '
          f'{left_out} left to the duality gap, {failed} failed')
    return failed > 0 or count == 0


if __name__ == '__main__':
    sys.exit(main())
