# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/sandwich.txt: sandwich plates by three-dimensional elasticity.

    python3 write_sandwich.py
"""

import os

import textdata
from cases import sandwich_3d
from write_data import DATA

HELP = """\
Simply supported unit square under sin(pi x) sin(pi y) on top: displacement of its middle by
three-dimensional elasticity (cases.py, sandwich_3d).

Format as elements.txt.  E = 1 of the faces, each a tenth of the height; core of 1/ratio; nu = .3.
    array side 1 1   side over height;  array ratio 1 1
    array w 1 1      displacement of the middle
"""


def blocks():
    """All cases of sandwich.txt."""
    return [(f"sandwich-{side}-{ratio}", {}, dict(side=[[side]], ratio=[[ratio]],
                                                  w=[[sandwich_3d(side, ratio)]]))
            for side in (10, 50) for ratio in (1, 100, 1000, 10000)]


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "sandwich.txt"), HELP, blocks())
