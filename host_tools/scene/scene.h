/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene holds everything that a user states about a structure, read from a YAML file and checked.
 * The members are plain input data in the units of the scene; ply angles are in degrees, and
 * derived quantities are not stored here. All strings and arrays are owned by the scene and are
 * released by scene_free.
 */
#ifndef SCENE_H
#define SCENE_H

#include <stddef.h>
#include <stdint.h>
#include "../quads/quad_read.h"
#include "expr.h"
#include "scene_error.h"
#include "spline.h"

/*
 * Limits: bytes of a name (SCENE_NAME), bytes of a name followed by _i_j (SCENE_LABEL), largest
 * number of mesh nodes (SCENE_NODES), largest number of functions removed from a target
 * (SCENE_FREE).
 */
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
    SURFACE_SPIRAL,
    SURFACE_PARABOLOID,
    SURFACE_FORMULA
} scene_surface_type;

typedef struct scene_surface {
    scene_surface_type type;
    double radius; /* radius of a cylinder or sphere, of a cone at theta1 = 0, of the centre circle
                      of a torus */
    double angle;  /* half angle of a cone (degrees) */
    int axial; /* coordinate along the axis of a cylinder or spiral: 1 for theta1, 2 for theta2 */
    double waist, height; /* constants of a hyperboloid of radius waist sqrt(1 + (z/height)^2) */
    double tube;          /* radius of the tube of a torus */
    double inner, outer, turns; /* spiral: radius at angle 0, radius at its end, and number of turns
                                   between them */
    double focal_length;        /* distance of the focus of a paraboloid from its vertex */
    expr *formula[3];           /* x, y, z of theta1 and theta2; NULL: theta1, theta2, 0 */
    spline *meridian; /* meridian (r, z) of a surface of revolution over its chord length */
} scene_surface;

typedef enum scene_kinematics {
    KINEMATICS_LINEAR,
    KINEMATICS_NONLINEAR,
    KINEMATICS_AUTO
} scene_kinematics;

/* Settings of the solver of the nonlinear equilibrium equations. */
typedef struct scene_equilibrium {
    int load_steps;   /* number of load steps tried first */
    double tolerance; /* convergence tolerance: largest norm of the last increment relative to the
                      displacement of the load step */
    int extrapolated_iterations; /* number of iterations of a load step with extrapolated resultants
                    before the true resultants are used; 0: plain Newton method */
    int linear_solves;           /* largest number of linear solves */
    scene_at at;
} scene_equilibrium;

/*
 * Formulation of the finite element, selected in the scene by `element: published`, `element:
 * improved`, or a map of the members below.
 */
typedef struct scene_element {
    int cartesian; /* 1: strains from Cartesian differences of the displacement vectors of the
                      corners; 0: from derivatives in the local triad */
    double tau;    /* factor of the warping correction of the membrane shear strain */
    double rho;    /* factor of the bending flexibility that is added to the transverse shear
                      compliance */
    int hr, lin33; /* hr: condense the compliance in the strain modes 01, 10 and 11; lin33: condense
                      the linear part of the normal strain e33 */
    int metric;    /* 1: exact variation of the surface metric through the thickness */
    int exact_area;   /* 1: exact element area; 0: area from the metric at the element centre */
    int dof_per_node; /* 7 or 6 */
    int equilibrium_shear; /* 1: transverse shear stiffness of a laminate from equilibrium; 0: shear
                              strain constant through the thickness */
} scene_element;

typedef struct scene_line { /* mesh lines along theta1 or theta2 */
    int elements;
    double *point; /* coordinates of the mesh lines, ascending [elements + 1] */
    int slit;      /* 1: the ends of a full turn are not joined */
    scene_at at;
} scene_line;

/*
 * Mesh from a file, in place of mesh lines on a surface. Regions, constrained dof and axes of the
 * mesh are those of the scene's layers, patches and supports.
 */
typedef struct scene_quads {
    quad_mesh mesh;
    quad_warnings warnings;
    char *file;          /* name of the mesh file as the scene gives it */
    double direction[3]; /* vector from which ply angles are measured, projected on each element; 0:
                            the direction from corner 1 to corner 2 of each element */
    int accept_irregular; /* 1: elements that are too thin for an irregular mesh are reported, not
                             refused */
    scene_at at;
} scene_quads;

