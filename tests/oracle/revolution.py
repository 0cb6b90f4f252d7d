# SPDX-License-Identifier: BSD-2-Clause
"""Naghdi shell of revolution, one circumferential harmonic at a time, by spectral elements.

Reference for thin shells: nothing here knows the four-node element.  The middle surface is
(r cos a, r sin a, z) over the meridian's parameter t, arc length s with ds = A1 dt, e3 as in
shellref.Revolution.  A displacement and a change of the director of harmonic n,
    u1 = u cos na,  u2 = v sin na,  u3 = w cos na,  d1 = b1 cos na,  d2 = b2 sin na,
have with ' = d/ds the surface derivatives (lam of the displacement, mu of the director)
    lam11 = u' + k1 w      lam21 = v'                       lam31 = w' - k1 u
    lam22 = n v/r + r'/r u + k2 w      lam12 = -n u/r - r'/r v      lam32 = -n w/r - k2 v
    mu11 = b1'             mu21 = b2'
    mu22 = n b2/r + r'/r b1            mu12 = -n b1/r - r'/r b2
and the covariant strain at depth z is (1 + k_a z) times the sum of lam and z mu.  Its terms of
order 0 and 1 in z are the eight strains
    e11 = lam11   e22 = lam22   2 e12 = lam12 + lam21
    x11 = mu11 + k1 lam11   x22 = mu22 + k2 lam22   2 x12 = mu12 + mu21 + k1 lam12 + k2 lam21
    g13 = b1 + lam31   g23 = b2 + lam32.

Both the displacements (continuous, degree p on an element) and the eight resultants at its p
Gauss points are unknowns: equilibrium  sum w r B^T S = f,  material  B q = D^-1 S.  This form
neither locks nor loses digits when the shell is thin: D^-1 S of a membrane that hardly strains
is a small term, where a stiffness matrix would subtract large ones.
"""

import numpy as np
from scipy.sparse import bmat, coo_matrix, diags
from scipy.sparse.linalg import splu

from shellref import SURFACES

# Constrained components of (u, v, w, b1, b2) at an end, by the words of the scenes.
SUPPORTS = dict(clamped=(0, 1, 2, 3, 4), simple=(1, 2, 4), symmetric=(0, 3), free=())

# Thin cases: surface and its numbers, t1 start and end, harmonic, supports of the two ends.
# E = 1, nu = .3, pressure cos(n a) along e3; the radius is 1, so h = h/R.
CASES = {
    "cylinder-simple-1": ("cylinder", (1.0,), (0.0, 1.0), 1, ("symmetric", "simple")),
    "cylinder-simple-2": ("cylinder", (1.0,), (0.0, 1.0), 2, ("symmetric", "simple")),
    "cylinder-simple-3": ("cylinder", (1.0,), (0.0, 1.0), 3, ("symmetric", "simple")),
    "cylinder-clamped-2": ("cylinder", (1.0,), (0.0, 1.0), 2, ("symmetric", "clamped")),
    "cylinder-free-2": ("cylinder", (1.0,), (0.0, 1.0), 2, ("symmetric", "free")),
    "cap-clamped-2": ("sphere", (1.0,), (np.pi / 18, np.pi / 3), 2, ("clamped", "clamped")),
    "hyperboloid-clamped-2": ("hyperboloid", (1.0, 1.0), (0.0, 1.0), 2, ("symmetric", "clamped")),
    "hyperboloid-free-2": ("hyperboloid", (1.0, 1.0), (0.0, 1.0), 2, ("symmetric", "free")),
}
THICKNESSES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]


