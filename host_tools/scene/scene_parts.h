/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that read the sections of a scene, one function for each section, and the check of the
 * complete scene.
 */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H

#include "scene_fields.h"

/* Geometry (scene_shape.c). The argument `to` of every section reader is the scene. */
field_read read_surface, read_mesh;

/* Materials, layers and element formulation (scene_model.c). */
field_read read_element, read_materials, read_layers, read_reference, read_patches;

/* Supports, loads and contact (scene_load.c). */
field_read read_supports, read_loads, read_contact;

/* A measured influence matrix in the place of a structure (scene_influence.c). */
field_read read_influence;

/* Target of a scene with a measured matrix, whose rows are the outputs of the matrix. */
field_read read_measured_target;

/*
 * Check the functions of a scene with a measured matrix. Returns 0, or -1 with error filled.
 */
int scene_check_influence(const scene *scene, char *error);

/* Solver settings, actuators, sensors, limits and outputs (scene_task.c). */
field_read read_equilibrium, read_actuators, read_sensors, read_limits, read_outputs, read_target,
    read_compare;

/* Measurements from which the firmware estimates the shape (scene_estimate.c). */
field_read read_estimate;

/* Data for vibration, and of the control loop on the device (scene_dynamics.c). */
field_read read_dynamics, read_control;

/*
 * Imperfections of sensors, amplifiers and ceramic (scene_imperfections.c); `to` is the
 * scene_simulate.
 */
field_read read_bandwidth, read_creep, read_drift, read_quantum, read_outliers, read_reversed,
    read_swapped;

/* Append the amplifiers that a list of names of amplifiers or actuators denotes. */
int read_amplifier_names(reader *reader, int node, int **list, int *count);

/* Closed-loop simulation (scene_simulate.c). */
field_read read_simulate;

/*
 * Places, faces and directions (scene_place.c); the argument `to` of the place readers is a
 * scene_where.
 */
field_read read_edge, read_point, read_at;
int require_place(reader *reader, int node, const scene_where *where);
extern const choice place_axes[], place_faces[];
extern const int place_components[];

/* Table rows for the six directions, read by one function whose rule is the component. */
#define DIRECTIONS(read)                                                                           \
    {"u1", read, 0, &place_components[0], 0}, {"u2", read, 0, &place_components[1], 0},            \
        {"u3", read, 0, &place_components[2], 0}, {"x", read, 0, &place_components[3], 0},         \
        {"y", read, 0, &place_components[4], 0},                                                   \
    {                                                                                              \
        "z", read, 0, &place_components[5], 0                                                      \
    }

/* Default element formulation of a scene. */
extern const scene_element element_improved;

/*
 * Check the names of a scene. Returns 0, or -1 with error filled.
 */
int scene_check_names(const scene *scene, char *error);

/*
 * Check what involves several sections of a scene, and move points and patch edges exactly onto
 * mesh lines (scene_check.c). Returns 0, or -1 with error filled.
 */
int scene_check(scene *scene, char *error);

/* Return 1 if the material of some layer has thermal expansion, otherwise 0. */
int scene_expands(const scene *scene);

#endif
