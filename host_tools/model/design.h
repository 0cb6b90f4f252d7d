/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene prepared for the library: its structure, with inputs as columns and outputs as rows, and,
 * once the influence matrix is known, its voltage problem. All arrays are in double.
 */
#ifndef DESIGN_H
#define DESIGN_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/* Largest number of free functions of a target. */
enum { DESIGN_FREE = SCENE_FREE };

/*
 * Source of the common voltage limits, from which the limits of each amplifier are computed.
 *   LIMITS_SCENE  `limits.voltage` of the scene
 *   LIMITS_GIVEN  lower and upper of this structure instead; they narrow an amplifier's own limits
 *                 and those of a depolarisation field, and never widen them; a held amplifier keeps
 *                 its voltage
 *   LIMITS_NONE   no limits, but held amplifiers keep their voltage
 */
typedef enum limits_source { LIMITS_SCENE, LIMITS_GIVEN, LIMITS_NONE } limits_source;
typedef struct common_limits {
    limits_source source;
    double lower, upper; /* V; LIMITS_GIVEN: finite, lower <= upper */
} common_limits;

typedef struct design {
    const scene *scene;
    mesh mesh;
    pzs_structure structure;   /* Inputs: amplifiers, loads, extra inputs, electrodes of sensors.
                                  Outputs: target nodes, then named outputs. The extra inputs exist
                                  under nonlinear kinematics and have empty columns: one for each
                                  follower load in the order of loads, one for prescribed
                                  displacements, one for the motion of a contact's body. */
    pzs_electrodes electrodes; /* amplifiers of voltages and sensors where the scene has sensors or
                                  asks for charges; else empty */
    int amplifiers;            /* number of amplifiers, the first inputs */
    int loads;                 /* number of loads, the inputs after the amplifiers */
    int sensor_first; /* first input of the sensors' electrodes, which are the last inputs */
    int targets;      /* number of target rows, the first outputs */
    int *target_node; /* [targets] node of each target row */
    int *named_first; /* [scene outputs + 1] first row of each named output */
    int *place_first; /* [scene outputs + 1] first entry of each named output in place_node */
    int *place_node;  /* nodes of the named outputs; outputs without a node have none */
    double *target;   /* [targets] target displacement without its free functions */
    double *wanted;   /* [targets] target less the displacement under the scene's loads: what the
                         voltages must cause */
    double *weight;   /* [targets] weights; 0 in rows on constrained dof */
    int fixed_rows;   /* number of target rows on constrained dof */
    double *fixed_weight; /* [targets] weights that rows on constrained dof would have; 0 in the
                             other rows */
    int free_functions;   /* number of free functions of the target */
    double *free_value;   /* [free_functions][targets] the free functions as combinations that are
                             orthonormal under the weights */
    double *influence; /* [targets][amplifiers] after design_control, without the free functions */
    double *hessian;   /* [amplifiers][amplifiers] B'W^2 B */
    double *lower, *upper, *step_limit, *reference_voltage; /* [amplifiers] limits, step limits and
                                                               reference voltages, V */
    double *park; /* [amplifiers] park voltages of the supervisor, V */
    pzs_problem problem;
} design;

/*
 * Build the inputs and outputs of the scene on the design's mesh: `structure`, targets and named
 * outputs. Returns 0, or -1 with error filled.
 */
int design_structure(design *design, char *error);

/*
 * Build the same for a scene with a measured influence matrix, on a mesh of points: one input for
 * each amplifier, one output for each row of the matrix. Returns 0, or -1 with error filled.
 */
int design_measured(design *design, char *error);

/*
 * Build the voltage problem.
 *   influence [outputs][inputs] in  of the whole structure, from pzs_influence
 * Returns 0, or -1 with error filled.
 */
int design_control(design *design, const double *influence, char *error);

/*
 * Voltage limits of every amplifier.
 *   common                     in   LIMITS_SCENE: the limits that design_control computed
 *   lower, upper [amplifiers]  out  V
 * Returns 0, or -1 with error filled where no voltage is left for an amplifier.
 */
int design_limits(const design *design, common_limits common, double *lower, double *upper,
                  char *error);

/* Whether an amplifier is held: its limits allow a single voltage. */
bool design_is_held(const design *design, int amplifier);

void design_free(design *design);

