/* SPDX-License-Identifier: BSD-2-Clause */
/* Points and areas of the plate (surface_types.h). */
#include "surface_types.h"

surface_point plate_at(const scene_surface *surface, double theta1, double theta2)
{
    const surface_point point = {
        {theta1, theta2, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 1}, {0, 0}, {0, 0}};
    (void)surface;
    return point;
}

double plate_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    (void)surface;
    return (t1[1] - t1[0]) * (t2[1] - t2[0]);
}
