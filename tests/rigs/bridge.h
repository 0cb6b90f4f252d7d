/*
 * Tables and solution of a scene as plain arrays in double, so that a test program of either
 * precision can run the library on tables that the host tools have made.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef BRIDGE_H
#define BRIDGE_H

#include "pzs.h"
#include <stddef.h>
#include <stdint.h>

/* Number of reals of a compact element type. */
enum { BRIDGE_COMPACT = 110 };

typedef struct bridge_rows {
    int count;
    const uint32_t *start;
    const uint16_t *dof;
    const double *value;
} bridge_rows;

typedef struct bridge {
    int nodes, elements, types, dof_per_node, dof;
    int amplifiers, targets; /* number of first inputs that are amplifiers, and of first outputs
                                that have a target */
    const uint16_t *element, *element_type, *node_dof, *first_column;
    const double *stiffness, *type_values; /* type_values: the reals of each pzs_element_type, one
                                       type after the other */
    size_t type_reals;                     /* number of reals of one element type */
    int compact_types;        /* number of compact element types, or 0 where the mesh has none */
    double *compact_value;    /* [compact_types][BRIDGE_COMPACT] reals of each pzs_compact_type */
    uint16_t *compact_corner; /* [compact_types][4] corners of each pzs_compact_type */
    double *node_value;       /* [nodes][12] position and local axes of each pzs_node */
    bridge_rows input, output, spring;
    const double *spring_stiffness; /* [springs] spring stiffness (N/m) */
    int turns;                 /* number of nodes at oblique supports, whose mean displacements act
                                  along rotated axes */
    const uint16_t *node_turn; /* [nodes] index of each node's rotation, or PZS_UNTURNED */
    const double *turn;        /* [turns][3][3] rotations (1) */
    const double *influence;   /* [outputs][inputs] influence matrix from refined solutions (m/V);
                                  NULL without a target */
    const double *target;      /* [targets] target shape (m) */
    double *displacement; /* [dof] displacement under the loads of the scene, refined in double (m
                             and 1) */
    const double *full_input; /* [inputs] loads and voltages of the scene; this member and the
                           following ones up to given_value are NULL or 0 in a linear scene */
    int given_values;
    const uint32_t *given_start; /* arrays of pzs_prescribed_resultants */
    const uint16_t *given_element, *given_which;
    const double *given_value; /* [given_values][10] prescribed resultants (N m) */
    int motions, motion_input; /* arrays of pzs_prescribed_motion, and its input */
    const uint16_t *motion_dof;
    const double *motion_value; /* [motions] (m and 1) */
    int electrodes; /* number of electrodes in pzs_electrodes; 0 where the scene has no sensors */
    const uint16_t *electrode_input;
    const uint8_t *electrode_open;
    bridge_rows direct;
    const double *input_value; /* [inputs] input values that belong to the displacement, with the
                             voltages of open electrodes */
    double tolerance;          /* tolerance of the equilibrium solver */
    unsigned linear_solves;    /* number of linear solves that the equilibrium solver has made */
    double condition, error;
    void *inside;
} bridge;

/*
 * Read and solve a scene, given as the name of a shipped scene or as a path. Returns 0, or -1 with
 * a message in error [400].
 */
int bridge_open(bridge *tables, const char *scene, const char *const *set, int sets, char *error);
void bridge_close(bridge *tables);

/*
 * Read a scene without solving it: the members of the structure alone are filled. For structures
 * without supports.
 */
int bridge_open_unsolved(bridge *tables, const char *scene, const char *const *set, int sets,
                         char *error);

/*
 * Modal model of a scene, with modes of unit modal mass: shapes at the nodes of the target, and
 * static responses.
 */
typedef struct bridge_modes {
    int modes;
    double *frequency;  /* [modes] angular frequencies (rad/s) */
    double *shape;      /* [targets][modes] displacement of each target per modal coordinate */
    double *modal;      /* [modes][amplifiers] static modal coordinate per volt */
    double *load;       /* [modes] static modal coordinate under the first load */
    double *load_shape; /* [targets] static displacement under the first load (m) */
} bridge_modes;

/*
 * Compute the modal model of a scene with densities. Returns 0, or -1 with a message in error
 * [400].
 */
int bridge_modes_open(bridge_modes *mode_tables, const bridge *tables, int modes, char *error);
void bridge_modes_close(bridge_modes *modes);

/* Circuits of the electrodes while a structure vibrates, in the order of electrode_circuit. */
typedef enum bridge_circuit { BRIDGE_SCENE, BRIDGE_SHORT, BRIDGE_OPEN } bridge_circuit;

/* Mass tables of a scene (pzs_mass), and what the host finds with them, in double. */
typedef struct bridge_mass {
    int types, rigid, count;
    const uint16_t *element_type; /* [elements] */
    const double *matrix;         /* [types] packed element mass matrices */
    double *square;               /* [count] squared angular frequencies (rad^2/s^2) */
    double *shape;                /* [count][dof] mode shapes of unit modal mass */
    double *response;             /* [count][inputs] static value of each modal coordinate */
    int electrodes;               /* number of electrodes in pzs_electrodes; 0: none is open */
    int open; /* number of electrodes that are open while the structure vibrates */
    const uint16_t *electrode_input;
    const uint8_t *electrode_open; /* whether each electrode is open by the scene */
    const uint8_t *is_open;        /* [electrodes] whether each is open in the circuit */
    bridge_rows direct;
    void *inside;
} bridge_mass;

/*
 * Build the mass tables of a scene with densities, and compute its lowest modes on the host; about
 * the equilibrium where the scene is nonlinear. Returns 0, or -1 with a message in error [400].
 */
int bridge_mass_open(bridge_mass *mass, const bridge *tables, bridge_circuit circuit, int modes,
                     char *error);
void bridge_mass_close(bridge_mass *mass);

/*
 * Least squares of `pzs calibrate` without a model: influence matrix, standard errors of its
 * columns and noise, from records of voltages and shapes.
 *   voltage   [count][inputs]   in
 *   shape     [count][outputs]  in
 *   influence [outputs][inputs] out
 *   spread    [inputs]          out
 * Returns the standard deviation of the noise, or NAN on failure.
 */
double bridge_calibrate(size_t count, size_t inputs, size_t outputs, const double *voltage,
                        const double *shape, double *influence, double *spread);

#endif
