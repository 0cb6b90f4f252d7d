# SPDX-License-Identifier: BSD-2-Clause
"""One case by CalculiX: writes the deck, runs ccx, reads displacements, increments and iterations.

Load steps are ccx's automatic increments, from a given first one on; convergence is ccx's own default.
Timed is the processor time of ccx; reading the deck is less than a hundredth of it.
"""

import os
import resource
import subprocess

import cases

ORDER = {"S4": 1, "S8R": 2}


def spent():
    """Processor time of all processes started here that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def frame(normal, tangent):
    """Local axes at a node of a plane of symmetry: the edge's tangent, the plane's normal, their cross product."""
    axis = [float(i == normal) for i in range(3)]
    t = tangent
    return t, axis, [t[1] * axis[2] - t[2] * axis[1], t[2] * axis[0] - t[0] * axis[2], t[0] * axis[1] - t[1] * axis[0]]


def deck(case, element, first):
    """The input of ccx; nodes and elements count from 1. The rotation about a shell's normal stays free on planes of
    symmetry: fixing it there gives a wrong answer without a word."""
    out = ["*NODE, NSET=ALL"]
    out += [f"{k + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for k, (x, y, z) in enumerate(case.node)]
    out += [f"*ELEMENT, TYPE={element}, ELSET=SHELL"]
    for k, quad in enumerate(case.quad):
        out.append(", ".join(str(n) for n in [k + 1] + [node + 1 for node in quad]))
    out += ["*MATERIAL, NAME=M", "*ELASTIC", f"{case.young}, {case.poisson}",
            "*SHELL SECTION, ELSET=SHELL, MATERIAL=M", str(case.thickness)]
    for k, normal, tangent in case.symmetric:
        axis = [float(i == normal) for i in range(3)]
        out += [f"*NSET, NSET=N{k + 1}", str(k + 1), f"*TRANSFORM, NSET=N{k + 1}, TYPE=R",
                ", ".join(f"{x:.12g}" for x in (*tangent, *axis))]
    out.append("*BOUNDARY")
    out += [f"{k + 1}, 1, 6" for k in case.clamped]
    for k, _, _ in case.symmetric:
        out += [f"{k + 1}, 2", f"{k + 1}, 4"]
    out += [f"{k + 1}, {axis + 1}" for k, axis in case.held]
    out += ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{first}, 1., 1e-5, 1."]
    out.append("*CLOAD")
    local = {k: (normal, tangent) for k, normal, tangent in case.symmetric}
    for k, axis, size in case.force:
        if k in local:
            triad = frame(*local[k])
            out += [f"{k + 1}, {i + 1}, {size * e[axis]:.12g}" for i, e in enumerate(triad) if e[axis]]
        else:
            out.append(f"{k + 1}, {axis + 1}, {size:.12g}")
    out += ["*NSET, NSET=ENDS", ", ".join(str(k + 1) for k, _, _ in case.read)]
    out += ["*NODE PRINT, NSET=ENDS, FREQUENCY=1000, GLOBAL=YES", "U", "*END STEP", ""]
    return "\n".join(out)


def solve(name, mesh, element, first, folder, limit=300):
    """One run: {"steps": , "iterations": , "seconds": , "a": , "b": }, or {"failed": part of the load reached}."""
    case = cases.make(name, mesh, ORDER[element])
    job = os.path.join(folder, f"{name}-{mesh}-{element}")
    os.makedirs(folder, exist_ok=True)
    with open(job + ".inp", "w", encoding="ascii") as file:
        file.write(deck(case, element, first))
    for ending in (".sta", ".cvg", ".dat"):
        with open(job + ending, "w", encoding="ascii"):
            pass
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    begin = spent()
    try:
        subprocess.run(["ccx", "-i", os.path.basename(job)], cwd=folder, env=environment, timeout=limit, check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        pass
    seconds = spent() - begin
    with open(job + ".sta", encoding="ascii") as file:
        rows = [line.split() for line in file if line.strip()[:1].isdigit()]
    with open(job + ".cvg", encoding="ascii") as file:
        iterations = sum(line.strip()[:1].isdigit() for line in file)
    done = float(rows[-1][4]) if rows else 0.0
    if done < 1:
        return {"failed": done}
    with open(job + ".dat", encoding="ascii") as file:
        moved = {int(row[0]) - 1: row[1:] for row in map(str.split, file) if row and row[0].isdigit()}
    a, b = (sign * float(moved[k][axis]) for k, axis, sign in case.read)
    return {"steps": len(rows), "iterations": iterations, "seconds": seconds, "a": a, "b": b}
