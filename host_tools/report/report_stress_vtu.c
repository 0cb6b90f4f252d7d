/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK file of recovered stresses for ParaView (report.h). */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "../model/stress_summary.h"
#include "../text/words.h"
#include "report.h"

/*
 * Numbers of the arrays that the VTK file contains for one layer, with values in each cell: stress
 * and strain at each height of the layer, whether the layer is present, electric field, electric
 * displacement, and, if the scene states strengths, the reserve factor.
 */
enum { STRAIN = STRESS_HEIGHTS, PRESENT = 2 * STRESS_HEIGHTS, FIELD, FLUX, RESERVE, LAYER_ARRAYS };

/* Size of the text of a unit in parentheses, including its NUL (characters). */
enum { UNIT_TEXT = 2 * WORDS_UNIT };

/* Contents of a VTK file of stresses that is being made. */
typedef struct stress_file {
    const stress_field *field;
    stress_points points;
    report_array *array; /* arrays that will be written into the VTK file */
    int arrays;
    bool is_full; /* true after an allocation of memory has failed */
} stress_file;

/*
 * Begin an array of zeros for the VTK file. Its name is made as by printf, from a format and
 * values. Returns the array.
 */
static report_array *add_array(stress_file *out, bool of_cells, int components, const char *format,
                               ...)
{
    const int rows = of_cells ? out->field->elements : out->points.count;
    report_array *array = &out->array[out->arrays++];
    va_list values;
    va_start(values, format);
    vsnprintf(array->name, sizeof array->name, format, values);
    va_end(values);
    array->components = components;
    array->of_cells = of_cells;
    array->value = calloc((size_t)(rows * components), sizeof *array->value);
    out->is_full |= !array->value;
    return array;
}

/*
 * Store the values of an element (stresses, strains, electric field, reserve factor) in the arrays
 * of a layer.
 *   array [LAYER_ARRAYS] in/out  arrays of the layer, in the order of the enumeration that ends
 *                                with LAYER_ARRAYS
 */
static void fill_element(const report_array *array, const scene_strength *strength, int element,
                         const stress_layer *result)
{
    double reserve = 1e9;
    for (int height = 0; height < STRESS_HEIGHTS; height++) {
        const stress_point *at = &result->at[height];
        const int first = STRESS_COMPONENTS * element;
        memcpy(array[height].value + first, at->stress, sizeof at->stress);
        memcpy(array[STRAIN + height].value + first, at->strain, sizeof at->strain);
        reserve = fmin(reserve, stress_reserve(strength, at->stress));
    }
    array[PRESENT].value[element] = 1;
    array[FIELD].value[element] = result->field;
    array[FLUX].value[element] = result->displacement;
    if (strength->given)
        array[RESERVE].value[element] = reserve;
}

/* Write the unit of a quantity in parentheses; an empty text if the scene file names none. */
static const char *unit_text(const stress_file *out, words_quantity quantity, char text[UNIT_TEXT])
{
    const scene_unit_names *units = &out->field->state.design->units;
    char unit[WORDS_UNIT];
    text[0] = '\0';
    if (*words_unit(units, quantity, unit) && quantity == QUANTITY_CHARGE)
        snprintf(text, UNIT_TEXT, " (%s/%.60s2)", unit, units->length);
    else if (*unit)
        snprintf(text, UNIT_TEXT, " (%s)", unit);
    return text;
}

/*
 * Begin the arrays that the VTK file contains for a layer, with values in the cells. Returns the
 * first array.
 */
static report_array *name_arrays(stress_file *out, int layer, bool has_strength)
{
    const char *given = out->field->state.design->layer[layer].name;
    report_array *first = &out->array[out->arrays];
    char name[SCENE_NAME], unit[UNIT_TEXT];
    snprintf(name, sizeof name, " %.60s", given);
    if (!*given)
        snprintf(name, sizeof name, " layer %d", layer + 1);
    unit_text(out, QUANTITY_PRESSURE, unit);
    for (int height = 0; height < STRESS_HEIGHTS; height++)
        add_array(out, true, STRESS_COMPONENTS, "stress%s %s%s", name, stress_height_name[height],
                  unit);
    for (int height = 0; height < STRESS_HEIGHTS; height++)
        add_array(out, true, STRESS_COMPONENTS, "strain%s %s", name, stress_height_name[height]);
    add_array(out, true, 1, "present%s", name);
    add_array(out, true, 1, "electric field%s%s", name, unit_text(out, QUANTITY_FIELD, unit));
    add_array(out, true, 1, "electric displacement%s%s", name,
              unit_text(out, QUANTITY_CHARGE, unit));
    if (has_strength)
        add_array(out, true, 1, "reserve factor%s", name);
    return first;
}

