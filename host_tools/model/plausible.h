/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plausibility of a scene and of its results: rules that compare a number with its usual range, or
 * with the range in which the theory holds. A number outside is a warning: the result is valid, but
 * the user should be told.
 *
 * Rules on numbers with units apply to scenes whose `units` are SI units. Rules on ratios apply to
 * every scene.
 */
#ifndef PLAUSIBLE_H
#define PLAUSIBLE_H

#include <stdio.h>
#include "../text/json.h"
#include "../mesh/mesh.h"

enum { PLAUSIBLE_MOST = 24 };

typedef struct plausible_warning {
    const char *rule;    /* name of the rule */
    double value, limit; /* the number and the end of the range that it exceeds; SI units or a ratio
                          */
    const char *unit;    /* unit of both */
    scene_at at;         /* position in the scene file; line 0: the scene as a whole */
    char text[SCENE_ERROR]; /* "file:line:column: what was found; what to do" */
} plausible_warning;

/* Warnings; all members are 0 before the first use. */
typedef struct plausible {
    int count;
    int dropped; /* number of warnings for which no entry was free */
    plausible_warning warning[PLAUSIBLE_MOST];
} plausible;

/* Apply the rules on the numbers of a checked scene. */
void plausible_scene(plausible *warnings, const scene *scene);

/* Apply the rules on a mesh and its laminate. */
void plausible_mesh(plausible *warnings, const mesh *mesh);

/*
 * Apply the rules on a displacement of a structure; of several displacements the worst is kept for
 * each rule. u [free_dof] in  displacement is_linear    in  whether it was computed with linear
 * kinematics name         in  name of the result in the text
 */
void plausible_result(plausible *warnings, const mesh *mesh, const double *displacement,
                      int is_linear, const char *name);

/* Apply the rules on computed voltages. voltage [amplifiers] in, V */
void plausible_voltages(plausible *warnings, const scene *scene, const double *voltage,
                        const char *name);

/* What the rules on the optimum of a target compare. */
typedef struct plausible_optimum {
    double target; /* root mean square of what the voltages are to correct, without the free
                      functions, over the largest entry of the target; 0 where that is 0 */
    double error;  /* shape error of the optimum within the limits, relative to the target */
    double share;  /* largest absolute voltage of the optimum over the largest limit; NAN: no limit
                    */
} plausible_optimum;

/* Apply the rules on the optimum of a target. */
void plausible_target(plausible *warnings, const scene *scene, const plausible_optimum *optimum);

/*
 * Apply the rules on the way to an equilibrium.
 *   difference      in  of analysis_path_difference
 *   negative_pivots in  of the tangent at the equilibrium
 */
void plausible_path(plausible *warnings, const scene *scene, double difference,
                    unsigned negative_pivots);

/*
 * Apply the rule on a certified loop with a vibration model.
 *   older  in  ticks by which readings may be older than the scene says
 */
void plausible_loop(plausible *warnings, const scene *scene, int older);

/* Print the warnings as a block of lines; nothing where there are none. */
void plausible_print(FILE *file, const plausible *warnings);

/* Write the JSON list `warnings`, empty where there are none. */
void plausible_json(json *json, const plausible *warnings);

/*
 * Largest absolute principal strain at the centres of the elements, on both faces: linear strains
 * where the displacement is linear, else Green's strains. Rigid motions (linear: of first order)
 * cause none.
 *   where [2]  out  theta1, theta2 of the element's centre
 * Returns the strain, or NAN where memory runs out.
 */
double plausible_strain(const mesh *mesh, const double *displacement, int is_linear, int *where);

#endif
