# SPDX-License-Identifier: BSD-2-Clause
"""Nonlinear shells by this project's program and by other codes: Kratos (PyPI) and CalculiX (Debian), one thread.

    run.py [--build FOLDER] [--quick] [--search]

Every run is a process of its own; the codes take turns, five times over. Prints one JSON line per case: code, element,
case, mesh, steps, iterations, runs, medians of seconds (the solution without reading and start-up) and of process
(all of the process), both processor times, a and b, the two displacements; progress goes to the error stream. A code that
cannot be installed is skipped with one line. compare.py reads the lines. --search finds the steps in this file again.
"""

import argparse
import functools
import json
import os
import shutil
import statistics
import subprocess
import sys

import calculix
import piezoshape

HERE = os.path.dirname(os.path.abspath(__file__))
VERSION = "10.4.4"
PACKAGES = ["KratosMultiphysics", "KratosStructuralMechanicsApplication", "KratosLinearSolversApplication"]
ROUNDS, OURS_A_ROUND = 5, 5

# Meshes: of many tried, the quickest that come within 2 % and within .5 % of the converged answers, where one does (CalculiX
# on the hemisphere: S4 16x16 is 23 % off; S4 32x32 and S8R 8x8 and 16x16 stop at about four fifths of the load).
# Our own, (case, mesh, element), built for this machine (FOLDER/bench/native) and as it comes (FOLDER/bench/default).
OURS = {("hemisphere", "12x8", "improved"): None,
        ("hemisphere", "16x10", "improved"): None,
        ("annular", "16x2", "improved"): None,
        ("annular", "18x5-graded", "improved"): None}
# Kratos, (case, mesh, element, solver): the fewest equal load steps that converge to the answer of REFERENCE_STEPS steps,
# and the faster linear solver; found by --search. The graded mesh that serves our element does not serve Kratos.
KRATOS = {("hemisphere", "12x16", "thin-triangle", "amgcl"): 5,
          ("hemisphere", "20x28", "thin-triangle", "amgcl"): 5,
          ("hemisphere", "14x18", "thick-quad", "amgcl"): 6,
          ("hemisphere", "26x26", "thick-quad", "amgcl"): 5,
          ("annular", "30x3", "thick-quad", "amgcl"): 14,
          ("annular", "30x4", "thick-quad", "amgcl"): 11,
          ("annular", "24x4-graded", "thick-quad", "amgcl"): 120}
# CalculiX, (case, mesh, element): the first of its automatic increments, the one of FIRST with the fewest iterations in
# all; found by --search.
CALCULIX = {("hemisphere", "16x16", "S4"): 0.15,
            ("annular", "30x6", "S4"): 0.05,
            ("annular", "16x3", "S8R"): 0.05,
            ("annular", "26x5", "S8R"): 0.05}
SLOW = ("thick-quad", "14x18"), ("thick-quad", "26x26"), ("thick-quad", "24x4-graded"), ("S4", "30x6")

# The search: steps of the reference, agreement asked for, first increments and linear solvers tried.
REFERENCE_STEPS, AGREE, FIRST, SOLVERS = 60, 1e-3, (1, 0.5, 0.25, 0.2, 0.15, 0.1, 0.05), ("amgcl", "sparse_lu")


def say(text):
    print(text, file=sys.stderr, flush=True)


def quiet(command):
    """Whether a command succeeds."""
    try:
        return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0
    except OSError:
        return False


def debian(package):
    """Install a Debian package where this user may."""
    root = [] if os.geteuid() == 0 else ["sudo", "-n"]
    say(f"installing {package}")
    install = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "install", "-y", "-qq", "--no-install-recommends",
               package]
    return quiet(root + ["apt-get", "update", "-qq"]) and quiet(root + install)


def get_calculix():
    """Whether ccx is here, installed on demand."""
    if shutil.which("ccx") or (debian("calculix-ccx") and shutil.which("ccx")):
        return True
    say("run.py: calculix-ccx cannot be installed, CalculiX is skipped")
    return False


def get_kratos(folder):
    """The Python that has Kratos, made on demand in a folder of its own; None where that fails."""
    python = os.path.join(folder, "bin", "python")
    modules = "import KratosMultiphysics.LinearSolversApplication, KratosMultiphysics.StructuralMechanicsApplication"
    if quiet([python, "-c", modules]):
        return python
    say("installing Kratos")
    shutil.rmtree(folder, ignore_errors=True)
    make = [sys.executable, "-m", "venv", folder]
    if (quiet(make) or (debian("python3-venv") and quiet(make))) and quiet(
            [python, "-m", "pip", "install", "--quiet"] + [f"{name}=={VERSION}" for name in PACKAGES]):
        return python
    shutil.rmtree(folder, ignore_errors=True)
    say("run.py: no network, no pip or no venv, Kratos is skipped")
    return None


