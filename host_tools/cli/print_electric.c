/* SPDX-License-Identifier: BSD-2-Clause */
/* Voltages, charges and capacitances of the electrodes of a scene on standard output
 * (print_electric.h). */
#include "print_electric.h"
#include <math.h>
#include <stdio.h>
#include "../model/bare_faces.h"
#include "../text/words.h"

/* Return a text that describes the electrical connection of electrode k. */
static const char *connection(const design *design, int k)
{
    if (design->electrodes.input[k] < design->amplifiers)
        return "driven";
    return design->electrodes.open[k] ? "open" : "short";
}

/* Name of electrode k, which belongs to an amplifier or to a sensor. */
static const char *name_of(const design *design, int k)
{
    const int input = design->electrodes.input[k];
    return input < design->amplifiers ? design->amplifier_name[input]
                                      : design->electrode_name[input - design->sensor_first];
}

/*
 * Number of electrodes of amplifiers and sensors, which come first in the library's list of
 * electrodes; the potentials of bare faces (without electrodes) follow them.
 */
static int electrodes_of_patches(const design *design)
{
    return design->electrodes.count - design->bare.count;
}

/*
 * Lowest and highest potential of a bare face (without electrode), and the number of its nodes with
 * a potential.
 */
typedef struct face_range {
    double lowest, highest;
    int nodes;
} face_range;

static face_range range_of(const analysis *analysis, int layer, int face)
{
    const design *design = &analysis->design;
    face_range range = {HUGE_VAL, -HUGE_VAL, 0};
    for (int node = 0; node < design->mesh.nodes; node++) {
        const size_t slot = (size_t)(layer + face) * (size_t)design->mesh.nodes + (size_t)node;
        const double value =
            bare_faces_potential(&design->bare, analysis->input_value, layer, face, node);
        if (design->bare.number[slot] < 0)
            continue;
        range.lowest = fmin(range.lowest, value);
        range.highest = fmax(range.highest, value);
        range.nodes++;
    }
    return range;
}

static bool is_bare(const design *design, int layer, int face)
{
    return design->layer[layer].bare & (face ? BARE_OUTER : BARE_INNER);
}

void print_bare_faces(const analysis *analysis)
{
    const design *design = &analysis->design;
    char unit[WORDS_UNIT + 1] = " ";
    if (!*words_unit(&design->units, QUANTITY_VOLTAGE, unit + 1))
        *unit = '\0';
    for (int k = 0; k < 2 * design->layers && design->bare.count > 0; k++) {
        if (!is_bare(design, k / 2, k % 2))
            continue;
        const face_range range = range_of(analysis, k / 2, k % 2);
        printf("  potential of the bare %s face of layer %d %s: %.6e .. %.6e%s at %d nodes\n",
               k % 2 ? "outer" : "inner", k / 2 + 1, design->layer[k / 2].name, range.lowest,
               range.highest, unit, range.nodes);
    }
}

void print_bare_faces_json(json *json, const analysis *analysis)
{
    const design *design = &analysis->design;
    if (design->bare.count == 0)
        return;
    json_open(json, "bare_faces", '[');
    for (int k = 0; k < 2 * design->layers; k++) {
        if (!is_bare(design, k / 2, k % 2))
            continue;
        const face_range range = range_of(analysis, k / 2, k % 2);
        json_open(json, NULL, '{');
        json_number(json, "layer", k / 2 + 1);
        json_string(json, "name", design->layer[k / 2].name);
        json_string(json, "face", k % 2 ? "outer" : "inner");
        json_number(json, "nodes", range.nodes);
        json_number(json, "lowest", range.lowest);
        json_number(json, "highest", range.highest);
        json_close(json, '}');
    }
    json_close(json, ']');
}

void print_electrodes(analysis *analysis)
{
    const design *design = &analysis->design;
    char unit[2][WORDS_UNIT], head[2][2 * WORDS_UNIT];
    if (electrodes_of_patches(design) == 0)
        return;
    words_unit(&design->units, QUANTITY_VOLTAGE, unit[0]);
    words_unit(&design->units, QUANTITY_CHARGE, unit[1]);
    for (int k = 0; k < 2; k++) {
        const char *name = k ? "charge" : "voltages";
        snprintf(head[k], sizeof head[k], unit[k][0] ? "%s (%s)" : "%s", name, unit[k]);
    }
    printf("\n  %-20s %-8s %14s %14s %18s %18s\n", "electrode", "circuit", head[0], head[1],
           "capacitance, held", "free");
    for (int k = 0; k < electrodes_of_patches(design); k++) {
        printf("  %-20s %-8s %14.6e %14.6e %18.6e ", name_of(design, k), connection(design, k),
               analysis->input_value[design->electrodes.input[k]], analysis->charge[k],
               analysis_capacitance(analysis, k, 0));
        if (isfinite(analysis_capacitance(analysis, k, 1)))
            printf("%18.6e\n", analysis_capacitance(analysis, k, 1));
        else
            puts("                 -");
    }
    const double ratio = analysis_stiffening(analysis);
    if (isfinite(ratio))
        printf("  open electrodes make the loaded shell stiffer than short ones by a factor of "
               "%.6f (coupling k2 = %.6f)\n",
               ratio, 1 - 1 / ratio);
}

void print_electrodes_json(json *json, analysis *analysis)
{
    const design *design = &analysis->design;
    json_open(json, "electrodes", '{');
    for (int k = 0; k < electrodes_of_patches(design); k++) {
        json_open(json, name_of(design, k), '{');
        json_string(json, "circuit", connection(design, k));
        json_number(json, "voltages", analysis->input_value[design->electrodes.input[k]]);
        json_number(json, "charge", analysis->charge[k]);
        json_number(json, "capacitance_held", analysis_capacitance(analysis, k, 0));
        json_number(json, "capacitance_free", analysis_capacitance(analysis, k, 1));
        json_close(json, '}');
    }
    json_close(json, '}');
    json_number(json, "open_over_short_stiffness", analysis_stiffening(analysis));
}
