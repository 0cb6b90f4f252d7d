# SPDX-License-Identifier: BSD-2-Clause
"""Reference of the improved element on any quadrilateral, in numpy, from nodes and directors.

No surface, no parameter plane: corner positions X_r, unit directors D_r, triads with e3 = D_r,
plies with respect to a direction that is projected on the element.  xi1, xi2 in [-1, 1], corners
(-,-) (+,-) (+,+) (-,+).  With c(v; p, q) = 1/4 sum_r xi1_r^p xi2_r^q v_r:

    g_1 = c(X; 1, 0), g_2 = c(X; 0, 1), g_h = c(X; 1, 1), d_a alike from D,  L_a = 2 |g_a|,
    alpha_a = g_h . g^a (dual base), r = L_2/L_1,
    B_ab = 2 (g_a . d_b + g_b . d_a)/(L_a L_b).

Everything else (strains of a corner, bubbles, condensations) is shared with shellref.py.
"""

import numpy as np

import shellref
from shellref import IMPROVED, MODAL, NEIGHBOUR, WARP_ROWS, WEIGHT, XI, Section

# Natural coordinates of the middles of the sides 01, 12, 23, 30.
MIDDLES = np.array([[0, -1], [1, 0], [0, 1], [-1, 0]])
# Constants of the rule for thin irregular meshes: share of rho, gate of asymptotic elements.
ROUGH, THIN = 3.0, 16.0


def monomials(x, y):
    """The eight functions of a serendipity quadrilateral and their slopes [3][8]."""
    one, zero = np.ones_like(x), np.zeros_like(x)
    return np.array([[one, x, y, x * y, x * x, y * y, x * x * y, x * y * y],
                     [zero, one, zero, y, 2 * x, zero, 2 * x * y, y * y],
                     [zero, zero, one, x, zero, 2 * y, x * x, 2 * x * y]])


def curved_area(corners, directors):
    """Area of the surface through corners and bent sides, 3 x 3 Gauss points.

    The middle of a side is that of a cubic whose ends are tangent to the surface: the chord's
    middle plus an eighth of the difference of the chord's projections on the end tangent planes.
    """
    points = list(corners)
    for r in range(4):
        s = (r + 1) % 4
        chord = corners[s] - corners[r]
        tangent = [chord - (chord @ d) * d for d in (directors[r], directors[s])]
        points.append((corners[r] + corners[s]) / 2 + (tangent[0] - tangent[1]) / 8)
    places = np.vstack([XI, MIDDLES]).astype(float)
    values = monomials(places[:, 0], places[:, 1])[0].T
    factors = np.linalg.solve(values, np.array(points))
    area = 0.0
    for x, wx in zip(*np.polynomial.legendre.leggauss(3)):
        for y, wy in zip(*np.polynomial.legendre.leggauss(3)):
            _, along, across = monomials(np.array(x), np.array(y))
            area += wx * wy * np.linalg.norm(np.cross(along @ factors, across @ factors))
    return area


class QuadSection(Section):
    """Plies whose axes are those of the element's material; base vectors J + z J'."""

    def place(self, base, slope):
        """Set the columns of the base [3][3] in material axes, and their change with z."""
        self.start, self.slope = base, slope

    def base(self, k, options):
        return self.start, self.slope if options["metric"] else 0 * self.slope

    def field(self, k, low, thick, z):
        """Electric field at z over volt/thick: the flux through the growing area is constant."""
        ratio = lambda t: np.linalg.det(self.start + t * self.slope) / np.linalg.det(self.start)
        x, w = np.polynomial.legendre.leggauss(20)
        mean = sum(wi / 2 / ratio(low + thick * (1 + xi) / 2) for xi, wi in zip(x, w))
        return 1 / (mean * ratio(z))


