#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Laws of the arrays that pzs writes for other programs.

  arrays_check.py FILE.npz FOLDER        each CSV file of the folder is the array of the same name; shapes are the
                                         influence times the voltages, misfits the shapes less the target, without piston
  arrays_check.py FILE.npz FILE.json outputs   output_k of solve is the k-th output of --json
  arrays_check.py FILE.npz FILE.csv ticks   time, error and voltages of simulate are the columns of --csv
"""
import json
import os
import sys
import numpy as np


def without_piston(x):
    return x - x.mean(axis=-1, keepdims=True)


def check_shapes(arrays, folder):
    names = [name for name in arrays.files if name != 'units']
    assert sorted(os.listdir(folder)) == sorted(name + '.csv' for name in names)
    for name in names:
        table = np.loadtxt(os.path.join(folder, name + '.csv'), delimiter=',', skiprows=1, ndmin=2)
        assert np.array_equal(table, arrays[name].reshape(table.shape)), name
    shape, target = arrays['shape'], arrays['target']
    rounding = 64 * np.finfo(float).eps * abs(shape).max()
    expected = arrays['voltage'] @ arrays['influence'].T
    assert abs(without_piston(shape - expected)).max() <= rounding
    assert abs(without_piston(shape - target - arrays['misfit'])).max() <= rounding
    # Each row of voltages lies within the limits of its row: one row has none, the others +-60 V or +-30 V.
    free, lower, upper = np.isinf(arrays['upper'][:, 0]), arrays['lower'], arrays['upper']
    assert (lower <= arrays['voltage']).all() and (arrays['voltage'] <= upper).all()
    assert free.sum() == 1 and set(upper[~free, 0]) == {30.0, 60.0} and np.array_equal(lower, -upper), upper
    units = dict(text.decode().split(': ') for text in arrays['units'])
    assert units['influence'] == 'mm/V' and units['voltage'] == 'V', units


def check_ticks(arrays, path):
    with open(path, encoding='utf-8') as file:
        head = file.readline().strip().split(',')
    table = np.loadtxt(path, delimiter=',', skiprows=1)
    amplifiers = arrays['voltage'].shape[1]
    assert np.allclose(table[:, head.index('time')], arrays['time'], rtol=1e-8)
    assert np.array_equal(table[:, head.index('error')], arrays['error'])
    assert np.array_equal(table[:, -amplifiers:], arrays['voltage'])


def check_outputs(arrays, path):
    with open(path, encoding='utf-8') as file:
        outputs = json.load(file)['outputs']
    units = dict(text.decode().split(': ') for text in arrays['units'])
    assert outputs
    for k, (name, value) in enumerate(outputs.items()):
        values = np.atleast_1d(np.array(value, dtype=float))
        assert np.array_equal(values, arrays[f'output_{k + 1}']), name
    return [units[f'output_{k + 1}'] for k in range(len(outputs))]


def main():
    arrays = np.load(sys.argv[1])
    what = sys.argv[3] if len(sys.argv) > 3 else ''
    if what == 'outputs':
        print(*check_outputs(arrays, sys.argv[2]))
    else:
        (check_ticks if what else check_shapes)(arrays, sys.argv[2])


main()
