# SPDX-License-Identifier: BSD-2-Clause
"""Frequencies with open and short-circuited electrodes against scipy's roots of the exact characteristic equations.

    open_modes.py PZS

bar      fixed at one end, stretched along its length, one electrode over each face:
         tan(x)/x = -(1 - k^2)/k^2 with the material's coupling factor k = k31
bimorph  cantilever bender, one electrode over each outer face: x (1 + cosh x cos x) + r (cosh x sin x + sinh x cos x) = 0
         with r = 3/4 k^2/(1 - k^2)

Each is solved on 16 and 32 elements; the values extrapolated to the order 2 must agree with the roots to fourth order.
"""

import json
import subprocess
import sys

import numpy as np
from scipy.optimize import brentq

MODES, ELEMENTS = 3, 16
YOUNG, E31, PERMITTIVITY, DENSITY = 60e9, 12.0, 8e-9, 7600.0
RATIO = E31**2 / (YOUNG * PERMITTIVITY)


def bar():
    """(open, short) roots and the frequencies of both."""
    speed = np.sqrt(YOUNG / DENSITY) / 0.05
    short = (np.arange(MODES) + 0.5) * np.pi
    opened = np.array([brentq(lambda x: x * np.cos(x) + RATIO * np.sin(x), x, x + np.pi / 2) for x in short])
    return opened, short, speed * opened / (2 * np.pi), speed * short / (2 * np.pi), 0 * opened


def bimorph():
    """The same of the bender; the theory of beams leaves out (x h/length)^2."""
    height, length, r = 1e-4, 0.1, 0.75 * RATIO
    unit = np.sqrt(YOUNG * height**2 / (12 * DENSITY)) / length**2 / (2 * np.pi)
    short = np.array([brentq(lambda x: 1 + np.cosh(x) * np.cos(x), i * np.pi + 0.1, (i + 1) * np.pi) for i in range(MODES)])
    opened = np.array([brentq(lambda x: x * (1 + np.cosh(x) * np.cos(x)) + r * (np.cosh(x) * np.sin(x) + np.sinh(x) * np.cos(x)),
                              x, x + np.pi / 4) for x in short])
    return opened, short, unit * opened**2, unit * short**2, (opened * height / length) ** 2


def computed(program, name, elements):
    command = [program, "modes", f"tests/rigs/scenes/coupled-{name}.yaml", "--number", str(MODES), "--json", "--set",
               f"mesh.theta1.elements={elements}"]
    found = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout)
    return [np.array(found[key]) for key in ("frequency", "short_frequency", "coupling_squared")]


def main():
    faults = 0
    for name, exact in (("bar", bar()), ("bimorph", bimorph())):
        opened, short, open_frequency, short_frequency, neglect = exact
        coarse, fine = (computed(sys.argv[1], name, n) for n in (ELEMENTS, 2 * ELEMENTS))
        wanted = open_frequency, short_frequency, 1 - (short_frequency / open_frequency) ** 2
        limit = [(4 * b - a) / 3 for a, b in zip(coarse, fine)]
        error = [np.abs(a - b) / (np.abs(b) if k < 2 else 1) for k, (a, b) in enumerate(zip(limit, wanted))]
        allowed = (opened / ELEMENTS) ** 4 + neglect
        faults += int(sum((e > allowed).any() for e in error))
        print(f"{name} open {error[0].max():.1e}, short {error[1].max():.1e}, coupling {error[2].max():.1e};", end=" ")
    print("worst errors of three modes, extrapolated")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
