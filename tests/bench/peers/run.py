"""Nonlinear shells by other codes: Kratos (PyPI) and CalculiX (Debian), one thread, timed without their start-up.

    run.py [--build FOLDER] [--quick] [--search] [--json]

Prints one JSON line per run: code, element, case, mesh, steps, iterations, seconds (the median of three runs, with
--quick one), a and b, the two displacements; progress goes to the error stream. A code that cannot be installed is
skipped with one line. compare.py reads the lines. --search finds the steps in this file again.
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys

import calculix

HERE = os.path.dirname(os.path.abspath(__file__))
VERSION = "10.4.4"
PACKAGES = ["KratosMultiphysics", "KratosStructuralMechanicsApplication", "KratosLinearSolversApplication"]
REPEAT = 3

# Meshes: the coarsest of a few that come within 2 % and within .5 % of the converged answers, where one does (CalculiX on
# the hemisphere: S4 16x16 is 23 % off; S4 32x32 and S8R 8x8 and 16x16 stop at about four fifths of the load).
# Kratos, (case, mesh, element, solver): the fewest equal load steps that converge to the answer of REFERENCE_STEPS steps,
# and the faster linear solver; found by --search. The graded mesh that serves our element does not serve Kratos.
KRATOS = {("hemisphere", "16x16", "thin-triangle", "amgcl"): 5,
          ("hemisphere", "26x26", "thin-triangle", "amgcl"): 5,
          ("hemisphere", "18x18", "thick-quad", "amgcl"): 5,
          ("hemisphere", "26x26", "thick-quad", "amgcl"): 5,
          ("annular", "20x4", "thick-quad", "amgcl"): 29,
          ("annular", "30x4", "thick-quad", "amgcl"): 11,
          ("annular", "24x4-graded", "thick-quad", "amgcl"): 120}
# CalculiX, (case, mesh, element): the first of its automatic increments, the one of FIRST with the fewest iterations in
# all; found by --search.
CALCULIX = {("hemisphere", "16x16", "S4"): 0.15,
            ("annular", "30x6", "S4"): 0.05,
            ("annular", "16x3", "S8R"): 0.05,
            ("annular", "26x5", "S8R"): 0.05}
SKIPPED_BY_QUICK = ("thick-quad", "18x18"), ("thick-quad", "26x26"), ("thick-quad", "24x4-graded"), ("S4", "30x6")

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


def run_kratos(python, key, steps, repeat):
    """One case in the Python that has Kratos; seconds is the median."""
    name, mesh, element, solver = key
    command = [python, os.path.join(HERE, "kratos.py"), name, mesh, element, solver, str(steps), str(repeat)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"})
    try:
        result = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        return {"failed": done.stderr.strip()[-200:] or f"exit status {done.returncode}"}
    if "seconds" in result:
        result["seconds"] = statistics.median(result["seconds"])
    return result


def run_calculix(folder, key, first, repeat):
    """One case by ccx; seconds is the median."""
    name, mesh, element = key
    runs = [calculix.solve(name, mesh, element, first, folder) for _ in range(repeat)]
    if "seconds" in runs[0]:
        runs[0]["seconds"] = statistics.median(run["seconds"] for run in runs)
    return runs[0]


def agree(run, reference):
    return "seconds" in run and all(abs(run[k] / reference[k] - 1) < AGREE for k in "ab")


def search_kratos(python, key):
    """The fewest equal steps that reach the answer of many, and the time with every solver."""
    reference = run_kratos(python, key, REFERENCE_STEPS, 1)
    if "failed" in reference:
        return None
    for steps in range(1, REFERENCE_STEPS + 1):
        run = run_kratos(python, key, steps, 1)
        if agree(run, reference):
            return steps, {solver: run_kratos(python, (*key[:3], solver), steps, 1).get("seconds") for solver in SOLVERS}
    return None


def search_calculix(folder, key):
    """The first increment with the fewest iterations in all: (iterations, first increment)."""
    runs = {first: run_calculix(folder, key, first, 1) for first in FIRST}
    good = {first: run for first, run in runs.items() if "seconds" in run}
    return min(((run["iterations"], first) for first, run in good.items()), default=None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build", metavar="FOLDER", help="Kratos and the decks go to FOLDER/peers (build)")
    parser.add_argument("--quick", action="store_true", help="fewer cases, each once: under a minute")
    parser.add_argument("--search", action="store_true", help="find the steps and first increments again: about ten minutes")
    parser.add_argument("--json", action="store_true", help="one JSON line per run: what is printed in any case")
    options = parser.parse_args()
    folder = os.path.join(options.build, "peers")
    os.makedirs(folder, exist_ok=True)
    python = get_kratos(os.path.abspath(os.path.join(folder, "venv")))
    decks = os.path.join(folder, "decks") if get_calculix() else None
    codes = [("kratos", python, KRATOS, run_kratos, search_kratos),
             ("calculix", decks, CALCULIX, run_calculix, search_calculix)]
    failed = False
    for code, where, table, run, search in codes:
        for key, setting in table.items() if where else ():
            if options.quick and (key[2], key[1]) in SKIPPED_BY_QUICK:
                continue
            say(f"{code} {' '.join(key)} ...")
            if options.search:
                print(code, *key, search(where, key), flush=True)
                continue
            result = run(where, key, setting, 1 if options.quick else REPEAT)
            if "failed" in result:
                say(f"run.py: {code} {' '.join(key)} did not converge: {result['failed']}")
                failed = True
            else:
                line = {"code": code, "case": key[0], "mesh": key[1], "element": key[2], **result}
                print(json.dumps(line), flush=True)
    return failed


if __name__ == "__main__":
    sys.exit(main())
