/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Voltages of actuators that are not linear, and their effects, the values that are proportional to
 * the displacements of the actuators (curves.h).
 */
#include "curves.h"
#include <math.h>
#include <stdio.h>
#include "../../lib/control/actuator_curve.h"

/* This declaration fails to compile if a scene could have more points than the tables. */
typedef char points_fit[SCENE_CURVE_POINTS == PZS_CURVE_POINTS ? 1 : -1];

bool curves_are_used(const design *design)
{
    return design->measured.curve.given;
}

actuator_curves curves_of(const design *design)
{
    const scene_curves *curve = &design->measured.curve;
    return (actuator_curves){curve->sets,   curve->points, curve->voltage,
                             curve->effect, curve->bend,   0};
}

void curves_fill(design *design)
{
    const scene_curves *curve = &design->measured.curve;
    if (!curve->given)
        return;
    design->curves = (pzs_actuator_curves){.scene = design->scene->hash,
                                           .inputs = (uint16_t)design->amplifiers,
                                           .sets = (uint16_t)curve->sets,
                                           .points = (uint16_t)curve->points,
                                           .voltage = curve->voltage,
                                           .effect = curve->effect,
                                           .bend = curve->bend};
    (void)pzs_actuator_curves_seal(&design->curves);
}

void curves_effects(const design *design, const double *voltage, double *effect)
{
    const actuator_curves curves = curves_of(design);
    for (int k = 0; k < design->amplifiers; k++)
        effect[k] = actuator_effect(&curves, k, voltage[k]);
}

void curves_narrow(const design *design, double *lower, double *upper)
{
    const scene_curves *curve = &design->measured.curve;
    for (int k = 0; k < design->amplifiers && curve->given; k++) {
        const int set = curve->sets > 1 ? k : 0;
        const double *voltage = curve->voltage + (size_t)set * (size_t)curve->points;
        if (design_is_held(design, k))
            continue;
        lower[k] = fmax(lower[k], voltage[0]);
        upper[k] = fmin(upper[k], voltage[curve->points - 1]);
    }
}

void curves_limits(const design *design, const double *limit, double *effect)
{
    for (int k = 0; k < design->amplifiers; k++)
        effect[k] = curves_are_used(design)
                        ? pzs_actuator_curve_effect(&design->curves, (uint32_t)k, limit[k])
                        : limit[k];
}

/*
 * Return the voltage inside limits at which actuator k has a wanted effect; the displacement of the
 * actuator is proportional to the effect.
 */
static double voltage_of(const pzs_actuator_curves *curves, uint32_t k, double effect, double lower,
                         double upper)
{
    if (effect >= pzs_actuator_curve_effect(curves, k, upper))
        return upper;
    if (effect <= pzs_actuator_curve_effect(curves, k, lower))
        return lower;
    return fmin(fmax(pzs_actuator_curve_voltage(curves, k, effect), lower), upper);
}

void curves_voltages(const design *design, const double *effect, const double *lower,
                     const double *upper, double *voltage)
{
    for (int k = 0; k < design->amplifiers; k++)
        voltage[k] = curves_are_used(design)
                         ? voltage_of(&design->curves, (uint32_t)k, effect[k], lower[k], upper[k])
                         : effect[k];
}

double curves_half_range(const design *design, int amplifier)
{
    const double lower = design->lower[amplifier], upper = design->upper[amplifier];
    const actuator_curves curves = curves_of(design);
    if (!curves_are_used(design) || !isfinite(upper - lower))
        return (upper - lower) / 2;
    return (actuator_effect(&curves, amplifier, upper) -
            actuator_effect(&curves, amplifier, lower)) /
           2;
}

/* ---- text ------------------------------------------------------------- */

/*
 * Lowest and highest slope of the curves between the voltage limits: change of the effect (to which
 * the displacement of the actuator is proportional) per volt.
 */
typedef struct slopes {
    double least, most;
} slopes;

/*
 * Widen the range of slopes by those of an amplifier's curve: its voltage range is divided into a
 * hundred parts, and the mean slope in each part, relative to that of the whole range, is included.
 */
static void add_slopes(const design *design, int amplifier, slopes *found)
{
    enum { PARTS = 100 };
    const actuator_curves curves = curves_of(design);
    const double lower = design->lower[amplifier], upper = design->upper[amplifier];
    const double part = (upper - lower) / PARTS;
    const double mean = 2 * curves_half_range(design, amplifier) / (upper - lower);
    for (int i = 0; i < PARTS && part > 0; i++) {
        const double slope = (actuator_effect(&curves, amplifier, lower + (i + 1) * part) -
                              actuator_effect(&curves, amplifier, lower + i * part)) /
                             (part * mean);
        found->least = fmin(found->least, slope);
        found->most = fmax(found->most, slope);
    }
}

void curves_text(const design *design, char text[CURVES_TEXT])
{
    const scene_curves *curve = &design->measured.curve;
    slopes found = {HUGE_VAL, 0};
    char kind[80], range[120] = "";
    text[0] = '\0';
    if (!curve->given)
        return;
    for (int k = 0; k < design->amplifiers && design->lower; k++)
        add_slopes(design, k, &found);
    if (curve->is_square)
        snprintf(kind, sizeof kind, "the effect is the square of the voltage");
    else
        snprintf(kind, sizeof kind, "%d points%s", curve->points,
                 curve->sets > 1 ? ", a curve for each actuator" : "");
    if (found.most > 0)
        snprintf(range, sizeof range,
                 ";\n  between the limits, hundredths of the range of voltages move %.3g to %.3g "
                 "times as far as the mean",
                 found.least, found.most);
    snprintf(text, CURVES_TEXT, "actuator curves: %s%s", kind, range);
}
