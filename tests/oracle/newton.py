# SPDX-License-Identifier: BSD-2-Clause
"""Newton's method with independent resultants on a mesh of reference elements.

Every iteration solves
    [ sum L^T D L + sum N A + K_load ] dU = F(U) - sum L^T (D e(U) + H0),     L = de/dU,  A = dL/dU,
where N are not the resultants of U but those extrapolated by the previous iteration,
N = D (e + L dU) + H0.  The first iteration of a step keeps the given resultants H0 (actuation) of
the state it starts from.  All sums run over elements and modes, with the weights in D.
"""

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu

from shellref import KEPT, face_map

ROWS = [(m, k) for m in range(4) for k in KEPT[m]]             # the 22 strains kept


class Kind:
    """Tables of one kind of element: B [22][n], Q [22][n][n], weighted D [22][22]."""

    def __init__(self, el):
        mode, strain = np.array(ROWS).T
        self.B, self.Q = el.B[mode, strain], el.Q[mode, strain]
        self.D = np.zeros((22, 22))
        for m in range(4):
            rows = np.flatnonzero(mode == m)
            self.D[np.ix_(rows, rows)] = el.weights[m] * el.D[m][np.ix_(KEPT[m], KEPT[m])]
        self.area, self.flat = el.area, self.Q.reshape(22, -1)
        self.second = self.Q.transpose(2, 0, 1).reshape(el.size, -1)

    def strains(self, u):
        """e [e][22] and L [e][22][n] at u [e][n]."""
        slope = (u @ self.second).reshape(len(u), 22, -1)
        e = u @ self.B.T + np.einsum("ekn,en->ek", slope, u) / 2
        return e, slope + self.B

    def tangent(self, slope, resultants):
        """sum L^T D L + sum N A [e][n][n]."""
        n = slope.shape[2]
        return slope.transpose(0, 2, 1) @ (self.D @ slope) + (resultants @ self.flat).reshape(-1, n, n)


class Shell:
    """A model with its elements grouped by kind.

    `given` [elements][10]: resultants of actuation per unit load factor (mode 00).
    """

    def __init__(self, model, given=None):
        self.model = model
        self.free = np.flatnonzero(~model.fixed)
        self.groups = []
        for kind in {id(el): el for el in model.elements}.values():
            which = np.array([k for k, el in enumerate(model.elements) if el is kind])
            dofs = np.array([model.dofs[k] for k in which])
            self.groups.append((Kind(kind), which, dofs))
        self.given = [np.zeros((len(which), 22)) for _, which, _ in self.groups]
        if given is not None:
            for (kind, which, _), mine in zip(self.groups, self.given):
                mine[:, :10] = kind.area * given[which]
        n = self.groups[0][2].shape[1]
        self.rows = np.concatenate([np.repeat(d, n, axis=1).ravel() for _, _, d in self.groups])
        self.cols = np.concatenate([np.tile(d, (1, n)).ravel() for _, _, d in self.groups])
        rest, _, _ = self.assemble(np.zeros(model.size), self.zero(), 0)
        self.stiffness = rest
        diagonal = rest.diagonal()[self.free]
        self.scale = 2.0 ** -np.round(np.log2(diagonal) / 2)

    def zero(self):
        """Resultants of the unloaded shell."""
        return [np.zeros((len(which), 22)) for _, which, _ in self.groups]

    def sparse(self, blocks):
        """[size][size] from element matrices, group by group."""
        data = np.concatenate([b.ravel() for b in blocks])
        size = self.model.size
        return coo_matrix((data, (self.rows, self.cols)), shape=(size, size)).tocsc()

    def scatter(self, parts):
        """[size] from element vectors, group by group."""
        out = np.zeros(self.model.size)
        for (_, _, dofs), part in zip(self.groups, parts):
            np.add.at(out, dofs, part)
        return out

    def assemble(self, u, resultants, factor, with_given=None):
        """Tangent holding `resultants` + with_given H0, internal force with factor H0, e and L.

        resultants: list [e][22] a group, weighted, without given; None: those of u.
        """
        with_given = factor if with_given is None else with_given
        matrices, forces, strains = [], [], []
        for g, (kind, _, dofs) in enumerate(self.groups):
            e, slope = kind.strains(u[dofs])
            own = e @ kind.D
            held = own if resultants is None else resultants[g]
            matrices.append(kind.tangent(slope, held + with_given * self.given[g]))
            total = own + factor * self.given[g]
            forces.append(np.einsum("ekn,ek->en", slope, total))
            strains.append((e, slope))
        return self.sparse(matrices), self.scatter(forces), strains

    def actuation(self, u, factor):
        """Nodal force of the given resultants at u."""
        return -self.scatter([np.einsum("ekn,ek->en", kind.strains(u[dofs])[1], factor * given)
                              for (kind, _, dofs), given in zip(self.groups, self.given)])

    def extrapolate(self, strains, du):
        """Weighted D (e + L dU), list [e][22] a group."""
        return [(e + np.einsum("ekn,en->ek", slope, du[dofs])) @ kind.D
                for (kind, _, dofs), (e, slope) in zip(self.groups, strains)]

    def factor(self, matrix, symmetric=True):
        """Sparse factor of the free part, scaled to unit diagonal at rest."""
        s = diags(self.scale)
        scaled = (s @ matrix[self.free][:, self.free] @ s).tocsc()
        if not symmetric:
            return splu(scaled)
        return splu(scaled, permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True), diag_pivot_thresh=0.0)

    def solve(self, matrix, rhs, symmetric=True):
        """dU [size] of matrix dU = rhs."""
        out = np.zeros(self.model.size)
        lu = self.factor(matrix, symmetric)
        out[self.free] = self.scale * lu.solve(self.scale * rhs[self.free])
        return out

    def negative(self, matrix):
        """Number of negative pivots of the (symmetrised) free part."""
        lu = self.factor((matrix + matrix.T) / 2)
        assert (lu.perm_r == lu.perm_c).all()
        return int((lu.U.diagonal() < 0).sum())

    def faces(self, u):
        """Displacements [nodes][7] (or 6) of the faces and u3M."""
        m = self.model
        p = face_map(m.h)[:m.unknowns, :m.unknowns]
        return u.reshape(-1, m.unknowns) @ p.T

    def imbalance(self, force, internal):
        """|F - internal| / |F| over the free unknowns, scaled to unit diagonal at rest."""
        return (np.linalg.norm(self.scale * (force - internal)[self.free])
                / np.linalg.norm(self.scale * force[self.free]))


