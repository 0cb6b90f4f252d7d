/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that read the sections of a scene, one for each section, and that check the complete
 * scene.
 */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H

#include "scene_fields.h"

/*
 * Functions that read the sections `surface` and `mesh` of a scene file (scene_shape.c). Their
 * argument `to`, which receives the values, is the scene.
 */
field_read read_surface, read_mesh;

/*
 * Readers of keys of scenes whose mesh comes from a file, or from the keys `disc` or `panel`
 * (scene_quads.c, scene_disc.c, scene_panel.c), with the C object that each fills:
 *   read_mesh_file    the scene; also read_mesh_disc, read_mesh_panel
 *   read_layer_sets   scene_layer, with the elements of the named sets
 *   read_patch_sets   scene_patches, with the elements of the named sets
 *   read_set          scene_where (place on the mesh), with the name of a set
 *   read_set_pattern  scene_where, with a name in which a * stands for any text
 *   read_ply_direction  nothing: the direction of layers goes to the scene of the reader
 *   read_vector       double[3]
 *   read_unit         double[3], a vector scaled to length 1
 */
extern const form ply_direction_form;
field_read read_ply_direction;
field_read read_mesh_file, read_mesh_disc, read_mesh_panel, read_layer_sets, read_patch_sets,
    read_set, read_set_pattern, read_vector, read_unit;

/* Keys that may stand beside the key `disc` or `panel` in the section `mesh` of a scene file. */
typedef struct block_options {
    bool accept_irregular; /* elements that are too thin for an irregular mesh: true: they are
                              accepted with a warning; false: the mesh is refused */
} block_options;
#define DIRECTION_ROW                                                                              \
    {                                                                                              \
        "direction", read_ply_direction, 0, NULL, 0, OF_NUMBER, &ply_direction_form,               \
            "Direction from whose projection the angles of layers are measured: a vector [x, y, "  \
            "z], three formulas of x, y and z, or the name of a set of edges, along the nearest "  \
            "of which it runs. Default, where the elements follow mesh lines or no layer needs a " \
            "direction, the first side of each element."                                           \
    }
#define BLOCK_ROWS(offset)                                                                         \
    DIRECTION_ROW,                                                                                 \
    {                                                                                              \
        "accept_irregular", read_flag, (offset) + offsetof(block_options, accept_irregular), NULL, \
            0, OF_NOTHING, NULL,                                                                   \
            "Report elements that are too thin for an irregular mesh, instead of refusing them; "  \
            "default false."                                                                       \
    }

/*
 * Let a scene own a mesh that was made from the key `disc` or `panel` (scene_disc.c). The scene
 * must not have a surface of its own. Returns 0, or -1 after writing an error message about the
 * scene file. Even after an error the caller must not release the mesh.
 */
int scene_take_block(reader *reader, int node, scene *scene, const char *key, quad_mesh *mesh,
                     const block_options *options);

/*
 * Among the sets of nodes, edges and elements of the mesh file, consider those whose names fit a
 * pattern, in which the first * stands for any text. Copy the name of the k-th of them (from 0) to
 * `name`, which stays unchanged if there are fewer. Returns the number of sets that fit.
 */
int scene_fitting_set(const scene *scene, const char *pattern, int k, char name[SCENE_NAME]);

/*
 * Read a point on a mesh from a file, a mapping of x, y and z, and find the mesh node nearest to it
 * (scene_quads.c). Returns 0, or -1 after writing an error message about the scene file.
 */
int read_place(reader *reader, int node, scene_where *where);

/*
 * Complete a mesh from a file after the scene has been read. Each returns 0, or -1 with error
 * filled.
 *   check_regions  groups the elements into regions with the same layers
 *   check_directions  computes the material direction of the layers on each element. Refuses a
 *       material that depends on the direction on elements without one
 *   check_triads   applies the supports: marks held dof, turns directors (unit normals) into
 *       symmetry planes and the local axis e1 into directions of supports
 */
int check_regions(scene *scene, char *error);
int check_directions(scene *scene, char *error);
int check_triads(scene *scene, char *error);

/*
 * Readers of the sections for materials, layers, patches and the element formulation
 * (scene_model.c).
 */
field_read read_element, read_materials, read_layers, read_reference, read_patches;

/*
 * Readers of springs, of the piezoelectric stacks of an actuator (into the scene_actuator at `to`),
 * and of a direction, which is a word or a vector (into the scene_direction at `to`); see
 * scene_springs.c.
 */
