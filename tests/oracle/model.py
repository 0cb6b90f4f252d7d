# SPDX-License-Identifier: BSD-2-Clause
"""A rectangular mesh of reference elements: assembly, supports, linear solution."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from shellref import Element, XI

CLAMPED = [0, 1, 2, 3, 4, 5, 6]


class Model:
    """Mesh over the grid points t1 x t2; node = i n2 + j, theta2 fastest.

    `same` maps a cell (i, j) to a key; cells of one key share an element (default: none do).
    """

    def __init__(self, surface, t1, t2, section, options, unknowns=7, same=None, closed=False):
        """closed: the last line of t2 is the first one again and carries no nodes of its own."""
        self.surface, self.unknowns = surface, unknowns
        self.t1, self.t2 = np.asarray(t1, float), np.asarray(t2, float)
        self.across = len(self.t2) - 1                     # elements along theta2
        self.n1, self.n2 = len(self.t1), self.across + (not closed)
        self.size = self.n1 * self.n2 * unknowns
        self.fixed = np.zeros(self.size, bool)
        self.h, self.zlow = section.h, section.zlow
        same = same or (lambda i, j: (i, j))
        made = {}
        self.elements, self.dofs = [], []
        for i in range(self.n1 - 1):
            for j in range(self.across):
                key = same(i, j)
                if key not in made:
                    made[key] = Element(surface, self.cell(i, j), section, options, unknowns)
                self.elements.append(made[key])
                nodes = [self.node(i, j), self.node(i + 1, j), self.node(i + 1, j + 1), self.node(i, j + 1)]
                self.dofs.append(np.concatenate([np.arange(unknowns) + unknowns * n for n in nodes]))

    def cell(self, i, j):
        """Corner parameters (t1a, t1b, t2a, t2b)."""
        return self.t1[i], self.t1[i + 1], self.t2[j], self.t2[j + 1]

    def node(self, i, j):
        """Node number; negative indices count from the end."""
        return (i % self.n1) * self.n2 + j % self.n2

    def edge(self, name):
        """Nodes of an edge: theta1-, theta1+, theta2-, theta2+."""
        last = 0 if name[-1] == "-" else -1
        if name.startswith("theta1"):
            return [self.node(last, j) for j in range(self.n2)]
        return [self.node(i, last) for i in range(self.n1)]

    def fix(self, nodes, unknowns):
        """Set unknowns (0..6) of nodes to zero."""
        for n in nodes:
            for k in unknowns:
                if k < self.unknowns:
                    self.fixed[n * self.unknowns + k] = True

    def symmetric(self, edge):
        """Normal in-plane component of both faces."""
        a = 0 if edge.startswith("theta1") else 1
        self.fix(self.edge(edge), [a, 3 + a])

    def simple(self, edge):
        """In-plane component along the edge and u3 of both faces and the middle."""
        a = 1 if edge.startswith("theta1") else 0
        self.fix(self.edge(edge), [a, 3 + a, 2, 5, 6])

    def clamped(self, edge):
        """All unknowns."""
        self.fix(self.edge(edge), CLAMPED)

    def matrix(self):
        """Stiffness at rest, sparse [size][size]."""
        rows, cols, vals = [], [], []
        cache = {}
        for el, dof in zip(self.elements, self.dofs):
            if id(el) not in cache:
                cache[id(el)] = el.stiffness()
            rows.append(np.repeat(dof, len(dof)))
            cols.append(np.tile(dof, len(dof)))
            vals.append(cache[id(el)].ravel())
        return coo_matrix((np.concatenate(vals), (np.concatenate(rows), np.concatenate(cols))),
                          shape=(self.size, self.size)).tocsc()

    def factor(self):
        """Free dofs, scales to unit diagonal, the scaled stiffness at rest and its factor."""
        free = np.flatnonzero(~self.fixed)
        k = self.matrix()[free][:, free]
        scale = 2.0 ** -np.round(np.log2(k.diagonal()) / 2)
        scaled = k.multiply(scale[:, None]).multiply(scale[None, :]).tocsc()
        lu = splu(scaled, permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True),
                  diag_pivot_thresh=0.0)
        return free, scale, scaled, lu

    def solve(self, loads):
        """Displacements for columns of loads [size][n]; scaled to unit diagonal, refined once."""
        free, scale, scaled, lu = self.factor()
        rhs = scale[:, None] * loads.reshape(self.size, -1)[free]
        x = lu.solve(rhs)
        x += lu.solve(rhs - scaled @ x)
        out = np.zeros((self.size, rhs.shape[1]))
        out[free] = scale[:, None] * x
        return out.reshape(loads.shape)

    def solve_thin(self, load, iterations=6):
        """Displacements [size] of a load [size], refined with the residual formed from strains.

        The stiffness of a very thin shell keeps no digit of its bending energy; the strains do.
        Residual load - sum w B^T D B u in extended precision; returns the displacements and the
        size of the last correction relative to them.
        """
        free, scale, _, lu = self.factor()
        tables = {id(el): el.B.reshape(40, -1).astype(np.longdouble) for el in self.elements}
        total, last = np.zeros(self.size, np.longdouble), 0.0
        for _ in range(iterations):
            residual = load.astype(np.longdouble)
            for el, dof in zip(self.elements, self.dofs):
                strain_rows = tables[id(el)]
                strains = (strain_rows @ total[dof]).reshape(4, 10)
                resultants = np.array([w * (d @ e) for w, d, e in zip(el.weights, el.D, strains)])
                residual[dof] -= strain_rows.T @ resultants.ravel()
            step = np.zeros(self.size)
            step[free] = scale * lu.solve(scale * residual[free].astype(float))
            total += step
            last = np.abs(step[free] / scale).max() / np.abs(total[free] / scale).max()
        return total.astype(float), float(last)

    def gather(self, element_force):
        """Sum over elements of element_force(element, i, j) -> [n] or [n][columns]."""
        out = None
        for e, (el, dof) in enumerate(zip(self.elements, self.dofs)):
            f = element_force(el, e // self.across, e % self.across)
            if out is None:
                out = np.zeros((self.size,) + f.shape[1:])
            np.add.at(out, dof, f)
        return out

    def distributed(self, field, where=0.0):
        """Load per reference area; field(t1, t2, triad) -> components in that triad."""
        def element(el, i, j):
            t1a, t1b, t2a, t2b = self.cell(i, j)
            points = [((t1a, t1b)[x > 0], (t2a, t2b)[y > 0]) for x, y in XI]
            return el.load(np.array([field(*p, self.surface.at(*p)[1]) for p in points]), where)
        return self.gather(element)

    def point(self, node, direction, force):
        """Load vector of a force along e_(direction+1) of a node, half on each face."""
        out = np.zeros(self.size)
        out[self.unknowns * node + direction] = force
        return out

    def displacement(self, u, node):
        """Middle-surface displacement of a node in global axes [3]."""
        local = u[self.unknowns * node:self.unknowns * node + 3].copy()
        local[2] = self.middle(u, node)
        return self.surface.at(self.t1[node // self.n2], self.t2[node % self.n2])[1] @ local

    def middle(self, u, node):
        """u3M at a node."""
        base = self.unknowns * node
        bubble = self.h * u[base + 6] if self.unknowns == 7 else 0
        return u[base + 2] + bubble
