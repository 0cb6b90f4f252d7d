/* SPDX-License-Identifier: BSD-2-Clause */
/* Meridian of the paraboloid of revolution, the surface of a reflector (surface_types.h). */
#include "surface_types.h"

surface_meridian paraboloid_meridian(const scene_surface *surface, double theta1)
{
    const double four_f = 4 * surface->focal_length;
    const surface_meridian meridian = {
        {theta1, theta1 * theta1 / four_f}, {1, 2 * theta1 / four_f}, {0, 2 / four_f}};
    return meridian;
}
