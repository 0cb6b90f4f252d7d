/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene: everything a user says about a structure, read from YAML and checked.
 * Plain data in the units of the scene, angles of plies in degrees; nothing here is derived.
 * All strings and arrays belong to the scene; scene_free releases them.
 */
#ifndef SCENE_H
#define SCENE_H

#include <stddef.h>
#include <stdint.h>
#include "expr.h"
#include "scene_error.h"
#include "spline.h"

/* Bytes of a name and of a name with _i_j behind it; most nodes of a mesh; most free functions of a
 * target. */
enum { SCENE_NAME = 64, SCENE_LABEL = SCENE_NAME + 24, SCENE_NODES = 60000, SCENE_FREE = 16 };

typedef enum scene_surface_type {
    SURFACE_PLATE,
    SURFACE_POLAR,
    SURFACE_CYLINDER,
    SURFACE_CONE,
    SURFACE_SPHERE,
    SURFACE_HYPERBOLOID,
    SURFACE_TORUS,
    SURFACE_REVOLUTION,
    SURFACE_SPIRAL
} scene_surface_type;

typedef struct scene_surface {
    scene_surface_type type;
    double radius; /* cylinder, sphere; cone: radius at theta1 = 0; torus: of the tube's axis */
    double angle;  /* cone: half angle, degrees */
    int axial;     /* cylinder, spiral: which theta runs along the axis, 1 or 2 */
    double waist, height;       /* hyperboloid: radius waist sqrt(1 + (z/height)^2) */
    double tube;                /* torus: radius of the tube */
    double inner, outer, turns; /* spiral: radius inner at angle 0, outer after the turns */
    spline *meridian;           /* revolution: (r, z) over the chord length */
} scene_surface;

typedef enum scene_kinematics {
    KINEMATICS_LINEAR,
    KINEMATICS_NONLINEAR,
    KINEMATICS_AUTO
} scene_kinematics;

/* How the nonlinear equations are solved. */
typedef struct scene_equilibrium {
    int steps;     /* load steps tried first */
    double change; /* of the step's increment at which it has converged, relative */
    int mixed;   /* iteration from which the stiffness holds the resultants of the displacements; 0:
                    plain Newton */
    int systems; /* budget of linear systems */
    scene_at at;
} scene_equilibrium;

/* The formulation of the element: `element: published`, `element: improved`, or a map of these. */
typedef struct scene_element {
    int cartesian;  /* kinematics: cartesian (1) or local (0) */
    double tau;     /* share of the warp in the membrane shear */
    double rho;     /* shear flexibility of coarse bending */
    int hr, lin33;  /* modes 01 10 11 by stresses; linear e33 condensed */
    int metric;     /* exact metric through the thickness */
    int exact_area; /* area: exact (1) or centre (0) */
    int unknowns;   /* 7 or 6 */
} scene_element;

typedef struct scene_line { /* mesh points along theta1 or theta2 */
    int elements;
    double *point; /* [elements + 1] ascending */
    int slit;      /* a full turn whose ends do not join */
    scene_at at;
} scene_line;

typedef struct scene_material {
    char name[SCENE_NAME];
    double e[3], g23, g13, g12, nu12, nu13, nu23; /* engineering constants; isotropic E, nu expanded
                                                   */
    double d31, d32, d33, d24, d15;               /* (m/V), strain per field along the poling */
    double piezo_e[5];                            /* e31 e32 e33 e24 e15 (C/m2) when has_e */
    int has_d, has_e;
    double permittivity; /* at constant strain (F/m), 0 if not given */
    double pyroelectric; /* along the poling at constant strain (C/m2 K) */
    double alpha[3];     /* thermal expansion (1/K) */
    double density;      /* mass per volume; weight is density * gravity */
    double field_limit;  /* depolarisation field (V/m), 0: none */
    int poling;          /* +3 or -3 */
    scene_at at;
} scene_material;

typedef struct scene_layer {
    char name[SCENE_NAME];
    int material;
    double thickness, angle;
    int patched; /* void where no patch lies */
    int poling;  /* +3, -3, from the layer or its material */
    scene_at at;
} scene_layer;

