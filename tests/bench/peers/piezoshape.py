# SPDX-License-Identifier: BSD-2-Clause
"""One case by this project's own programs, processes as the peers are: `pzs solve SCENE --json` for the answer and the
time of the whole process, run_path for the time of the solution alone. Both are processor times."""

import json
import os
import subprocess

from calculix import spent

# Scene, direction of the mesh's first number and of its second, signs of the outputs A and B.
SCENES = {"hemisphere": ("hemisphere", "theta1", "theta2", (-1, 1)),
          "annular": ("annular-plate", "theta2", "theta1", (1, 1))}
GRADED = ["mesh.theta1.centre=1.4", "mesh.theta2.grading=4"]  # what cases.spacing makes for the peers


def call(command):
    """What a program prints, and the processor time it took; (None, reason) where it fails."""
    begin = spent()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return (done.stdout, spent() - begin) if done.returncode == 0 else (None, done.stderr.strip())


def solve(folder, name, mesh, element):
    """One run by the programs of a folder: {"steps": , "iterations": , "seconds": , "process": , "a": , "b": }, or
    {"failed": reason}."""
    scene, first, second, sign = SCENES[name]
    counts, _, graded = mesh.partition("-")
    n = counts.split("x")
    settings = [f"element={element}", f"mesh.{first}.elements={n[0]}", f"mesh.{second}.elements={n[1]}"]
    settings += GRADED if graded else []
    alone, reason = call([os.path.join(folder, "run_path"), scene] + settings)
    settings = [word for setting in settings for word in ("--set", setting)]
    printed, process = call([os.path.join(folder, "pzs"), "solve", scene, "--json"] + settings)
    if printed is None or alone is None:
        return {"failed": process if printed is None else reason}
    result = json.loads(printed)
    a, b = (s * result["outputs"][k] for s, k in zip(sign, "AB"))
    return {"steps": result["load_steps"], "iterations": result["linear_solves"], "seconds": float(alone.split()[-1]),
            "process": process, "a": a, "b": b}