def strain_rows(lame, radius, slope, k, n):
    """(B0, B1) [8][5]: strains = B0 q + B1 dq/dt, q = (u, v, w, b1, b2).

    lame: A1 = ds/dt;  radius r;  slope r' = dr/ds;  k [2] principal curvatures;  n harmonic.
    """
    u, v, w, b1, b2 = np.eye(5)
    lam11, lam21, lam31 = k[0] * w, 0 * v, -k[0] * u
    lam22 = (n * v + slope * u) / radius + k[1] * w
    lam12 = (-n * u - slope * v) / radius
    lam32 = -n * w / radius - k[1] * v
    mu22, mu12 = (n * b2 + slope * b1) / radius, (-n * b1 - slope * b2) / radius
    rows = np.array([lam11, lam22, lam12 + lam21,
                     k[0] * lam11, mu22 + k[1] * lam22, mu12 + k[0] * lam12 + k[1] * lam21,
                     b1 + lam31, b2 + lam32])
    slopes = np.array([u, 0 * u, v, b1 + k[0] * u, 0 * u, b2 + k[1] * v, w, 0 * w]) / lame
    return rows, slopes


def section_stiffness(young, poisson, h, k):
    """D [8][8] of an isotropic shell, plane stress, metric 1 + k_a z, transverse shear G h.

    D = integral M^T C M (1 + k1 z)(1 + k2 z) dz, M(z) = Cartesian from covariant strains.
    """
    plane = young / (1 - poisson**2) * np.array([[1, poisson], [poisson, 1]])
    shear = young / (2 * (1 + poisson))
    dmat = np.zeros((8, 8))
    for x, weight in zip(*np.polynomial.legendre.leggauss(8)):
        z = x * h / 2
        c1, c2 = 1 + k[0] * z, 1 + k[1] * z
        lengths = np.array([c1 * c1, c2 * c2, c1 * c2])
        law = np.zeros((3, 3))
        law[:2, :2], law[2, 2] = plane, shear
        law = law / np.outer(lengths, lengths)
        dz = weight * h / 2 * c1 * c2
        dmat[:6, :6] += np.kron([[1, z], [z, z * z]], law) * dz
        dmat[6:, 6:] += np.diag([shear / c1**2, shear / c2**2]) * dz
    return dmat


def lobatto(degree):
    """The degree + 1 Gauss-Lobatto points on [-1, 1]."""
    inner = np.polynomial.legendre.Legendre.basis(degree).deriv().roots()
    return np.concatenate([[-1.0], np.sort(inner.real), [1.0]])


def lagrange(nodes, points):
    """Values and slopes [points][nodes] of the Lagrange polynomials of the nodes."""
    basis = np.polynomial.legendre.legvander(nodes, len(nodes) - 1)
    values = np.polynomial.legendre.legvander(points, len(nodes) - 1)
    slopes = np.array([np.polynomial.legendre.Legendre.basis(i).deriv()(points)
                       for i in range(len(nodes))]).T
    return values @ np.linalg.inv(basis), slopes @ np.linalg.inv(basis)


def graded_mesh(start, end, width):
    """Breakpoints from start to end that resolve a boundary layer of `width` at both ends."""
    half, step, points = (end - start) / 2, 1.5 * width, [0.0]
    while points[-1] + step < 0.8 * half:
        points.append(points[-1] + step)
        step *= 2
    points = np.array(points)
    return np.concatenate([start + points, [start + half], (end - points)[::-1]])


