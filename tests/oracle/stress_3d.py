# SPDX-License-Identifier: BSD-2-Clause
"""Stresses through the thickness by three-dimensional elasticity, at three heights of each ply."""

import numpy as np
from scipy.linalg import expm

from cases import GRAPHITE
from shellref import isotropic, ply_stiffness, ply_turn

MATERIALS = dict(isotropic=(isotropic(1.0, 0.3)["constants"], [0, 0]),
                 cross=(GRAPHITE["constants"], [0, 90, 0]),
                 around=(GRAPHITE["constants"], [90, 0, 90]))


def stiffnesses(name):
    """Stiffness [6][6] of each ply in the axes of the shell (11 22 33 23 13 12), from below."""
    constants, angles = MATERIALS[name]
    return [ply_turn(a).T @ ply_stiffness(constants) @ ply_turn(a) for a in angles]


def strip(side_to_h, name):
    """Amplitudes [plies][3][4] of s11, s22, s13, s33 of a simply supported strip (Pagano 1969).

    Unit span, plane strain across, load sin(pi x) along e3 on the upper face.  s11, s22 and s33 vary
    as sin(pi x), s13 as cos(pi x).  State (U, W, s13, s33)' = A state, with u1 = U cos(pi x).
    """
    p, plies = np.pi, stiffnesses(name)
    half = 1 / side_to_h / len(plies) / 2
    through, states = np.eye(4), []
    for c in plies:
        e33 = np.array([c[0, 2] * p, 0, 0, 1]) / c[2, 2]
        a = np.array([[0, -p, 1 / c[4, 4], 0],
                      e33,
                      p * (c[0, 0] * np.array([p, 0, 0, 0])) - p * c[0, 2] * e33,
                      [0, 0, p, 0]])
        step = expm(a * half)
        states.append((c, e33, [through, step @ through, step @ step @ through]))
        through = step @ step @ through
    bottom = np.append(np.linalg.solve(through[2:, :2], [0, 1]), [0, 0])
    out = []
    for c, e33, heights in states:
        rows = []
        for t in heights:
            y = t @ bottom
            rows.append([-c[0, 0] * p * y[0] + c[0, 2] * e33 @ y,
                         -c[0, 1] * p * y[0] + c[1, 2] * e33 @ y, y[2], y[3]])
        out.append(rows)
    return np.array(out)


def cylinder(radius_to_h, name, waves=4, length=4.0):
    """Amplitudes [plies][3][6] of a simply supported cylinder (Varadan and Bhaskar 1991).

    R = 1, axis along 1, pressure sin(pi x/L) cos(waves t) on the true inner face.  Order 11, 22, 12,
    13, 23, 33; with sx, cx of pi x/L and st, ct of waves t the stresses vary as sx ct, sx ct, cx st,
    cx ct, sx st, sx ct.  Plies from the inside; the radius is stepped by the fourth-order Magnus
    formula.
    """
    p, n, steps, plies = np.pi / length, waves, 40, stiffnesses(name)

    def strains(r, c):
        exx, ett = np.array([-p, 0, 0, 0, 0, 0]), np.array([0, n / r, 1 / r, 0, 0, 0])
        return exx, ett, (np.eye(6)[3] - c[0, 2] * exx - c[1, 2] * ett) / c[2, 2]

    def stresses(r, c):
        exx, ett, err = strains(r, c)
        return (c[0, 0] * exx + c[0, 1] * ett + c[0, 2] * err,
                c[0, 1] * exx + c[1, 1] * ett + c[1, 2] * err,
                c[5, 5] * np.array([-n / r, p, 0, 0, 0, 0]))

    def system(r, c):
        sxx, stt, sxt = stresses(r, c)
        return np.array([
            [0, 0, -p, 0, 1 / c[4, 4], 0],
            [0, 1 / r, n / r, 0, 0, 1 / c[3, 3]],
            strains(r, c)[2],
            stt / r + np.array([0, 0, 0, -1 / r, p, -n / r]),
            -p * sxx - n / r * sxt + np.array([0, 0, 0, 0, -1 / r, 0]),
            p * sxt + n / r * stt + np.array([0, 0, 0, 0, 0, -2 / r])])

    h = 1 / radius_to_h
    dr, gauss = h / len(plies) / steps, np.sqrt(3) / 6
    through, kept = np.eye(6), []
    for k in range(steps * len(plies) + 1):
        r = 1 - h / 2 + k * dr
        for number, c in enumerate(plies):
            place = k - number * steps
            if place in (0, steps // 2, steps):
                kept.append((number, 2 * place // steps, r, c, through))
        if k < steps * len(plies):
            c = plies[k // steps]
            a, b = system(r + dr * (0.5 - gauss), c), system(r + dr * (0.5 + gauss), c)
            through = expm(dr / 2 * (a + b) + gauss / 2 * dr**2 * (b @ a - a @ b)) @ through
    bottom = np.append(np.linalg.solve(through[3:, :3], through[3:, 3]), [-1, 0, 0])
    out = np.zeros((len(plies), 3, 6))
    for number, place, r, c, t in kept:
        y = t @ bottom
        sxx, stt, sxt = stresses(r, c)
        out[number, place] = [sxx @ y, stt @ y, sxt @ y, y[4], y[5], y[3]]
    return out
