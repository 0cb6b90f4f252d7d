/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Points, areas and coordinate ranges of reference surfaces (surface.h), by the functions in the
 * table SURFACE_TYPES (surface_types.h). The Lame parameter A1 (arc length per unit of theta1) of
 * these surfaces never depends on theta2.
 */
#include "surface.h"
#include "gauss.h"
#include "surface_types.h"

static const double full_turn = 6.283185307179586;

#define TYPE(type, word, keys, at, meridian, area, closed, angles, cure, help)                     \
    [type] = {at, meridian, area, closed, angles, cure},
static const surface_type types[] = {SURFACE_TYPES(TYPE)};
#undef TYPE

const surface_type *surface_type_of(const scene_surface *surface)
{
    return &types[surface->type];
}

int surface_revolves(const scene_surface *surface)
{
    return surface_type_of(surface)->meridian != NULL;
}

surface_point surface_at(const scene_surface *surface, double theta1, double theta2)
{
    return surface_type_of(surface)->at(surface, theta1, theta2);
}

/* ---- area of a surface ------------------------------------------------ */

/*
 * Integrate the area of a surface per unit of its coordinates theta1 and theta2 (the product of the
 * Lame parameters A1 and A2) over a short range of one coordinate. The integrand does not depend on
 * the other coordinate.
 */
static double integral_of_piece(const scene_surface *surface, int direction, double from, double to)
{
    double sum = 0;
    for (int i = 0; i < GAUSS_POINTS; i++) {
        const gauss_point point = gauss_point_at(i, from, to);
        const double theta1 = direction == 1 ? point.place : 0;
        const double theta2 = direction == 2 ? point.place : 0;
        const surface_point at = surface_at(surface, theta1, theta2);
        sum += point.weight * at.lame[0] * at.lame[1];
    }
    return sum;
}

/*
 * Integrate the area of a surface per unit of its coordinates theta1 and theta2 (the product of the
 * Lame parameters A1 and A2) over a range of one coordinate. The range is divided at the knots of a
 * spline, where the integrand is not smooth, and into short pieces.
 */
static double integral(const scene_surface *surface, int direction, const double range[2])
{
    enum { PIECES = 8 };
    double sum = 0, from = range[0];
    while (from < range[1]) {
        const double knot =
            surface->meridian ? spline_next_knot(surface->meridian, from) : range[1];
        const double to = knot < range[1] ? knot : range[1];
        for (int i = 0; i < PIECES; i++)
            sum += integral_of_piece(surface, direction, from + (to - from) * i / PIECES,
                                     from + (to - from) * (i + 1) / PIECES);
        from = to;
    }
    return sum;
}

double surface_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const surface_type *const type = surface_type_of(surface);
    if (type->area)
        return type->area(surface, t1, t2);
    if (surface_revolves(surface) || surface->axial == 2)
        return integral(surface, 1, t1) * (t2[1] - t2[0]);
    return integral(surface, 2, t2) * (t1[1] - t1[0]);
}

/* ---- ranges of surface coordinates ------------------------------------ */

/*
 * Return whether a set of surface coordinates contains theta1 (direction 1) or theta2 (direction
 * 2).
 *   set  in  sum of the bits ALONG_THETA1, ALONG_THETA2 and AROUND_AXIS. AROUND_AXIS stands for the
 *       angle around the axis of a cylinder or spiral, which is theta1 or theta2
 */
static int has_direction(const scene_surface *surface, int set, int direction)
{
    if (set & (direction == 1 ? ALONG_THETA1 : ALONG_THETA2))
        return 1;
    return set & AROUND_AXIS && direction == 3 - surface->axial;
}

int surface_closes(const scene_surface *surface, int direction)
{
    return has_direction(surface, surface_type_of(surface)->closed, direction);
}

int surface_is_angle(const scene_surface *surface, int direction)
{
    return has_direction(surface, surface_type_of(surface)->angles, direction);
}

int surface_range(const scene_surface *surface, int direction, double range[2])
{
    range[0] = 0;
    if (surface->meridian && direction == 1) {
        range[1] = spline_length(surface->meridian);
        return 1;
    }
    if (surface->type == SURFACE_POINTS) {
        range[0] = surface->points.from[direction - 1];
        range[1] = surface->points.to[direction - 1];
        return 1;
    }
    range[1] = full_turn * surface->turns;
    return surface->turns > 0 && direction == 3 - surface->axial;
}
