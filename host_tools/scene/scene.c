/* Scenes (scene.h): the table of sections, reading and release. */
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scene_parts.h"

static int read_units(reader *r, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"length", read_name, offsetof(scene, unit_length), NULL, 0},
        {"force", read_name, offsetof(scene, unit_force), NULL, 0},
        {"voltage", read_name, offsetof(scene, unit_voltage), NULL, 0},
        {"temperature", read_name, offsetof(scene, unit_temperature), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    return read_map(r, node, fields, to);
}

static int read_unknowns(reader *r, int node, void *to, const void *rule)
{
    static const choice counts[] = {{"7", 7}, {"6", 6}, {NULL, 0}};
    scene_element *element = &((scene *)to)->element;
    (void)rule;
    if (read_choice(r, node, &element->unknowns, counts) != 0)
        return -1;
    if (element->unknowns == 7 || element->lin33)
        return 0;
    return tree_fault(r->t, node,
                      "'unknowns: 6' needs lin33; use element: improved, or unknowns: 7");
}

static const choice kinematics[] = {{"linear", KINEMATICS_LINEAR},
                                    {"nonlinear", KINEMATICS_NONLINEAR},
                                    {"auto", KINEMATICS_AUTO},
                                    {NULL, 0}};

static int read_kinematics(reader *r, int node, void *to, const void *rule)
{
    scene *s = to;
    int kind = 0;
    if (read_choice(r, node, &kind, rule) != 0)
        return -1;
    s->kinematics = (scene_kinematics)kind;
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
static int keep_origin(scene *s, const char *path, const char *const *set, int sets)
{
    s->path = duplicate(path);
    s->set = calloc((size_t)sets + 1, sizeof *s->set);
    if (!s->path || !s->set)
        return -1;
    for (; s->sets < sets; s->sets++) {
        s->set[s->sets] = duplicate(set[s->sets]);
        if (!s->set[s->sets])
            return -1;
    }
    return 0;
}

static void set_defaults(scene *s)
{
    s->element = element_improved;
    s->tolerance = 0.01;
    s->equilibrium.steps = 1;
    s->equilibrium.change = 1e-4;
    s->equilibrium.mixed = 12;
    s->equilibrium.systems = 400;
    s->reference_is_middle = 1;
    s->dynamics.damping = 0.005;
    s->dynamics.modes = 30;
    s->limits.lower = -HUGE_VAL;
    s->limits.upper = s->limits.slew = HUGE_VAL;
}

static int fill(scene *s, tree *t, char *error)
{
    scene_at whole = {0, 0};
    reader r;
    r.t = t;
    r.s = s;
    if (keep_origin(s, t->path, t->set, t->sets) != 0)
        return tree_fault_at(t, whole, "out of memory");
    s->hash = t->hash;
    set_defaults(s);
    return read_map(&r, t->root, sections, s) == 0 ? scene_check(s, error) : -1;
}

int scene_read(scene *s, const char *path, const char *const *set, int sets, char *error)
{
    tree t;
    int status;
    memset(s, 0, sizeof *s);
    status = tree_read(&t, path, set, sets, error);
    if (status == 0)
        status = fill(s, &t, error);
    tree_free(&t);
    if (status != 0)
        scene_free(s);
    return status;
}

void scene_free(scene *s)
{
    int i;
    for (i = 0; i < s->sets; i++)
        free(s->set[i]);
    for (i = 0; i < s->actuators; i++)
        free(s->actuator[i].drive);
    for (i = 0; i < s->sensors; i++)
        free(s->sensor[i].drive);
    for (i = 0; i < s->supports; i++)
        expr_free(s->support[i].value);
    for (i = 0; i < s->loads; i++)
        expr_free(s->load[i].value);
    for (i = 0; i < s->loads; i++)
        expr_free(s->load[i].outer);
    for (i = 0; i < s->compares; i++)
        free(s->compare[i].value);
    expr_free(s->contact.body.value);
    expr_free(s->target.value);
    for (i = 0; i < s->target.modes; i++)
        expr_free(s->target.mode[i].value);
    for (i = 0; i < s->target.frees; i++)
        expr_free(s->target.free[i].value);
    free(s->target.mode);
    free(s->target.free);
    spline_free(s->surface.meridian);
    free(s->path);
    free(s->set);
    free(s->about);
    free(s->line[0].point);
    free(s->line[1].point);
    free(s->material);
    free(s->layer);
    free(s->patches);
    free(s->actuator);
    free(s->sensor);
    free(s->support);
    free(s->load);
    free(s->output);
    free(s->limits.each);
    free(s->compare);
    free(s->estimate.reading);
    free_simulate(&s->simulate);
    memset(s, 0, sizeof *s);
}

static void name_of(const scene_actuator *a, int k, char name[SCENE_LABEL])
{
    while (k >= a->first + a->grid[0] * a->grid[1])
        a++;
    k -= a->first;
    if (a->grid[0] * a->grid[1] == 1)
        strcpy(name, a->name);
    else
        snprintf(name, SCENE_LABEL, "%s_%d_%d", a->name, k / a->grid[1] + 1, k % a->grid[1] + 1);
}

void scene_amplifier_name(const scene *s, int k, char name[SCENE_LABEL])
{
    name_of(s->actuator, k, name);
}

void scene_sensor_name(const scene *s, int k, char name[SCENE_LABEL])
{
    name_of(s->sensor, k, name);
}

/* Amplifier of an actuator from the "_i_j" after its name, or -1. */
static int from_suffix(const scene_actuator *a, const char *suffix)
{
    char written[48];
    int i, j;
    if (sscanf(suffix, "_%6d_%6d", &i, &j) != 2 || i < 1 || j < 1 || i > a->grid[0] ||
        j > a->grid[1])
        return -1;
    snprintf(written, sizeof written, "_%d_%d", i, j);
    return strcmp(written, suffix) == 0 ? a->first + (i - 1) * a->grid[1] + j - 1 : -1;
}

static int find(const scene_actuator *a, int actuators, const char *name, int *first, int *count)
{
    for (; actuators > 0; actuators--, a++) {
        size_t n = strlen(a->name);
        if (strncmp(a->name, name, n) != 0)
            continue;
        *first = name[n] ? from_suffix(a, name + n) : a->first;
        *count = name[n] ? 1 : a->grid[0] * a->grid[1];
        if (*first >= 0)
            return 1;
    }
    return 0;
}

int scene_find_amplifier(const scene *s, const char *name, int *first, int *count)
{
    return find(s->actuator, s->actuators, name, first, count);
}

int scene_find_sensor(const scene *s, const char *name, int *first, int *count)
{
    return find(s->sensor, s->sensors, name, first, count);
}

int scene_fault(const scene *s, scene_at at, char *error, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(error, s->path, (const char *const *)(const void *)s->set, at, format, list);
    va_end(list);
    return -1;
}
