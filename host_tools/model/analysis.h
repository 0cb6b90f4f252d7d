/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Analysis by the library of the structure that one scene file describes: assembly and
 * factorisation of the stiffness matrix, displacements, influence matrix. The host allocates the
 * memory; the library code is the same as on a device.
 */
#ifndef ANALYSIS_H
#define ANALYSIS_H

#include "certificate.h"
#include "equilibrium.h"
#include "kept_modes.h"
#include "load_path.h"
#include "mesh_error.h"
#include "plausible.h"
#include "reactions.h"

struct analysis;

/*
 * Source of the displacements of an analysis: either a mechanical structure, whose stiffness matrix
 * is factored, or a measured influence matrix. All computations that use the influence matrix are
 * the same for both sources.
 */
typedef struct analysis_source {
    bool has_structure; /* true for a scene with elements, stiffness, loads and mass; false for a
                           measured influence matrix */
    /*
     * Prepare the computation of displacements from the design (numerical model of the scene):
     * assemble and factor the stiffness matrix, or read the measured matrix. Returns 0, or -1 with
     * error filled.
     */
    int (*open)(struct analysis *analysis, char *error);
    /*
     * Compute the linear displacement under input values.
     *   value [inputs]  in   voltages (V), load factors and temperature changes (K)
     *   u     [free_dof] out  displacement vector
     */
    pzs_status (*displace)(struct analysis *analysis, const double *value, double *u);
    /*
     * Compute the influence matrix analysis->influence [outputs][inputs], whose memory is already
     * allocated.
     */
    pzs_status (*influence)(struct analysis *analysis);
} analysis_source;

extern const analysis_source analysis_of_structure, analysis_of_matrix;

typedef struct analysis {
    const analysis_source *source; /* source of the displacements: a mechanical structure or a
                                      measured influence matrix */
    design design;
    pzs_model model;
    void *work;
    size_t work_bytes;
    equilibrium equilibrium; /* solver of the nonlinear equilibrium; used where the scene's
                                kinematics is not linear */
    pzs_electric electric;   /* charges of the electrodes per unit of every input (voltage,
                                temperature or load factor); used where the scene has electrodes,
                                after the stiffness matrix is factored */
    void *electric_work;
    double *input_value; /* [inputs] values of the inputs that cause the last computed displacement;
                            for open electrodes, the computed voltages */
    double *charge; /* [electrodes] charge of each electrode at the last computed displacement (C)
                     */
    kept_modes *modes; /* vibration modes computed so far, kept for later requests: modes about the
                          equilibrium in the member `about`, or about the reference state if that
                          member is empty */
    linearised about;  /* tangent stiffness matrix and forces of the inputs about the equilibrium to
                          which influence matrix and vibration modes belong; empty: they belong to
                          the reference state */
    bool is_nonlinear; /* whether displacements are computed by the nonlinear equilibrium solver;
                          the initial value is that of the scene */
    double *influence; /* [outputs][inputs] influence matrix in the reference state, or about the
                          loaded equilibrium where the scene asks for it, filled by
                          analysis_influence */
    double *recovered; /* [nodes of all outputs, in the order of design.place_node] values of the
                          scene's outputs of strain and stress, for the last displacement of
                          analysis_solve or analysis_continue; NULL where the scene has none */
    reactions reactions; /* forces of the supports on the shell in the last solution of
                            analysis_solve or analysis_continue */
    pzs_status status;   /* status that the last computation of a nonlinear equilibrium returned */
    struct {
        double assemble, factor, solve;
    } seconds; /* durations (s): assembling the stiffness matrix, factoring it, and computing the
                  last displacement */
    certificate certificate; /* certificate: result of the stability tests of the control loop,
                                filled by certificate_make */
    bool is_compact; /* whether to leave out of the tables what the device can compute: stiffness
                        matrices of the element types, and on meshes with compact element types
                        also the matrices from displacements to strains */
    const struct tables_modes *device_modes; /* what the tables hold for vibration modes on the
                                                device (option --modes); NULL: nothing */
    bool quasi_static;   /* whether to write the controller's tables even where vibration makes the
                            control loop unstable */
    double linear_error; /* difference between linear and nonlinear displacement relative to the
                            nonlinear one, computed where the scene's kinematics is `auto` */
    load_path load_path; /* points of the load path that leads to the present displacement, each an
                            equilibrium; empty unless the user asked for the load path */
    mesh_error mesh_error; /* estimated discretisation error of the results; empty unless the user
                              has asked for this estimate */
    plausible warnings; /* plausibility warnings on the scene and on the results computed so far */
} analysis;

