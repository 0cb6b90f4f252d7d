# SPDX-License-Identifier: BSD-2-Clause
"""Anchors of the oracle: other programs' numbers, closed forms and laws.  Prints TAP.

    python3 check_oracle.py          exit status 1 when a check fails
"""

import os
import sys

import numpy as np

import cases
import revolution
import textdata
import write_data
import write_quads
from model import Model
from quadref import QuadElement, QuadSection, rigid
from shellref import (IMPROVED, KEPT, PUBLISHED, SURFACES, WARP_ROWS, XI, Element, Plate, Ring,
                      Section, cylinder, face_map, field_share, isotropic, ply, ply_stiffness,
                      ply_turn, rigid_motion, strain_map)

# The bubble of the former element, the same in modes 01 and 10; known rows of plates use it.
LINEAR_E33 = {**IMPROVED, "plies": False}  # a thickness strain that is linear through the package
FACES = {**LINEAR_E33, "quadratic": False}  # and z^2 of the in-plane strains from the faces
FORMER_BUBBLE = {**IMPROVED, "rho": 0.1, "torsion": 0.0}
PRESETS = [(PUBLISHED, 7), (IMPROVED, 7), (IMPROVED, 6)]
CHECKS = []

CELLS = {**write_data.CELLS,
         "torus": ((3.0, 1.0), (-0.3, 0.4, 0.2, 0.5)),
         "hyperboloid": ((1.5, 0.6), (0.2, 0.7, 0.1, 0.4))}


def check(function):
    """Collect a check: it returns the pairs (what, error, bound)."""
    CHECKS.append(function)
    return function


def relative(got, wanted):
    """Largest difference over the largest wanted number."""
    return np.abs(np.asarray(got) - wanted).max() / np.abs(wanted).max()


def elements(layup):
    """(name, element, surface, cell, section) of every surface and preset."""
    section = Section(**write_data.LAYUPS[layup])
    for name, (numbers, cell) in CELLS.items():
        surface = SURFACES[name](*numbers)
        for preset, unknowns in PRESETS:
            yield name, Element(surface, cell, section, preset, unknowns), surface, cell, section


# ---------------------------------------------------------------- another program

@check
def ten_elements_of_another_program():
    keep = np.zeros((4, 10))
    keep[[0] * 10, range(10)] = keep[1, [0, 1, 4, 5, 8]] = keep[2, [2, 3, 4, 5, 9]] = keep[3, 4:6] = 1
    for name, words, a in write_data.witnesses("witness"):
        el = write_data.witness_element(words, a)
        p, t = np.kron(np.eye(4), face_map(el.h)), strain_map()
        u = np.linalg.solve(p, a["U"][:, 0])
        inverse = np.linalg.inv(p)
        yield f"{name} strains", relative(keep * (el.strains(u) @ t.T), a["strains"]), 1e-12
        yield f"{name} resultants", relative(el.resultants(u) @ np.linalg.inv(t), a["resultants"]), 1e-12
        yield f"{name} energy", relative(el.energy(u), a["energy"]), 1e-12
        yield f"{name} force", relative(inverse.T @ el.force(u), a["force"][:, 0]), 1e-12
        yield f"{name} tangent", relative(inverse.T @ el.tangent(u) @ inverse, a["K"]), 1e-12
        nodes = [np.concatenate(c[2:]) for c in el.corners]
        yield f"{name} geometry", relative(nodes, a["nodes"]), 1e-14


class Oblique:
    """A plane parallelogram, t1 and t2 from 0 to 1 along its sides; triads are the global axes."""

    def __init__(self, corners):
        """corners [4][3] in the plane e3 = const."""
        self.start, self.sides = corners[0], np.array([corners[1], corners[3]]) - corners[0]

    def at(self, t1, t2):
        """As shellref.Plate.at; A, k and B are not those of lines of curvature and not used."""
        return (self.start + t1 * self.sides[0] + t2 * self.sides[1], np.eye(3),
                np.ones(2), np.zeros(2), np.zeros(2))

    def area(self, cell):
        """Exact area for the cell (0, 1, 0, 1)."""
        return np.linalg.norm(np.cross(*self.sides))


class ObliqueSection(Section):
    """A section whose base vectors at every depth are given."""

    def __init__(self, layers, base):
        super().__init__(layers)
        self.given_base = base

    def base(self, k, options):
        """J(0) and dJ/dz = 0 [3][3]."""
        return self.given_base, np.zeros((3, 3))


def improved_witness(words, a):
    """Our improved element on the geometry and material of a witness."""
    thick, angle, *constants = a["layers"][0]
    layers = [(thick, angle, ply(constants[:9]))]
    if words["surface"] == "oblique":
        section = ObliqueSection(layers, a["base"])
        return Element(Oblique(a["corners"]), (0, 1, 0, 1), section, FACES)
    surface = SURFACES[words["surface"]](*a["surface"][0])
    return Element(surface, a["cell"][0], Section(layers), FACES)


@check
def two_improved_elements_of_another_program():
    """On a cylinder along its lines of curvature, and a plane parallelogram."""
    kept = np.zeros((4, 10))
    for m, strains in enumerate(KEPT):
        kept[m, strains] = 1
    for name, words, a in write_data.witnesses("improved-witness"):
        el = improved_witness(words, a)
        u, lower = a["U"][:, 0], np.tril_indices(28)
        yield f"{name} area", relative(el.area, a["area"]), 1e-14
        scale = max(np.abs(a["warp"]).max(), 1e-2)
        yield f"{name} warp", np.abs(el.warp - a["warp"]).max() / scale, 1e-13
        yield f"{name} stiffness", relative(el.stiffness()[lower], a["K"][0]), 1e-13
        yield f"{name} strains", relative(kept * el.strains(u), a["strains"]), 1e-13
        yield f"{name} force", relative(el.force(u), a["force"][:, 0]), 1e-12
        yield f"{name} tangent", relative(el.tangent(u)[lower], a["tangent"][0]), 1e-12