typedef struct scene_material {
    char name[SCENE_NAME];
    double e[3], g23, g13, g12, nu12, nu13, nu23; /* engineering constants; those of an isotropic
                                                     material follow from E and nu */
    double d31, d32, d33, d24, d15; /* piezoelectric constants (m/V): strain per electric field
                                       along the poling */
    double piezo_e[5]; /* piezoelectric constants e31, e32, e33, e24, e15 (C/m2), valid if has_e */
    int has_d, has_e;
    double permittivity; /* permittivity at constant strain (F/m); 0 if not given */
    double pyroelectric; /* pyroelectric constant along the poling at constant strain (C/(m2 K)) */
    double alpha[3];     /* thermal expansion coefficients (1/K) */
    double density;      /* mass per volume; the weight per volume is density * gravity */
    double field_limit;  /* depolarisation field (V/m); 0: no limit */
    int poling;          /* direction of the poling, +3 or -3 */
    scene_at at;
} scene_material;

typedef struct scene_layer {
    char name[SCENE_NAME];
    int material;
    double thickness, angle;
    int patched; /* 1: the layer consists of patches with no material between them */
    int poling;  /* direction of the poling, +3 or -3, given by the layer or else by its material */
    unsigned char *present; /* mesh from a file: 1 in the elements of the layer's sets [elements];
                               NULL: the layer has no sets */
    scene_at at;
} scene_layer;

typedef struct scene_patches { /* rectangular grid of patches on one layer */
    char name[SCENE_NAME];
    int layer;
    double theta1[2], theta2[2]; /* range of the grid, which must end on mesh lines; the whole mesh
                                    if not given */
    int grid[2]; /* number of patches along theta1 and theta2, 1 x 1 if not given; all patches must
                    end on mesh lines; mesh from a file: number of sets and 1 */
    int *patch;  /* mesh from a file: patch in each element, or -1 [elements]; else NULL */
    scene_at at;
} scene_patches;

typedef struct scene_drive {
    int patches;
    double factor;
} scene_drive;

typedef enum scene_edge {
    EDGE_NONE,
    EDGE_THETA1_MINUS,
    EDGE_THETA1_PLUS,
    EDGE_THETA2_MINUS,
    EDGE_THETA2_PLUS
} scene_edge;

/*
 * Set of nodes: an edge, all nodes, the node at (theta1, theta2), or the nodes of a rectangular
 * region of the mesh; on a mesh from a file a named set, all nodes, or the node nearest to a place.
 */
typedef enum scene_where_type {
    WHERE_EDGE,
    WHERE_NODES,
    WHERE_POINT,
    WHERE_REGION,
    WHERE_SET,
    WHERE_PLACE
} scene_where_type;
typedef struct scene_where {
    scene_where_type type;
    scene_edge edge;
    double theta[2];      /* coordinates of a point, equal to those of its mesh node */
    double span[2][2];    /* region: start and end along theta1 and theta2, infinite if not given */
    int node[2];          /* point: indices of its coordinates in line[0].point and line[1].point;
                             place: node[0] is the nearest node */
    char set[SCENE_NAME]; /* name of a set of the mesh file */
    double x[3];          /* place in space */
    scene_at at;
} scene_where;

typedef enum scene_face {
    FACE_MIDDLE,
    FACE_INNER,
    FACE_OUTER,
    FACE_MEAN
} scene_face; /* Face on which a load acts; half of a load on the middle acts on each face. */
typedef enum scene_component {
    COMPONENT_U1,
    COMPONENT_U2,
    COMPONENT_U3,
    COMPONENT_X,
    COMPONENT_Y,
    COMPONENT_Z
} scene_component;

/* Direction of a spring or a stack. */
typedef struct scene_direction {
    int given;
    scene_component component; /* direction in the triad of a node or along a global axis, where
                                  the vector is zero */
    double vector[3];          /* unit vector (x, y, z), or zero */
} scene_direction;