typedef struct scene_patches { /* a grid of rectangles on one layer */
    char name[SCENE_NAME];
    int layer;
    double theta1[2], theta2[2]; /* the whole mesh if not given; exactly on mesh lines */
    int grid[2];                 /* 1 x 1 if not given; every patch ends on mesh lines */
    scene_at at;
} scene_patches;

typedef struct scene_drive {
    int patches;
    double factor;
} scene_drive;

/*
 * One amplifier per patch of its grids, tied with signs, first index along theta1, second fastest;
 * or a whole temperature. A sensor is the same without an amplifier.
 */
typedef struct scene_actuator {
    char name[SCENE_NAME];
    int drives;
    scene_drive *drive;
    int is_temperature;
    double applied;     /* V (K) on each of its amplifiers when the scene is simply solved */
    int open;           /* sensor: open circuit, else short */
    int first, grid[2]; /* first amplifier, or first among the sensors' electrodes; grid[0] *
                           grid[1] of them */
    scene_at at;
} scene_actuator;

typedef enum scene_edge {
    EDGE_NONE,
    EDGE_THETA1_MINUS,
    EDGE_THETA1_PLUS,
    EDGE_THETA2_MINUS,
    EDGE_THETA2_PLUS
} scene_edge;

/* A set of nodes: an edge, all nodes, the node at (theta1, theta2), or those of a rectangle of the
 * mesh. */
typedef enum scene_where_type {
    WHERE_EDGE,
    WHERE_NODES,
    WHERE_POINT,
    WHERE_REGION
} scene_where_type;
typedef struct scene_where {
    scene_where_type type;
    scene_edge edge;
    double theta[2];   /* a point: exactly those of its mesh node */
    double span[2][2]; /* a region: from, to of theta1 and theta2; infinite where not given */
    int node[2];       /* a point: its place in line[0].point and line[1].point */
    scene_at at;
} scene_where;

typedef struct scene_support {
    scene_where where;
    unsigned fix;  /* bit i: unknown i of conventions order is given */
    expr *value;   /* displacement at full load; NULL: 0 */
    unsigned move; /* bit i: unknown i takes the value, the rest of fix is 0: u3 moves both faces
                      alike */
    scene_at at;
} scene_support;

typedef enum scene_load_type {
    LOAD_POINT,
    LOAD_LINE,
    LOAD_FACE,
    LOAD_WEIGHT,
    LOAD_TEMPERATURE
} scene_load_type;
typedef enum scene_face {
    FACE_MIDDLE,
    FACE_INNER,
    FACE_OUTER,
    FACE_MEAN
} scene_face; /* load on middle: half each */
typedef enum scene_component {
    COMPONENT_U1,
    COMPONENT_U2,
    COMPONENT_U3,
    COMPONENT_X,
    COMPONENT_Y,
    COMPONENT_Z
} scene_component;

/* A pressure that turns with the shell: fixed size per reference area along the outer face's unit
 * normal, or a true one. */
typedef enum scene_follower { FOLLOWER_NONE, FOLLOWER_NORMAL, FOLLOWER_PRESSURE } scene_follower;

typedef struct scene_load {
    scene_load_type type;
    scene_where where; /* point and line loads */
    scene_face face;
    scene_component component; /* direction; pressure is u3 */
    expr *value;               /* per point, length, area; K; weight: gravity */
    expr *outer;   /* temperature: at the outer face, value then at the inner; NULL: uniform */
    int true_area; /* face: per area of the loaded face, not of the reference surface */
    scene_follower follower; /* face: pressure; FOLLOWER_PRESSURE implies true_area */
    scene_at at;
} scene_load;

/* A rigid convex body; all vectors (x, y, z). */
typedef enum scene_body_type { BODY_PLANE, BODY_CYLINDER, BODY_SPHERE, BODY_PSI } scene_body_type;
typedef struct scene_body {
    scene_body_type type;
    double point[3];  /* on the plane, on the axis, the centre */
    double normal[3]; /* plane: out of the body, unit */
    double axis[3];   /* cylinder: along it, unit */
    double radius;    /* cylinder, sphere */
    expr *value;      /* psi(x, y, z), above 0 outside */
} scene_body;

typedef struct scene_contact {
    int given;
    scene_face face; /* inner or outer */
    scene_body body;
    double move[3];   /* of the body at full load */
    double stiffness; /* kappa: of contact, in units of the structure's own */
    scene_at at;
} scene_contact;

