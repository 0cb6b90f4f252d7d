# SPDX-License-Identifier: BSD-2-Clause
"""Linear structural cases; each function states its set-up and returns the printed ratio.

Common to all: point loads are split half on each face (a force on the mean unknown),
distributed loads are consistent and split half on each face unless said otherwise,
`preset` is shellref.PUBLISHED or IMPROVED or a variation, displacements are of the
middle surface (u3M = mean u3 + h * seventh unknown).
"""

import numpy as np
from scipy.linalg import expm

import revolution
from model import Model
from shellref import (PUBLISHED, SURFACES, Plate, Section, cylinder, isotropic, ply,
                      ply_stiffness, ply_turn, sphere)

GRAPHITE = ply([25, 1, 1, 0.5, 0.5, 0.2, 0.25, 0.25, 0.25])     # E_T = 1


def scordelis_lo(n, preset, unknowns=7):
    """Roof under its weight, quarter, n x n uniform; vertical displacement / .3024.

    Cylinder R = 25, theta1 axial from midspan 0 to 25, theta2 = angle from the crown 0 to
    40 degrees; h = .25, E = 4.32e8, nu = 0.  theta1-, theta2-: symmetric (normal in-plane
    component of both faces); theta1+: diaphragm (in-plane component along the edge, u3 of
    both faces and middle); theta2+: free.  Load 90 per reference area, vertically down.
    Output: downward displacement at (0, 40 degrees) from mean u2 and u3M.
    """
    m = Model(cylinder(25.0), np.linspace(0, 25, n + 1), np.radians(np.linspace(0, 40, n + 1)),
              Section([(0.25, 0, isotropic(4.32e8, 0))]), preset, unknowns, uniform)
    m.symmetric("theta1-")
    m.symmetric("theta2-")
    m.simple("theta1+")
    down = np.array([-1.0, 0, 0])
    u = m.solve(m.distributed(lambda t1, t2, triad: 90 * triad.T @ down))
    return m.displacement(u, m.node(0, -1)) @ down / 0.3024


def pinched_cylinder(n, preset, unknowns=7):
    """Cylinder between diaphragms, two opposite forces, eighth, n x n; u / 1.8248e-5.

    R = 300, h = 3, E = 3e6, nu = .3; theta1 axial from the loaded section 0 to 300, theta2
    = angle from the load 0 to 90 degrees.  theta1-, theta2-, theta2+: symmetric; theta1+:
    diaphragm.  Force 1/4 inwards at (0, 0); output -u3M there.
    """
    m = Model(cylinder(300.0), np.linspace(0, 300, n + 1), np.radians(np.linspace(0, 90, n + 1)),
              Section([(3.0, 0, isotropic(3e6, 0.3))]), preset, unknowns, uniform)
    for edge in ("theta1-", "theta2-", "theta2+"):
        m.symmetric(edge)
    m.simple("theta1+")
    u = m.solve(m.point(m.node(0, 0), 2, -0.25))
    return -m.middle(u, m.node(0, 0)) / 1.8248e-5


