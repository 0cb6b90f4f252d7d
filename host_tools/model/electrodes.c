/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes of a scene's amplifiers and sensors as the library's table (electrodes.h). */
#include "electrodes.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/electrode.h"
#include "../scene/outline_common.h"
#include "bare_charges.h"
#include "load_forces.h"

/*
 * Voltage that one input applies across one ply of an element: the value of the input times
 * `factor`, on the fraction `share` of the area of the element.
 */
typedef struct across {
    int input, ply;
    double factor;
    double share; /* part of the element's area that the electrode covers, from 0 to 1 */
    bool is_heat; /* true: the input is a temperature of the ply instead of a voltage */
    const scene_patches *patches;
    int patch;
} across;

/* List of the voltages that all inputs apply across the plies of one element. */
typedef struct across_list {
    across *entry;
    design_part *part; /* patches of one actuator or sensor that cover a part of the present
                          element; overwritten for each actuator or sensor */
    int count, room;
    bool is_full; /* whether an allocation of memory for this list of voltages across plies has
                     failed */
} across_list;

/* Enlarge a list of voltages across plies so that `more` further entries fit. */
static void make_room(across_list *list, int more)
{
    bool is_full = false;
    if (list->count + more <= list->room)
        return;
    list->room = 2 * (list->count + more);
    list->entry = design_grow(list->entry, (size_t)list->room, sizeof *list->entry, &is_full);
    list->part = design_grow(list->part, (size_t)list->room, sizeof *list->part, &is_full);
    list->is_full = list->is_full || is_full;
}

/*
 * Append the voltages that one actuator or sensor applies in an element to a list. An entry names a
 * ply, an input (voltage of an amplifier or open electrode), and the voltage across the ply per
 * volt of the input. A ply may appear several times.
 *   first in  index of the first input of the actuator or sensor
 */
static void append_across(const mesh *mesh, const scene_actuator *actuator, int first, int element,
                          across_list *list)
{
    for (int k = 0; k < actuator->drives; k++) {
        const scene_patches *patches = &mesh->scene->patches[actuator->drive[k].patches];
        const int count = design_patches_in(mesh, element, patches, NULL);
        make_room(list, count);
        if (list->is_full)
            return;
        design_patches_in(mesh, element, patches, list->part);
        for (int i = 0; i < count; i++)
            list->entry[list->count++] = (across){first + list->part[i].patch, patches->layer,
                                                  actuator->drive[k].factor,   list->part[i].share,
                                                  actuator->is_temperature,    patches,
                                                  list->part[i].patch};
    }
}

/* List the voltages of all actuators and sensors across the plies of one element. */
static void all_across(const design *design, int element, across_list *list)
{
    const scene *scene = design->scene;
    list->count = 0;
    for (int k = 0; k < scene->actuators; k++)
        append_across(&design->mesh, &scene->actuator[k], scene->actuator[k].first, element, list);
    for (int k = 0; k < scene->sensors; k++)
        append_across(&design->mesh, &scene->sensor[k],
                      design->sensor_first + scene->sensor[k].first, element, list);
}

/*
 * Return the fraction (0 to 1) of an element's area that is covered by both of two electrodes. It
 * is 0 for different electrodes on the same layer, because these do not overlap.
 */
static double common_share(const design *design, int element, const across *one,
                           const across *other)
{
    if (one->patches == other->patches && one->patch == other->patch)
        return one->share;
    if (one->ply == other->ply)
        return 0;
    if (!one->patches->outlines || !other->patches->outlines)
        return one->share * other->share;
    return outline_common_share(design->scene, one->patches, one->patch, other->patches,
                                other->patch, element);
}

/*
 * Add the charges that a unit of every input (1 V or 1 K) causes on all electrodes of one element
 * at zero strain.
 *   dense [electrodes][inputs] in/out  charge of each electrode per unit of each input
 */
static void add_element(const design *design, int element, across_list *list, double *dense)
{
    const mesh *mesh = &design->mesh;
    const scene *scene = design->scene;
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    all_across(design, element, list);
    for (int i = 0; i < list->count; i++) {
        const across *own = &list->entry[i];
        if (own->is_heat) {
            bare_charges_add_heater(design, element, own->ply, own->share * own->factor, own->input,
                                    dense);
            continue;
        }
        double *row =
            dense + (size_t)electrodes_of(design, own->input) * design->structure.input.count;
        for (int j = 0; j < list->count; j++) {
            const across *other = &list->entry[j];
            const laminate_field unit = {
                .ply = other->ply, .axis = other->is_heat ? LAMINATE_HEATED_PLY : LAMINATE_ACROSS};
            const double share = common_share(design, element, own, other);
            if (share > 0)
                row[other->input] +=
                    share * own->factor * other->factor *
                    laminate_charge(&mesh->laminate, &scene->element, place, own->ply, &unit);
        }
        bare_charges_add_electrode(design, element, own->ply, own->share * own->factor,
                                   electrodes_of(design, own->input), dense);
        for (int k = 0; k < scene->actuators; k++) {
            const laminate_field kelvin = {.ply = -1, .temperature = {1, 1}};
            if (scene_heats_all(&scene->actuator[k]))
                row[scene->actuator[k].first] +=
                    own->share * own->factor *
                    laminate_charge(&mesh->laminate, &scene->element, place, own->ply, &kelvin);
        }
        for (int k = 0; k < scene->loads; k++)
            if (scene->load[k].type == LOAD_TEMPERATURE) {
                const laminate_field kelvin = load_temperatures(&scene->load[k]);
                row[design->amplifiers + k] +=
                    own->share * own->factor *
                    laminate_charge(&mesh->laminate, &scene->element, place, own->ply, &kelvin);
            }
    }
}

