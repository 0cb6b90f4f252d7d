/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Design: the numerical model of a scene, in double precision. Inputs are columns of nodal forces,
 * outputs are rows of weights of the dof. With the influence matrix, the design also contains the
 * voltage optimisation problem (least squares for the voltages within their limits).
 */
#ifndef DESIGN_H
#define DESIGN_H

#include <stdbool.h>
#include "../mesh/mesh.h"
#include "../scene/outline_pieces.h"
#include "bare_faces.h"
#include "pzs_loop.h"

/*
 * Largest number of free functions of a target. A free function is a shape, such as a tilt, that
 * may be added to the target at no cost.
 */
enum { DESIGN_FREE = SCENE_FREE };

/*
 * Source of the voltage limits that all amplifiers share. Held amplifiers keep their voltage with
 * LIMITS_GIVEN and LIMITS_NONE.
 *   LIMITS_SCENE  key `limits.voltage` of the scene file
 *   LIMITS_GIVEN  members lower and upper of common_limits; they only narrow an amplifier's own
 *       limits and those of the depolarisation field
 *   LIMITS_NONE   no limits
 */
typedef enum limits_source { LIMITS_SCENE, LIMITS_GIVEN, LIMITS_NONE } limits_source;
typedef struct common_limits {
    limits_source source;
    double lower, upper; /* common voltage limits of all amplifiers, used where LIMITS_GIVEN selects
                            them; finite, lower <= upper (V) */
} common_limits;

/*
 * Arrays of limit rows (limits of weighted sums of voltages), which the optimisation of the
 * voltages obeys, and the tables of the library made from them.
 */
typedef struct design_rows {
    uint32_t *start; /* [limit rows + 1] index of the first entry of each limit row (limit of a
                        weighted sum of voltages) in `input` and `value` */
    uint16_t *input; /* [entries of all limit rows] amplifier to whose voltage each entry of a limit
                        row (limit of a weighted sum of voltages) belongs */
    double *value;   /* [entries of all limit rows] factor (dimensionless) by which the voltage of
                        each amplifier enters a limit row (limit of a weighted sum of voltages) */
    double *lower, *upper; /* [limit rows] lower and upper limit of each weighted sum of voltages
                              (V) */
    double *safe; /* [amplifiers] voltages that obey all voltage limits and all limit rows, which
                     are limits of sums of voltages (V) */
    pzs_limit_rows tables;
} design_rows;

/*
 * Small entries of a measured influence matrix that count as zero in the controller, and the error
 * that this causes.
 */
typedef struct design_dropped {
    size_t entries; /* number of entries of the influence matrix that count as zero */
    double error;   /* error caused by small entries of the influence matrix, which count as zero:
                       largest change of the displacement of any output while all voltages are at
                       their limits (length unit); infinite without limits */
    /*
     * index, from 0, of the output (row of the influence matrix) with the largest error: its
     * displacement changes most if small entries of the matrix become zero
     */
    int output;
} design_dropped;

/*
 * Modes (patterns of voltages) with their gains, the parts of their wanted change that a control
 * tick makes, and leaks, the parts of their coordinates that a tick removes. They are orthonormal
 * in the Hessian of the voltage optimisation problem (least squares for the voltages) of the
 * amplifiers that are not held at one voltage.
 */
typedef struct modal_gains {
    bool is_used;
    pzs_modal_gains tables;
    double *memory; /* memory in which all arrays of the tables, and the array `left`, are stored
                       one after the other */
    double *left; /* [modes] for a mode made from a function of the scene: norm of what no voltages
                     can make of the function, over its norm; 0 for singular vectors */
} modal_gains;

/*
 * Numerical model of a scene. The members after `problem` hold everything else of the scene that
 * later stages (analysis, control, reports) use; design_build copies them. Their texts and lists
 * belong to the scene, which outlives the design.
 */