@check
def data_file_is_what_this_code_writes():
    stored = textdata.read(os.path.join(write_data.DATA, "elements.txt"))
    made = write_data.blocks()
    yield "names", float([b[:2] for b in stored] != [b[:2] for b in made]), 0.5
    for (name, _, old), (_, _, new) in zip(stored, made):
        yield name, max(relative(new[k], old[k]) for k in old if np.size(old[k]) and np.abs(old[k]).max() > 0), 1e-10


@check
def data_of_quadrilaterals_is_what_this_code_writes():
    stored = textdata.read(os.path.join(write_data.DATA, "quads.txt"))
    for (name, _, old), (_, _, new) in zip(stored, write_quads.blocks(), strict=True):
        yield name, max(np.abs(np.asarray(new[k]) - old[k]).max() / max(np.abs(old[k]).max(), 1e-12)
                        for k in old if np.size(old[k])), 1e-10


# ---------------------------------------------------------------- laws of one element

@check
def quadrilateral_along_lines_is_the_element_of_the_surface():
    """Plate and cylinder: the same stiffness, force and columns from nodes and directors alone."""
    section = dict(write_data.LAYUPS["laminate"])
    for name in ("plate", "cylinder", "ring"):
        numbers, cell = CELLS[name]
        surface = SURFACES[name](*numbers)
        el = Element(surface, cell, Section(**section), IMPROVED)
        triads = [c[1].T for c in el.corners]
        quad = QuadElement([c[0] for c in el.corners], [t[2] for t in triads], [t[0] for t in triads],
                           QuadSection(**section), area=el.area)
        u = 0.01 * np.sin(np.arange(28.0))
        yield f"{name} stiffness", relative(quad.stiffness(), el.stiffness()), 1e-12
        yield f"{name} strains", relative(quad.B, el.B), 1e-13
        yield f"{name} volt", relative(quad.volt, el.volt), 1e-12
        yield f"{name} force", relative(quad.force(u), el.force(u)), 1e-12


@check
def rigid_motion_strains_no_quadrilateral():
    for name, corners, directors, direction, layup, unknowns in write_quads.cases():
        el = QuadElement(corners, directors, write_quads.axes_of(directors),
                         QuadSection(**write_data.LAYUPS[layup]), direction, unknowns=unknowns)
        u = rigid(el, write_data.rotation(np.array([1.0, -0.7, 0.4])), np.array([0.3, -0.2, 0.1]))
        yield name, np.abs(el.strains(u)).max(), 1e-14

@check
def triad_follows_the_lines_of_curvature():
    """x,a = A_a e_a and e3,a = A_a k_a e_a and e3 = e1 x e2, by central differences."""
    for name, (numbers, cell) in CELLS.items():
        surface, t, d = SURFACES[name](*numbers), np.array([cell[0], cell[2]]), 1e-5
        _, triad, lame, k, _ = surface.at(*t)
        yield f"{name} e3", np.abs(np.cross(triad[:, 0], triad[:, 1]) - triad[:, 2]).max(), 1e-14
        for a in (0, 1):
            step = d * np.eye(2)[a]
            plus, minus = surface.at(*(t + step)), surface.at(*(t - step))
            yield f"{name} x", np.abs((plus[0] - minus[0]) / (2 * d) - lame[a] * triad[:, a]).max(), 1e-8
            turn = (plus[1][:, 2] - minus[1][:, 2]) / (2 * d)
            yield f"{name} k", np.abs(turn - lame[a] * k[a] * triad[:, a]).max(), 1e-8


@check
def point_strain_of_a_finite_rigid_motion_is_zero():
    """lam_a from exact derivatives of the components (central differences here)."""
    turn, shift, d = write_data.rotation([0.9, -1.3, 0.7]), np.array([0.3, -0.2, 0.5]), 1e-5
    for name, el, surface, cell, section in elements("laminate"):
        if el.cartesian:
            continue
        params, faces = np.array([cell[1] - cell[0], cell[3] - cell[2]]), (section.zlow, section.zhigh)
        here = np.array([cell[0], cell[2]])
        lame = el.corners[0][2]

        def faces_at(t):
            q = rigid_motion(surface, [t], section, turn, shift)
            return np.array([q[:3] - section.h / 2 * q[3:6], q[:3] + section.h / 2 * q[3:6]])
        lam, g = [], []
        for a in (0, 1):
            s, t, base = el.coupling(0, a, params, faces)
            step = d * np.eye(2)[a]
            slope = (faces_at(here + step) - faces_at(here - step)) / (2 * d * lame[a])
            lam.append(faces_at(here) @ (s + t).T + slope)
            g.append(base)
        beta = (faces_at(here)[1] - faces_at(here)[0]) / section.h
        for face in (0, 1):
            for a, b in ((0, 0), (1, 1), (0, 1)):
                e = g[a][face] @ lam[b][face] + g[b][face] @ lam[a][face] + lam[a][face] @ lam[b][face]
                yield f"{name} {a}{b}", abs(e), 1e-8
        for a in (0, 1):
            e = [beta @ g[a][f] + lam[a][f][2] + beta @ lam[a][f] for f in (0, 1)]
            yield f"{name} {a}3", abs(sum(e)), 1e-8
        yield f"{name} 33", abs(beta[2] + beta @ beta / 2), 1e-13


