# SPDX-License-Identifier: BSD-2-Clause
"""Natural frequencies of a plate and of a cylinder panel, against CalculiX *FREQUENCY.

    frequencies.py [--build FOLDER]

Both programs solve meshes of the same structure until the frequencies have converged: this program's improved element with
its usual mass, CalculiX's shell S8R. Printed are the first six frequencies on the finest mesh of each, the difference of
this program's from CalculiX's, and what the last refinement moved them by. The times are processor times of each program
for everything it does, in one thread, for the coarsest mesh of each whose six frequencies are all within a stated error of
CalculiX's finest ones.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
from math import cos, pi, sin

from mesh_file import say, timed

MODES = 6
WITHIN = (0.02, 0.005)

# Structures of one material with one clamped edge; lengths in m. The panel is the curved fan blade of Olson and Lindberg.
STRUCTURES = {
    "plate": dict(length=0.4, width=0.3, radius=None, thickness=2e-3, E=70e9, nu=0.3, density=2700.0),
    "panel": dict(length=0.3048, width=0.3048, radius=0.6096, thickness=3.048e-3, E=206.8e9, nu=0.3, density=7860.0),
}
OURS = (8, 16, 32, 64)
CALCULIX = (8, 16, 32, 64)


def scene_text(structure, n):
    """The scene: clamped at theta1 = 0; theta1 runs along the axis, or across the panel."""
    surface = "{type: plate}"
    side = f"{{from: 0, to: {structure['width']}, elements: {n}}}"
    if structure["radius"]:
        surface = f"{{type: cylinder, radius: {structure['radius']}, axial: theta1}}"
        side = f"{{from: 0, to: {structure['width'] / structure['radius']}, elements: {n}}}"
    return "\n".join([
        "name: bench", "units: {length: m, force: N, voltage: V, temperature: K}", f"surface: {surface}", "mesh:",
        f"  theta1: {{from: 0, to: {structure['length']}, elements: {n}}}", f"  theta2: {side}", "materials:",
        f"  sheet: {{E: {structure['E']}, nu: {structure['nu']}, density: {structure['density']}}}", "layers:",
        f"  - {{material: sheet, thickness: {structure['thickness']}}}", "supports:",
        "  - {edge: theta1-, fix: clamped}", "dof_per_node: 6", ""])


def run_ours(program, structure, n, folder):
    with open(os.path.join(folder, "bench.yaml"), "w", encoding="ascii") as file:
        file.write(scene_text(structure, n))
    seconds, text = timed([program, "modes", "bench.yaml", "--number", str(MODES), "--json"], folder)
    return seconds, json.loads(text)["frequency"]


def place(structure, s, t):
    """Point at the fractions s of the length and t of the width."""
    x, radius = s * structure["length"], structure["radius"]
    if not radius:
        return x, t * structure["width"], 0.0
    angle = t * structure["width"] / radius
    return x, radius * cos(angle), radius * sin(angle)


def deck(structure, n):
    """n x n elements S8R, clamped at s = 0; the element's stiffness against drilling is CalculiX's own."""
    number, out = {}, ["*NODE, NSET=ALL"]
    for i in range(2 * n + 1):
        for j in range(2 * n + 1):
            if i % 2 == 0 or j % 2 == 0:
                number[i, j] = len(number) + 1
                at = place(structure, i / (2 * n), j / (2 * n))
                out.append(f"{number[i, j]}, " + ", ".join(f"{x:.12g}" for x in at))
    out.append("*ELEMENT, TYPE=S8R, ELSET=SHELL")
    ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    for i in range(0, 2 * n, 2):
        for j in range(0, 2 * n, 2):
            nodes = [number[i + a, j + b] for a, b in ring]
            out.append(", ".join(str(k) for k in [i * n + j // 2 + 1] + nodes))
    out.append("*NSET, NSET=ROOT")
    out += [f"{number[0, j]}," for j in range(2 * n + 1)]
    out += ["*MATERIAL, NAME=SHEET", "*ELASTIC", f"{structure['E']}, {structure['nu']}", "*DENSITY",
            f"{structure['density']}", "*SHELL SECTION, ELSET=SHELL, MATERIAL=SHEET", f"{structure['thickness']}",
            "*BOUNDARY", "ROOT, 1, 6", "*STEP", "*FREQUENCY", f"{MODES}", "*END STEP", ""]
    return "\n".join(out)


def run_calculix(structure, n, folder):
    with open(os.path.join(folder, "ccx.inp"), "w", encoding="ascii") as file:
        file.write(deck(structure, n))
    seconds, text = timed(["ccx", "-i", "ccx"], folder)
    if "Job finished" not in text:
        raise RuntimeError(text[-300:])
    found = []
    with open(os.path.join(folder, "ccx.dat"), encoding="ascii") as file:
        for line in file:
            words = line.split()
            if len(words) == 5 and words[0] == str(len(found) + 1) and len(found) < MODES:
                found.append(float(words[3]))
    assert len(found) == MODES, found
    return seconds, found


def differ(found, expected):
    """Largest relative difference of the first frequencies."""
    return max(abs(a / b - 1) for a, b in zip(found, expected))


def converge(run, structure, meshes, what):
    """[(elements along a side, seconds, frequencies)], one for each mesh."""
    rows = []
    for n in meshes:
        with tempfile.TemporaryDirectory() as folder:
            seconds, frequency = run(structure, n, folder)
        say(f"{what}, {n} x {n}: {seconds:.2f} s, {frequency[0]:.5g} Hz ...")
        rows.append((n, seconds, frequency))
    return rows


def first_within(rows, expected, most):
    return next(((n, seconds) for n, seconds, found in rows if differ(found, expected) < most), None)


def show(name, ours, theirs):
    """Print the comparison of one structure. Returns the largest difference on the finest meshes."""
    expected, found = theirs[-1][2], ours[-1][2]
    print(f"{name}: pzs {ours[-1][0]} x {ours[-1][0]}, CalculiX S8R {theirs[-1][0]} x {theirs[-1][0]}")
    for i in range(MODES):
        print(f"  mode {i + 1}: {found[i]:10.4f} Hz, CalculiX {expected[i]:10.4f} Hz, {100 * (found[i] / expected[i] - 1):+.3f} %")
    print(f"  last refinement: {100 * differ(ours[-2][2], found):.3f} %, CalculiX {100 * differ(theirs[-2][2], expected):.3f} %")
    for most in WITHIN:
        own, other = first_within(ours, expected, most), first_within(theirs, expected, most)
        if own and other:
            print(f"  all six within {100 * most:g} %: {own[0]} x {own[0]} in {own[1]:.3f} s, CalculiX {other[0]} x {other[0]} in "
                  f"{other[1]:.3f} s: {other[1] / own[1]:.1f} times as long")
    return differ(found, expected)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    options = parser.parse_args()
    program = os.path.abspath(os.path.join(options.build, "pzs"))
    if not shutil.which("ccx"):
        print("frequencies against CalculiX: skipped, no ccx (Debian: calculix-ccx)")
        return 0
    worst = 0.0
    for name, structure in STRUCTURES.items():
        ours = converge(lambda s, n, f: run_ours(program, s, n, f), structure, OURS, f"{name}, pzs")
        theirs = converge(run_calculix, structure, CALCULIX, f"{name}, CalculiX")
        worst = max(worst, show(name, ours, theirs))
    print(f"largest difference on the finest meshes {100 * worst:.3f} %; allowed {100 * WITHIN[-1]:g} %")
    return int(worst > WITHIN[-1])


if __name__ == "__main__":
    sys.exit(main())
