# SPDX-License-Identifier: BSD-2-Clause
"""First frequency of thick simply supported plates against the three-dimensional theory of elasticity.

    thick_modes.py PZS

Square plates, ten thicknesses wide, isotropic and of plies [0/90/0] and [0/90] (E1/E2 = 25), on 16 x 16 elements with
`shear: equilibrium`. In a plate that vibrates as u = U(z) cos px sin qy, v = V(z) sin px cos qy, w = W(z) sin px sin qy with
the angular frequency f, the vector (U, V, W, s_xz, s_yz, s_zz) follows a linear differential equation in each ply, whose
solution is a matrix exponential; f is a root of the determinant that leaves both faces free of stress.
"""

import json
import os
import subprocess
import sys
import tempfile

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

RATIO, ELEMENTS, ALLOWED = 10, 16, 0.01
WAVE = np.pi  # one half wave along each side of length 1
PLY = dict(E1=25.0, E2=1.0, E3=1.0, G12=0.5, G13=0.5, G23=0.2, nu12=0.25, nu13=0.25, nu23=0.25)
ISOTROPIC = dict(E1=1.0, E2=1.0, E3=1.0, G12=1 / 2.6, G13=1 / 2.6, G23=1 / 2.6, nu12=0.3, nu13=0.3, nu23=0.3)
PLATES = {"isotropic": (ISOTROPIC, [0]), "[0/90/0]": (PLY, [0, 90, 0]), "[0/90]": (PLY, [0, 90])}


def stiffness(m, angle):
    """Stiffness matrix 6 x 6 in the axes of the plate, Voigt order 11 22 33 23 13 12."""
    s = np.diag([1 / m[k] for k in ("E1", "E2", "E3", "G23", "G13", "G12")])
    for i, j, nu in ((0, 1, "nu12"), (0, 2, "nu13"), (1, 2, "nu23")):
        s[i, j] = s[j, i] = -m[nu] / m[f"E{i + 1}"]
    c = np.linalg.inv(s)
    order = [1, 0, 2, 4, 3, 5] if angle == 90 else range(6)
    return c[np.ix_(order, order)]


def change(c, inertia):
    """Matrix of the derivative along z of (U, V, W, s_xz, s_yz, s_zz); inertia is density times f^2."""
    p = q = WAVE
    stretch = np.array([c[0, 2] * p, c[1, 2] * q, 0, 0, 0, 1]) / c[2, 2]
    s_xx = c[0, 2] * stretch - np.array([c[0, 0] * p, c[0, 1] * q, 0, 0, 0, 0])
    s_yy = c[1, 2] * stretch - np.array([c[0, 1] * p, c[1, 1] * q, 0, 0, 0, 0])
    s_xy = c[5, 5] * np.array([q, p, 0, 0, 0, 0])
    a = np.array([[0, 0, -p, 1 / c[4, 4], 0, 0], [0, 0, -q, 0, 1 / c[3, 3], 0], stretch, q * s_xy - p * s_xx,
                  p * s_xy - q * s_yy, [0, 0, 0, p, q, 0]])
    a[[3, 4, 5], [0, 1, 2]] -= inertia
    return a


def free_faces(f, material, angles):
    """Determinant that vanishes at the frequencies of the plate, of density 1."""
    passed, h = np.eye(6), 1 / (RATIO * len(angles))
    for angle in angles:
        passed = expm(change(stiffness(material, angle), f * f) * h) @ passed
    return np.linalg.det(passed[3:, :3])


def exact(material, angles, near):
    """The angular frequency nearest to a computed one."""
    grid = np.linspace(0.5 * near, 1.5 * near, 101)
    value = [free_faces(f, material, angles) for f in grid]
    roots = [brentq(free_faces, a, b, args=(material, angles)) for a, b, x, y in zip(grid, grid[1:], value, value[1:])
             if x * y < 0]
    return min(roots, key=lambda f: abs(f - near))


def computed(program, material, angles, folder):
    """Angular frequency of the mode in which most of the mass moves along the normal."""
    constants = ", ".join(f"{name}: {value!r}" for name, value in material.items())
    layers = ", ".join(f"{{material: m, thickness: {1 / (RATIO * len(angles))!r}, angle: {angle}}}" for angle in angles)
    held = [", ".join(f"u{k} {part}" for k in (2 - along, 3) for part in ("mean", "difference")) for along in (0, 1)]
    edges = ", ".join(f"{{edge: theta{along + 1}{end}, fix: [{held[along]}]}}" for along in (0, 1) for end in "-+")
    lines = "\n".join(f"  theta{k}: {{from: 0, to: 1, elements: {ELEMENTS}}}" for k in (1, 2))
    path = os.path.join(folder, "plate.yaml")
    with open(path, "w", encoding="ascii") as file:
        file.write(f"name: plate\nelement: {{shear: equilibrium}}\nsurface: {{type: plate}}\nmesh:\n{lines}\n"
                   f"materials: {{m: {{{constants}, density: 1}}}}\nlayers: [{layers}]\nsupports: [{edges}]\n")
    done = subprocess.run([program, "modes", path, "--number", "6", "--json"], stdout=subprocess.PIPE, check=True, text=True)
    found = json.loads(done.stdout)
    best = max(range(6), key=lambda i: found["modes"][i]["effective_mass"][2])
    return 2 * np.pi * found["frequency"][best]


def main():
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for name, (material, angles) in PLATES.items():
            near = computed(sys.argv[1], material, angles, folder)
            error = near / exact(material, angles, near) - 1
            worst = max(worst, abs(error))
            print(f"{name} {100 * error:+.2f} %,", end=" ")
    print(f"{RATIO} thicknesses wide, {ELEMENTS} x {ELEMENTS} elements")
    return worst > ALLOWED


if __name__ == "__main__":
    sys.exit(main())
