# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/stress.txt: stresses through the thickness by three-dimensional elasticity.

    python3 write_stress.py
"""

import os

import textdata
from stress_3d import cylinder, strip
from write_data import DATA

HELP = """\
Stresses by three-dimensional elasticity (stress_3d.py) at the lower face, the middle and the upper
face of each ply, from below.  E = 1 and nu = .3, or graphite/epoxy with E_T = 1.

Format as elements.txt.  word plies isotropic | cross [0/90/0] | around [90/0/90]
    array side 1 1      span or radius over height
    array stress n c    strip: s11 s22 s13 s33 (c = 4); cylinder: s11 s22 s12 s13 s23 s33 (c = 6)
"""


def blocks():
    """All cases of stress.txt."""
    out = []
    for make, laminates in ((strip, ("isotropic", "cross")), (cylinder, ("isotropic", "around"))):
        for name in laminates:
            for side in (4, 10, 50, 100):
                stress = make(side, name)
                out.append((f"{make.__name__}-{name}-{side}", dict(plies=name),
                            dict(side=[[side]], stress=stress.reshape(-1, stress.shape[2]))))
    return out


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "stress.txt"), HELP, blocks())