/* What the stiffness of a spring is related to. */
typedef enum scene_per { PER_POINT, PER_LENGTH, PER_AREA } scene_per;

/*
 * Springs of equal stiffness between places of the shell and the ground, or between one place and
 * another; of an actuator also its stacks, one amplifier each.
 */
typedef struct scene_spring {
    char name[SCENE_NAME]; /* empty if not given */
    scene_where where;     /* nodes with a spring each; where.at.column is 0 if points are given */
    int points;
    double (*point)[3];    /* [points] theta1, theta2 and 0, or x, y, z on a mesh from a file; z is
                              NAN where it is not given */
    scene_where to;        /* node at the other end; to.at.column is 0 for the ground */
    scene_direction along; /* direction of the displacement that elongates the spring */
    scene_direction about; /* axis of the rotation that turns a torsional spring */
    scene_face face;       /* face at which the spring is attached */
    double stiffness;      /* force per elongation, also per length or area; moment per angle of a
                              torsional spring */
    int per;               /* scene_per */
    double force;          /* stack: force per unit of its input while it cannot elongate */
    double stroke;         /* stack: elongation per unit of its input without a load; 0 if the force
                              is given */
    scene_at at;
} scene_spring;

/*
 * An actuator has one amplifier for each patch position of its grids; patches at the same position
 * are connected with signed factors. The first index counts along theta1, and the second index runs
 * fastest. An actuator may instead be one uniform temperature, or stacks with one amplifier each.
 * The same structure describes a sensor, which has electrodes but no amplifiers.
 */
typedef struct scene_actuator {
    char name[SCENE_NAME];
    int drives;
    scene_drive *drive;
    int is_temperature;
    scene_spring *stacks; /* places, directions and stiffness of the stacks; NULL: no stacks */
    double applied; /* voltage (V) or temperature (K) on each amplifier of the actuator in a plain
                       solution; of a list, the value with the largest magnitude */
    double *each;   /* the same of every amplifier, [grid[0] grid[1]]; NULL where all have `applied`
                     */
    int open;       /* sensor: 1 for open circuit, 0 for short circuit */
    int first, grid[2]; /* index of the first amplifier, or of the first electrode of a sensor, and
                           size of the grid: there are grid[0] * grid[1] of them */
    scene_at at;
} scene_actuator;

/*
 * Conditions of a support on a mesh from a file whose dof depend on the edge or on the node, beside
 * the bits of the seven dof: along an edge, across it, and along x, y, z.
 */
enum { FIX_SIMPLE = 128, FIX_SYMMETRIC = 256, FIX_X = 512, FIX_Y = 1024, FIX_Z = 2048 };

typedef struct scene_support {
    scene_where where;
    double direction[3]; /* mesh from a file: unit vector whose projection is e1 of the nodes; 0:
                            not given */
    unsigned fix;  /* bit i set: dof i of the nodes, in the order of the library's conventions, is
                      prescribed; on a mesh from a file also FIX_SIMPLE ... FIX_Z */
    expr *value;   /* prescribed displacement at full load; NULL: 0 */
    unsigned move; /* bit i set: prescribed dof i takes the value, while the other prescribed dof
                      are 0, so that a prescribed u3 moves both faces alike */
    scene_at at;
} scene_support;

typedef enum scene_load_type {
    LOAD_POINT,
    LOAD_LINE,
    LOAD_FACE,
    LOAD_WEIGHT,
    LOAD_TEMPERATURE
} scene_load_type;
/*
 * Pressure whose direction follows the deformed shell. FOLLOWER_NORMAL keeps its magnitude per
 * reference area along the unit normal of the outer face; FOLLOWER_PRESSURE acts per deformed area.
 */
typedef enum scene_follower { FOLLOWER_NONE, FOLLOWER_NORMAL, FOLLOWER_PRESSURE } scene_follower;