def mesh_energy(name, n, preset, unknowns):
    """Energy of a finite rigid motion of an n x n mesh / energy of stretching it by 1."""
    numbers, cell = CELLS[name]
    surface, section = SURFACES[name](*numbers), Section(**write_data.LAYUPS["laminate"])
    turn, shift = write_data.rotation([0.9, -1.3, 0.7]), np.array([0.3, -0.2, 0.5])
    t1, t2 = np.linspace(cell[0], cell[1], n + 1), np.linspace(cell[2], cell[3], n + 1)
    m = Model(surface, t1, t2, section, preset, unknowns)
    u = rigid_motion(surface, [(a, b) for a in t1 for b in t2], section, turn, shift, unknowns)
    scale = sum(el.area * el.D[0][0, 0] for el in m.elements) / 2
    return sum(el.energy(u[dof]) for el, dof in zip(m.elements, m.dofs)) / scale


@check
def finite_rigid_motion_of_the_mesh():
    """Free in Cartesian differences; in the published element it falls with the fourth power."""
    for name in CELLS:
        for preset, unknowns in PRESETS[1:]:
            yield f"{name} improved", abs(mesh_energy(name, 3, preset, unknowns)), 1e-25
        if name == "plate":
            yield "plate published", abs(mesh_energy(name, 3, PUBLISHED, 7)), 1e-27
        else:
            ratio = mesh_energy(name, 4, PUBLISHED, 7) / mesh_energy(name, 8, PUBLISHED, 7)
            yield f"{name} published, order", abs(np.log2(ratio) - 4), 0.2


@check
def six_zero_eigenvalues():
    """Of the stiffness scaled to unit diagonal, on every surface."""
    for layup in write_data.LAYUPS:
        for name, el, *_ in elements(layup):
            k = el.stiffness()
            root = np.sqrt(np.diag(k))
            values = np.linalg.eigvalsh(k / np.outer(root, root))
            yield f"{name} sixth", abs(values[5]), 1e-13
            yield f"{name} seventh", 1e-7 / values[6], 1.0


@check
def force_and_tangent_are_derivatives():
    """Complex steps of the energy and of the force."""
    rng = np.random.default_rng(3)
    for name, el, surface, cell, section in elements("laminate"):
        u = write_data.moderate(rng, surface, cell, section, el.unknowns)
        steps = 1e-30j * np.eye(el.size)
        force = [el.energy(u + s).imag / 1e-30 for s in steps]
        tangent = np.array([el.force(u + s).imag / 1e-30 for s in steps]).T
        yield f"{name} force", relative(el.force(u), np.array(force)), 1e-12
        yield f"{name} tangent", relative(el.tangent(u), tangent), 1e-12
        yield f"{name} at rest", relative(el.stiffness(), el.tangent(np.zeros(el.size))), 1e-14


# ---------------------------------------------------------------- strains quadratic in the height

@check
def quadratic_part_of_shells_with_normal_directors():
    """m = (c^T k + k c)/2 - c^T e c, from a smooth displacement of surfaces with two curvatures."""
    rng, d = np.random.default_rng(5), 1e-4
    for name in ("polar", "cylinder", "sphere", "cone", "torus"):
        numbers, cell = CELLS[name]
        surface, here = SURFACES[name](*numbers), np.array([cell[0], cell[2]])
        poly = rng.standard_normal((3, 3, 3))

        def moved(t):
            return np.einsum("ijk,j,k->i", poly, [1, t[0], t[0]**2], [1, t[1], t[1]**2])

        def slopes(function, t):
            return np.array([(function(t + d * e) - function(t - d * e)) / (2 * d) for e in np.eye(2)]).T

        def turned(t):
            base, normal = slopes(lambda s: surface.at(*s)[0], t), surface.at(*t)[1][:, 2]
            return -base @ np.linalg.solve(base.T @ base, slopes(moved, t).T @ normal)
        base, turn = (slopes(lambda s: surface.at(*s)[i][..., 2] if i else surface.at(*s)[0], here) for i in (0, 1))
        u, v = slopes(moved, here), slopes(turned, here)

        def both(a, b):
            return (a.T @ b + b.T @ a) / 2
        change = np.linalg.solve(base.T @ base, base.T @ turn)
        strain, slope = both(base, u), both(base, v) + both(turn, u)
        wanted = (change.T @ slope + slope @ change) / 2 - change.T @ strain @ change
        yield name, relative(both(turn, v), wanted) if name != "polar" else np.abs(both(turn, v)).max(), 1e-5


LAYERS_OF_STRIPS = {
    "one ply": [(1.0, 1.0)],
    "0/90/0": [(1 / 3, 4.0), (1 / 3, 1.0), (1 / 3, 4.0)],
    "90/0/90": [(1 / 3, 1.0), (1 / 3, 25.0), (1 / 3, 1.0)],
    "sandwich": [(0.05, 1.0), (0.9, 1e-3), (0.05, 1.0)],
    "bimetal": [(0.5, 1.0), (0.5, 3.0)],
    "void": [(0.4, None), (0.6, 1.0)],
}


def rolled_energy(el, side, stretch, curvature):
    """Energy per area of a flat element whose middle is stretched and rolled to a curvature per length."""
    u, turn = np.zeros((4, 7)), curvature * side
    radius = stretch / curvature
    for r, (x, triad, *_) in enumerate(el.corners):
        angle = turn * (x[0] > 0)
        u[r, :3] = [radius * np.sin(angle) - x[0], 0, radius * (np.cos(angle) - 1)]
        u[r, 3:6] = [np.sin(angle), 0, np.cos(angle) - 1]
    return el.energy(u.ravel()) / el.area


