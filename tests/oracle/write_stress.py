# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/stress.txt: stresses through the thickness by three-dimensional elasticity.

    python3 write_stress.py
"""

import os

import textdata
from stress_3d import cylinder, first_order, plate, strip
from write_data import DATA

HELP = """\
Stresses by three-dimensional elasticity (stress_3d.py) at the lower face, the middle and the upper
face of each ply, from below.  E = 1 and nu = .3, or graphite/epoxy with E_T = 1.

Format as elements.txt.  word plies isotropic | cross [0/90/0] | around [90/0/90]
    array side 1 1      span or radius over height
    array stress n c    strip: s11 s22 s13 s33 (c = 4); plate and cylinder: s11 s22 s12 s13 s23
                        s33 (c = 6)
    array deflection 1 3    cylinder: displacement along the normal at the middle of the thickness;
                        the same by the exact solution of the first-order theory, with a uniform
                        shear strain, and with the shear stiffness from equilibrium
"""


def flat_blocks(make, name, side):
    """Case of one strip or plate."""
    stress = make(side, name)
    return (f"{make.__name__}-{name}-{side}", dict(plies=name),
            dict(side=[[side]], stress=stress.reshape(-1, stress.shape[2])))


def cylinder_blocks(name, side):
    """Case of one cylinder."""
    stress, deflection = cylinder(side, name)
    theory = [first_order(side, name, equilibrium) for equilibrium in (False, True)]
    return (f"cylinder-{name}-{side}", dict(plies=name),
            dict(side=[[side]], stress=stress.reshape(-1, stress.shape[2]),
                 deflection=[[deflection] + theory]))


def blocks():
    """All cases of stress.txt."""
    sides = (4, 10, 50, 100)
    flat = [flat_blocks(make, name, side) for make in (strip, plate)
            for name in ("isotropic", "cross") for side in sides]
    return flat + [cylinder_blocks(name, side) for name in ("isotropic", "around", "cross")
                   for side in sides]


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "stress.txt"), HELP, blocks())