typedef struct scene_load {
    scene_load_type type;
    scene_where where; /* nodes on which a point load or line load acts; face load on a mesh from a
                          file: WHERE_SET limits it to an element set */
    scene_face face;
    scene_component component; /* direction of the load; a pressure has the direction u3 */
    expr *value;   /* load per point, length or area; temperature (K); acceleration of gravity for a
                      weight */
    expr *outer;   /* temperature at the outer face, with value at the inner face; NULL: uniform
                      temperature */
    int true_area; /* face load: 1 per area of the loaded face, 0 of the reference surface */
    scene_follower follower; /* face load: pressure that follows the deformation; FOLLOWER_PRESSURE
                                implies true_area */
    scene_at at;
} scene_load;

/* Rigid convex obstacle; all vectors have the components (x, y, z). */
typedef enum scene_body_type { BODY_PLANE, BODY_CYLINDER, BODY_SPHERE, BODY_PSI } scene_body_type;
typedef struct scene_body {
    scene_body_type type;
    double point[3];  /* point on a plane, on the axis of a cylinder, or the centre of a sphere */
    double normal[3]; /* unit normal of a plane, pointing out of the body */
    double axis[3];   /* unit vector along the axis of a cylinder */
    double radius;    /* radius of a cylinder or sphere */
    expr *value;      /* level-set function psi(x, y, z), positive outside the body */
} scene_body;

typedef struct scene_contact {
    int given;
    scene_face face; /* face of the shell that touches the body, inner or outer */
    scene_body body;
    double move[3];   /* displacement of the body at full load */
    double stiffness; /* contact: penalty factor kappa relative to the stiffness of the structure */
    scene_at at;
} scene_contact;

/*
 * Output of contact: a component of the resultant force on the shell, the number of nodes in
 * contact, or the contact pressure at a place.
 */
typedef enum scene_contact_output {
    CONTACT_NONE,
    CONTACT_X,
    CONTACT_Y,
    CONTACT_Z,
    CONTACT_NODES,
    CONTACT_PRESSURE
} scene_contact_output;

/* Output of electrodes: their voltages, or the charge on the side that faces +e3. */
typedef enum scene_electric_output {
    ELECTRIC_NONE,
    ELECTRIC_VOLTAGE,
    ELECTRIC_CHARGE
} scene_electric_output;

typedef struct scene_output {
    char name[SCENE_NAME];
    scene_contact_output contact;   /* if not CONTACT_NONE, the output is no displacement, and only
                                       CONTACT_PRESSURE has a place */
    scene_electric_output electric; /* if not ELECTRIC_NONE, the output is neither a displacement
                                       nor of contact and has no place */
    int of_sensor, first, count;    /* electric output: electrodes [first, first + count) of the
                                       sensors if of_sensor, else of the amplifiers */
    scene_where where;
    scene_component component;
    scene_face face;
    double reference; /* reference value printed beside the result; NAN if not given */
    scene_at at;
} scene_output;

/* Named shape with the component, place and weight of the target. */
typedef struct scene_mode {
    char name[SCENE_NAME];
    expr *value;
    scene_at at;
} scene_mode;

typedef struct scene_target {
    int given;
    scene_output what; /* component, face and place of the controlled displacement */
    expr *value;       /* desired displacement as a function of the coordinates */
    int modes;
    scene_mode *mode; /* alternative target shapes, each evaluated separately */
    int weight_area;  /* weight of the nodes in the error: 1 by area, 0 equal */
    int frees;
    scene_mode *free; /* functions whose best fit is removed from the target and from the error */
} scene_target;

typedef struct scene_compare {
    char name[SCENE_NAME];
    int count;
    double *value;
    scene_at at;
} scene_compare;

typedef struct scene_limit { /* voltage limits of the amplifiers [first, first + count); equal
                                limits hold the voltage */
    int first, count;
    double lower, upper;
    scene_at at;
} scene_limit;

typedef struct scene_limits {
    double lower, upper, step_limit; /* voltage limits (V) and step limit (V a tick); infinite if
                                        not given */
    double regularisation;           /* weight of the squared voltages: absolute, or relative if
                                        regularisation_is_relative */
    int regularisation_is_relative;
    int each_count;
    scene_limit *each; /* limits of individual amplifiers, which override the common ones */
    scene_at at;
} scene_limits;