typedef struct design {
    const scene *scene; /* the scene from which this numerical model is built, used only by the
                           functions that build the numerical model */
    mesh mesh;
    /*
     * Linear structure. Inputs: amplifiers, loads, extra inputs, electrodes of sensors, potentials
     * of bare faces (without electrodes). Outputs: target nodes, named outputs. Extra inputs exist
     * under nonlinear kinematics (follower loads, prescribed displacements, moved body); their
     * nodal forces are empty here.
     */
    pzs_structure structure;
    pzs_electrodes electrodes; /* electrodes of the amplifiers and of the sensors, and potentials of
                                  bare faces (without electrodes); empty unless the scene has
                                  sensors or bare faces or asks for charges */
    int amplifiers; /* number of amplifiers; they are the first inputs of the structure */
    int loads;      /* number of loads; they are the inputs of the structure after the amplifiers */
    int sensor_first; /* index of the first input that is an electrode of a sensor */
    bare_faces bare;  /* potentials of bare faces (without electrodes), which are the last inputs */
    int targets; /* number of target rows (controlled displacements), which are the first outputs */
    int *target_node; /* [targets] number of the mesh node of each target row (controlled
                         displacement) */
    int *named_first; /* [scene outputs + 1] index of the first output row of each named output of
                         the scene */
    int *place_first; /* [scene outputs + 1] for each named output of the scene, index of its first
                         node in the list place_node */
    int *place_node;  /* nodes of the mesh at which the outputs of the scene are read, one output
                         after the other; an output that is not read at nodes, such as a charge, has
                         no entry */
    double *target;   /* [targets] target displacements, without their part along the free functions
                         (shapes that may be added to the target at no cost) */
    double *wanted;   /* [targets] displacements that the voltages must cause: target minus
                         displacement under the scene's loads */
    double *weight;   /* [targets] weight of each controlled displacement (target row) in the shape
                         error; 0 for rows on constrained dof */
    int fixed_rows;   /* number of controlled displacements (target rows) on constrained dof, which
                         voltages cannot change */
    double *fixed_weight; /* [targets] original weights of the controlled displacements on
                             constrained dof, whose entries in `weight` are 0; 0 for all others */
    int free_functions; /* number of free functions of the target: shapes that may be added to it at
                           no cost */
    double *free_value; /* [free_functions][targets] free functions of the target (shapes that may
                           be added at no cost), orthonormal in the scalar product that sums weight
                           squared times both functions over the targets */
    double *free_basis; /* [free_functions][targets] the same functions, orthonormal in the scalar
                           product without weights over the targets whose weight is not 0, where
                           alone they are not 0 */
    double *influence;  /* [targets][amplifiers] influence matrix without its part along the free
                           functions of the target (shapes that may be added at no cost), filled by
                           design_control */
    double *hessian;    /* [amplifiers][amplifiers] Hessian B'W^2 B of half the squared error, with
                           influence matrix B and weights W */
    double *lower, *upper, *step_limit, *reference_voltage; /* [amplifiers] voltage limits (V), step
                                                               limits (V a tick) and reference
                                                               voltages (V) */
    design_dropped dropped;
    double *park; /* [amplifiers] park voltages: voltages of rest, to which the supervisor ramps by
                     command or after a fault (V) */
    pzs_problem problem;
    pzs_actuator_curves curves; /* tables of the curves of actuators that are not linear, filled by
                                   design_control; all zero if the scene has none */
    modal_gains gains; /* modes of the control loop: part of its wanted change that a tick makes
                          (gain), and part that a tick removes (leak), for each mode; filled by
                          design_control */
    design_rows rows;  /* limit rows of the voltage optimisation problem (limits of weighted sums of
                          voltages); empty if the scene has none */

    const char *name, *about, *path; /* name, purpose (may be NULL) and file of the scene */
    scene_at at, at_layers; /* positions in the scene file for error messages about the structure
                               and about its layers */
    scene_unit_names units;
    char (*amplifier_name)[SCENE_LABEL]; /* [amplifiers] name of the actuator, with the position in
                                            its grid if it has several amplifiers */
    char (*electrode_name)[SCENE_LABEL]; /* [electrodes of sensors] name of the sensor, with the
                                            position in its grid if it has several electrodes */
    scene_kinematics kinematics;
    double tolerance; /* largest difference between linear and nonlinear displacement, relative to
                         the nonlinear one, at which `kinematics: auto` uses linear kinematics */
    scene_equilibrium equilibrium; /* settings of the solver that computes the nonlinear equilibrium
                                    */
    int materials, layers, patch_grids, actuators, sensors, supports, springs, outputs, compares;
    const scene_material *material; /* [materials] materials of the scene */
    const scene_layer *layer;       /* [layers] layers of the shell */
    const scene_patches *patches;   /* [patch_grids] grids of piezoelectric patches */
    const scene_actuator *actuator; /* [actuators] actuators of the scene */
    const scene_actuator *sensor;   /* [sensors] piezoelectric sensors of the scene */
    const scene_support *support;   /* [supports] supports of the structure */
    const scene_spring *spring;     /* [springs] springs of the structure */
    const scene_load *load;         /* [loads] loads of the scene */
    const scene_output *output;     /* [outputs] named outputs of the scene */
    const scene_compare *compare;   /* [compares] voltages that the scene file gives for comparison
                                       with the optimum */
    const scene_quads *quads; /* mesh of quadrilaterals that was read from a mesh file, or NULL */
    scene_contact contact;
    scene_limits limits;
    scene_target goal; /* displacement component, nodes and formula of the target shape */
    scene_estimate estimate;
    scene_simulate simulate;
    scene_dynamics dynamics;
    scene_control control;
    scene_safety safety;
    scene_hysteresis hysteresis;
    scene_influence measured; /* measured influence matrix that the scene gives in place of a
                                 structure */
} design;

