/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plausibility of a scene and of its results: rules that compare a number with its usual range, or
 * with the range in which the theory is valid. A number outside causes a warning; the result is
 * valid. Rules on numbers with units apply to scenes in SI units, rules on ratios to every scene.
 */
#ifndef PLAUSIBLE_H
#define PLAUSIBLE_H

#include <stdio.h>
#include "../text/json.h"
#include "../mesh/mesh.h"

enum { PLAUSIBLE_MOST = 24 };

typedef struct plausible_warning {
    const char *rule;    /* name of the plausibility rule that gave the warning */
    double value, limit; /* number that a plausibility rule has measured, and the limit of the usual
                            range that it exceeds or falls below; in SI units, or a ratio */
    const char *unit; /* unit of the number that a plausibility rule has measured, and of its usual
                         range */
    scene_at at;      /* position in the scene file to which the warning refers; line 0: the warning
                         refers to the whole scene */
    char text[SCENE_ERROR]; /* warning as text: "file:line:column: what was found; what to do" */
} plausible_warning;

/* List of plausibility warnings. All members must be 0 before the first use. */
typedef struct plausible {
    int count;
    int dropped; /* number of plausibility warnings not stored because the list was full */
    plausible_warning warning[PLAUSIBLE_MOST];
} plausible;

/* Apply the plausibility rules on the numbers of a scene that has been read without errors. */
void plausible_scene(plausible *warnings, const scene *scene);

/* Apply the plausibility rules on a mesh and its laminate. */
void plausible_mesh(plausible *warnings, const mesh *mesh);

/*
 * Apply the plausibility rules to a displacement. Each rule keeps its worst warning of all examined
 * displacements.
 *   displacement [free_dof] in  displacement vector of the structure
 *   is_linear               in  true if the displacement was computed with linear kinematics
 *   name                    in  name of the displacement in the text of a warning
 */
void plausible_result(plausible *warnings, const mesh *mesh, const double *displacement,
                      int is_linear, const char *name);

/*
 * Apply the plausibility rules on computed voltages.
 *   voltage [amplifiers] in  voltages of the amplifiers (V)
 */
void plausible_voltages(plausible *warnings, const scene *scene, const double *voltage,
                        const char *name);

/*
 * Properties of the optimal voltages for a target, which the plausibility rules compare with their
 * usual ranges.
 */
typedef struct plausible_optimum {
    double target; /* root mean square of the displacements that the voltages are to cause, relative
                      to the largest entry of the target; 0 where that entry is 0. The free
                      functions of the target (shapes that may be added at no cost) do not count */
    double error;  /* relative RMS error of the shape that the optimal voltages reach within the
                      voltage limits */
    double share;  /* largest absolute value of the optimal voltages relative to the largest voltage
                      limit; NAN without limits */
    int dependent; /* number of amplifiers whose columns of the influence matrix depend linearly on
                      the columns of other amplifiers; counted without regularisation */
    double reading; /* largest displacement of the target relative to the range of the sensors of
                       its nodes, beyond which the loop takes a reading as missing; 0: no range */
} plausible_optimum;

/*
 * Recovered stresses of the elements, to which plausibility rules are applied: reserve factors
 * against the strengths of the materials should be at least 1.
 */
struct stress_field;
void plausible_stress(plausible *warnings, const struct stress_field *field);

/* Apply the plausibility rules on the optimal voltages for a target. */
void plausible_target(plausible *warnings, const scene *scene, const plausible_optimum *optimum);

/*
 * Apply the plausibility rules on the load stepping to an equilibrium.
 *   difference      in  relative difference between the result and the one with twice as many load
 *       steps; infinite: those end before the full load; NAN: not known
 *   load_factor     in  part of the load that twice as many steps have reached
 *   negative_pivots in  number of negative pivots of the tangent stiffness at the equilibrium
 */
void plausible_path(plausible *warnings, const scene *scene, double difference, double load_factor,
                    unsigned negative_pivots);

/*
 * Warn if the static loads of a scene change the first natural frequency, because results for the
 * unloaded structure then do not hold under the loads.
 *   unloaded, loaded in  first natural frequency without and with the loads (Hz); 0: the
 *       equilibrium under the loads is unstable; NAN: not known
 */
void plausible_prestress(plausible *warnings, const scene *scene, double unloaded, double loaded);

/*
 * Warn if reversed amplifiers may not be noticed. The supervisor of the loop must tolerate that all
 * loads of the scene appear at once. If the loads move the target nodes far more than the voltages
 * do, the effect of reversed amplifiers lies within this tolerance. Displacements are root mean
 * squares over the target nodes (length unit of the scene).
 *   load  in  displacement under all loads
 *   reach in  displacement under half the voltage range of all amplifiers with random signs
 */
void plausible_loads(plausible *warnings, const scene *scene, double load, double reach);

/*
 * Warn about a stable control loop with a vibration model if sensor noise is as large as the
 * target, readings one tick older make the loop unstable, or the target is too large for linear
 * vibration.
 *   older     in  largest additional age of the readings (ticks) with which the loop is stable
 *   amplitude in  largest displacement of the target divided by the thickness of the structure
 *   noise     in  standard deviation of the sensors' noise over the root mean square of the target;
 *       0 where the target is zero
 */
void plausible_loop(plausible *warnings, const scene *scene, int older, double amplitude,
                    double noise);

/*
 * Warn if small errors of the entries of the influence matrix make the control loop unstable.
 *   margin in  largest standard deviation of random relative errors with which the loop is stable
 *   cure   in  how the margin becomes larger, as part of a sentence
 */
void plausible_matrix_errors(plausible *warnings, const scene *scene, double margin,
                             const char *cure);

/*
 * Largest shape error at the end of a simulation, over the largest without voltages, with which the
 * loop does not count as diverged.
 */
#define PLAUSIBLE_DIVERGENCE 2.5

/*
 * Warn if a simulated loop has diverged.
 *   error in  relative shape error at the end
 *   ratio in  this error divided by the largest one without voltages
 */
void plausible_end(plausible *warnings, const scene *scene, double error, double ratio);

/* Print plausibility warnings as a block of lines; print nothing where there are none. */
void plausible_print(FILE *file, const plausible *warnings);

/* Write plausibility warnings as the JSON list `warnings`, which is empty where there are none. */
void plausible_json(json *json, const plausible *warnings);

/*
 * Return the largest absolute principal strain at the centres of the elements, on both faces, or
 * NAN where memory runs out. Green's strain is 0 for every rigid motion, the linear strain only for
 * small ones.
 *   is_linear in   true: linear strain of a linear displacement; false: Green's strain
 *   where     out  index of the element with the largest strain
 */
double plausible_strain(const mesh *mesh, const double *displacement, int is_linear, int *where);

#endif