/*
 * Measurement available to the firmware: all values of an output, with noise of the given standard
 * deviation.
 */
typedef struct scene_reading {
    int output;
    double noise;
    scene_at at;
} scene_reading;

/*
 * Measurements from which the firmware estimates the shape, and standard deviations of the
 * disturbances.
 */
typedef struct scene_estimate {
    int given;
    int readings;
    scene_reading *reading;
    double loads;     /* standard deviation of the amount of every load, relative to the load of the
                         scene */
    double voltages;  /* standard deviation of the voltage error of an electrode (V); -1: a tenth of
                         half its voltage range */
    double tolerance; /* largest fraction of the disturbance that the estimate may leave unobserved;
                         the readings are refused if more remains */
    scene_at at;
} scene_estimate;

/* Change that takes place at a tick of a simulation. */
typedef enum scene_event_type {
    EVENT_TARGET,
    EVENT_VALUE, /* EVENT_TARGET scales the target by a factor, EVENT_VALUE replaces the target */
    EVENT_LOAD,
    EVENT_TEMPERATURE, /* EVENT_LOAD scales a load and EVENT_TEMPERATURE heats the structure; the
                          controller is informed only of known loads */
    EVENT_DEAD,
    EVENT_STUCK,
    EVENT_ALIVE, /* electrodes at 0 V (EVENT_DEAD), held at their last voltage (EVENT_STUCK), or
                    working again (EVENT_ALIVE) */
    EVENT_NAN,
    EVENT_FROZEN,  /* a fraction of the sensors reads NaN (EVENT_NAN) or keeps its last value
                      (EVENT_FROZEN) */
    EVENT_LOST,    /* the controller does not run for some ticks */
    EVENT_IMPULSE, /* a load acts like a hammer: its force during `amount` seconds, at one instant
                    */
    EVENT_SINE,    /* a load varies by amount sin(2 pi frequency t) for some ticks */
    EVENT_LATE,    /* for some ticks the voltages act a random part of the interval late, up to
                      `amount` */
    EVENT_JITTER,  /* for some ticks the interval is longer or shorter by a random part, up to
                      `amount` */
    EVENT_DELAY    /* for some ticks the readings arrive `amount` ticks later than the controller
                      believes */
} scene_event_type;

/* Whether the controller is never informed of an electrode fault or detects the fault itself. */
enum { TOLD_NEVER = -1, TOLD_FOUND = -2 };

typedef struct scene_event {
    scene_event_type type;
    int tick;         /* tick of the event; the events are in ascending order */
    double amount;    /* factor of the target or load, temperature, or probability that a sensor is
                         affected */
    int ticks;        /* duration in ticks of EVENT_NAN, EVENT_FROZEN, EVENT_LOST and of those from
                         EVENT_SINE on */
    int load;         /* index of the load of EVENT_LOAD, EVENT_IMPULSE and EVENT_SINE */
    double frequency; /* frequency of EVENT_SINE (Hz) */
    int known; /* EVENT_LOAD: 1 if the controller is given the load factor one tick in advance */
    int amplifiers, *amplifier; /* amplifiers of EVENT_DEAD, EVENT_STUCK and EVENT_ALIVE
                                   [amplifiers] */
    int told; /* EVENT_DEAD, EVENT_STUCK: ticks until the controller is informed, or TOLD_NEVER or
                 TOLD_FOUND */
    expr *value; /* new target of EVENT_VALUE */
    scene_at at;
} scene_event;

/*
 * Source of the measured shape. SIGHT_SCENE: the readings of the scene's estimate if there is one,
 * else one sensor for each target node; SIGHT_ESTIMATED and SIGHT_MEASURED select one of the two.
 */
typedef enum scene_sight { SIGHT_SCENE, SIGHT_ESTIMATED, SIGHT_MEASURED } scene_sight;