/*
 * Build the inputs and outputs of the scene on the mesh. Fills the member `structure`, whose output
 * rows are first those of the target, then those of the outputs that the scene names. Returns 0, or
 * -1 with error filled.
 */
int design_structure(design *design, char *error);

/*
 * Build inputs and outputs of a scene with a measured influence matrix, on a mesh of points without
 * elements: one input for each amplifier, one output for each row of the matrix. Returns 0, or -1
 * with error filled.
 */
int design_measured(design *design, char *error);

/*
 * Build the least-squares problem for the voltages within their limits (member `problem`).
 *   influence [outputs][inputs] in  influence matrix of the whole structure, from pzs_influence
 * Returns 0, or -1 with error filled.
 */
int design_control(design *design, const double *influence, char *error);

/*
 * Mean diagonal entry of the Hessian of the voltage optimisation problem (m2/V2), to which a
 * relative regularisation of the scene refers; after design_control.
 */
double design_mean_diagonal(const design *design);

/*
 * Compute the voltage limits of every amplifier.
 *   common  in  origin of the limits that all amplifiers share: the scene file (LIMITS_SCENE, only
 *       after design_control), two given voltages (LIMITS_GIVEN), or none (LIMITS_NONE)
 *   lower, upper  [amplifiers] out  voltage limits (V)
 * Returns 0, or -1 with error filled where no voltage is allowed for an amplifier.
 */
int design_limits(const design *design, common_limits common, double *lower, double *upper,
                  char *error);

/*
 * Voltage of an actuator (V) at which the electric field against the poling, in one grid of its
 * patches, reaches the depolarisation field of the material. The sign is that of voltages that
 * oppose the poling. Infinite for a material without a depolarisation field.
 */
double design_depolarising_voltage(const scene *scene, const scene_drive *drive);

/* Whether an amplifier is held at one voltage, because its limits allow no other voltage. */
bool design_is_held(const design *design, int amplifier);

/*
 * Names and unit of what the amplifiers of a scene give: temperatures if all of them supply
 * heaters, otherwise voltages.
 */
typedef struct design_inputs {
    const char *name, *title; /* word for the inputs in a sentence and in a title: "voltage" and
                                 "Voltage", or "temperature" and "Temperature" */
    const char *unit;
} design_inputs;
design_inputs design_inputs_of(const design *design);

/* Return the unit of the input of an amplifier: of voltages, or of temperatures for a heater. */
const char *design_unit(const design *design, int amplifier);

void design_free(design *design);

/*
 * Copy the scene of a design (numerical model), to build another one with other material constants,
 * loads or kinematics from the copy. Returns 0, or -1 where memory runs out.
 */
int design_vary(const design *design, scene *copy);

/*
 * Compute the stress resultants that 1 V (or 1 K) of one amplifier of an actuator causes in one
 * element, times the area of the element.
 *   cell    in   index of the amplifier within the actuator's grid, second grid index fastest
 *   h0 [10] out  resultants (N m), in the order of the ten strains (laminate.h)
 * Returns whether the amplifier acts in the element.
 */
int design_actuation(const mesh *mesh, const scene_actuator *actuator, int cell, int element,
                     double h0[LAMINATE_STRAINS]);

/*
 * Piezoelectric patch that covers an element, or a part of it: its index in its grid of patches
 * (second grid index fastest), and the covered part.
 */
typedef struct design_part {
    int patch;
    double share; /* part of the element's area that the patch covers, above 0 and at most 1; 1 for
                     patches of whole elements */
} design_part;

/*
 * Find the patches that cover an element or a part of it: at most one where the patches consist of
 * whole elements, several where outlines are given.
 *   list [number] out  patches and covered parts; NULL: only count
 * Returns the number of patches.
 */
int design_patches_in(const mesh *mesh, int element, const scene_patches *patches,
                      design_part *list);

/*
 * Draw the part of an electrode of any outline that lies in one element into a picture, as filled
 * polygons or as the lines of its outline. Returns 0, or -1 where memory runs out.
 */
int design_pieces(const design *design, const scene_patches *patches, int electrode, int element,
                  bool draws_outline, outline_draw *draw, void *context);

/*
 * Return the index at which the lists of the scene file (values of the target, for example) hold
 * the value for a controlled displacement (target row). For a measured influence matrix this is the
 * number of the row in the matrix file, because lists have values also for rows that the scene
 * ignores.
 */
