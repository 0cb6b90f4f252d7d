# SPDX-License-Identifier: BSD-2-Clause
"""Reference four-node shell element in numpy, written from the theory alone.

Two elements.  PUBLISHED is GEX7P4 of S. V. Plotnikova's 2013 dissertation on geometrically
exact shell elements.  IMPROVED keeps its strains, modes and unknowns and changes the tables:
Cartesian differences, the warp of the middle surface in the membrane shear, bending bubbles in
the transverse shear compliance, modes by stresses.  Elements lie on lines of curvature.
Nothing here shares code with the library: every array is formed densely, straight from its
formula.

Unknowns of a node (7), in this order, h = z+ - z- the package thickness:
    u1, u2, u3 means of the two faces; (u+ - u-)/h of 1, 2, 3; (u3M - mean u3)/h.
Strains of a point (10), m = mean of the faces, d = e+ - e-:
    11m 11d 22m 22d 33m 33d 12m 12d 13 23, shears engineering (2 e_ab).
Corners r = 0..3: (-,-), (+,-), (+,+), (-,+); modes 00, 01, 10, 11 of xi1^r1 xi2^r2.
Voigt order of plies: 11, 22, 33, 23, 13, 12.
"""

import numpy as np

# tau: share of the warp of the middle surface in the mean of 12 of mode 00.
# rho: share of the bending bubble in the transverse shear compliance.
# torsion: twist of the antisymmetric bubble of modes 01 and 10 (the constant c of its law).
# hr: modes 01, 10, 11 by stresses.   lin33: linear part of e33 eliminated.
# metric: lengths and areas at depth z.   free33: given stresses condensed on s33 = 0 in a ply.
# plies: each ply thickens freely under one normal stress (with lin33).
# quadratic: z^2 in an in-plane strain is replaced by the line that fits it best, weighted with the
# stiffness of the plies; without it by its value at the faces.
PUBLISHED = dict(kinematics="local", tau=0.0, rho=0.0, torsion=0.0, hr=False, lin33=False,
                 metric=False, area="centre", free33=False, plies=False, quadratic=False)
IMPROVED = dict(kinematics="cartesian", tau=1.0, rho=0.09, torsion=0.6, hr=True, lin33=True,
                metric=True, area="exact", free33=True, plies=True, quadratic=True)

XI = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
NEIGHBOUR = np.array([[1, 0, 3, 2], [3, 2, 1, 0]])      # [direction][corner]
MODAL = np.array([np.ones(4), XI[:, 1], XI[:, 0], XI[:, 0] * XI[:, 1]]) / 4
WEIGHT = np.array([1, 1 / 3, 1 / 3, 1 / 9])
KEPT = [list(range(10)), [0, 1, 4, 5, 8], [2, 3, 4, 5, 9], [4, 5]]
# Rows (mode, strain) of the warp after 12d^00: 13^01 23^10 13^00 23^00 11d^00 11d^01 22d^00 22d^10.
WARP_ROWS = [(1, 8), (2, 9), (0, 8), (0, 9), (0, 1), (1, 1), (0, 3), (2, 3)]
LOAD = np.array([[4, 2, 1, 2], [2, 4, 2, 1], [1, 2, 4, 2], [2, 1, 2, 4]]) / 36


# ---------------------------------------------------------------- surfaces

class Plate:
    """theta1 = x, theta2 = y, e3 = +z."""

    def at(self, t1, t2):
        """Position [3], triad [3][3] (columns e1 e2 e3), A [2], k [2], B [2]."""
        return (np.array([t1, t2, 0.0]), np.eye(3),
                np.ones(2), np.zeros(2), np.zeros(2))

    def area(self, cell):
        """Exact area of the cell (t1a, t1b, t2a, t2b)."""
        return (cell[1] - cell[0]) * (cell[3] - cell[2])


class Ring:
    """Cylinder with theta1 the angle and theta2 the axis; e3 outward."""

    def __init__(self, radius):
        self.radius = radius

    def at(self, t1, t2):
        c, s, radius = np.cos(t1), np.sin(t1), self.radius
        triad = np.array([[-s, 0, c], [c, 0, s], [0, 1.0, 0]])
        return (np.array([radius * c, radius * s, t2]), triad,
                np.array([radius, 1.0]), np.array([1 / radius, 0]), np.zeros(2))

    def area(self, cell):
        return self.radius * (cell[1] - cell[0]) * (cell[3] - cell[2])


