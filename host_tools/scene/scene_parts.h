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

/*
 * Mesh from a file (scene_quads.c): the section `mesh` with `file`; the sets of a layer, to =
 * scene_layer, and of patches, to = scene_patches; a set as a place, to = scene_where; three
 * numbers, and a unit vector, to = double[3].
 */
field_read read_mesh_file, read_mesh_disc, read_layer_sets, read_patch_sets, read_set, read_vector,
    read_unit;

/* Read a place in space, as a mapping of x, y, z, and find its nearest node (scene_quads.c). */
int read_place(reader *reader, int node, scene_where *where);

/*
 * Give the elements of a mesh from a file their regions, and apply the supports to its directors,
 * axes and constrained dof (scene_regions.c, scene_triads.c). Each returns 0, or -1 with error
 * filled.
 */
int check_regions(scene *scene, char *error);
int check_triads(scene *scene, char *error);

/* Materials, layers and element formulation (scene_model.c). */
field_read read_element, read_materials, read_layers, read_reference, read_patches;

/*
 * Springs; the stacks of an actuator, to = scene_actuator; a direction as a word or a vector, to =
 * scene_direction (scene_springs.c).
 */
field_read read_springs, read_stacks, read_any_direction;

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

/* Supervisor of the control loop (scene_safety.c). */
field_read read_safety;

/* Wrong wires of amplifiers (scene_imperfections.c); `to` is the scene_simulate. */
field_read read_reversed, read_swapped;

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
extern const form direction_form, stacks_form;
extern const form edge_form, point_form, node_form, at_form, face_form, place_form, mesh_file_form,
    mesh_disc_form;
extern const choice place_axes[], place_faces[];
extern const int place_components[];

/*
 * Table rows for the six directions, read by one function whose rule is the component, and for the
 * place of an edge or a set of nodes, at an offset in a structure.
 */
#define DIRECTION(key, read, i, of, form, help)                                                    \
    {                                                                                              \
        key, read, 0, &place_components[i], 0, of, form, help                                      \
    }
#define DIRECTIONS(read, of, form, what)                                                           \
    DIRECTION("u1", read, 0, of, form, what " along e1."),                                         \
        DIRECTION("u2", read, 1, of, form, what " along e2."),                                     \
        DIRECTION("u3", read, 2, of, form, what " along e3."),                                     \
        DIRECTION("x", read, 3, of, form, what " along the global x axis."),                       \
        DIRECTION("y", read, 4, of, form, what " along the global y axis."),                       \
        DIRECTION("z", read, 5, of, form, what " along the global z axis.")
#define PLACE(offset)                                                                              \
    {"set",                                                                                        \
     read_set,                                                                                     \
     offset,                                                                                       \
     NULL,                                                                                         \
     0,                                                                                            \
     OF_NOTHING,                                                                                   \
     &name_form,                                                                                   \
     "Mesh from a file: nodes of a set of the file, be it of nodes, edges or elements."},          \
        {"edge", read_edge,  offset,     NULL,                                                     \
         0,      OF_NOTHING, &edge_form, "All nodes of an edge of the mesh."},                     \
    {                                                                                              \
        "at", read_at, offset, NULL, 0, OF_COORDINATE, &at_form,                                   \
            "A node {theta1, theta2}, the nodes of a rectangle {theta1: [from, to], ...}, or "     \
            "nodes for all; mesh from a file: the node nearest to {x, y, z}, or {set: name}."      \
    }

/* Forms of the sections. */
extern const form element_form, surface_form, mesh_form, materials_form, layers_form,
    reference_form, patches_form, actuators_form, sensors_form, control_form, safety_form,
    limits_form, supports_form, springs_form, loads_form, contact_form, outputs_form, target_form,
    compare_form, estimate_form, dynamics_form, simulate_form, equilibrium_form, influence_form,
    measured_target_form;

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