field_read read_springs, read_stacks, read_any_direction;

/*
 * Read points that need not be nodes of the mesh from a list or a file of them (scene_springs.c).
 *   point   out  allocated coordinates; NULL where the function fails
 *   points  out  number of points, at least 1
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int scene_points_read(reader *reader, int node, double (**point)[3], int *points);

/* Reader of the section for concentrated masses (scene_masses.c). */
field_read read_masses;

/*
 * Functions that read the electrodes of patches (scene_outlines.c): the plane of their outlines,
 * into the outline_plane at `to`, and the outlines, into the scene_patches at `to`.
 */
field_read read_plane, read_outlines;
extern const form plane_form, outlines_form;

/*
 * Compute the area fraction of each element that each electrode covers, and refuse electrodes that
 * extend beyond the surface or overlap (outline_check.c). Returns 0, or -1 with error filled.
 */
int check_outlines(scene *scene, char *error);

/* Readers of the sections for supports, loads and contact (scene_load.c). */
field_read read_supports, read_loads, read_contact;

/*
 * Reader of the section for a measured influence matrix in place of a structural model
 * (scene_influence.c).
 */
field_read read_influence;

/*
 * Read the groups of actuators that one amplifier drives (key `tied`), and replace the actuators of
 * each group by one (scene_tied.c). Returns 0, or -1 after writing an error message about the scene
 * file.
 */
int scene_tie(reader *reader, int node);
extern const form tied_form;

/*
 * Function that reads the vibration modes of a scene with a measured influence matrix into the
 * scene, to which its argument `to` points (scene_measured_modes.c). It must be called after the
 * influence matrix is read.
 */
field_read read_measured_modes;
extern const form measured_modes_form;

/*
 * Reader of the curves of actuators that are not linear into the scene, to which its argument `to`
 * points (scene_curves.c). It must be called after the influence matrix is read.
 */
field_read read_curves;
extern const form curves_form;

/*
 * Complete the curves of actuators that are not linear after the scene has been read: square curves
 * end at the voltage limits, effects (values to which the displacements are proportional) are
 * scaled to volts, and the influence matrix becomes the displacement per volt of effect. Refuses
 * curves that end inside the voltage limits, and functions of the control loop that assume linear
 * actuators. Returns 0, or -1 with error filled.
 */
int scene_check_curves(scene *scene, char *error);

/*
 * Reader of the target of a scene with a measured influence matrix; the target has one value for
 * each output of the matrix.
 */
field_read read_measured_target;

/*
 * Check that the formulas and tables of a scene with a measured influence matrix, such as its
 * target, use only coordinates that its outputs have. Returns 0, or -1 with error filled.
 */
int scene_check_influence(const scene *scene, char *error);

/*
 * Return an advice that an error message may end with: to transpose the measured influence matrix
 * of a scene. The text is empty where the scene has no such matrix, or one without more actuators
 * than outputs.
 */
const char *scene_transposed_hint(const scene *scene);

/*
 * Readers of the sections for the equilibrium solver, actuators, sensors, limits, outputs, target
 * and reference values (scene_task.c).
 */
field_read read_equilibrium, read_actuators, read_sensors, read_limits, read_outputs, read_target,
    read_compare;

/*
 * Reader of the section for the measurements from which the firmware estimates the shape
 * (scene_estimate.c).
 */
field_read read_estimate;

/*
 * Readers of the sections for vibration data and for the control loop on the device
 * (scene_dynamics.c).
 */
field_read read_dynamics, read_control;

/*
 * Reader of the key control.modal_gains of a scene file (scene_modal_gains.c): for each mode, the
 * part of a wanted change that a control tick makes (gain), and the part of its coordinate that is
 * lost in a tick (leak).
 */
field_read read_modal_gains;
extern const form modal_gains_form;

/*
 * Read the shape of a mode: a function at the target nodes, or one of the words piston, tip and
 * tilt. `item` points to the scene_mode that receives it (scene_task.c).
 */
item_read read_shape_function;

/* Reader of the section for the supervisor of the control loop (scene_safety.c). */
field_read read_safety;

/* Reader of the section for hysteresis and creep of the ceramic (scene_hysteresis.c). */
field_read read_hysteresis_section;

/*
 * Readers of the simulated wiring faults of amplifiers (scene_imperfections.c). The argument `to`
 * points at the struct scene_simulate that they fill.
 */