/* What contact gives: the resultant force on the shell, the number of nodes in contact, the
 * pressure at a place. */
typedef enum scene_contact_output {
    CONTACT_NONE,
    CONTACT_X,
    CONTACT_Y,
    CONTACT_Z,
    CONTACT_NODES,
    CONTACT_PRESSURE
} scene_contact_output;

/* Of electrodes: voltages, or the charge of the side towards +e3. */
typedef enum scene_electric_output {
    ELECTRIC_NONE,
    ELECTRIC_VOLTAGE,
    ELECTRIC_CHARGE
} scene_electric_output;

typedef struct scene_output {
    char name[SCENE_NAME];
    scene_contact_output contact;   /* not CONTACT_NONE: no displacement, and only CONTACT_PRESSURE
                                       has a place */
    scene_electric_output electric; /* not ELECTRIC_NONE: neither, and no place; of these
                                       electrodes: */
    int of_sensor, first, count;    /* sensors' or amplifiers */
    scene_where where;
    scene_component component;
    scene_face face;
    double reference; /* printed beside, NAN if not given */
    scene_at at;
} scene_output;

/* Another shape of the target's component, place and weight. */
typedef struct scene_mode {
    char name[SCENE_NAME];
    expr *value;
    scene_at at;
} scene_mode;

typedef struct scene_target {
    int given;
    scene_output what; /* component, face, where */
    expr *value;       /* wanted displacement */
    int modes;
    scene_mode *mode; /* shapes to try one by one beside it */
    int weight_area;  /* weight: area (1) or equal (0) */
    int frees;
    scene_mode *free; /* functions that are taken out of target and error */
} scene_target;

typedef struct scene_compare {
    char name[SCENE_NAME];
    int count;
    double *value;
    scene_at at;
} scene_compare;

typedef struct scene_limit { /* of some amplifiers; held where equal */
    int first, count;
    double lower, upper;
    scene_at at;
} scene_limit;

typedef struct scene_limits {
    double lower, upper, slew; /* V, V, V per step; infinite if not given */
    double effort;             /* absolute, or relative if effort_is_relative */
    int effort_is_relative;
    int each_count;
    scene_limit *each; /* own limits of some amplifiers, the last word */
    scene_at at;
} scene_limits;

/* A sensor that the firmware has: every value of an output, with noise of this standard deviation.
 */
typedef struct scene_reading {
    int output;
    double noise;
    scene_at at;
} scene_reading;

/* From what the firmware estimates the shape, and what may disturb it: standard deviations. */
typedef struct scene_estimate {
    int given;
    int readings;
    scene_reading *reading;
    double loads;     /* of every load's amount, 1: as the scene says */
    double volts;     /* of what an electrode does besides its command (V), -1: a tenth of half its
                         limits */
    double tolerance; /* most of the disturbance that the estimate may miss, or the readings do not
                         do */
    scene_at at;
} scene_estimate;

/* What happens at a tick of a simulation. */
typedef enum scene_event_type {
    EVENT_TARGET,
    EVENT_VALUE, /* a factor of the target, another target */
    EVENT_LOAD,
    EVENT_TEMPERATURE, /* on the structure; the controller does not know, but of known loads */
    EVENT_DEAD,
    EVENT_STUCK,
    EVENT_ALIVE, /* electrodes: at 0 V, at their last voltage, as they should be */
    EVENT_NAN,
    EVENT_FROZEN, /* a share of the sensors */
    EVENT_LOST    /* ticks in which the controller does not run */
} scene_event_type;

enum { TOLD_NEVER = -1, TOLD_FOUND = -2 }; /* the controller finds it by itself */

typedef struct scene_event {
    scene_event_type type;
    int tick;                   /* ascending over the events */
    double amount;              /* factor of target or load, temperature, share of the sensors */
    int ticks;                  /* nan, frozen, lost: for how long */
    int load;                   /* its number */
    int known;                  /* load: the controller is told the amount a tick before */
    int amplifiers, *amplifier; /* dead, stuck, alive: [amplifiers] */
    int told;    /* dead, stuck: ticks until the controller is told, or one of the two above */
    expr *value; /* another target */
    scene_at at;
} scene_event;

