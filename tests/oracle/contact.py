# SPDX-License-Identifier: BSD-2-Clause
"""Frictionless contact of a face with a rigid body: a primal-dual active set inside the mixed Newton.

Per node: weight w = sum area/4, multiplier L <= 0 (force per area), flag, stiffness
e = kappa K0[u3 of the face]/w.  One iteration at the moved points, g the signed distance (positive
outside the body), n its gradient:
    active where L + c g < 0, c = 1e-6 e  (the first iteration: the given flags, or g <= 0);
    f -= w (L + e g) n,   K += w (L Hess g + e n n^T);     solve;     L += e (g + n . d) where active, else 0.
Nodes whose deformed normal points away from the body (eta . n >= 0) are never active.
"""

import numpy as np
from scipy.sparse import coo_matrix

from follower import corner_tangents
from newton import Failed, Result, State, external
from shellref import face_map


class PlaneBody:
    """Body behind a plane: outside where (x - point) . normal > 0."""

    def __init__(self, point, normal):
        self.point, self.normal = np.array(point, float), np.array(normal, float)

    def distance(self, x):
        """g [k], gradient [k][3], Hessian [k][3][3] at x [k][3]."""
        return (x - self.point) @ self.normal, np.tile(self.normal, (len(x), 1)), np.zeros((len(x), 3, 3))


class RoundBody:
    """Cylinder of given axis, or sphere (axis None), outside where farther than the radius."""

    def __init__(self, point, radius, axis=None):
        self.point, self.radius = np.array(point, float), radius
        self.across = np.eye(3) if axis is None else np.eye(3) - np.outer(axis, axis)

    def distance(self, x):
        """g [k], gradient [k][3], Hessian [k][3][3] at x [k][3]."""
        v = (x - self.point) @ self.across
        size = np.linalg.norm(v, axis=1)
        n = v / size[:, None]
        return size - self.radius, n, (self.across - n[:, :, None] * n[:, None, :]) / size[:, None, None]


