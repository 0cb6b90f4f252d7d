# SPDX-License-Identifier: BSD-2-Clause
"""Anchors of the nonlinear oracle: tables of another program and laws.  Prints TAP.

    python3 check_nonlinear.py       exit status 1 when a check fails
"""

import os
import sys

import numpy as np

import nonlinear_cases as nc
import textdata
import write_nonlinear
from check_oracle import error_ratio, main, relative
from contact import contact_newton
from follower import Pressure
from model import Model
from newton import Shell, newton
from shellref import IMPROVED, PUBLISHED, Section, rigid_motion, torus
from write_data import DATA, rotation

CHECKS = []


def check(function):
    """Collect a check: it returns the triples (what, error, bound)."""
    CHECKS.append(function)
    return function


def rows(name, case, wanted, systems, digits=None, **options):
    """A case against printed outputs (half a unit of the last digit) and the number of systems (None: any)."""
    if case.contact is None:
        result = newton(case.shell, case.dead, case.followers, **{"mixed": 1000, **options})
    else:
        result = contact_newton(case.shell, case.contact, case.dead, case.followers, **options)
    got = case.read(result.u)
    for k, (value, want) in enumerate(zip(got, wanted)):
        digits_here = len(str(want).partition(".")[2]) if digits is None else digits
        yield f"{name} output {k}", abs(value - want), 0.51 * 10.0**-digits_here
    if systems is not None:
        yield f"{name} systems", abs(result.systems - systems), 0.5


# ---------------------------------------------------------------- tables

def improved_rows(name, make, mesh, improved, published, systems):
    """Output A of the improved element over that of the published one, errors known in percent.

    make(preset) -> case; the errors refer to one reference, which the ratio does not need.
    """
    value = []
    for preset in (IMPROVED, PUBLISHED):
        case = make(preset)
        result = newton(case.shell, case.dead, case.followers, mixed=1000)
        value.append(case.read(result.u)[0])
        if preset is IMPROVED and systems is not None:
            yield f"{name} {mesh} systems", abs(result.systems - systems), 0.5
    known, bound = error_ratio(improved, published)
    yield f"{name} {mesh}", abs(value[0] / value[1] - known), bound


@check
def hemisphere_with_a_hole():
    for n, wanted in {4: (7.0460, 3.2609), 8: (8.0992, 3.9505), 16: (8.1326, 4.0511)}.items():
        yield from rows(f"{n}x{n}", nc.hemisphere(n, PUBLISHED), wanted, 8)
    for n, improved, published in ((4, "10", "-13.6"), (8, "2.6", "-.5"), (16, ".7", "-.2")):
        yield from improved_rows("improved", lambda preset: nc.hemisphere(n, preset), n, improved,
                                 published, 8)


@check
def slit_annular_plate():
    for mesh, (a, b, systems) in {
            (2, 4): (12.7389, 16.0252, 7), (4, 8): (12.5740, 16.0916, 9),
            (16, 32): (13.6697, 17.3024, 11), (10, 80): (13.7603, 17.3975, 12)}.items():
        yield from rows(f"{mesh}", nc.annular(*mesh, PUBLISHED), (a, b), systems, 4)
    for mesh, improved, published in (((2, 4), "-13.2", "-8.1"), ((4, 8), "-7.5", "-9.3"),
                                      ((10, 40), "-.8", "-1.2"), ((16, 32), "-.8", "-1.4")):
        yield from improved_rows("improved", lambda preset: nc.annular(*mesh, preset), mesh,
                                 improved, published, None)
    case = nc.annular(4, 8, PUBLISHED)
    yield "4x8 is a saddle", abs(newton(case.shell, case.dead).negative - 1), 0.5


@check
def hyperboloids():
    for n, wanted in ((8, (2.6651, -3.3148)), (16, (2.7598, -3.4755)), (28, (2.7815, -3.5175))):
        yield from rows(f"[0/90/0] {n}", nc.free_hyperboloid(n, (0, 90, 0), PUBLISHED), wanted, 8)
    for n, steps, systems, wanted in ((8, 2, 15, (3.3942, -4.7741)), (16, 2, 21, (3.7629, -5.6421)),
                                      (28, 3, 42, (3.8313, -6.0676))):
        yield from rows(f"[90/0/90] {n}", nc.free_hyperboloid(n, (90, 0, 90), PUBLISHED), wanted, systems, 3, steps=steps)