/*
 * List the inputs that are voltages and return their number: amplifiers, except those of
 * temperatures and stack actuators; electrodes of sensors; potentials of bare faces. Potentials
 * count as open electrodes, because no charge comes to a face without electrode.
 */
static uint16_t list_inputs(const design *design, uint16_t *input, uint8_t *open)
{
    const scene *scene = design->scene;
    uint16_t count = 0;
    for (int k = 0; k < scene->actuators; k++)
        for (int cell = 0; cell < scene->actuator[k].grid[0] * scene->actuator[k].grid[1] &&
                           scene_has_electrodes(&scene->actuator[k]);
             cell++)
            input[count++] = (uint16_t)(scene->actuator[k].first + cell);
    for (int k = 0; k < scene->sensors; k++)
        for (int cell = 0; cell < scene->sensor[k].grid[0] * scene->sensor[k].grid[1]; cell++) {
            open[count] = (uint8_t)scene->sensor[k].open;
            input[count++] = (uint16_t)(design->sensor_first + scene->sensor[k].first + cell);
        }
    for (int k = 0; k < design->bare.count; k++) {
        open[count] = 1;
        input[count++] = (uint16_t)(design->bare.first_input + k);
    }
    return count;
}

static void sparse(const double *dense, size_t rows, size_t columns, uint32_t *start, uint16_t *dof,
                   double *value)
{
    uint32_t entries = 0;
    for (size_t k = 0; k < rows; k++) {
        for (size_t j = 0; j < columns; j++)
            if (dense[k * columns + j] != 0) {
                dof[entries] = (uint16_t)j;
                value[entries++] = dense[k * columns + j];
            }
        start[k + 1] = entries;
    }
}

static int is_wanted(const design *design)
{
    const scene *scene = design->scene;
    int wanted = scene->sensors > 0 || design->bare.count > 0;
    for (int k = 0; k < scene->outputs; k++)
        wanted |= scene_output_info_of(scene->output[k].type)->spread == SPREAD_ELECTRODES;
    return wanted;
}

/*
 * Fill design->electrodes with all electrodes and bare faces of the scene if they are wanted, else
 * with none. Returns 0, or -1 with error filled.
 */
static int build(design *design, bool wanted, char *error)
{
    const size_t inputs = design->structure.input.count;
    pzs_electrodes *tables = &design->electrodes;
    uint16_t *input = calloc(inputs + 1, sizeof *input), *dof = NULL;
    uint8_t *open = calloc(inputs + 1, sizeof *open);
    uint32_t *start = calloc(inputs + 1, sizeof *start);
    across_list list = {NULL, NULL, 0, 0, false};
    double *dense = NULL, *value = NULL;
    const int ready = input && open && start;
    tables->input = input;
    tables->open = open;
    tables->count = wanted && ready ? list_inputs(design, input, open) : 0;
    dense = calloc(tables->count * inputs + 1, sizeof *dense);
    dof = calloc(tables->count * inputs + 1, sizeof *dof);
    value = calloc(tables->count * inputs + 1, sizeof *value);
    if (ready && dense && dof && value) {
        for (int element = 0; element < design->mesh.elements && tables->count > 0; element++) {
            add_element(design, element, &list, dense);
            bare_charges_add(design, element, dense);
        }
        sparse(dense, tables->count, inputs, start, dof, value);
    }
    const pzs_rows direct = {tables->count, start, dof, value};
    tables->direct = direct;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = design->scene->hash;
    free(list.entry);
    free(list.part);
    free(dense);
    if (!ready || !dense || !dof || !value || list.is_full)
        return scene_fault(design->scene->at_surface, error, "electrodes do not fit into memory");
    tables->crc = pzs_electrode_crc(tables, (uint32_t)inputs);
    return 0;
}

int electrodes_build(design *design, char *error)
{
    return build(design, is_wanted(design), error);
}

int electrodes_build_all(const design *given, pzs_electrodes *tables, char *error)
{
    design copy = *given;
    memset(&copy.electrodes, 0, sizeof copy.electrodes);
    const int failed = build(&copy, true, error);
    *tables = copy.electrodes;
    return failed;
}

void electrodes_free(pzs_electrodes *tables)
{
    design_release(tables->input);
    design_release(tables->open);
    design_release(tables->direct.start);
    design_release(tables->direct.dof);
    design_release(tables->direct.value);
    memset(tables, 0, sizeof *tables);
}

bool electrodes_is_bare(const design *design, int input)
{
    return design->bare.count > 0 && input >= design->bare.first_input;
}

const char *electrodes_name(const design *design, int input)
{
    if (electrodes_is_bare(design, input))
        return "of a bare face";
    return input < design->amplifiers ? design->amplifier_name[input]
                                      : design->electrode_name[input - design->sensor_first];
}

int electrodes_of(const design *design, int input)
{
    for (int k = 0; k < design->electrodes.count; k++)
        if (design->electrodes.input[k] == input)
            return k;
    return -1;
}

int electrodes_input(const design *design, const scene_output *output, int i)
{
    return (output->of_sensor ? design->sensor_first : 0) + output->first + i;
}