/* Imperfections of sensors and amplifiers of the plant that the controller does not know. */
typedef struct scene_imperfections {
    double bandwidth;      /* corner frequency of the amplifiers, first order (Hz); 0: no limit */
    double creep;          /* creep of the ceramic a decade of time, relative to the voltage */
    double drift;          /* drift of every sensor, of random sign (reading a second) */
    double quantum;        /* step of the sensors' converters (unit of the reading) */
    double outlier_chance; /* probability that a reading is an outlier */
    double outlier_size;   /* largest error of an outlier (unit of the reading) */
    int reversals, *reversed; /* amplifiers whose wires are reversed [reversals] */
    int swaps, *swapped;      /* amplifiers whose cables are swapped, the first with the second, the
                                 third with the fourth, ... [swaps] */
} scene_imperfections;

/*
 * Closed-loop simulation of the controller with a plant that differs from the scene, with sensors,
 * amplifiers and a schedule of events.
 */
typedef struct scene_simulate {
    int given;
    int ticks, seed;
    int at_target; /* 1: the controller's influence matrix is that at the nonlinear optimum; 0: in
                      the undeformed state */
    scene_kinematics kinematics; /* kinematics of the plant, linear or nonlinear */
    double *stiffness, *d; /* factors of the plant's stiffness and piezoelectric constants that the
                              controller does not know [materials] */
    double *gain;          /* factors of the columns of a measured matrix in the plant, which the
                              controller does not know [amplifiers] */
    double scatter;        /* standard deviation of the relative error of its entries */
    double hysteresis;     /* width of the largest hysteresis loop relative to the voltage range */
    scene_sight sight;
    double noise; /* standard deviation of the noise of measured shapes; the readings of an estimate
                     have their own */
    int delay;    /* delay of the sensors (ticks) */
    double step, dead_band; /* voltage resolution of the converters and dead band of the amplifiers
                               (V) */
    double fault_chance;    /* probability of a random fault in a tick */
    int fault_until;        /* tick from which no random faults occur */
    int inertia_given, inertia; /* whether the scene says that the plant has inertia or has none */
    int modes;                  /* largest number of modes of a plant with inertia */
    int hysteresis_given;       /* whether the scene gives the hysteresis */
    scene_imperfections imperfections;
    int finds; /* 1: the fault of some electrode is TOLD_FOUND */
    int feeds; /* 1: some load event is known to the controller */
    int events;
    scene_event *event;
    scene_at at;
} scene_simulate;

/*
 * Measured influence matrix in the place of a structure. Its columns are the actuators of the
 * scene, one amplifier each. Outputs that the scene ignores are left out of every array but
 * output_name.
 */
typedef struct scene_influence {
    int given;
    char file[256];     /* file of the matrix, as the scene names it */
    int outputs;        /* rows that are used */
    int file_outputs;   /* rows of the file */
    int *row;           /* [outputs] number of each row in the file, from 0 */
    double *matrix;     /* [outputs][amplifiers] displacement per volt */
    double (*place)[3]; /* [outputs] coordinates x, y, z; NULL where the scene gives none */
    char (*output_name)[SCENE_NAME]; /* [file_outputs] names, or NULL */
    scene_at at;
} scene_influence;

/* Data for vibration in addition to the densities of the materials. */
typedef struct scene_dynamics {
    double damping; /* damping ratio of every mode relative to critical damping */
    int dampings;   /* number of entries of damping_of_mode; 0: `damping` holds for every mode */
    double *damping_of_mode; /* damping ratios of the first modes; the last entry holds for all
                                later modes [dampings] */
    int is_rayleigh;         /* damping ratios follow from Rayleigh's coefficients */
    double rayleigh[2]; /* coefficients of mass (rad/s) and stiffness (s/rad): damping ratio a/(2 w)
                           + b w/2 */
    int damping_given;  /* 1: the damping ratio is given by the scene; 0: it is an assumed value */
    int modes; /* number of vibration modes used to assess the stability of the control loop */
    double mass_per_area; /* mass per area that belongs to no layer, located at the middle of the
                             laminate */
} scene_dynamics;

/* Data of the control loop on the device. */
typedef struct scene_control {
    double rate; /* tick rate (ticks per second); 0 if neither given nor needed by a simulation */
    int moving_target; /* 1: a governor lets the damped tick follow a moving target */
    double clock;      /* clock of the device's processor (Hz); 0 if not given */
} scene_control;

