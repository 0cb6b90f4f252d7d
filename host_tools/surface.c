/* Reference surfaces (surface.h). Every one here has A1 constant and A2 a function of theta1 alone, so B2 = 0. */
#include "surface.h"
#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

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

/* A cylinder whose axis is theta1 (along x, theta2 = 0 on top) or theta2 (along z). */
static surface_point cylinder_at(const scene_surface *s, double t1, double t2)
{
    surface_point p;
    memset(&p, 0, sizeof p);
    const int axis = s->axial - 1, round = 1 - axis;
    const double phi = axis == 0 ? t2 : t1, c = cos(phi), q = sin(phi), r = s->radius;
    if (axis == 0) {
        set(p.x, t1, r * q, r * c);
        set(p.e[0], 1, 0, 0);
        set(p.e[1], 0, c, -q);
        set(p.e[2], 0, q, c);
    } else {
        set(p.x, r * c, r * q, t2);
        set(p.e[0], -q, c, 0);
        set(p.e[1], 0, 0, 1);
        set(p.e[2], c, q, 0);
    }
    p.a[axis] = 1;
    p.a[round] = r;
    p.k[round] = 1 / r;
    return p;
}

/*
 * Surface of revolution about z, theta2 = azimuth, from its meridian at theta1:
 * radius r, height z, angle psi of the outer normal above the horizontal plane.
 */
static surface_point revolution(double r, double z, double psi, double t2)
{
    const double c = cos(t2), q = sin(t2), cp = cos(psi), sp = sin(psi);
    surface_point p;
    memset(&p, 0, sizeof p);
    set(p.x, r * c, r * q, z);
    set(p.e[0], sp * c, sp * q, -cp);
    set(p.e[1], -q, c, 0);
    set(p.e[2], cp * c, cp * q, sp);
    p.a[0] = 1;
    p.a[1] = r;
    p.k[1] = cp / r;
    p.b[0] = sp / r;
    return p;
}

static surface_point polar_at(double r, double phi)
{
    surface_point p;
    memset(&p, 0, sizeof p);
    set(p.x, r * cos(phi), r * sin(phi), 0);
    set(p.e[0], cos(phi), sin(phi), 0);
    set(p.e[1], -sin(phi), cos(phi), 0);
    set(p.e[2], 0, 0, 1);
    p.a[0] = 1;
    p.a[1] = r;
    p.b[0] = 1 / r;
    return p;
}

static surface_point sphere_at(double radius, double t1, double t2)
{
    const double quarter = 1.5707963267948966;
    surface_point p = revolution(radius * sin(t1), radius * cos(t1), quarter - t1, t2);
    p.a[0] = radius;
    p.k[0] = 1 / radius;
    p.k[1] = 1 / radius;
    p.b[0] = cos(t1) / (radius * sin(t1));
    return p;
}

surface_point surface_at(const scene_surface *s, double theta1, double theta2)
{
    const double slope = s->angle * degree;
    switch (s->type) {
    case SURFACE_POLAR:
        return polar_at(theta1, theta2);
    case SURFACE_CYLINDER:
        return cylinder_at(s, theta1, theta2);
    case SURFACE_CONE:
        return revolution(s->radius + theta1 * sin(slope), -theta1 * cos(slope), slope, theta2);
    case SURFACE_SPHERE:
        return sphere_at(s->radius, theta1, theta2);
    case SURFACE_PLATE:
        break;
    }
    return plate_at(theta1, theta2);
}

double surface_area(const scene_surface *s, const double t1[2], const double t2[2])
{
    const double d1 = t1[1] - t1[0], d2 = t2[1] - t2[0], middle = (t1[0] + t1[1]) / 2;
    switch (s->type) {
    case SURFACE_POLAR:
        return middle * d1 * d2;
    case SURFACE_CYLINDER:
        return s->radius * d1 * d2;
    case SURFACE_CONE:
        return (s->radius + middle * sin(s->angle * degree)) * d1 * d2;
    case SURFACE_SPHERE:
        return s->radius * s->radius * 2 * sin(middle) * sin(d1 / 2) * d2;
    case SURFACE_PLATE:
        break;
    }
    return d1 * d2;
}

int surface_periodic(const scene_surface *s)
{
    switch (s->type) {
    case SURFACE_POLAR:
    case SURFACE_CONE:
    case SURFACE_SPHERE:
        return 2;
    case SURFACE_CYLINDER:
        return s->axial == 1 ? 2 : 1;
    case SURFACE_PLATE:
        break;
    }
    return 0;
}
