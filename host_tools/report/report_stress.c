/* SPDX-License-Identifier: BSD-2-Clause */
/* Section of the stresses on a report page (report_page.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../model/stress_points.h"
#include "../model/stress_summary.h"
#include "../text/words.h"
#include "report_page.h"

/*
 * Write a map of the load on the material, averaged at the nodes: one over the reserve factor if
 * the scene states strengths, otherwise the von Mises stress. Where a node has several averages, as
 * at a fold, the map shows the largest.
 */
static void write_load(const page *page, const stress_field *field)
{
    static const char *const title[] = {"Von Mises stress", "Use of the strength"};
    static const char *const note[] = {
        ", of the layers the largest, averaged at the nodes",
        ", one over the least reserve factor of the layers, averaged at the nodes"};
    stress_points points;
    double *load = calloc(5 * (size_t)field->elements + 1, sizeof *load), *value = page->value;
    if (stress_points_make(&points, field) == 0 && load) {
        double *mean = load + field->elements;
        const bool has_strength = stress_load(field, load);
        const char *unit = has_strength ? "" : page->pressure;
        stress_points_average(&points, field, load, 1, mean);
        memset(value, 0, (size_t)page->mesh->nodes * sizeof *value);
        for (int k = 0; k < points.count; k++)
            value[points.node[k]] = fmax(value[points.node[k]], mean[k]);
        page_map(page, value, draw_scale_of(false, unit, value, page->mesh->nodes),
                 title[has_strength], note[has_strength]);
    } else {
        *page->map.has_failed = true;
    }
    stress_points_free(&points);
    free(load);
}

static void write_components(const page *page, const stress_summary *summary)
{
    put(page->file,
        PUT_TABLE("Largest stresses and strains at element centres (larger at clamps and under "
                  "point loads), in the axes of the materials",
                  "^Component^Value^<Layer, face^<Place"));
    for (int k = 0; k < 2 * STRESS_COMPONENTS; k++) {
        const bool is_strain = k >= STRESS_COMPONENTS;
        const int i = k % STRESS_COMPONENTS;
        const stress_extreme *found = is_strain ? &summary->strain[i] : &summary->stress[i];
        if (found->element < 0)
            continue;
        const char *unit = is_strain ? "" : page->pressure;
        put(page->file, PUT_ROW("%s %t|%q|<%d %t, %t|<%t"), is_strain ? "Strain" : "Stress",
            stress_component_name[i], found->value, unit, found->layer + 1,
            page->design->layer[found->layer].name, stress_height_name[found->height],
            mesh_element_text(page->mesh, found->element).text);
    }
    put(page->file, PUT_TABLE_END);
}

static double value_of(const stress_extreme *found)
{
    return found->element >= 0 ? found->value : (double)NAN;
}

static void write_layers(const page *page, const stress_summary *summary)
{
    put(page->file,
        PUT_TABLE("Layers: largest von Mises stress, least reserve factors",
                  "^Layer^<Material^Von Mises^Reserve, strength^Reserve, depolarisation"));
    for (int layer = 0; layer < page->design->layers; layer++)
        put(page->file, PUT_ROW("%d %t|<%t|%q|%n|%n"), layer + 1, page->design->layer[layer].name,
            page->design->material[page->design->layer[layer].material].name,
            value_of(&summary->mises[layer]), page->pressure, value_of(&summary->reserve[layer]),
            value_of(&summary->field_reserve[layer]));
    put(page->file, PUT_TABLE_END);
}

void page_stress(const page *page)
{
    const stress_field *field = page->stress;
    stress_summary summary;
    if (!field)
        return;
    stress_summarise(field, &summary);
    put(page->file, "<h2>Stresses</h2>\n<p class=\"soft\">%s</p>\n<div class=\"row\">\n",
        field->state.is_nonlinear ? "Second Piola-Kirchhoff stresses and Green-Lagrange strains."
                                  : "Linear in the displacement; 13, 23 and 33 from equilibrium.");
    write_load(page, field);
    fputs("<div>\n", page->file);
    write_components(page, &summary);
    write_layers(page, &summary);
    fputs("</div>\n</div>\n", page->file);
}
