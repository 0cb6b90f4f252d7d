/*
 * A scene made ready for the library: its structure (inputs as columns, outputs as rows)
 * and, once the influence is known, its voltage problem. Everything is plain arrays in double.
 */
#ifndef DESIGN_H
#define DESIGN_H

#include "mesh.h"

typedef struct design {
    const scene *scene;
    mesh mesh;
    pzs_structure structure; /* inputs: amplifiers, then loads; outputs: target nodes, then named outputs */
    int amplifiers;          /* the first inputs */
    int targets;             /* the first outputs */
    int *target_node;        /* [targets] node of each */
    int *named_first;        /* [scene outputs + 1] first row of each named output */
    double *target;          /* [targets] wanted displacement */
    double *wanted;          /* [targets] the same less the displacement under the scene's loads: what the volts must do */
    double *weight;          /* [targets] */
    double *influence;       /* [targets][amplifiers] after design_control */
    double *hessian;         /* [amplifiers][amplifiers] */
    double *lower, *upper, *slew, *prefer; /* [amplifiers] */
    pzs_problem problem;
} design;

/* Build mesh, columns and rows of a checked scene, which must outlive the design. Returns 0, or -1 with error filled. */
int design_build(design *d, const scene *s, char *error);

/*
 * Build the voltage problem.
 *   influence [outputs][inputs] in  of the whole structure, from pzs_influence
 * Returns 0, or -1 with error filled.
 */
int design_control(design *d, const double *influence, char *error);

void design_free(design *d);

/*
 * Displacement of a node as weights on its unknowns, (mean, difference/h) order.
 *   weight [7] out
 */
void design_output_weights(const mesh *m, int node, scene_component component, scene_face face, double weight[7]);

#endif
