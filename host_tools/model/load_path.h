/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load path: the curve of equilibria from the reference state, with one load factor on all input
 * values. The arc-length method (Crisfield 1981) follows it beyond limit points, where the load
 * decreases. Prescribed displacements, moving contact bodies and shells held by contact alone need
 * equal steps of the load factor, which end at a limit point.
 */
#ifndef LOAD_PATH_H
#define LOAD_PATH_H

#include <stdbool.h>
#include "pzs_base.h"
#include "face_strain.h"

/* One equilibrium on the load path, the sequence of equilibria under a growing load. */
typedef struct load_path_point {
    double load_factor;  /* load factor by which all input values are multiplied; 1 is the full load
                          */
    int negative_pivots; /* number of negative pivots of the tangent stiffness; 0: the equilibrium
                            is stable */
    int iterations; /* number of linear solves of the arc-length step that ended at this point */
    double turn; /* largest angle by which the shell has bent within an element: change of the angle
                    between the thickness directions at two neighbouring nodes (degrees) */
    int turn_element; /* index of the element within which the shell has bent by the largest angle
                       */
    double tilt;   /* largest angle between the line through the thickness of the deformed shell and
                      the normal of the undeformed shell (degrees) */
    int tilt_node; /* index of the node at which the line through the thickness has turned by the
                      largest angle, `tilt` */
    face_strain compression; /* lowest principal Green's strain of both faces of the shell, and the
                                element in which it occurs */
    double thickness_strain; /* Green's strain of the lines through the thickness of the shell in
                                the element whose face is compressed most */
} load_path_point;

typedef enum load_path_event_type {
    LOAD_PATH_LIMIT,       /* limit point: the load factor has a maximum or a minimum */
    LOAD_PATH_BIFURCATION, /* bifurcation point: another load path branches off */
    /*
     * on a path of equal load steps, the number of negative pivots of the tangent stiffness
     * changes: at a bifurcation, or because the set of nodes in contact changes
     */
    LOAD_PATH_STABILITY,
    LOAD_PATH_EVENT_TYPES
} load_path_event_type;

/*
 * Critical point (limit point or bifurcation) between two computed points of the load path, with
 * the indices `point` and `point` + 1.
 */
typedef struct load_path_event {
    load_path_event_type type;
    int point;
    double load_factor;
} load_path_event;

enum { LOAD_PATH_POINTS = 400, LOAD_PATH_EVENTS = 32 };

typedef struct load_path {
    int points, events, linear_solves;
    load_path_point point[LOAD_PATH_POINTS]; /* computed points of the load path; the first is the
                                                reference state */
    load_path_event event[LOAD_PATH_EVENTS]; /* critical points in the order of the load path; those
                                                beyond the largest number that can be stored
                                                (LOAD_PATH_EVENTS) are left out */
    bool is_closed;   /* whether the path ends because the branch has returned to its bifurcation */
    int branch_point; /* index of the point at a bifurcation from which the path follows a branch;
                         0: none */
    int outputs;      /* number of outputs of the scene */
    double *value;    /* [points][outputs] first value of each output of the scene at each point of
                         the load path; not filled for outputs of strains and stresses */
    double *event_value; /* [events][outputs] first value of each output of the scene at each
                            critical point (limit point or bifurcation) of the load path */
    double *row;       /* work array for the values of all outputs at one point of the load path */
    pzs_status status; /* status of the last load step of a path in equal load steps */
    bool is_complete;  /* whether the load path has reached the full load */
    bool has_equal_steps; /* true: the points of the load path follow each other in equal steps of
                             the load factor; false: by the arc-length method */
} load_path;

/* Return the name of a type of critical point, for tables and diagrams. */
const char *load_path_event_name(load_path_event_type type);

/* Release the memory of a load path and make the path empty. */
void load_path_free(load_path *path);

#endif