class Revolution:
    """theta1 along the meridian, theta2 the azimuth; e3 = e1 x e2.

    A meridian is a function t -> (r, r', r'', z, z', z'') with position
    (r cos t2, r sin t2, z);  k1 = (r'' z' - z'' r')/A1^3, k2 = -z'/(A1 r),
    B1 = r'/(A1 r), B2 = 0.
    """

    def __init__(self, meridian):
        self.meridian = meridian

    def at(self, t1, t2):
        r, r1, r2, z, z1, z2 = self.meridian(t1)
        c, s, a1 = np.cos(t2), np.sin(t2), np.hypot(r1, z1)
        triad = np.array([[r1 * c / a1, -s, -z1 * c / a1],
                          [r1 * s / a1, c, -z1 * s / a1],
                          [z1 / a1, 0, r1 / a1]])
        return (np.array([r * c, r * s, z]), triad, np.array([a1, r]),
                np.array([(r2 * z1 - z2 * r1) / a1**3, -z1 / (a1 * r)]),
                np.array([r1 / (a1 * r), 0]))

    def area(self, cell):
        """(t2b - t2a) times the integral of r A1 over t1, 24 Gauss points."""
        x, w = np.polynomial.legendre.leggauss(24)
        half = (cell[1] - cell[0]) / 2
        total = 0.0
        for xi, wi in zip(x, w):
            r, r1, _, _, z1, _ = self.meridian(cell[0] + half * (1 + xi))
            total += wi * half * r * np.hypot(r1, z1)
        return total * (cell[3] - cell[2])


def polar():
    """theta1 = radius, theta2 = angle, e3 = +z."""
    return Revolution(lambda t: (t, 1.0, 0.0, 0.0, 0.0, 0.0))


def cylinder(radius):
    """theta1 axial (downwards), theta2 the angle; e3 outward."""
    return Revolution(lambda t: (radius, 0.0, 0.0, -t, -1.0, 0.0))


def cone(half_angle):
    """theta1 = distance from the apex, theta2 the angle; e3 outward."""
    s, c = np.sin(half_angle), np.cos(half_angle)
    return Revolution(lambda t: (s * t, s, 0.0, -c * t, -c, 0.0))


def sphere(radius):
    """theta1 = polar angle from the pole, theta2 = azimuth; e3 outward."""
    return Revolution(lambda t: (
        radius * np.sin(t), radius * np.cos(t), -radius * np.sin(t),
        radius * np.cos(t), -radius * np.sin(t), -radius * np.cos(t)))


def torus(radius, tube):
    """r = radius + tube cos t1, z = -tube sin t1; e3 away from the tube's axis."""
    return Revolution(lambda t: (
        radius + tube * np.cos(t), -tube * np.sin(t), -tube * np.cos(t),
        -tube * np.sin(t), -tube * np.cos(t), tube * np.sin(t)))


def hyperboloid(waist, slope):
    """r = waist sqrt(1 + slope t1^2), z = -t1; e3 outward."""
    def meridian(t):
        root = np.sqrt(1 + slope * t * t)
        return (waist * root, waist * slope * t / root, waist * slope / root**3,
                -t, -1.0, 0.0)
    return Revolution(meridian)


SURFACES = dict(plate=Plate, polar=polar, cylinder=cylinder, ring=Ring, cone=cone,
                sphere=sphere, torus=torus, hyperboloid=hyperboloid)


# ---------------------------------------------------------------- plies

def isotropic(young, poisson, **more):
    """Ply constants of an isotropic material."""
    shear = young / (2 * (1 + poisson))
    return ply([young] * 3 + [shear] * 3 + [poisson] * 3, **more)


def ply(constants, d=(0, 0, 0), alpha=(0, 0, 0)):
    """constants = E1 E2 E3 G12 G13 G23 nu12 nu13 nu23; d = d31 d32 d33; expansions."""
    return dict(constants=np.array(constants, float), d=np.array(d, float),
                alpha=np.array(alpha, float))


def ply_stiffness(constants):
    """C [6][6] in ply axes, from the orthotropic compliance."""
    e1, e2, e3, g12, g13, g23, n12, n13, n23 = constants
    s = np.zeros((6, 6))
    s[:3, :3] = [[1 / e1, -n12 / e1, -n13 / e1],
                 [-n12 / e1, 1 / e2, -n23 / e2],
                 [-n13 / e1, -n23 / e2, 1 / e3]]
    s[3, 3], s[4, 4], s[5, 5] = 1 / g23, 1 / g13, 1 / g12
    return np.linalg.inv(s)


