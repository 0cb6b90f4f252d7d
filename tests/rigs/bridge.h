/*
 * The tables and the double-precision answer of a scene as plain arrays, so that a test program
 * in either precision can run the library on what the host tools made in double.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef BRIDGE_H
#define BRIDGE_H

#include "pzs.h"
#include <stddef.h>
#include <stdint.h>

typedef struct bridge_rows {
    int count;
    const uint32_t *start;
    const uint16_t *dof;
    const double *value;
} bridge_rows;

typedef struct bridge {
    int nodes, elements, kinds, unknowns, dof;
    int amplifiers, targets; /* the first inputs, the first outputs */
    const uint16_t *element, *element_kind, *node_dof, *first;
    const double *stiffness, *kind; /* kind: the reals of pzs_element_type, one after the other */
    size_t kind_reals;              /* per kind */
    bridge_rows input, output, spring;
    const double *spring_stiffness; /* [springs] */
    const double *influence;        /* [outputs][inputs], refined, NULL without a target */
    const double *target;           /* [targets] */
    double *u;          /* [dof] displacement under the scene's loads, refined in double */
    const double *full; /* [inputs] the scene's loads and volts; these seven NULL or 0 where it is
                           linear */
    int given_values;
    const uint32_t *given_start; /* pzs_prescribed_resultants */
    const uint16_t *given_element, *given_which;
    const double *given_value; /* [given_values][10] */
    int electrodes;            /* pzs_electrodes, none where the scene has no sensors */
    const uint16_t *electrode_input;
    const uint8_t *pzs_electrode_open;
    bridge_rows direct;
    const double *amount; /* [inputs] of u, volts of open electrodes as they were found */
    double change;        /* pzs_solver.change */
    unsigned systems;     /* of the path that led to u */
    double condition, error;
    void *inside;
} bridge;

/* scene is the name of a shipped scene or a path. Returns 0, or -1 with error [400] filled. */
int bridge_open(bridge *tables, const char *scene, const char *const *set, int sets, char *error);
void bridge_close(bridge *tables);

/* Modal model of a scene: shapes of the target nodes and static responses, for modes of mass 1. */
typedef struct bridge_modes {
    int modes;
    double *frequency;  /* [modes] angular frequencies (rad/s) */
    double *shape;      /* [targets][modes] */
    double *modal;      /* [modes][amplifiers] static coordinate per volt */
    double *load;       /* [modes] static coordinate by the first load */
    double *load_shape; /* [targets] static shape by the first load */
} bridge_modes;

/* Of an open bridge whose scene has densities. Returns 0, or -1 with error [400] filled. */
int bridge_modes_open(bridge_modes *mode_tables, const bridge *tables, int modes, char *error);
void bridge_modes_close(bridge_modes *modes);

#endif