@check
def ring_under_pressure():
    for kind, tangent, wanted, counts in (
            ("dead", None, (0.3554, 0.8217), (7, 23, 40)), ("unit", "exact", (0.3660, 0.8391), (7, 23, 40)),
            ("unit", "symmetrised", (0.3660, 0.8391), (8, 26, 52)), ("unit", None, (0.3660, 0.8391), (12, 36, 69)),
            ("true", "symmetrised", (0.3659, 0.8393), (8, 26, 52))):
        for steps, systems in zip((1, 5, 10), counts):
            case = nc.pressed_ring(18, PUBLISHED, kind, tangent=tangent)
            yield from rows(f"{kind} {tangent} {steps}", case, wanted, systems, 4, eps=1e-6, steps=steps)
    yield from rows("72", nc.pressed_ring(72, PUBLISHED), (0.3675, 0.8471), None, 4)


@check
def strip_rolled_up():
    yield from rows("circle", nc.roll_up(40, PUBLISHED), (-9.9847, 0.0001), 11, eps=1e-6)
    for n in (10, 20, 40):
        yield from rows(f"half a circle, {n}", nc.roll_up(n, PUBLISHED, 0.5), (), 8, eps=1e-6)


@check
def ring_on_a_body():
    for n, base, plane_strain, wanted, systems in (
            (30, 1000.0, False, (88.949, 198.021), 20), (60, 1000.0, False, (88.614, 198.823), 27),
            (30, 100.0, False, (88.977, 209.032), None), (60, 100.0, False, (88.621, 209.773), None),
            (30, None, True, (88.8661, 170.12), None), (60, None, True, (88.5928, 170.86), None),
            (30, 1000.0, True, (88.8743, 173.28), None), (60, 1000.0, True, (88.5946, 174.18), None),
            (30, 100.0, True, (88.9545, 193.08), None), (60, 100.0, True, (88.6148, 193.76), None)):
        case = nc.ring_on_body(n, PUBLISHED, base, plane_strain)
        yield from rows(f"{n} {base} {plane_strain}", case, wanted, systems)
    yield from rows("improved carries its load", nc.ring_on_body(30, IMPROVED), (88.5,), None, 6)


@check
def cylinder_on_a_cylinder():
    yield from rows("10x30", nc.cylinder_on_cylinder(10, 30, PUBLISHED), (87.907, 195.591, 194.816), 28)


@check
def torus_inflated():
    for kind, table in (("dead", (1.1474, 1.1261, 1.1204, 1.1189)), ("unit", (1.2961, 1.2844, 1.2814, 1.2805)),
                        ("true", (1.2238, 1.2138, 1.2111, 1.2103))):
        for n, wanted in zip((24, 48, 96, 192), table):
            yield from rows(f"{kind} {n}", nc.torus_inflation(n, PUBLISHED, kind, "exact"), (wanted,), 5, 4)
    for ends, wanted in (("not-a-knot", 1.28137), ("given", 1.28188), ("natural", 1.30992)):
        yield from rows(ends, nc.spline_torus(48, 25, ends, PUBLISHED), (wanted,), None, eps=1e-8)


@check
def torus_on_a_body():
    for kind, tangent, plane, force, systems in (
            ("dead", None, False, 3724.009, 7), ("unit", "exact", False, 4388.304, 6), ("unit", "symmetrised", True, 4671.947, 7)):
        case = nc.torus_contact(24, 18, PUBLISHED, kind, tangent, plane)
        yield from rows(f"{kind} {tangent} {plane}", case, (force,), systems, 2)


# ---------------------------------------------------------------- laws

def patch(preset):
    """A few torus elements and their corner parameters."""
    section = Section(nc.TORUS_PLIES)
    m = Model(torus(200.0, 50.0), np.radians([10, 25, 45]), np.radians([5, 20, 30]), section, preset)
    return m, section, [(a, b) for a in m.t1 for b in m.t2]


