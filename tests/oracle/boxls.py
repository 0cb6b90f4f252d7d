#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Solve the problems that test_control wrote with scipy's exact bounded least squares and compare objectives.

    test_control FILE COUNT; boxls.py FILE [--all]

Each record is doubles: n m effort tolerance B W e lower upper prefer volt. The objective
|W (B v - e)|^2 + effort |v - prefer|^2 of the given volts must not exceed scipy's (method bvls, started from
its own least squares) by more than tolerance |W e|^2; scipy ending above ours by more is counted, not
an error. Without --all every tenth record is solved: the certificate in test_control.c covers all of them.
"""
import sys

import numpy as np
from scipy.optimize import lsq_linear


def records(path):
    data = np.fromfile(path)
    at = 0
    while at < len(data):
        n, m, effort, tolerance = int(data[at]), int(data[at + 1]), data[at + 2], data[at + 3]
        at += 4
        parts = []
        for size in (n * m, m, m, n, n, n, n):
            parts.append(data[at:at + size])
            at += size
        yield effort, tolerance, parts[0].reshape(m, n), *parts[1:]


def solve(a, y, lower, upper):
    """min |a v - y| over the box; inputs without room are taken out first, which scipy cannot do."""
    v = lower.copy()
    free = lower < upper
    if free.any():
        rest = y - a[:, ~free] @ v[~free]
        v[free] = lsq_linear(a[:, free], rest, (lower[free], upper[free]), method='bvls', tol=1e-15, max_iter=2000).x
    return np.clip(v, lower, upper)


def main():
    path, step = sys.argv[1], 1 if '--all' in sys.argv else 10
    count = above = failed = 0
    worst = 0.0
    for number, (effort, tolerance, b, weight, e, lower, upper, prefer, volt) in enumerate(records(path)):
        if number % step:
            continue
        a = np.vstack([weight[:, None] * b, np.sqrt(effort) * np.eye(len(volt))])
        y = np.concatenate([weight * e, np.sqrt(effort) * prefer])
        allowed = tolerance * np.sum((weight * e) ** 2)
        ours = np.sum((a @ volt - y) ** 2)
        theirs = np.sum((a @ solve(a, y, lower, upper) - y) ** 2)
        excess = (ours - theirs) / allowed
        count += 1
        worst = max(worst, excess)
        above += excess < -1
        if excess > 1 or not (np.all(volt >= lower) and np.all(volt <= upper)):
            failed += 1
            print(f'problem {number}: n {len(volt)}, m {len(e)}: ours {ours:.17g}, scipy {theirs:.17g}')
    print(f'{count} problems against scipy: excess at most {worst:.2g} of what is allowed, '
          f'scipy worse in {above}, {failed} failed')
    return failed > 0


if __name__ == '__main__':
    sys.exit(main())
