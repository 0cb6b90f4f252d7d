/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Small entries of a measured influence matrix that count as zero in the controller (design.h), so
 * that its tables may hold the matrix as sparse rows.
 */
#include <math.h>
#include "curves.h"

/* Return the absolute value of the largest entry of column k of the influence matrix. */
static double largest_of_column(const design *design, size_t k)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    double largest = 0;
    for (size_t i = 0; i < (size_t)design->targets; i++)
        largest = fmax(largest, fabs(design->influence[i * amplifiers + k]));
    return largest;
}

/*
 * Set the small entries of column k of the influence matrix to zero. For each output, add the
 * largest displacement that is lost by this: absolute value of the entry times the largest absolute
 * voltage, or with actuator curves the largest effect (value to which the displacement of the
 * actuator is proportional).
 *   error [targets] in/out  displacements that are left out (length unit)
 */
static void drop_of_column(design *design, size_t k, double *error)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    const double least = design->measured.drop_below * largest_of_column(design, k);
    const actuator_curves curves = curves_of(design);
    const double effect = fmax(fabs(actuator_effect(&curves, (int)k, design->lower[k])),
                               fabs(actuator_effect(&curves, (int)k, design->upper[k])));
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        double *entry = &design->influence[i * amplifiers + k];
        if (!(fabs(*entry) > 0) || !(fabs(*entry) < least))
            continue;
        error[i] += effect > 0 ? fabs(*entry) * effect : 0;
        *entry = 0;
        design->dropped.entries++;
    }
}

void design_drop(design *design, double *error)
{
    for (size_t k = 0; k < (size_t)design->amplifiers && design->measured.drop_below > 0; k++)
        drop_of_column(design, k, error);
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        if (error[i] > design->dropped.error) {
            design->dropped.error = error[i];
            design->dropped.output = (int)i;
        }
        error[i] = 0;
    }
}
