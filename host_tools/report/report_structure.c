/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of layers, materials and voltages, and the text of the scene, on report pages. */
#include <math.h>
#include "../scene/outline_shares.h"
#include "report_page.h"

/* Write in how many elements the stiffness of a layer is smeared over cut patches. */
static void write_cuts(const page *page, int layer)
{
    const design *design = page->design;
    if (!outline_is_smeared(design->scene, layer))
        return;
    const outline_cuts cuts = outline_cuts_of(design->scene, layer, design->mesh.elements);
    if (cuts.elements > 0)
        put(page->file,
            "<p>The stiffness of the layer %t is smeared over %d elements of which its patches "
            "cover %p to %p; the error near their outlines is of the size of an element.</p>\n",
            design->layer[layer].name, cuts.elements, cuts.least, cuts.most);
    else
        put(page->file,
            "<p>The patches of the layer %t cover whole elements, no stiffness is smeared.</p>\n",
            design->layer[layer].name);
}

static void write_layers(const page *page)
{
    const design *design = page->design;
    put(page->file, PUT_TABLE("Layers from the inner face to the outer face",
                              "^Layer^<Material^Thickness^Angle^<Where"));
    for (int k = 0; k < design->layers; k++) {
        const scene_layer *layer = &design->layer[k];
        const char *place = layer->present ? "in its sets" : "everywhere";
        put(page->file, PUT_ROW("%d %t|<%t|%q|%n°|<%s"), k + 1, layer->name,
            design->material[layer->material].name, layer->thickness, design->units.length,
            layer->angle, layer->patched ? "in patches" : place);
    }
    put(page->file, PUT_TABLE_END);
    for (int k = 0; k < design->layers; k++)
        write_cuts(page, k);
}

/* Write the materials with the piezoelectric constants that the scene states: d31 or e31. */
static void write_materials(const page *page)
{
    const design *design = page->design;
    put(page->file, PUT_TABLE("Materials", "^Material^E₁^E₂^ν₁₂^G₁₂^d₃₁^e₃₁"));
    for (int k = 0; k < design->materials; k++) {
        const scene_material *material = &design->material[k];
        const double d31 = material->has_d ? material->d31 : (double)NAN;
        const double e31 = material->has_e ? material->piezo_e[0] : (double)NAN;
        put(page->file, PUT_ROW("%t|%q|%q|%n|%q|%n|%n"), material->name, material->e[0],
            page->pressure, material->e[1], page->pressure, material->nu12, material->g12,
            page->pressure, d31, e31);
    }
    put(page->file, PUT_TABLE_END);
}

/* Write the text of the scene file on the report page, unless the file can no longer be read. */
static void write_scene(const page *page)
{
    FILE *text = fopen(page->design->path, "r");
    char line[1024];
    if (!text)
        return;
    fputs("<details><summary>Scene file: supports, loads and everything else; changes by --set are "
          "in the command below</summary>\n<pre>",
          page->file);
    while (fgets(line, sizeof line, text))
        put(page->file, "%t", line);
    fputs("</pre></details>\n", page->file);
    fclose(text);
}

void page_structure(const page *page)
{
    fputs("<h2>Structure</h2>\n", page->file);
    if (page->analysis->source->has_structure) {
        write_layers(page);
        write_materials(page);
    }
    write_scene(page);
}

void page_voltages(const page *page, const voltages *result, int results)
{
    if (page->design->amplifiers == 0)
        return;
    put(page->file, "<details><summary>%ss by amplifier</summary>\n" PUT_HEAD("") "^Amplifier",
        page->inputs.title);
    for (int i = 0; i < results; i++)
        put(page->file, "^%t", result[i].name);
    fputs("<tbody>\n", page->file);
    for (int k = 0; k < page->design->amplifiers; k++) {
        put(page->file, PUT_ROW("%t"), page->design->amplifier_name[k]);
        for (int i = 0; i < results; i++)
            put(page->file, "|%q", result[i].voltage[k], design_unit(page->design, k));
    }
    put(page->file, PUT_TABLE_END "</details>\n");
}

/* Write the error that remains of each mode (named target shape) alone, within a pair of limits. */
static void write_modes(const page *page, int limits)
{
    const modes *modes = page->modes;
    put(page->file, "<h2>Mode by mode within %l</h2>\n", modes->left[limits].limit,
        page->inputs.unit);
    put(page->file,
        PUT_TABLE(
            "Relative RMS error of each mode of the target alone. At 100\xc2\xa0%% nothing is "
            "gained.",
            "^Mode^Target, RMS^Unconstrained^Largest %s,<br>unconstrained^Clipped least "
            "squares^Optimum within limits^Limit active"),
        page->inputs.name);
    for (int k = 0; k < modes->count; k++) {
        const mode *mode = &modes->mode[k];
        const mode_left *left = &modes->left[k * modes->limits + limits];
        put(page->file, PUT_ROW("%t|%q|%p|%q|%p|%b|%d"), page->design->goal.mode[k].name,
            mode->size, page->design->units.length, mode->unconstrained_error,
            mode->largest_voltage, page->inputs.unit, left->clipped, left->optimum, 1.0,
            left->active_limits);
    }
    put(page->file, PUT_TABLE_END);
}

void page_modes(const page *page)
{
    for (int k = 0; page->modes->count > 0 && k < page->modes->limits; k++)
        write_modes(page, k);
}
