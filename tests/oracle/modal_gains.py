#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare the loops that test_modal_gains wrote with a modal leaky integrator of numpy.

    test_modal_gains FILE; modal_gains.py FILE

Each loop is doubles: inputs, outputs, modes, ticks, machine epsilon, regularisation, other_gain, other_leak, limit, then B, W, reference
voltages, step limits, voltages of the modes, gains, leaks, target, and for each tick the voltages before, the measured shape and the voltages
after; ticks = -1: the measured shape of the last tick and its voltages, when the loop has come to rest.

Here the integrator acts on shapes: with A = [W B; sqrt(regularisation) I] and the orthonormal shapes Q = A modes, the wish of a tick is
A v + (gain) P d - (leak) P A (v - v0) for the projection P on each shape and on the rest, with d the best fit of the error by A. The voltages
are those inside all limits whose shape is nearest to the wish: scipy's bounded least squares. At rest they minimise the sum of gain times
squared distance from the best fit and leak times squared distance from the reference shape, over all shapes.
"""
import sys

import numpy as np
from scipy.optimize import lsq_linear

from dumped_numbers import Numbers


def loops(path):
    numbers = Numbers(path)
    take = numbers.take
    while numbers.is_left():
        n, m, modes, ticks = (int(x) for x in take(4))
        epsilon, effort, other_gain, other_leak, limit = take(5)
        loop = dict(n=n, epsilon=epsilon, effort=effort, other=(other_gain, other_leak), limit=limit, rests=ticks < 0)
        for key, shape in (('b', (m, n)), ('weight', (m,)), ('reference', (n,)), ('step', (n,)), ('modes', (modes, n)), ('gain', (modes,)),
                           ('leak', (modes,)), ('wanted', (m,))):
            loop[key] = take(*shape)
        if loop['rests']:
            loop['ticks'] = [(None, take(m), take(n))]
        else:
            loop['ticks'] = [(take(n), take(m), take(n)) for _ in range(ticks)]
        yield loop


def bounded(a, y, lower, upper):
    """min |a v - y| inside the limits, unconstrained where there are none."""
    free = np.linalg.lstsq(a, y, rcond=None)[0]
    if np.all(free >= lower) and np.all(free <= upper):
        return free
    return lsq_linear(a, y, (lower, upper), method='bvls', tol=1e-15, max_iter=2000).x


def stacked(loop):
    return np.vstack([loop['weight'][:, None] * loop['b'], np.sqrt(loop['effort']) * np.eye(loop['n'])])


def weighting(loop, shapes, which):
    """Matrix that multiplies the part along each shape by its gain or leak, and the rest by that of everything else."""
    each, other = loop[('gain', 'leak')[which]], loop['other'][which]
    return other * np.eye(len(shapes)) + shapes @ np.diag(each - other) @ shapes.T


def tick(loop, before, measured):
    a = stacked(loop)
    shapes = a @ loop['modes'].T
    error = np.concatenate([loop['weight'] * (loop['wanted'] - measured), -np.sqrt(loop['effort']) * (before - loop['reference'])])
    fit = a @ np.linalg.lstsq(a, error, rcond=None)[0]
    wish = a @ before + weighting(loop, shapes, 0) @ fit - weighting(loop, shapes, 1) @ a @ (before - loop['reference'])
    lower = np.maximum(-loop['limit'], before - loop['step'])
    upper = np.minimum(loop['limit'], before + loop['step'])
    return bounded(a, wish, lower, upper), np.any(np.isfinite(np.concatenate([lower, upper])))


def rest(loop, measured, after):
    a = stacked(loop)
    shapes = a @ loop['modes'].T
    wanted = loop['wanted'] - (measured - loop['b'] @ after)
    best = np.linalg.lstsq(a, np.concatenate([loop['weight'] * wanted, np.sqrt(loop['effort']) * loop['reference']]), rcond=None)[0]
    values, vectors = np.linalg.eigh(weighting(loop, shapes, 0))
    gains = np.sqrt(np.maximum(values, 0))[:, None] * vectors.T @ a
    values, vectors = np.linalg.eigh(weighting(loop, shapes, 1))
    leaks = np.sqrt(np.maximum(values, 0))[:, None] * vectors.T @ a
    both = np.vstack([gains, leaks])
    y = np.concatenate([gains @ best, leaks @ loop['reference']])
    limit = np.full(loop['n'], loop['limit'])
    return bounded(both, y, -limit, limit)


def main():
    worst = {'unconstrained': 0.0, 'bounded': 0.0, 'at rest': 0.0}
    count = dict.fromkeys(worst, 0)
    failed = 0
    for number, loop in enumerate(loops(sys.argv[1])):
        condition = np.linalg.cond(stacked(loop)) ** 2
        for before, measured, after in loop['ticks']:
            if loop['rests']:
                expected, what, many = rest(loop, measured, after), 'at rest', 20
            else:
                expected, is_bounded = tick(loop, before, measured)
                what, many = 'bounded' if is_bounded else 'unconstrained', 1
            size = np.abs(expected).max() + 50
            allowed = 4 * many * len(loop['wanted']) * condition * loop['epsilon'] * size
            excess = np.abs(after - expected).max() / allowed
            count[what] += 1
            worst[what] = max(worst[what], excess)
            inside = np.all(np.abs(after) <= loop['limit'])
            if excess > 1 or not inside:
                failed += 1
                print(f'loop {number}, {what}: differs by {np.abs(after - expected).max():.3g} V of {size:.3g} V')
    said = ', '.join(f'{count[what]} {what} (at most {worst[what]:.2g} of the rounding bound)' for what in worst)
    print(f'leaky integrators: {said}')
    sys.exit(failed > 0)


if __name__ == '__main__':
    main()