@check
def rolled_strips_have_the_resultants_of_their_plies():
    """Force and moment of a strip that is stretched and rolled, against integrals over the plies.

    With s(z) = ((l + z k)^2 - 1)/2: force = integral E s (l + z k), moment = integral E s (l + z k) z.
    The element's force is exact; its moment lacks the work of z^2 - a - b z, E (z^2 - a - b z)^2 k^3/2.
    From the faces force and moment of one ply under tension are wrong by k^2 h^2/12.
    """
    side, step, stretch, curvature = 1e-4, 1e-4, 1.02, 0.1
    for name, layers in LAYERS_OF_STRIPS.items():
        section = Section([(t, 0, None if e is None else isotropic(e, 0.0)) for t, e in layers])
        for preset in (IMPROVED, {**IMPROVED, "quadratic": False}):
            el = Element(Plate(), (0, side, 0, side), section, {**preset, "rho": 0.0})
            got = np.array([(rolled_energy(el, side, stretch + s, curvature + k)
                             - rolled_energy(el, side, stretch - s, curvature - k)) / (2 * step)
                            for s, k in ((step, 0), (0, step))])
            wanted, bottom = np.zeros(2), -0.5
            a, b = el.lines[:, 0]
            for thick, young in layers:
                x, w = np.polynomial.legendre.leggauss(5)
                z, weight = bottom + thick * (1 + x) / 2, (young or 0) * thick / 2 * w
                bottom += thick
                strain = ((stretch + z * curvature)**2 - 1) / 2
                wanted += [weight @ (strain * (stretch + z * curvature)),
                           weight @ (strain * (stretch + z * curvature) * z)]
                if preset is IMPROVED:
                    wanted[1] -= weight @ (z**2 - a - b * z)**2 * curvature**3 / 2
            if preset is IMPROVED:
                yield f"{name} force", abs(got[0] / wanted[0] - 1), 1e-6
                yield f"{name} moment", abs(got[1] / wanted[1] - 1), 1e-5
            elif name == "one ply":
                yield "force of faces is wrong", abs(got[0] - wanted[0] - stretch * curvature**2 / 12), 1e-6


def fold_stiffness(law, curvature, step=1e-4):
    """d moment/d curvature at constant force 0; law(stretch, curvature) = force, moment."""
    def moment(k):
        stretch = 1.0
        for _ in range(50):
            force, above = law(stretch, k)[0], law(stretch + 1e-7, k)[0]
            stretch -= force / (above - force) * 1e-7
        return law(stretch, k)[1]
    return (moment(curvature + step) - moment(curvature - step)) / (2 * step)


@check
def folds_lose_stiffness():
    """THEORY.md: plies [0/90/0] of moduli 1, 4, 1 without membrane force, folded to thickness times curvature .8.

    Resultants of a body with Green's strains s = ((l + z k)^2 - 1)/2 against those of two theories: z^2 k^2/2
    replaced by its best constant, and left out.
    """
    x, w = np.polynomial.legendre.leggauss(5)
    z = np.concatenate([x / 6 - 1 / 3, x / 6, x / 6 + 1 / 3])
    weight = np.concatenate([w / 6, 4 * w / 6, w / 6])
    size, bend = weight.sum(), weight @ z**2

    def body(stretch, k):
        strain = ((stretch + z * k)**2 - 1) / 2
        return weight @ (strain * (stretch + z * k)), weight @ (strain * (stretch + z * k) * z)

    def theory(share):
        def law(stretch, k):
            mean = (stretch**2 - 1) / 2 + share * k**2 / 2
            return (size * mean * stretch + bend * stretch * k**2,
                    size * mean * share * k + bend * stretch**2 * k)
        return law
    for name, law, known in (("body", body, 0.73), ("fitted", theory(bend / size), 0.64), ("omitted", theory(0), 0.82)):
        yield name, abs(fold_stiffness(law, 0.8) / bend - known), 0.005


# ---------------------------------------------------------------- warp of the improved element

@check
def warp_takes_no_director():
    """12d^00 - sum c_k row_k holds no director; what is left is the warp of the four nodes.

    The mixed difference of the middle surface is x,12 = sum xi1 xi2 X/4 = g_h: the bracket is
    -8 h/(L1 L2) u,12 . D to first order in the element's angles, and exactly on a plate.
    """
    for layup in write_data.LAYUPS:
        for name, el, *_ in elements(layup):
            if not el.cartesian:
                continue
            yield f"{name} directors", el.director_left, 1e-14
    section = Section(**write_data.LAYUPS["isotropic"])
    el = Element(Plate(), write_data.CELLS["plate"][1], section, IMPROVED)
    bracket = el.B[0, 7].copy()
    for c, (m, k) in zip(el.warp_c, WARP_ROWS):
        bracket -= c * el.B[m, k]
    wanted = np.zeros((4, 7))
    wanted[:, 2] = -8 * el.h / el.chords.prod() * XI.prod(axis=1) / 4
    yield "warp of a plate", relative(bracket, wanted.ravel()), 1e-13