/*
 * Resultants, in one element, of one volt (or one kelvin) of an amplifier of an actuator.
 *   cell    in   amplifier within the actuator, second index fastest
 *   h0 [10] out  resultants times the area of the element
 * Returns whether the amplifier acts in the element.
 */
int design_actuation(const mesh *mesh, const scene_actuator *actuator, int cell, int element,
                     double h0[LAMINATE_STRAINS]);

/*
 * Temperatures of the inner and outer face under a temperature load, and the resultants of such a
 * load in one element times its area. h0 [10] out
 */
laminate_field design_temperatures(const scene_load *load);
void design_temperature_resultants(const mesh *mesh, const scene_load *load, int element,
                                   double h0[LAMINATE_STRAINS]);

/* Patch of a grid, second index fastest, that contains an element, or -1. */
int design_patch(const mesh *mesh, int element, const scene_patches *patches);

/*
 * Number of a target row in lists of values: the row of the file for a measured influence matrix,
 * which may have rows that are ignored.
 */
int design_row(const design *design, int target);

/*
 * Largest distance of a target node from the nearest of the scattered points that give the target,
 * in multiples of their usual spacing; 0 for targets that are no scattered points. Above 2 the
 * target is extrapolated.
 */
double design_target_gap(const design *design);

/*
 * Target displacement at the target nodes, without the free functions. value [targets] out. Returns
 * 0, or -1 with error filled where a value is not finite.
 */
int design_target_values(const design *design, const expr *wanted, scene_at at, double *value,
                         char *error);

/*
 * Base vectors of a face at corner r of an element of the improved formulation.
 *
 * The base vectors are chords, inclined by a/2 to the tangent plane where the element spans the
 * angle a. The fraction (1 - (a/2) cot(a/2))/(a/2) of the inclination, about a third, is used for
 * pressures: the pressure's component along the surface then has the resultant and the moment that
 * it has on the arc, and balances the stretched chords of a ring at any angles.
 *   flat [2][2]  out  the base vectors without their inclination
 *   lean [2]     out  the inclination that is used for pressures
 * Returns the area that the base vectors span.
 */
double design_chords(const mesh *mesh, int element, int corner, scene_face face, double flat[2][2],
                     double lean[2]);

/*
 * Values of a load at the nodes. value [nodes] out. Returns 0, or -1 with error filled where a
 * value is not finite.
 */
int design_load_values(const mesh *mesh, const scene_load *load, double *value, char *error);

/* Applied voltages of the scene's actuators. voltage [amplifiers] out */
void design_applied(const design *design, double *voltage);

/* Target rows of a displacement. u [free_dof] in, shape [targets] out */
void design_shape(const design *design, const double *displacement, double *shape);

/*
 * |W P (x - y)|^2, or |W P x|^2 where y is NULL, with P the projector that removes the free
 * functions. x, y [targets] in
 */
double design_squares(const design *design, const double *shape, const double *wanted);

/*
 * misfit [targets] out = P (x - y), with P the projector that removes the free functions. Returns
 * the weighted sum of its squares in the rows on constrained dof.
 */
double design_misfit(const design *design, const double *shape, const double *wanted,
                     double *misfit);

/* x := P x, with P the projector that removes the free functions. x [targets] in/out */
void design_take_free(const design *design, double *shape);

/*
 * P B with rows on constrained dof set to 0.
 *   influence [targets][stride]  in   B, the amplifiers' columns first
 *   column [targets]             work
 *   out [targets][amplifiers]    out
 */
void design_influence_free(const design *design, const double *influence, size_t stride,
                           double *column, double *out);

/*
 * Find the rows on constrained dof and orthonormalise the free functions; then evaluate the target.
 * Returns 0, or -1 with error filled.
 */
int design_target_rows(design *design, char *error);

/*
 * Reallocate a growing array to `count` items of `size`; without memory the old array is returned
 * and *full is set. design_release frees an array that the library's tables declare const.
 */
void *design_grow(void *old, size_t count, size_t size, int *full);
void design_release(const void *table);

/*
 * Displacement of a node as weights of its dof in the order means, differences/h, seventh dof.
 * weight [7] out
 */
void design_output_weights(const mesh *mesh, int node, scene_component component, scene_face face,
                           double weight[7]);

#endif
