/*
 * A scene run through the library: assemble, factor, solve, influence, voltages.
 * Host memory, device code.
 */
#ifndef ANALYSIS_H
#define ANALYSIS_H

#include "certificate.h"
#include "equilibrium.h"
#include "plausible.h"

typedef struct analysis {
    design design;
    pzs_model model;
    void *work;
    size_t work_bytes;
    equilibrium equilibrium; /* where the scene's kinematics is not linear */
    pzs_electric electric;   /* where the design has electrodes, after the stiffness at rest is
                                factored */
    void *electric_work;
    double *input_value; /* [inputs] of the last displacement, volts of open electrodes as they were
                       found */
    double *charge;      /* [electrodes] at the last displacement */
    int nonlinear; /* which of the two analysis_solve and analysis_reach run; first what the scene
                      says */
    double *influence; /* [outputs][inputs] at rest, after analysis_influence */
    pzs_status status; /* of the last equilibrium */
    struct {
        double assemble, factor, solve;
    } seconds;               /* of the stiffness at rest, and of the last displacement */
    certificate certificate; /* of vibration, after certificate_make */
    int quasi_static; /* tables of a control loop that vibration makes unstable are wanted all the
                         same */
    double linear_error; /* kinematics auto: difference of the linear displacement over the
                            nonlinear one */
    plausible warnings;  /* of the scene and its results so far, for the reader */
} analysis;

/*
 * Build, assemble and factor; where the kinematics is not linear, lay out a path at rest besides
 * (its structure may be loose at rest, held by a contact alone). Returns 0, or -1 with error filled
 * and *a empty.
 */
int analysis_prepare(analysis *analysis, const scene *scene, char *error);

/*
 * Displacement under the scene's loads and applied volts, from rest. u [dof] out. Kinematics auto:
 * both, and then a->nonlinear says which one is in u, the linear one where its cost is within the
 * scene's tolerance. Nonlinear: where the load steps end before the full load, the last equilibrium
 * is in u and the message says so.
 */
int analysis_solve(analysis *analysis, double *u, char *error);

/*
 * The same under other volts.
 *   volt [amplifiers] in
 *   warm           in  nonlinear: from the shape reached last instead of from rest
 */
int analysis_reach(analysis *analysis, const double *voltage, int warm, double *u, char *error);

/*
 * a->amount and a->charge at the last equilibrium of the path, or of a linear structure under
 * amounts; the solving calls do this. amount [inputs] in  open electrodes left out: their volts are
 * found
 */
pzs_status analysis_electrodes(analysis *analysis, const double *amount);

/* Whether a->status says that the load steps ended before the full load. */
int analysis_ended_early(const analysis *analysis);

/* Value of the scene's k-th output at its i-th node. value [output rows] in, rows of the structure.
 */
double analysis_output(const analysis *analysis, int k, int i, const double *value);
/* Its number of values. */
int analysis_outputs(const analysis *analysis, int k);
/* Mesh node of its i-th value; -1 for electrodes and for the force and the number of nodes of the
 * whole contact. */
int analysis_output_node(const analysis *analysis, int k, int i);
/* Name of the electrode of its i-th value; the output is a voltage or a charge. */
void analysis_output_electrode(const analysis *analysis, int k, int i, char name[SCENE_LABEL]);

/* Charge per volt of electrode k itself: the shell held, or free as its supports leave it and no
 * other electrode with volts. */
double analysis_capacitance(const analysis *analysis, int k, int is_free);

/*
 * Stiffness at rest with the sensors open over that with all of them short, as the scene's loads
 * (temperatures left out) feel it; NAN where there are no loads or no open sensors, and on a
 * nonlinear structure.
 */
double analysis_stiffening(analysis *analysis);

/* Influence at rest of every input on every output, and from it the voltage problem of the design;
 * once. */
int analysis_influence(analysis *analysis, char *error);

/* The message of a status of the library, with the place it names on the mesh. Returns -1. */
int analysis_explain(const analysis *analysis, pzs_status status, char *error);

void analysis_free(analysis *analysis);

/* Seconds of a clock that only runs forward. */
double analysis_now(void);

#endif
