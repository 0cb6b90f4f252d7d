/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plausibility rules on assumptions of the elements, such as straight cross-sections, by recovered
 * stresses (plausible_parts.h).
 */
#include "plausible_parts.h"
#include <stdio.h>
#include "stress_field.h"

/*
 * Measure by which fraction the displacement changes if the elements' transverse shear stresses and
 * normal stresses 33 are replaced by the recovered ones, which satisfy equilibrium.
 */
int measure_theory(const subject *of, int k, measured *found)
{
    found->at = of->scene->at_layers;
    found->value = of->stress->is_straight ? 0 : of->stress->theory_error;
    snprintf(found->what, WHAT,
             "change of the displacement by the recovered transverse stresses; %s contain it",
             of->stress->correction.displacement ? "the stresses alone"
                                                 : "neither displacement nor stresses");
    return k == 0;
}

/*
 * Measure whether the correction of the stresses for bent cross-sections converges: size of its
 * second iteration relative to the first; 0 if the correction is negligible.
 */
int measure_bend(const subject *of, int k, measured *found)
{
    const double negligible = 0.1; /* largest change of the in-plane stresses by bent cross-sections
                                      that counts as negligible, as a part of the in-plane stresses
                                    */
    found->at = of->scene->at_layers;
    found->value = of->stress->bend_share > negligible ? of->stress->bend_change : 0;
    snprintf(found->what, WHAT,
             "second correction of the stresses for bent cross-sections, relative to the first");
    return k == 0;
}
