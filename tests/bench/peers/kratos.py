# SPDX-License-Identifier: BSD-2-Clause
"""One case by Kratos, in the Python that has it:  kratos.py CASE MESH ELEMENT SOLVER STEPS

Prints one JSON object: steps, iterations, seconds, a, b; or {"failed": step} where a step did not converge.
Timed, as processor time, is the solution from the strategy's Initialize on; the import, the mesh and the model's making
are not.
"""

import json
import math
import sys
import time

import KratosMultiphysics as KM
import KratosMultiphysics.StructuralMechanicsApplication as SM
import KratosMultiphysics.LinearSolversApplication  # noqa: F401  registers its solvers
from KratosMultiphysics import python_linear_solver_factory

import cases

# A step ends where an increment is below TOLERANCE of the displacements. Measuring residuals instead (1e-6) costs one more
# assembly an iteration, doubles the time and moves the answers by 1e-6; but only it would notice a step too long:
# this criterion also ends on nonsense such as A = 214, so the number of steps is checked against many (run.py --search).
TOLERANCE, ITERATIONS = 1e-4, 50
ELEMENTS = {"thick-quad": ("ShellThickElementCorotational3D4N", "ReissnerMindlinShellElasticConstitutiveLaw"),
            "thin-triangle": ("ShellThinElementCorotational3D3N", "LinearElasticPlaneStress2DLaw")}
SOLVERS = {"amgcl": {"solver_type": "amgcl"}, "sparse_lu": {"solver_type": "LinearSolversApplication.sparse_lu"}}
MOVES = KM.DISPLACEMENT_X, KM.DISPLACEMENT_Y, KM.DISPLACEMENT_Z
TURNS = KM.ROTATION_X, KM.ROTATION_Y, KM.ROTATION_Z


def fill(part, case, element):
    """Nodes, elements, supports and loads of a case into an empty model part."""
    for variable in (KM.DISPLACEMENT, KM.ROTATION, KM.REACTION, KM.REACTION_MOMENT, KM.VOLUME_ACCELERATION, SM.POINT_LOAD):
        part.AddNodalSolutionStepVariable(variable)
    part.SetBufferSize(2)
    for k, point in enumerate(case.node):
        part.CreateNewNode(k + 1, *point)
    name, law = ELEMENTS[element]
    shell = part.CreateNewProperties(1)
    shell.SetValue(KM.YOUNG_MODULUS, case.young)
    shell.SetValue(KM.POISSON_RATIO, case.poisson)
    shell.SetValue(KM.THICKNESS, case.thickness)
    shell.SetValue(KM.DENSITY, 1.0)
    shell.SetValue(KM.CONSTITUTIVE_LAW, KM.KratosGlobals.GetConstitutiveLaw(law).Clone())
    corners = ((0, 1, 2, 3),) if element.endswith("quad") else ((0, 1, 2), (0, 2, 3))
    ids = ([quad[c] + 1 for c in corner] for quad in case.quad for corner in corners)
    for k, nodes in enumerate(ids):
        part.CreateNewElement(name, k + 1, nodes, shell)
    for moves, reactions in ((MOVES, (KM.REACTION_X, KM.REACTION_Y, KM.REACTION_Z)),
                             (TURNS, (KM.REACTION_MOMENT_X, KM.REACTION_MOMENT_Y, KM.REACTION_MOMENT_Z))):
        for move, reaction in zip(moves, reactions):
            KM.VariableUtils().AddDof(move, reaction, part)
    for k in case.clamped:
        for variable in MOVES + TURNS:
            part.GetNode(k + 1).Fix(variable)
    for k, normal, _ in case.symmetric:
        part.GetNode(k + 1).Fix(MOVES[normal])
        for axis in range(3):
            if axis != normal:
                part.GetNode(k + 1).Fix(TURNS[axis])
    for k, axis in case.held:
        part.GetNode(k + 1).Fix(MOVES[axis])
    for number, (k, _, _) in enumerate(case.force):
        part.CreateNewCondition("PointLoadCondition3D1N", number + 1, [k + 1], shell)


def strategy_of(part, solver):
    """Newton's method; the corotational elements diverge unless the mesh moves with the nodes (the last True)."""
    linear = python_linear_solver_factory.ConstructSolver(KM.Parameters(json.dumps(SOLVERS[solver])))
    criterion = KM.DisplacementCriteria(TOLERANCE, 1e-12)
    criterion.SetEchoLevel(0)
    strategy = KM.ResidualBasedNewtonRaphsonStrategy(
        part, KM.ResidualBasedIncrementalUpdateStaticScheme(), criterion, KM.ResidualBasedBlockBuilderAndSolver(linear),
        ITERATIONS, False, False, True)
    strategy.SetEchoLevel(0)
    return strategy


def solve(name, mesh, element, solver, steps):
    """One run in equal load steps."""
    case = cases.make(name, mesh)
    model = KM.Model()
    part = model.CreateModelPart("shell")
    fill(part, case, element)
    strategy = strategy_of(part, solver)
    iterations = 0
    begin = time.process_time()
    strategy.Initialize()
    strategy.Check()
    for step in range(1, steps + 1):
        part.CloneTimeStep(float(step))
        part.ProcessInfo[KM.STEP] = step
        for k, axis, size in case.force:
            load = [0.0, 0.0, 0.0]
            load[axis] = size * step / steps
            part.GetNode(k + 1).SetSolutionStepValue(SM.POINT_LOAD, load)
        strategy.InitializeSolutionStep()
        strategy.Predict()
        converged = strategy.SolveSolutionStep()
        strategy.FinalizeSolutionStep()
        iterations += part.ProcessInfo[KM.NL_ITERATION_NUMBER]
        ends = [sign * part.GetNode(k + 1).GetSolutionStepValue(MOVES[axis]) for k, axis, sign in case.read]
        if not converged or not all(map(math.isfinite, ends)):
            return {"failed": step}
    return {"steps": steps, "iterations": iterations, "seconds": time.process_time() - begin, "a": ends[0], "b": ends[1]}


def main():
    name, mesh, element, solver, steps = sys.argv[1:]
    KM.Logger.GetDefaultOutput().SetSeverity(KM.Logger.Severity.WARNING)
    KM.ParallelUtilities.SetNumThreads(1)
    print(json.dumps(solve(name, mesh, element, solver, int(steps))))


if __name__ == "__main__":
    main()
