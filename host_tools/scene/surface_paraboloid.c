/* SPDX-License-Identifier: BSD-2-Clause */
/* The paraboloid of revolution, as of a reflector (surface_types.h). */
#include "surface_types.h"

surface_meridian paraboloid_meridian(const scene_surface *surface, double t)
{
    const double four_f = 4 * surface->focal_length;
    const surface_meridian m = {{t, t * t / four_f}, {1, 2 * t / four_f}, {0, 2 / four_f}};
    return m;
}