int design_row(const design *design, int target);

/*
 * Largest distance between a target node and its nearest scattered point, as a multiple of the
 * usual spacing of the points; 0 where no scattered points give the target. Above 2 the target is
 * extrapolated.
 */
double design_target_gap(const design *design);

/*
 * Root mean square of the target displacements over the target nodes (length unit of the scene).
 */
double design_target_rms(const design *design);

/*
 * Evaluate the target displacement at the target nodes, and remove its part along the free
 * functions (shapes that may be added to the target at no cost).
 *   value [targets] out  value at each target
 * Returns 0, or -1 with error filled where a value is not finite.
 */
int design_target_values(const design *design, const expr *wanted, scene_at at, double *value,
                         char *error);

/*
 * Evaluate the value of a load at all nodes.
 *   value [nodes] out  value at each node
 * Returns 0, or -1 with error filled where a value is not finite.
 */
int design_load_values(const mesh *mesh, const scene_load *load, double *value, char *error);

/*
 * Whether every sensor reading in the scene's `estimate` section is a displacement, which the
 * numerical model then has as an output row (weights of the dof).
 */
bool design_reads_displacements(const design *design);

/*
 * Applied voltages of the actuators, which the scene file gives for solutions without optimisation.
 */
void design_applied(const design *design, double *voltage);

/*
 * Displacements of the target rows (controlled displacements) under a displacement vector of the
 * structure.
 */
void design_shape(const design *design, const double *displacement, double *shape);

/*
 * Squared weighted norm |W P (shape - wanted)|^2, or |W P shape|^2 where `wanted` is NULL. W holds
 * the weights; the projector P removes the free functions (shapes that may be added to the target
 * at no cost).
 *   shape, wanted [targets] in  reached and wanted displacements
 */
double design_squares(const design *design, const double *shape, const double *wanted);

/*
 * Compute the misfit: the shape minus the wanted displacements, without its part along the free
 * functions (shapes that may be added to the target at no cost).
 *   shape, wanted [targets] in  reached and wanted displacements
 *   misfit        [targets] out  the difference
 * Returns the weighted sum of squares of the misfit at constrained dof, which no voltage can
 * change.
 */
double design_misfit(const design *design, const double *shape, const double *wanted,
                     double *misfit);

/*
 * Remove the part along the free functions of the target (shapes that may be added at no cost) from
 * a shape.
 *   shape [targets] in/out  displacements
 */
void design_take_free(const design *design, double *shape);

/*
 * Make the influence matrix for the least-squares problem of the voltages: without its part along
 * the free functions (shapes that may be added to the target at no cost), and 0 on constrained dof.
 *   influence [outputs][stride]     in   influence matrix, the amplifiers' columns first
 *   column    [targets]             out  work array
 *   out       [targets][amplifiers] out  influence matrix for the least-squares problem
 */
void design_influence_free(const design *design, const double *influence, size_t stride,
                           double *column, double *out);

/*
 * Set the small entries of a measured influence matrix to zero in the controller, as the scene file
 * asks for, and compute the largest error that this causes (design.dropped). The voltage limits
 * must be computed before.
 *   error [targets] in/out  work array, all zero (length unit)
 */
void design_drop(design *design, double *error);

/*
 * Find the controlled displacements (target rows) on constrained dof, orthonormalise the free
 * functions (shapes that may be added to the target at no cost), and evaluate the target. Returns
 * 0, or -1 with error filled.
 */
int design_target_rows(design *design, char *error);

/*
 * design_grow enlarges an allocated array to `count` items of `size` bytes; where memory runs out,
 * it returns the old array and sets *full to true. design_release frees an array that the library's
 * tables declare const.
 */
void *design_grow(void *old, size_t count, size_t size, bool *full);
void design_release(const void *table);

/*
 * Weights of the dof of a node in one displacement component of one face. The order of the dof is:
 * mean of both faces' displacements; their difference divided by the thickness; displacement of the
 * middle surface relative to the mean of the faces.
 *   weight  [7] out  weight of each dof
 */
void design_output_weights(const mesh *mesh, int node, scene_component component, scene_face face,
                           double weight[7]);

/*
 * Displacement of a node in one component of one face.
 *   displacement [free_dof] in  displacement vector of the structure
 */
double design_displacement(const mesh *mesh, const double *displacement, int node,
                           scene_component component, scene_face face);

/*
 * Compute the Cartesian displacement of the middle surface at all nodes.
 *   displacement [free_dof] in   displacement vector of the structure
 *   vector [nodes][3]       out  displacement of each node along x, y and z
 */
void design_vectors(const mesh *mesh, const double *displacement, double *vector);

#endif