def ply_turn(angle):
    """T [6][6]: strain in ply axes = T strain; degrees, theta1 towards theta2.

    Exact for multiples of 90 degrees.
    """
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    if angle % 90 == 0:
        c, s = round(c), round(s)
    rot = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    turn = np.zeros((6, 6))
    for j, (a, b) in enumerate(pairs):
        strain = np.zeros((3, 3))
        strain[a, b] += 0.5
        strain[b, a] += 0.5
        turned = rot @ strain @ rot.T
        for i, (p, q) in enumerate(pairs):
            turn[i, j] = turned[p, q] * (1 if p == q else 2)
    return turn


def covariant_map(base):
    """T [6][6]: covariant strains (Voigt) in the base vectors, columns of base [3][3], of a
    Cartesian strain e: base^T e base, shears doubled.
    """
    a, b = np.array([[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])
    same, crossed = base[a][:, a] * base[b][:, b], base[a][:, b] * base[b][:, a]
    doubled = np.array([1, 1, 1, 2, 2, 2])
    return doubled[:, None] * (same + crossed).T / 2


class Section:
    """Stiffness and given resultants through the thickness.

    layers: list of (thickness, angle, material or None for void), from z- to z+.
    zlow: z of the inner face (middle of the package when None).
    """

    def __init__(self, layers, zlow=None):
        self.layers = layers
        self.h = sum(t for t, _, _ in layers)
        self.zlow = -self.h / 2 if zlow is None else zlow
        self.zhigh = self.zlow + self.h

    def base(self, k, options):
        """J(0) and dJ/dz [3][3], columns = base vectors at depth z in the material frame.

        Lines of curvature k [2]: J(z) = diag(1 + k1 z, 1 + k2 z, 1); without metric J = I.
        """
        k1, k2 = k if options["metric"] else (0.0, 0.0)
        return np.eye(3), np.diag([k1, k2, 0.0])

    def height_squared(self, k, options):
        """Lines a + b zeta/h that replace zeta^2 in the strains 11, 22, 12, zeta from the middle:
        a [3], b [3].

        With the option quadratic the least-squares fit weighted with the plane stress stiffness of
        the plies against the strain, along the base vectors of the middle; else h^2/4, 0.
        """
        if not options["quadratic"]:
            return np.array([[self.h**2 / 4] * 3, [0.0] * 3])
        start, slope = self.base(k, options)
        to_plain = np.linalg.inv(covariant_map(start + (self.zlow + self.zhigh) / 2 * slope))
        rows, weights, low = [], [], -self.h / 2
        for thick, angle, material in self.layers:
            x, w = np.polynomial.legendre.leggauss(3)
            if material is not None:
                turn = ply_turn(angle)
                c = to_plain.T @ turn.T @ ply_stiffness(material["constants"]) @ turn @ to_plain
                q = np.diag(c) - c[:, 2]**2 / c[2, 2]
                rows += list((low + thick * (1 + x) / 2) / self.h)
                weights += [wi * thick * q[[0, 1, 5]] for wi in w]
            low += thick
        x = np.array(rows)
        line = np.column_stack([np.ones(len(x)), x])
        fits = [np.linalg.lstsq(root[:, None] * line, root * x**2, rcond=None)[0]
                for root in np.sqrt(weights).T]
        return self.h**2 * np.array(fits).T

    def quadratic_part(self, k, options):
        """m [3][10]: quadratic part of the strains 11, 22, 12 of a curved element at rest, per
        strain of the element.

        Let c be the change of the base with z, in the base of the middle.  A shell with normal
        directors has the covariant strain (1 + z c)^T e(z) (1 + z c) with e linear in z: from
        strain e, slope k and m of the middle m = (c^T k + k c)/2 - c^T e c.  The mean of the
        element is e + a m, its difference h k + b m, with the lines of height_squared.
        """
        out = np.zeros((3, 10))
        if not options["quadratic"]:
            return out
        start, slope = self.base(k, options)
        change = np.linalg.solve(start + (self.zlow + self.zhigh) / 2 * slope, slope)[:2, :2]
        square, line = self.height_squared(k, options)

        def tensor(values):
            return np.array([[values[0], values[2] / 2], [values[2] / 2, values[1]]])

        def vector(t):
            return np.array([t[0, 0], t[1, 1], t[0, 1] + t[1, 0]])
        units = [tensor(unit) for unit in np.eye(3)]
        by_difference = np.array([vector(change.T @ t + t @ change) / 2 for t in units]).T / self.h
        by_mean = np.array([-vector(change.T @ t @ change) for t in units]).T
        whole = np.eye(3) + by_mean * square + by_difference * line
        out[:, [0, 2, 6]] = np.linalg.solve(whole, by_mean)
        out[:, [1, 3, 7]] = np.linalg.solve(whole, by_difference)
        return out

    def integrate(self, k, options):
        """D [10][10], given resultants per volt of each layer [n][10], per kelvin [10].

        With M(z) = T(J(z))^-1 N(z) the Cartesian strains at depth z and w = det J(z)/det J(0):
        D = integral M^T C M w dz,  H0 = integral M^T s0 w dz.
        With the option plies D is that of free_plies.
        Given stress (total stress = C E + s0): volt e^T/h_n from E3 = -V/h_n, with the metric
        times field_share; kelvin -C alpha; with free33 condensed on s33 = 0 in each ply, whose
        mean free strain along the normal, -s0_33/C_33, the mean of e33 then holds, as a strain
        along the third base vector.
        """
        dmat = np.zeros((10, 10))
        volt = np.zeros((len(self.layers), 10))
        kelvin = np.zeros(10)
        thick_volt, thick_kelvin = np.zeros(len(self.layers)), 0.0
        start, slope_of_base = self.base(k, options)
        gauss, weights = np.polynomial.legendre.leggauss(10)
        low, quadratic = self.zlow, self.quadratic_part(k, options)
        line = self.height_squared(k, options)
        plane, normal, compliance = np.zeros((10, 10)), np.zeros(10), 0.0
        for n, (thick, angle, material) in enumerate(self.layers):
            if material is not None:
                turn = ply_turn(angle)
                plain = ply_stiffness(material["constants"])
                stiff = turn.T @ plain @ turn
                given_volt = turn.T @ plain[:, :3] @ material["d"] / thick
                given_kelvin = -turn.T @ plain[:, :3] @ material["alpha"]
                if options["free33"]:
                    slope = stiff[:, 2] / stiff[2, 2]
                    thick_volt[n] = given_volt[2] / stiff[2, 2] * thick / self.h
                    thick_kelvin += given_kelvin[2] / stiff[2, 2] * thick / self.h
                    given_volt = given_volt - slope * given_volt[2]
                    given_kelvin = given_kelvin - slope * given_kelvin[2]
                for x, w in zip(gauss, weights):
                    z = low + thick * (1 + x) / 2
                    base = start + z * slope_of_base
                    strains = self.shape(z, quadratic, line)
                    shape = np.linalg.inv(covariant_map(base)) @ strains
                    dz = w * thick / 2 * np.linalg.det(base) / np.linalg.det(start)
                    dmat += shape.T @ stiff @ shape * dz
                    to_plain = np.linalg.inv(covariant_map(base))
                    own = to_plain.T @ stiff @ to_plain  # along the base vectors
                    pull = own[:, 2] / own[2, 2]
                    plane += strains.T @ (own - np.outer(pull, own[2])) @ strains * dz
                    normal += strains.T @ pull * dz
                    compliance += dz / own[2, 2]
                    volt[n] += shape.T @ given_volt * dz * (
                        self.field(k, low, thick, z) if options["metric"] else 1)
                    kelvin += shape.T @ given_kelvin * dz
            low += thick
        if options["plies"]:
            dmat = free_plies(dmat, plane, normal, compliance)
        along = dmat[:, 4] * start[2, 2]**2
        return dmat, volt + np.outer(thick_volt, along), kelvin + thick_kelvin * along

    def field(self, k, low, thick, z):
        """Electric field at height z over volt/thick."""
        return field_share(k, low, thick, z)

    def shape(self, z, quadratic, line):
        """N [6][10]: Voigt strain at z = N (mean, difference) strains."""
        height = z - (self.zlow + self.zhigh) / 2
        zeta = height / self.h
        shape = np.zeros((6, 10))
        for row, col in ((0, 0), (1, 2), (2, 4), (5, 6)):
            shape[row, col:col + 2] = 1, zeta
        shape[4, 8] = shape[3, 9] = 1
        shape[[0, 1, 5]] += (height**2 - line[0] - line[1] * zeta)[:, None] * quadratic
        return shape


def field_share(k, low, thick, z):
    """Field across a curved layer at height z over V/thick, for curvatures k [2].

    No charge inside: the flux through dA = c1 c2 dA0 is that of every height, and with one
    permittivity E3 = a/(c1 c2).  Its integral over the layer is V:
        a integral dz/(c1 c2) = a ln(1 + (k1 - k2) thick/(c1(low) c2(high)))/(k1 - k2) = V
    On a cylinder V/(r ln(r2/r1)), on a sphere V r1 r2/(r^2 thick).
    """
    bottom, top = 1 + k[0] * low, 1 + k[1] * (low + thick)
    x = (k[0] - k[1]) * thick / (bottom * top)
    mean = (np.log1p(x) / x if x else 1.0) / (bottom * top)
    return 1 / (mean * (1 + k[0] * z) * (1 + k[1] * z))


class GivenSection:
    """A section whose D [10][10] (mean, difference) is given; no actuation."""

    def __init__(self, zlow, zhigh, dmat):
        self.zlow, self.zhigh, self.h, self.dmat = zlow, zhigh, zhigh - zlow, dmat

    def height_squared(self, k, options):
        """As at the faces, whatever the options."""
        return np.array([[self.h**2 / 4] * 3, [0.0] * 3])

    def integrate(self, k, options):
        """As Section.integrate, for any curvature and options."""
        return self.dmat, np.zeros((0, 10)), np.zeros(10)


# ---------------------------------------------------------------- options of the improved element

def free_plies(dmat, plane, normal, compliance):
    """D of plies that thicken freely under one normal stress s, of any e33 but in the mean.

    Mixed form: s (integral e33 dz) + the rest in plane stress, s = normal . E/compliance, with
    normal = integral (C_3./C_33) M dz, compliance = integral dz/C_33, and no linear part of e33;
    that part keeps the compliance which D gives it, uncoupled.
    """
    line = 5
    new = plane + np.outer(normal, normal) / compliance
    new[line] = new[:, line] = 0
    new[line, line] = 1 / np.linalg.inv(dmat)[line, line]
    return new


def uncouple33(dmat, givens):
    """lin33: statically eliminate the linear part l of e33 from the other nine.

    D_oo -= D_ol D_lo/D_ll, D_ol = 0, D_ll = 1/(D^-1)_ll; H0_o -= D_ol H0_l/D_ll, H0_l = 0.
    """
    line = 5
    ratio = dmat[:, line] / dmat[line, line]
    new = dmat - np.outer(ratio, dmat[line])
    new[line] = new[:, line] = 0
    new[line, line] = 1 / np.linalg.inv(dmat)[line, line]
    return new, [given - ratio * given[line] for given in givens]


def bending_flexibility(dmat, h):
    """(f, ft): curvature per moment, the smaller of 11 and 22, and twist per twisting moment.

    From S, the inverse of D's in-plane 6x6 with 33 relaxed:
    f = min(S_11d,11d, S_22d,22d)/h^2, ft = S_12d,12d/h^2.
    """
    plane, thick = [0, 1, 2, 3, 6, 7], [4, 5]
    cond = dmat[np.ix_(plane, plane)] - dmat[np.ix_(plane, thick)] @ np.linalg.solve(
        dmat[np.ix_(thick, thick)], dmat[np.ix_(thick, plane)])
    flex = np.linalg.inv(cond)
    return min(flex[1, 1], flex[3, 3]) / h**2, flex[5, 5] / h**2


def bubble_compliance(chords, flexibility, options):
    """Compliance [4][2] that the bending bubbles add to the shears 13, 23 of each mode.

    Mode 00: rho f L_a^2/12.  In modes 01 (13) and 10 (23) the bubble is antisymmetric across
    the element and must twist as well: divided by 1 + c (f/ft)(L1/L2)^2, 1 + c (f/ft)(L2/L1)^2.
    Mode 11 has no shears.
    """
    bend, twist = flexibility
    plain = options["rho"] * bend * np.square(chords) / 12
    aspect = (chords[0] / chords[1])**2
    twisting = 1 + options["torsion"] * bend / twist * np.array([aspect, 1 / aspect])
    return np.array([plain, plain / twisting, plain / twisting, [0.0, 0.0]])


def modal_stiffness(dmat, chords, flexibility, options):
    """D^m [4][10][10], zero outside the kept strains of each mode.

    Q^T D Q, or with hr [Q^T D^-1 Q]^-1 in modes 01, 10, 11; then bubble_compliance is added to
    the compliance of the mode.
    """
    out = np.zeros((4, 10, 10))
    bubbles = bubble_compliance(chords, flexibility, options)
    for m, kept in enumerate(KEPT):
        block = dmat[np.ix_(kept, kept)]
        if options["hr"] and m > 0:
            block = np.linalg.inv(np.linalg.inv(dmat)[np.ix_(kept, kept)])
        shears = [s for s in (8, 9) if s in kept]
        if options["rho"] and shears:
            flex = np.linalg.inv(block)
            for s in shears:
                i = kept.index(s)
                flex[i, i] += bubbles[m, s - 8]
            block = np.linalg.inv(flex)
        out[m][np.ix_(kept, kept)] = block
    return out


def warp_coefficients(linear, unknowns):
    """c [8] of the rows WARP_ROWS, and the director unknowns left, relative to those of 12d^00.

    linear [4][10][n]: linear strains by plain modes.  12d^00 - sum c_k row_k contains none of
    the eight tangential director unknowns (components 1, 2 of (u+ - u-)/h of the four nodes):
    A c = y with A[:, k] = d row_k/dt, y = d 12d^00/dt.
    """
    directors = [unknowns * r + i for r in range(4) for i in (3, 4)]
    rows = np.array([linear[m, k][directors] for m, k in WARP_ROWS]).T
    twist = linear[0, 7][directors]
    c = np.linalg.pinv(rows) @ twist
    return c, np.abs(twist - rows @ c).max() / np.abs(twist).max()


# ---------------------------------------------------------------- element

def face_map(h):
    """P [7][7]: (u1-,u2-,u3-,u1+,u2+,u3+,u3M) = P (unknowns of a node)."""
    p = np.zeros((7, 7))
    for i in range(3):
        p[i, [i, 3 + i]] = 1, -h / 2
        p[3 + i, [i, 3 + i]] = 1, h / 2
    p[6, [2, 6]] = 1, h
    return p


def strain_map():
    """T [10][10]: strains at the faces (11-,11+,22-,...,12+,13,23) = T (mean, difference)."""
    t = np.eye(10)
    for i in range(0, 8, 2):
        t[i:i + 2, i:i + 2] = [[1, -0.5], [1, 0.5]]
    return t


def sym(p, q):
    """Matrix of the quadratic form sum_i (p_i u)(q_i u) = u^T sym u / 2."""
    return p.T @ q + q.T @ p


class Element:
    """One element on cell = (t1a, t1b, t2a, t2b).

    Modal strains are e_mk = B[m,k] u + u^T Q[m,k] u / 2, exact, [4][10] of them.
    """

    def __init__(self, surface, cell, section, options, unknowns=7):
        """options: PUBLISHED, IMPROVED or a variation; unknowns 7, or 6 (needs lin33).

        chords [2]: L1 = |x2 + x3 - x1 - x4|/2, L2 = |x3 + x4 - x1 - x2|/2 of the corners.
        warp [9]: shares of 12d^00 and of WARP_ROWS in the mean of 12 of mode 00,
        tw (1, -c) with tw = tau (L1^2 k1 + L2^2 k2)/(12 h), k at the parameter centre.
        """
        self.h, self.unknowns, self.size = section.h, unknowns, 4 * unknowns
        t1a, t1b, t2a, t2b = cell
        corners = [(t1a, t2a), (t1b, t2a), (t1b, t2b), (t1a, t2b)]
        self.corners = [surface.at(*c) for c in corners]
        self.triads = [c[1] for c in self.corners]
        self.centre = surface.at((t1a + t1b) / 2, (t2a + t2b) / 2)
        _, _, lame, k, _ = self.centre
        self.params = params = np.array([t1b - t1a, t2b - t2a])
        x = [c[0] for c in self.corners]
        self.chords = chords = np.array([np.linalg.norm(x[1] + x[2] - x[0] - x[3]) / 2,
                                         np.linalg.norm(x[2] + x[3] - x[0] - x[1]) / 2])
        self.cartesian = options["kinematics"] == "cartesian"
        self.area = surface.area(cell) if options["area"] == "exact" else lame.prod() * params.prod()
        self.weights = self.area * WEIGHT

        raw, volt, kelvin = section.integrate(k, options)
        dmat, givens = raw, [*volt, kelvin]
        if options["lin33"]:
            dmat, givens = uncouple33(raw, givens)
        self.D = modal_stiffness(dmat, chords, bending_flexibility(raw, self.h), options)
        self.lines = section.height_squared(k, options)
        self.volt, self.kelvin = np.array(givens[:-1]), givens[-1]

        faces = (section.zlow, section.zhigh)
        nodal = [self.corner_strains(r, params, faces) for r in range(4)]
        self.B = np.einsum("mr,rki->mki", MODAL, np.array([n[0] for n in nodal]))
        self.Q = np.einsum("mr,rkij->mkij", MODAL, np.array([n[1] for n in nodal]))
        self.warp = np.zeros(9)
        if options["tau"]:
            twist = options["tau"] * (chords**2 @ k) / (12 * self.h)
            self.warp_c, self.director_left = warp_coefficients(self.B, unknowns)
            self.warp = twist * np.append(1.0, -self.warp_c)
            self.add_warp()

    def add_warp(self):
        """12m^00 += sum of warp times 12d^00 and WARP_ROWS, in the linear and quadratic parts."""
        for share, (m, k) in zip(self.warp, [(0, 7), *WARP_ROWS]):
            self.B[0, 6] += share * self.B[m, k]
            self.Q[0, 6] += share * self.Q[m, k]

    def coupling(self, r, a, params, faces):
        """S, T [3][3] with lam_a = S u_r + T u_r', and g_a at both faces [2][3].

        local:     T = s/(A_a d_a) I, S = -T + turning of the triad, g = (1 + k_a z) e_a;
        cartesian: T = (s/C) E_r^T E_r', S = -(s/C) I, g = (s/C) E_r^T (X_r' - X_r).
        """
        q, sign = NEIGHBOUR[a][r], -XI[r, a]
        pos, triad, lame, k, b = self.corners[r]
        if self.cartesian:
            far, far_triad = self.corners[q][:2]
            scale = sign / np.linalg.norm(far - pos)
            g = [scale * triad.T @ (far + z * far_triad[:, 2] - pos - z * triad[:, 2]) for z in faces]
            return -scale * np.eye(3), scale * triad.T @ far_triad, np.array(g)
        t = sign / (lame[a] * params[a]) * np.eye(3)
        other, sgn = 1 - a, (1, -1)[a]
        turn = np.zeros((3, 3))
        turn[0, 1], turn[1, 0] = sgn * b[other], -sgn * b[other]
        turn[a, 2], turn[2, a] = k[a], -k[a]
        g = [(1 + k[a] * z) * np.eye(3)[a] for z in faces]
        return turn - t, t, np.array(g)

    def corner_strains(self, r, params, faces):
        """Linear part [10][n] and quadratic part [10][n][n] of the strains at corner r."""
        n, h, w = self.size, self.h, self.unknowns
        square, line = self.lines

        def rows(node, first):
            out = np.zeros((3, n))
            out[range(3), range(w * node + first, w * node + first + 3)] = 1
            return out

        bub = np.zeros((1, n))                       # w = (u3M - mean u3)/h
        if w == 7:
            bub[0, 7 * r + 6] = 1
        d = rows(r, 3)
        lm, ld, gm, gd = [], [], [], []
        for a in (0, 1):
            s, t, g = self.coupling(r, a, params, faces)
            q = NEIGHBOUR[a][r]
            lm.append(s @ rows(r, 0) + t @ rows(q, 0))
            ld.append(s @ d + t @ rows(q, 3))
            gm.append((g[0] + g[1]) / 2)
            gd.append((g[1] - g[0]) / h)

        lin, quad = np.zeros((10, n)), np.zeros((10, n, n))
        for a, m in ((0, 0), (1, 2)):
            lin[m] = gm[a] @ lm[a] + square[a] * gd[a] @ ld[a]
            quad[m] = (sym(lm[a], lm[a]) + square[a] * sym(ld[a], ld[a])) / 2
            lin[m + 1] = h * (gm[a] @ ld[a] + gd[a] @ lm[a]) + line[a] * gd[a] @ ld[a]
            quad[m + 1] = h * sym(lm[a], ld[a]) + line[a] / 2 * sym(ld[a], ld[a])
            lin[8 + a] = gm[a] @ d + lm[a][2] - 2 * h * gd[a][2] * bub[0]
            quad[8 + a] = sym(d, lm[a]) - 2 * h * sym(bub, ld[a][2:])
        lin[4], quad[4] = d[2], (sym(d, d) + 16 * sym(bub, bub)) / 2
        lin[5], quad[5] = -8 * bub[0], -8 * sym(bub, d[2:])
        both, cross = gd[0] @ ld[1] + gd[1] @ ld[0], sym(ld[0], ld[1])
        lin[6] = gm[0] @ lm[1] + gm[1] @ lm[0] + square[2] * both
        quad[6] = sym(lm[0], lm[1]) + square[2] * cross
        lin[7] = h * (gm[0] @ ld[1] + gd[0] @ lm[1] + gm[1] @ ld[0] + gd[1] @ lm[0]) + line[2] * both
        quad[7] = h * (sym(lm[0], ld[1]) + sym(ld[0], lm[1])) + line[2] * cross
        return lin, quad

    def strains(self, u):
        """Modal strains [4][10] at u [n]."""
        return self.B @ u + (self.Q @ u) @ u / 2

    def resultants(self, u):
        """Modal resultants [4][10] without given stresses."""
        return np.einsum("mkl,ml->mk", self.D, self.strains(u))

    def energy(self, u):
        """Strain energy, sum of weight e^T D e / 2."""
        return np.einsum("m,mk,mk->", self.weights, self.strains(u), self.resultants(u)) / 2

    def force(self, u):
        """Internal force [n], gradient of the energy."""
        slope = self.B + self.Q @ u
        return np.einsum("m,mki,mk->i", self.weights, slope, self.resultants(u))

    def tangent(self, u):
        """Derivative of the internal force [n][n]."""
        slope = self.B + self.Q @ u
        return (np.einsum("m,mki,mkl,mlj->ij", self.weights, slope, self.D, slope, optimize=True)
                + np.einsum("m,mk,mkij->ij", self.weights, self.resultants(u), self.Q))

    def stiffness(self):
        """Tangent at rest [n][n]."""
        return np.einsum("m,mki,mkl,mlj->ij", self.weights, self.B, self.D, self.B, optimize=True)

    def given_force(self, given):
        """Nodal force at rest of a given resultant [10] (mode 00): -area B00^T H0."""
        return -self.area * self.B[0].T @ given

    def load(self, vectors, where=0.5, weights=LOAD):
        """Consistent nodal force [n] of a distributed load.

        vectors [4][3]: force per reference area at the corners, components in their
        own triads; where: +.5 on the outer face, -.5 on the inner face, 0 split half on each;
        weights [4][4]: integral of N_r N_s over the element, divided by its area.
        """
        out = np.zeros((4, self.unknowns))
        for r in range(4):
            for s in range(4):
                turn = self.triads[r].T @ self.triads[s] if self.cartesian else np.eye(3)
                out[r, :3] += self.area * weights[r, s] * turn @ vectors[s]
            out[r, 3:6] = where * self.h * out[r, :3]
        return out.ravel()

    def skew_weights(self):
        """integral of N_r N_s j [4][4] over the area, j ~ 1 + alpha1 xi2 + alpha2 xi1.

        alpha [2]: [g_a.g_b] alpha = [g_a.g_h] with g_a = sum xi_a X/4, g_h = sum xi1 xi2 X/4.
        The widths of the element's ends differ; LOAD is the case alpha = 0.
        """
        x = np.array([c[0] for c in self.corners])
        sides, across = XI.T @ x / 4, XI[:, 0] * XI[:, 1] @ x / 4
        alpha = np.linalg.solve(sides @ sides.T, sides @ across)
        even = [(1 + np.outer(XI[:, a], XI[:, a]) / 3) / 2 for a in (0, 1)]
        odd = [(XI[:, [a]] + XI[:, a]) / 6 for a in (0, 1)]
        return (even[0] * even[1] + alpha[0] * even[0] * odd[1] + alpha[1] * odd[0] * even[1]) / 4


def rigid_motion(surface, corners, section, rotation, shift, unknowns=7):
    """Unknowns [4 n] of corner points under X -> rotation X + shift (finite)."""
    out = []
    for c in corners:
        pos, triad = surface.at(*c)[:2]
        faces = [pos + z * triad[:, 2] for z in (section.zlow, section.zhigh)]
        low, high = [triad.T @ (rotation @ x + shift - x) for x in faces]
        out += [*(low + high) / 2, *(high - low) / section.h, 0.0][:unknowns]
    return np.array(out)