class QuadElement(shellref.Element):
    """One quadrilateral.

    corners, directors, axes [4][3] (axes: e1 of each corner, normal to its director);
    direction [3]: projected on the element, axis 1 of the plies; 0: direction 1 of the element.
    """

    def __init__(self, corners, directors, axes, section, direction=(0, 0, 0), options=IMPROVED,
                 unknowns=7, area=None):
        self.h, self.unknowns, self.size = section.h, unknowns, 4 * unknowns
        self.cartesian = True
        self.middle = (section.zlow + section.zhigh) / 2
        x, d = np.array(corners, float), np.array(directors, float)
        self.triads = [np.array([e, np.cross(n, e), n]).T for e, n in zip(np.array(axes, float), d)]
        self.corners = list(zip(x, self.triads))
        self.centre_geometry(x, d)
        self.area = curved_area(x, d) if area is None else area
        self.material(np.array(direction, float), section)
        self.rule(options)

        raw, volt, kelvin = section.integrate(None, options)
        dmat, givens = shellref.uncouple33(raw, [*volt, kelvin])
        bent = shellref.bending_flexibility(raw, self.h)
        self.D = shellref.modal_stiffness(dmat, self.chords, bent,
                                          dict(options, rho=options["rho"] * self.share))
        self.volt, self.kelvin = np.array(givens[:-1]), givens[-1]
        self.lines = section.height_squared(None, options)
        self.weights = self.area * np.array([1, 1 / (3 - self.alpha[0]**2),
                                             1 / (3 - self.alpha[1]**2), WEIGHT[3]])
        faces = (section.zlow, section.zhigh)
        nodal = [self.corner_strains(r, None, faces) for r in range(4)]
        self.B = np.einsum("mr,rki->mki", MODAL, np.array([n[0] for n in nodal]))
        self.Q = np.einsum("mr,rkij->mkij", MODAL, np.array([n[1] for n in nodal]))
        self.find_warp(options)
        self.add_warp()
        self.correct_modes(self.B)
        self.correct_modes(self.Q)

    def centre_geometry(self, x, d):
        """Base, hourglass vector, alpha, curvatures at the centre."""
        xi1, xi2 = XI.T
        self.g = np.array([xi1 @ x, xi2 @ x]) / 4
        self.d = np.array([xi1 @ d, xi2 @ d]) / 4
        across = (xi1 * xi2) @ x / 4
        self.chords = 2 * np.linalg.norm(self.g, axis=1)
        self.alpha = np.linalg.lstsq(self.g.T, across, rcond=None)[0]
        self.ratio = self.chords[1] / self.chords[0]
        product = self.g @ self.d.T
        self.bend = 2 * (product + product.T) / np.outer(self.chords, self.chords)
        self.director = d.sum(0) / np.linalg.norm(d.sum(0))

    def material(self, direction, section):
        """Base vectors in the axes of the plies; axis 3 is normal to g_1 and g_2."""
        normal = np.cross(*self.g)
        normal = normal / np.linalg.norm(normal)
        first = direction - (direction @ normal) * normal
        if not np.linalg.norm(first) > 1e-6 * np.linalg.norm(direction):
            first = self.g[0]
        first = first / np.linalg.norm(first)
        axes = np.array([first, np.cross(normal, first), normal])
        base = np.column_stack([2 * self.g[0] / self.chords[0], 2 * self.g[1] / self.chords[1],
                                self.director])
        slope = np.column_stack([2 * self.d[0] / self.chords[0], 2 * self.d[1] / self.chords[1],
                                 np.zeros(3)])
        section.place(axes @ base, axes @ slope)

    def rule(self, options):
        """Share of rho, and gate of the elements along asymptotic lines."""
        lengths = np.outer(self.chords, self.chords)
        thin = np.abs(self.bend * lengths).max() / self.h
        rough = np.abs(self.alpha).sum()
        self.share = 1 / (1 + (rough * thin / ROUGH)**2)
        twist = self.bend[0, 1]**2
        self.gate = 0.0
        if twist * lengths[0, 0] > 1e-12:
            gate = max(0.0, 1 - 2 * abs(self.bend[0, 0] * self.bend[1, 1]) / twist)
            self.gate = options["tau"] * gate * self.share / (1 + (thin / THIN)**2)

    def coupling(self, r, a, params, faces):
        """S, T [3][3] and the base vectors at both faces [2][3], with one length L_a."""
        q = NEIGHBOUR[a][r]
        scale = -XI[r, a] / self.chords[a]
        (here, triad), (there, other) = self.corners[r], self.corners[q]
        g = [scale * triad.T @ (there + z * other[:, 2] - here - z * triad[:, 2]) for z in faces]
        return -scale * np.eye(3), scale * triad.T @ other, np.array(g)

    def find_warp(self, options):
        """Shares [9] of 12d^00 and of WARP_ROWS in the mean of 12, mode 00."""
        twist = options["tau"] * np.diag(self.bend) @ self.chords**2 / (12 * self.h)
        self.warp = np.zeros(9)
        if twist:
            self.warp_c, self.director_left = shellref.warp_coefficients(self.B, self.unknowns)
            self.warp = twist * np.append(1.0, -self.warp_c)
        self.warp[[5, 7]] += self.gate * self.bend[0, 1] * self.chords**2 / (6 * self.h)

    def correct_modes(self, y):
        """Modes 01 and 10 orthogonal to constant strains, in place; y [4][10][...]."""
        (a1, a2), r = self.alpha, self.ratio
        for m in (0, 1):
            e11, e22, e12, e33 = y[0, m], y[0, 2 + m], y[0, 6 + m], y[0, 4 + m]
            excess = (a1 * (y[1, m] - a1 * e11) + a2 * r * (r * (y[2, 2 + m] - a2 * e22) - a1 * e12)
                      ) / (1 - a1**2 - a2**2)
            e11 -= excess
            e22 -= excess / r**2
            y[1, m] -= 2 * a1 * e11 + a2 * r * e12
            y[2, 2 + m] -= 2 * a2 * e22 + a1 / r * e12
            e33 += (a1 * y[1, 4 + m] + a2 * y[2, 4 + m]) / 3
        y[1, 8] -= a1 * y[0, 8] + a2 * r * y[0, 9]
        y[2, 9] -= a1 / r * y[0, 8] + a2 * y[0, 9]

    def load_weights(self):
        """integral of N_r N_s j over the area [4][4], by 2 x 2 Gauss points."""
        out, x = np.zeros((4, 4)), 1 / np.sqrt(3)
        for s, t in XI * x:
            shape = (1 + XI[:, 0] * s) * (1 + XI[:, 1] * t) / 4
            out += np.outer(shape, shape) * (1 + self.alpha[0] * t + self.alpha[1] * s) / 4
        return out


def rigid(element, rotation, shift):
    """Unknowns [n] of the finite motion X -> rotation X + shift."""
    out = []
    for corner, triad in element.corners:
        x = corner + element.middle * triad[:, 2]
        out += [*(triad.T @ (rotation @ x + shift - x)),
                *(triad.T @ (rotation @ triad[:, 2] - triad[:, 2])), 0.0][:element.unknowns]
    return np.array(out)
