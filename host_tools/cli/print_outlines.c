/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Areas of electrodes of any outline, and elements with smeared stiffness, on standard output
 * (print_outlines.h).
 */
#include "print_outlines.h"
#include <math.h>
#include <stdlib.h>
#include "../scene/outline_shares.h"

/*
 * Areas of the electrodes of one item of the scene's section `patches` (square of the scene's unit
 * of length), or NULL where memory runs out. The caller frees the array.
 */
static double *areas_of(const mesh *mesh, const scene_outlines *outlines)
{
    double *area = calloc((size_t)outlines->electrodes, sizeof *area);
    for (int element = 0; area && element < outlines->elements; element++)
        for (size_t i = outlines->start[element]; i < outlines->start[element + 1]; i++)
            area[outlines->electrode_of[i]] +=
                outlines->share[i] * mesh->place[mesh->element_type[element]].area;
    return area;
}

static void print_item(const design *design, const scene_patches *patches)
{
    const char *unit = design->units.length;
    const int count = patches->outlines->electrodes;
    double *area = areas_of(&design->mesh, patches->outlines), least = HUGE_VAL, most = 0;
    for (int k = 0; area && k < count; k++) {
        least = fmin(least, area[k]);
        most = fmax(most, area[k]);
    }
    printf("  patches '%s': %d electrode%s, areas from %.4g to %.4g", patches->name, count,
           count == 1 ? "" : "s", least, most);
    printf(*unit ? " %s2\n" : "\n", unit);
    free(area);
}

/*
 * Print in how many elements the stiffness is smeared, because patches of a layer cover them only
 * in part: the patches count there by the covered fraction of the area.
 */
static void print_cuts(const char *name, const outline_cuts *cuts)
{
    if (cuts->elements == 0) {
        printf("  layer '%s': its patches cover whole elements, no stiffness is smeared\n", name);
        return;
    }
    printf("  layer '%s': stiffness is smeared over %d element%s ", name, cuts->elements,
           cuts->elements == 1 ? "" : "s");
    printf("of which patches cover %.3g to %.4g %%;\n", 100 * cuts->least, 100 * cuts->most);
    puts("  the error near their outlines is of the size of an element");
}

void print_outlines(const design *design)
{
    for (int k = 0; k < design->patch_grids; k++)
        if (design->patches[k].outlines)
            print_item(design, &design->patches[k]);
    for (int layer = 0; layer < design->layers; layer++)
        if (outline_is_smeared(design->scene, layer)) {
            const outline_cuts cuts = outline_cuts_of(design->scene, layer, design->mesh.elements);
            print_cuts(design->layer[layer].name, &cuts);
        }
}

/*
 * Write for each layer with smeared stiffness the number of elements that its patches cover in
 * part, and the smallest and the largest covered fraction of an element; nothing where there is no
 * such layer.
 */
static void json_cuts(json *json, const design *design)
{
    int layers = 0;
    for (int layer = 0; layer < design->layers; layer++) {
        if (!outline_is_smeared(design->scene, layer))
            continue;
        const outline_cuts cuts = outline_cuts_of(design->scene, layer, design->mesh.elements);
        if (layers++ == 0)
            json_open(json, "smeared_stiffness", '{');
        json_open(json, design->layer[layer].name, '{');
        json_number(json, "elements", cuts.elements);
        json_number(json, "least_share", cuts.elements ? cuts.least : (double)NAN);
        json_number(json, "most_share", cuts.elements ? cuts.most : (double)NAN);
        json_close(json, '}');
    }
    if (layers > 0)
        json_close(json, '}');
}

void print_outlines_json(json *json, const design *design)
{
    int items = 0;
    for (int k = 0; k < design->patch_grids; k++)
        items += design->patches[k].outlines != NULL;
    if (items == 0)
        return;
    json_open(json, "electrode_areas", '{');
    for (int k = 0; k < design->patch_grids; k++) {
        const scene_patches *patches = &design->patches[k];
        double *area = patches->outlines ? areas_of(&design->mesh, patches->outlines) : NULL;
        if (area)
            json_numbers(json, patches->name, area, patches->outlines->electrodes);
        free(area);
    }
    json_close(json, '}');
    json_cuts(json, design);
}
