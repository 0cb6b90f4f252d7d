/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Extreme stresses and strains, reserve factors and resultants of a structure (stress_summary.h).
 */
#include "stress_summary.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "stress_equilibrium.h"

double stress_mises(const double s[STRESS_COMPONENTS])
{
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt((a * a + b * b + c * c) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

double stress_reserve(const scene_strength *strength, const double stress[STRESS_COMPONENTS])
{
    double limit[2];
    for (int axis = 0; axis < 2; axis++)
        limit[axis] = stress[axis] > 0 ? strength->tension[axis] : strength->compression[axis];
    const double first = stress[0] / limit[0], second = stress[1] / limit[1],
                 shear = stress[5] / strength->shear;
    if (strength->criterion == CRITERION_MAXIMUM_STRESS)
        return 1 / fmax(fmax(fabs(first), fabs(second)), fabs(shear));
    return 1 / sqrt(first * first - first * stress[1] / limit[0] + second * second + shear * shear);
}

/*
 * Return the reserve factor of a layer against depolarisation: depolarisation field of its material
 * over the electric field. It is infinite for a field not against the poling, and for a material
 * without a depolarisation field.
 *   field in  electric field along the poling axis e3 (V/m)
 */
static double field_reserve(const design *design, int layer, double field)
{
    const double limit = design->material[design->layer[layer].material].field_limit;
    const scene_layer *own = &design->layer[layer];
    const double against = own->poling > 0 ? -field : field;
    if (abs(own->poling) != 3 && own->finger_distance <= 0)
        return (double)INFINITY;
    return limit > 0 && against > 0 ? limit / against : (double)INFINITY;
}

bool stress_is_zero(const stress_summary *summary)
{
    for (int i = 0; i < STRESS_COMPONENTS; i++)
        if (fabs(summary->stress[i].value) > 0)
            return false;
    return true;
}

bool stress_load(const stress_field *field, double *value)
{
    const design *design = field->state.design;
    bool has_strength = false;
    for (int layer = 0; layer < design->layers; layer++)
        has_strength |= design->material[design->layer[layer].material].strength.given;
    for (int element = 0; element < field->elements; element++) {
        value[element] = 0;
        for (int layer = 0; layer < field->layers; layer++) {
            const scene_strength *strength =
                &design->material[design->layer[layer].material].strength;
            stress_layer result;
            if (!stress_is_present(field, element, layer) || (has_strength && !strength->given))
                continue;
            stress_layer_of(field, element, layer, &result);
            for (int height = 0; height < STRESS_HEIGHTS; height++) {
                const double *stress = result.at[height].stress;
                value[element] =
                    fmax(value[element], has_strength ? 1 / stress_reserve(strength, stress)
                                                      : stress_mises(stress));
            }
        }
    }
    return has_strength;
}

/*
 * Store a value, with its element, layer and height in the layer, as the extreme value of a stress
 * or strain, if none is stored yet or the value is more extreme: larger for order = 1, smaller for
 * order = -1.
 */
static void keep(stress_extreme *extreme, double order, double value, stress_extreme place)
{
    if (extreme->element >= 0 && !(order * value > order * extreme->value))
        return;
    *extreme = place;
    extreme->value = value;
}

/*
 * Store a value, with its element, layer and height in the layer, as the extreme value of a stress
 * or strain, if none is stored yet or the magnitude of the value exceeds that of the stored value.
 */
static void keep_larger(stress_extreme *extreme, double value, stress_extreme place)
{
    if (extreme->element < 0 || fabs(value) > fabs(extreme->value)) {
        *extreme = place;
        extreme->value = value;
    }
}

static void add_layer(const stress_field *field, int element, int layer, stress_summary *summary)
{
    const design *design = field->state.design;
    const scene_strength *strength = &design->material[design->layer[layer].material].strength;
    stress_layer result;
    stress_layer_of(field, element, layer, &result);
    for (int height = 0; height < STRESS_HEIGHTS; height++) {
        const stress_extreme place = {0, element, layer, height};
        const double *stress = result.at[height].stress;
        for (int i = 0; i < STRESS_COMPONENTS; i++) {
            keep_larger(&summary->stress[i], stress[i], place);
            keep_larger(&summary->strain[i], result.at[height].strain[i], place);
        }
        keep(&summary->mises[layer], 1, stress_mises(stress), place);
        const double reserve = strength->given ? stress_reserve(strength, stress) : HUGE_VAL;
        if (isfinite(reserve))
            keep(&summary->reserve[layer], -1, reserve, place);
    }
    const stress_extreme middle = {0, element, layer, 1};
    const double reserve = field_reserve(design, layer, result.field);
    keep_larger(&summary->field[layer], result.field, middle);
    if (isfinite(reserve))
        keep(&summary->field_reserve[layer], -1, reserve, middle);
}

void stress_summarise(const stress_field *field, stress_summary *summary)
{
    const stress_extreme none = {0, -1, 0, 0};
    for (int i = 0; i < STRESS_COMPONENTS; i++)
        summary->stress[i] = summary->strain[i] = none;
    for (int layer = 0; layer < LAMINATE_LAYERS; layer++)
        summary->mises[layer] = summary->reserve[layer] = summary->field[layer] =
            summary->field_reserve[layer] = none;
    for (int element = 0; element < field->elements; element++)
        for (int layer = 0; layer < field->layers; layer++)
            if (stress_is_present(field, element, layer))
                add_layer(field, element, layer, summary);
}

void stress_resultants(const stress_field *field, int element, double value[STRESS_RESULTANTS])
{
    const mesh *mesh = &field->state.design->mesh;
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    const double *natural = field->element[element].resultant;
    const double thickness = mesh->laminate.thickness;
    static const int of[3] = {0, 2, 6};
    static const double unit[2][2] = {{1, 0}, {0, 1}};
    double base[2][2];
    memcpy(base, unit, sizeof base);
    for (int i = 0; i < 4 && place->is_general; i++)
        base[i / 2][i % 2] = place->natural.base[i / 2][i % 2];
    for (int face = 0; face < 2; face++)
        for (int k = 0; k < 3; k++) {
            const double *one = base[k == 1], *two = base[k > 0];
            const double h11 = natural[of[0] + face], h22 = natural[of[1] + face],
                         h12 = natural[of[2] + face];
            value[3 * face + k] = (one[0] * two[0] * h11 + one[1] * two[1] * h22 +
                                   (one[0] * two[1] + one[1] * two[0]) * h12) *
                                  (face ? thickness : 1);
        }
    stress_shear_resultants(field, element, value + 6);
}
