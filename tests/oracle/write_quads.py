# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/quads.txt: the improved element on single quadrilaterals.

    python3 write_quads.py
"""

import os

import numpy as np

import textdata
from quadref import QuadElement, QuadSection, rigid
from write_data import DATA, LAYUPS, lower, rotation

HELP = """\
The improved element on single quadrilaterals, from the nodes and directors alone (quadref.py).

Format, unknowns, strains and layers as in elements.txt.
    array corners, directors, axes 4 3   positions, unit directors e3 and unit vectors e1 of the triads
    array direction 1 3                  projected on the element: axis 1 of the layers; 0: its own
    array area 1 1, skew 1 3 (alpha1 alpha2 L2/L1), warp 1 9, share 1 1 (part of rho that is used)
    array D00 D01 D10 D11, volt n L, kelvin n 1, K, U n 1, energy 1 1, force n 1, tangent
    array weights 4 4                    integral of N_r N_s over the element, divided by its area
"""


def unit(vectors):
    """Vectors along the last axis, divided by their lengths."""
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def axes_of(directors):
    """Unit vectors e1: an arbitrary but fixed direction, projected."""
    toward = np.array([0.8, 0.3, -0.5])
    return unit([toward - (toward @ d) * d for d in directors])


def flat(points):
    """Corners in the plane z = 0 and their directors."""
    return np.column_stack([points, np.zeros(4)]), np.tile([0.0, 0, 1], (4, 1))


def on_cylinder(points, radius):
    """(axial, angle) of the corners; e3 outward, counterclockwise from outside."""
    points = np.array(points)
    normal = np.column_stack([np.zeros(4), np.sin(points[:, 1]), np.cos(points[:, 1])])
    return normal * radius + np.outer(points[:, 0], [1.0, 0, 0]), normal


def on_graph(points, height, slope):
    """Corners (x, y, height(x, y)) with the normals of the graph."""
    x, y = np.array(points).T
    normal = np.column_stack([*(-s for s in slope(x, y)), np.ones(4)])
    return np.column_stack([x, y, height(x, y)]), unit(normal)


def on_sphere(points, radius):
    """Central projection of points of the plane z = 1."""
    normal = unit(np.column_stack([points, np.ones(4)]))
    return radius * normal, normal


def cases():
    """(name, corners, directors, direction, layup, unknowns)."""
    skew = [(0.1, -0.2), (1.0, -0.1), (0.8, 0.5), (0.0, 0.3)]
    trapezoid = [(0, 0), (1.0, 0), (0.7, 0.5), (0.3, 0.5)]
    rough = [(-0.5, -0.3), (0.4, -0.45), (0.55, 0.35), (-0.3, 0.5)]
    rng = np.random.default_rng(11)
    warped, tilted = flat(rough)
    warped = warped + 0.08 * rng.standard_normal((4, 3))
    tilted = unit(tilted + 0.15 * rng.standard_normal((4, 3)))
    hypar = on_graph(rough, lambda x, y: 0.4 * x * y, lambda x, y: (0.4 * y, 0.4 * x))
    return [
        ("parallelogram", *flat([(0, 0), (1, 0.2), (1.3, 0.9), (0.3, 0.7)]), (0, 0, 0), "isotropic", 7),
        ("trapezoid", *flat(trapezoid), (0, 0, 0), "laminate", 7),
        ("flat", *flat(skew), (0.4, 1.0, 0), "laminate", 7),
        ("flat-6", *flat(skew), (0.4, 1.0, 0), "laminate", 6),
        ("cylinder-oblique", *on_cylinder([(0, 0), (0.7, 0.1), (0.8, 0.5), (-0.1, 0.35)], 2.0),
         (1, 0, 0), "laminate", 7),
        ("sphere", *on_sphere(rough, 1.5), (1, 1, 0), "isotropic", 7),
        ("hypar", *hypar, (0, 0, 0), "isotropic", 7),
        ("warped", warped, tilted, (1.0, 0.3, 0.1), "laminate", 7),
        ("warped-6", warped, tilted, (1.0, 0.3, 0.1), "laminate", 6),
    ]


def block(rng, name, corners, directors, direction, layup, unknowns):
    """One case of the file: (case name, words, arrays)."""
    section = QuadSection(**LAYUPS[layup])
    axes = axes_of(directors)
    el = QuadElement(corners, directors, axes, section, direction, unknowns=unknowns)
    spread = np.tile([0.02] * 3 + [0.05] * 3 + [0.01] * (unknowns - 6), 4)
    turn = rotation(0.3 * unit(rng.standard_normal(3)))
    u = rigid(el, turn, rng.uniform(-0.1, 0.1, 3)) + spread * rng.standard_normal(el.size)
    rows = [np.concatenate([[t, a], m["constants"], m["d"], m["alpha"]]) for t, a, m in section.layers]
    arrays = dict(corners=corners, directors=directors, axes=axes, direction=[direction],
                  unknowns=[[unknowns]], layers=rows, z=[[section.zlow, section.zhigh]],
                  area=[[el.area]], skew=[[*el.alpha, el.ratio]], warp=el.warp[None],
                  share=[[el.share]], weights=el.load_weights())
    for mode, d in zip(("D00", "D01", "D10", "D11"), el.D):
        arrays[mode] = d
    arrays.update(volt=np.array([el.given_force(v) for v in el.volt]).T,
                  kelvin=el.given_force(el.kelvin)[:, None], K=lower(el.stiffness()), U=u[:, None],
                  energy=[[el.energy(u)]], force=el.force(u)[:, None], tangent=lower(el.tangent(u)))
    return name, {}, arrays


def blocks():
    """All cases of quads.txt."""
    rng = np.random.default_rng(3)
    return [block(rng, *case) for case in cases()]


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "quads.txt"), HELP, blocks())
