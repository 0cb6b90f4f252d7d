/* The electrodes of a scene on standard output (print.h). */
#include <math.h>
#include <stdio.h>
#include "print.h"
#include "words.h"

/* Name of electrode k, and how it is connected. */
static const char *connection(const design *d, int k, char name[SCENE_LABEL])
{
    const int input = d->electrodes.input[k];
    if (input < d->amplifiers) {
        scene_amplifier_name(d->scene, input, name);
        return "driven";
    }
    scene_sensor_name(d->scene, input - d->sensor_first, name);
    return d->electrodes.open[k] ? "open" : "short";
}

void print_electrodes(analysis *a)
{
    const design *d = &a->design;
    char name[SCENE_LABEL], unit[2][WORDS_UNIT], head[2][2 * WORDS_UNIT];
    if (d->electrodes.count == 0)
        return;
    words_unit(d->scene, QUANTITY_VOLTAGE, unit[0]);
    words_unit(d->scene, QUANTITY_CHARGE, unit[1]);
    for (int k = 0; k < 2; k++)
        snprintf(head[k], sizeof head[k], unit[k][0] ? "%s (%s)" : "%s", k ? "charge" : "volts",
                 unit[k]);
    printf("\n  %-20s %-8s %14s %14s %18s %18s\n", "electrode", "circuit", head[0], head[1],
           "capacitance, held", "free");
    for (int k = 0; k < d->electrodes.count; k++) {
        const char *circuit = connection(d, k, name);
        printf("  %-20s %-8s %14.6e %14.6e %18.6e ", name, circuit,
               a->amount[d->electrodes.input[k]], a->charge[k], analysis_capacitance(a, k, 0));
        if (isfinite(analysis_capacitance(a, k, 1)))
            printf("%18.6e\n", analysis_capacitance(a, k, 1));
        else
            puts("                 -");
    }
    const double ratio = analysis_stiffening(a);
    if (isfinite(ratio))
        printf(
            "  open electrodes make the loaded shell stiffer than short ones by a factor of %.6f (coupling k2 = %.6f)\n",
            ratio, 1 - 1 / ratio);
}

void print_electrodes_json(json *j, analysis *a)
{
    const design *d = &a->design;
    char name[SCENE_LABEL];
    json_open(j, "electrodes", '{');
    for (int k = 0; k < d->electrodes.count; k++) {
        const char *circuit = connection(d, k, name);
        json_open(j, name, '{');
        json_string(j, "circuit", circuit);
        json_number(j, "volts", a->amount[d->electrodes.input[k]]);
        json_number(j, "charge", a->charge[k]);
        json_number(j, "capacitance_held", analysis_capacitance(a, k, 0));
        json_number(j, "capacitance_free", analysis_capacitance(a, k, 1));
        json_close(j, '}');
    }
    json_close(j, '}');
    json_number(j, "open_over_short_stiffness", analysis_stiffening(a));
}