@check
def warp_on_rectangles_is_two_h_over_the_sides():
    """c = (2h/L2 t1, 2h/L1 t2, 0 ...) on plates and cylinders; tw = (L1^2 k1 + L2^2 k2)/(12 h).

    t_a = 1 + b k_a/(h (1 + k_a z)), z the middle of the plies, is the share of the line a + b zeta/h
    that replaces zeta^2: 1 where the plies are symmetric.
    """
    for layup in write_data.LAYUPS:
        for name, el, *_ in elements(layup):
            if not el.cartesian or name not in ("plate", "cylinder", "ring"):
                continue
            wanted = np.zeros(8)
            k, middle = np.array(el.centre[3]), write_data.LAYUPS[layup]["zlow"]
            middle = 0 if middle is None else middle + el.h / 2
            wanted[:2] = 2 * (el.h + el.lines[1, 2] * k / (1 + k * middle)) / el.chords[::-1]
            yield f"{name} c", relative(el.warp_c, wanted), 1e-14
            curvature = 0 if name == "plate" else 0.5
            side = el.chords[0 if name == "ring" else 1]
            yield f"{name} tw", abs(el.warp[0] - side**2 * curvature / (12 * el.h)), 1e-14


@check
def inextensional_waves_follow_the_law_of_tau():
    """r = (1 - 2/3 s^2)(4 s^2/p^2)^2/(1 - 2/3 tau s^2)^2, s = sin(p/2), p the phase of an element.

    A wave of phase pi has zero displacement along the circle at all nodes and cos^2 = 1: twice r.
    Allowed: half the square of the axial phase pi/64, and angle^2/6 by which interpolated loads
    are shorter.
    """
    for elements_around, half_waves, tau in ((4, 1, 1.0), (4, 2, 1.0), (4, 3, 1.0), (4, 4, 1.0),
                                             (8, 3, 1.0), (4, 2, 0.0), (8, 1, 0.0)):
        phase = np.pi * half_waves / elements_around
        s2 = np.sin(phase / 2)**2
        law = (1 - 2 / 3 * s2) * (4 * s2 / phase**2)**2 / (1 - 2 / 3 * tau * s2)**2
        if half_waves == elements_around:
            law *= 2
        got = cases.inextensional_wave(elements_around, half_waves, {**IMPROVED, "tau": tau})
        bound = (np.pi / 64)**2 / 2 + (phase / 20)**2 / 6
        what = f"{half_waves} half waves, {elements_around} elements, tau {tau}"
        yield what, abs(got - law), bound


# ---------------------------------------------------------------- thin shells

THIN = {        # improved element at h/R 1e-6: compliance over the reference, 4x4 8x8 16x16
    "cylinder-simple-1": (0.913, 0.968, 0.987),
    "cylinder-simple-3": (0.941, 0.984, 0.995),
    "cylinder-clamped-2": (0.897, 0.966, 0.988),
    "cap-clamped-2": (0.823, 0.939, 0.978),
    "hyperboloid-clamped-2": (0.779, 0.910, 0.963),
    "hyperboloid-free-2": (0.832, 0.954),
}


@check
def shell_of_revolution_meets_a_closed_form():
    """Cylinder with diaphragms under sin(pi x/L) cos na: one wave solves all five equations."""
    length, n = 2.0, 2
    wave = np.pi / length
    for h in (1e-2, 1e-6):
        rows, slopes = revolution.strain_rows(1.0, 1.0, 0.0, [0.0, 1.0], n)
        rows = rows + wave * slopes * np.array([-1, 1, 1, -1, 1])
        law = revolution.section_stiffness(1.0, 0.3, h, [0.0, 1.0])
        exact = np.linalg.inv(rows.T @ law @ rows)[2, 2] * length / 2
        got = revolution.Harmonic(cylinder(1.0), (0.0, length), h, n, ("simple", "simple"),
                                  lambda t: np.array([0, 0, np.sin(wave * t)])).compliance
        yield f"h {h}", abs(got / exact - 1), 1e-11


@check
def finer_references_are_the_same():
    """Stored changes by a finer discretisation; references at h/R 1e-2 and two finer ones anew."""
    stored = textdata.read(os.path.join(write_data.DATA, "thin.txt"))
    yield "number", abs(len(stored) - len(revolution.CASES) * len(revolution.THICKNESSES)), 0.5
    for name, _, a in stored:
        yield f"{name} finer", abs(a["finer"][0, 0]), 1e-4
    for name, _, a in stored:
        h = a["h"][0, 0]
        case = name[:-len("-1e-02")]
        if h == 1e-2:
            yield name, abs(revolution.compliance(case, h) / a["compliance"][0, 0] - 1), 1e-6
        if h == 1e-4 and case in ("cylinder-free-2", "cap-clamped-2"):
            finer = revolution.compliance(case, h, degree=16, refine=2)
            yield f"{name} again", abs(finer / a["compliance"][0, 0] - 1), 1e-4


@check
def thin_shells_do_not_lock_and_are_not_too_soft():
    """Known to the printed digits at h/R 1e-6; every stored ratio is what this code gives."""
    stored = {name: a for name, _, a in textdata.read(os.path.join(write_data.DATA, "thin.txt"))}
    for case in revolution.CASES:
        a = stored[f"{case}-1e-06"]
        ratios = [cases.thin_shell(n, IMPROVED, case, 1e-6) / a["compliance"][0, 0]
                  for n in (4, 8, 16)]
        yield f"{case} stored", np.abs(ratios - a["improved"][:, 1]).max(), 1e-6
        for n, ratio, known in zip((4, 8, 16), ratios, THIN.get(case, ())):
            yield f"{case} {n}", abs(ratio - known), 6e-4
    for name, a in stored.items():
        yield f"{name} is not too soft", a["improved"][:, 1].max(), 1.0


