# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/plant.txt: vibration of a structure by matrix exponentials.

    python3 write_plant.py
"""

import os

import numpy as np
from scipy.linalg import expm

import textdata
from write_data import DATA

HELP = """\
Vibration of structures given by their modes, under inputs that are constant between the steps:
q'' + 2 damping w q' + w^2 (q - g v) = 0, y = C q + (G - C g) v, by the exponential of the matrix of
the whole system with its inputs, one for each step.

    array frequency 1 modes    w (rad/s);  array damping 1 modes: damping ratio
    array shape rows modes     C;  array response modes inputs: g;  array static rows inputs: G
    array interval 1 steps     s
    array input steps inputs   v during the step
    array kick steps inputs    impulse of each input before the step, in seconds
    array output steps rows    y at the end of the step, under the inputs of the step
"""


def block(name, modes, rows, inputs, steps, seed):
    """One case of the file: (case name, words, arrays)."""
    draw = np.random.default_rng(seed)
    frequency = np.sort(10.0 ** draw.uniform(1, 4, modes))
    damping = 10.0 ** draw.uniform(-3, -0.5, modes)
    damping[-1] = 1.7                       # above critical damping
    if modes > 2:
        damping[-2] = 1.0                   # critical damping
    shape = draw.standard_normal((rows, modes))
    response = draw.standard_normal((modes, inputs))
    static = draw.standard_normal((rows, inputs))
    interval = 10.0 ** draw.uniform(-4, -2, steps)
    value = draw.standard_normal((steps, inputs)) * (draw.random((steps, 1)) < 0.6)
    kick = 1e-3 * draw.standard_normal((steps, inputs)) * (draw.random((steps, 1)) < 0.3)
    q, qt = np.zeros(modes), np.zeros(modes)
    output = []
    for k in range(steps):
        qt = qt + frequency**2 * (response @ kick[k])
        system = np.zeros((2 * modes + inputs,) * 2)
        system[:modes, modes:2 * modes] = np.eye(modes)
        system[modes:2 * modes, :modes] = -np.diag(frequency**2)
        system[modes:2 * modes, modes:2 * modes] = -np.diag(2 * damping * frequency)
        system[modes:2 * modes, 2 * modes:] = frequency[:, None]**2 * response
        # Scaled so that displacement and velocity over w have the same size.
        scale = np.r_[np.ones(modes), frequency, np.ones(inputs)]
        after = expm(system * scale[None, :] / scale[:, None] * interval[k]) @ (
            np.r_[q, qt, value[k]] / scale) * scale
        q, qt = after[:modes], after[modes:2 * modes]
        output.append(shape @ q + (static - shape @ response) @ value[k])
    return name, {}, {"frequency": frequency, "damping": damping, "shape": shape,
                      "response": response, "static": static, "interval": interval,
                      "input": value, "kick": kick, "output": np.array(output)}


def main():
    """Write the file."""
    blocks = [block("one", 1, 1, 1, 20, 1), block("few", 6, 3, 2, 40, 2), block("many", 24, 8, 5, 25, 3)]
    textdata.write(os.path.join(DATA, "plant.txt"), HELP, blocks)


if __name__ == "__main__":
    main()
