# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/motion.txt: motion of small nonlinear shells with mass.

    python3 write_motion.py
"""

import os

import numpy as np
from scipy.integrate import solve_ivp

import textdata
from model import Model
from newton import Shell
from shellref import IMPROVED, PUBLISHED, Plate, Ring, Section, isotropic
from write_data import DATA

HELP = """\
Motion of nonlinear shells with mass from rest in the undeformed state, under a force and voltages that are constant from
t = 0 on.  M u'' = F - f(u) is integrated by the explicit Runge-Kutta method of order 8 of Dormand and Prince; mass and
internal force f are those of the numpy elements.  No damping.

Two layers of thickness 0.15, E 1e4, nu 0.3, density 1, d31 = d32 = 1e-4; 30 V on the upper and -30 V on the lower layer;
theta1- clamped; force on theta1+ along e3, word force in all, half at each node.  Mass: 2/3 lumped, 1/3 consistent.
    word element              improved (6 unknowns a node) | published (7)
    word surface              plate: theta1 = x 0..2, theta2 = y 0..1;  ring: radius 2, theta1 the angle 0..57.29.. degrees
                              (1 radian), theta2 the axis 0..1
    array mesh 1 2            elements along theta1, theta2
    array step 1 1            time step with which the error of a method of second order is close to its leading term
    array time 1 k            the times
    array u k unknowns        displacement of all nodes at these times; node = i n2 + j, theta2 fastest; unknowns of a
                              node: mean u1 u2 u3; (u+ - u-)/h of 1 2 3; (u3M - mean u3)/h
    array energy k 2          kinetic energy; strain energy plus potential of force and voltages, zero at t = 0
"""

LUMPED = 2 / 3
THICK, DENSITY, VOLTAGE = 0.15, 1.0, 30.0
CONSISTENT = np.array([[4, 2, 1, 2], [2, 4, 2, 1], [1, 2, 4, 2], [2, 1, 2, 4]]) / 36


def kernel(k, h, unknowns):
    """Mass of a node per area [unknowns][unknowns], in its triad, by quadrature over the height."""
    out = np.zeros((unknowns, unknowns))
    for x, w in zip(*np.polynomial.legendre.leggauss(8)):
        t = x * h / 2
        move = np.zeros((3, unknowns))
        move[:, :3], move[:, 3:6] = np.eye(3), t * np.eye(3)
        if unknowns == 7:
            move[2, 6] = h * (1 - 4 * t * t / h**2)
        out += w * h / 2 * DENSITY * (1 + k[0] * t) * (1 + k[1] * t) * move.T @ move
    return out


def mass_matrix(model):
    """Mass of the whole mesh, dense; displacement vectors are interpolated, not components."""
    n = model.unknowns
    out = np.zeros((model.size, model.size))
    for el, dofs in zip(model.elements, model.dofs):
        of_node = kernel(el.centre[3], model.h, n)
        for r in range(4):
            for s in range(4):
                share = (1 - LUMPED) * CONSISTENT[r, s] + LUMPED * (0.25 if r == s else 0)
                turn = np.zeros((n, n))
                between = el.triads[r].T @ el.triads[s]
                turn[:3, :3] = turn[3:6, 3:6] = between
                turn[:3, 3:6] = turn[3:6, :3] = between
                if n == 7:
                    turn[6, :3] = turn[6, 3:6] = between[2]
                    turn[:3, 6] = turn[3:6, 6] = between[:, 2]
                    turn[6, 6] = between[2, 2]
                rows, columns = dofs[n * r:n * r + n], dofs[n * s:n * s + n]
                out[np.ix_(rows, columns)] += el.area * share * turn * expand(of_node)
    return out


def expand(of_node):
    """Moments of every pair of unknowns, whatever their directions: [n][n] without the zeros between directions."""
    n = len(of_node)
    function = np.array([0, 0, 0, 1, 1, 1, 2][:n])
    first = np.array([2, 5, 6][:3 if n == 7 else 2])
    moment = of_node[np.ix_(first, first)]
    return moment[np.ix_(function, function)]


def case(name, element, surface, mesh, force, end, step, times=4):
    """One case of the file."""
    preset, unknowns = (IMPROVED, 6) if element == "improved" else (PUBLISHED, 7)
    material = isotropic(1e4, 0.3, d=(1e-4, 1e-4, 0))
    section = Section([(THICK, 0, material), (THICK, 0, material)])
    shape, span = (Plate(), 2.0) if surface == "plate" else (Ring(2.0), 1.0)
    model = Model(shape, np.linspace(0, span, mesh[0] + 1), np.linspace(0, 1, mesh[1] + 1), section, preset, unknowns)
    model.clamped("theta1-")
    shell = Shell(model, np.array([VOLTAGE * (el.volt[1] - el.volt[0]) for el in model.elements]))
    free = shell.free
    inverse = np.linalg.inv(mass_matrix(model)[np.ix_(free, free)])
    mass = mass_matrix(model)[np.ix_(free, free)]
    load = np.zeros(model.size)
    for j in range(mesh[1] + 1):
        load += model.point(model.node(-1, j), 2, force / mesh[1] * (0.5 if j in (0, mesh[1]) else 1))

    def internal(u):
        return shell.scatter([np.einsum("ekn,ek->en", slope, e @ kind.D + given)
                              for (kind, _, dofs), given in zip(shell.groups, shell.given)
                              for e, slope in [kind.strains(u[dofs])]])

    def potential(u):
        sum_ = -load @ u
        for (kind, _, dofs), given in zip(shell.groups, shell.given):
            e, _ = kind.strains(u[dofs])
            sum_ += np.einsum("ek,kl,el->", e, kind.D, e) / 2 + (e * given).sum()
        return sum_

    def rate(_, state):
        u = np.zeros(model.size)
        u[free] = state[:len(free)]
        return np.concatenate([state[len(free):], inverse @ (load - internal(u))[free]])

    at = np.linspace(0, end, times + 1)[1:]
    found = solve_ivp(rate, (0, end), np.zeros(2 * len(free)), method="DOP853", t_eval=at, rtol=1e-11, atol=1e-13)
    shapes, energies = [], []
    for state in found.y.T:
        u = np.zeros(model.size)
        u[free] = state[:len(free)]
        shapes.append(u)
        v = state[len(free):]
        energies.append([v @ mass @ v / 2, potential(u)])
    print(name, found.nfev, "evaluations; u3 of the tip", [round(u[unknowns * model.node(-1, 0) + 2], 4) for u in shapes],
          "energy", max(abs(sum(e)) for e in energies))
    return name, dict(element=element, surface=surface, force=force), dict(mesh=[mesh], step=[[step]], time=[at], u=shapes,
                                                                            energy=energies)


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "motion.txt"), HELP, [
        case("plate", "improved", "plate", (2, 1), 5.0, 0.2, 2e-4),
        case("plate-published", "published", "plate", (2, 1), 20.0, 0.1, 4e-5),
        case("ring", "improved", "ring", (3, 1), 4.0, 0.2, 5e-5)])
