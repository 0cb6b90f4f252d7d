/* SPDX-License-Identifier: BSD-2-Clause */
/* Units of the quantities of a scene (words.h). */
#include "words.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Write the unit of an electric charge: unit of force times unit of length over unit of voltage. */
static void charge_unit(const scene_unit_names *units, char text[WORDS_UNIT])
{
    const bool is_si = strcmp(units->force, "N") == 0 && strcmp(units->voltage, "V") == 0;
    if (is_si && strcmp(units->length, "m") == 0)
        strcpy(text, "C");
    else if (is_si && strcmp(units->length, "mm") == 0)
        strcpy(text, "mC");
    else if (units->force[0] && units->length[0] && units->voltage[0])
        snprintf(text, WORDS_UNIT, "%.63s %.63s/%.63s", units->force, units->length,
                 units->voltage);
}

const char *words_unit(const scene_unit_names *units, words_quantity quantity,
                       char text[WORDS_UNIT])
{
    const char *length = units->length, *force = units->force;
    const char *const plain[QUANTITY_OTHER + 1] = {
        [QUANTITY_LENGTH] = length, [QUANTITY_ANGLE] = "rad",
        [QUANTITY_FORCE] = force,   [QUANTITY_VOLTAGE] = units->voltage,
        [QUANTITY_NODES] = "nodes", [QUANTITY_TEMPERATURE] = units->temperature};
    snprintf(text, WORDS_UNIT, "%s", plain[quantity] ? plain[quantity] : "");
    if (quantity == QUANTITY_CHARGE)
        charge_unit(units, text);
    if (quantity == QUANTITY_MOMENT && *length && *force)
        snprintf(text, WORDS_UNIT, "%s %s", force, length);
    if (quantity == QUANTITY_INFLUENCE && *length && *units->voltage)
        snprintf(text, WORDS_UNIT, "%s/%s", length, units->voltage);
    if (quantity == QUANTITY_FIELD && *length && *units->voltage)
        snprintf(text, WORDS_UNIT, "%s/%s", units->voltage, length);
    if ((quantity == QUANTITY_LINE_FORCE || quantity == QUANTITY_PRESSURE) && *length && *force)
        snprintf(text, WORDS_UNIT, "%s/%s%s", force, length,
                 quantity == QUANTITY_PRESSURE ? "2" : "");
    return text;
}

bool words_unitless(const scene_unit_names *units)
{
    return !units->length[0] && !units->force[0] && !units->voltage[0] && !units->temperature[0];
}

words_quantity words_of_load(const scene_load *load)
{
#define QUANTITY_OF(type, words, quantity, forces) [type] = quantity,
    static const words_quantity quantity[LOAD_TYPE_COUNT] = {LOAD_TYPES(QUANTITY_OF)};
    return quantity[load->type];
}

words_quantity words_of_output(const scene_output *output)
{
#define UNIT_OF(type, word, keys, of, quantity, ...) [type] = quantity,
    static const words_quantity quantity[OUTPUT_TYPE_COUNT] = {OUTPUT_TYPES(UNIT_OF)};
    return quantity[output->type];
}

bool words_bare_face(const scene_layer *layer, int k, char text[WORDS_FACE])
{
    snprintf(text, WORDS_FACE, "potential of layer %d %.60s, %s face", k / 2 + 1, layer[k / 2].name,
             k % 2 ? "outer" : "inner");
    return layer[k / 2].bare & (k % 2 ? BARE_OUTER : BARE_INNER);
}
