/* SPDX-License-Identifier: BSD-2-Clause */
/* Units of the quantities of a scene (words.h). */
#include "words.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "../mesh/mesh.h"

/* Write the unit of an electric charge: unit of force times unit of length over unit of voltage. */
static void charge_unit(const scene *scene, char text[WORDS_UNIT])
{
    const bool is_si = strcmp(scene->unit_force, "N") == 0 && strcmp(scene->unit_voltage, "V") == 0;
    if (is_si && strcmp(scene->unit_length, "m") == 0)
        strcpy(text, "C");
    else if (is_si && strcmp(scene->unit_length, "mm") == 0)
        strcpy(text, "mC");
    else if (scene->unit_force[0] && scene->unit_length[0] && scene->unit_voltage[0])
        snprintf(text, WORDS_UNIT, "%.63s %.63s/%.63s", scene->unit_force, scene->unit_length,
                 scene->unit_voltage);
}

const char *words_unit(const scene *scene, words_quantity quantity, char text[WORDS_UNIT])
{
    const char *length = scene->unit_length, *force = scene->unit_force;
    const char *const plain[] = {
        length,  "rad", force, "", "", scene->unit_voltage, "", scene->unit_temperature,
        "nodes", ""};
    snprintf(text, WORDS_UNIT, "%s", plain[quantity]);
    if (quantity == QUANTITY_CHARGE)
        charge_unit(scene, text);
    if ((quantity == QUANTITY_LINE_FORCE || quantity == QUANTITY_PRESSURE) && *length && *force)
        snprintf(text, WORDS_UNIT, "%s/%s%s", force, length,
                 quantity == QUANTITY_PRESSURE ? "2" : "");
    return text;
}

bool words_unitless(const scene *scene)
{
    return !scene->unit_length[0] && !scene->unit_force[0] && !scene->unit_voltage[0] &&
           !scene->unit_temperature[0];
}

words_quantity words_of_theta(const scene *scene, int direction)
{
    return surface_is_angle(&scene->surface, direction + 1) ? QUANTITY_ANGLE : QUANTITY_LENGTH;
}

words_quantity words_of_load(const scene_load *load)
{
    static const words_quantity quantity[] = {QUANTITY_FORCE,       QUANTITY_LINE_FORCE,
                                              QUANTITY_PRESSURE,    QUANTITY_OTHER,
                                              QUANTITY_TEMPERATURE, QUANTITY_OTHER};
    return quantity[load->type];
}

words_quantity words_of_output(const scene_output *output)
{
    if (output->electric != ELECTRIC_NONE)
        return output->electric == ELECTRIC_VOLTAGE ? QUANTITY_VOLTAGE : QUANTITY_CHARGE;
    switch (output->contact) {
    case CONTACT_NONE: return QUANTITY_LENGTH;
    case CONTACT_NODES: return QUANTITY_NODES;
    case CONTACT_PRESSURE: return QUANTITY_PRESSURE;
    default: return QUANTITY_FORCE;
    }
}
