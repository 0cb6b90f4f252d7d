/* SPDX-License-Identifier: BSD-2-Clause */
/* Voltages, charges and capacitances of the electrodes of a scene on standard output (print.h). */
#include <math.h>
#include <stdio.h>
#include "print.h"
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

void print_electrodes(analysis *analysis)
{
    const design *design = &analysis->design;
    char unit[2][WORDS_UNIT], head[2][2 * WORDS_UNIT];
    if (design->electrodes.count == 0)
        return;
    words_unit(&design->units, QUANTITY_VOLTAGE, unit[0]);
    words_unit(&design->units, QUANTITY_CHARGE, unit[1]);
    for (int k = 0; k < 2; k++)
        snprintf(head[k], sizeof head[k], unit[k][0] ? "%s (%s)" : "%s", k ? "charge" : "voltages",
                 unit[k]);
    printf("\n  %-20s %-8s %14s %14s %18s %18s\n", "electrode", "circuit", head[0], head[1],
           "capacitance, held", "free");
    for (int k = 0; k < design->electrodes.count; k++) {
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
    for (int k = 0; k < design->electrodes.count; k++) {
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
