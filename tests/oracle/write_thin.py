# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/thin.txt: references for thin shells of revolution.

    python3 write_thin.py
"""

import os

import numpy as np

import cases
import textdata
from revolution import CASES, THICKNESSES, compliance
from shellref import IMPROVED
from write_data import DATA

HELP = """\
Thin shells of revolution under a pressure cos(n theta2): compliance by the Naghdi shell of
revolution (revolution.py: one harmonic, spectral elements along the meridian).

Format as elements.txt.  E = 1, nu = .3, middle surface in the middle of the thickness, radius 1.
    word surface              cylinder, sphere (theta1 = angle from the pole, rad) or hyperboloid
                              (r = waist sqrt(1 + slope t1^2), z = -t1); theta2 = angle around
    array surface 1 k         radius; hyperboloid: waist, slope
    array cell 1 4            t1a t1b t2a t2b of the structure, a quarter of the circle
    word theta1- theta1+      supports of the edges: clamped, simple (diaphragm), symmetric, free
    word theta2- theta2+      symmetric; simple where cos(n theta2) = 0
    array harmonic 1 1        n;  array h 1 1: thickness (= h/R)
    array compliance 1 1      integral of pressure times normal displacement over the cell, pressure
                              cos(n theta2) along e3 per area of the middle surface
    array finer 1 1           relative change of the compliance by a finer discretisation
    array improved 3 2        elements along each side of a uniform mesh; compliance of the improved
                              element of shellref.py over that of the reference.  Load on the means:
                              sum over s of area/36 [4 2 1 2] E_r E_s^T e3 cos(n theta2_s).  Solved
                              with the residual formed from strains in extended precision
"""


def block(name, h):
    """One case of the file: (case name, words, arrays)."""
    surface, numbers, span, harmonic, supports = CASES[name]
    exact = compliance(name, h)
    finer = compliance(name, h, degree=16, refine=2)
    ratios = [[n, cases.thin_shell(n, IMPROVED, name, h) / exact] for n in (4, 8, 16)]
    words = {"surface": surface, "theta1-": supports[0], "theta1+": supports[1],
             "theta2-": "symmetric", "theta2+": "simple" if harmonic % 2 else "symmetric"}
    arrays = dict(surface=[numbers], cell=[[*span, 0.0, np.pi / 2]], harmonic=[[harmonic]], h=[[h]],
                  compliance=[[exact]], finer=[[finer / exact - 1]], improved=ratios)
    return f"{name}-{h:.0e}", words, arrays


def blocks():
    """All cases of thin.txt."""
    return [block(name, h) for name in CASES for h in THICKNESSES]


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "thin.txt"), HELP, blocks())
