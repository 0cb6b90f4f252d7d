/* SPDX-License-Identifier: BSD-2-Clause */
/* Shares of the four corners in the area of an element (corner_weight.h). */
#include "corner_weight.h"

static const double xi1[4] = {-1, 1, 1, -1}, xi2[4] = {-1, -1, 1, 1};

double corner_jacobian(const laminate_place *place, int corner)
{
    return 1 + place->skew[0] * xi2[corner] + place->skew[1] * xi1[corner];
}

double corner_share(const laminate_place *place, int corner)
{
    return 1 + (corner_jacobian(place, corner) - 1) / 3;
}

double corner_pair_excess(const laminate_place *place, int first, int second)
{
    const double even1 = 1 + xi1[first] * xi1[second] / 3, even2 = 1 + xi2[first] * xi2[second] / 3;
    const double odd1 = (xi1[first] + xi1[second]) / 3, odd2 = (xi2[first] + xi2[second]) / 3;
    return (place->skew[0] * even1 * odd2 + place->skew[1] * even2 * odd1) / 16;
}
