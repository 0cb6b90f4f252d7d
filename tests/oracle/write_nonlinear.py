# SPDX-License-Identifier: BSD-2-Clause
"""Write tests/oracle/data/nonlinear.txt: converged nonlinear states.

    python3 write_nonlinear.py
"""

import os

import numpy as np

import nonlinear_cases as nc
import textdata
from contact import contact_newton
from newton import external, newton
from shellref import IMPROVED, PUBLISHED
from write_data import DATA

HELP = """\
Converged states of nonlinear shells, iterated until the increment is 1e-10 of the displacement.

Format as elements.txt.  Unknowns of a node: mean u1 u2 u3; (u+ - u-)/h of 1 2 3; (u3M - mean u3)/h.
    word element              improved | published
    array mesh 1 2            elements along theta1, theta2
    array u nodes 7           node = i n2 + j, theta2 fastest
    array good 1 1            change of u, relative to its largest displacement, by one more system
    array outputs 1 k         the numbers of the table, see below
    array systems 1 2         a stopping tolerance and the linear systems solved to it in one load step; stop: norm of
                              (u-, u+, u3M) of all nodes of the increment over that of the step's total; the first
                              system is linear; extrapolated resultants throughout
    array residual 1 1        |F - internal|/|F| of the free unknowns scaled to unit diagonal at rest, at that tolerance
    array negative 1 1        negative pivots of the tangent
Cases:
    hemisphere                R 10, h .04, E 6.825e7, nu .3; theta1 polar angle 18..90, theta2 0..90 degrees; theta2 edges
                              symmetric; mean u1 = 0 at (18, 45); force along e3 -200 at (90, 0), 200 at (90, 90);
                              outputs -u3M, u3M there
    annular                   r 6..10, theta2 0..360 degrees, h .03, E 21e6, nu 0; theta2- clamped; .8 per length along
                              e3 on theta2+, end nodes half; outputs u3M at (6, 360), (10, 360)
    ring-follower             theta1 the angle 0..90 degrees, theta2 axial 0..1, R 100, h 1, E 2.1e7, nu .3; theta1 edges
                              symmetric; u2 = 0; pressure -p0 (1 - cos 2 theta1) along the normal on the inner face,
                              p0 = 3 E h^3/(12 (1 - nu^2) R^3); word pressure unit (size per reference area, normal of
                              the outer face) or true (per deformed area of the inner face); nodal values; published:
                              consistent weights; improved: lumped (follower.py); symmetrised load stiffness; outputs
                              u3M/R at 0, -u3M/R at 90 degrees
    ring-contact              half ring theta1 0..180, theta2 axial 0..1, same R h E nu; theta1 edges symmetric, u2 = 0 on
                              theta2- (faces); force along e3 -P/4 at both nodes of 180, P = 88.5 E/(120 R^2); outer face
                              against the rigid cylinder of radius 1000 about (1100.5, 0), R along +x at theta1 = 0;
                              outputs 120 R^2/E times twice the resultant, -u3M(180); array weight, multiplier
                              (force per area, <= 0), active [nodes][1], kappa; array force 1 3 on the half shell
    roll-up                   strip theta1 = x 0..10, theta2 = y 0..1, h .1, E 1e6, nu 0; x = 0 clamped; given resultants
                              -D e0, e0 = curvature making a full (word turn 1) or half circle: 11d = -h 2 pi turn/10;
                              outputs mean u1, u3M at (10, 0)
    hyperboloid               r = 7.5 sqrt(1 + 3 z^2/400), theta1 = -z 0..20, theta2 0..90 degrees; h .04, three plies
                              [0/90/0], 0 = around; E_L 4e7, E_T 1e6, G 6e5, nu .25; theta1-, theta2-, theta2+
                              symmetric; force along e3 100 at (0, 0), -100 at (0, 90); outputs u3M there
"""


def correction(c, result):
    """What one more system (true tangent) would change, relative to the largest face displacement."""
    shell, u = c.shell, result.u
    matrix, internal, _ = shell.assemble(u, None, 1.0)
    force, load_stiffness = external(shell, u, 1.0, c.dead, c.followers)
    if load_stiffness is not None:
        matrix = matrix - load_stiffness
    if c.contact is not None:
        push, stiff = c.contact.terms(*c.contact.geometry(u, 1.0))
        force, matrix = force + push, matrix + stiff
    du = shell.solve(matrix, force - internal)
    return np.abs(shell.faces(du)).max() / np.abs(shell.faces(u)).max()


def solve(make, eps):
    """Case and result at eps and at 1e-10."""
    for tolerance in (eps, 1e-10):
        c = make()
        if c.contact is None:
            result = newton(c.shell, c.dead, c.followers, eps=tolerance, mixed=1000)
        else:
            result = contact_newton(c.shell, c.contact, c.dead, c.followers, eps=tolerance, cuts=0)
        if tolerance == eps:
            first = result
    return c, first, result


def block(name, make, eps, element, mesh, words, quiet):
    """One case of the file."""
    c, first, last = solve(make, eps)
    good = correction(c, last)
    arrays = dict(mesh=[mesh], u=last.u.reshape(-1, c.shell.model.unknowns), good=[[good]], outputs=[c.read(last.u)],
                  systems=[[eps, first.systems]], residual=[[first.residual]], negative=[[last.negative]])
    if c.contact is not None:
        arrays.update(weight=c.contact.weight[:, None], multiplier=c.contact.multiplier[:, None],
                      active=c.contact.active[:, None], kappa=[[1.0]], force=[c.contact.resultant(last.u, 1)])
    if not quiet:
        print(f"{name:28s} systems {first.systems} ({first.residual:.1e}) last {last.systems} "
              f"({last.residual:.1e}) good {good:.1e} negative {last.negative} outputs", c.read(last.u))
    return name, dict(element=element, **words), arrays


def blocks(quiet=False):
    """All cases of nonlinear.txt."""
    out = []
    for word, preset in (("published", PUBLISHED), ("improved", IMPROVED)):
        def add(name, case, eps, mesh, **words):
            out.append(block(f"{name}-{word}", case, eps, word, mesh, words, quiet))
        add("hemisphere-4x4", lambda: nc.hemisphere(4, preset), 1e-4, (4, 4))
        add("annular-2x4", lambda: nc.annular(2, 4, preset), 1e-4, (2, 4))
        for kind in ("unit", "true"):
            add(f"ring-follower-{kind}", lambda: nc.pressed_ring(18, preset, kind), 1e-6, (18, 1), pressure=kind)
        add("ring-contact", lambda: nc.ring_on_body(30, preset), 1e-6, (30, 1))
        for turn in (0.5, 1):
            add(f"roll-up-{turn}", lambda: nc.roll_up(10, preset, turn), 1e-6, (10, 1), turn=turn)
        add("hyperboloid-8x8", lambda: nc.free_hyperboloid(8, (0, 90, 0), preset), 1e-4, (8, 8))
    return out


if __name__ == "__main__":
    textdata.write(os.path.join(DATA, "nonlinear.txt"), HELP, blocks())
