#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Margin of a loop against errors of its influence matrix: the program against numpy.

    matrix_errors.py PZS FOLDER

A mirror of 16 actuators with wide influence functions, whose weakest singular values lie below the errors of a measurement. Without
limits and vibration the voltages of the tick obey v(next) = F (t - s G v), F = (B'PB + r)^-1 B'P, G = entries of B times random
numbers, P = projector that takes out the free functions of the target; the margin is the smallest 1 / (spectral radius of F G) over the random sequences of the program. Then the whole way of a user:
`check` refuses the scene, `simulate` with the errors ends far from the target, with exit code 1 where it is many times as far as at rest, and with the regularisation that `check`
names it passes and settles.
"""
import json
import subprocess
import sys

import numpy as np

SEQUENCES = 16
PZS, FOLDER = sys.argv[1:3]
SCENE = FOLDER + '/mirror.yaml'


def noises(seed, count):
    """The numbers of random_noise: splitmix64, sums of twelve uniform numbers less six."""
    step = np.uint64(0x9e3779b97f4a7c15)
    with np.errstate(over='ignore'):
        z = np.uint64(seed) + step * np.arange(1, 12 * count + 1, dtype=np.uint64)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xbf58476d1ce4e5b9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94d049bb133111eb)
    z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)).astype(float).reshape(count, 12).sum(axis=1) * 2.0 ** -53 - 6


def margin(matrix, free, relative):
    outputs, inputs = matrix.shape
    basis = np.linalg.qr(free)[0]
    projected = matrix - basis @ (basis.T @ matrix)
    hessian = projected.T @ projected
    hessian += relative * np.trace(hessian) / inputs * np.eye(inputs)
    answer = np.linalg.solve(hessian, projected.T)
    radii = [abs(np.linalg.eigvals(answer @ (matrix * noises(seed, outputs * inputs).reshape(matrix.shape)))).max()
             for seed in range(1, SEQUENCES + 1)]
    return 1 / max(radii)


def run(command, *changes):
    """Exit code and JSON of a command, and its message."""
    sets = [word for change in changes for word in ('--set', change)]
    done = subprocess.run([PZS, command, SCENE, '--json', *sets], capture_output=True, text=True, check=False)
    return done.returncode, json.loads(done.stdout) if done.stdout else None, done.stderr


def write_mirror():
    grid = np.arange(4.0)
    actuators = np.array([(x, y) for y in grid for x in grid])
    place = np.array([(x, y) for y in np.linspace(-.5, 3.5, 6) for x in np.linspace(-.5, 3.5, 6)])
    matrix = np.exp(-((place[:, None] - actuators[None]) ** 2).sum(axis=2) / (2 * 1.6 ** 2))
    np.savetxt(FOLDER + '/matrix.csv', matrix, delimiter=',', fmt='%.17g')
    np.savetxt(FOLDER + '/places.csv', place, delimiter=',', fmt='%.17g')
    with open(SCENE, 'w', encoding='utf-8') as file:
        file.write('name: mirror\nunits: {length: mm, force: N, voltage: V}\n'
                   'influence: {file: matrix.csv, scale: 1e-4, coordinates: {file: places.csv}}\n'
                   'limits: {voltage: [-100, 100]}\ntarget: {value: "1e-4*(x - 1.5)*(y - 1.5)"}\ncontrol: {rate: 1000}\n'
                   'simulate: {ticks: 600, events: [{at: 0, target: 1}]}\n')
    return 1e-4 * matrix, place


def main():
    matrix, place = write_mirror()
    outputs = len(matrix)
    # Bisection to 0.5 / 1e-4 in 2^9 parts, twice: 1.7 %; growth by 0.25 in 400 ticks: 0.06 % of the radius.
    tolerance = (0.5 / 1e-4) ** (1 / 2 ** 9) - 1 + .25 / 400
    no_limits = 'limits={}'
    for relative in (1e-7, 1e-5, 1e-4, 1e-3):
        for names, free in (('', np.zeros((outputs, 0))), ('piston, tip', np.column_stack([np.ones(outputs), place[:, 0]]))):
            _, found, message = run('check', 'target.free=[%s]' % names, no_limits, 'limits.regularisation={relative: %g}' % relative)
            assert found, message
            wanted, shown = margin(matrix, free, relative), found['matrix_errors']['margin']
            assert abs(shown / wanted - 1) < 2 * tolerance, (relative, shown, wanted)
    # Readings that are d ticks old make d + 1 such loops of the tick, which take turns, each with a part of the ticks.
    for delay in (1, 2, 3, 6):
        _, found, message = run('check', no_limits, 'limits.regularisation={relative: 1e-4}', 'simulate.sensors={delay: %d}' % delay)
        wanted, shown = margin(matrix, np.zeros((outputs, 0)), 1e-4), found['matrix_errors']['margin']
        assert abs(shown / wanted - 1) < 2 * tolerance + .25 * delay / 400, (delay, shown, wanted)
    code, found, message = run('check')
    errors = found['matrix_errors']
    assert code == 3 and 'influence.scatter' in message and errors['margin'] < errors['expected'], (code, errors, message)
    tables = subprocess.run([PZS, 'tables', SCENE, '-o', FOLDER + '/mirror.h'], capture_output=True, check=False)
    assert tables.returncode == 3
    cure = 'limits.regularisation={relative: %g}' % errors['regularisation']
    code, cured, message = run('check', cure)
    assert code == 0 and cured['matrix_errors']['margin'] >= errors['margin_wanted'], (code, message)
    assert abs(cured['matrix_errors']['margin'] - errors['regularised_margin']) <= 1e-12
    assert errors['shape_error'] < errors['regularised_shape_error'] < .2
    # a tenth of the regularisation does not reach the margin: the cure is no larger than it must be
    assert run('check', 'limits.regularisation={relative: %g}' % (errors['regularisation'] / 10))[1]['matrix_errors']['margin'] < .05
    diverged = 0
    for seed in range(4):
        wrong = ['simulate.seed=%d' % seed, 'simulate.plant={scatter: %g}' % (.7 * errors['margin_wanted'])]
        code, done, _ = run('simulate', *wrong)
        phase = done['phases'][-1]
        assert phase['controller']['steady'] > .3 + 2 * phase['optimum'], (seed, phase['controller']['steady'], phase['optimum'])
        assert (code == 1) == ('diverged' in [w['rule'] for w in done['warnings']]), (code, seed)
        diverged += code == 1
        code, done, _ = run('simulate', cure, *wrong)
        phase = done['phases'][-1]
        assert code == 0 and phase['controller']['steady'] < .05 + 2 * phase['optimum'], (seed, phase['controller']['steady'])
    assert diverged > 1
    # a measurement that is known to be better is not refused
    assert run('check', 'influence.scatter=%g' % (errors['margin'] / 2))[0] == 0
    print('ok 1 - margin against errors of the matrix: as numpy; %.3g %% without, %.3g %% with {relative: %g}'
          % (100 * errors['margin'], 100 * errors['regularised_margin'], errors['regularisation']))


main()