class Harmonic:
    """Solution of one harmonic: q at the nodes, and the compliance of its load."""

    def __init__(self, surface, span, h, n, supports, load, material=(1.0, 0.3), degree=12,
                 refine=1):
        """surface: shellref.Revolution; span (t start, t end); supports: words of the two ends.

        load(t) -> [3] amplitudes of the force per area along e1 (cos), e2 (sin), e3 (cos);
        material (E, nu); degree of the polynomials; refine: parts of each graded interval.
        Afterwards compliance = integral of load . displacement r A1 dt, with the factor
        integral of cos^2 na over the angle left to the caller.
        """
        _, _, lame, k, _ = surface.at(span[0], 0.0)
        width = np.sqrt(h / np.abs(k).max()) / lame[0]
        breaks = graded_mesh(*span, min(width, (span[1] - span[0]) / 4))
        breaks = np.interp(np.arange(refine * (len(breaks) - 1) + 1) / refine,
                           np.arange(len(breaks)), breaks)
        self.surface, self.h, self.n, self.material, self.load = surface, h, n, material, load
        self.degree, self.nodes = degree, lobatto(degree)
        self.size = 5 * (degree * (len(breaks) - 1) + 1)
        blocks, flexibility, self.force = [], [], np.zeros(self.size)
        for e in range(len(breaks) - 1):
            rows, soft = self.element(e, breaks[e], breaks[e + 1])
            blocks.append(rows)
            flexibility += soft
        fixed = [*SUPPORTS[supports[0]], *(self.size - 5 + c for c in SUPPORTS[supports[1]])]
        self.free = np.setdiff1d(np.arange(self.size), fixed)
        self.solve(blocks, flexibility)

    def element(self, number, start, end):
        """Rows w r A1 B [8 p][size] (sparse) and h^3 w r A1 D^-1 [8][8] at each Gauss point."""
        points, weights = np.polynomial.legendre.leggauss(self.degree)
        values, slopes = lagrange(self.nodes, points)
        half = (end - start) / 2
        dofs = 5 * self.degree * number + np.arange(5 * (self.degree + 1))
        rows, soft = np.zeros((8 * self.degree, len(dofs))), []
        for g, (x, weight) in enumerate(zip(points, weights)):
            t = start + half * (1 + x)
            _, _, (lame, radius), k, b = self.surface.at(t, 0.0)
            area = weight * half * lame * radius
            plain, slope = strain_rows(lame, radius, b[0] * radius, k, self.n)
            rows[8 * g:8 * g + 8] = area * (np.kron(values[g], plain)
                                            + np.kron(slopes[g] / half, slope))
            law = section_stiffness(*self.material, self.h, k)
            soft.append(area * self.h**3 * np.linalg.inv(law))
            self.force[dofs] += area * np.kron(values[g], np.append(self.load(t), [0, 0]))
        index = np.indices(rows.shape)
        return coo_matrix((rows.ravel(), (index[0].ravel(), dofs[index[1].ravel()])),
                          shape=(len(rows), self.size)), soft

    def solve(self, blocks, flexibility):
        """Resultants h^3 S at the Gauss points and q; rows scaled, solution refined twice."""
        rows = bmat([[b] for b in blocks]).tocsc()[:, self.free]
        matrix = bmat([[-self.block_diagonal(flexibility), rows], [rows.T, None]]).tocsc()
        scale = 1 / np.sqrt(abs(matrix).max(axis=1).toarray().ravel())
        scaled = (diags(scale) @ matrix @ diags(scale)).tocsc()
        rhs = scale * np.append(np.zeros(rows.shape[0]), self.force[self.free])
        lu = splu(scaled)
        x = lu.solve(rhs)
        for _ in range(2):
            x += lu.solve(rhs - scaled @ x)
        self.q = np.zeros(self.size)
        self.q[self.free] = (scale * x)[rows.shape[0]:] / self.h**3
        self.compliance = self.force @ self.q

    @staticmethod
    def block_diagonal(blocks):
        """Sparse block-diagonal matrix of [8][8] blocks."""
        count = len(blocks)
        row, col = np.indices((8, 8))
        start = 8 * np.arange(count)[:, None]
        return coo_matrix((np.array(blocks).ravel(),
                           ((start + row.ravel()).ravel(), (start + col.ravel()).ravel())),
                          shape=(8 * count, 8 * count))


def compliance(name, h, degree=12, refine=1):
    """Work of the pressure cos(n a) on its displacement, a case over a quarter of the circle.

    The mean of cos^2 and sin^2 over 0 to 90 degrees is 1/2 for every harmonic.
    """
    surface, numbers, span, n, supports = CASES[name]
    pressure = np.array([0.0, 0.0, 1.0])
    solution = Harmonic(SURFACES[surface](*numbers), span, h, n, supports, lambda t: pressure,
                        degree=degree, refine=refine)
    return np.pi / 4 * solution.compliance
