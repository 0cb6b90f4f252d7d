/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions on a whole scene (scene.h): release of memory, names of amplifiers and sensor
 * electrodes, and errors that are found after the scene file has been read.
 */
#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "yaml_tree.h"

static void free_simulate(scene_simulate *simulate)
{
    int i;
    for (i = 0; i < simulate->events; i++) {
        free(simulate->event[i].amplifier);
        expr_free(simulate->event[i].value);
    }
    free(simulate->event);
    free(simulate->stiffness);
    free(simulate->d);
    free(simulate->imperfections.reversed);
    free(simulate->imperfections.swapped);
    free(simulate->gain);
}

static void free_quads(scene *scene)
{
    int i;
    for (i = 0; i < scene->layers; i++)
        free(scene->layer[i].present);
    for (i = 0; i < scene->patch_grids; i++) {
        free(scene->patches[i].patch);
        outlines_free(scene->patches[i].outlines);
    }
    for (i = 0; i < 3; i++)
        expr_free(scene->ply_direction.formula[i]);
    if (!scene->quads)
        return;
    quad_mesh_free(&scene->quads->mesh);
    free(scene->quads->file);
    free(scene->quads);
}

static void free_actuators(scene *scene)
{
    for (int i = 0; i < scene->actuators; i++) {
        free(scene->actuator[i].drive);
        free(scene->actuator[i].each);
        if (scene->actuator[i].stacks)
            free(scene->actuator[i].stacks->point);
        free(scene->actuator[i].stacks);
    }
    for (int i = 0; i < scene->sensors; i++)
        free(scene->sensor[i].drive);
    free(scene->actuator);
    free(scene->sensor);
}

static void free_mechanics(scene *scene)
{
    for (int i = 0; i < scene->springs; i++)
        free(scene->spring[i].point);
    for (int i = 0; i < scene->masses; i++)
        free(scene->mass[i].point);
    for (int i = 0; i < scene->supports; i++) {
        expr_free(scene->support[i].value);
        for (int axis = 0; axis < 3; axis++)
            expr_free(scene->support[i].formula[axis]);
    }
    for (int i = 0; i < scene->loads; i++) {
        expr_free(scene->load[i].value);
        expr_free(scene->load[i].outer);
    }
    expr_free(scene->contact.body.value);
    free(scene->spring);
    free(scene->mass);
    free(scene->support);
    free(scene->load);
}

static void free_target(scene_target *target)
{
    expr_free(target->value);
    for (int i = 0; i < target->modes; i++)
        expr_free(target->mode[i].value);
    for (int i = 0; i < target->frees; i++)
        expr_free(target->free[i].value);
    free(target->mode);
    free(target->free);
}

static void free_modal_gains(scene_modal_gains *gains)
{
    for (int i = 0; i < gains->functions; i++)
        expr_free(gains->function[i].value);
    free(gains->function);
    free(gains->gain);
    free(gains->leak);
}

static void free_geometry(scene *scene)
{
    spline_free(scene->surface.meridian);
    bicubic_free(&scene->surface.points);
    for (int i = 0; i < 3; i++)
        expr_free(scene->surface.formula[i]);
    free(scene->line[0].point);
    free(scene->line[1].point);
}

static void free_origin(scene_origin *origin)
{
    if (!origin)
        return;
    for (int i = 0; i < origin->sets; i++)
        free(origin->set[i]);
    free(origin->set);
    free(origin->path);
    free(origin);
}

void scene_free(scene *scene)
{
    free_quads(scene);
    free_actuators(scene);
    free_mechanics(scene);
    free_target(&scene->target);
    free_modal_gains(&scene->control.modal_gains);
    free_geometry(scene);
    free_simulate(&scene->simulate);
    free_origin(scene->origin);
    for (int i = 0; i < scene->compares; i++)
        free(scene->compare[i].value);
    free(scene->about);
    free(scene->material);
    free(scene->layer);
    free(scene->patches);
    free(scene->output);
    free(scene->limits.each);
    for (int i = 0; i < scene->limits.rows; i++) {
        free(scene->limits.row[i].amplifier);
        free(scene->limits.row[i].factor);
    }
    free(scene->limits.row);
    free(scene->dynamics.damping_of_mode);
    free(scene->safety.park);
    free(scene->compare);
    free(scene->estimate.reading);
    for (int i = 0; i < scene->influence.modes && scene->influence.mode; i++) {
        free(scene->influence.mode[i].shape);
        free(scene->influence.mode[i].response);
    }
    free(scene->influence.mode);
    free(scene->influence.row);
    free(scene->influence.matrix);
    free(scene->influence.place);
    free(scene->influence.output_name);
    free(scene->influence.amplifier_of);
    free(scene->influence.tied_name);
    free(scene->influence.curve.voltage);
    free(scene->influence.curve.effect);
    free(scene->influence.curve.bend);
    free(scene->influence.curve.unit);
    memset(scene, 0, sizeof *scene);
}