def hemisphere(n, preset, unknowns=7):
    """Hemisphere with an 18 degree hole, quarter, n x n; (-u3M(A)/.093, u3M(B)/.093).

    R = 10, h = .04, E = 6.825e7, nu = .3; theta1 = polar angle 18 to 90 degrees, theta2 =
    azimuth 0 to 90.  theta2-, theta2+: symmetric; theta1 edges free.  Force 1 inwards at
    A (90, 0), 1 outwards at B (90, 90).  Axial motion held by mean u1 at (18, 45 degrees).
    """
    m = Model(sphere(10.0), np.radians(np.linspace(18, 90, n + 1)), np.radians(np.linspace(0, 90, n + 1)),
              Section([(0.04, 0, isotropic(6.825e7, 0.3))]), preset, unknowns, ring)
    m.symmetric("theta2-")
    m.symmetric("theta2+")
    m.fix([m.node(0, n // 2)], [0])
    a, b = m.node(-1, 0), m.node(-1, -1)
    u = m.solve(m.point(a, 2, -1) + m.point(b, 2, 1))
    return -m.middle(u, a) / 0.093, m.middle(u, b) / 0.093


def clamped_plate(n, preset, unknowns=7, nu=0.3):
    """Square plate clamped all round, central force, quarter, n x n; w/(.0056 P L^2/D).

    L = 1, h = .01, E = 1, D = E h^3/(12 (1 - nu^2)); theta1 = x, theta2 = y from the centre
    0 to 1/2.  theta1-, theta2-: symmetric; theta1+, theta2+: all unknowns zero.  Force P/4
    at the centre; output u3M there.
    """
    h = 0.01
    m = Model(Plate(), np.linspace(0, 0.5, n + 1), np.linspace(0, 0.5, n + 1),
              Section([(h, 0, isotropic(1.0, nu))]), preset, unknowns, uniform)
    m.symmetric("theta1-")
    m.symmetric("theta2-")
    m.clamped("theta1+")
    m.clamped("theta2+")
    u = m.solve(m.point(m.node(0, 0), 2, 0.25))
    return m.middle(u, m.node(0, 0)) * h**3 / (12 * (1 - nu**2)) / 0.0056


def uniform(i, j):
    """Every cell is the same element."""
    return 0


def ring(i, j):
    """Cells of one ring of a surface of revolution are the same element."""
    return i


# ---------------------------------------------------------------- against three-dimensional elasticity

def laminate_3d(layers):
    """w at the middle of the simply supported unit square under sin(pi x) sin(pi y) on top.

    layers: (thickness, stiffness [6][6] in the axes of the plate) from below, orthotropic along
    the axes.  State (U, V, W, s33, s13, s23)' = A state in each part; the parts are cut at the
    middle of the package.  Load 1 on the upper face.
    """
    p, middle, total, below = np.pi, None, sum(t for t, _ in layers), 0.0
    state = np.eye(6)
    for thick, c in layers:
        e11, e22 = np.array([-p, 0, 0, 0, 0, 0]), np.array([0, -p, 0, 0, 0, 0])
        e33 = (np.eye(6)[3] - c[0, 2] * e11 - c[1, 2] * e22) / c[2, 2]
        s12 = c[5, 5] * np.array([p, p, 0, 0, 0, 0])
        a = np.array([
            [0, 0, -p, 0, 1 / c[4, 4], 0],
            [0, 0, -p, 0, 0, 1 / c[3, 3]],
            e33,
            [0, 0, 0, 0, p, p],
            -p * (c[0, 0] * e11 + c[0, 1] * e22 + c[0, 2] * e33) + p * s12,
            -p * (c[0, 1] * e11 + c[1, 1] * e22 + c[1, 2] * e33) + p * s12])
        first = min(max(total / 2 - below, 0.0), thick)
        state = expm(a * first) @ state
        if middle is None and below + thick > total / 2 - 1e-12 * total:
            middle = state
        state = expm(a * (thick - first)) @ state
        below += thick
    bottom = np.append(np.linalg.solve(state[3:, :3], [1, 0, 0]), [0, 0, 0])
    return (middle @ bottom)[2]


def plate_3d(side_to_h, material, angles):
    """laminate_3d of plies of equal thickness and one material, at 0 or 90 degrees."""
    turns = [ply_turn(angle) for angle in angles]
    plain = ply_stiffness(material["constants"])
    return laminate_3d([(1 / side_to_h / len(angles), t.T @ plain @ t) for t in turns])


def sandwich_3d(side_to_h, ratio):
    """laminate_3d of faces of E = 1 and a tenth of the height, and a core of 1/ratio; nu = .3."""
    h, face = 1 / side_to_h, ply_stiffness(isotropic(1.0, 0.3)["constants"])
    return laminate_3d([(0.1 * h, face), (0.8 * h, face / ratio), (0.1 * h, face)])


def sine_plate(n, preset, unknowns, side_to_h, material, angles):
    """Simply supported unit square under a sinusoidal load, quarter, n x n; w / plate_3d.

    theta1 = x, theta2 = y from the edges 0 to 1/2; theta1-, theta2-: simple (in-plane
    component along the edge, u3 of both faces and middle); theta1+, theta2+: symmetric.
    Load sin(pi x) sin(pi y) along e3 on the upper face, nodal values interpolated
    bilinearly; output u3M at the centre.  Isotropic nu = .3 (Vlasov) or GRAPHITE
    [0/90/0] of equal plies (Pagano).  The printed ratios are the limits of fine meshes,
    (4 u_2n - u_n)/3 of n = 16 has them to 1e-5.
    """
    h = 1 / side_to_h
    x = np.linspace(0, 0.5, n + 1)
    m = Model(Plate(), x, x, Section([(h / len(angles), a, material) for a in angles]),
              preset, unknowns, uniform)
    for edge in ("theta1-", "theta2-"):
        m.simple(edge)
    for edge in ("theta1+", "theta2+"):
        m.symmetric(edge)
    load = m.distributed(lambda x, y, triad: np.array([0, 0, np.sin(np.pi * x) * np.sin(np.pi * y)]), 0.5)
    return m.middle(m.solve(load), m.node(-1, -1)) / plate_3d(side_to_h, material, angles)


def cylinder_3d(radius, h, length, waves, angles):
    """w at the middle surface, crown of a simply supported cylinder, exact elasticity.

    GRAPHITE plies, inner first, 90 degrees = around.  Pressure sin(pi x/L) cos(waves t) on
    the TRUE inner face, outwards.  u = U cos px cos nt, v = V sin px sin nt, w = W sin px cos nt;
    state (U, V, W, srr, sxr, str)' = A(r) state, stepped by the fourth-order Magnus formula.
    """
    p, n, steps = np.pi / length, waves, 40

    def system(r, c):
        exx, ett = np.array([-p, 0, 0, 0, 0, 0]), np.array([0, n / r, 1 / r, 0, 0, 0])
        err = (np.eye(6)[3] - c[0, 2] * exx - c[1, 2] * ett) / c[2, 2]
        sxx = c[0, 0] * exx + c[0, 1] * ett + c[0, 2] * err
        stt = c[0, 1] * exx + c[1, 1] * ett + c[1, 2] * err
        sxt = c[5, 5] * np.array([-n / r, p, 0, 0, 0, 0])
        return np.array([
            [0, 0, -p, 0, 1 / c[4, 4], 0],
            [0, 1 / r, n / r, 0, 0, 1 / c[3, 3]],
            err,
            stt / r + np.array([0, 0, 0, -1 / r, p, -n / r]),
            -p * sxx - n / r * sxt + np.array([0, 0, 0, 0, -1 / r, 0]),
            p * sxt + n / r * stt + np.array([0, 0, 0, 0, 0, -2 / r])])

    through, middle = np.eye(6), None
    dr = h / len(angles) / steps
    gauss = np.sqrt(3) / 6
    for k in range(steps * len(angles)):
        if 2 * k == steps * len(angles):
            middle = through
        turn = ply_turn(angles[k // steps])
        c = turn.T @ ply_stiffness(GRAPHITE["constants"]) @ turn
        r = radius - h / 2 + k * dr
        a, b = system(r + dr * (0.5 - gauss), c), system(r + dr * (0.5 + gauss), c)
        through = expm(dr / 2 * (a + b) + gauss / 2 * dr**2 * (b @ a - a @ b)) @ through
    bottom = np.append(np.linalg.solve(through[3:, :3], through[3:, 3]), [-1, 0, 0])
    return (middle @ bottom)[2]


def sine_cylinder(n, preset, unknowns, angles):
    """Simply supported laminated cylinder under sinusoidal inner pressure; w / cylinder_3d.

    R = 1, h = .02, L = 4, GRAPHITE, plies of equal thickness listed from the inside, 90 =
    around.  theta1 axial 0 to L/2, theta2 0 to pi/8, n x n; theta1-, theta2+: simple;
    theta1+, theta2-: symmetric.  Load sin(pi x/L) cos(4 t) outwards on the inner face per
    MIDDLE-surface area (per true area: times 1 - h/2R); output u3M at (L/2, 0).  The
    printed ratios are the limits, (4 u_2n - u_n)/3.
    """
    h = 0.02
    m = Model(cylinder(1.0), np.linspace(0, 2, n + 1), np.linspace(0, np.pi / 8, n + 1),
              Section([(h / len(angles), a, GRAPHITE) for a in angles]), preset, unknowns, uniform)
    m.simple("theta1-")
    m.symmetric("theta1+")
    m.symmetric("theta2-")
    m.simple("theta2+")
    load = m.distributed(lambda x, t, triad: np.array([0, 0, np.sin(np.pi * x / 4) * np.cos(4 * t)]), -0.5)
    return m.middle(m.solve(load), m.node(-1, 0)) / cylinder_3d(1.0, h, 4.0, 4, angles)


def limit(coarse, fine):
    """Richardson extrapolation of second order, meshes n and 2 n."""
    return (4 * fine - coarse) / 3


# ---------------------------------------------------------------- bimorphs

PVDF = dict(E=2e9, d31=23e-12)


def bimorph(nu, d32, d33, t):
    """Two layers of thickness t poled oppositely (-3 below, +3 above).

    One volt across both is half a volt on each; the poling of the lower layer is in the
    sign of its piezo constants.
    """
    d = np.array([PVDF["d31"], d32, d33])
    return Section([(t, 0, isotropic(PVDF["E"], nu, d=-d)), (t, 0, isotropic(PVDF["E"], nu, d=d))])


def bimorph_cantilever(n, preset, unknowns=7, groups=1):
    """Strip 100 x 5 x 1 mm, n x 1 elements; model, columns [size][groups] per volt across both.

    theta1 = x along the strip, theta2 = y 0 to 5 mm; theta1-: all unknowns zero; nu = 0,
    d32 = d33 = 0, layers .5 mm.  Electrode g covers the g-th n/groups elements.
    """
    m = Model(Plate(), np.linspace(0, 0.1, n + 1), [0, 0.005], bimorph(0, 0, 0, 0.5e-3),
              preset, unknowns, uniform)
    m.clamped("theta1-")

    def columns(el, i, j):
        out = np.zeros((el.size, groups))
        out[:, i * groups // n] = el.given_force(el.volt.sum(axis=0) / 2)
        return out
    return m, m.gather(columns)


def bimorph_tip(n, preset, unknowns=7):
    """Magnitude of the tip deflection at 1 V across both layers (closed form 3.45e-7)."""
    m, columns = bimorph_cantilever(n, preset, unknowns)
    return m.middle(m.solve(columns[:, 0]), m.node(-1, 0))


def equal_voltages(n, preset, unknowns=7, groups=5):
    """Voltages [groups] for u3M = x^2/2, least squares over the nodes (14492.7536 each)."""
    m, columns = bimorph_cantilever(n, preset, unknowns, groups)
    u = m.solve(columns)
    influence = np.array([m.middle(u, k) for k in range(m.n1 * m.n2)])
    target = np.repeat(m.t1**2 / 2, 2)
    return np.linalg.lstsq(influence, target, rcond=None)[0]


def tip_force_voltages(n, preset, unknowns=7):
    """Five voltages cancelling the deflection of a tip force of 1e-3 N, and the residual.

    Force along +e3, half on each of the two tip nodes.  Least squares over u3M of all
    nodes weighted by their area (half at the ends); residual = norm of what is left / norm
    of the deflection without voltage, same weights.  Continuous least squares of beam
    theory: -1615.397 -1186.347 -884.510 -512.281 -190.444, residual .000526.
    """
    m, columns = bimorph_cantilever(n, preset, unknowns, 5)
    force = m.point(m.node(-1, 0), 2, 0.5e-3) + m.point(m.node(-1, 1), 2, 0.5e-3)
    u = m.solve(np.column_stack([columns, force]))
    shape = np.array([m.middle(u, k) for k in range(m.n1 * m.n2)])
    shape[[0, 1, -2, -1]] *= np.sqrt(0.5)
    volts = np.linalg.lstsq(shape[:, :5], -shape[:, 5], rcond=None)[0]
    return volts, np.linalg.norm(shape @ np.append(volts, 1)) / np.linalg.norm(shape[:, 5])


def open_electrodes(n, preset, unknowns=7, groups=5):
    """Voltages [groups] of open electrodes when the tip is forced to u3M = 10 mm.

    Charge of an electrode Q = f^T u + C V = 0 with f its force column at 1 V across both
    layers and C = eps area/(2 t), eps = 1.062e-10 at constant strain.  Signs are those of
    V = potential at e3 minus potential below: bending towards e3 gives negative voltages.
    Beam theory with back-coupling: 292.351 227.384 162.417 97.450 32.483 in size (with d32
    not zero the coupling through the width would take .7 % off).
    """
    m, columns = bimorph_cantilever(n, preset, unknowns, groups)
    force = m.point(m.node(-1, 0), 2, 0.5) + m.point(m.node(-1, 1), 2, 0.5)
    u = m.solve(np.column_stack([columns, force]))
    capacity = 1.062e-10 * (0.1 / groups * 0.005) / 1e-3
    system = np.zeros((groups + 1, groups + 1))
    system[:groups] = columns.T @ u
    system[:groups, :groups] += capacity * np.eye(groups)
    system[groups] = m.middle(u, m.node(-1, 0))
    return np.linalg.solve(system, np.append(np.zeros(groups), 0.01))[:groups]


def free_bimorph_curvature(n, preset, unknowns=7, nu=0.3, d33=-33e-12):
    """Curvatures (xx, yy) of a free square bimorph, times 4 t^2/(3 d31 V): exactly 1 for any nu, d33.

    a = .1, t = .5 mm, n x n elements; rigid motion held at three corners only: all three
    means and the two (u_a+ - u_a-)/h at (0, 0), u2 at (a, 0).
    """
    t = 0.5e-3
    x = np.linspace(0, 0.1, n + 1)
    m = Model(Plate(), x, x, bimorph(nu, PVDF["d31"], d33, t), preset, unknowns, uniform)
    m.fix([m.node(0, 0)], [0, 1, 2, 3, 4])
    m.fix([m.node(-1, 0)], [1])
    u = m.solve(m.gather(lambda el, i, j: el.given_force(el.volt.sum(axis=0) / 2)))
    origin, scale = m.middle(u, m.node(0, 0)), 4 * t**2 / (3 * PVDF["d31"])
    return [2 * (m.middle(u, m.node(*far)) - origin) / 0.1**2 * scale for far in ((-1, 0), (0, -1))]


# ---------------------------------------------------------------- plate with pairs of patches

def patch_plate(preset, unknowns=7):
    """Influence [121][25] of 25 pairs of patches on a cantilever plate, m/V.

    .2 x .2 m, theta1 = x, theta2 = y, 10 x 10 elements, theta1-: all unknowns zero.  Layers
    from below: patch, AS4/3501 at 90 0 0 90 degrees of .125 mm each, patch; patches .25 mm of
    E = 63 GPa, nu = .3, d31 = d32 = 254e-12, covering 2 x 2 elements each.  Column 5 i + j:
    +1 V on the upper patch (i, j), -1 V on the lower.  Rows: u3M of the nodes 11 i + j.
    """
    composite = ply([144.23e9, 9.65e9, 9.65e9, 4.14e9, 4.14e9, 3.45e9, 0.3, 0.3, 0.3])
    patch = isotropic(63e9, 0.3, d=(254e-12, 254e-12, 0))
    layers = [(0.25e-3, 0, patch), *[(0.125e-3, a, composite) for a in (90, 0, 0, 90)], (0.25e-3, 0, patch)]
    x = np.linspace(0, 0.2, 11)
    m = Model(Plate(), x, x, Section(layers), preset, unknowns, uniform)
    m.clamped("theta1-")

    def columns(el, i, j):
        out = np.zeros((el.size, 25))
        out[:, 5 * (i // 2) + j // 2] = el.given_force(el.volt[5] - el.volt[0])
        return out
    u = m.solve(m.gather(columns))
    return np.array([m.middle(u, n) for n in range(121)])


def patch_target():
    """.1 x (y - .1) at the 121 nodes of patch_plate."""
    x = np.linspace(0, 0.2, 11)
    return np.outer(0.1 * x, x - 0.1).ravel()


# ---------------------------------------------------------------- piezo film on a laminate

def pvdf():
    """The film of 40 um: e31 = .046, e32 = e33 = 0."""
    film = isotropic(2e9, 0.29)
    film["d"] = np.linalg.solve(ply_stiffness(film["constants"])[:3, :3], [0.046, 0, 0])
    return 40e-6, 0, film


def ceramic(d33):
    """A ceramic of .25 mm in its place, d31 = d32 = 254e-12, with any d33."""
    return 0.25e-3, 0, isotropic(63e9, 0.3, d=(254e-12, 254e-12, d33))


def film_strip(span, film):
    """Layers (thickness, angle, material) of the strip, L = span x 3 mm, and L."""
    soft = 6.9e9
    graphite = ply([25 * soft, soft, soft, 0.5 * soft, 0.5 * soft, 0.2 * soft, 0.25, 0.25, 0.25])
    return [*[(1e-3, a, graphite) for a in (0, 90, 0)], film], span * 3e-3


def film_strip_3d(span, film):
    """Deflections at the laminate's middle (z = 1.5 mm): 100 V sin(pi x/L), 1 Pa sin(pi x/L).

    Cylindrical bending, simply supported; E3 = -V/t, stress C d V/t in the film.  State
    (U, W, s33, s13, 1)' = A state, u = U cos px, w = W sin px; load on the film's face.
    """
    layers, length = film_strip(span, film)
    p, through, half = np.pi / length, np.eye(5), None
    for thick, angle, material in layers:
        turn = ply_turn(angle)
        plain = ply_stiffness(material["constants"])
        c, e = turn.T @ plain @ turn, plain[:, :3] @ material["d"] * 100 / thick
        exx, one = np.array([-p, 0, 0, 0, 0]), np.eye(5)[4]
        ezz = (np.eye(5)[2] - c[0, 2] * exx - e[2] * one) / c[2, 2]
        sxx = c[0, 0] * exx + c[0, 2] * ezz + e[0] * one
        a = np.array([[0, -p, 0, 1 / c[4, 4], 0], ezz, [0, 0, 0, p, 0], -p * sxx, np.zeros(5)])
        if angle == 90:
            half = expm(a * thick / 2) @ through
        through = expm(a * thick) @ through
    out = []
    for drive, load in ((1, 0), (0, 1)):
        bottom = np.append(np.linalg.solve(through[2:4, :2], [load, 0] - drive * through[2:4, 4]), [0, 0, drive])
        out.append((half @ bottom)[1])
    return np.array(out)


def film_strip_ratios(n, preset, unknowns, span, film):
    """u3M of the element over film_strip_3d, (100 V, 1 Pa).

    Half strip theta1 = x from the support 0 to L/2, n x 1 elements; theta2 fixed everywhere
    (u2 and its difference), theta1-: u3 of both faces and middle, theta1+: symmetric.
    Reference surface in the middle of the package.  Voltage: sin(pi x/L) at the
    middle of each element; load on the upper face.
    """
    layers, length = film_strip(span, film)
    x = np.linspace(0, length / 2, n + 1)
    m = Model(Plate(), x, [0, length / n], Section(layers), preset, unknowns, uniform)
    m.fix(range(m.n1 * m.n2), [1, 4])
    m.fix(m.edge("theta1-"), [2, 5, 6])
    m.symmetric("theta1+")
    volts = m.gather(lambda el, i, j: 100 * np.sin(np.pi * (x[i] + x[i + 1]) / 2 / length) * el.given_force(el.volt[3]))
    load = m.distributed(lambda t1, t2, triad: np.array([0, 0, np.sin(np.pi * t1 / length)]), 0.5)
    u = m.solve(np.column_stack([volts, load]))
    return m.middle(u, m.node(-1, 0)) / film_strip_3d(span, film)


# ---------------------------------------------------------------- thin shells of revolution

def quarter_of_revolution(surface, t1, harmonic, angles, supports, h, preset):
    """Model over t1 x angles, E = 1, nu = .3, for a load cos(harmonic t2).

    supports: words of the theta1 ends.  theta2-: symmetric; theta2+: symmetric, or simple where
    cos is 0 there.
    """
    m = Model(surface, t1, angles, Section([(h, 0, isotropic(1.0, 0.3))]), preset, 7, ring)
    support = dict(symmetric=m.symmetric, simple=m.simple, clamped=m.clamped,
                   free=lambda edge: None)
    for edge, word in zip(("theta1-", "theta1+"), supports):
        support[word](edge)
    m.symmetric("theta2-")
    odd = abs(np.cos(harmonic * angles[-1])) < 0.5
    support["simple" if odd else "symmetric"]("theta2+")
    return m


def thin_shell(n, preset, name, h):
    """Compliance of a case of revolution.py, a quarter of the circle, n x n.

    Pressure cos(harmonic t2) along e3 on the middle surface, bilinear between its values at the
    nodes as vectors, weights area/36 [4 2 1 2]; displacements refined by Model.solve_thin.
    """
    surface, numbers, span, harmonic, supports = revolution.CASES[name]
    m = quarter_of_revolution(SURFACES[surface](*numbers), np.linspace(*span, n + 1), harmonic,
                              np.linspace(0, np.pi / 2, n + 1), supports, h, preset)
    load = m.distributed(lambda t1, t2, triad: np.array([0, 0, np.cos(harmonic * t2)]))
    return load @ m.solve_thin(load, 4)[0]


def axial_wave(length):
    """Function t -> amplitudes [3] along e1 e2 e3 of a radial pressure cos(pi t/(2 length))."""
    return lambda t: np.array([0, 0, np.cos(np.pi * t / 2 / length)])


def smooth_pressure(meshes, preset, h):
    """Cylinder R = 1 of length 2 between diaphragms, pressure cos(pi x/2) cos 2 t2; w / exact.

    Eighth, n x n for n of `meshes`, theta1 axial from midspan; w at midspan and t2 = 0.  The
    pressure acts by components, as on the published element: radial nodal values are
    interpolated, not vectors.
    """
    surface, supports, pressure = cylinder(1.0), ("symmetric", "simple"), axial_wave(1.0)
    exact = revolution.Harmonic(surface, (0.0, 1.0), h, 2, supports, pressure).q[2]
    ratios = []
    for n in meshes:
        args = (surface, np.linspace(0, 1, n + 1), 2, np.linspace(0, np.pi / 2, n + 1), supports, h)
        load = quarter_of_revolution(*args, PUBLISHED).distributed(
            lambda t1, t2, triad: pressure(t1) * np.cos(2 * t2))
        m = quarter_of_revolution(*args, preset)
        ratios.append(m.middle(m.solve_thin(load, 4)[0], m.node(0, 0)) / exact)
    return ratios


def inextensional_wave(elements, half_waves, preset, harmonic=20, h=1e-7):
    """Compliance / exact of a wave cos(harmonic t2) on a cylinder with diaphragms, R = 1.

    `half_waves` of it over `elements` elements around, so the phase of an element is
    pi half_waves/elements; 32 elements over a half length pi/2.  The circumferential strain and
    the shear are small: the membrane energy is that of e11.
    """
    length = np.pi / 2
    pressure, supports = axial_wave(length), ("symmetric", "simple")
    angles = np.linspace(0, half_waves * np.pi / harmonic, elements + 1)
    m = quarter_of_revolution(cylinder(1.0), np.linspace(0, length, 33), harmonic, angles, supports,
                              h, preset)
    load = m.distributed(lambda t1, t2, triad: pressure(t1) * np.cos(harmonic * t2))
    exact = revolution.Harmonic(cylinder(1.0), (0.0, length), h, harmonic, supports, pressure)
    return load @ m.solve_thin(load, 4)[0] / (exact.compliance * angles[-1] / 2)
