"""Write tests/oracle/data/elements.txt: single elements on six surfaces.

    python3 write_data.py

Deterministic: same files from the same numpy, bit for bit.
Anchors that this code did not compute (witness.txt, table7.txt) are only read.
"""

import os

import numpy as np

import textdata
from shellref import (IMPROVED, PUBLISHED, SURFACES, Element, GivenSection, Section,
                      face_map, isotropic, ply, rigid_motion, strain_map)

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "data")

ELEMENTS_HELP = """\
Single shell elements: geometry, plies, stiffness, loads and internal forces.

Format, tokens separated by white space; a line that starts with # is a comment:
    case NAME                 starts a case
    word KEY VALUE            one word
    array KEY ROWS COLS       followed by ROWS x COLS numbers, row by row
Keys with n = 4 x unknowns (7 or 6 a node), corners (-,-) (+,-) (+,+) (-,+):
    word surface              plate polar cylinder ring cone sphere
    array surface 1 k         its numbers: cylinder, ring, sphere: radius; cone: half angle, rad
                              (plate: theta1 = x; polar: theta1 = r; cylinder: theta1 axial, theta2
                              around; ring: theta1 around, theta2 axial; cone: theta1 = distance from
                              the apex; sphere: theta1 = angle from the pole; e3 outward or +z)
    word element              improved | published;   array unknowns 1 1
    array cell 1 4            t1a t1b t2a t2b
    array layers L 17         from z-: thickness, angle (degrees, theta1 towards theta2), E1 E2 E3 G12 G13
                              G23 nu12 nu13 nu23, d31 d32 d33, alpha1 alpha2 alpha3 (ply axes)
    array z 1 2               z of the inner and outer face from the reference surface
    array area 1 1
    array D00 D01 D10 D11     10 x 10 of the strains 11m 11d 22m 22d 33m 33d 12m 12d 13 23 (m mean of the
                              faces, d outer minus inner), zero where a mode keeps no strain
    array volt n L            nodal force at rest per volt of each layer (E3 = -V/thickness; where the
                              metric counts, falling as 1/(c1 c2), V between the layer's faces)
    array kelvin n 1          nodal force at rest per kelvin
    array pressure n 1        nodal force of a unit pressure along +e3 on the outer face, per reference area, weights
                              area/36 [4 2 1 2]; published by components, improved as vectors E_r E_s^T e3
    array pressure_skew n 1   improved only: the same with the weights area x integral of N_r N_s j,
                              j ~ 1 + alpha1 xi2 + alpha2 xi1, alpha of the corners
    array warp 1 9            improved only: shares in 12m of mode 00 of the plain modes 12d^00 13^01
                              23^10 13^00 23^00 11d^00 11d^01 22d^00 22d^10
    array K 1 n(n+1)/2        stiffness at rest, lower triangle row by row
    array U n 1               a displacement;  array energy 1 1, array force n 1: strain energy and internal
                              force there;  array tangent 1 n(n+1)/2
Unknowns of a node: mean u1 u2 u3; (u+ - u-)/h of 1 2 3; (u3M - mean u3)/h.
The published element: components in turning triads, area at the centre, given stresses as they are.
The improved element: Cartesian differences, warp of the middle surface in the membrane shear
(tau 1), bubbles in the shear compliance (rho .09, c .6), modes 01, 10, 11 by stresses, linear part of e33
eliminated, metric through the thickness, exact area, given stresses condensed on s33 = 0 in
each ply; transverse shear of laminates uniform through the thickness.
Cases published-witness-1 ... 10 were computed by another program: no layers, D given in the strains above
(array D), and per node (array nodes 4 x 6) A1 A2 k1 k2 B1 B2; their tangent, force and energy at U.
"""

COMPOSITE = [144.23e3, 9.65e3, 11.0e3, 4.14e3, 3.9e3, 3.45e3, 0.3, 0.28, 0.35]

LAYUPS = {
    "isotropic": (dict(layers=[(0.06, 0, isotropic(2.1e5, 0.3, alpha=[1.2e-5] * 3))], zlow=None)),
    "laminate": (dict(layers=[
        (0.010, 0, isotropic(6.3e4, 0.3, d=(254e-9, 254e-9, -100e-9), alpha=[4e-6] * 3)),
        (0.012, 30, ply(COMPOSITE, alpha=(-3e-7, 2.8e-5, 2.9e-5))),
        (0.018, -50, ply(COMPOSITE, alpha=(-3e-7, 2.8e-5, 2.9e-5))),
        (0.005, 20, ply([2.2e3, 2.0e3, 1.9e3, 8e2, 7.5e2, 7e2, 0.29, 0.31, 0.33],
                        d=(23e-9, 5e-9, -30e-9), alpha=(5e-5, 6e-5, 7e-5)))], zlow=-0.015)),
}