/*
 * Build the design (numerical model) of a scene, and assemble and factor its stiffness matrix.
 * Where the scene's kinematics is not linear, also set up the equilibrium solver; such a structure
 * may be supported by contact alone. Returns 0, or -1 with error filled and the analysis empty.
 */
int analysis_prepare(analysis *analysis, const scene *scene, char *error);

/*
 * Compute the displacement under the scene's loads and applied voltages from the reference state.
 * With kinematics `auto` it is the linear one if that agrees with the nonlinear one within the
 * scene's tolerance (analysis->is_nonlinear).
 *   displacement [free_dof] out  displacement of the structure. If the load steps end before the
 *       full load, it is that of the last equilibrium, and `error` says so
 * Returns 0, or -1 with error filled.
 */
int analysis_solve(analysis *analysis, double *displacement, char *error);

/*
 * Check that the scene has a mechanical structure and not only a measured influence matrix. Returns
 * 0, or -1 with an error text that says that `what` needs a structure.
 */
int analysis_needs_structure(const analysis *analysis, const char *what, char *error);

/*
 * Recover the stresses of a displacement that analysis_solve or analysis_continue computed. With
 * linear kinematics the displacement is first corrected for assumptions of the elements, such as
 * straight cross-sections (stress_corrected.h).
 *   displacement [free_dof] in  must remain valid as long as the field is used
 * Returns 0, or -1 if memory runs out; call stress_free in both cases.
 */
int analysis_stresses(analysis *analysis, const double *displacement, struct stress_field *field);

/*
 * Compute the linear displacement under input values.
 *   value        [inputs]   in   voltages (V), load factors and temperature changes (K)
 *   displacement [free_dof] out  displacement vector of the structure
 */
pzs_status analysis_displace(analysis *analysis, const double *value, double *displacement);

/*
 * Compute the nonlinear displacement under the scene's loads and applied voltages, starting from
 * the last equilibrium of the solver, for example the last point that load_path_follow reached.
 *   displacement [free_dof] out  displacement vector of the structure
 * Returns 0, or -1 with error filled.
 */
int analysis_continue(analysis *analysis, double *displacement, char *error);

/*
 * Compute the nonlinear displacement again with twice as many load steps, and compare. A large
 * difference says that the result may not lie on the load path. The solver's state is restored.
 *   displacement [free_dof] in   nonlinear displacement from analysis_solve
 *   load_factor             out  part of the load that twice as many load steps reach; 1: all
 * Returns the relative difference; HUGE_VAL if the full load is not reached; NAN without memory or
 * with bare faces (their potentials cost many linear solves).
 */
double analysis_path_difference(analysis *analysis, const double *displacement,
                                double *load_factor);

/*
 * Compute the displacement under the scene's loads and given voltages, linear or nonlinear
 * (analysis->is_nonlinear).
 *   voltage      [amplifiers] in   voltages (V)
 *   warm                      in   1: start the nonlinear solver from the last shape; 0: from the
 *       reference state
 *   displacement [free_dof]   out  displacement of the structure
 * Returns 0, or -1 with error filled.
 */
int analysis_reach(analysis *analysis, const double *voltage, int warm, double *displacement,
                   char *error);

/*
 * Fill analysis->input_value (values of all inputs) and analysis->charge (charges of the
 * electrodes) for the displacement just computed.
 *   value [inputs] in  input values of a linear structure; those of open electrodes are computed.
 *       Under nonlinear kinematics `value` is not read: the values are those of the solver's last
 *       equilibrium
 */
