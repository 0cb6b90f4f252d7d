/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of a scene (scene_read of scene.h): the table of the sections and their default values.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "scene_parts.h"

static int read_units(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"length", read_name, offsetof(scene, unit_length), NULL, 0},
        {"force", read_name, offsetof(scene, unit_force), NULL, 0},
        {"voltage", read_name, offsetof(scene, unit_voltage), NULL, 0},
        {"temperature", read_name, offsetof(scene, unit_temperature), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    return read_map(reader, node, fields, to);
}

static int read_dof_per_node(reader *reader, int node, void *to, const void *rule)
{
    static const choice counts[] = {{"7", 7}, {"6", 6}, {NULL, 0}};
    scene_element *element = &((scene *)to)->element;
    (void)rule;
    if (read_choice(reader, node, &element->dof_per_node, counts) != 0)
        return -1;
    if (element->dof_per_node == 7 || element->lin33)
        return 0;
    return tree_fault(reader->t, node,
                      "'dof_per_node: 6' needs lin33; use element: improved, or dof_per_node: 7");
}

static const choice kinematics[] = {{"linear", KINEMATICS_LINEAR},
                                    {"nonlinear", KINEMATICS_NONLINEAR},
                                    {"auto", KINEMATICS_AUTO},
                                    {NULL, 0}};

static int read_kinematics(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int kind = 0;
    if (read_choice(reader, node, &kind, rule) != 0)
        return -1;
    scene->kinematics = (scene_kinematics)kind;
    return 0;
}

static const range relative = {0, 1, 1,
                               "must lie between 0 and 1, ends left out; it is a relative error"};

static const field sections[] = {{"name", read_name, offsetof(scene, name), NULL, 1},
                                 {"about", read_text, offsetof(scene, about), NULL, 0},
                                 {"units", read_units, 0, NULL, 0},
                                 {"element", read_element, 0, NULL, 0},
                                 {"dof_per_node", read_dof_per_node, 0, NULL, 0},
                                 {"kinematics", read_kinematics, 0, kinematics, 0},
                                 {"tolerance", read_real, offsetof(scene, tolerance), &relative, 0},
                                 {"equilibrium", read_equilibrium, 0, NULL, 0},
                                 {"surface", read_surface, 0, NULL, 1},
                                 {"mesh", read_mesh, 0, NULL, 1},
                                 {"materials", read_materials, 0, NULL, 1},
                                 {"layers", read_layers, 0, NULL, 1},
                                 {"reference", read_reference, 0, NULL, 0},
                                 {"patches", read_patches, 0, NULL, 0},
                                 {"actuators", read_actuators, 0, NULL, 0},
                                 {"sensors", read_sensors, 0, NULL, 0},
                                 {"control", read_control, 0, NULL, 0},
                                 {"limits", read_limits, 0, NULL, 0},
                                 {"supports", read_supports, 0, NULL, 0},
                                 {"loads", read_loads, 0, NULL, 0},
                                 {"contact", read_contact, 0, NULL, 0},
                                 {"outputs", read_outputs, 0, NULL, 0},
                                 {"target", read_target, 0, NULL, 0},
                                 {"compare", read_compare, 0, NULL, 0},
                                 {"estimate", read_estimate, 0, NULL, 0},
                                 {"dynamics", read_dynamics, 0, NULL, 0},
                                 {"simulate", read_simulate, 0, NULL, 0},
                                 {NULL, NULL, 0, NULL, 0}};

/* Sections of a scene with a measured influence matrix. */
static const field measured_sections[] = {{"name", read_name, offsetof(scene, name), NULL, 1},
                                          {"about", read_text, offsetof(scene, about), NULL, 0},
                                          {"units", read_units, 0, NULL, 0},
                                          {"influence", read_influence, 0, NULL, 1},
                                          {"control", read_control, 0, NULL, 0},
                                          {"limits", read_limits, 0, NULL, 0},
                                          {"target", read_measured_target, 0, NULL, 0},
                                          {"compare", read_compare, 0, NULL, 0},
                                          {"simulate", read_simulate, 0, NULL, 0},
                                          {NULL, NULL, 0, NULL, 0}};

static int has_key(const field *fields, const char *key)
{
    while (fields->key && strcmp(fields->key, key) != 0)
        fields++;
    return fields->key != NULL;
}

/* Refuse sections of a structure in a scene with a measured matrix. */
static int check_sections(const tree *tree)
{
    for (int i = tree->node[tree->root].first; i; i = tree->node[i].next)
        if (has_key(sections, tree->node[i].key) && !has_key(measured_sections, tree->node[i].key))
            return tree_fault_at(tree, tree->node[i].key_at,
                                 "'%.60s' describes a structure, and 'influence' is a measured "
                                 "matrix in its place; remove one of the two",
                                 tree->node[i].key);
    return 0;
}

/* Read and check a scene with a measured influence matrix. */
static int fill_measured(reader *reader, char *error)
{
    scene *scene = reader->s;
    if (check_sections(reader->t) != 0 ||
        read_map(reader, reader->t->root, measured_sections, scene) != 0)
        return -1;
    return scene_check_names(scene, error) != 0 ? -1 : scene_check_influence(scene, error);
}

static char *duplicate(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

/* Store the path of the scene file and the applied changes for later error messages. */
static int keep_origin(scene *scene, const char *path, const char *const *set, int sets)
{
    scene->path = duplicate(path);
    scene->set = calloc((size_t)sets + 1, sizeof *scene->set);
    if (!scene->path || !scene->set)
        return -1;
    for (; scene->sets < sets; scene->sets++) {
        scene->set[scene->sets] = duplicate(set[scene->sets]);
        if (!scene->set[scene->sets])
            return -1;
    }
    return 0;
}

static void set_defaults(scene *scene)
{
    scene->element = element_improved;
    scene->tolerance = 0.01;
    scene->equilibrium.load_steps = 1;
    scene->equilibrium.tolerance = 1e-4;
    scene->equilibrium.extrapolated_iterations = 12;
    scene->equilibrium.linear_solves = 400;
    scene->reference_is_middle = 1;
    scene->dynamics.damping = 0.005;
    scene->dynamics.modes = 30;
    scene->limits.lower = -HUGE_VAL;
    scene->limits.upper = scene->limits.step_limit = HUGE_VAL;
}

static int fill(scene *scene, tree *tree, char *error)
{
    scene_at whole = {0, 0};
    reader reader;
    reader.t = tree;
    reader.s = scene;
    if (keep_origin(scene, tree->path, tree->set, tree->sets) != 0)
        return tree_fault_at(tree, whole, "out of memory");
    scene->hash = tree->hash;
    set_defaults(scene);
    if (tree->node[tree->root].kind == TREE_MAP && tree_find(tree, tree->root, "influence"))
        return fill_measured(&reader, error);
    return read_map(&reader, tree->root, sections, scene) == 0 ? scene_check(scene, error) : -1;
}

/* Fill the scene from a tree that was read with the given status, and release the tree. */
static int take_tree(scene *scene, tree *tree, int status, char *error)
{
    memset(scene, 0, sizeof *scene);
    if (status == 0)
        status = fill(scene, tree, error);
    tree_free(tree);
    if (status != 0)
        scene_free(scene);
    return status;
}

int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error)
{
    tree tree;
    const int status = tree_read(&tree, path, set, sets, error);
    return take_tree(scene, &tree, status, error);
}

int scene_read_text(scene *scene, const char *path, const char *text, size_t bytes, char *error)
{
    tree tree;
    const int status = tree_read_text(&tree, path, text, bytes, error);
    return take_tree(scene, &tree, status, error);
}