def run_ours(folder, key, _):
    """One case by our own programs."""
    return piezoshape.solve(folder, *key)


def run_kratos(python, key, steps):
    """One case in the Python that has Kratos."""
    command = [python, os.path.join(HERE, "kratos.py"), *key, str(steps)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"})
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {"failed": done.stderr.strip()[-200:] or f"exit status {done.returncode}"}


def run_calculix(folder, key, first):
    """One case by ccx."""
    return calculix.solve(*key, first, folder)


def agree(run, reference):
    return "seconds" in run and all(abs(run[k] / reference[k] - 1) < AGREE for k in "ab")


def search_kratos(python, key):
    """The fewest equal steps that reach the answer of many, and the time with every solver."""
    reference = run_kratos(python, key, REFERENCE_STEPS)
    if "failed" in reference:
        return None
    for steps in range(1, REFERENCE_STEPS + 1):
        run = run_kratos(python, key, steps)
        if agree(run, reference):
            return steps, {solver: run_kratos(python, (*key[:3], solver), steps).get("seconds") for solver in SOLVERS}
    return None


def search_calculix(folder, key):
    """The first increment with the fewest iterations in all: (iterations, first increment)."""
    runs = {first: run_calculix(folder, key, first) for first in FIRST}
    good = {first: run for first, run in runs.items() if "seconds" in run}
    return min(((run["iterations"], first) for first, run in good.items()), default=None)


def in_turns(jobs):
    """Jobs (code, key, call, rounds, runs a round). Prints the medians; returns whether one did not converge."""
    seen = {}
    for turn in range(max(job[3] for job in jobs)):
        say(f"round {turn + 1}")
        for code, key, call, rounds, each in jobs:
            runs = seen.setdefault((code, key), [])
            for _ in range(each if turn < rounds else 0):
                if not runs or "failed" not in runs[0]:
                    begin = calculix.spent()
                    runs.append(call())
                    runs[-1].setdefault("process", calculix.spent() - begin)
    for (code, key), runs in seen.items():
        if "failed" in runs[0]:
            say(f"run.py: {code} {' '.join(key)} did not converge: {runs[0]['failed']}")
            continue
        medians = {name: statistics.median(run[name] for run in runs) for name in ("seconds", "process")}
        print(json.dumps({"code": code, "case": key[0], "mesh": key[1], "element": key[2], "runs": len(runs), **runs[0],
                          **medians}))
    return any("failed" in runs[0] for runs in seen.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build", metavar="FOLDER",
                        help="our programs; Kratos and the decks go to FOLDER/peers (build)")
    parser.add_argument("--quick", action="store_true", help="fewer cases, CalculiX once: under two minutes")
    parser.add_argument("--search", action="store_true", help="find the steps and first increments again: about ten minutes")
    options = parser.parse_args()
    folder = os.path.join(options.build, "peers")
    os.makedirs(folder, exist_ok=True)
    python = get_kratos(os.path.abspath(os.path.join(folder, "venv")))
    decks = os.path.join(folder, "decks") if get_calculix() else None
    if options.search:
        for code, where, table, search in (("kratos", python, KRATOS, search_kratos),
                                           ("calculix", decks, CALCULIX, search_calculix)):
            for key in table if where else ():
                print(code, *key, search(where, key), flush=True)
        return 0
    codes = [("native", os.path.join(options.build, "bench", "native"), OURS, run_ours, ROUNDS, OURS_A_ROUND),
             ("default", os.path.join(options.build, "bench", "default"), OURS, run_ours, ROUNDS, OURS_A_ROUND),
             ("kratos", python, KRATOS, run_kratos, ROUNDS, 1),
             ("calculix", decks, CALCULIX, run_calculix, 1 if options.quick else ROUNDS, 1)]
    return in_turns([(code, key, functools.partial(run, where, key, setting), rounds, each)
                     for code, where, table, run, rounds, each in codes if where
                     for key, setting in table.items() if not (options.quick and (key[2], key[1]) in SLOW)])


if __name__ == "__main__":
    sys.exit(main())
