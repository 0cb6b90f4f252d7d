/*
 * Plausibility of a scene and of its results: rules that compare a number with the range in which
 * it is usual, or in which the theory holds. What lies outside is a warning: the result is valid,
 * but the user should be told.
 *
 * Rules on numbers with units need the scene's `units` to be SI units and are silent where they are
 * not. Rules on ratios apply to every scene.
 */
#ifndef PLAUSIBLE_H
#define PLAUSIBLE_H

#include <stdio.h>
#include "../text/json.h"
#include "../mesh/mesh.h"

enum { PLAUSIBLE_MOST = 24 };

typedef struct plausible_warning {
    const char *rule;    /* its name */
    double value, limit; /* what was found, the end of the range that it passes; SI units or a ratio
                          */
    const char *unit;    /* of both */
    scene_at at;         /* line 0: the scene as a whole */
    char text[SCENE_ERROR]; /* "file:line:column: what was found; what to do" */
} plausible_warning;

/* Zeroed before its first use. */
typedef struct plausible {
    int count;
    int dropped; /* warnings that found no room */
    plausible_warning warning[PLAUSIBLE_MOST];
} plausible;

/* Rules on the numbers of a checked scene. */
void plausible_scene(plausible *warnings, const scene *scene);

/*
 * Rules on a displacement; of several displacements the worst is kept for each rule.
 *   u         [dof] in
 *   is_linear       in  found with small displacements
 *   name            in  of the result, for the text
 */
void plausible_result(plausible *warnings, const mesh *mesh, const double *u, int is_linear,
                      const char *name);

/* Rules on voltages that were found. volt [amplifiers] in */
void plausible_voltages(plausible *warnings, const scene *scene, const double *voltage,
                        const char *name);

/* A block of lines, nothing where there are no warnings. */
void plausible_print(FILE *file, const plausible *warnings);

/* The list `warnings`, empty where there are none. */
void plausible_json(json *json, const plausible *warnings);

/*
 * Largest principal strain in the middle of the elements, on both faces, without its sign: of first
 * order where the displacement is linear, else that of Green. Rigid motions (linear: rigid motions
 * of first order) have none. where [2] out  theta1, theta2 of the element's middle Returns the
 * strain, or NAN where memory runs out.
 */
double plausible_strain(const mesh *mesh, const double *u, int is_linear, double where[2]);

#endif