/* Supervisor of the control loop. */
typedef struct scene_safety {
    int given;
    double park;    /* park voltage of all amplifiers, clamped to the limits of each */
    int timeout;    /* ticks without usable readings until control is taken away; 0: never */
    int ramp_ticks; /* shortest ramp to the park voltages (ticks) */
    int waits;      /* 1: the loop waits for the command to arm; 0: it arms itself */
} scene_safety;

typedef struct scene {
    char *path; /* path of the scene file */
    char **set; /* changes applied to the scene file [sets] */
    int sets;
    char name[SCENE_NAME];
    char *about;
    char unit_length[SCENE_NAME], unit_force[SCENE_NAME], unit_voltage[SCENE_NAME],
        unit_temperature[SCENE_NAME];
    uint32_t hash; /* hash of the text of the scene and of its --set changes */
    scene_element element;
    scene_kinematics kinematics;
    double tolerance; /* largest relative error that simpler kinematics may cause under
                         KINEMATICS_AUTO */
    scene_equilibrium equilibrium;
    scene_surface surface;
    scene_line line[2]; /* mesh lines; without points where the mesh comes from a file */
    scene_quads *quads; /* mesh from a file, or NULL */
    int reference_is_middle;
    double reference; /* z coordinate of the reference surface, measured from the inner face */
    int materials, layers, patch_grids, actuators, sensors, supports, springs, loads, outputs,
        compares;
    scene_material *material;
    scene_layer *layer;
    scene_patches *patches;
    scene_actuator *actuator, *sensor;
    scene_support *support;
    scene_spring *spring;
    scene_load *load;
    scene_contact contact;
    scene_output *output;
    scene_limits limits;
    scene_target target;
    scene_compare *compare;
    scene_estimate estimate;
    scene_simulate simulate;
    scene_dynamics dynamics;
    scene_control control;
    scene_safety safety;
    scene_influence influence;
    int amplifiers; /* number of amplifiers of all actuators, in the order of the actuators */
    int electrodes; /* number of electrodes of all sensors, in the order of the sensors */
    scene_at at_surface, at_layers;
} scene;

/*
 * Read and check a scene.
 *   path     in   YAML file
 *   set      in   [sets] changes "a.b.c=value" applied before checking; list items are
 *                selected by their index from 0 or by their name; the value is YAML; the
 *                last key may be a new one
 *   error    out  [SCENE_ERROR] one line "file:line:column: what is wrong and the cure"
 * Returns 0, or -1 with error filled and *scene empty.
 */
int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error);

/* Read a scene from a text instead of the file at the path, which is named in messages only. */
int scene_read_text(scene *scene, const char *path, const char *text, size_t bytes, char *error);
void scene_free(scene *scene);

/*
 * Write the name of amplifier k: the name of its actuator, followed by _i_j (indices from 1) if the
 * grid has more than one patch.
 */
void scene_amplifier_name(const scene *scene, int k, char name[SCENE_LABEL]);

/* Write the name of electrode k of the sensors, formed like the name of an amplifier. */
void scene_sensor_name(const scene *scene, int k, char name[SCENE_LABEL]);

/*
 * Find the amplifiers [*first, *first + *count) that belong to the name of an actuator or of a
 * single amplifier. Returns 1 if there are any, otherwise 0.
 */
int scene_find_amplifier(const scene *scene, const char *name, int *first, int *count);

/*
 * Find the electrodes [*first, *first + *count) that belong to the name of a sensor or of a single
 * electrode. Returns 1 if there are any, otherwise 0.
 */
int scene_find_sensor(const scene *scene, const char *name, int *first, int *count);

/*
 * Mark the nodes of a place on a mesh from a file; a set is looked for among the node sets, the
 * edge sets and the element sets, in this order. in_set [nodes] out  1 for the nodes of the place,
 * else 0 Returns their number.
 */
size_t scene_mark_nodes(const scene *scene, const scene_where *where, unsigned char *in_set);

/* Write an error message "file:line:column: ..." for a fault found after reading; returns -1. */
int scene_fault(const scene *scene, scene_at at, char *error, const char *format, ...);

#endif
