/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Prints the modes of the control loop, each with its gain (part of the wanted change that a tick
 * makes) and its leak (part that a tick removes) (print_gains.h).
 */
#include "print_gains.h"
#include <math.h>
#include <stdio.h>
#include "../model/modal_gains.h"

/* Smallest and largest number of a list. */
typedef struct extent {
    double least, most;
} extent;

static extent extent_of(const double *value, int count)
{
    extent of = {value[0], value[0]};
    for (int k = 1; k < count; k++) {
        of.least = fmin(of.least, value[k]);
        of.most = fmax(of.most, value[k]);
    }
    return of;
}

static bool stays(double gain, double leak)
{
    return !(gain > 0) && !(leak > 0);
}

/*
 * How much noise of the measured shape a mode passes on to its coordinate: root mean square of the
 * coordinate, divided by that of white noise in the mode (dimensionless).
 */
static double noise_of(double gain, double leak)
{
    const double sum = gain + leak;
    return sum > 0 ? gain / sqrt(sum * (2 - sum)) : 0;
}

/*
 * Extremes over all modes and, if there are fewer modes than amplifiers, over the voltages outside
 * their span.
 */
typedef struct gains_facts {
    double growth; /* largest factor by which a tick multiplies an error in a mode (dimensionless);
                      modes of which a tick neither makes a change (gain 0) nor removes a part (leak
                      0) do not count, because their errors stay */
    double noise;  /* largest ratio of the noise in the coordinate of a mode to the noise of the
                      measured shape (dimensionless) */
    int staying;   /* number of modes whose gain and leak are both 0, so that the loop never changes
                      them */
} gains_facts;

static void add_fact(gains_facts *facts, double gain, double leak, int delay)
{
    if (stays(gain, leak))
        return;
    facts->growth = fmax(facts->growth, modal_gains_growth(gain, leak, delay));
    facts->noise = fmax(facts->noise, noise_of(gain, leak));
}

static gains_facts find_facts(const design *design)
{
    const pzs_modal_gains *tables = &design->gains.tables;
    const int delay = design->simulate.delay;
    gains_facts facts = {0, 0, 0};
    for (int k = 0; k < tables->modes; k++) {
        add_fact(&facts, tables->gain[k], tables->leak[k], delay);
        facts.staying += stays(tables->gain[k], tables->leak[k]);
    }
    if (tables->modes < design->amplifiers)
        add_fact(&facts, tables->other_gain, tables->other_leak, delay);
    return facts;
}

static void print_extent(const char *name, const double *value, int count)
{
    const extent of = extent_of(value, count);
    if (of.least < of.most)
        printf("%s %.4g to %.4g", name, of.least, of.most);
    else
        printf("%s %.4g", name, of.least);
}

/*
 * Print each function that the scene lists as a mode, with its gain, its leak, and the part of it
 * that the actuators cannot produce (%).
 */
static void print_functions(const design *design)
{
    const scene_modal_gains *from = &design->control.modal_gains;
    const modal_gains *gains = &design->gains;
    if (from->functions == 0)
        return;
    puts("    mode  gain    leak    not made  function");
    for (int k = 0; k < from->functions; k++)
        printf("    %4d  %-6.4g  %-6.4g  %7.3g%%  %s\n", k + 1, gains->tables.gain[k],
               gains->tables.leak[k], 100 * gains->left[k], from->function[k].name);
}

void print_gains(const design *design)
{
    const pzs_modal_gains *tables = &design->gains.tables;
    if (!design->gains.is_used)
        return;
    const gains_facts facts = find_facts(design);
    fputs("\n  gains of modes: ", stdout);
    if (tables->modes > 0) {
        printf("%d %s, ", tables->modes,
               design->control.modal_gains.functions > 0
                   ? "functions"
                   : "singular vectors of the influence matrix");
        print_extent("gain", tables->gain, tables->modes);
        print_extent(", leak", tables->leak, tables->modes);
        printf("; the rest: gain %.4g, leak %.4g\n", tables->other_gain, tables->other_leak);
    } else {
        printf("gain %.4g, leak %.4g of everything\n", tables->other_gain, tables->other_leak);
    }
    printf(
        "  a tick leaves at most %.4g of an error, where the response to voltages is 0.8 to 1.33 "
        "of the model's;\n  noise of the readings comes back as at most %.4g of it in a mode\n",
        facts.growth, facts.noise);
    if (facts.staying > 0)
        printf("  %d mode%s of gain 0 and leak 0: nothing brings it back where limits have moved "
               "it; a small leak does\n",
               facts.staying, facts.staying == 1 ? "" : "s");
    print_functions(design);
}

void print_gains_json(json *json, const design *design)
{
    const pzs_modal_gains *tables = &design->gains.tables;
    if (!design->gains.is_used)
        return;
    const gains_facts facts = find_facts(design);
    json_open(json, "modal_gains", '{');
    json_number(json, "modes", tables->modes);
    json_numbers(json, "gain", tables->gain, tables->modes);
    json_numbers(json, "leak", tables->leak, tables->modes);
    json_number(json, "other_gain", tables->other_gain);
    json_number(json, "other_leak", tables->other_leak);
    json_number(json, "growth", facts.growth);
    json_number(json, "noise", facts.noise);
    if (design->control.modal_gains.functions > 0)
        json_numbers(json, "not_made", design->gains.left, tables->modes);
    json_close(json, '}');
}