@check
def smooth_pressure_between_diaphragms():
    """The same error at every thickness: no locking, no loss of membrane stiffness."""
    for preset, thickest, wanted in ((IMPROVED, 1e-2, (1.005, 1.002, 1.001)),
                                     (PUBLISHED, 1e-3, (1.164, 1.037, 1.009))):
        for h in (thickest, 1e-5):
            got = cases.smooth_pressure((4, 8, 16), preset, h)
            yield f"{h}", np.abs(np.subtract(got, wanted)).max(), 6e-4


# ---------------------------------------------------------------- patch tests and free expansion

def interior_force(preset, unknowns, nu, field):
    """Largest internal force at inner nodes / at the edge, non-uniform 3 x 3 plate."""
    h = 0.1
    x, y = [0, 0.5, 0.8, 1.6], [0, 0.2, 0.7, 1.0]
    m = Model(Plate(), x, y, Section([(h, 0, isotropic(1.0, nu))]), preset, unknowns)
    u = np.concatenate([field(a, b, h)[:unknowns] for a in x for b in y])
    f = (m.matrix() @ u).reshape(m.n1, m.n2, unknowns)
    return np.abs(f[1:-1, 1:-1]).max() / np.abs(f).max()


@check
def patch_tests():
    nu = 0.3
    squeeze = nu / (1 - nu)

    def membrane(x, y, h):
        return [0.3 * x + 0.2 * y, 0.1 * x - 0.4 * y, 0, 0, 0, -squeeze * (0.3 - 0.4), 0]

    for preset, unknowns in PRESETS:
        def bending(x, y, h):
            bulge = -squeeze * (0.5 - 0.2) * h / 8 if not preset["lin33"] else 0
            return [0, 0, 0.25 * x * x - 0.1 * y * y + 0.15 * x * y - h * bulge,
                    -0.5 * x - 0.15 * y, 0.2 * y - 0.15 * x, 0, bulge]
        yield "membrane", interior_force(preset, unknowns, nu, membrane), 1e-13
        yield "bending", interior_force(preset, unknowns, nu, bending), 1e-12


@check
def free_thermal_expansion():
    for preset, unknowns in PRESETS:
        m = Model(Plate(), [0, 0.5, 0.8], [0, 0.2, 0.7],
                  Section([(0.1, 0, isotropic(2.0, 0.3, alpha=[1e-3] * 3))]), preset, unknowns)
        m.fix([0], [0, 1, 2, 3, 4])
        m.fix([m.node(-1, 0)], [1])
        u = m.solve(m.gather(lambda el, i, j: el.given_force(el.kelvin))).reshape(-1, unknowns)
        grid = 1e-3 * np.array([(a, b) for a in m.t1 for b in m.t2])
        yield "in plane", relative(u[:, :2], grid), 1e-10
        if not preset["free33"]:
            yield "thickness", relative(u[:, 5], np.full(len(u), 1e-3)), 1e-10


@check
def bimorph_closed_forms():
    for preset, unknowns in PRESETS:
        for n in (1, 40):
            yield f"tip {n}", abs(cases.bimorph_tip(n, preset, unknowns) / 3.45e-7 - 1), 1e-8
        yield "equal voltages", relative(cases.equal_voltages(10, preset, unknowns), np.full(5, 14492.753623)), 1e-8
        for nu, d33 in ((0.3, -33e-12), (0.45, 0.0)):
            got = cases.free_bimorph_curvature(3, preset, unknowns, nu, d33)
            yield f"free plate nu={nu}", relative(got, np.ones(2)), 1e-9
        volts, left = cases.tip_force_voltages(40, preset, unknowns)
        yield "tip force volts", relative(volts, np.array([-1615.397, -1186.347, -884.510, -512.281, -190.444])), 2e-3
        yield "tip force rest", abs(left - 5.25e-4), 1e-5
        beam = -np.array([292.351, 227.384, 162.417, 97.450, 32.483])
        yield "open electrodes", relative(cases.open_electrodes(40, preset, unknowns), beam), 1.3e-4


@check
def membrane_cylinders():
    """Ring under a unit pressure, plane strain: u3 = p R^2 (1 - nu^2)/(E h), both directions agree.

    The Cartesian load loses angle^2/6 of an element's angle here: interpolated vectors are shorter.
    """
    young, nu, radius, h, angle = 7.0, 0.3, 2.0, 0.02, 0.15
    section = Section([(h, 0, isotropic(young, nu))])
    wanted = radius**2 * (1 - nu**2) / (young * h)
    for preset, unknowns in PRESETS:
        got = []
        for surface, around in ((cylinder(radius), 1), (Ring(radius), 0)):
            grid = [np.linspace(0, 2 * angle, 3)] * 2
            m = Model(surface, *grid, section, preset, unknowns)
            for edge in ("theta1-", "theta1+", "theta2-", "theta2+"):
                m.symmetric(edge)
            u = m.solve(m.distributed(lambda a, b, t: np.array([0, 0, 1.0]), 0.0))
            got.append(m.middle(u, m.node(1, 1)))
        yield "both directions", abs(got[0] / got[1] - 1), 1e-12
        lost = angle**2 / 6 if preset["kinematics"] == "cartesian" else 0
        yield "closed form", abs(got[0] / wanted - 1 + lost), 1e-4


# ---------------------------------------------------------------- structural cases, ratios known from another program

