#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Oracle of the damper: observer gain by structured doubling and 40 ticks of the damper, in numpy.

Written from the formulas alone. A random structure of modes with random sensors, readings and
voltages; some readings are missing, some frames do not arrive. Writes data/damper.txt.
"""
import os

import numpy as np

from textdata import write

MODES, INPUTS, SENSORS, OUTPUTS, DELAY, TICKS = 4, 3, 7, 10, 2, 40
LAG, LEAD_LOSS = 0.2, 0.5  # tick over the time constant of the amplifiers
KICK, DRIFT, SLOW, MIX, RIDGE = 0.25, 0.21, 0.05, 0.75, 1e-7


def riccati(a, c, q):
    """P = A P A' - A P C' (C P C' + 1)^-1 C P A' + Q by structured doubling."""
    transition, information, solution = a.T, c.T @ c, q.copy()
    one = np.eye(len(a))
    for _ in range(60):
        inverse = np.linalg.inv(one + information @ solution)
        step = transition.T @ solution @ inverse @ transition
        information = information + transition @ inverse @ information @ transition.T
        transition = transition @ inverse @ transition
        solution = solution + step
        if np.abs(step).max() <= 1e-15 * np.abs(solution).max():
            break
    return solution


def ticks(f, lag):
    """States, shapes and damping gradients of all ticks; lag: tick over time constant, or 0."""
    n, angle, modal, voltage = MODES, f['angle'], f['modal'], f['voltage']
    kept = np.exp(-lag) if lag else 0
    mean = (1 - kept) / lag if lag else 0
    scale = abs((1 - kept * np.exp(-1j * angle)) / (1 - kept)) ** -LEAD_LOSS

    x = np.concatenate([modal @ voltage[0], np.zeros(2 * n)])
    output = voltage[0]
    past = [voltage[0]] * (DELAY + 1)
    residual, before = np.zeros(SENSORS), np.zeros(n)
    states, shapes, gradients = [], [], []
    for k in range(TICKS):
        # The present voltages were given out at the last tick; past holds what acted since then.
        acting, earlier = voltage[k] + mean * (output - voltage[k]), output
        past = past[1:] + [acting]
        output = voltage[k] + kept * (output - voltage[k])
        x = f['a'] @ x + f['b'] @ past[0]
        if not f['absent'][k]:
            static = (f['direct'] - f['reading'] @ modal) @ past[0]
            e = f['frames'][k] - f['reading'] @ x[:n] - static
            e = np.where(f['missing'][k], residual, e)
            x = x + f['observer'] @ e
            residual = residual + SLOW * (f['rest'] @ e - residual)
        now = x
        for v in past[1:]:
            now = f['a'] @ now + f['b'] @ v
        position, velocity, load = now[:n], now[n:2 * n], now[2 * n:]
        mixed = (1 - MIX) * (position - load - modal @ output)
        mixed += MIX * (before - velocity) / angle
        before = velocity
        # The deviation from the equilibrium under the output a tick before: the mode turned back.
        last = np.cos(angle) * (mixed + modal @ (output - acting)) - np.sin(angle) * velocity
        last -= modal @ (earlier - acting)
        change = (mixed - kept * last) / (1 - kept)
        states.append(now)
        shapes.append(f['influence'] @ voltage[k] + f['shape'] @ load + f['gain'] @ residual)
        gradients.append(f['damping'].T @ (scale * change))
    return states, shapes, gradients


def main():
    rng = np.random.default_rng(11)
    n = MODES
    angle = np.sort(rng.uniform(0.1, 1.8, n))
    ratio = rng.uniform(0.002, 0.02, n)
    modal = rng.uniform(-1, 1, (n, INPUTS)) * 1e-6
    shape = rng.uniform(-1, 1, (OUTPUTS, n))
    reading = rng.uniform(-1, 1, (SENSORS, n))
    direct = reading @ modal + rng.uniform(-1, 1, (SENSORS, INPUTS)) * 1e-7
    influence = shape @ modal + rng.uniform(-1, 1, (OUTPUTS, INPUTS)) * 1e-7
    gain = rng.uniform(-1, 1, (OUTPUTS, SENSORS))
    damping = rng.uniform(-1, 1, (n, INPUTS))

    root, decay = np.sqrt(1 - ratio**2), np.exp(-ratio * angle)
    cosine, sine = decay * np.cos(root * angle), decay * np.sin(root * angle) / root
    r = np.array([cosine + ratio * sine, sine, -sine, cosine - ratio * sine])
    a = np.zeros((3 * n, 3 * n))
    b = np.zeros((3 * n, INPUTS))
    for i in range(n):
        a[i, i], a[i, n + i], a[i, 2 * n + i] = r[0, i], r[1, i], 1 - r[0, i]
        a[n + i, i], a[n + i, n + i], a[n + i, 2 * n + i] = r[2, i], r[3, i], -r[2, i]
        a[2 * n + i, 2 * n + i] = 1
        b[i] = (1 - r[0, i]) * modal[i]
        b[n + i] = -r[2, i] * modal[i]
    fall = angle[0] / angle / np.sqrt(SENSORS)
    q = np.diag(np.concatenate([np.full(n, 1e-12), (KICK * fall) ** 2, (DRIFT * fall) ** 2]))
    c = np.hstack([reading, np.zeros((SENSORS, 2 * n))])
    p = riccati(a, c, q)
    observer = p @ c.T @ np.linalg.inv(c @ p @ c.T + np.eye(SENSORS))
    overlap = reading.T @ reading
    ridge = RIDGE * np.trace(overlap) / n * np.eye(n)
    explain = np.linalg.solve(overlap + ridge, reading.T)
    rest = np.eye(SENSORS) - reading @ explain

    voltage = rng.uniform(-100, 100, (TICKS, INPUTS))
    frames = rng.uniform(-1, 1, (TICKS, SENSORS)) * 2e-4
    missing = rng.uniform(0, 1, (TICKS, SENSORS)) < 0.1
    absent = rng.uniform(0, 1, TICKS) < 0.15

    frame = dict(a=a, b=b, angle=angle, modal=modal, shape=shape, reading=reading, direct=direct,
                 influence=influence, gain=gain, damping=damping, observer=observer, rest=rest,
                 voltage=voltage, frames=frames, missing=missing, absent=absent)
    states, shapes, gradients = ticks(frame, 0)
    lag_states, lag_shapes, lag_gradients = ticks(frame, LAG)

    arrays = dict(angle=angle, ratio=ratio, modal=modal, shape=shape, reading=reading,
                  direct=direct, influence=influence, gain=gain, damping=damping, covariance=p,
                  observer=observer, voltage=voltage, frames=frames, missing=missing,
                  absent=absent, states=np.array(states), shapes=np.array(shapes),
                  gradients=np.array(gradients), lag_states=np.array(lag_states),
                  lag_shapes=np.array(lag_shapes), lag_gradients=np.array(lag_gradients))
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'data', 'damper.txt')
    write(path, 'Written by write_damper.py: a damper with random tables, and 40 ticks of it.',
          [('damper', {}, arrays)])


if __name__ == '__main__':
    main()
