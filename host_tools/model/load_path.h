/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load path: the curve of equilibria that begins in the reference state, through limit points,
 * where the load has to decrease. All input values of the scene are multiplied by one load factor.
 * The curve is followed by the arc-length method with a spherical constraint (Crisfield 1981): each
 * step has a given length of displacement, and the load factor is an unknown.
 */
#ifndef LOAD_PATH_H
#define LOAD_PATH_H

/* One equilibrium of the path. */
typedef struct load_path_point {
    double load_factor;  /* 1: full load */
    int negative_pivots; /* negative pivots of the tangent; 0: stable */
    int iterations;      /* linear solves of the step that ended here */
} load_path_point;

typedef enum load_path_event_type {
    LOAD_PATH_LIMIT,      /* the load factor has a maximum or a minimum */
    LOAD_PATH_BIFURCATION /* another path branches off */
} load_path_event_type;

/* A critical point between points `point` and `point` + 1. */
typedef struct load_path_event {
    load_path_event_type type;
    int point;
    double load_factor;
} load_path_event;

enum { LOAD_PATH_POINTS = 400, LOAD_PATH_EVENTS = 32 };

typedef struct load_path {
    int points, events, linear_solves;
    load_path_point point[LOAD_PATH_POINTS]; /* the first one is the reference state */
    load_path_event event[LOAD_PATH_EVENTS]; /* the first ones, in the order of the path */
    int rows;                                /* output rows of the structure */
    double *value;                           /* [points][rows] output rows at each point */
    int is_complete;                         /* whether the path has reached the full load */
} load_path;

/* Release the memory of a path, which is then empty. */
void load_path_free(load_path *path);

#endif