/* What the sensors are: those of the scene's estimate where it has one, or that, or one for every
 * target node. */
typedef enum scene_sight { SIGHT_SCENE, SIGHT_ESTIMATED, SIGHT_MEASURED } scene_sight;

/* A structure that is not quite the scene's, sensors, amplifiers and a schedule, for the controller
 * to live with. */
typedef struct scene_simulate {
    int given;
    int ticks, seed;
    double rate;   /* ticks a second, for the time axis */
    int at_target; /* influence: the controller's tables are made at the nonlinear optimum, not at
                      rest */
    scene_kinematics kinematics; /* of the plant: linear or nonlinear */
    double *stiffness, *d;       /* [materials] factors that the controller does not know */
    double hysteresis;           /* width of the largest loop over the range of the voltages */
    scene_sight sight;
    double noise; /* of measured shapes, standard deviation; an estimate's readings have their own
                   */
    int delay;    /* of the sensors, ticks */
    double step, dead_band; /* of the amplifiers, V */
    double fault_chance;    /* of a random fault in a tick */
    int fault_until;        /* tick from which there are none */
    int finds;              /* some electrode is TOLD_FOUND */
    int feeds;              /* some load is known */
    int events;
    scene_event *event;
    scene_at at;
} scene_simulate;

/* What vibration needs besides the densities of the materials. */
typedef struct scene_dynamics {
    double damping;    /* ratio of every mode to critical damping */
    int damping_given; /* by the scene; 0: an assumption */
    int modes;         /* of the structure that the stability of the control loop is judged with */
    double mass_per_area; /* of what is no layer, at the middle of the package */
} scene_dynamics;

typedef struct scene {
    char *path; /* file it was read from */
    char **set; /* [sets] changes that were applied */
    int sets;
    char name[SCENE_NAME];
    char *about;
    char unit_length[SCENE_NAME], unit_force[SCENE_NAME], unit_voltage[SCENE_NAME],
        unit_temperature[SCENE_NAME];
    uint32_t hash; /* of the scene's text and its --set changes */
    scene_element element;
    scene_kinematics kinematics;
    double tolerance; /* relative error the cheaper kinematics may cost under KINEMATICS_AUTO */
    scene_equilibrium equilibrium;
    scene_surface surface;
    scene_line line[2];
    int reference_is_middle;
    double reference; /* z of the reference surface above the inner face */
    int materials, layers, patch_grids, actuators, sensors, supports, loads, outputs, compares;
    scene_material *material;
    scene_layer *layer;
    scene_patches *patches;
    scene_actuator *actuator, *sensor;
    scene_support *support;
    scene_load *load;
    scene_contact contact;
    scene_output *output;
    scene_limits limits;
    scene_target target;
    scene_compare *compare;
    scene_estimate estimate;
    scene_simulate simulate;
    scene_dynamics dynamics;
    int amplifiers; /* of all actuators, in their order */
    int electrodes; /* of all sensors, in their order */
    scene_at at_surface, at_layers;
} scene;

/*
 * Read and check a scene.
 *   path     in   YAML file
 *   set      in   [sets] changes "a.b.c=value" applied before checking; list items by
 *                number from 0 or by their name; the value is YAML; a last key may be new
 *   error    out  [SCENE_ERROR] one line "file:line:column: what is wrong and the cure"
 * Returns 0, or -1 with error filled and *s empty.
 */
int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error);
void scene_free(scene *scene);

/* Name of amplifier k: that of its actuator, with _i_j (from 1) where the grid has more than one
 * patch. */
void scene_amplifier_name(const scene *scene, int k, char name[SCENE_LABEL]);

/* The same of electrode k of the sensors. */
void scene_sensor_name(const scene *scene, int k, char name[SCENE_LABEL]);

/* The amplifiers [*first, *first + *count) of an actuator or of one amplifier's name; returns
 * whether there are any. */
int scene_find_amplifier(const scene *scene, const char *name, int *first, int *count);

/* The same among the electrodes of the sensors. */
int scene_find_sensor(const scene *scene, const char *name, int *first, int *count);

/* Fill error with "file:line:column: ..." for a fault found after reading; returns -1. */
int scene_fault(const scene *scene, scene_at at, char *error, const char *format, ...);

#endif
