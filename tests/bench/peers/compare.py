# SPDX-License-Identifier: BSD-2-Clause
"""Time to reach an error, code by code:  compare.py [--json] [FILE ...]   (without files: the standard input)

Reads the JSON lines of run.py. The error of a run is the worse of its two displacements' errors against the converged
answers in cases.py. Per case and tolerance: the fastest run of each code that reaches it, and how many times ours the
others took, for the solution and for the whole process: against our program built for this machine, and as it comes. Then
the least ratios; those below WANTED are marked. Exit status 2 without runs or on a line that is none.
"""

import argparse
import fileinput
import json
import math
import sys

from cases import CONVERGED

OURS, TIMES, TOLERANCES, WANTED = ("native", "default"), ("seconds", "process"), (0.02, 0.005), 100


def error(run):
    """The worse of the two displacements' relative errors."""
    return max(abs(run[k] / wanted - 1) for k, wanted in zip("ab", CONVERGED[run["case"]]))


def read(lines):
    """The runs of all lines that are not blank."""
    runs = []
    for line in filter(str.strip, lines):
        run = json.loads(line)
        run["error"] = error(run)
        words = isinstance(run["code"], str) and isinstance(run["mesh"], str)
        if not (words and math.isfinite(run["error"]) and run["seconds"] > 0 and run["process"] > 0):
            raise ValueError(line)
        runs.append(run)
    return runs


def compare(runs):
    """One row per case, tolerance and code: the fastest run that reaches it (None where none does); ratio: of a peer's
    times to ours, {our build: {name of the time: times}}."""
    rows = []
    for case in CONVERGED:
        here = [run for run in runs if run["case"] == case]
        codes = [code for code in (*OURS, *sorted({run["code"] for run in here} - set(OURS)))
                 if any(run["code"] == code for run in here)]
        for tolerance in TOLERANCES if here else ():
            best = {code: min((run for run in here if run["code"] == code and run["error"] <= tolerance),
                              key=lambda run: run["seconds"], default=None) for code in codes}
            for code in codes:
                ratio = {ours: {k: best[code][k] / best[ours][k] for k in TIMES} for ours in OURS
                         if code not in OURS and best[code] and best.get(ours)}
                rows.append({"case": case, "tolerance": tolerance, "code": code, "run": best[code], "ratio": ratio})
    return rows


def show(rows, runs):
    print(f"{'case':<11}{'error':>6}  {'code':<9}{'solution':>12}{'process':>13}   over native  over default  "
          "mesh, element, steps, systems, its error, runs")
    for row in rows:
        run = row["run"]
        text = f"{row['case']:<11}{100 * row['tolerance']:>4g} %  {row['code']:<9}"
        if run is None:
            least = min((r for r in runs if (r["case"], r["code"]) == (row["case"], row["code"])),
                        key=lambda r: r["error"])
            print(f"{text}none reaches it; the best is {least['mesh']} {least['element']}, "
                  f"error {100 * least['error']:.2f} %")
            continue
        ratio = "".join(" ".join(f"{times:.0f}" for times in row["ratio"].get(ours, {}).values()).rjust(14) for ours in OURS)
        print(f"{text}{1000 * run['seconds']:>9.1f} ms{1000 * run['process']:>10.1f} ms{ratio}  {run['mesh']} "
              f"{run['element']} {run['steps']} {run['iterations']}, {100 * run['error']:.2f} %, {run['runs']}")
    for ours in OURS:
        for k, name in zip(TIMES, ("solution", "process")):
            ratios = [(row["ratio"][ours][k], row) for row in rows if ours in row["ratio"]]
            for ratio, row in [min(ratios, key=lambda pair: pair[0])] if ratios else ():
                which = f"{row['case']}, {100 * row['tolerance']:g} %, {row['code']}"
                text = f"least ratio, {name}, {ours}: {ratio:.0f} ({which})"
                print(text if ratio >= WANTED else f"{text}, below {WANTED}")
    for case in sorted({run["case"] for run in runs}):
        if not any(run["case"] == case and run["code"] in OURS for run in runs):
            print(f"{case:<12}no run of our own: no ratios")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="one JSON line per row")
    parser.add_argument("file", nargs="*", help="files of JSON lines")
    options = parser.parse_args()
    try:
        runs = read(fileinput.input(options.file))
    except OSError as fault:
        sys.exit(f"compare.py: {fault}")
    except (ValueError, KeyError, TypeError) as fault:
        print(f"compare.py: not a run: {fault}", file=sys.stderr)
        return 2
    if not runs:
        print("compare.py: no runs", file=sys.stderr)
        return 2
    rows = compare(runs)
    if options.json:
        for row in rows:
            print(json.dumps(row))
    else:
        show(rows, runs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
