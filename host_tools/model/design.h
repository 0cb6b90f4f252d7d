/*
 * A scene made ready for the library: its structure (inputs as columns, outputs as rows)
 * and, once the influence is known, its voltage problem. Everything is plain arrays in double.
 */
#ifndef DESIGN_H
#define DESIGN_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/* Most free functions of a target. */
enum { DESIGN_FREE = SCENE_FREE };

/*
 * The common voltage limits of all amplifiers, from which the limits of each are made.
 *   LIMITS_SCENE  `limits.voltage` of the scene
 *   LIMITS_GIVEN  lower and upper of this structure replace it; they narrow an amplifier's own
 *                 limits, and never widen them, nor those of a depolarisation field; a held
 *                 amplifier stays at its voltage
 *   LIMITS_NONE   no limit of any kind, but held amplifiers stay held
 */
typedef enum limits_source { LIMITS_SCENE, LIMITS_GIVEN, LIMITS_NONE } limits_source;
typedef struct common_limits {
    limits_source source;
    double lower, upper; /* V, LIMITS_GIVEN: finite, lower <= upper */
} common_limits;

typedef struct design {
    const scene *scene;
    mesh mesh;
    pzs_structure structure;   /* inputs: amplifiers, loads, extras, sensors; outputs: target nodes,
                                  then named outputs.   Extras are the nonlinear path's, their rows
                                  empty: one for each follower load in the order   of loads, one for
                                  prescribed displacements, one for the motion of a contact's body;
                                  none under linear kinematics */
    pzs_electrodes electrodes; /* amplifiers in volts and sensors, where the scene asks for volts or
                                  charges; or none */
    int amplifiers;            /* the first inputs */
    int loads;                 /* the next */
    int sensor_first;          /* first input of the sensors' electrodes, the last */
    int targets;               /* the first outputs */
    int *target_node;          /* [targets] node of each */
    int *named_first;          /* [scene outputs + 1] first row of each named output */
    int *place_first; /* [scene outputs + 1] first entry of each named output in place_node */
    int *place_node;  /* nodes of the named outputs; an output without a place has none */
    double *target;   /* [targets] wanted displacement, the free functions of the target
                         taken out */
    double *wanted;   /* [targets] the same less the displacement under the scene's loads: what the
                         volts must do */
    double *weight;   /* [targets] 0 in rows on constrained dof, which cannot move */
    int fixed_rows;   /* their number */
    double *fixed_weight; /* [targets] the weight that they would have, 0 in the other rows */
    int free_functions;   /* of the target */
    double *free_value;   /* [free_functions][targets] as combinations that are orthonormal under
                             the weights */
    double *influence;    /* [targets][amplifiers] after design_control, the free functions taken
                             out */
    double *hessian;      /* [amplifiers][amplifiers] */
    double *lower, *upper, *step_limit, *reference_voltage; /* [amplifiers] */
    pzs_problem problem;
} design;

/*
 * Build the inputs and outputs of the scene on the design's mesh: `structure`, targets and named
 * outputs. Returns 0, or -1 with error filled.
 */
int design_structure(design *design, char *error);

/*
 * Build the voltage problem.
 *   influence [outputs][inputs] in  of the whole structure, from pzs_influence
 * Returns 0, or -1 with error filled.
 */
int design_control(design *design, const double *influence, char *error);

/*
 * Voltage limits of every amplifier.
 *   common in  LIMITS_SCENE: the limits of the design as they are, after design_control
 *   lower, upper [amplifiers] out
 * Returns 0, or -1 with error filled: an amplifier has no voltage left.
 */
int design_limits(const design *design, common_limits common, double *lower, double *upper,
                  char *error);

/* Is the amplifier held, so that its limits leave it one voltage? */
bool design_is_held(const design *design, int amplifier);

void design_free(design *design);

/*
 * Resultants of a volt (a kelvin) of an actuator's amplifier in one element.
 *   cell  in   amplifier within the actuator, second index fastest
 *   h0 [10] out times the element's area
 * Returns whether it acts there.
 */
int design_actuation(const mesh *mesh, const scene_actuator *actuator, int cell, int element,
                     double h0[LAMINATE_STRAINS]);

/* Temperatures of the inner and outer face under a temperature load; resultants of it in one
 * element, h0 [10] out. */
laminate_field design_temperatures(const scene_load *load);
void design_temperature_resultants(const mesh *mesh, const scene_load *load, int element,
                                   double h0[LAMINATE_STRAINS]);

/* Patch of a grid, second index fastest, on which the element lies, or -1. */
int design_patch(const mesh *mesh, int element, const scene_patches *patches);

/*
 * A wanted displacement at the target's nodes, the free functions taken out. value [targets] out.
 * Returns 0, or -1 with error filled: not finite.
 */
int design_target_values(const design *design, const expr *wanted, scene_at at, double *value,
                         char *error);

/*
 * Base vectors of a face at corner r of an element of the improved kind: chords, a/2 out of the
 * tangent plane where the element spans the angle a. Of that lean the tangent (1 - (a/2)
 * cot(a/2))/(a/2) counts, about a third: a pressure that pushes by it along the surface, towards
 * the ends of the element, has the resultant and the moment on an arc of that on its chord, and is
 * what the stretched chords of a ring hold in balance, whatever their angles. flat [2][2] out
 * without their lean; lean [2] out what counts of it. Returns the area they span.
 */
double design_chords(const mesh *mesh, int element, int r, scene_face face, double flat[2][2],
                     double lean[2]);

/* Values of a load at the nodes. value [nodes] out. Returns 0, or -1 with error filled: a value is
 * not finite. */
int design_load_values(const mesh *mesh, const scene_load *load, double *value, char *error);

/* Applied volts of the scene's actuators. volt [amplifiers] out */
void design_applied(const design *design, double *voltage);

/* Target rows of a displacement. u [dof] in, shape [targets] out */
void design_shape(const design *design, const double *u, double *shape);

/*
 * |W P (x - y)|^2, or |W P x|^2 where y is NULL; P takes the free functions out. x, y [targets] in
 */
double design_squares(const design *design, const double *x, const double *y);

/*
 * misfit [targets] out = P (x - y), as above. Returns the weighted sum of its squares in the rows
 * that cannot move.
 */
double design_misfit(const design *design, const double *x, const double *y, double *misfit);

/* x := P x. x [targets] in/out */
void design_take_free(const design *design, double *x);

/*
 * P B, 0 in rows that cannot move.
 *   influence [targets][stride] in  B, the amplifiers' columns first
 *   column [targets]                room
 *   out [targets][amplifiers]   out
 */
void design_influence_free(const design *design, const double *influence, size_t stride,
                           double *column, double *out);

/*
 * Rows that cannot move, free functions, then the wanted displacement. Returns 0, or -1 with error
 * filled.
 */
int design_target_rows(design *design, char *error);

/* Quarter areas of the elements at each node. area [nodes] out */
void design_node_areas(const mesh *mesh, double *area);

/*
 * Arrays under construction: room for count items of a size, or *full set and the old array; and
 * the library's tables, const for their readers, when they are done with.
 */
void *design_grow(void *old, size_t count, size_t size, int *full);
void design_release(const void *table);

/*
 * Displacement of a node as weights on its unknowns, (mean, difference/h) order.
 *   weight [7] out
 */
void design_output_weights(const mesh *mesh, int node, scene_component component, scene_face face,
                           double weight[7]);

#endif
