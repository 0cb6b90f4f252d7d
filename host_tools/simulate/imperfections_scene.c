/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Imperfections of amplifiers, cables, ceramic and sensors as a scene states them
 * (imperfections_scene.h).
 */
#include "imperfections_scene.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "../model/curves.h"

/*
 * Width of the hysteresis loop of a soft piezoceramic relative to the voltage range, used if the
 * scene file gives no width.
 */
static const double usual_hysteresis = 0.1;

/* Return whether a material is piezoelectric: an electric field strains it. */
static bool is_piezoelectric(const scene_material *material)
{
    return material->has_d || material->has_e;
}

double imperfections_hysteresis(const design *design)
{
    bool is_active = false;
    if (design->simulate.hysteresis_given)
        return design->simulate.hysteresis;
    for (int i = 0; i < design->layers; i++)
        is_active |= is_piezoelectric(&design->material[design->layer[i].material]);
    for (int k = 0; k < design->amplifiers; k++)
        is_active = is_active && isfinite(design->upper[k] - design->lower[k]);
    return is_active ? usual_hysteresis : 0;
}

int imperfections_check(const design *design, char *error)
{
    for (int k = 0; k < design->amplifiers; k++)
        if (!isfinite(design->upper[k] - design->lower[k]) && imperfections_hysteresis(design) > 0)
            return scene_fault(design->simulate.at, error,
                               "hysteresis is a part of the range of the voltages; add "
                               "limits: {voltage: [lowest, highest]}");
    return 0;
}

imperfection_tables imperfections_of_scene(const design *design)
{
    const scene_imperfections *settings = &design->simulate.imperfections;
    actuator_curves curves = curves_of(design);
    curves.error = design->simulate.curve_error;
    return (imperfection_tables){.amplifiers = design->amplifiers,
                                 .lower = design->lower,
                                 .upper = design->upper,
                                 .hysteresis = imperfections_hysteresis(design),
                                 .bandwidth = settings->bandwidth,
                                 .creep = settings->creep,
                                 .drift = settings->drift,
                                 .quantum = settings->quantum,
                                 .outlier_chance = settings->outlier_chance,
                                 .outlier_size = settings->outlier_size,
                                 .reversals = settings->reversals,
                                 .reversed = settings->reversed,
                                 .swaps = settings->swaps,
                                 .swapped = settings->swapped,
                                 .curves = curves};
}

/*
 * Return the largest deviation from 1 of the gains of the amplifiers. A gain is the factor by which
 * an amplifier's column of the simulated plant's influence matrix differs from its column of the
 * scene's measured influence matrix.
 */
static double largest_gain_error(const design *design)
{
    double most = 0;
    for (int k = 0; k < design->amplifiers && design->simulate.gain; k++)
        most = fmax(most, fabs(design->simulate.gain[k] - 1));
    return most;
}

void imperfections_text(const design *design, char *text, size_t room)
{
    const scene_imperfections *settings = &design->simulate.imperfections;
    const struct {
        const char *format;
        double value;
    } rows[] = {
        {"entries of the matrix wrong by %g", design->simulate.scatter},
        {"gains of the matrix up to %g off", largest_gain_error(design)},
        {"actuator curves off by %g of the range of effects", fabs(design->simulate.curve_error)},
        {"hysteresis %g of the range", imperfections_hysteresis(design)},
        {"creep %g a decade", settings->creep},
        {"amplifiers of %g Hz", settings->bandwidth},
        {"%g reversed wires", settings->reversals},
        {"%g swapped cables", settings->swaps},
        {"drift of sensors up to %g a second", settings->drift},
        {"outliers in a share of %g of the readings", settings->outlier_chance},
        {"readings in steps of %g", settings->quantum}};
    size_t at = 0;
    text[0] = '\0';
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char part[80];
        if (!(rows[i].value > 0))
            continue;
        snprintf(part, sizeof part, rows[i].format, rows[i].value);
        if (at + strlen(part) + 3 < room)
            at += (size_t)snprintf(text + at, room - at, "%s%s", at ? ", " : "", part);
    }
}