LINEAR = [
    (cases.scordelis_lo, {}, PUBLISHED, [0.8614, 0.9582, 0.9853, 0.9927]),
    (cases.pinched_cylinder, {}, PUBLISHED, [0.8485, 0.9158, 0.9757, 1.0000]),
    (cases.hemisphere, {}, PUBLISHED, [0.8764, 0.9591, 0.9899, 1.0012]),
    (cases.clamped_plate, dict(nu=0.3), PUBLISHED, [0.941, 0.981, 0.996]),
    (cases.clamped_plate, dict(nu=0.49), PUBLISHED, [0.428, 0.705, 0.862]),
    (cases.clamped_plate, dict(nu=0.4999), PUBLISHED, [0.011, 0.036, 0.119]),
    (cases.clamped_plate, dict(nu=0.3), FORMER_BUBBLE, [0.9909, 1.0020, 1.0049]),
    (cases.clamped_plate, dict(nu=0.49), FORMER_BUBBLE, [0.9976, 1.0049, 1.0068]),
    (cases.clamped_plate, dict(nu=0.4999), FORMER_BUBBLE, [0.9980, 1.0051, 1.0069]),
]


@check
def shell_and_plate_rows():
    """Known to the printed digits; six unknowns give the same as seven."""
    for function, more, preset, wanted in LINEAR:
        what = f"{function.__name__} {more}"
        bound = 6e-4 if function is cases.clamped_plate and preset is PUBLISHED else 6e-5
        for n, ratio in zip((4, 8, 16, 32), wanted):
            yield f"{what} {n}", np.abs(np.subtract(function(n, preset, **more), ratio)).max(), bound
    for function in (cases.scordelis_lo, cases.pinched_cylinder, cases.hemisphere,
                     cases.clamped_plate):
        pair = [np.array(function(4, IMPROVED, k)) for k in (6, 7)]
        yield f"{function.__name__} 6 = 7", np.abs(pair[0] - pair[1]).max(), 1e-7


def error_ratio(improved, published):
    """(value, rounding) of (1 + improved)/(1 + published), errors printed in percent."""
    numbers, bound = [], 0.0
    for text in (improved, published):
        numbers.append(1 + float(text) / 100)
        bound += 0.005 * 10.0**-len(text.partition(".")[2]) / numbers[-1]
    return numbers[0] / numbers[1], bound * numbers[0] / numbers[1]


@check
def improved_rows():
    """Errors in percent known from another program, on meshes 4 8 16.

    Its reference of the roof is the limit of fine meshes (to 1e-4); those of the point loads are
    its own, so the ratio of the improved to the published element is compared.
    """
    roof = [cases.scordelis_lo(n, IMPROVED) for n in (4, 8, 16, 32)]
    exact = cases.limit(roof[2], roof[3])
    for n, value, error in zip((4, 8, 16), roof, (-7.2, -2.1, -0.6)):
        yield f"roof {n}", abs(100 * (value / exact - 1) - error), 0.05 + 0.01
    for function, improved, published in (
            (cases.pinched_cylinder, ("-30.6", "-9.5", "-2.8"), ("-16", "-9.5", "-3.6")),
            (cases.hemisphere, ("2.6", "-.2"), ("-12.9", "-4.7"))):
        for n, a, b in zip((4, 8, 16), improved, published):
            known, bound = error_ratio(a, b)
            got = np.max(function(n, IMPROVED)) / np.max(function(n, PUBLISHED))
            yield f"{function.__name__} {n}", abs(got - known), bound


@check
def three_dimensional_elasticity():
    isotropic_plate = (isotropic(1.0, 0.3), [0, 0])
    pagano = (cases.GRAPHITE, [0, 90, 0])
    yield "published [0/90/0] S=4", abs(cases.plate_3d(4, *pagano) * 100 / 4**3 - 2.0059), 1e-4
    yield "exact at S=500", abs(cases.plate_3d(500, *isotropic_plate) * 4 * np.pi**4 / 500**3
                               / (12 * (1 - 0.09)) - 1), 1e-4
    for (material, angles), table in ((isotropic_plate, {4: 1.0404, 10: 1.0073, 20: 1.0019, 50: 1.0003}),
                                      (pagano, {4: 0.797, 10: 0.842, 20: 0.935, 50: 0.9875, 100: 0.9968})):
        for ratio, wanted in table.items():
            got = cases.limit(*[cases.sine_plate(n, PUBLISHED, 7, ratio, material, angles) for n in (16, 32)])
            yield f"plate {angles} {ratio}", abs(got - wanted), 6e-4 if wanted < 0.95 else 6e-5
    for angles, wanted in (([90], 1.0058), ([90, 0], 1.0059), ([90, 0, 90], 0.9899)):
        got = cases.limit(*[cases.sine_cylinder(n, PUBLISHED, 7, angles) for n in (16, 32)])
        yield f"cylinder {angles}", abs(got - wanted), 6e-5


@check
def piezo_film_on_a_laminate():
    exact = {10: (-1.999276e-9, 4.048267e-11, 0.852, 0.820), 20: (-7.105953e-9, 4.291705e-10, 0.957, 0.929),
             50: (-4.276223e-8, 1.431229e-8, 0.9926, 0.9863), 100: (-1.700922e-7, 2.233537e-7, 0.9980, 0.9964)}
    for span, row in exact.items():
        yield f"exact {span}", np.abs(cases.film_strip_3d(span, cases.pvdf()) / row[:2] - 1).max(), 5e-7
        got = cases.film_strip_ratios(64, PUBLISHED, 7, span, cases.pvdf())
        yield f"element {span}", np.abs(got - row[2:]).max(), 6e-4 if span < 50 else 1.2e-4


