/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK files of displacements, potentials, stresses and vibration modes for ParaView (vtk.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../model/stress_summary.h"
#include "../text/words.h"
#include "vtk.h"
#include "vtk_file.h"
#include "vtk_structure.h"

/*
 * Indices of the arrays that hold the values of one layer in each cell of a VTK file: stress (from
 * 0) and strain at each height of the layer, electric field and electric displacement. The last
 * one, the reserve factor, exists only if the scene states strengths.
 */
enum { STRAIN = STRESS_HEIGHTS, FIELD = 2 * STRESS_HEIGHTS, FLUX, RESERVE, LAYER_ARRAYS };

/*
 * Store the stresses, strains and electric field that one layer has in one element in the arrays of
 * the VTK file that belong to this layer.
 *   array [LAYER_ARRAYS] in/out  arrays of the layer, over all elements
 */
static void fill_element(const vtk_array *array, const scene_strength *strength, int element,
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
    array[FIELD].value[element] = result->field;
    array[FLUX].value[element] = result->displacement;
    if (strength->given)
        array[RESERVE].value[element] = reserve;
}

/* Begin the arrays of a VTK file for the stresses and strains of a layer in the cells. */
static void name_arrays(vtk_file *vtk, const design *design, int layer, bool has_strength)
{
    const scene_unit_names *units = &design->units;
    char name[SCENE_NAME], unit[VTK_UNIT];
    vtk_layer_name(design, layer, name);
    vtk_unit(units, QUANTITY_PRESSURE, unit);
    for (int height = 0; height < STRESS_HEIGHTS; height++)
        vtk_add(vtk, true, STRESS_COMPONENTS, "stress %s %s%s", name, stress_height_name[height],
                unit);
    for (int height = 0; height < STRESS_HEIGHTS; height++)
        vtk_add(vtk, true, STRESS_COMPONENTS, "strain %s %s", name, stress_height_name[height]);
    vtk_add(vtk, true, 1, "electric field %s%s", name, vtk_unit(units, QUANTITY_FIELD, unit));
    vtk_add(vtk, true, 1, "electric displacement %s%s", name,
            vtk_unit(units, QUANTITY_CHARGE, unit));
    if (has_strength)
        vtk_add(vtk, true, 1, "reserve factor %s", name);
}

/* Add stresses and strains of a layer to a VTK file: in its cells, and averaged at its points. */
static void add_layer(vtk_file *vtk, const stress_field *field, int layer)
{
    const design *design = field->state.design;
    const scene_strength *strength = &design->material[design->layer[layer].material].strength;
    const int first = vtk->arrays;
    name_arrays(vtk, design, layer, strength->given);
    for (int element = 0; !vtk->is_full && element < field->elements; element++) {
        stress_layer result;
        if (!stress_is_present(field, element, layer))
            continue;
        stress_layer_of(field, element, layer, &result);
        fill_element(vtk->array + first, strength, element, &result);
    }
    for (int k = first; !vtk->is_full && k < first + FIELD; k++) {
        double *mean = vtk_add(vtk, false, STRESS_COMPONENTS, "%s", vtk->array[k].name);
        if (mean)
            stress_points_average(vtk->points, field, vtk->array[k].value, STRESS_COMPONENTS, mean);
    }
}

static void add_displacement(vtk_file *vtk, const double *u, const char *name)
{
    double *value = vtk_add(vtk, false, 3, "%s", name);
    double *vector = calloc(3 * (size_t)vtk->mesh->nodes, sizeof *vector);
    vtk->is_full |= !vector;
    if (!vtk->is_full)
        design_vectors(vtk->mesh, u, vector);
    for (int k = 0; !vtk->is_full && k < vtk_points(vtk); k++)
        memcpy(value + 3 * k, vector + 3 * vtk_node(vtk, k), 3 * sizeof *value);
    free(vector);
}

static void add_resultants(vtk_file *vtk, const stress_field *field)
{
    const char *length = field->state.design->units.length;
    const char *force = field->state.design->units.force;
    char unit[SCENE_ERROR] = "";
    if (*length && *force)
        snprintf(unit, sizeof unit, " (%.30s/%.30s, %.30s, %.30s/%.30s)", force, length, force,
                 force, length);
    double *value =
        vtk_add(vtk, true, STRESS_RESULTANTS, "resultants N11 N22 N12 M11 M22 M12 Q13 Q23%s", unit);
    for (int element = 0; value && element < field->elements; element++)
        stress_resultants(field, element, value + element * STRESS_RESULTANTS);
}

static void add_potentials(vtk_file *vtk, const design *design, const double *input_value)
{
    char name[WORDS_FACE], unit[VTK_UNIT];
    vtk_unit(&design->units, QUANTITY_VOLTAGE, unit);
    for (int k = 0; design->bare.count > 0 && k < 2 * design->layers; k++) {
        if (!words_bare_face(design->layer, k, name))
            continue;
        double *value = vtk_add(vtk, false, 1, "%s%s", name, unit);
        for (int i = 0; value && i < vtk_points(vtk); i++)
            value[i] =
                bare_faces_potential(&design->bare, input_value, k / 2, k % 2, vtk_node(vtk, i));
    }
}

/*
 * Add a vector at each node to a VTK file, the first three or the last three of six components.
 *   value [nodes][6] in  components at the nodes
 *   first            in  first component, 0 or 3
 */
static void add_node_vectors(vtk_file *vtk, const double (*value)[6], int first, const char *name,
                             const char *unit)
{
    double *vector = vtk_add(vtk, false, 3, "%s%s", name, unit);
    for (int k = 0; vector && k < vtk_points(vtk); k++)
        memcpy(vector + 3 * k, value[vtk_node(vtk, k)] + first, 3 * sizeof *vector);
}

/*
 * Add the force and the moment of the supports at each node to a VTK file, which are zero at nodes
 * that no support holds.
 */
static void add_reactions(vtk_file *vtk, const analysis *analysis)
{
    const scene_unit_names *units = &analysis->design.units;
    const double(*value)[6] = (const double(*)[6])analysis->reactions.node;
    char unit[VTK_UNIT];
    if (analysis->reactions.nodes == 0)
        return;
    add_node_vectors(vtk, value, 0, "reaction", vtk_unit(units, QUANTITY_FORCE, unit));
    add_node_vectors(vtk, value, 3, "reaction moment", vtk_unit(units, QUANTITY_MOMENT, unit));
}

/* Add the force of the contact body at each node to a VTK file. */
static void add_contact_forces(vtk_file *vtk, const analysis *analysis)
{
    char unit[VTK_UNIT];
    if (!analysis->is_nonlinear || !analysis->design.contact.given)
        return;
    double *vector = vtk_add(vtk, false, 3, "contact force%s",
                             vtk_unit(&analysis->design.units, QUANTITY_FORCE, unit));
    for (int k = 0; vector && k < vtk_points(vtk); k++)
        equilibrium_contact_force(&analysis->equilibrium, vtk_node(vtk, k), vector + 3 * k);
}

int vtk_write_solution(FILE *file, const vtk_solution *solution)
{
    const analysis *analysis = solution->analysis;
    const stress_field *stress = solution->stress;
    const design *design = &analysis->design;
    char name[VTK_UNIT + 16], unit[VTK_UNIT];
    stress_points points = {.count = 0};
    vtk_file vtk = {.mesh = &design->mesh, .points = stress ? &points : NULL};
    vtk.is_full = stress && stress_points_make(&points, stress) < 0;
    snprintf(name, sizeof name, "displacement%s", vtk_unit(&design->units, QUANTITY_LENGTH, unit));
    add_displacement(&vtk, solution->displacement, name);
    if (solution->shape)
        vtk_add_target(&vtk, design, solution->shape, solution->target);
    vtk_add_cells(&vtk, design, solution->voltage);
    add_potentials(&vtk, design, analysis->input_value);
    add_reactions(&vtk, analysis);
    add_contact_forces(&vtk, analysis);
    if (stress)
        add_resultants(&vtk, stress);
    for (int layer = 0; stress && layer < design->layers; layer++)
        add_layer(&vtk, stress, layer);
    const int status = vtk_end(&vtk, file);
    stress_points_free(&points);
    return status;
}

int vtk_write_modes(FILE *file, const design *design, const vibration *vibration)
{
    const mesh *mesh = &design->mesh;
    vtk_file vtk = {.mesh = mesh};
    for (int k = 0; k < vibration->count; k++) {
        char name[32];
        snprintf(name, sizeof name, "mode_%d", k + 1);
        add_displacement(&vtk, vibration->shape + (size_t)k * (size_t)mesh->free_dof, name);
    }
    vtk_add_cells(&vtk, design, NULL);
    return vtk_end(&vtk, file);
}
