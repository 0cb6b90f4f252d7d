# SPDX-License-Identifier: BSD-2-Clause
"""Structures on a mesh of a file: this program and CalculiX read the same nodes and elements.

    mesh_file.py [--build FOLDER]

Gmsh makes each mesh twice: quadrilaterals of four nodes (S4), which both programs read, and the same with nodes in the
middle of the sides (S8R), for CalculiX alone. Loads: a pressure, and voltages, which CalculiX gets as thermal strains of
the ceramic. Printed is the difference of the displacements at the corner nodes, over their norm, from CalculiX's S8R on
the mesh with half the element length, and the processor time of each program for everything it does.

Then both programs solve a mesh of 10,000 elements of four nodes under pressure, of one material, because CalculiX has no
layers in S4. Printed is the difference of each from CalculiX's S8R on the same mesh. Both run in one thread.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "..", "..", "host_tools", "scenes")

# Materials: E in Pa, d31 in m/V. All have one Poisson's ratio, because CalculiX makes one solid element of all layers:
# its thickness strain cannot follow layers of different ratios, and a ceramic on glass of 0.2 bends it 4.4 % too far.
GLASS = dict(name="glass", E=64e9, nu=0.31)
CERAMIC = dict(name="ceramic", E=63e9, nu=0.31, d31=-180e-12)

# A structure: geometry of Gmsh, number that divides its element sides, layers from the inner face outwards, sets that
# carry a voltage, clamped set, pressure (Pa), voltage.
STRUCTURES = {
    "disc": dict(geo="hex-mirror.geo", parts="parts = {};", first=2, clamped="rim", layers=[(CERAMIC, 0.2e-3), (GLASS, 0.8e-3)],
                 driven=["hex_1", "hex_17"], pressure=10.0, voltage=100.0),
    "skin": dict(geo="wing-panel.geo", parts=None, first=1, clamped="root", layers=[(CERAMIC, 0.3e-3), (GLASS, 2e-3)],
                 driven=["mfc_1", "mfc_6"], pressure=20.0, voltage=100.0),
}


# Meshes of 10,000 elements, by the number that divides the element sides once more. With six dof a node they fit into 16 bits.
LARGE = {"disc": 4, "skin": 7}


def say(text):
    print(text, file=sys.stderr, flush=True)


def spent():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(command, folder):
    """Processor time of a program; its output is returned with it."""
    begin = spent()
    ran = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=900,
                         env={**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"})
    if ran.returncode:
        raise RuntimeError(f"{command[0]}: {ran.stdout.decode(errors='replace')[-300:]}")
    return spent() - begin, ran.stdout.decode(errors="replace")


# ---- meshes ---------------------------------------------------------------


def make_mesh(structure, finer, folder):
    """A mesh of Gmsh with quadrilaterals of eight nodes, as a file of its format 2.2."""
    with open(os.path.join(SCENES, structure["geo"]), encoding="ascii") as file:
        text = file.read()
    if structure["parts"]:
        first = structure["first"]
        assert structure["parts"].format(first) in text
        text = text.replace(structure["parts"].format(first), structure["parts"].format(first * finer))
    else:
        for name in ("divisions_i", "divisions_j"):
            start = text.index(name + "() = {") + len(name) + 6
            end = text.index("}", start)
            text = text[:start] + ", ".join(str(int(n) * finer) for n in text[start:end].split(",")) + text[end:]
    with open(os.path.join(folder, "mesh.geo"), "w", encoding="ascii") as file:
        file.write(text)
    subprocess.run(["gmsh", "-2", "mesh.geo", "-order", "2", "-setnumber", "Mesh.SecondOrderIncomplete", "1", "-format", "msh22",
                    "-o", "mesh.msh"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    return read_mesh(os.path.join(folder, "mesh.msh"))


def read_mesh(path):
    """Nodes {number: place in m}, quadrilaterals {number: 8 nodes}, sets of elements and of nodes by name."""
    names, node, quad, elements, nodes, known = {}, {}, {}, {}, {}, set()
    with open(path, encoding="ascii") as file:
        lines = iter(file.read().splitlines())
    for line in lines:
        if line == "$PhysicalNames":
            for _ in range(int(next(lines))):
                dimension, tag, name = next(lines).split(None, 2)
                names[int(dimension), int(tag)] = name.strip('"')
        elif line == "$Nodes":
            for _ in range(int(next(lines))):
                number, *place = next(lines).split()
                node[int(number)] = [float(x) * 1e-3 for x in place]
        elif line == "$Elements":
            for _ in range(int(next(lines))):
                number, kind, tags, *rest = map(int, next(lines).split())
                group, own = rest[0], rest[tags:]
                if kind == 16 and tuple(own) not in known:  # Gmsh repeats elements of two groups
                    known.add(tuple(own))
                    quad[number] = own
                    elements.setdefault(names.get((2, group), "rest"), []).append(number)
                elif kind == 8:
                    nodes.setdefault(names.get((1, group), "rest"), set()).update(own)
    orient(quad)
    return node, quad, elements, nodes


def orient(quad):
    """Turn the elements so that all have their outer faces on the side of the first one; Gmsh does not."""
    sides = {}
    for number, own in quad.items():
        for i in range(4):
            sides.setdefault(frozenset((own[i], own[(i + 1) % 4])), []).append(number)
    first = next(iter(quad))
    seen, stack = {first}, [first]
    while stack:
        own = quad[stack.pop()]
        for i in range(4):
            a, b = own[i], own[(i + 1) % 4]
            for other in sides[frozenset((a, b))]:
                if other in seen:
                    continue
                q = quad[other]
                if any(q[j] == a and q[(j + 1) % 4] == b for j in range(4)):
                    quad[other] = [q[0], q[3], q[2], q[1], q[7], q[6], q[5], q[4]]
                seen.add(other)
                stack.append(other)
    assert len(seen) == len(quad)


def mesh_text(mesh, element):
    """The mesh as INP: all nodes and S8R elements, or corner nodes and S4 elements; sets of both."""
    node, quad, elements, nodes = mesh
    corners = 4 if element == "S4" else 8
    used = sorted({n for own in quad.values() for n in own[:corners]})
    # CalculiX reads 20 characters of a number, and would lose the exponent of a longer one
    out = ["*NODE, NSET=ALL"] + [f"{n}, " + ", ".join(f"{x:.12g}" for x in node[n]) for n in used]
    for name, members in elements.items():
        out.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
        out += [", ".join(str(x) for x in [e] + quad[e][:corners]) for e in members]
    kept = set(used)
    for name, members in nodes.items():
        out.append(f"*NSET, NSET={name}")
        out += [f"{n}," for n in sorted(members & kept)]
    return "\n".join(out) + "\n"


# ---- this program ----------------------------------------------------------


def scene_text(structure, load):
    materials = {m["name"]: m for m, _ in structure["layers"]}
    driven = ", ".join(f'"{name}"' for name in structure["driven"])
    lines = ["name: bench", "units: {length: m, force: N, voltage: V, temperature: K}", "mesh: {file: mesh.inp}", "materials:"]
    for m in materials.values():
        piezo = f", d31: {m['d31']}, d32: {m['d31']}" if "d31" in m else ""
        lines.append(f"  {m['name']}: {{E: {m['E']}, nu: {m['nu']}{piezo}}}")
    lines.append("layers:")
    lines += [f"  - {{name: {m['name']}, material: {m['name']}, thickness: {t}}}" for m, t in structure["layers"]]
    if driven:
        lines += [f"patches: [{{name: p, layer: ceramic, sets: [{driven}]}}]",
                  f"actuators: [{{name: v, drives: [{{patches: p}}], applied: {structure['voltage'] if load == 'voltage' else 0}}}]"]
    lines += [f"supports: [{{set: {structure['clamped']}, fix: clamped}}]", f"dof_per_node: {structure.get('dof', 7)}"]
    if load == "pressure":
        lines.append(f"loads: [{{face: outer, pressure: {structure['pressure']}}}]")
    return "\n".join(lines) + "\n"


def run_ours(program, structure, load, folder):
    with open(os.path.join(folder, "bench.yaml"), "w", encoding="ascii") as file:
        file.write(scene_text(structure, load))
    seconds, _ = timed([program, "solve", "bench.yaml", "--npz", "bench.npz"], folder)
    with np.load(os.path.join(folder, "bench.npz")) as result:
        return seconds, result["node_place"], result["displacement"]


# ---- CalculiX --------------------------------------------------------------


def deck(structure, load, mesh, element):
    """The mesh with layers, clamped set and load. Layers count from the face away from the normal, as ours do."""
    _, _, elements, _ = mesh
    out = [mesh_text(mesh, element)]
    names = {m["name"]: m for m, _ in structure["layers"]}
    for suffix in ("", "_driven"):
        for m in names.values():
            out += [f"*MATERIAL, NAME={m['name']}{suffix}", "*ELASTIC", f"{m['E']}, {m['nu']}"]
            strain = 0.0
            if suffix and "d31" in m and load == "voltage":
                thickness = next(t for own, t in structure["layers"] if own is m)
                strain = -m["d31"] * structure["voltage"] / thickness  # the field is -V over the thickness
            # thermal strain of one kelvin in the plane; the shell has no stress across it
            out += ["*EXPANSION, TYPE=ORTHO", f"{strain:.12g}, {strain:.12g}, 0."]
    for name in elements:
        suffix = "_driven" if name in structure["driven"] else ""
        if len(structure["layers"]) == 1:  # S4 has no layers
            material, thickness = structure["layers"][0]
            out += [f"*SHELL SECTION, ELSET={name}, MATERIAL={material['name']}", f"{thickness}"]
            continue
        out.append(f"*SHELL SECTION, ELSET={name}, COMPOSITE")
        out += [f"{t}, , {m['name']}{suffix}" for m, t in structure["layers"]]
    out += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.", "*BOUNDARY", f"{structure['clamped']}, 1, 6", "*STEP", "*STATIC"]
    if load == "pressure":
        out.append("*DLOAD")
        out += [f"{name}, P, {structure['pressure']}" for name in elements]
    else:
        out += ["*TEMPERATURE", "ALL, 1."]
    out += ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]
    return "\n".join(out)


def run_calculix(structure, load, mesh, folder, element="S8R"):
    with open(os.path.join(folder, "ccx.inp"), "w", encoding="ascii") as file:
        file.write(deck(structure, load, mesh, element))
    seconds, text = timed(["ccx", "-i", "ccx"], folder)
    if "Job finished" not in text:
        raise RuntimeError(text[-300:])
    with open(os.path.join(folder, "ccx.dat"), encoding="ascii") as file:
        rows = [line.split() for line in file]
    return seconds, {int(row[0]): [float(x) for x in row[1:4]] for row in rows if len(row) == 4 and row[0].isdigit()}


# ---- comparison ------------------------------------------------------------


def key(place):
    return tuple(round(x * 1e7) for x in place)


def differ(found, expected):
    """|found - expected| / |expected| over the places of both; dictionaries from place to displacement."""
    common = [k for k in found if k in expected]
    assert len(common) > 100, len(common)
    a, b = (np.array([of[k] for k in common]) for of in (found, expected))
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def by_place(place, displacement):
    return {key(x): u for x, u in zip(place, displacement)}


def compare(program, name, load):
    structure, rows = STRUCTURES[name], []
    found, theirs = {}, {}
    for finer in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            mesh = make_mesh(structure, finer, folder)
            with open(os.path.join(folder, "mesh.inp"), "w", encoding="ascii") as file:
                file.write(mesh_text(mesh, "S4"))
            seconds, place, displacement = run_ours(program, structure, load, folder)
            found[finer] = by_place(place, displacement)
            calculix, u = run_calculix(structure, load, mesh, folder)
            theirs[finer] = {key(mesh[0][n]): x for n, x in u.items()}
            rows.append(dict(structure=name, load=load, elements=len(mesh[1]), seconds=seconds, calculix_seconds=calculix))
            say(f"{name}, {load}, {len(mesh[1])} elements: {seconds:.2f} s, CalculiX S8R {calculix:.2f} s")
    for finer, row in zip((1, 2), rows):
        corners = {k: u for k, u in theirs[finer].items() if k in found[finer]}
        row["error"] = differ(found[finer], theirs[2])
        row["calculix_error"] = differ(corners, theirs[2])
    return rows


def compare_large(program, name):
    """Both programs on one mesh of 10,000 elements of four nodes: processor times, and differences from S8R."""
    structure = {**STRUCTURES[name], "layers": [(GLASS, 1e-3)], "driven": [], "dof": 6}
    with tempfile.TemporaryDirectory() as folder:
        mesh = make_mesh(structure, LARGE[name], folder)
        with open(os.path.join(folder, "mesh.inp"), "w", encoding="ascii") as file:
            file.write(mesh_text(mesh, "S4"))
        seconds, place, displacement = run_ours(program, structure, "pressure", folder)
        calculix, theirs = run_calculix(structure, "pressure", mesh, folder, "S4")
        _, expected = run_calculix(structure, "pressure", mesh, folder)
    expected = {key(mesh[0][n]): u for n, u in expected.items()}
    say(f"{name}, {len(mesh[1])} elements: {seconds:.2f} s, CalculiX S4 {calculix:.2f} s")
    return dict(structure=name, elements=len(mesh[1]), seconds=seconds, calculix_seconds=calculix,
                error=differ(by_place(place, displacement), expected),
                calculix_error=differ({key(mesh[0][n]): u for n, u in theirs.items()}, expected))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", default="build")
    options = parser.parse_args()
    program = os.path.abspath(os.path.join(options.build, "pzs"))
    for tool in ("ccx", "gmsh"):
        if not shutil.which(tool):
            print(f"mesh files against CalculiX: skipped, no {tool} (Debian: calculix-ccx, gmsh)")
            return 0
    rows = []
    for name in STRUCTURES:
        for load in ("pressure", "voltage"):
            rows += compare(program, name, load)
    print(f"{'structure':10}{'load':10}{'elements':>9}{'ours %':>9}{'S8R %':>9}{'ours s':>9}{'S8R s':>9}")
    for row in rows:
        print(f"{row['structure']:10}{row['load']:10}{row['elements']:9}{100 * row['error']:9.3f}{100 * row['calculix_error']:9.3f}"
              f"{row['seconds']:9.2f}{row['calculix_seconds']:9.2f}")
    print(f"{'structure':10}{'load':10}{'elements':>9}{'ours %':>9}{'S4 %':>9}{'ours s':>9}{'S4 s':>9}")
    for row in [compare_large(program, name) for name in LARGE]:
        print(f"{row['structure']:10}{'pressure':10}{row['elements']:9}{100 * row['error']:9.3f}{100 * row['calculix_error']:9.3f}"
              f"{row['seconds']:9.2f}{row['calculix_seconds']:9.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