CELLS = {
    "plate": ((), (0.1, 0.8, -0.2, 0.3)),
    "polar": ((), (1.0, 1.6, 0.2, 0.7)),
    "cylinder": ((2.0,), (0.0, 0.8, 0.1, 0.6)),
    "ring": ((2.0,), (0.1, 0.6, 0.0, 0.8)),
    "cone": ((0.5,), (2.0, 2.7, 0.3, 0.8)),
    "sphere": ((1.5,), (0.6, 1.1, 0.2, 0.8)),
}

PRESETS = [("published", PUBLISHED, 7), ("improved", IMPROVED, 7), ("improved", IMPROVED, 6)]


def lower(matrix):
    """Lower triangle row by row [n(n+1)/2]."""
    return matrix[np.tril_indices(len(matrix))][None]


def rotation(vector):
    """Rotation matrix of a rotation vector (Rodrigues)."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def moderate(rng, surface, cell, section, unknowns):
    """Rigid rotation of .3 about a random axis plus strains of a few hundredths [n]."""
    axis = rng.standard_normal(3)
    turn = rotation(0.3 * axis / np.linalg.norm(axis))
    corners = [(cell[0], cell[2]), (cell[1], cell[2]), (cell[1], cell[3]), (cell[0], cell[3])]
    rigid = rigid_motion(surface, corners, section, turn, rng.uniform(-0.1, 0.1, 3), unknowns)
    spread = np.tile([0.02] * 3 + [0.05] * 3 + [0.01] * (unknowns - 6), 4)
    return rigid + spread * rng.standard_normal(4 * unknowns)


def element_case(rng, name, layup, word, preset, unknowns):
    """One element on a surface: (case name, words, arrays)."""
    numbers, cell = CELLS[name]
    surface, section = SURFACES[name](*numbers), Section(**LAYUPS[layup])
    el = Element(surface, cell, section, preset, unknowns)
    u = moderate(rng, surface, cell, section, unknowns)
    rows = [np.concatenate([[t, a], m["constants"], m["d"], m["alpha"]]) for t, a, m in section.layers]
    arrays = dict(surface=np.array([numbers]), unknowns=[[unknowns]], cell=[cell], layers=rows,
                  z=[[section.zlow, section.zhigh]], area=[[el.area]])
    for mode, d in zip(("D00", "D01", "D10", "D11"), el.D):
        arrays[mode] = d
    arrays.update(volt=np.array([el.given_force(v) for v in el.volt]).T,
                  kelvin=el.given_force(el.kelvin)[:, None],
                  pressure=el.load(np.tile([0.0, 0, 1], (4, 1)))[:, None],
                  K=lower(el.stiffness()), U=u[:, None], energy=[[el.energy(u)]],
                  force=el.force(u)[:, None], tangent=lower(el.tangent(u)))
    if el.cartesian:
        normal = np.tile([0.0, 0, 1], (4, 1))
        arrays.update(pressure_skew=el.load(normal, weights=el.skew_weights())[:, None],
                      warp=el.warp[None])
    return f"{name}-{layup}-{word}-{unknowns}", dict(surface=name, element=word), arrays


def witnesses(prefix):
    """Cases of witness.txt whose names start with `prefix`."""
    path = os.path.join(DATA, "witness.txt")
    return [block for block in textdata.read(path) if block[0].startswith(prefix)]


def witness_case(name, words, arrays):
    """The other program's element, turned from face unknowns to the unknowns of this file."""
    zlow, zhigh = arrays["z"][0]
    t = strain_map()
    p = np.kron(np.eye(4), face_map(zhigh - zlow))
    out = {key: arrays[key] for key in ("surface", "cell", "z", "area", "nodes")}
    out["unknowns"] = [[7]]
    out["D"] = t.T @ arrays["D"] @ t
    out["U"] = np.linalg.solve(p, arrays["U"])
    out["energy"] = arrays["energy"]
    out["force"] = p.T @ arrays["force"]
    out["tangent"] = lower(p.T @ arrays["K"] @ p)
    return f"published-{name}", dict(surface=words["surface"], element="published"), out


def witness_element(words, arrays):
    """Our element on the cell of a witness, with its D."""
    zlow, zhigh = arrays["z"][0]
    t = strain_map()
    section = GivenSection(zlow, zhigh, t.T @ arrays["D"] @ t)
    return Element(SURFACES[words["surface"]](*arrays["surface"][0]), arrays["cell"][0], section, PUBLISHED)


def blocks():
    """All cases of elements.txt."""
    rng = np.random.default_rng(7)
    return [element_case(rng, name, layup, *preset)
            for name in CELLS for layup in LAYUPS for preset in PRESETS] + [
        witness_case(*block) for block in witnesses("witness")]


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "elements.txt"), ELEMENTS_HELP, blocks())
