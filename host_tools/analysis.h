/*
 * A scene run through the library: assemble, factor, solve, influence, voltages.
 * Host memory, device code.
 */
#ifndef ANALYSIS_H
#define ANALYSIS_H

#include "path.h"

typedef struct analysis {
    design design;
    pzs_model model;
    void *work;
    size_t work_bytes;
    path path;          /* where the scene's kinematics is not linear */
    double *influence;  /* [outputs][inputs], after analysis_influence */
    pzs_status status;  /* of the last equilibrium */
    double seconds;     /* that it took */
} analysis;

/*
 * Build, assemble and factor; where the kinematics is not linear, lay out a path at rest besides (its structure
 * may be loose at rest, held by a contact alone). Returns 0, or -1 with error filled and *a empty.
 */
int analysis_prepare(analysis *a, const scene *s, char *error);

/*
 * Displacement under the scene's loads and applied volts. u [dof] out.
 * Nonlinear: by load steps; where they end before the full load, the last equilibrium is in u and the message says so.
 */
int analysis_solve(analysis *a, double *u, char *error);

/* Whether analysis_solve runs the nonlinear path. */
int analysis_is_nonlinear(const analysis *a);

/* Value of the scene's k-th output at its i-th node. value [output rows] in, rows of the structure. */
double analysis_output(const analysis *a, int k, int i, const double *value);
/* Its number of values. */
int analysis_outputs(const analysis *a, int k);

/* Influence of every input on every output, and from it the voltage problem of the design. */
int analysis_influence(analysis *a, char *error);

void analysis_free(analysis *a);

typedef struct analysis_volts {
    char name[SCENE_NAME + 32]; /* what these volts are */
    double *volt;               /* [amplifiers] */
    double *shape;              /* [targets] B v and the displacement under the loads */
    double error;               /* |W (B v - wanted)| / |W wanted| */
    double optimality;          /* KKT violation / largest |B'W^2 wanted|; NAN where none is claimed */
    double limit[2];            /* the tightest limits of any amplifier */
    int active, passes;
} analysis_volts;

/*
 * The bounded optimum for the scene's target.
 *   limit  in  voltage limit that replaces the scene's, or NAN for the scene's own, or INFINITY for none
 * analysis_clipped: the unlimited optimum cut to that limit. analysis_given: volts as they are.
 */
int analysis_optimum(analysis *a, double limit, analysis_volts *v, char *error);
int analysis_clipped(analysis *a, double limit, analysis_volts *v, char *error);
int analysis_given(analysis *a, const char *name, const double *volt, analysis_volts *v, char *error);
void analysis_volts_free(analysis_volts *v);

#endif
