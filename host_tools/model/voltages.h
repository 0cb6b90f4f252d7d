/*
 * Voltages for a scene's target: the bounded optimum on the linear or the nonlinear structure, and
 * others to compare with it. Each is a set of volts with the shape it really reaches on the
 * structure asked about.
 */
#ifndef VOLTAGES_H
#define VOLTAGES_H

#include "analysis.h"

typedef struct voltages {
    char name[SCENE_NAME + 32]; /* what these volts are */
    int amplifiers;
    double *voltage;        /* [volts] one an amplifier */
    double *u;              /* [dof] displacement under them and the scene's loads */
    double *shape;          /* [targets] its part that the target is about */
    double *aligned_target; /* [targets] target, with as much of its free functions as fits the
                    shape best */
    double error;           /* |W P (shape - target)| / |W P (target - shape without voltages)|,
                               linear, over the rows that can move, P taking the free functions
                               out; NAN: no equilibrium found */
    double error_all;       /* the same if the rows that cannot move were counted */
    int fixed_off;          /* rows that cannot move and are not where the target wants them */
    double optimality;      /* KKT violation / largest |B'W^2 wanted|; NAN where none is claimed */
    double limit[2];        /* V, lowest and highest that any amplifier may give */
    int held, narrowed;     /* amplifiers that are held; of the others, those with a narrower
                               range than limit */
    double residual;        /* of the displacement */
    double regularisation;  /* of voltages_regularised, over tr(B'W^2 B)/n; 0 elsewhere */
    int active_limits, iterations; /* amplifiers at a limit, held ones not counted; passes of the
                           optimiser */
    int relinearised;              /* times the influence was computed anew at the shape reached */
    int linear_solves;             /* linear systems solved on the nonlinear structure */
} voltages;

/*
 * The bounded optimum for the scene's target, after analysis_influence. On the nonlinear structure
 * (a->nonlinear): Gauss-Newton with the influence at the shape reached, from the linear optimum
 * (the part of it that has an equilibrium), within a reach that shrinks where the error does not
 * fall, until it stops falling. common in  which common voltage limits (design.h); the narrowest
 * limit of an amplifier always applies voltages_linear: the optimum of the linear model, its shape
 * that of the structure asked about. voltages_clipped: linear least squares without limits, then
 * cut to them. voltages_regularised: the same with the one regularisation parameter that leaves the
 * smallest error of the linear model after cutting, chosen knowing that error. voltages_given:
 * voltages as they are. Each returns 0, or -1 with error filled.
 */
int voltages_optimum(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_linear(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_clipped(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_regularised(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_given(analysis *analysis, const char *name, const double *voltage, voltages *result,
                   char *error);
void voltages_free(voltages *result);

#endif