/*
 * Add all values of a layer to the VTK file: stresses and strains in the cells, and their averages
 * at the points.
 */
static void add_layer(stress_file *out, int layer)
{
    const stress_field *field = out->field;
    const design *design = field->state.design;
    const scene_strength *strength = &design->material[design->layer[layer].material].strength;
    const report_array *own = name_arrays(out, layer, strength->given);
    for (int element = 0; !out->is_full && element < field->elements; element++) {
        stress_layer result;
        if (!stress_is_present(field, element, layer))
            continue;
        stress_layer_of(field, element, layer, &result);
        fill_element(own, strength, element, &result);
    }
    for (int k = 0; k < PRESENT; k++) {
        const report_array *mean = add_array(out, false, STRESS_COMPONENTS, "%s", own[k].name);
        if (!out->is_full)
            stress_points_average(&out->points, field, own[k].value, STRESS_COMPONENTS,
                                  mean->value);
    }
}

/*
 * Add the displacement of the middle surface and the stress resultants to the VTK file.
 *   vector [nodes][3] in  displacement along x, y and z
 */
static void add_structure(stress_file *out, const double *vector)
{
    const scene_unit_names *units = &out->field->state.design->units;
    const char *length = units->length, *force = units->force;
    char unit[SCENE_ERROR] = "";
    if (*length && *force)
        snprintf(unit, sizeof unit, " (%.30s/%.30s, %.30s, %.30s/%.30s)", force, length, force,
                 force, length);
    const report_array *shape = add_array(out, false, 3, "displacement");
    const report_array *resultants = add_array(
        out, true, STRESS_RESULTANTS, "resultants N11 N22 N12 M11 M22 M12 Q13 Q23%s", unit);
    for (int k = 0; !out->is_full && k < 3 * out->points.count; k++)
        shape->value[k] = vector[3 * out->points.node[k / 3] + k % 3];
    for (int element = 0; !out->is_full && element < out->field->elements; element++)
        stress_resultants(out->field, element, resultants->value + element * STRESS_RESULTANTS);
}

/* Add the potentials of the bare faces (without electrodes) to the VTK file. */
static void add_potentials(stress_file *out)
{
    const design *design = out->field->state.design;
    report_array *own = calloc((size_t)(2 * out->field->layers), sizeof *own);
    const int count = own ? report_potentials(design, out->field->state.input_value, own) : -1;
    out->is_full |= count < 0;
    for (int k = 0; k < count; k++) {
        const report_array *array = add_array(out, false, 1, "%s", own[k].name);
        for (int i = 0; !out->is_full && i < out->points.count; i++)
            array->value[i] = own[k].value[out->points.node[i]];
        free(own[k].value);
    }
    free(own);
}

int report_stress_vtu(FILE *file, const stress_field *field, const double *vector)
{
    stress_file out = {.field = field};
    int status = -1;
    out.array = calloc((size_t)(2 + 2 * (LAYER_ARRAYS + 1) * field->layers), sizeof *out.array);
    if (out.array && stress_points_make(&out.points, field) == 0) {
        add_structure(&out, vector);
        add_potentials(&out);
        for (int layer = 0; layer < field->layers; layer++)
            add_layer(&out, layer);
        if (!out.is_full)
            status =
                report_vtu(file, &field->state.design->mesh, &out.points, out.array, out.arrays);
    }
    for (int k = 0; k < out.arrays; k++)
        free(out.array[k].value);
    free(out.array);
    stress_points_free(&out.points);
    return status;
}