class State:
    """Displacements, extrapolated resultants and the load factor they belong to."""

    def __init__(self, shell):
        self.u, self.resultants, self.factor = np.zeros(shell.model.size), shell.zero(), 0.0

    def copy(self):
        out = State.__new__(State)
        out.u, out.resultants, out.factor = self.u.copy(), self.resultants, self.factor
        return out


class Failed(Exception):
    """A load step did not converge."""


class Result:
    """What a solution reports: u, systems, steps, residual, negative pivots."""

    def __init__(self, u, systems, steps, residual, negative, history):
        self.u, self.systems, self.steps = u, systems, steps
        self.residual, self.negative, self.history = residual, negative, history
        self.iterations = systems - steps


def external(shell, u, factor, dead, followers):
    """Force [size] and load stiffness (or None) at u."""
    force = factor * dead
    load_stiffness = None
    for follower in followers:
        f, k = follower.evaluate(shell, u, factor)
        force = force + f
        if k is not None:
            load_stiffness = k if load_stiffness is None else load_stiffness + k
    return force, load_stiffness


def step(shell, state, factor, dead, followers=(), eps=1e-4, mixed=12, most=100, norm=None):
    """One load step in place; returns (systems, sizes of the increments relative to the step's)."""
    norm = norm or (lambda du: np.linalg.norm(shell.faces(du)))
    start = state.u.copy()
    sizes = []
    for k in range(most):
        held = state.resultants if k < mixed else None
        kept = state.factor if k == 0 and mixed > 0 else factor
        matrix, internal, strains = shell.assemble(state.u, held, factor, kept)
        force, load_stiffness = external(shell, state.u, factor, dead, followers)
        if load_stiffness is not None:
            matrix = matrix - load_stiffness
        symmetric = all(f.tangent != "exact" for f in followers)
        du = shell.solve(matrix, force - internal, symmetric)
        state.u = state.u + du
        state.resultants = shell.extrapolate(strains, du)
        total = norm(state.u - start)
        sizes.append(norm(du) / total if total > 0 else 0.0)
        if not np.isfinite(sizes[-1]) or not np.isfinite(total) or total > 1e12:
            break
        if sizes[-1] < eps:
            state.factor = factor
            return k + 1, sizes
    raise Failed(f"no convergence in {len(sizes)} systems at factor {factor:g}")


def report(shell, state, dead, followers, systems, steps, history):
    """Result of a converged state: residual and negative pivots of the true tangent."""
    matrix, internal, _ = shell.assemble(state.u, None, state.factor)
    force, load_stiffness = external(shell, state.u, state.factor, dead, followers)
    if load_stiffness is not None:
        matrix = matrix - load_stiffness
    actuation = shell.actuation(state.u, state.factor)
    residual = shell.imbalance(force + actuation, internal + actuation)
    return Result(state.u, systems, steps, residual, shell.negative(matrix), history)


def newton(shell, dead=None, followers=(), steps=1, **options):
    """Equal load steps to factor 1; raises Failed."""
    dead = np.zeros(shell.model.size) if dead is None else dead
    state, systems, history = State(shell), 0, []
    for n in range(steps):
        count, sizes = step(shell, state, (n + 1) / steps, dead, followers, **options)
        systems += count
        history.append(sizes)
    return report(shell, state, dead, followers, systems, steps, history)