@check
def ceramic_on_a_laminate():
    """d33 in a ply that may thicken: nothing in three dimensions, nothing in the improved element."""
    for span, ratio, linear in ((10, 0.83616, 0.83576), (20, 0.95085, 0.95039), (50, 0.99165, 0.99117),
                                (100, 0.99788, 0.99739)):
        plain, thickening = cases.film_strip_3d(span, cases.ceramic(0)), cases.film_strip_3d(span, cases.ceramic(594e-12))
        yield f"exact {span}", abs(thickening[0] / plain[0] - 1), 2.5e-4
        for unknowns in (7, 6):
            got = [cases.film_strip_ratios(64, preset, unknowns, span, cases.ceramic(d33))[0]
                   for preset, d33 in ((IMPROVED, 0), (IMPROVED, 594e-12), (LINEAR_E33, 0))]
            yield f"element with a linear e33 {span}", abs(got[2] - linear), 6e-6
            yield f"element {span}", abs(got[0] - ratio), 6e-6
            yield f"element {span} is nearer to three dimensions", abs(got[0] - 1) / abs(got[2] - 1), 1
            yield f"element {span} with d33", abs(got[1] - got[0]), 2.5e-4


@check
def plies_thicken_freely():
    """Without a normal force a flat package of plies of any Poisson's ratios is that of plane stress, A, B, D."""
    layers = [(0.2, 0, isotropic(63.0, 0.31)),
              (0.5, 30, ply([130, 9, 11, 4.8, 4.4, 3.2, 0.31, 0.02, 0.45])),
              (0.3, 0, isotropic(64.0, 0.1))]
    section = Section(layers)
    plane = [0, 1, 5]
    classic, low = np.zeros((6, 6)), section.zlow
    for thick, angle, material in layers:
        turn = ply_turn(angle)
        c = turn.T @ ply_stiffness(material["constants"]) @ turn
        q = c[np.ix_(plane, plane)] - np.outer(c[plane, 2], c[2, plane]) / c[2, 2]
        for i, x in enumerate((1, 0.5, 1 / 3)):
            part = x * ((low + thick)**(i + 1) - low**(i + 1)) / section.h**i * q
            for a, b in {0: [(0, 0)], 1: [(0, 1), (1, 0)], 2: [(1, 1)]}[i]:
                classic[3 * a:3 * a + 3, 3 * b:3 * b + 3] += part
        low += thick
    order = [0, 2, 6, 1, 3, 7]
    d = section.integrate((0, 0), IMPROVED)[0]
    own = d - np.outer(d[:, 4], d[4]) / d[4, 4]
    yield "plane stress", relative(own[np.ix_(order, order)], classic), 1e-14


@check
def field_across_a_curved_layer():
    """V between the faces; on a cylinder V/(r ln(r2/r1)), on a sphere V r1 r2/(r^2 h)."""
    x, w = np.polynomial.legendre.leggauss(20)
    low, thick = -0.3, 0.5
    for k in ((0.0, 0.0), (0.5, 0.0), (0.0, -0.4), (0.5, 0.5), (0.7, 0.7 + 1e-9), (-0.6, 0.9)):
        share = [field_share(k, low, thick, low + thick * (1 + xi) / 2) for xi in x]
        yield f"volts {k}", abs(w @ share / 2 - 1), 1e-13
    radius = 2.0 + np.array([low, 0.1, low + thick])
    wanted = thick / (radius[1] * np.log(radius[2] / radius[0]))
    yield "cylinder", abs(field_share((0.5, 0.0), low, thick, 0.1) / wanted - 1), 1e-14
    yield "sphere", abs(field_share((0.5, 0.5), low, thick, 0.1) * radius[1]**2 / (radius[0] * radius[2]) - 1), 1e-14


@check
def plate_with_patches():
    known = textdata.read(os.path.join(write_data.DATA, "table7.txt"))[0][2]
    g, e = cases.patch_plate(PUBLISHED), cases.patch_target()
    yield "influence", relative(g, known["influence"]), 2e-6
    volts = np.linalg.lstsq(g, e, rcond=None)[0]
    yield "least squares", relative(volts, known["least_squares"][0]), 1e-6
    damping = 1e-3 * np.trace(g.T @ g) / 25 * np.eye(25)
    yield "Tikhonov", relative(np.linalg.solve(g.T @ g + damping, g.T @ e), known["tikhonov"][0]), 1e-6
    box = known["box_200"][0]
    slope = g.T @ (e - g @ box)
    push = np.where(np.abs(box) > 199.999, np.minimum(slope * np.sign(box), 0), slope)
    yield "box optimality", np.abs(push).max() / np.abs(g.T @ e).max(), 1e-5

    def shape_error(v):
        return np.linalg.norm(g @ v - e) / np.linalg.norm(e)
    yield "error", abs(shape_error(volts) - 0.0554), 6e-5
    yield "error, 200 V", abs(shape_error(box) - 0.090), 6e-4
    yield "error, published volts", abs(shape_error(known["published"][0]) - 0.0706), 6e-5
    yield "condition", abs(np.linalg.cond(g) - 252), 1.0
    pair = [cases.patch_plate(IMPROVED, k) for k in (6, 7)]
    yield "improved, 6 = 7", relative(*pair), 1e-7


def main(checks):
    """Run the checks, print TAP; 1 when one fails."""
    print(f"1..{len(checks)}")
    failed = 0
    for number, function in enumerate(checks, 1):
        results = list(function())
        bad = [r for r in results if not r[1] <= r[2]]
        failed += bool(bad)
        name = function.__name__.replace("_", " ")
        print(f"{'not ok' if bad else 'ok'} {number} {name} ({len(results)} numbers)")
        for what, error, bound in bad:
            print(f"# {what}: {error:.3g}, allowed {bound:.3g}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(CHECKS))
