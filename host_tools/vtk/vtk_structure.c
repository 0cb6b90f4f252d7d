/* SPDX-License-Identifier: BSD-2-Clause */
/* Patches, layers and element types of the cells, and target of a VTK file (vtk_structure.h). */
#include "vtk_structure.h"
#include <stdlib.h>
#include "../text/words.h"

/*
 * Return the number of the patch that covers most of an element, or -1 if no patch covers any of it
 * or memory runs out.
 */
static int patch_of(vtk_file *vtk, const scene_patches *patches, int element)
{
    const int count = design_patches_in(vtk->mesh, element, patches, NULL);
    design_part *part = calloc((size_t)count + 1, sizeof *part);
    int largest = 0;
    vtk->is_full |= !part;
    if (!part)
        return -1;
    design_patches_in(vtk->mesh, element, patches, part);
    for (int k = 1; k < count; k++)
        if (part[k].share > part[largest].share)
            largest = k;
    const int patch = count > 0 ? part[largest].patch : -1;
    free(part);
    return patch;
}

/*
 * Return the voltage of one patch: the sum of the voltages of the amplifiers that drive it, each
 * times the factor of its connection.
 *   grid in  index of the grid of patches to which the patch belongs
 */
static double patch_voltage(const design *design, int grid, int patch, const double *voltage)
{
    double sum = 0;
    for (int k = 0; k < design->actuators; k++) {
        const scene_actuator *actuator = &design->actuator[k];
        for (int i = 0; i < actuator->drives && !actuator->is_temperature; i++)
            if (actuator->drive[i].patches == grid)
                sum += actuator->drive[i].factor * voltage[actuator->first + patch];
    }
    return sum;
}

static void add_layers(vtk_file *vtk, const design *design)
{
    char name[SCENE_NAME];
    for (int layer = 0; layer < design->layers; layer++) {
        double *present = vtk_add(vtk, true, 1, "present %s", vtk_layer_name(design, layer, name));
        for (int e = 0; present && e < vtk->mesh->elements; e++) {
            const laminate_place *place = &vtk->mesh->place[vtk->mesh->element_type[e]];
            present[e] = place->present_plies >> layer & 1u;
        }
    }
}

/* Add the number of the patch of a grid that covers each element, from 1 (0: none). */
static void add_patches(vtk_file *vtk, const design *design, int grid)
{
    const scene_patches *patches = &design->patches[grid];
    double *number = vtk_add(vtk, true, 1, "patch %s", patches->name);
    for (int e = 0; number && e < vtk->mesh->elements; e++)
        number[e] = patch_of(vtk, patches, e) + 1;
}

static void add_voltages(vtk_file *vtk, const design *design, int grid, const double *voltage)
{
    const scene_patches *patches = &design->patches[grid];
    char unit[VTK_UNIT];
    double *value = vtk_add(vtk, true, 1, "voltage %s%s", patches->name,
                            vtk_unit(&design->units, QUANTITY_VOLTAGE, unit));
    for (int e = 0; value && e < vtk->mesh->elements; e++) {
        const int patch = patch_of(vtk, patches, e);
        value[e] = patch < 0 ? 0 : patch_voltage(design, grid, patch, voltage);
    }
}

void vtk_add_cells(vtk_file *vtk, const design *design, const double *voltage)
{
    if (vtk->mesh->elements == 0)
        return;
    double *type = vtk_add(vtk, true, 1, "element type");
    for (int e = 0; type && e < vtk->mesh->elements; e++)
        type[e] = vtk->mesh->element_type[e];
    add_layers(vtk, design);
    for (int grid = 0; grid < design->patch_grids; grid++) {
        add_patches(vtk, design, grid);
        if (voltage)
            add_voltages(vtk, design, grid, voltage);
    }
}

/*
 * Return a new array [nodes of the mesh] with the given value of each target at the node of the
 * target, and 0 at nodes without a target; NULL where memory runs out.
 */
static double *at_nodes(const vtk_file *vtk, const design *design, const double *value)
{
    double *node = calloc((size_t)vtk->mesh->nodes + 1, sizeof *node);
    for (int i = 0; node && i < design->targets; i++)
        node[design->target_node[i]] = value[i];
    return node;
}

static void add_target_array(vtk_file *vtk, const design *design, const double *value,
                             const char *name, words_quantity quantity)
{
    char unit[VTK_UNIT];
    double *array = vtk_add(vtk, false, 1, "%s%s", name, vtk_unit(&design->units, quantity, unit));
    double *node = at_nodes(vtk, design, value);
    vtk->is_full |= !node;
    for (int k = 0; array && node && k < vtk_points(vtk); k++)
        array[k] = node[vtk_node(vtk, k)];
    free(node);
}

void vtk_add_target(vtk_file *vtk, const design *design, const double *shape, const double *target)
{
    double *misfit = calloc((size_t)design->targets + 1, sizeof *misfit);
    vtk->is_full |= !misfit;
    for (int i = 0; misfit && i < design->targets; i++)
        misfit[i] = shape[i] - target[i];
    add_target_array(vtk, design, design->weight, "target weight", QUANTITY_OTHER);
    add_target_array(vtk, design, target, "target", QUANTITY_LENGTH);
    add_target_array(vtk, design, shape, "shape", QUANTITY_LENGTH);
    if (misfit)
        add_target_array(vtk, design, misfit, "misfit", QUANTITY_LENGTH);
    free(misfit);
}
