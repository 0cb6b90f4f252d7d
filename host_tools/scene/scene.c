/* Scenes (scene.h): the table of sections, reading and release. */
#include "scene.h"

#include <math.h>
#include <stdio.h>
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

static int read_unknowns(reader *reader, int node, void *to, const void *rule)
{
    static const choice counts[] = {{"7", 7}, {"6", 6}, {NULL, 0}};
    scene_element *element = &((scene *)to)->element;
    (void)rule;
    if (read_choice(reader, node, &element->unknowns, counts) != 0)
        return -1;
    if (element->unknowns == 7 || element->lin33)
        return 0;
    return tree_fault(reader->t, node,
                      "'unknowns: 6' needs lin33; use element: improved, or unknowns: 7");
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
                                 {"unknowns", read_unknowns, 0, NULL, 0},
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

static char *duplicate(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

/* What later messages need. */
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
    scene->equilibrium.steps = 1;
    scene->equilibrium.change = 1e-4;
    scene->equilibrium.mixed = 12;
    scene->equilibrium.systems = 400;
    scene->reference_is_middle = 1;
    scene->dynamics.damping = 0.005;
    scene->dynamics.modes = 30;
    scene->limits.lower = -HUGE_VAL;
    scene->limits.upper = scene->limits.slew = HUGE_VAL;
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
    return read_map(&reader, tree->root, sections, scene) == 0 ? scene_check(scene, error) : -1;
}

int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error)
{
    tree tree;
    int status;
    memset(scene, 0, sizeof *scene);
    status = tree_read(&tree, path, set, sets, error);
    if (status == 0)
        status = fill(scene, &tree, error);
    tree_free(&tree);
    if (status != 0)
        scene_free(scene);
    return status;
}

void scene_free(scene *scene)
{
    int i;
    for (i = 0; i < scene->sets; i++)
        free(scene->set[i]);
    for (i = 0; i < scene->actuators; i++)
        free(scene->actuator[i].drive);
    for (i = 0; i < scene->sensors; i++)
        free(scene->sensor[i].drive);
    for (i = 0; i < scene->supports; i++)
        expr_free(scene->support[i].value);
    for (i = 0; i < scene->loads; i++)
        expr_free(scene->load[i].value);
    for (i = 0; i < scene->loads; i++)
        expr_free(scene->load[i].outer);
    for (i = 0; i < scene->compares; i++)
        free(scene->compare[i].value);
    expr_free(scene->contact.body.value);
    expr_free(scene->target.value);
    for (i = 0; i < scene->target.modes; i++)
        expr_free(scene->target.mode[i].value);
    for (i = 0; i < scene->target.frees; i++)
        expr_free(scene->target.free[i].value);
    free(scene->target.mode);
    free(scene->target.free);
    spline_free(scene->surface.meridian);
    free(scene->path);
    free(scene->set);
    free(scene->about);
    free(scene->line[0].point);
    free(scene->line[1].point);
    free(scene->material);
    free(scene->layer);
    free(scene->patches);
    free(scene->actuator);
    free(scene->sensor);
    free(scene->support);
    free(scene->load);
    free(scene->output);
    free(scene->limits.each);
    free(scene->compare);
    free(scene->estimate.reading);
    free_simulate(&scene->simulate);
    memset(scene, 0, sizeof *scene);
}

static void name_of(const scene_actuator *actuator, int k, char name[SCENE_LABEL])
{
    while (k >= actuator->first + actuator->grid[0] * actuator->grid[1])
        actuator++;
    k -= actuator->first;
    if (actuator->grid[0] * actuator->grid[1] == 1)
        strcpy(name, actuator->name);
    else
        snprintf(name, SCENE_LABEL, "%s_%d_%d", actuator->name, k / actuator->grid[1] + 1,
                 k % actuator->grid[1] + 1);
}

void scene_amplifier_name(const scene *scene, int k, char name[SCENE_LABEL])
{
    name_of(scene->actuator, k, name);
}

void scene_sensor_name(const scene *scene, int k, char name[SCENE_LABEL])
{
    name_of(scene->sensor, k, name);
}

/* Amplifier of an actuator from the "_i_j" after its name, or -1. */
static int from_suffix(const scene_actuator *actuator, const char *suffix)
{
    char written[48];
    int i, j;
    if (sscanf(suffix, "_%6d_%6d", &i, &j) != 2 || i < 1 || j < 1 || i > actuator->grid[0] ||
        j > actuator->grid[1])
        return -1;
    snprintf(written, sizeof written, "_%d_%d", i, j);
    return strcmp(written, suffix) == 0 ? actuator->first + (i - 1) * actuator->grid[1] + j - 1
                                        : -1;
}

static int find(const scene_actuator *actuator, int actuators, const char *name, int *first,
                int *count)
{
    for (; actuators > 0; actuators--, actuator++) {
        size_t n = strlen(actuator->name);
        if (strncmp(actuator->name, name, n) != 0)
            continue;
        *first = name[n] ? from_suffix(actuator, name + n) : actuator->first;
        *count = name[n] ? 1 : actuator->grid[0] * actuator->grid[1];
        if (*first >= 0)
            return 1;
    }
    return 0;
}

int scene_find_amplifier(const scene *scene, const char *name, int *first, int *count)
{
    return find(scene->actuator, scene->actuators, name, first, count);
}

int scene_find_sensor(const scene *scene, const char *name, int *first, int *count)
{
    return find(scene->sensor, scene->sensors, name, first, count);
}

int scene_fault(const scene *scene, scene_at at, char *error, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(error, scene->path, (const char *const *)(const void *)scene->set, at, format,
                 list);
    va_end(list);
    return -1;
}
