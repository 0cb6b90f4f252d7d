/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference surfaces (surface.h): plates, cylinders over a plane curve, and surfaces of revolution.
 * A1 never depends on theta2, so that B2 = 0.
 */
#include "surface.h"
#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295, full_turn = 6.283185307179586;

static void set(double v[3], double x, double y, double z)
{
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

static surface_point plate_at(double t1, double t2)
{
    surface_point p = {{t1, t2, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 1}, {0, 0}, {0, 0}};
    return p;
}

/* Return the increase of the radius of a spiral per radian, or 0 for the circular cylinder. */
static double growth(const scene_surface *surface)
{
    return surface->type == SURFACE_SPIRAL
               ? (surface->outer - surface->inner) / (full_turn * surface->turns)
               : 0;
}

/*
 * Compute a point of a cylinder over the curve r(phi) = r + growth phi. The coordinate along the
 * axis is theta1 (axis along x; phi = 0 on top, increasing towards +y) or theta2 (axis along z;
 * phi = 0 on +x, increasing towards +y).
 */
static surface_point cylinder_at(const scene_surface *surface, double t1, double t2)
{
    surface_point p;
    memset(&p, 0, sizeof p);
    const int axis = surface->axial - 1, round = 1 - axis;
    const double phi = axis == 0 ? t2 : t1, c = cos(phi), q = sin(phi), rise = growth(surface);
    const double r = surface->type == SURFACE_SPIRAL ? surface->inner + rise * phi
                                                     : surface->radius,
                 length = hypot(r, rise);
    const double tangent[2] = {(rise * c - r * q) / length, (rise * q + r * c) / length};
    if (axis == 0) {
        set(p.x, t1, r * q, r * c);
        set(p.e[0], 1, 0, 0);
        set(p.e[1], 0, tangent[1], tangent[0]);
        set(p.e[2], 0, -tangent[0], tangent[1]);
    } else {
        set(p.x, r * c, r * q, t2);
        set(p.e[0], tangent[0], tangent[1], 0);
        set(p.e[1], 0, 0, 1);
        set(p.e[2], tangent[1], -tangent[0], 0);
    }
    p.a[axis] = 1;
    p.a[round] = length;
    p.k[round] = (r * r + 2 * rise * rise) / (length * length * length);
    return p;
}

/* Point of a meridian at theta1: (radius, height), and its first and second derivatives. */
typedef struct meridian {
    double x[2], d1[2], d2[2];
} meridian;

static meridian meridian_at(const scene_surface *surface, double t)
{
    meridian m = {{t, 0}, {1, 0}, {0, 0}}; /* polar coordinates of a plane */
    const double c = cos(t), q = sin(t), slope = surface->angle * degree;
    if (surface->type == SURFACE_CONE) {
        const meridian cone = {
            {surface->radius + t * sin(slope), -t * cos(slope)}, {sin(slope), -cos(slope)}, {0, 0}};
        m = cone;
    } else if (surface->type == SURFACE_SPHERE) {
        const double r = surface->radius;
        const meridian sphere = {{r * q, r * c}, {r * c, -r * q}, {-r * q, -r * c}};
        m = sphere;
    } else if (surface->type == SURFACE_TORUS) {
        const double r = surface->tube;
        const meridian torus = {
            {surface->radius + r * c, -r * q}, {-r * q, -r * c}, {-r * c, r * q}};
        m = torus;
    } else if (surface->type == SURFACE_HYPERBOLOID) {
        const double w = surface->waist, z = t / surface->height, root = sqrt(1 + z * z);
        const meridian hyperboloid = {
            {w * root, -t},
            {w * z / (root * surface->height), -1},
            {w / (root * root * root * surface->height * surface->height), 0}};
        m = hyperboloid;
    } else if (surface->type == SURFACE_REVOLUTION) {
        spline_at(surface->meridian, t, m.x, m.d1, m.d2);
    }
    return m;
}

/*
 * Compute a point of a surface of revolution about z with theta2 as the azimuth. e3 points to the
 * left of the meridian in a plot of height over radius.
 */
static surface_point revolution_at(const scene_surface *surface, double t1, double t2)
{
    const meridian m = meridian_at(surface, t1);
    const double c = cos(t2), q = sin(t2), length = hypot(m.d1[0], m.d1[1]), dr = m.d1[0] / length,
                 dz = m.d1[1] / length;
    surface_point p;
    memset(&p, 0, sizeof p);
    set(p.x, m.x[0] * c, m.x[0] * q, m.x[1]);
    set(p.e[0], dr * c, dr * q, dz);
    set(p.e[1], -q, c, 0);
    set(p.e[2], -dz * c, -dz * q, dr);
    p.a[0] = length;
    p.a[1] = m.x[0];
    p.k[0] = (dz * m.d2[0] - dr * m.d2[1]) / (length * length);
    p.k[1] = -dz / m.x[0];
    p.b[0] = dr / m.x[0];
    return p;
}

int surface_revolves(const scene_surface *surface)
{
    return surface->type != SURFACE_PLATE && surface->type != SURFACE_CYLINDER &&
           surface->type != SURFACE_SPIRAL;
}

surface_point surface_at(const scene_surface *surface, double theta1, double theta2)
{
    if (surface->type == SURFACE_PLATE)
        return plate_at(theta1, theta2);
    return surface_revolves(surface) ? revolution_at(surface, theta1, theta2)
                                     : cylinder_at(surface, theta1, theta2);
}

/* ---- area ------------------------------------------------------------- */

/*
 * Integrate A1 A2 over one coordinate by Gauss quadrature with eight points; the result does not
 * depend on the other coordinate.
 */
static double gauss(const scene_surface *surface, int direction, double from, double to)
{
    static const double point[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    const double middle = (from + to) / 2, half = (to - from) / 2;
    double sum = 0;
    for (int i = 0; i < 8; i++) {
        const double t = middle + (i & 1 ? half : -half) * point[i / 2];
        const double theta1 = direction == 1 ? t : 0;
        const double theta2 = direction == 2 ? t : 0;
        const surface_point p = surface_at(surface, theta1, theta2);
        sum += weight[i / 2] * p.a[0] * p.a[1];
    }
    return half * sum;
}

/*
 * Integrate A1 A2 over a range piece by piece, because a spline is smooth only between its knots;
 * long pieces are subdivided.
 */
static double integral(const scene_surface *surface, int direction, const double t[2])
{
    enum { PIECES = 8 };
    double sum = 0, from = t[0];
    while (from < t[1]) {
        const double knot =
            surface->type == SURFACE_REVOLUTION ? spline_next_knot(surface->meridian, from) : t[1];
        const double to = knot < t[1] ? knot : t[1];
        for (int i = 0; i < PIECES; i++)
            sum += gauss(surface, direction, from + (to - from) * i / PIECES,
                         from + (to - from) * (i + 1) / PIECES);
        from = to;
    }
    return sum;
}

double surface_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double d1 = t1[1] - t1[0], d2 = t2[1] - t2[0], middle = (t1[0] + t1[1]) / 2;
    switch (surface->type) {
    case SURFACE_POLAR: return middle * d1 * d2;
    case SURFACE_CYLINDER: return surface->radius * d1 * d2;
    case SURFACE_CONE: return (surface->radius + middle * sin(surface->angle * degree)) * d1 * d2;
    case SURFACE_SPHERE:
        return surface->radius * surface->radius * 2 * sin(middle) * sin(d1 / 2) * d2;
    case SURFACE_TORUS:
        return surface->tube *
               (surface->radius * d1 + 2 * surface->tube * cos(middle) * sin(d1 / 2)) * d2;
    case SURFACE_HYPERBOLOID:
    case SURFACE_REVOLUTION: return integral(surface, 1, t1) * d2;
    case SURFACE_SPIRAL:
        return surface->axial == 1 ? integral(surface, 2, t2) * d1 : integral(surface, 1, t1) * d2;
    case SURFACE_PLATE: break;
    }
    return d1 * d2;
}

/* ---- ranges ----------------------------------------------------------- */

int surface_closes(const scene_surface *surface, int direction)
{
    if (surface->type == SURFACE_CYLINDER)
        return direction == 3 - surface->axial;
    return surface_revolves(surface) && (direction == 2 || surface->type == SURFACE_TORUS);
}

/*
 * Return whether a coordinate is an angle. The angle of a spiral is the coordinate that is not
 * along its axis.
 */
int surface_is_angle(const scene_surface *surface, int direction)
{
    if (surface->type == SURFACE_SPIRAL)
        return direction == 3 - surface->axial;
    return surface_closes(surface, direction) || surface->type == SURFACE_SPHERE;
}

int surface_range(const scene_surface *surface, int direction, double range[2])
{
    range[0] = 0;
    if (surface->type == SURFACE_REVOLUTION && direction == 1) {
        range[1] = spline_length(surface->meridian);
        return 1;
    }
    range[1] = full_turn * surface->turns;
    return surface->type == SURFACE_SPIRAL && direction == 3 - surface->axial;
}
