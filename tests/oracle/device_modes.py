#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compare the modes that test_modes wrote with the eigenvalues of dense matrices in scipy.

    test_modes FILE; device_modes.py FILE

Each structure is doubles: machine epsilon of the device, tolerance, shift, nodes, elements, stiffness types, mass types, dof of a node, free
dof, modes; then the nodes of each element, the stiffness and the mass type of each element, the free dof of each node (-1: constrained), the
packed element matrices of stiffness and mass, the squared angular frequencies of the device and its mode shapes.

Here the matrices are assembled densely and the pencil (M, K + shift M) is solved, with the diagonal of K scaled to 1. Its eigenvalues
1 / (w^2 + shift) have an error of machine epsilon times the condition number of the scaled stiffness.
"""
import sys

import numpy as np
from scipy.linalg import eigh

from dumped_numbers import Numbers


def structures(path):
    numbers = Numbers(path)
    take = numbers.take
    while numbers.is_left():
        epsilon, tolerance, shift = take(3)
        nodes, elements, types, masses, per_node, dof, modes = (int(x) for x in take(7))
        packed = 2 * per_node * (4 * per_node + 1)
        yield dict(epsilon=epsilon, tolerance=tolerance, shift=shift, dof=dof, elements=elements, element=take(elements, 4).astype(int),
                   kind=take(elements).astype(int), mass=take(elements).astype(int), free=take(nodes, per_node).astype(int),
                   stiffness=take(types, packed), inertia=take(masses, packed), square=take(modes), shape=take(modes, dof))


def assemble(structure, kind, packed):
    """The dense matrix of packed element matrices."""
    rows = 4 * structure['free'].shape[1]
    lower = np.tril_indices(rows)
    matrix = np.zeros((structure['dof'], structure['dof']))
    for nodes, k in zip(structure['element'], kind):
        full = np.zeros((rows, rows))
        full[lower] = packed[k]
        full = full + np.tril(full, -1).T
        dof = structure['free'][nodes].ravel()
        kept = np.flatnonzero(dof >= 0)
        matrix[np.ix_(dof[kept], dof[kept])] += full[np.ix_(kept, kept)]
    return matrix


def check(structure):
    """The largest error of a squared frequency and what is allowed, and faults as text."""
    k, m = assemble(structure, structure['kind'], structure['stiffness']), assemble(structure, structure['mass'], structure['inertia'])
    shift, square, dof = structure['shift'], structure['square'], structure['dof']
    k += shift * m
    scale = 1 / np.sqrt(np.diag(k))
    k, m = scale[:, None] * k * scale, scale[:, None] * m * scale
    value, vector = eigh(m, k)
    value, vector = value[::-1], vector[:, ::-1]
    exact = 1 / value[:len(square)]
    oracle = 4 * np.finfo(float).eps * np.linalg.cond(k)
    device = 4 * structure['epsilon'] * np.sqrt(88 * structure['elements']) + structure['tolerance'] ** 2
    error = np.abs(square + shift - exact) / exact
    faults = [f'squared frequency {i}: {square[i]:.9g}, not {exact[i] - shift:.9g}' for i in np.flatnonzero(error > oracle + device)]
    shape = structure['shape'] / scale
    part = shape @ m @ vector / np.sqrt(value)
    for i, row in enumerate(part):
        near = np.abs(value / value[i] - 1) < 0.1
        beside = 1 - np.sum(row[near] ** 2)
        if abs(beside) > 100 * structure['tolerance'] ** 2 + 64 * structure['epsilon'] * np.sqrt(dof) + 4 * oracle:
            faults.append(f'mode shape {i}: {beside:.2g} of it belongs to other frequencies')
    return error.max(), (oracle + device), faults


def main():
    count = worst = share = 0
    for structure in structures(sys.argv[1]):
        error, allowed, faults = check(structure)
        count, worst, share = count + 1, max(worst, error), max(share, error / allowed)
        for fault in faults:
            print(fault)
        if faults:
            return 1
    print(f'{count} structures, squared frequencies to {worst:.1e}, {share:.2f} of what is allowed')
    return count == 0


if __name__ == '__main__':
    sys.exit(main())
