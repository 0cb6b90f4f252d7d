/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Runs a scene through the library: assembly, factorisation, solution, influence matrix, voltages.
 * The memory is the host's, the code is that of the device.
 */
#ifndef ANALYSIS_H
#define ANALYSIS_H

#include "certificate.h"
#include "equilibrium.h"
#include "load_path.h"
#include "mesh_error.h"
#include "plausible.h"

struct analysis;

/*
 * Where the displacements of an analysis come from: a structure, whose stiffness is factored, or a
 * measured influence matrix (analysis_matrix.c). Everything after the influence matrix is the same
 * for both.
 */
typedef struct analysis_source {
    bool has_structure; /* there are elements, a stiffness, loads and mass */
    /*
     * Prepare what displacements are computed from, after the design. Returns 0, or -1 with error
     * filled.
     */
    int (*open)(struct analysis *analysis, char *error);
    /* Linear displacement. value [inputs] in, u [free_dof] out */
    pzs_status (*displace)(struct analysis *analysis, const double *value, double *u);
    /* Fill analysis->influence [outputs][inputs], which is allocated. */
    pzs_status (*influence)(struct analysis *analysis);
} analysis_source;

extern const analysis_source analysis_of_structure, analysis_of_matrix;

typedef struct analysis {
    const analysis_source *source; /* where displacements come from */
    design design;
    pzs_model model;
    void *work;
    size_t work_bytes;
    equilibrium equilibrium; /* where the scene's kinematics is not linear */
    pzs_electric electric;   /* where the design has electrodes, once the stiffness is factored */
    void *electric_work;
    double *input_value; /* [inputs] input values of the last displacement, with the voltages found
                            for open electrodes */
    double *charge;      /* [electrodes] charges at the last displacement */
    int nonlinear;       /* whether analysis_solve and analysis_reach use the equilibrium solver;
                            initially as the scene says */
    double *influence;   /* [outputs][inputs] of the reference state, after analysis_influence */
    pzs_status status;   /* status of the last equilibrium */
    struct {
        double assemble, factor, solve;
    } seconds; /* times of the reference state's stiffness and of the last displacement */
    certificate certificate; /* stability of the control loop, after certificate_make */
    int quasi_static;        /* write tables even where vibration makes the control loop unstable */
    double linear_error;     /* kinematics auto: difference of the linear from the nonlinear
                                displacement, relative */
    load_path load_path;     /* the load path to the last displacement, where it was asked for */
    mesh_error mesh_error;   /* estimated discretisation error, where it was asked for */
    plausible warnings;      /* warnings on the scene and on its results so far */
} analysis;

/*
 * Build the design, assemble and factor its stiffness. Where the kinematics is not linear, set up
 * the equilibrium solver as well; such a structure may be supported by contact alone. Returns 0, or
 * -1 with error filled and the analysis empty.
 */
int analysis_prepare(analysis *analysis, const scene *scene, char *error);

/*
 * Displacement under the scene's loads and applied voltages, starting from the reference state. u
 * [free_dof] out.
 *
 * Kinematics auto solves both ways, and analysis->nonlinear then says which displacement is in u:
 * the linear one where its relative difference is within the scene's tolerance. Nonlinear: where
 * the load steps end before the full load, u is the last equilibrium and the message says so.
 * Returns 0, or -1 with error filled.
 */
int analysis_solve(analysis *analysis, double *displacement, char *error);

/* Returns 0 where the scene has a structure, else -1 with error filled: `what` needs one. */
int analysis_needs_structure(const analysis *analysis, const char *what, char *error);

/*
 * Linear displacement under input values.
 *   value [inputs]  in
 *   u [free_dof]    out
 */
pzs_status analysis_displace(analysis *analysis, const double *value, double *displacement);

/*
 * The same from the last equilibrium of the solver, as load_path_follow leaves it, with nonlinear
 * kinematics.
 */
int analysis_continue(analysis *analysis, double *displacement, char *error);

/*
 * Solve once more with twice as many load steps, and compare: a large difference says that the
 * displacement depends on the way of loading, and that it may not lie on the load path. The solver
 * is left as before.
 *   u [free_dof] in  displacement of analysis_solve with nonlinear kinematics
 * Returns the difference relative to the displacement; HUGE_VAL where the load is not reached; NAN
 * for scenes with contact, prescribed displacements or open electrodes, and without memory.
 */
double analysis_path_difference(analysis *analysis, const double *displacement);

/*
 * Displacement under other voltages, as analysis_solve.
 *   voltage [amplifiers]  in
 *   warm                  in   nonlinear: start from the last shape, not from the reference state
 *   u [free_dof]          out
 */
int analysis_reach(analysis *analysis, const double *voltage, int warm, double *displacement,
                   char *error);

/*
 * Fill analysis->input_value and analysis->charge: of the solver's last equilibrium, or of a linear
 * structure under the given input values. The solving functions call this one.
 *   value [inputs]  in  open electrodes excluded, whose voltages are computed
 */
pzs_status analysis_electrodes(analysis *analysis, const double *value);

/* Whether analysis->status says that the load steps ended before the full load. */
int analysis_ended_early(const analysis *analysis);

/* Value of the scene's output k at its i-th node. value [output rows] in: rows of the structure. */
double analysis_output(const analysis *analysis, int k, int i, const double *value);
/* Number of values of the scene's output k. */
int analysis_outputs(const analysis *analysis, int k);
/*
 * Mesh node of the i-th value of output k; -1 for electrodes, and for the force and the number of
 * nodes of the whole contact.
 */
int analysis_output_node(const analysis *analysis, int k, int i);
/* Name of the electrode of the i-th value of output k, which is a voltage or a charge. */
void analysis_output_electrode(const analysis *analysis, int k, int i, char name[SCENE_LABEL]);

/*
 * Charge per volt of electrode k, with the shell undeformable, or free as its supports allow and
 * every other electrode at 0 V.
 */
double analysis_capacitance(const analysis *analysis, int k, int is_free);

/*
 * Ratio of the stiffness with open sensors to that with short-circuited sensors, under the scene's
 * loads without temperatures, in the reference state. NAN where there are no loads or no open
 * sensors, and on a nonlinear structure.
 */
double analysis_stiffening(analysis *analysis);

/*
 * Compute the influence of every input on every output in the reference state, and the voltage
 * problem of the design. Later calls do nothing. Returns 0, or -1 with error filled.
 */
int analysis_influence(analysis *analysis, char *error);

/*
 * Fill error with the message of a library status and the place on the mesh that the status names.
 * Returns -1.
 */
int analysis_explain(const analysis *analysis, pzs_status status, char *error);

void analysis_free(analysis *analysis);

/* Time in seconds of a monotonic clock. */
double analysis_now(void);

#endif