class Contact:
    """A face of a shell against a body; body: function of the load factor -> body."""

    def __init__(self, shell, body, face=1, kappa=1.0):
        m = self.model = shell.model
        self.shell, self.face = shell, face
        self.body = body if callable(body) else lambda factor: body
        count = m.n1 * m.n2
        self.weight = np.zeros(count)
        faces, normal = (m.zlow, m.zlow + m.h), {}
        self.normals = []
        for _, which, dofs in shell.groups:
            el = m.elements[which[0]]
            nodes = dofs[:, ::m.unknowns] // m.unknowns
            np.add.at(self.weight, nodes, el.area / 4)
            self.normals.append((nodes, dofs) + corner_tangents(el, faces, face))
        at = [m.surface.at(m.t1[n // m.n2], m.t2[n % m.n2]) for n in range(count)]
        self.triad = np.array([a[1] for a in at])
        self.point = np.array([a[0] for a in at]) + faces[face] * self.triad[:, :, 2]
        inverse = np.linalg.inv(face_map(m.h)[:m.unknowns, :m.unknowns])[:, 5 if face else 2]
        k0, w = shell.stiffness.tocsr(), m.unknowns
        blocks = [inverse @ k0[w * n:w * n + w][:, w * n:w * n + w] @ inverse for n in range(count)]
        self.stiffness = kappa * np.array(blocks) / self.weight
        rows = np.zeros((3, w))                                   # displacement of the face, local
        rows[range(3), range(3)] = 1
        rows[range(3), range(3, 6)] = (face - 0.5) * m.h
        self.rows = self.triad @ rows                             # global [nodes][3][unknowns]
        self.multiplier, self.active = np.zeros(count), np.zeros(count, bool)

    def copy(self):
        return self.multiplier.copy(), self.active.copy()

    def restore(self, saved):
        self.multiplier, self.active = saved[0].copy(), saved[1].copy()

    def geometry(self, u, factor):
        """g (infinite where the face looks away), n, Hessian at the moved points."""
        moved = self.point + np.einsum("nci,ni->nc", self.rows, u.reshape(len(self.point), -1))
        g, n, hess = self.body(factor).distance(moved)
        eta = np.zeros((len(g), 3))
        for nodes, dofs, const, linear in self.normals:
            tangents = const + np.einsum("raci,ei->erac", linear, u[dofs])
            np.add.at(eta, nodes, np.cross(tangents[:, :, 0], tangents[:, :, 1]))
        toward = np.einsum("nij,nj,ni->n", self.triad, eta, n) * (2 * self.face - 1)
        return np.where(toward < 0, g, np.inf), n, hess

    def wanted(self, g, keep_one):
        """Flags of the active set."""
        test = np.where(np.isfinite(g), self.multiplier + 1e-6 * self.stiffness * g, 1.0)
        flags = test < 0
        if not flags.any() and keep_one:
            flags[np.argmin(g)] = True
        return flags

    def terms(self, g, n, hess):
        """Force [size] and stiffness (sparse) of the active nodes."""
        a = np.flatnonzero(self.active)
        w, e, pressure = self.weight[a], self.stiffness[a], self.multiplier[a]
        rows, u = self.rows[a], self.model.unknowns
        push = -(w * (pressure + e * g[a]))[:, None] * n[a]
        force = np.zeros(self.model.size)
        dofs = u * a[:, None] + np.arange(u)
        force[dofs] = np.einsum("kci,kc->ki", rows, push)
        core = w[:, None, None] * (pressure[:, None, None] * hess[a]
                                   + e[:, None, None] * n[a][:, :, None] * n[a][:, None, :])
        blocks = rows.transpose(0, 2, 1) @ core @ rows
        i, j = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        size = self.model.size
        return force, coo_matrix((blocks.ravel(), (i.ravel(), j.ravel())), shape=(size, size)).tocsc()

    def advance(self, g, n, du):
        """Multipliers predicted by the solution du."""
        a = self.active
        d = np.einsum("nci,ni->nc", self.rows, du.reshape(len(g), -1))
        self.multiplier = np.where(a, self.multiplier + self.stiffness * (np.where(a, g, 0) + (n * d).sum(1)), 0.0)

    def resultant(self, u, factor):
        """Total force on the shell [3]."""
        _, n, _ = self.geometry(u, factor)
        return -(self.weight * self.multiplier) @ n


def contact_step(shell, contact, state, factor, dead, followers=(), eps=1e-6, most=40, free=True, delay=None, mixed=None):
    """One load step in place; returns the number of systems; raises Failed.

    delay: flags change only while |d|/|dU| < delay.
    """
    start = state.u.copy()
    moved_at_all = state.factor > 0 or contact.active.any()
    ratio = 1.0
    size = np.abs(contact.point).max()
    for k in range(most):
        g, n, hess = contact.geometry(state.u, factor)
        before = contact.active.copy()
        if k == 0:
            contact.active = contact.active & np.isfinite(g) if moved_at_all else (g <= 1e-9 * size)
        elif delay is None or ratio < delay:
            contact.active = contact.wanted(g, free)
        changed = k > 0 and (before != contact.active).any()
        contact.multiplier = np.where(contact.active, contact.multiplier, 0.0)
        held = state.resultants if mixed is None or k < mixed else None
        matrix, internal, strains = shell.assemble(state.u, held, factor, state.factor if k == 0 else factor)
        force, load_stiffness = external(shell, state.u, factor, dead, followers)
        push, stiff = contact.terms(g, n, hess)
        matrix = matrix + stiff - (0 if load_stiffness is None else load_stiffness)
        du = shell.solve(matrix, force + push - internal, all(f.tangent != "exact" for f in followers))
        state.u = state.u + du
        state.resultants = shell.extrapolate(strains, du)
        contact.advance(g, n, du)
        total = np.linalg.norm(shell.faces(state.u - start))
        ratio = np.linalg.norm(shell.faces(du)) / total
        if not np.isfinite(ratio) or total > 1e12:
            break
        if ratio < eps and not changed:
            g, n, _ = contact.geometry(state.u, factor)
            a = contact.active
            if (contact.wanted(g, free) == a).all() and (not a.any() or np.abs(g[a]).max() < 1e-8 * size):
                state.factor = factor
                return k + 1
    raise Failed(f"no convergence in {k + 1} systems at factor {factor:g}")


def contact_newton(shell, contact, dead=None, followers=(), steps=1, cuts=6, **options):
    """Load steps with halving after a failure; Result with `contact` solved in place."""
    dead = np.zeros(shell.model.size) if dead is None else dead
    state, systems, taken, wasted, width = State(shell), 0, 0, 0, 1 / steps
    smallest = width / 2**cuts
    while state.factor < 1 - 1e-12:
        saved, flags = state.copy(), contact.copy()
        factor = min(1.0, state.factor + width)
        try:
            systems += contact_step(shell, contact, state, factor, dead, followers, **options)
            taken += 1
            width = min(2 * width, 1 / steps)
        except (Failed, RuntimeError, np.linalg.LinAlgError):
            state = saved
            contact.restore(flags)
            wasted += options.get("most", 40)
            width /= 2
            if width < smallest:
                raise
    result = contact_report(shell, contact, state, dead, followers, systems + wasted, taken)
    result.state = state
    return result


def contact_report(shell, contact, state, dead, followers, systems, steps):
    """Residual and negative pivots of the converged state."""
    g, n, hess = contact.geometry(state.u, state.factor)
    push, stiff = contact.terms(g, n, hess)
    matrix, internal, _ = shell.assemble(state.u, None, state.factor)
    force, load_stiffness = external(shell, state.u, state.factor, dead, followers)
    matrix = matrix + stiff - (0 if load_stiffness is None else load_stiffness)
    scale = lambda f: np.linalg.norm(shell.scale * f[shell.free])
    residual = scale(force + push - internal) / max(scale(force), scale(push))
    return Result(state.u, systems, steps, residual, shell.negative(matrix), [])
