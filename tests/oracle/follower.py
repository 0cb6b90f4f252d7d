# SPDX-License-Identifier: BSD-2-Clause
"""Follower pressure on a face, with its exact or symmetrised load stiffness.

Normal of the deformed face at corner r of an element, in the corner's triad:
    eta = G1 x G2,   G_a = g_a + lam_a(u)      (face tangents, linear in u; the element's own tables).
kind "unit": size p per reference area, direction of the OUTER face's normal, acting on `face`.
kind "true": p per deformed area of `face`.
form "consistent": nodal vectors p eta, interpolated bilinearly, weights area/36 [4 2 1 2].
form "lumped": each corner carries a quarter of the area.  G_a are chords, x = half their angle out of the tangent
    plane; with t = e3 + (w+ - w-)/h the director and g_a3 = g_a . e3,
        U_a = G_a - g_a3 t,  eta = U1 x U2,  side = k1 t x U2 + k2 U1 x t,  k_a = |g_a - g_a3 e3| (1 - x cot x)/x
    eta acts on the face and is divided by its length at rest, times the metric factors c1 c2 of the face for "true": at
    rest exactly p c1 c2 area/4 along e3.  side acts on the middle, divided by the same: the tangential part
    p R tan(...) that makes the pressure on an arc that on its chord, and balances the chords of an inflated ring
    whatever their lengths.  A finite rotation of the mesh turns both exactly.
form "facet": derivative of the volume under the bilinear Cartesian facet ("true" only).
"""

import numpy as np

from shellref import LOAD, NEIGHBOUR


def corner_tangents(el, z_faces, face):
    """Per corner the constants [4][2][3] and matrices [4][2][3][n] of G_a = g_a + lam_a at a face (0 or 1)."""
    w = el.unknowns
    params = el.params
    const, linear = np.zeros((4, 2, 3)), np.zeros((4, 2, 3, el.size))
    for r in range(4):
        for a in (0, 1):
            s, t, g = el.coupling(r, a, params, z_faces)
            q = NEIGHBOUR[a][r]
            const[r, a] = g[face]
            linear[r, a] = s @ face_rows(el, r, face) + t @ face_rows(el, q, face)
    return const, linear


def face_rows(el, node, face):
    """[3][n]: displacement of a face at a corner."""
    out, w = np.zeros((3, el.size)), el.unknowns
    for i in range(3):
        out[i, w * node + i] = 1
        out[i, w * node + 3 + i] = (face - 0.5) * el.h
    return out


def cross_matrix(v):
    """[v x] of v [..., 3]."""
    out = np.zeros(v.shape + (3,))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return out


