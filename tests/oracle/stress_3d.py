# SPDX-License-Identifier: BSD-2-Clause
"""Stresses through the thickness by three-dimensional elasticity, at three heights of each ply; and
the deflection of the same cylinders by the first-order theory of shells."""

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


def plate(side_to_h, name):
    """Amplitudes [plies][3][6] of a simply supported square plate (Pagano 1970).

    Unit side, load sin(pi x) sin(pi y) along e3 on the upper face.  Order 11, 22, 12, 13, 23, 33;
    with sx, cx of pi x and sy, cy of pi y the stresses vary as sx sy, sx sy, cx cy, cx sy, sx cy,
    sx sy.  State (U, V, W, s13, s23, s33)' = A state, with u1 = U cx sy, u2 = V sx cy.
    """
    p, plies, unit = np.pi, stiffnesses(name), np.eye(6)
    half = 1 / side_to_h / len(plies) / 2
    through, states = np.eye(6), []
    for c in plies:
        e11, e22 = -p * unit[0], -p * unit[1]
        e33 = (unit[5] - c[0, 2] * e11 - c[1, 2] * e22) / c[2, 2]
        s11 = c[0, 0] * e11 + c[0, 1] * e22 + c[0, 2] * e33
        s22 = c[0, 1] * e11 + c[1, 1] * e22 + c[1, 2] * e33
        s12 = c[5, 5] * p * (unit[0] + unit[1])
        a = np.array([unit[3] / c[4, 4] - p * unit[2], unit[4] / c[3, 3] - p * unit[2], e33,
                      p * (s12 - s11), p * (s12 - s22), p * (unit[3] + unit[4])])
        step = expm(a * half)
        states.append((s11, s22, s12, [through, step @ through, step @ step @ through]))
        through = step @ step @ through
    bottom = np.append(np.linalg.solve(through[3:, :3], [0, 0, 1]), [0, 0, 0])
    return np.array([[[s11 @ t @ bottom, s22 @ t @ bottom, s12 @ t @ bottom, *(t @ bottom)[3:]]
                      for t in heights] for s11, s22, s12, heights in states])


def cylinder(radius_to_h, name, waves=4, length=4.0):
    """Stresses and deflection of a simply supported cylinder (Varadan and Bhaskar 1991).

    Returns the amplitudes [plies][3][6] of the stresses, and that of the displacement along the
    normal at the middle of the thickness.

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
    out, deflection = np.zeros((len(plies), 3, 6)), 0.0
    for number, place, r, c, t in kept:
        y = t @ bottom
        sxx, stt, sxt = stresses(r, c)
        out[number, place] = [sxx @ y, stt @ y, sxt @ y, y[4], y[5], y[3]]
        if abs(r - 1) < dr / 4:
            deflection = y[2]
    return out, deflection


def shear_stiffness(plies, z, weight, number, equilibrium):
    """Stiffness of the transverse shears 13 and 23 of a symmetric laminate, at heights z.

    Uniform: integral of the shear moduli, with the lengths at each height over those in the middle.
    Equilibrium: shear force squared over the work of the shear stresses that balance the gradient of
    a moment along its own direction.
    """
    c = [plies[i] for i in number]
    if not equilibrium:
        return [sum(w * m[4, 4] * (1 + x) for w, m, x in zip(weight, c, z)),
                sum(w * m[3, 3] / (1 + x) for w, m, x in zip(weight, c, z))]
    modulus = np.array([[m[a, a] - m[a, 2]**2 / m[2, 2] for a in (0, 1)] for m in c])
    cross = np.array([m[0, 1] - m[0, 2] * m[1, 2] / m[2, 2] for m in c])
    bending = np.array([[weight @ (modulus[:, 0] * z**2), weight @ (cross * z**2)],
                        [weight @ (cross * z**2), weight @ (modulus[:, 1] * z**2)]])
    curvature = np.linalg.inv(bending)
    out = []
    for a in (0, 1):
        stress = z * (modulus[:, a] * curvature[a, a] + cross * curvature[1 - a, a])
        shear = np.cumsum(weight * stress) - weight * stress / 2
        out.append(1 / (weight @ (shear**2 / [m[4 - a, 4 - a] for m in c])))
    return out


def first_order(radius_to_h, name, equilibrium, waves=4, length=4.0):
    """Deflection of the same cylinder by the first-order theory: the exact solution of this theory.

    Displacements u1 = a + b z, u2 = c + d z, u3 = e + f z; transverse shear strains that are the
    mean of both faces; every ply thickens freely under one normal stress 33.  Symmetric laminates.
    """
    p, n, h, points = np.pi / length, waves, 1 / radius_to_h, 4000
    plies = stiffnesses(name)
    count = points * len(plies)
    z, weight = h * ((np.arange(count) + 0.5) / count - 0.5), np.full(count, h / count)
    number = np.arange(count) // points
    matrix = np.zeros((6, 6))
    narrowing, compliance = np.array([0, 0, 0, 0, 0, h]), 0.0
    for x, w, i in zip(z, weight, number):
        s, c = 1 + x, plies[i]
        e = np.array([[-p, -p * x, 0, 0, 0, 0], [0, 0, n / s, n * x / s, 1 / s, x / s],
                      [-n / s, -n * x / s, p, p * x, 0, 0]])
        rows, through = [0, 1, 5], c[[0, 1, 5], 2] / c[2, 2]
        plane = c[np.ix_(rows, rows)] - c[2, 2] * np.outer(through, through)
        matrix += w * s * e.T @ plane @ e
        narrowing = narrowing + w * s * through @ e
        compliance += w * s / c[2, 2]
    matrix += np.outer(narrowing, narrowing) / compliance
    shears = shear_stiffness(plies, z, weight, number, equilibrium)
    for stiffness, row in zip(shears, np.array([[0, 1, 0, 0, p, 0], [0, 0, -1, 1, -n, 0]])):
        matrix += stiffness * np.outer(row, row)
    return np.linalg.solve(matrix, (1 - h / 2) * np.array([0, 0, 0, 0, 1, -h / 2]))[4]
