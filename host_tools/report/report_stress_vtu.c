/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK file of recovered stresses for ParaView (report.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../model/stress_points.h"
#include "../model/stress_summary.h"
#include "../text/words.h"
#include "report.h"

/* Contents of a VTK file of stresses that is being made. */
typedef struct stress_file {
    const stress_field *field;
    stress_points points;
    report_array *array; /* [room] arrays of values that the VTK file will contain */
    int arrays, room;
    char unit[WORDS_UNIT]; /* unit of stresses, in parentheses after a blank; an empty text if the
                              scene file names no units */
    char field_unit[WORDS_UNIT], flux_unit[WORDS_UNIT]; /* units of electric fields and of electric
                                                           displacements, in parentheses */
    char line_unit[WORDS_UNIT]; /* units of the stress resultants: of forces, moments and transverse
                                   shear forces */
    bool is_full;               /* true after an allocation of memory has failed */
} stress_file;

/*
 * Begin an array of the VTK file. Its name consists of a text, the name of a layer and the name of
 * a height. Returns the memory for the values of the array, or NULL if memory runs out.
 */
static double *add_array(stress_file *out, bool of_cells, int components, const char *text,
                         int layer, const char *height, const char *unit)
{
    const design *design = out->field->state.design;
    const size_t rows = (size_t)(of_cells ? out->field->elements : out->points.count);
    report_array *array = &out->array[out->arrays];
    char name[SCENE_NAME] = "";
    if (layer >= 0 && design->layer[layer].name[0])
        snprintf(name, sizeof name, " %.60s", design->layer[layer].name);
    else if (layer >= 0)
        snprintf(name, sizeof name, " layer %d", layer + 1);
    array->value = calloc(rows * (size_t)components, sizeof *array->value);
    out->is_full |= !array->value;
    if (!array->value)
        return NULL;
    snprintf(array->name, sizeof array->name, "%s%s%s%s%s", text, name, *height ? " " : "", height,
             unit);
    array->components = components;
    array->of_cells = of_cells;
    out->arrays++;
    return array->value;
}

/*
 * Add an array of values at the points of the VTK file, which are averages of the given values of
 * its cells. The array has the same name as the last array of cell values.
 */
static void add_average(stress_file *out, const double *of_cells)
{
    const report_array cells = out->array[out->arrays - 1];
    double *value = add_array(out, false, cells.components, cells.name, -1, "", "");
    if (value)
        stress_points_average(&out->points, out->field, of_cells, cells.components, value);
}

/*
 * Add the stresses or the strains at one height of a layer to the VTK file: as values of the cells,
 * and averaged at the points.
 */
static void add_height(stress_file *out, int layer, int height, bool is_strain)
{
    const stress_field *field = out->field;
    double *value = add_array(out, true, STRESS_COMPONENTS, is_strain ? "strain" : "stress", layer,
                              stress_height_name[height], is_strain ? "" : out->unit);
    for (int element = 0; value && element < field->elements; element++) {
        stress_layer result;
        if (!stress_is_present(field, element, layer))
            continue;
        stress_layer_of(field, element, layer, &result);
        memcpy(value + element * STRESS_COMPONENTS,
               is_strain ? result.at[height].strain : result.at[height].stress,
               STRESS_COMPONENTS * sizeof *value);
    }
    if (value)
        add_average(out, value);
}

/*
 * Add four arrays for a layer to the VTK file: presence of the layer in each cell, electric field,
 * electric displacement and smallest reserve factor.
 */
static void add_layer(stress_file *out, int layer)
{
    const stress_field *field = out->field;
    const design *design = field->state.design;
    const scene_strength *strength = &design->material[design->layer[layer].material].strength;
    double *present = add_array(out, true, 1, "present", layer, "", "");
    double *electric = add_array(out, true, 1, "electric field", layer, "", out->field_unit);
    double *displacement =
        add_array(out, true, 1, "electric displacement", layer, "", out->flux_unit);
    double *reserve =
        strength->given ? add_array(out, true, 1, "reserve factor", layer, "", "") : NULL;
    for (int element = 0; !out->is_full && element < field->elements; element++) {
        stress_layer result;
        present[element] = stress_is_present(field, element, layer);
        if (present[element] == 0)
            continue;
        stress_layer_of(field, element, layer, &result);
        electric[element] = result.field;
        displacement[element] = result.displacement;
        for (int height = 0; reserve && height < STRESS_HEIGHTS; height++) {
            const double own = fmin(1e9, stress_reserve(strength, result.at[height].stress));
            reserve[element] = height > 0 ? fmin(reserve[element], own) : own;
        }
    }
}

static void add_resultants(stress_file *out)
{
    double *value = add_array(out, true, STRESS_RESULTANTS,
                              "resultants N11 N22 N12 M11 M22 M12 Q13 Q23", -1, "", out->line_unit);
    for (int element = 0; value && element < out->field->elements; element++)
        stress_resultants(out->field, element, value + element * STRESS_RESULTANTS);
}

static void add_displacement(stress_file *out, const double *vector)
{
    double *value = add_array(out, false, 3, "displacement", -1, "", "");
    for (int k = 0; value && k < 3 * out->points.count; k++)
        value[k] = vector[3 * out->points.node[k / 3] + k % 3];
}

static void add_all(stress_file *out, const double *vector)
{
    add_displacement(out, vector);
    add_resultants(out);
    for (int layer = 0; layer < out->field->layers; layer++) {
        for (int k = 0; k < 2 * STRESS_HEIGHTS; k++)
            add_height(out, layer, k % STRESS_HEIGHTS, k >= STRESS_HEIGHTS);
        add_layer(out, layer);
    }
}

/*
 * Make the texts of the units of the arrays from the units of the scene. The texts are empty if the
 * scene file names no units.
 */
static void name_units(stress_file *out)
{
    const design *design = out->field->state.design;
    const char *length = design->units.length, *force = design->units.force;
    char unit[WORDS_UNIT], charge[WORDS_UNIT];
    if (!*length || !*force || !*design->units.voltage)
        return;
    snprintf(out->unit, sizeof out->unit, " (%.150s)",
             words_unit(&design->units, QUANTITY_PRESSURE, unit));
    snprintf(out->field_unit, sizeof out->field_unit, " (%.60s/%.60s)", design->units.voltage,
             length);
    snprintf(out->flux_unit, sizeof out->flux_unit, " (%.100s/%.60s2)",
             words_unit(&design->units, QUANTITY_CHARGE, charge), length);
    snprintf(out->line_unit, sizeof out->line_unit, " (%.30s/%.30s, %.30s, %.30s/%.30s)", force,
             length, force, force, length);
}

int report_stress_vtu(FILE *file, const stress_field *field, const double *vector)
{
    stress_file out = {.field = field, .room = 2 + 20 * field->layers};
    int status = -1;
    name_units(&out);
    out.array = calloc((size_t)out.room, sizeof *out.array);
    if (out.array && stress_points_make(&out.points, field) == 0) {
        add_all(&out, vector);
        if (!out.is_full)
            status = report_vtu_arrays(file, &field->state.design->mesh, out.points.node,
                                       out.points.count, out.points.corner, out.array, out.arrays);
    }
    for (int k = 0; k < out.arrays; k++)
        free(out.array[k].value);
    free(out.array);
    stress_points_free(&out.points);
    return status;
}