pzs_status analysis_electrodes(analysis *analysis, const double *value);

/* Whether analysis->status says that the nonlinear load steps ended before the full load. */
int analysis_ended_early(const analysis *analysis);

/*
 * Value of one output of the scene at one of its nodes or electrodes.
 *   value in  values of all outputs of the scene, output after output
 *   k     in  index of the output
 *   i     in  index among the nodes or electrodes of this output
 */
double analysis_output(const analysis *analysis, int k, int i, const double *value);
/*
 * Compute analysis->reactions, the forces of the supports on the shell, at a displacement
 * [free_dof] that belongs to analysis->input_value; under nonlinear kinematics it must be that of
 * the equilibrium solver. Returns 0, or -1 with error filled and the reactions empty.
 */
int analysis_find_reactions(analysis *analysis, const double *displacement, char *error);
/*
 * Return whether output k of the scene is a linear function of the displacement under the
 * kinematics of this analysis. Its values are then rows of the structure's outputs, from row
 * design.named_first[k] on.
 */
bool analysis_output_is_row(const analysis *analysis, int k);
/* Number of values (nodes or electrodes) of the scene's output with index k. */
int analysis_outputs(const analysis *analysis, int k);
/*
 * Return the index of the mesh node at which the i-th value of the scene's output k is read. If
 * several nodes share one value, such as the force on a support, it is the first of them. Returns
 * -1 for outputs without a node: voltages and charges, and force and number of nodes of the whole
 * contact.
 */
int analysis_output_node(const analysis *analysis, int k, int i);
/*
 * Name of the electrode that belongs to the i-th value of the scene's output with index k, where
 * that output is a voltage or a charge.
 */
const char *analysis_output_electrode(const analysis *analysis, int k, int i);

/*
 * Return the capacitance of electrode k (C/V) while every other electrode is at 0 V.
 *   is_free in  1: the shell deforms as its supports allow; 0: the shell cannot deform
 */
double analysis_capacitance(const analysis *analysis, int k, int is_free);

/*
 * Return the work of the scene's loads with short-circuited sensor electrodes over that with open
 * ones, in the reference state without temperature changes. The ratio is at least 1, because open
 * electrodes stiffen the structure. NAN without loads or open sensors, and for nonlinear
 * kinematics.
 */
double analysis_stiffening(analysis *analysis);

/*
 * Compute the influence of every input on every output and the least-squares problem for the
 * optimal voltages, in the reference state or, with simulate.influence, at the equilibrium under
 * the scene's loads. Further calls do nothing. Returns 0, or -1 with error filled.
 */
int analysis_influence(analysis *analysis, char *error);

/*
 * Keep in analysis->about the tangent stiffness matrix and the forces of the inputs at the
 * equilibrium that the nonlinear solver has reached. Returns 0, or -1 with error filled where this
 * equilibrium is unstable.
 */
int analysis_linearise(analysis *analysis, char *error);

/*
 * Compute the lowest vibration modes of the structure, in the state in which its influence matrix
 * is computed: the reference state, or the loaded equilibrium.
 *   number in  number of modes
 * Returns 0, or -1 with error filled and the result empty.
 */
int analysis_vibration(const analysis *analysis, vibration *vibration, int number, char *error);

/*
 * Compute the vibration modes as analysis_vibration does, but with a stated circuit of the
 * electrodes, and without the store of modes that were computed before.
 */
int analysis_vibration_of(const analysis *analysis, electrode_circuit circuit, vibration *vibration,
                          int number, char *error);

/*
 * Fill `error` with the message of a library status and, where it refers to a degree of freedom,
 * with the node of the mesh to which this belongs. Returns -1.
 */
int analysis_explain(const analysis *analysis, pzs_status status, char *error);

void analysis_free(analysis *analysis);

/* Time of a monotonic clock (s), to measure durations. */
double analysis_now(void);

#endif
