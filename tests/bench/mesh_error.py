#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Does the interval of --error contain the converged value? Scenes x meshes x elements.

The scenes are the benchmarks, and those of the folder error_scenes: other shapes, dimensions, loads,
laminates and natural frequencies, with which the estimate was not developed.

The converged value is the extrapolated one of the finest mesh of the same element: on thick plates
the elements converge to different values, because they treat the normal strain differently. Fails
when less than 95 % of the intervals of either group contain it. Usage: mesh_error.py PZS
"""
import glob
import json
import os
import subprocess
import sys

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'error_scenes')
# elements along theta1 and theta2 of the coarsest mesh, and its refinements for the converged value
BENCHMARKS = {
    'scordelis-lo': ((8, 8), 8), 'pinched-cylinder': ((8, 8), 8), 'hemisphere-linear': ((8, 8), 8),
    'clamped-plate': ((8, 8), 8), 'crossply': ((8, 8), 8), 'vlasov-plate': ((8, 8), 8),
    'varadan-cylinder': ((8, 8), 8), 'hyperboloid': ((8, 8), 4), 'hemisphere': ((8, 8), 4),
    'hyperboloid-soft': ((8, 8), 8), 'annular-plate': ((8, 64), 4), 'cantilever': ((8, 2), 8),
    'hyperbolic-paraboloid': ((16, 8), 8), 'ring-follower': ((8, 2), 8),
    'torus-isotropic': ((24, 2), 8), 'pulled-cylinder': ((8, 12), 4), 'tyre-section': ((16, 16), 4),
    'ring-contact': ((40, 2), 4), 'spiral': ((2, 64), 8), 'crawley-lazarus': ((20, 12), 4),
    'actuator-beam': ((20, 12), 4), 'roll-up': ((8, 2), 8), 'shear-bender': ((8, 2), 8),
    'bimorph-actuator': ((10, 2), 8), 'bimorph-sensor': ((20, 2), 8), 'heated-bimetal': ((8, 2), 8),
    'thermal-bimorph': ((8, 8), 8),
}
# counts, which do not converge with the mesh as displacements do
COUNTS = ('nodes',)

OTHERS = {path: ((16, 8) if path.endswith('torus.yaml') else (8, 8), 8)
          for path in sorted(glob.glob(os.path.join(FOLDER, '*.yaml')))}
# surfaces given by formulas, for which there is no published element, and a shell that turns by a
# right angle, with which the seven dof of its nodes leave the load path
IMPROVED_ALONE = ('saddle', 'dish', 'hyperbolic-paraboloid', 'pulled-cylinder')


def name_of(scene):
    """Name of a scene given by its name or its path."""
    return os.path.splitext(os.path.basename(scene))[0]


def estimate(pzs, scene, element, mesh):
    """Results of one scene: name -> value, extrapolated, uncertainty, order."""
    command = ['modes', scene, '--number', '4'] if name_of(scene).startswith('modes-') else \
        ['solve', scene]
    command += ['--error', '--json', '--set', 'element=' + element]
    command += ['--set', 'dof_per_node=7'] if element == 'published' else []
    for axis in (0, 1):
        command += ['--set', 'mesh.theta%d.elements=%d' % (axis + 1, mesh[axis])]
    run = subprocess.run([pzs] + command, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(run.stderr)
    return json.loads(run.stdout)['discretisation']['results']


def check_mesh(pzs, scene, element, mesh, converged):
    """Number of results on one mesh, and how many of their intervals contain the converged one."""
    inside = cases = 0
    largest = max(abs(row['extrapolated']) for row in converged.values())
    for name, row in estimate(pzs, scene, element, mesh).items():
        true = converged[name]['extrapolated']
        if name in COUNTS or abs(true) < sys.float_info.epsilon * largest:
            continue
        good = abs(row['extrapolated'] - true) <= row['uncertainty']
        cases += 1
        inside += good
        print('%-20s %-9s %-7s %3dx%-3d  %12.5g  %+7.2f%%  %+7.2f%%  %7.2f%%%s' % (
            name_of(scene), element, name, mesh[0], mesh[1], true,
            100 * (row['value'] / true - 1), 100 * (row['extrapolated'] / true - 1),
            100 * row['uncertainty'] / abs(true), '' if good else '  outside'))
    return inside, cases


def check_scenes(pzs, scenes):
    """Print the results of some scenes; whether 95 % of the intervals contain the converged one."""
    inside = cases = 0
    print('%-20s %-9s %-7s %7s  %12s  %8s  %8s  %8s' % (
        'scene', 'element', 'output', 'mesh', 'converged', 'error', 'extrap.', '+-'))
    for scene, (coarsest, refinement) in scenes.items():
        for element in ('improved', 'published'):
            if element == 'published' and name_of(scene) in IMPROVED_ALONE:
                continue
            converged = estimate(pzs, scene, element, [refinement * n for n in coarsest])
            for factor in (1, 2, 4):
                if factor >= refinement:
                    continue
                mesh = [factor * n for n in coarsest]
                found = check_mesh(pzs, scene, element, mesh, converged)
                inside, cases = inside + found[0], cases + found[1]
    print('%d of %d intervals contain the converged value' % (inside, cases))
    return inside >= 0.95 * cases


def main():
    good = [check_scenes(sys.argv[1], scenes) for scenes in (BENCHMARKS, OTHERS)]
    sys.exit(not all(good))


main()