field_read read_reversed, read_swapped;

/*
 * Read a YAML list of names of actuators or single amplifiers, and append the numbers of their
 * amplifiers to an allocated list. Returns 0, or -1 after writing an error message about the scene
 * file.
 */
int read_amplifier_names(reader *reader, int node, int **list, int *count);

/*
 * Read numbers of the amplifiers: one number for all, or a mapping from names of actuators or
 * single amplifiers to numbers. If several names comprise the same amplifier, the last number
 * applies.
 *   absent  in                number of an amplifier that the mapping does not name
 *   value   [amplifiers] out  allocated numbers, also where the function fails; NULL without memory
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int read_amplifier_numbers(reader *reader, int node, double absent, double **value);
extern const form amplifier_numbers_form;

/*
 * Functions that read limits of several voltages together (scene_rows.c): of a difference of two
 * voltages, of a weighted sum, and of a sum of absolute values. The objects of type `form` describe
 * the keys of each limit for the JSON schema and the help.
 */
field_read read_difference, read_sum, read_absolute_sum;
extern const form difference_form, sum_form, absolute_sum_form;

/*
 * Refuse a scene file that limits sums or differences of voltages and also asks for a function of
 * the control loop that disregards such limits. An example is the self-test, which moves amplifiers
 * one by one. Returns 0, or -1 with error filled.
 */
int scene_check_rows(const scene *scene, char *error);

/* Write the error message for a name that is neither an amplifier nor an actuator. Returns -1. */
int refuse_amplifier(reader *reader, scene_at at, const char *name);

/* Reader of the section for the closed-loop simulation (scene_simulate.c). */
field_read read_simulate;

/*
 * Functions that read sets of nodes, faces of the shell and directions (scene_place.c). A set of
 * nodes is stored in the scene_where (description of a place on the mesh) to which the argument
 * `to` points.
 */
field_read read_edge, read_point, read_at, read_face;
int require_place(reader *reader, int node, const scene_where *where);
extern const form direction_form, stacks_form;
extern const form edge_form, node_form, at_form, face_form, place_form, mesh_file_form,
    mesh_disc_form, mesh_panel_form;
extern const choice place_axes[], place_faces[], place_pers[];
extern const int place_components[];

/*
 * Macros that expand to rows of a table of keys (array of `field`, scene_fields.h).
 *   DIRECTIONS        keys u1, u2, u3 (local axes), x, y, z (in space); the argument `rule` of the
 *       function `read` tells the direction
 *   PLACE             keys for a place on the mesh (set, edge, at); `offset` is the position
 *       (bytes) of the scene_where in the C struct that the table fills
 *   PLACE_ON_SURFACE  the keys of PLACE without `set`, the name of a set of a mesh file
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
        PLACE_ON_SURFACE(offset)
#define PLACE_ON_SURFACE(offset)                                                                   \
    {"edge", read_edge,  offset,     NULL,                                                         \
     0,      OF_NOTHING, &edge_form, "All nodes of an edge of the mesh."},                         \
    {                                                                                              \
        "at", read_at, offset, NULL, 0, OF_COORDINATE, &at_form,                                   \
            "A node {theta1, theta2}, the nodes of a rectangle {theta1: [from, to], ...}, or "     \
            "nodes for all; mesh from a file: the node nearest to {x, y, z}, or {set: name}."      \
    }

/* Descriptions of the values (struct form) that the sections of a scene file accept. */
extern const form element_form, surface_form, mesh_form, materials_form, layers_form,
    reference_form, patches_form, actuators_form, sensors_form, control_form, safety_form,
    hysteresis_form, limits_form, supports_form, springs_form, masses_form, loads_form,
    contact_form, outputs_form, target_form, compare_form, estimate_form, dynamics_form,
    simulate_form, equilibrium_form, influence_form, measured_target_form;

/* Default element formulation, for a scene that does not choose one. */
extern const scene_element element_improved;

/* Check that every name of a scene is used only once. Returns 0, or -1 with error filled. */
int scene_check_names(const scene *scene, char *error);

/*
 * Check the rules that concern several sections of a scene, and move points and patch edges exactly
 * onto mesh lines (scene_check.c). Returns 0, or -1 with error filled.
 */
int scene_check(scene *scene, char *error);

/* Return 1 if the material of some layer has a thermal expansion other than 0, else 0. */
int scene_expands(const scene *scene);

#endif
