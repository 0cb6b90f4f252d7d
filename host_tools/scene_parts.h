/* The sections of a scene, each read by one function; the whole is checked afterwards. */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H

#include "scene_fields.h"

/* scene_model.c: what there is. `to` is the scene. */
field_read read_element, read_surface, read_mesh, read_materials, read_layers, read_reference, read_patches;

/* scene_task.c: what is done to it and asked of it. `to` is the scene. */
field_read read_actuators, read_limits, read_supports, read_loads, read_outputs, read_target, read_compare;

/* What a scene has that says nothing of its element. */
extern const scene_element element_corrected;

/* scene_check.c: what no single section can know; snaps points and patches to the mesh. */
int scene_check(scene *s, char *error);

#endif
