# SPDX-License-Identifier: BSD-2-Clause
"""The two cases of the comparison as plain data, for the peers' own input.

hemisphere: a quarter of a hemisphere with a hole of 18 degrees, mesh theta x phi, theta from the hole to the equator;
            a force of 200 pushes A (phi = 0) in and pulls B (phi = 90 degrees) out.
annular:    a slit annular plate, mesh phi x r; a line load of .8 lifts one lip of the slit, the other is clamped;
            A is the inner, B the outer corner of the loaded lip.
"""

from math import cos, pi, radians, sin

# Displacements at A and B that fine meshes converge to; compare.py measures errors by them.
CONVERGED = {"hemisphere": (8.147, 4.0735), "annular": (13.86, 17.49)}


class Case:
    """A shell of four-node or eight-node quadrilaterals; nodes count from 0.

    node      [(x, y, z)]
    quad      [[corner, corner, corner, corner, (middle of each side, from the first corner on)]]
    clamped   [node]
    symmetric [(node, axis of the plane's normal 0..2, tangent of the edge there)]
    held      [(node, axis)]
    force     [(node, axis, size)]
    read      ((node, axis, sign), (node, axis, sign)): displacements A and B
    """

    def __init__(self, point, n, order):
        """Nodes and elements of an n[0] x n[1] mesh of point(s, t), s and t in [0, 1]; order 1: four nodes, 2: eight."""
        self.number, self.node, self.quad = {}, [], []
        self.size = [order * k for k in n]
        for i in range(self.size[0] + 1):
            for j in range(self.size[1] + 1):
                if order == 1 or i % 2 == 0 or j % 2 == 0:
                    self.number[i, j] = len(self.node)
                    self.node.append(point(i / self.size[0], j / self.size[1]))
        ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        for i in range(0, self.size[0], order):
            for j in range(0, self.size[1], order):
                corners = ring if order == 2 else [(a // 2, b // 2) for a, b in ring[:4]]
                self.quad.append([self.number[i + a, j + b] for a, b in corners])
        self.clamped, self.symmetric, self.held, self.force = [], [], [], []


def hemisphere(n, order):
    """Quarter model; the shell is held along its axis at one node of the hole's rim."""
    radius, hole = 10.0, radians(18)

    def angles(s, t):
        return hole + s * (pi / 2 - hole), t * pi / 2

    def point(s, t):
        theta, phi = angles(s, t)
        return radius * sin(theta) * cos(phi), radius * sin(theta) * sin(phi), radius * cos(theta)

    case = Case(point, n, order)
    last = case.size
    for j, normal in ((0, 1), (last[1], 0)):
        for i in range(last[0] + 1):
            theta, phi = angles(i / last[0], j / last[1])
            tangent = cos(theta) * cos(phi), cos(theta) * sin(phi), -sin(theta)
            case.symmetric.append((case.number[i, j], normal, tangent))
    case.held = [(case.number[0, last[1] // 2], 2)]
    a, b = case.number[last[0], 0], case.number[last[0], last[1]]
    case.force = [(a, 0, -200.0), (b, 1, 200.0)]
    case.read = (a, 0, -1), (b, 1, 1)
    case.young, case.poisson, case.thickness = 6.825e7, 0.3, 0.04
    return case


def spacing(n, order, graded):
    """Positions 0..1 along phi and along r. Graded: elements along phi grow from the clamped lip on, the last one four
    times as long as the first; along r they are finer towards the free edges, s -> 1.4 s - .4 s^3 on [-1, 1]."""
    phi, r = ([k / (order * size) for k in range(order * size + 1)] for size in n)
    if graded:
        growth = 4 ** (1 / (n[0] - 1))
        phi = [(growth ** (n[0] * at) - 1) / (growth ** n[0] - 1) for at in phi]
        r = [(1 + 1.4 * s - 0.4 * s ** 3) / 2 for s in (2 * at - 1 for at in r)]
    return phi, r


def annular(n, order, graded):
    """The slit lies at phi = 0, the loaded lip at its end."""
    inner, outer, load = 6.0, 10.0, 0.8
    along_phi, along_r = spacing(n, order, graded)
    radius = [inner + at * (outer - inner) for at in along_r]

    def point(s, t):
        phi, r = 2 * pi * along_phi[round(s * order * n[0])], radius[round(t * order * n[1])]
        return r * cos(phi), r * sin(phi), 0.0

    case = Case(point, n, order)
    last = case.size
    case.clamped = [case.number[0, j] for j in range(last[1] + 1)]
    weight = [0.0] * (last[1] + 1)
    for j in range(0, last[1], order):
        for k, share in enumerate((1 / 6, 4 / 6, 1 / 6) if order == 2 else (1 / 2, 1 / 2)):
            weight[j + k] += share * load * (radius[j + order] - radius[j])
    lip = [case.number[last[0], j] for j in range(last[1] + 1)]
    case.force = [(k, 2, w) for k, w in zip(lip, weight)]
    case.read = (lip[0], 2, 1), (lip[-1], 2, 1)
    case.young, case.poisson, case.thickness = 21e6, 0.0, 0.03
    return case


def make(name, mesh, order=1):
    """The case of a name and a mesh such as "16x16" or, for four-node elements on the annular plate, "20x5-graded"."""
    counts, _, graded = mesh.partition("-")
    n = [int(k) for k in counts.split("x")]
    return annular(n, order, bool(graded)) if name == "annular" else hemisphere(n, order)
