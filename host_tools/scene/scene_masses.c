/* SPDX-License-Identifier: BSD-2-Clause */
/* Concentrated masses of a scene (section `masses`). */
#include <stdlib.h>
#include "scene_parts.h"
#include "scene_points.h"

/* Read the points at which masses are attached; they need not be nodes of the mesh. */
static int read_points(reader *reader, int node, void *to, const void *rule)
{
    scene_mass *mass = to;
    (void)rule;
    return scene_points_read(reader, node, &mass->point, &mass->points);
}

static const field mass_fields[] = {
    {"name", read_name, offsetof(scene_mass, name), .help = "Name of the masses."},
    PLACE(offsetof(scene_mass, where)),
    {"points", read_points, .of = OF_POINT, .form = &scene_points_form,
     .help = "Points that need not be nodes: [[theta1, theta2], ...], on a mesh from a file [[x, "
             "y, z], ...] or, seen along z, [[x, y], ...]; or a file of them."},
    {"on", read_face, offsetof(scene_mass, face), .form = &face_form,
     .help = "Face with which the masses move; middle (default) and mean: the mean of both faces."},
    {"per", read_choice, offsetof(scene_mass, per), place_pers,
     .help = "point: each node or point has this mass (default); length: of an edge; area: of the "
             "elements whose nodes are all in the place."},
    {"mass", read_real, offsetof(scene_mass, mass), &above_zero, 1, .of = OF_ADDED_MASS,
     .help = "One mass, or mass per length or area. It takes part in vibration and weight."},
    {"rotary_inertia", read_real, offsetof(scene_mass, inertia), &not_negative, .of = OF_INERTIA,
     .help = "Moment of inertia of one mass about its centre, for rotations about any axis in the "
             "surface; default 0."},
    {.key = NULL}};

static const form_case mass_cases[] = {
    {"edge|at|set|points mass ?rotary_inertia ?on ?name ?per=point", "Masses at nodes or points."},
    {"edge|at|set mass per=length/area ?on ?name", "Mass per length or area."},
    {NULL, NULL}};
static const form mass_form = {.type = FORM_MAP, .fields = mass_fields, .cases = mass_cases};
const form masses_form = {.type = FORM_LIST, .item = &mass_form};

/*
 * Check the keys of an item of masses, which is attached to nodes by one of `at`, `edge` and `set`,
 * or to points by `points`. A mass per length or area (key `per`) excludes `points` and moments of
 * inertia. Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_place(reader *reader, int node, const scene_mass *mass)
{
    if ((mass->where.at.column != 0) == (mass->points > 0))
        return tree_fault(reader->t, node,
                          "a mass needs one of at, edge, set and points; give one");
    if (mass->per != PER_POINT && (mass->points > 0 || mass->inertia > 0))
        return tree_fault(reader->t, node,
                          "'per: %s' is for a place, without points and rotary_inertia; remove it",
                          place_pers[mass->per].word);
    return 0;
}

static int read_mass(reader *reader, int node, void *item)
{
    scene_mass *mass = item;
    mass->at = node_at(reader, node);
    return read_map(reader, node, mass_fields, mass) != 0 ? -1 : check_place(reader, node, mass);
}

int read_masses(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->mass = new_items(reader, node, TREE_LIST, sizeof *scene->mass, &scene->masses);
    return read_items(reader, node, scene->mass, sizeof *scene->mass, read_mass, NULL);
}
