#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Does the interval of --error contain the converged value? Benchmark scenes x meshes x elements.

The converged value is the extrapolated one of the finest mesh of the same element: on thick plates
the elements converge to different values, because they treat the normal strain differently. Fails
when less than 95 % of the intervals contain it. Usage: mesh_error.py PZS
"""
import json
import subprocess
import sys

# elements along theta1 and theta2 of the coarsest mesh, and its refinements for the converged value
SCENES = {
    'scordelis-lo': ((8, 8), 8), 'pinched-cylinder': ((8, 8), 8), 'hemisphere-linear': ((8, 8), 8),
    'clamped-plate': ((8, 8), 8), 'crossply': ((8, 8), 8), 'vlasov-plate': ((8, 8), 8),
    'varadan-cylinder': ((8, 8), 8), 'hyperboloid': ((8, 8), 4), 'hemisphere': ((8, 8), 4),
    'hyperboloid-soft': ((8, 8), 8), 'annular-plate': ((8, 64), 4),
}


def solve(pzs, scene, element, mesh):
    """Results of one scene: name -> value, extrapolated, uncertainty, order."""
    command = [pzs, 'solve', scene, '--error', '--json', '--set', 'element=' + element]
    for axis in (0, 1):
        command += ['--set', 'mesh.theta%d.elements=%d' % (axis + 1, mesh[axis])]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(run.stderr)
    return json.loads(run.stdout)['discretisation']['results']


def main():
    pzs = sys.argv[1]
    inside = cases = 0
    print('%-18s %-9s %-7s %7s  %12s  %8s  %8s  %8s' % (
        'scene', 'element', 'output', 'mesh', 'converged', 'error', 'extrap.', '+-'))
    for scene, (coarsest, refinement) in SCENES.items():
        finest = [refinement * n for n in coarsest]
        for element in ('improved', 'published'):
            converged = solve(pzs, scene, element, finest)
            for factor in (1, 2, 4):
                if factor >= refinement:
                    continue
                mesh = [factor * n for n in coarsest]
                for name, row in solve(pzs, scene, element, mesh).items():
                    true = converged[name]['extrapolated']
                    good = abs(row['extrapolated'] - true) <= row['uncertainty']
                    cases += 1
                    inside += good
                    print('%-18s %-9s %-7s %3dx%-3d  %12.5g  %+7.2f%%  %+7.2f%%  %7.2f%%%s' % (
                        scene, element, name, mesh[0], mesh[1], true,
                        100 * (row['value'] / true - 1), 100 * (row['extrapolated'] / true - 1),
                        100 * row['uncertainty'] / abs(true), '' if good else '  outside'))
    print('%d of %d intervals contain the converged value' % (inside, cases))
    sys.exit(inside < 0.95 * cases)


main()