@check
def follower_turns_with_the_mesh():
    """Force of a rotated mesh = rotated force, Cartesian forms, any uneven pressure."""
    m, section, points = patch(IMPROVED)
    shell = Shell(m)
    turn = rotation(np.array([0.7, -1.1, 0.4]))
    u = rigid_motion(m.surface, points, section, turn, np.array([3.0, 1.0, 2.0]))
    triads = np.array([m.surface.at(*p)[1] for p in points])
    for form in ("consistent", "lumped"):
        for kind in ("unit", "true"):
            load = Pressure(m, lambda a, b: 1 + a + b * b, 0, kind, form)
            rest, turned = [np.einsum("nij,nj->ni", triads, load.evaluate(shell, v, 1)[0].reshape(-1, 7)[:, :3])
                            for v in (0 * u, u)]
            yield f"{form} {kind}", relative(turned, rest @ turn.T), 1e-13


@check
def load_stiffness_is_the_derivative():
    rng = np.random.default_rng(3)
    for preset in (PUBLISHED, IMPROVED):
        m, _, points = patch(preset)
        shell = Shell(m)
        u, v = 2.0 * rng.standard_normal(m.size), rng.standard_normal(m.size)
        u[3::7] /= 20
        for kind in ("unit", "true"):
            load = Pressure(m, lambda a, b: 1 + a + b * b, 0, kind, tangent="exact")
            slope = load.evaluate(shell, u, 1)[1] @ v
            step = 1e-5
            difference = (load.evaluate(shell, u + step * v, 1)[0] - load.evaluate(shell, u - step * v, 1)[0]) / (2 * step)
            yield f"{kind}", relative(slope, difference), 1e-8


@check
def lumped_pressure_at_rest_is_pressure_times_area():
    """A uniformly pressed ring: radial force p R angle at a node, and hoop force p R, exactly, for any angle."""
    for n in (3, 6, 12):
        m = Model(nc.Ring(100.0), np.radians(np.linspace(0, 90, n + 1)), [0, 1.0],
                  Section([(1.0, 0, nc.isotropic(2.1e7, 0.3))]), IMPROVED)
        force = Pressure(m, lambda a, b: 1.0, 0).evaluate(Shell(m), np.zeros(m.size), 1)[0]
        got = force[7 * m.node(1, 0) + 2]
        yield f"{n}", relative(got, 100 * np.pi / 2 / n / 2), 1e-14


@check
def pressure_on_an_arc_is_that_on_its_chord():
    """Resultant 2 p R sin(phi/2) and moment p R^2 (1 - cos phi) about an end, however the arc is cut."""
    for cuts in ([0, 2.0], [0, 0.3, 1.1, 2.0], np.linspace(0, 2, 9)):
        m = Model(nc.Ring(100.0), np.array(cuts), [0, 1.0], Section([(10.0, 0, nc.isotropic(2.1e7, 0.3))]), IMPROVED)
        force = Pressure(m, lambda a, b: 1.0, 0).evaluate(Shell(m), np.zeros(m.size), 1)[0].reshape(-1, 7)
        total, moment = np.zeros(3), np.zeros(3)
        start = m.surface.at(0, 0)[0]
        for i, angle in enumerate(cuts):
            x, triad = m.surface.at(angle, 0)[:2]
            push, couple = (triad @ force[2 * i:2 * i + 2, k:k + 3].sum(axis=0) for k in (0, 3))
            total += push
            moment += np.cross(x - start, push) + np.cross(triad[:, 2], couple)
        yield f"{len(cuts)} resultant", relative(np.linalg.norm(total), 200 * np.sin(1)), 1e-13
        yield f"{len(cuts)} moment", relative(np.linalg.norm(moment[2]), 1e4 * (1 - np.cos(2))), 1e-13


@check
def data_file_is_what_this_code_writes():
    stored = textdata.read(os.path.join(DATA, "nonlinear.txt"))
    made = write_nonlinear.blocks(quiet=True)
    yield "names", float([b[:2] for b in stored] != [(n, {k: str(v) for k, v in w.items()}) for n, w, _ in made]), 0.5
    for (name, _, old), (_, _, new) in zip(stored, made):
        yield f"{name} u", relative(new["u"], old["u"]), 1e-8
        yield f"{name} systems", relative(new["systems"], old["systems"]), 0
        yield f"{name} good", float(new["good"][0][0]), 1e-9


if __name__ == "__main__":
    sys.exit(main(CHECKS))