class Pressure:
    """pressure: function (t1, t2) -> p at load factor 1, positive along +e3."""

    def __init__(self, model, pressure, face, kind="unit", form=None, tangent="symmetrised"):
        """face: 0 inner, 1 outer; form: default consistent for local kinematics, lumped for Cartesian."""
        self.kind, self.tangent = kind, tangent
        self.form = form or ("lumped" if model.elements[0].cartesian else "consistent")
        self.values = np.zeros((len(model.elements), 4))
        for e in range(len(model.elements)):
            t1a, t1b, t2a, t2b = model.cell(e // model.across, e % model.across)
            for r, point in enumerate([(t1a, t2a), (t1b, t2a), (t1b, t2b), (t1a, t2b)]):
                self.values[e, r] = pressure(*point)
        self.tables = {}
        faces = (model.zlow, model.zlow + model.h)
        for el in {id(el): el for el in model.elements}.values():
            self.tables[id(el)] = self.table(el, faces, face, 1 if kind == "unit" else face)
        self.elements = model.elements

    def table(self, el, faces, face, normal_face):
        """Constants and matrices of U1, U2, t [4][3]...; the maps from eta and side [4][3] to the element force [n][4][3]; k."""
        const, linear = np.zeros((4, 3, 3)), np.zeros((4, 3, 3, el.size))
        const[:, :2], linear[:, :2] = corner_tangents(el, faces, normal_face)
        apply, middle, kept = np.zeros((el.size, 4, 3)), np.zeros((el.size, 4, 3)), np.zeros((4, 2))
        for r in range(4):
            const[r, 2] = [0, 0, 1]
            linear[r, 2] = (face_rows(el, r, 1) - face_rows(el, r, 0)) / el.h
            for a in (0, 1) if self.form == "lumped" else ():
                lean, flat = const[r, a, 2], np.hypot(*const[r, a, :2])
                x = np.arctan2(lean, flat)
                kept[r, a] = flat * (1 / x - 1 / np.tan(x)) if x else 0
                const[r, a] -= lean * const[r, 2]
                linear[r, a] -= lean * linear[r, 2]
        for r in range(4):
            rows = face_rows(el, r, face)
            if self.form == "consistent":
                for s in range(4):
                    turn = el.triads[r].T @ el.triads[s] if el.cartesian else np.eye(3)
                    apply[:, s] += el.area * LOAD[r, s] * rows.T @ turn
            elif self.form == "lumped":
                rest = np.linalg.norm(np.cross(*const[r, :2])) if self.kind == "true" else 1.0
                metric = (np.prod([1 + c * faces[face] for c in el.corners[r][3]])
                          if self.kind == "true" else 1.0)
                apply[:, r] += el.area / 4 * metric / rest * rows.T
                middle[:, r] += el.area / 4 * metric / rest * (face_rows(el, r, 0) + face_rows(el, r, 1)).T / 2
        return const, linear, apply, middle, kept

    def evaluate(self, shell, u, factor):
        """Force [size] and, unless tangent is None, its derivative [size][size] (sparse)."""
        forces, blocks = [], []
        for _, which, dofs in shell.groups:
            const, linear, apply, middle, kept = self.tables[id(self.elements[which[0]])]
            g = const + np.einsum("raci,ei->erac", linear, u[dofs])

            def product(a, b):
                """G_a x G_b of all corners, with the director as the third, and its derivative."""
                return (np.cross(g[:, :, a], g[:, :, b]),
                        cross_matrix(g[:, :, a]) @ linear[None, :, b] - cross_matrix(g[:, :, b]) @ linear[None, :, a])
            (eta, d_eta), (one, d_one), (two, d_two) = product(0, 1), product(2, 1), product(0, 2)
            side = kept[:, :1] * one + kept[:, 1:] * two
            d_side = kept[:, :1, None] * d_one + kept[:, 1:, None] * d_two
            if self.kind == "unit":
                size = np.linalg.norm(eta, axis=2)[..., None]
                longer = np.einsum("erc,erci->eri", eta, d_eta)[:, :, None] / size[..., None] ** 2
                d_eta, d_side = ((d - v[..., None] * longer) / size[..., None] for v, d in ((eta, d_eta), (side, d_side)))
                eta, side = eta / size, side / size
            p = factor * self.values[which]
            forces.append(np.einsum("irc,er,erc->ei", apply, p, eta) + np.einsum("irc,er,erc->ei", middle, p, side))
            if self.tangent:
                k = (np.einsum("irc,er,ercj->eij", apply, p, d_eta, optimize=True)
                     + np.einsum("irc,er,ercj->eij", middle, p, d_side, optimize=True))
                blocks.append((k + k.transpose(0, 2, 1)) / 2 if self.tangent == "symmetrised" else k)
        return shell.scatter(forces), shell.sparse(blocks) if self.tangent else None


class FacetPressure:
    """True pressure as the gradient of the volume under the bilinear Cartesian facets of a face."""

    def __init__(self, model, pressure, face, tangent="symmetrised"):
        self.tangent = tangent
        self.inner = Pressure(model, pressure, face, "true", "facet", tangent)
        self.model, self.face = model, face
        self.tables = {}
        gauss = 1 / np.sqrt(3)
        z = model.zlow + face * model.h
        for el in {id(el): el for el in model.elements}.values():
            rows = np.concatenate([el.triads[r] @ face_rows(el, r, face) for r in range(4)])      # global, [12][n]
            rest = np.concatenate([c[0] + z * c[1][:, 2] for c in el.corners])
            points = []
            for x in (-gauss, gauss):
                for y in (-gauss, gauss):
                    n = np.array([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)]) / 4
                    d1 = np.array([-(1 - y), 1 - y, 1 + y, -(1 + y)]) / 4
                    d2 = np.array([-(1 - x), -(1 + x), 1 + x, 1 - x]) / 4
                    points.append([np.kron(v, np.eye(3)) for v in (n, d1, d2)])
            self.tables[id(el)] = rows, rest, points

    def evaluate(self, shell, u, factor):
        forces, blocks = [], []
        for _, which, dofs in shell.groups:
            rows, rest, points = self.tables[id(self.model.elements[which[0]])]
            x = rest + u[dofs] @ rows.T
            f, k = 0, 0
            for n, d1, d2 in points:
                p = factor * self.inner.values[which] @ n[0, ::3]
                g1, g2 = x @ d1.T, x @ d2.T
                f = f + p[:, None] * np.cross(g1, g2) @ (n @ rows)
                d = cross_matrix(g1) @ (d2 @ rows) - cross_matrix(g2) @ (d1 @ rows)
                k = k + p[:, None, None] * ((n @ rows).T @ d)
            forces.append(f)
            if self.tangent:
                blocks.append((k + k.transpose(0, 2, 1)) / 2 if self.tangent == "symmetrised" else k)
        return shell.scatter(forces), shell.sparse(blocks) if self.tangent else None
