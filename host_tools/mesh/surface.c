/*
 * Reference surfaces (surface.h): plates, cylinders over a plane curve, surfaces of revolution.
 * A1 never depends on theta2: B2 = 0.
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

/* Growth of a spiral's radius per angle; 0 for the circular cylinder. */
static double growth(const scene_surface *s)
{
    return s->type == SURFACE_SPIRAL ? (s->outer - s->inner) / (full_turn * s->turns) : 0;
}

/*
 * Cylinder over the curve r(phi) = r + growth phi; its axis is theta1 (along x, phi = 0 on top,
 * towards +y) or theta2 (along z, phi = 0 on +x, towards +y).
 */
static surface_point cylinder_at(const scene_surface *s, double t1, double t2)
{
    surface_point p;
    memset(&p, 0, sizeof p);
    const int axis = s->axial - 1, round = 1 - axis;
    const double phi = axis == 0 ? t2 : t1, c = cos(phi), q = sin(phi), rise = growth(s);
    const double r = s->type == SURFACE_SPIRAL ? s->inner + rise * phi : s->radius,
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

/* A meridian at theta1: (radius, height) and its first two derivatives. */
typedef struct meridian {
    double x[2], d1[2], d2[2];
} meridian;

static meridian meridian_at(const scene_surface *s, double t)
{
    meridian m = {{t, 0}, {1, 0}, {0, 0}}; /* polar */
    const double c = cos(t), q = sin(t), slope = s->angle * degree;
    if (s->type == SURFACE_CONE) {
        const meridian cone = {
            {s->radius + t * sin(slope), -t * cos(slope)}, {sin(slope), -cos(slope)}, {0, 0}};
        m = cone;
    } else if (s->type == SURFACE_SPHERE) {
        const double r = s->radius;
        const meridian sphere = {{r * q, r * c}, {r * c, -r * q}, {-r * q, -r * c}};
        m = sphere;
    } else if (s->type == SURFACE_TORUS) {
        const double r = s->tube;
        const meridian torus = {{s->radius + r * c, -r * q}, {-r * q, -r * c}, {-r * c, r * q}};
        m = torus;
    } else if (s->type == SURFACE_HYPERBOLOID) {
        const double w = s->waist, z = t / s->height, root = sqrt(1 + z * z);
        const meridian hyperboloid = {{w * root, -t},
                                      {w * z / (root * s->height), -1},
                                      {w / (root * root * root * s->height * s->height), 0}};
        m = hyperboloid;
    } else if (s->type == SURFACE_REVOLUTION) {
        spline_at(s->meridian, t, m.x, m.d1, m.d2);
    }
    return m;
}

/* Surface of revolution about z, theta2 = azimuth; e3 to the left of the meridian seen as height
 * over radius. */
static surface_point revolution_at(const scene_surface *s, double t1, double t2)
{
    const meridian m = meridian_at(s, t1);
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

int surface_revolves(const scene_surface *s)
{
    return s->type != SURFACE_PLATE && s->type != SURFACE_CYLINDER && s->type != SURFACE_SPIRAL;
}

surface_point surface_at(const scene_surface *s, double theta1, double theta2)
{
    if (s->type == SURFACE_PLATE)
        return plate_at(theta1, theta2);
    return surface_revolves(s) ? revolution_at(s, theta1, theta2) : cylinder_at(s, theta1, theta2);
}

/* ---- area ------------------------------------------------------------- */

/* Integral of A1 A2 over one coordinate, by eight points of Gauss; the other one does not matter.
 */
static double gauss(const scene_surface *s, int direction, double from, double to)
{
    static const double point[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    const double middle = (from + to) / 2, half = (to - from) / 2;
    double sum = 0;
    for (int i = 0; i < 8; i++) {
        const double t = middle + (i & 1 ? half : -half) * point[i / 2];
        const surface_point p = surface_at(s, direction == 1 ? t : 0, direction == 2 ? t : 0);
        sum += weight[i / 2] * p.a[0] * p.a[1];
    }
    return half * sum;
}

/* The pieces between the knots of a spline are smooth, not the whole; long pieces are cut. */
static double integral(const scene_surface *s, int direction, const double t[2])
{
    enum { PIECES = 8 };
    double sum = 0, from = t[0];
    while (from < t[1]) {
        const double knot =
            s->type == SURFACE_REVOLUTION ? spline_next_knot(s->meridian, from) : t[1];
        const double to = knot < t[1] ? knot : t[1];
        for (int i = 0; i < PIECES; i++)
            sum += gauss(s, direction, from + (to - from) * i / PIECES,
                         from + (to - from) * (i + 1) / PIECES);
        from = to;
    }
    return sum;
}

double surface_area(const scene_surface *s, const double t1[2], const double t2[2])
{
    const double d1 = t1[1] - t1[0], d2 = t2[1] - t2[0], middle = (t1[0] + t1[1]) / 2;
    switch (s->type) {
    case SURFACE_POLAR: return middle * d1 * d2;
    case SURFACE_CYLINDER: return s->radius * d1 * d2;
    case SURFACE_CONE: return (s->radius + middle * sin(s->angle * degree)) * d1 * d2;
    case SURFACE_SPHERE: return s->radius * s->radius * 2 * sin(middle) * sin(d1 / 2) * d2;
    case SURFACE_TORUS:
        return s->tube * (s->radius * d1 + 2 * s->tube * cos(middle) * sin(d1 / 2)) * d2;
    case SURFACE_HYPERBOLOID:
    case SURFACE_REVOLUTION: return integral(s, 1, t1) * d2;
    case SURFACE_SPIRAL: return s->axial == 1 ? integral(s, 2, t2) * d1 : integral(s, 1, t1) * d2;
    case SURFACE_PLATE: break;
    }
    return d1 * d2;
}

/* ---- ranges ----------------------------------------------------------- */

int surface_closes(const scene_surface *s, int direction)
{
    if (s->type == SURFACE_CYLINDER)
        return direction == 3 - s->axial;
    return surface_revolves(s) && (direction == 2 || s->type == SURFACE_TORUS);
}

/* A spiral's angle runs along the coordinate that is not its axis. */
int surface_is_angle(const scene_surface *s, int direction)
{
    if (s->type == SURFACE_SPIRAL)
        return direction == 3 - s->axial;
    return surface_closes(s, direction) || s->type == SURFACE_SPHERE;
}

int surface_range(const scene_surface *s, int direction, double range[2])
{
    range[0] = 0;
    if (s->type == SURFACE_REVOLUTION && direction == 1) {
        range[1] = spline_length(s->meridian);
        return 1;
    }
    range[1] = full_turn * s->turns;
    return s->type == SURFACE_SPIRAL && direction == 3 - s->axial;
}