/*
 * Allocate a copy of an array with room for one more item at its end. Returns NULL where memory
 * runs out.
 */
static void *copy_items(const void *items, size_t count, size_t size)
{
    void *copy = calloc(count + 1, size);
    return copy && count > 0 ? memcpy(copy, items, count * size) : copy;
}

/*
 * Copy the measured vibration modes of a scene for a copy of the scene, which may change their
 * static responses. The shapes of the modes are shared with the original. Returns whether memory
 * sufficed.
 */
static bool copy_modes(scene *copy, const scene *original)
{
    const size_t modes = (size_t)original->influence.modes;
    bool has_memory = true;
    copy->influence.mode =
        copy_items(original->influence.mode, modes, sizeof *copy->influence.mode);
    for (size_t i = 0; i < modes && copy->influence.mode; i++) {
        double **response = &copy->influence.mode[i].response;
        *response =
            *response ? copy_items(*response, (size_t)original->amplifiers, sizeof(double)) : NULL;
        has_memory = has_memory && (*response || !original->influence.mode[i].response);
    }
    return has_memory && copy->influence.mode;
}

int scene_vary(scene *copy, const scene *original)
{
    const size_t entries = (size_t)original->influence.outputs * (size_t)original->amplifiers;
    *copy = *original;
    copy->material =
        copy_items(original->material, (size_t)original->materials, sizeof *copy->material);
    copy->load = copy_items(original->load, (size_t)original->loads, sizeof *copy->load);
    copy->influence.matrix = copy_items(original->influence.matrix, entries, sizeof(double));
    const bool has_modes = copy_modes(copy, original);
    if (copy->material && copy->load && copy->influence.matrix && has_modes)
        return 0;
    scene_vary_free(copy);
    return -1;
}

void scene_vary_free(scene *copy)
{
    free(copy->material);
    free(copy->load);
    free(copy->influence.matrix);
    for (int i = 0; i < copy->influence.modes && copy->influence.mode; i++)
        free(copy->influence.mode[i].response);
    free(copy->influence.mode);
    memset(copy, 0, sizeof *copy);
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

/*
 * Return the number of an amplifier within its actuator from the ending "_i_j" of its name, or -1
 * if the ending names no position in the grid.
 */
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
        size_t length = strlen(actuator->name);
        if (strncmp(actuator->name, name, length) != 0)
            continue;
        *first = name[length] ? from_suffix(actuator, name + length) : actuator->first;
        *count = name[length] ? 1 : actuator->grid[0] * actuator->grid[1];
        if (*first >= 0)
            return 1;
    }
    return 0;
}

int scene_find_amplifier(const scene *scene, const char *name, int *first, int *count)
{
    return find(scene->actuator, scene->actuators, name, first, count);
}

bool scene_has_electrodes(const scene_actuator *actuator)
{
    return actuator->drives > 0 && !actuator->is_temperature;
}

bool scene_heats_all(const scene_actuator *actuator)
{
    return actuator->drives == 0 && actuator->is_temperature;
}

bool scene_is_heater(const scene_actuator *actuator, int actuators, int amplifier)
{
    for (int i = 0; i < actuators; i++)
        if (actuator[i].is_temperature && amplifier >= actuator[i].first &&
            amplifier < actuator[i].first + actuator[i].grid[0] * actuator[i].grid[1])
            return true;
    return false;
}

int scene_find_sensor(const scene *scene, const char *name, int *first, int *count)
{
    return find(scene->sensor, scene->sensors, name, first, count);
}

int scene_fault(scene_at at, char *error, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    if (at.origin)
        tree_message(error, at.origin->path, (const char *const *)(const void *)at.origin->set, at,
                     format, list);
    else
        vsnprintf(error, SCENE_ERROR, format, list);
    va_end(list);
    return -1;
}
