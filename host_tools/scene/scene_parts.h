/* SPDX-License-Identifier: BSD-2-Clause */
/* The sections of a scene, each read by one function; the whole is checked afterwards. */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H

#include "scene_fields.h"

/* scene_shape.c: its geometry. `to` is the scene, of all sections. */
field_read read_surface, read_mesh;

/* scene_model.c: what it is made of. */
field_read read_element, read_materials, read_layers, read_reference, read_patches;

/* scene_load.c: what holds, loads and touches it. */
field_read read_supports, read_loads, read_contact;

/* scene_task.c: what drives it and what is asked. */
field_read read_equilibrium, read_actuators, read_sensors, read_limits, read_outputs, read_target,
    read_compare;

/* scene_estimate.c: what the firmware knows of the shape. */
field_read read_estimate;

/* scene_dynamics.c: what its vibration needs. */
field_read read_dynamics;

/* scene_simulate.c: what the controller has to live with. */
field_read read_simulate;

/* scene_place.c: places (`to` is a scene_where), faces and directions. */
field_read read_edge, read_point, read_at;
int require_place(reader *reader, int node, const scene_where *where);
extern const choice place_axes[], place_faces[];
extern const int place_components[];

/* Rows of a table for the six directions, read by one function whose rule is the component. */
#define DIRECTIONS(read)                                                                           \
    {"u1", read, 0, &place_components[0], 0}, {"u2", read, 0, &place_components[1], 0},            \
        {"u3", read, 0, &place_components[2], 0}, {"x", read, 0, &place_components[3], 0},         \
        {"y", read, 0, &place_components[4], 0},                                                   \
    {                                                                                              \
        "z", read, 0, &place_components[5], 0                                                      \
    }

/* What a scene has that says nothing of its element. */
extern const scene_element element_improved;

/* scene_check.c: what no single section can know; snaps points and patches to the mesh. */
int scene_check(scene *scene, char *error);

/* Does the material of some layer expand with temperature? */
int scene_expands(const scene *scene);

#endif
