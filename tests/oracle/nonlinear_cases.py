# SPDX-License-Identifier: BSD-2-Clause
"""Nonlinear cases: each function returns a shell ready for `newton`, its loads and what is watched."""

import numpy as np
from scipy.interpolate import CubicSpline

from cases import ring, uniform
from model import Model
from contact import Contact, PlaneBody, RoundBody
from follower import FacetPressure, Pressure
from newton import Shell
from shellref import Plate, Revolution, Ring, Section, cylinder, hyperboloid, isotropic, ply, polar, sphere, torus


class Case:
    """A shell, its dead load [size], follower loads, and named outputs of u."""

    def __init__(self, shell, dead=None, followers=(), outputs=None, contact=None):
        self.shell, self.followers, self.outputs, self.contact = shell, list(followers), outputs or {}, contact
        self.dead = np.zeros(shell.model.size) if dead is None else dead

    def read(self, u):
        """Values of the outputs."""
        return np.array([f(u) for f in self.outputs.values()])


def middle(m, node, sign=1):
    """Function u -> sign u3M of a node."""
    return lambda u: sign * m.middle(u, node)


def hemisphere(n, preset, unknowns=7):
    """Hemisphere with an 18 degree hole, quarter, n x n; outputs -u3M(A), u3M(B).

    R = 10, h = .04, E = 6.825e7, nu = .3; theta1 polar angle 18 to 90, theta2 azimuth 0 to 90 degrees.
    theta2 edges symmetric, theta1 edges free, axial motion held by u1- at (18, 45 degrees).
    Force 200 inwards at (90, 0), outwards at (90, 90).
    """
    m = Model(sphere(10.0), np.radians(np.linspace(18, 90, n + 1)), np.radians(np.linspace(0, 90, n + 1)),
              Section([(0.04, 0, isotropic(6.825e7, 0.3))]), preset, unknowns, ring)
    m.symmetric("theta2-")
    m.symmetric("theta2+")
    m.fix([m.node(0, n // 2)], [0])
    a, b = m.node(-1, 0), m.node(-1, -1)
    return Case(Shell(m), m.point(a, 2, -200) + m.point(b, 2, 200), outputs=dict(A=middle(m, a, -1), B=middle(m, b)))


def annular(n1, n2, preset, unknowns=7):
    """Slit annular plate, n1 radial x n2 around; outputs u3M at the inner and outer corner.

    r 6 to 10, h = .03, E = 21e6, nu = 0; theta1 radius, theta2 0 to 360 degrees; theta2- clamped, line load
    .8 along e3 on theta2+.
    """
    m = Model(polar(), np.linspace(6, 10, n1 + 1), np.linspace(0, 2 * np.pi, n2 + 1),
              Section([(0.03, 0, isotropic(21e6, 0.0))]), preset, unknowns, ring)
    m.clamped("theta2-")
    dead = np.zeros(m.size)
    for i in range(n1 + 1):
        dead += m.point(m.node(i, -1), 2, 0.8 * 4 / n1 * (0.5 if i in (0, n1) else 1))
    a, b = m.node(0, -1), m.node(-1, -1)
    return Case(Shell(m), dead, outputs=dict(A=middle(m, a), B=middle(m, b)))


def free_hyperboloid(n, plies, preset, unknowns=7):
    """Hyperboloid under two pairs of waist forces, eighth, n x n; outputs u3M out and in.

    r = 7.5 sqrt(1 + 3 z^2/400), theta1 = -z from the waist 0 to 20, theta2 0 to 90 degrees; h = .04 in three plies,
    E_L 4e7, E_T 1e6, G 6e5, nu .25, listed inside first, 0 = around.  theta1-, theta2-, theta2+ symmetric,
    theta1+ free; force 100 outwards at (0, 0), inwards at (0, 90).
    """
    material = ply([4e7, 1e6, 1e6, 6e5, 6e5, 6e5, 0.25, 0.25, 0.25])
    m = Model(hyperboloid(7.5, 3 / 400), np.linspace(0, 20, n + 1), np.radians(np.linspace(0, 90, n + 1)),
              Section([(0.04 / 3, 90 - a, material) for a in plies]), preset, unknowns, ring)
    for edge in ("theta1-", "theta2-", "theta2+"):
        m.symmetric(edge)
    a, b = m.node(0, 0), m.node(0, -1)
    return Case(Shell(m), m.point(a, 2, 100) + m.point(b, 2, -100), outputs=dict(out=middle(m, a), into=middle(m, b)))


def roll_up(n, preset, turn=1.0, nu=0.0, h=0.1, length=10.0, unknowns=7):
    """Cantilever n x 1 bent by a free curvature to `turn` full turns; outputs tip motion along x and z.

    theta1 = x 0 to 10, theta2 = y 0 to 1, E = 1e6; clamped at x = 0 with all unknowns when nu = 0, else u1, u3 and
    their differences and one u2.  Given resultants -D e0, e0 = free strain -z kappa along and across.
    """
    m = Model(Plate(), np.linspace(0, length, n + 1), [0, 1.0], Section([(h, 0, isotropic(1e6, nu))]),
              preset, unknowns, uniform)
    m.clamped("theta1-")
    free = np.zeros(10)
    free[1] = -h * 2 * np.pi * turn / length
    given = np.array([given_of(el, free) for el in m.elements])
    tip = m.node(-1, 0)
    return Case(Shell(m, given), outputs=dict(x=lambda u: u[m.unknowns * tip], z=middle(m, tip)))


def given_of(el, free):
    """Given resultant -D e0 [10] of a free strain, mode 00."""
    return -el.D[0] @ free


def pressed_ring(n, preset, kind="unit", form=None, tangent="symmetrised", unknowns=7):
    """Ring under follower pressure, quarter, n x 1; outputs u3M/r at 0 and -u3M/r at 90 degrees.

    r = 100, h = b = 1, E = 2.1e7, nu = .3, plane strain; theta1 0 to 90 degrees, theta2 the axis; theta1 edges symmetric;
    Pressure p0 (1 - cos 2 phi) inwards on the inner face, 12 (1 - nu^2) p0 r^3/(E h^3) = 3.  kind: unit, true or dead.
    """
    m = Model(Ring(100.0), np.radians(np.linspace(0, 90, n + 1)), [0, 1.0],
              Section([(1.0, 0, isotropic(2.1e7, 0.3))]), preset, unknowns, uniform)
    m.symmetric("theta1-")
    m.symmetric("theta1+")
    for j in (0, 1):
        m.fix([m.node(i, j) for i in range(n + 1)], [1, 4])
    p0 = 3 * 2.1e7 / (12 * (1 - 0.09) * 100**3)

    def pressure(t1, t2):
        return -p0 * (1 - np.cos(2 * t1))
    a, b = m.node(0, 0), m.node(-1, 0)
    outputs = dict(A=lambda u: m.middle(u, a) / 100, B=lambda u: -m.middle(u, b) / 100)
    if kind == "dead":
        return Case(Shell(m), m.distributed(lambda t1, t2, triad: np.array([0, 0, pressure(t1, t2)]), -0.5), outputs=outputs)
    if form == "facet":
        return Case(Shell(m), followers=[FacetPressure(m, pressure, 0, tangent)], outputs=outputs)
    return Case(Shell(m), followers=[Pressure(m, pressure, 0, kind, form, tangent)], outputs=outputs)


def ring_on_body(n, preset, base=1000.0, plane_strain=False, kappa=1.0, unknowns=7):
    """Half ring pressed on a rigid cylinder or plane; outputs Pc~ and -u3M(A); P~ = 88.5.

    R = 100, h = b = 1, E = 2.1e7, nu = .3, n x 1; theta1 0 (touching point) to 180 degrees, theta2 the axis; theta1
    edges symmetric, u2 = 0 on theta2- (plane strain: everywhere).  Half the force P/2 at theta1 = 180 degrees, inwards,
    on both of its nodes.  Base radius None: plane.
    """
    m = Model(Ring(100.0), np.radians(np.linspace(0, 180, n + 1)), [0, 1.0],
              Section([(1.0, 0, isotropic(2.1e7, 0.3))]), preset, unknowns, uniform)
    m.symmetric("theta1-")
    m.symmetric("theta1+")
    m.fix(m.edge("theta2-"), [1, 4])
    if plane_strain:
        m.fix(m.edge("theta2+"), [1, 4])
    unit = 2.1e7 / (120 * 100**2)
    dead = m.point(m.node(-1, 0), 2, -88.5 * unit / 4) + m.point(m.node(-1, 1), 2, -88.5 * unit / 4)
    shell = Shell(m)
    body = (PlaneBody([100.5, 0, 0], [-1, 0, 0]) if base is None
            else RoundBody([100.5 + base, 0, 0], base, np.array([0, 0, 1.0])))
    contact = Contact(shell, body, 1, kappa)
    outputs = dict(Pc=lambda u: -2 * contact.resultant(u, 1)[0] / unit, A=middle(m, m.node(-1, 0), -1))
    return Case(shell, dead, outputs=outputs, contact=contact)


def cylinder_on_cylinder(n1, n2, preset, load=87.5, kappa=1.0, unknowns=7):
    """Cylinder pressed on a crossed rigid cylinder, quarter, n1 x n2; outputs Pc~, -u3M(A), -u3M(B).

    R = 100, h = 1, half length 100, E = 2.1e7, nu = .3; theta1 axial 0 to 100, theta2 0 (touching) to 180
    degrees; theta1- and the theta2 edges symmetric, theta1+ free.  Force P/4 at A (0, 180), B (100, 180).
    """
    m = Model(cylinder(100.0), np.linspace(0, 100, n1 + 1), np.radians(np.linspace(0, 180, n2 + 1)),
              Section([(1.0, 0, isotropic(2.1e7, 0.3))]), preset, unknowns, uniform)
    for edge in ("theta1-", "theta2-", "theta2+"):
        m.symmetric(edge)
    unit = 2.1e7 * 200 / (120 * 0.91 * 100**2)
    a, b = m.node(0, -1), m.node(-1, -1)
    dead = m.point(a, 2, -load * unit / 4)
    shell = Shell(m)
    contact = Contact(shell, RoundBody([1100.5, 0, 0], 1000.0, np.array([0, 1.0, 0])), 1, kappa)
    outputs = dict(Pc=lambda u: -4 * contact.resultant(u, 1)[0] / unit, A=middle(m, a, -1), B=middle(m, b, -1))
    return Case(shell, dead, outputs=outputs, contact=contact)


TYRE = ply([500, 10, 10, 3.5, 3.5, 3.448276, 0.4, 0.4, 0.45])
TORUS_PLIES = [(1.2, a, TYRE) for a in (-45, 45, -45, 45)]


def torus_inflation(n, preset, kind="unit", tangent="symmetrised", form=None, degrees=1.0):
    """Axisymmetric sector of the cross-ply torus under .5 MPa inside; output u3M at the crown.

    Middle surface r = 200 + 50 cos a, z = -50 sin a, theta1 = a in +-120 degrees (n elements), theta2 one
    element of `degrees` whose two nodes share their unknowns; ends clamped; four plies of
    1.2 at -45 45 -45 45 from theta1, inside first.
    """
    m = Model(torus(200.0, 50.0), np.radians(np.linspace(-120, 120, n + 1)), np.radians([-degrees / 2, degrees / 2]),
              Section(TORUS_PLIES), preset, 7, ring, closed=True)
    m.clamped("theta1-")
    m.clamped("theta1+")
    out = dict(A=middle(m, m.node(n // 2, 0)))
    if kind == "dead":
        return Case(Shell(m), m.distributed(lambda t1, t2, triad: np.array([0, 0, 0.5]), -0.5), outputs=out)
    return Case(Shell(m), followers=[Pressure(m, lambda t1, t2: 0.5, 0, kind, form, tangent)], outputs=out)


def graded(n, limit, a):
    """n + 1 points limit (a s + (1 - a) s^3), s from -1 to 1."""
    s = np.linspace(-1, 1, n + 1)
    return np.radians(limit) * (a * s + (1 - a) * s**3)


def torus_contact(n1, n2, preset, kind="unit", tangent="symmetrised", plane=False, depth=17.0, kappa=100.0, unknowns=7):
    """Full inflated torus on a rigid base moved by `depth`; outputs resultant, number of contact nodes, u3M(A).

    Mesh n1 x n2, theta1 +-120 degrees graded .6, theta2 the whole circle graded .3; pressure .5 inside and the motion of the
    base ramp together.  Base: cylinder of radius 1000, axis along z, or plane, first touching at x = 252.4.
    """
    m = Model(torus(200.0, 50.0), graded(n1, 120, 0.6), graded(n2, 180, 0.3), Section(TORUS_PLIES), preset,
              unknowns, closed=True)
    m.clamped("theta1-")
    m.clamped("theta1+")
    shell = Shell(m)

    def body(factor):
        x = 252.4 - depth * factor
        if plane:
            return PlaneBody([x, 0, 0], [-1.0, 0, 0])
        return RoundBody([x + 1000, 0, 0], 1000.0, np.array([0, 0, 1.0]))
    contact = Contact(shell, body, 1, kappa)
    out = dict(R=lambda u: -contact.resultant(u, 1)[0], nodes=lambda u: contact.active.sum(),
               A=middle(m, m.node(n1 // 2, n2 // 2)))
    if kind == "dead":
        return Case(shell, m.distributed(lambda t1, t2, triad: np.array([0, 0, 0.5]), -0.5), outputs=out, contact=contact)
    return Case(shell, followers=[Pressure(m, lambda t1, t2: 0.5, 0, kind, None, tangent)], outputs=out, contact=contact)


def spline_torus(n, points, ends, preset, kind="unit", tangent="symmetrised"):
    """torus_inflation with the meridian a cubic spline through `points` of its points, chord-length parameter.

    ends: "not-a-knot", "natural" or "given" (the true end tangents); n elements, uniform in each interval.
    Output u3M at the crown.
    """
    angle = np.radians(np.linspace(-120, 120, points))
    xz = np.column_stack([200 + 50 * np.cos(angle), -50 * np.sin(angle)])
    t = np.append(0, np.cumsum(np.linalg.norm(np.diff(xz, axis=0), axis=1)))
    if ends == "given":
        slopes = [np.array([-np.sin(a), -np.cos(a)]) for a in angle[[0, -1]]]
        ends = ((1, slopes[0]), (1, slopes[1]))
    spline = CubicSpline(t, xz, bc_type=ends)

    def meridian(s):
        (r, z), (r1, z1), (r2, z2) = spline(s), spline(s, 1), spline(s, 2)
        return r, r1, r2, z, z1, z2
    lines = np.interp(np.linspace(0, points - 1, n + 1), np.arange(points), t)
    m = Model(Revolution(meridian), lines, np.radians([-0.5, 0.5]), Section(TORUS_PLIES), preset, 7, ring, closed=True)
    m.clamped("theta1-")
    m.clamped("theta1+")
    case = Case(Shell(m), followers=[Pressure(m, lambda t1, t2: 0.5, 0, kind, None, tangent)],
                outputs=dict(A=middle(m, m.node(n // 2, 0))))
    case.curvature = np.array([m.surface.at(s, 0)[3][0] for s in t])
    return case
