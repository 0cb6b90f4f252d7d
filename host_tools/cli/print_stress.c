/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Printing of the largest stresses and strains of a structure on standard output (print_stress.h).
 */
#include "print_stress.h"
#include <stdio.h>
#include <string.h>
#include "../model/stress_summary.h"
#include "../text/words.h"

/*
 * Return the name of a layer. A layer without a name in the scene file is called "layer" followed
 * by its number, counted from 1.
 */
static const char *layer_name(const design *design, int layer, char text[SCENE_NAME])
{
    if (design->layer[layer].name[0])
        snprintf(text, SCENE_NAME, "%s", design->layer[layer].name);
    else
        snprintf(text, SCENE_NAME, "layer %d", layer + 1);
    return text;
}

/* ---- text ------------------------------------------------------------- */

/*
 * Print an extreme stress, strain or reserve factor with the element, layer and height where it
 * occurs; print a dash if the extreme has no value.
 */
static void print_extreme(const stress_field *field, const char *name, const stress_extreme *found,
                          const char *unit)
{
    const design *design = field->state.design;
    char layer[SCENE_NAME];
    printf("  %-24s ", name);
    if (found->element < 0) {
        printf("%14s\n", "-");
        return;
    }
    printf("%14.6e %-6s %-14s %-7s %8d   %s\n", found->value, unit,
           layer_name(design, found->layer, layer), stress_height_name[found->height],
           found->element, mesh_element_text(&field->state.design->mesh, found->element).text);
}

static void print_components(const stress_field *field, const stress_summary *summary,
                             const char *unit)
{
    printf("\n  %-24s %14s %-6s %-14s %-7s %8s   %s\n", "largest, by component", "value", "",
           "layer", "face", "element", "place");
    for (int strain = 0; strain < 2; strain++)
        for (int i = 0; i < STRESS_COMPONENTS; i++) {
            const stress_extreme *found = strain ? &summary->strain[i] : &summary->stress[i];
            char name[SCENE_NAME];
            snprintf(name, sizeof name, "%s %s", strain ? "strain" : "stress",
                     stress_component_name[i]);
            print_extreme(field, name, found, strain ? "" : unit);
        }
}

static void print_layer(const stress_field *field, const stress_summary *summary, int layer,
                        const char *unit)
{
    const design *design = field->state.design;
    const scene_material *material = &design->material[design->layer[layer].material];
    const bool is_tsai = material->strength.criterion == CRITERION_TSAI_HILL;
    char name[SCENE_NAME], field_unit[WORDS_UNIT];
    printf("  %s%s, of %s\n", design->layer[layer].name[0] ? "layer " : "",
           layer_name(design, layer, name), material->name);
    print_extreme(field, "  von Mises stress", &summary->mises[layer], unit);
    if (material->strength.given)
        print_extreme(field, is_tsai ? "  reserve, Tsai-Hill" : "  reserve, maximum stress",
                      &summary->reserve[layer], "");
    if (material->has_d || material->has_e)
        print_extreme(field, "  electric field", &summary->field[layer],
                      words_unit(&design->units, QUANTITY_FIELD, field_unit));
    if (material->field_limit > 0)
        print_extreme(field, "  reserve, depolarisation", &summary->field_reserve[layer], "");
}

void print_stress(const stress_field *field)
{
    stress_summary summary;
    char unit[WORDS_UNIT];
    if (!field)
        return;
    words_unit(&field->state.design->units, QUANTITY_PRESSURE, unit);
    stress_summarise(field, &summary);
    printf("\n  stresses and strains at element centres, in the axes of the materials: %s\n",
           field->state.is_nonlinear ? "second Piola-Kirchhoff stresses, Green-Lagrange strains"
                                     : "small strains");
    puts("  (larger at clamps and under point loads: refine there before relying on a reserve)");
    puts("  stresses 13, 23 and 33 from equilibrium through the thickness");
    if (stress_is_zero(&summary))
        puts("  every stress is 0: nothing loads the structure, so there are no reserves");
    print_components(field, &summary, unit);
    putchar('\n');
    for (int layer = 0; layer < field->layers; layer++)
        print_layer(field, &summary, layer, unit);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_extreme(json *json, const stress_field *field, const char *key,
                         const stress_extreme *found)
{
    static const char *const axis[3] = {"x", "y", "z"};
    char layer[SCENE_NAME];
    if (found->element < 0)
        return;
    json_open_line(json, key, '{');
    json_number(json, "value", found->value);
    json_string(json, "layer", layer_name(field->state.design, found->layer, layer));
    json_string(json, "face", stress_height_name[found->height]);
    json_number(json, "element", found->element);
    for (int i = 0; i < 3; i++)
        json_number(json, axis[i], field->element[found->element].place[i]);
    json_string(json, "place", mesh_element_text(&field->state.design->mesh, found->element).text);
    json_close(json, '}');
}

static void json_layer(json *json, const stress_field *field, const stress_summary *summary,
                       int layer)
{
    const design *design = field->state.design;
    const scene_material *material = &design->material[design->layer[layer].material];
    char name[SCENE_NAME];
    json_open(json, NULL, '{');
    json_string(json, "layer", layer_name(design, layer, name));
    json_string(json, "material", material->name);
    if (material->strength.given)
        json_string(json, "criterion",
                    material->strength.criterion == CRITERION_TSAI_HILL ? "tsai-hill"
                                                                        : "maximum-stress");
    json_extreme(json, field, "mises", &summary->mises[layer]);
    json_extreme(json, field, "reserve", &summary->reserve[layer]);
    json_extreme(json, field, "electric_field", &summary->field[layer]);
    json_extreme(json, field, "field_reserve", &summary->field_reserve[layer]);
    json_close(json, '}');
}

void print_stress_json(json *json, const stress_field *field)
{
    stress_summary summary;
    char unit[WORDS_UNIT];
    if (!field)
        return;
    stress_summarise(field, &summary);
    json_open(json, "stress", '{');
    json_string(json, "unit", words_unit(&field->state.design->units, QUANTITY_PRESSURE, unit));
    json_string(json, "places", "element centres");
    json_string(json, "measure",
                field->state.is_nonlinear ? "second Piola-Kirchhoff, Green-Lagrange" : "small");
    for (int strain = 0; strain < 2; strain++) {
        json_open(json, strain ? "largest_strain" : "largest_stress", '{');
        for (int i = 0; i < STRESS_COMPONENTS; i++)
            json_extreme(json, field, stress_component_name[i],
                         strain ? &summary.strain[i] : &summary.stress[i]);
        json_close(json, '}');
    }
    json_open(json, "layers", '[');
    for (int layer = 0; layer < field->layers; layer++)
        json_layer(json, field, &summary, layer);
    json_close(json, ']');
    json_close(json, '}');
}
