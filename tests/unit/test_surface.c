/*
 * Laws of reference surfaces, of splines and of the unknowns a mesh prescribes.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/mesh/mesh.h"
#include "../../host_tools/scene/gauss.h"

static const double pi = 3.14159265358979323846;
static char file[] = "/tmp/test_surface_XXXXXX";

static void check(const char *what, double got, double expected, double tolerance)
{
    if (!(fabs(got - expected) <= tolerance))
        fail_msg("%s: %.15g, expected %.15g within %.3g", what, got, expected, tolerance);
}

/* ---- surfaces --------------------------------------------------------- */

enum { POINTS = 25 };

static void circle_points(double point[POINTS][2])
{
    for (int i = 0; i < POINTS; i++) {
        const double a = (10 * i - 120) * pi / 180;
        point[i][0] = 200 + 50 * cos(a);
        point[i][1] = -50 * sin(a);
    }
}

typedef struct sample {
    const char *name;
    scene_surface surface;
    double theta[2][2]; /* a rectangle away from knots */
} sample;

#define SURFACE(type_, ...)                                                                        \
    {                                                                                              \
        .type = type_, __VA_ARGS__                                                                 \
    }

static const sample samples[] = {
    {"plate", SURFACE(SURFACE_PLATE, .radius = 0), {{0.3, 0.9}, {0.2, 1.1}}},
    {"polar", SURFACE(SURFACE_POLAR, .radius = 0), {{0.3, 0.9}, {0.2, 1.1}}},
    {"cylinder, axis theta1",
     SURFACE(SURFACE_CYLINDER, .radius = 1.7, .axial = 1),
     {{0.3, 0.9}, {0.2, 1.1}}},
    {"cylinder, axis theta2",
     SURFACE(SURFACE_CYLINDER, .radius = 1.7, .axial = 2),
     {{0.3, 0.9}, {0.2, 1.1}}},
    {"cone", SURFACE(SURFACE_CONE, .radius = 1.7, .angle = 30), {{0.3, 0.9}, {0.2, 1.1}}},
    {"sphere", SURFACE(SURFACE_SPHERE, .radius = 1.7), {{0.3, 0.9}, {0.2, 1.1}}},
    {"hyperboloid",
     SURFACE(SURFACE_HYPERBOLOID, .waist = 1.5, .height = 2.3),
     {{-0.3, 0.9}, {0.2, 1.1}}},
    {"torus, outside", SURFACE(SURFACE_TORUS, .radius = 4, .tube = 1.1), {{-0.3, 0.9}, {0.2, 1.1}}},
    {"torus, inside", SURFACE(SURFACE_TORUS, .radius = 4, .tube = 1.1), {{2.2, 3.7}, {0.2, 1.1}}},
    {"spiral, axis theta1",
     SURFACE(SURFACE_SPIRAL, .inner = 1.5, .outer = 15, .turns = 4, .axial = 1),
     {{0.3, 0.9}, {1.2, 2.1}}},
    {"spiral, axis theta2",
     SURFACE(SURFACE_SPIRAL, .inner = 1.5, .outer = 15, .turns = 4, .axial = 2),
     {{1.3, 1.9}, {0.2, 1.1}}},
    {"paraboloid", SURFACE(SURFACE_PARABOLOID, .focal_length = 0.6), {{0.3, 0.9}, {0.2, 1.1}}},
    {"revolution", SURFACE(SURFACE_REVOLUTION, .radius = 0), {{35.5, 42}, {0.2, 1.1}}},
};
enum { SAMPLES = sizeof samples / sizeof *samples };

/* The surface of a sample; the one of revolution has the meridian of a torus. Releases nothing
 * else. */
static scene_surface open_surface(const sample *s)
{
    double point[POINTS][2];
    scene_surface surface = s->surface;
    circle_points(point);
    if (surface.type == SURFACE_REVOLUTION)
        surface.meridian = spline_fit(POINTS, (const double(*)[2])point, NULL, 0);
    return surface;
}

static surface_point moved(const scene_surface *s, const double t[2], int a, double by)
{
    return surface_at(s, t[0] + (a == 0 ? by : 0), t[1] + (a == 1 ? by : 0));
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* e1, e2, e3 are a right-handed orthonormal triad. */
static void check_triad(const char *name, const surface_point *p)
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int b = 0; b < 3; b++)
            check(name, dot(p->triad[i], p->triad[b]), i == b, 1e-15 * 4);
        check(name, p->triad[2][i],
              p->triad[0][j] * p->triad[1][k] - p->triad[0][k] * p->triad[1][j], 1e-15 * 4);
    }
}

/*
 * x,a = A_a e_a;  e3,a = A_a k_a e_a;  B1 = A2,1/(A1 A2), B2 = A1,2/(A1 A2), all by central
 * differences of fourth order: their error is that of rounding over the step, 1e-15 size / step,
 * and (step / size)^4.
 */
static void check_derivatives(const char *name, const scene_surface *s, const double t[2])
{
    const surface_point p = surface_at(s, t[0], t[1]);
    for (int a = 0; a < 2; a++) {
        const double size = s->type == SURFACE_REVOLUTION && a == 0 ? 50 : 1, h = 1e-3 * size;
        const surface_point q[4] = {moved(s, t, a, h), moved(s, t, a, -h), moved(s, t, a, 2 * h),
                                    moved(s, t, a, -2 * h)};
        const double far = fabs(p.position[0]) + fabs(p.position[1]) + fabs(p.position[2]) + 1,
                     rounding = 1e-11 * far / size;
        for (int i = 0; i < 3; i++) {
            const double x = (8 * (q[0].position[i] - q[1].position[i]) -
                              (q[2].position[i] - q[3].position[i])) /
                             (12 * h);
            const double n = (8 * (q[0].triad[2][i] - q[1].triad[2][i]) -
                              (q[2].triad[2][i] - q[3].triad[2][i])) /
                             (12 * h);
            check(name, p.lame[a] * p.triad[a][i], x, rounding);
            check(name, p.lame[a] * p.curvature[a] * p.triad[a][i], n, 1e-11);
        }
        const double other =
            (8 * (q[0].lame[1 - a] - q[1].lame[1 - a]) - (q[2].lame[1 - a] - q[3].lame[1 - a])) /
            (12 * h);
        check(name, p.geodesic[a] * p.lame[0] * p.lame[1], other, rounding);
    }
}

/* Position, triad, metric and curvatures of every surface belong together. */
static void test_geometry(void **state)
{
    (void)state;
    for (int k = 0; k < SAMPLES; k++) {
        scene_surface s = open_surface(&samples[k]);
        for (int i = 0; i < 9; i++) {
            const double t[2] = {
                samples[k].theta[0][0] +
                    (samples[k].theta[0][1] - samples[k].theta[0][0]) * (i / 3 + 0.5) / 3,
                samples[k].theta[1][0] +
                    (samples[k].theta[1][1] - samples[k].theta[1][0]) * (i % 3 + 0.5) / 3};
            const surface_point p = surface_at(&s, t[0], t[1]);
            check_triad(samples[k].name, &p);
            check_derivatives(samples[k].name, &s, t);
        }
        spline_free(s.meridian);
    }
}

/* Law: the quadrature is exact for powers up to 15, and for the next one it is not. */
static void test_quadrature(void **state)
{
    const double from = -0.5, to = 2;
    (void)state;
    for (int power = 0; power <= 16; power++) {
        const double exact = (pow(to, power + 1) - pow(from, power + 1)) / (power + 1);
        double sum = 0;
        for (int i = 0; i < GAUSS_POINTS; i++) {
            const gauss_point point = gauss_point_at(i, from, to);
            sum += point.weight * pow(point.place, power);
        }
        if (power < 16)
            check("power", sum, exact, GAUSS_POINTS * power * 2.3e-16 * exact + 2e-15);
        else if (fabs(sum - exact) < 1e-9 * exact)
            fail_msg("power 16 is integrated exactly");
    }
}

/* The area is the integral of A1 A2: midpoint sums extrapolated twice. */
static void test_area(void **state)
{
    (void)state;
    for (int k = 0; k < SAMPLES; k++) {
        const sample *m = &samples[k];
        scene_surface s = open_surface(m);
        double sum[3];
        for (int r = 0; r < 3; r++) {
            const int n = 64 << r;
            const double d1 = (m->theta[0][1] - m->theta[0][0]) / n,
                         d2 = (m->theta[1][1] - m->theta[1][0]) / n;
            sum[r] = 0;
            for (int i = 0; i < n * n; i++) {
                const surface_point p = surface_at(&s, m->theta[0][0] + (i / n + 0.5) * d1,
                                                   m->theta[1][0] + (i % n + 0.5) * d2);
                sum[r] += p.lame[0] * p.lame[1] * d1 * d2;
            }
        }
        for (int r = 0; r < 2; r++)
            sum[r] = (4 * sum[r + 1] - sum[r]) / 3;
        const double expected = (16 * sum[1] - sum[0]) / 15;
        /* 256 x 256 terms rounded; the second derivative of a spline has kinks, where midpoint sums
         * gain less */
        check(m->name, surface_area(&s, m->theta[0], m->theta[1]), expected,
              (m->surface.type == SURFACE_REVOLUTION ? 1e-8 : 256 * 256 * 2.2e-16) * expected);
        spline_free(s.meridian);
    }
}

/* The area of a spline's surface over a range is the sum of those of its parts, wherever it is cut.
 */
static void test_area_parts(void **state)
{
    const sample *m = &samples[SAMPLES - 1];
    scene_surface s = open_surface(m);
    const double whole[2] = {3.3, 101.7}, low[2] = {3.3, 40.123}, high[2] = {40.123, 101.7},
                 turn[2] = {0, 1};
    (void)state;
    const double area = surface_area(&s, whole, turn);
    check(m->name, surface_area(&s, low, turn) + surface_area(&s, high, turn), area, 1e-13 * area);
    spline_free(s.meridian);
}

/* e3 of a paraboloid points towards the focus, along the line that reflects a ray from above. */
static void test_reflector(void **state)
{
    const scene_surface s = {.type = SURFACE_PARABOLOID, .focal_length = 0.6};
    (void)state;
    for (int k = 1; k < 9; k++) {
        const surface_point p = surface_at(&s, 0.2 * k, 0.7 * k);
        const double ray[3] = {0, 0, -1}, along = dot(ray, p.triad[2]);
        const double way = (p.position[2] - s.focal_length) / hypot(p.position[0], p.position[1]);
        double out[3];
        for (int i = 0; i < 3; i++)
            out[i] = ray[i] - 2 * along * p.triad[2][i];
        check("height of the reflected ray over its way to the axis",
              -out[2] / hypot(out[0], out[1]), way, 1e-14 * (1 + fabs(way)));
        assert_true(p.triad[2][2] > 0 && out[0] * p.position[0] + out[1] * p.position[1] < 0);
    }
}

/* e3 of closed surfaces points away from the axis, the tube's axis, or the centre. */
static void test_outside(void **state)
{
    (void)state;
    for (int k = 0; k < SAMPLES; k++) {
        scene_surface s = open_surface(&samples[k]);
        const double t[2] = {samples[k].theta[0][0], samples[k].theta[1][0]};
        const surface_point p = surface_at(&s, t[0], t[1]);
        const double meridian = s.type == SURFACE_REVOLUTION ? 200 : 0;
        const double tube = s.type == SURFACE_TORUS ? s.radius : meridian;
        const int axis =
            (s.type == SURFACE_CYLINDER || s.type == SURFACE_SPIRAL) && s.axial == 1 ? 0 : 2;
        double away[3] = {p.position[0], p.position[1], p.position[2]};
        if (s.type != SURFACE_PLATE && s.type != SURFACE_POLAR && s.type != SURFACE_PARABOLOID) {
            for (int i = 0; i < 2 && tube > 0; i++)
                away[i] -= tube * (i == 0 ? cos(t[1]) : sin(t[1]));
            if (tube == 0 && s.type != SURFACE_SPHERE)
                away[axis] = 0;
            assert_true(dot(away, p.triad[2]) > 0);
        }
        spline_free(s.meridian);
    }
}

/* ---- splines ---------------------------------------------------------- */

static double curvature(const spline *s, double t)
{
    double x[2], d1[2], d2[2];
    spline_at(s, t, x, d1, d2);
    return (d1[1] * d2[0] - d1[0] * d2[1]) / pow(hypot(d1[0], d1[1]), 3);
}

/* Through 25 points of a circle: k R at the first nodes of 48 elements as scipy's CubicSpline has
 * it, alike at both ends. */
static void test_not_a_knot(void **state)
{
    static const int node[] = {0, 1, 2, 3, 24};
    static const double expected[] = {1.02086826, 1.00566140, 0.99747432, 0.99687880, 1.00255142};
    double point[POINTS][2], x[2], d1[2], d2[2];
    (void)state;
    circle_points(point);
    spline *s = spline_fit(POINTS, (const double(*)[2])point, NULL, 0);
    const double length = spline_length(s);
    check("length", length, 24 * 100 * sin(5 * pi / 180), 1e-11);
    for (int i = 0; i < 5; i++) {
        check("k R", 50 * curvature(s, length * node[i] / 48), expected[i], 1e-8);
        check("k R", 50 * curvature(s, length * (48 - node[i]) / 48), expected[i], 1e-8);
    }
    for (int i = 0; i < POINTS; i++) {
        spline_at(s, length * i / (POINTS - 1), x, d1, d2);
        check("r", x[0], point[i][0], 1e-11);
        check("z", x[1], point[i][1], 1e-11);
    }
    spline_free(s);
}

/* A straight line is its own spline, with either ends, any spacing, any smoothing; rounding grows
 * by (L/h)^2 lambda/L^3. */
static void test_reproduction(void **state)
{
    static const double at[] = {0, 0.7, 1, 2.1, 2.9, 3};
    enum { N = sizeof at / sizeof *at };
    const double rounding = 2.2e-16 * 900 * 37;
    double point[N][2], tangent[2][2] = {{3, 4}, {30, 40}}, x[2], d1[2], d2[2];
    (void)state;
    for (int i = 0; i < N; i++) {
        point[i][0] = 1 + 0.6 * at[i];
        point[i][1] = 2 + 0.8 * at[i];
    }
    for (int k = 0; k < 4; k++) {
        spline *s = spline_fit(N, (const double(*)[2])point,
                               k & 1 ? (const double(*)[2])tangent : NULL, k & 2 ? 1e3 : 0);
        for (int i = 0; i <= 20; i++) {
            spline_at(s, 0.15 * i, x, d1, d2);
            check("r", x[0], 1 + 0.09 * i, rounding);
            check("z", x[1], 2 + 0.12 * i, rounding);
            check("r'", d1[0], 0.6, rounding);
            check("z''", d2[1], 0, rounding);
        }
        spline_free(s);
    }
}

/* sum |p - s|^2 + lambda integral |s''|^2, by Gauss' two points, exact for a square of a line */
static double functional(const spline *s, int n, const double (*point)[2], const double *t,
                         double lambda)
{
    double sum = 0, x[2], d1[2], d2[2];
    for (int i = 0; i < n; i++) {
        spline_at(s, t[i], x, d1, d2);
        sum += pow(x[0] - point[i][0], 2) + pow(x[1] - point[i][1], 2);
        for (int g = -1; g <= 1 && i > 0; g += 2) {
            spline_at(s, (t[i] + t[i - 1]) / 2 + g * (t[i] - t[i - 1]) / sqrt(12), x, d1, d2);
            sum += lambda * (t[i] - t[i - 1]) / 2 * (d2[0] * d2[0] + d2[1] * d2[1]);
        }
    }
    return sum;
}

/*
 * The smoothed curve has the least functional among not-a-knot splines on its knots, its neighbours
 * of other lambda have more; its end is that of a dense solution by numpy.
 */
static void test_smoothing(void **state)
{
    static const double lambda[] = {100, 1000, 1e5}, end[][2] = {{174.9314318, 43.4908863},
                                                                 {174.7743934, 44.2657883},
                                                                 {180.8830108, 55.9217417}};
    double point[POINTS][2], t[POINTS], x[2], d1[2], d2[2];
    (void)state;
    circle_points(point);
    for (int i = 0; i < POINTS; i++)
        t[i] = 100 * sin(5 * pi / 180) * i;
    for (int k = 0; k < 3; k++) {
        spline *s = spline_fit(POINTS, (const double(*)[2])point, NULL, lambda[k]);
        const double least = functional(s, POINTS, (const double(*)[2])point, t, lambda[k]);
        spline_at(s, 0, x, d1, d2);
        check("r of the end", x[0], end[k][0], 1e-6);
        check("z of the end", x[1], end[k][1], 1e-6);
        for (int j = -1; j <= 1; j += 2) {
            spline *other =
                spline_fit(POINTS, (const double(*)[2])point, NULL, lambda[k] * (1 + j * 0.01));
            assert_true(functional(other, POINTS, (const double(*)[2])point, t, lambda[k]) > least);
            spline_free(other);
        }
        spline_free(s);
    }
}

/* The unit of length does not matter: points times c, lambda times c^3, curve times c. */
static void test_units(void **state)
{
    double point[POINTS][2], scaled[POINTS][2], x[2], y[2], d1[2], d2[2];
    (void)state;
    circle_points(point);
    for (int k = -12; k <= 12; k += 8) {
        const double c = pow(10, k);
        for (int i = 0; i < POINTS; i++)
            for (int a = 0; a < 2; a++)
                scaled[i][a] = c * point[i][a];
        spline *s = spline_fit(POINTS, (const double(*)[2])point, NULL, 50);
        spline *q = spline_fit(POINTS, (const double(*)[2])scaled, NULL, 50 * c * c * c);
        for (int i = 0; i <= 10; i++) {
            spline_at(s, 20.0 * i, x, d1, d2);
            spline_at(q, 20.0 * i * c, y, d1, d2);
            check("r", y[0] / c, x[0], 1e-10);
            check("z", y[1] / c, x[1], 1e-10);
        }
        spline_free(s);
        spline_free(q);
    }
}

/* No curve: neighbours that coincide, not a number. */
static void test_no_spline(void **state)
{
    const double twice[4][2] = {{1, 0}, {2, 0}, {2, 0}, {3, 0}},
                 nothing[4][2] = {{1, 0}, {(double)NAN, 0}, {2, 0}, {3, 0}};
    (void)state;
    assert_null(spline_fit(4, twice, NULL, 0));
    assert_null(spline_fit(4, nothing, NULL, 0));
}

/* ---- meshes ----------------------------------------------------------- */

static const char *const plate =
    "name: t\nkinematics: nonlinear\ndof_per_node: 7\nsurface: {type: plate}\n"
    "mesh: {theta1: {from: 0, to: 2, elements: 2}, theta2: {from: 0, to: 1, elements: 1}}\n"
    "materials: {m: {E: 1, nu: 0}}\nlayers: [{material: m, thickness: 0.1}]\n";

static int build(mesh *m, scene *s, const char *start, const char *rest, char *error)
{
    FILE *out = fopen(file, "wb");
    assert_non_null(out);
    fprintf(out, "%s%s\n", start, rest);
    fclose(out);
    if (scene_read(s, file, NULL, 0, error) != 0)
        fail_msg("%s", error);
    return mesh_build(m, s, error);
}

/* Prescribed unknowns stay numbered; u3 moves both faces alike: mean by the value, difference and
 * seventh held. */
static void test_prescribed(void **state)
{
    char error[SCENE_ERROR];
    scene s;
    mesh m;
    (void)state;
    assert_int_equal(build(&m, &s, plate,
                           "supports: [{edge: theta1-, fix: clamped}, {edge: theta1+, fix: [u3, u1 "
                           "difference], value: 0.5+theta2*x}]",
                           error),
                     0);
    assert_int_equal(m.free_dof, 2 * 7 + 2 * 5);
    assert_int_equal(m.prescribed_count, 4);
    for (int j = 0; j < 2; j++) {
        const int node = mesh_node(&m, 2, j);
        int found = 0;
        for (int k = 0; k < m.prescribed_count; k++)
            if (m.prescribed_dof[k] == m.node_dof[node * 7 + 2] ||
                m.prescribed_dof[k] == m.node_dof[node * 7 + 3]) {
                check("value", m.prescribed_value[k], 0.5 + 2 * j, 1e-15);
                found++;
            }
        assert_int_equal(found, 2);
        assert_int_equal(m.node_dof[node * 7 + 5], PZS_CONSTRAINED);
        assert_int_equal(m.node_dof[node * 7 + 6], PZS_CONSTRAINED);
    }
    for (int k = 1; k < m.prescribed_count; k++)
        assert_true(m.prescribed_dof[k] > m.prescribed_dof[k - 1]);
    mesh_free(&m);
    scene_free(&s);
    assert_int_equal(build(&m, &s, plate, "supports: [{edge: theta1-, fix: clamped}]", error), 0);
    assert_int_equal(m.prescribed_count, 0);
    mesh_free(&m);
    scene_free(&s);
}

/* Two supports may agree, never contradict; a value must be finite. */
static void test_contradictions(void **state)
{
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"supports: [{edge: theta1-, fix: u3, value: x}, {edge: theta1-, fix: u3}, {edge: theta2-, "
         "fix: u3, value: x}]",
         NULL},
        {"supports:\n- {edge: theta1-, fix: u3}\n- {at: nodes, fix: u3, value: 1}",
         ":10:3: at theta1 = 0, theta2 = 0 another support prescribes 0 and this one 1; remove "
         "one"},
        {"supports:\n- {edge: theta1+, fix: u3 mean, value: y}\n- {at: nodes, fix: u3 mean}",
         ":10:3: at theta1 = 2, theta2 = 1 another support prescribes 1 and this one 0; remove "
         "one"},
        {"supports:\n- {at: nodes, fix: u3, value: 1/x}",
         ":9:3: the value of the support is not a finite number at theta1 = 0, theta2 = 0; correct "
         "its "
         "formula"},
    };
    char error[SCENE_ERROR];
    scene s;
    mesh m;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = build(&m, &s, plate, cases[i].text, error);
        if ((status == 0) != (cases[i].expected == NULL) ||
            (status != 0 && !strstr(error, cases[i].expected)))
            fail_msg("%s: %s", cases[i].text, status == 0 ? "no fault" : error);
        if (status == 0)
            mesh_free(&m);
        scene_free(&s);
    }
}

/* A full turn closes on itself in every direction the surface does, unless it is slit. */
static void test_closing(void **state)
{
    static const struct {
        const char *surface, *theta1, *theta2;
        int lines[2];
    } cases[] = {
        {"{type: torus, radius: 5, tube: 1}",
         "{from: -pi, to: pi, elements: 6}",
         "{from: 0, to: 2*pi, elements: 8}",
         {6, 8}},
        {"{type: torus, radius: 5, tube: 1}",
         "{from: -pi, to: pi, elements: 6, slit: true}",
         "{from: 0, to: 6, elements: 8}",
         {7, 9}},
        {"{type: polar}",
         "{from: 1, to: 2, elements: 2}",
         "{from: 0, to: 2*pi, elements: 8, slit: true}",
         {3, 9}},
        {"{type: polar}",
         "{from: 1, to: 2, elements: 2}",
         "{from: 0, to: 2*pi, elements: 8, slit: no}",
         {3, 8}},
        {"{type: hyperboloid, waist: 1, height: 1}",
         "{from: 0, to: 2*pi, elements: 2}",
         "{from: -pi, to: pi, elements: 8}",
         {3, 8}},
        {"{type: spiral, inner: 1, outer: 2, turns: 2, axial: theta1}",
         "{from: 0, to: 2, elements: 2}",
         "{elements: 8}",
         {3, 9}},
        {"{type: spiral, inner: 1, outer: 2, turns: 1, axial: theta2}",
         "{to: 2*pi, elements: 8}",
         "{from: 0, to: 2*pi, elements: 2}",
         {9, 3}},
        {"{type: revolution, meridian: [[5, 0], [6, -1], [6, -2], [5, -3]]}",
         "{elements: 6}",
         "{from: -pi, to: pi, elements: 4, centre: 0.3}",
         {7, 4}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char start[600], error[SCENE_ERROR];
        scene s;
        mesh m;
        snprintf(
            start, sizeof start,
            "name: t\nsurface: %s\nmesh: {theta1: %s, theta2: %s}\nmaterials: {m: {E: 1, nu: 0}}\n"
            "layers: [{material: m, thickness: 0.1}]\n",
            cases[i].surface, cases[i].theta1, cases[i].theta2);
        if (build(&m, &s, start, "", error) != 0)
            fail_msg("%s", error);
        if (m.lines[0] != cases[i].lines[0] || m.lines[1] != cases[i].lines[1])
            fail_msg("%s: %d x %d lines", cases[i].surface, m.lines[0], m.lines[1]);
        mesh_free(&m);
        scene_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_geometry),     cmocka_unit_test(test_area),
        cmocka_unit_test(test_area_parts),   cmocka_unit_test(test_reflector),
        cmocka_unit_test(test_outside),      cmocka_unit_test(test_not_a_knot),
        cmocka_unit_test(test_reproduction), cmocka_unit_test(test_smoothing),
        cmocka_unit_test(test_units),        cmocka_unit_test(test_no_spline),
        cmocka_unit_test(test_prescribed),   cmocka_unit_test(test_contradictions),
        cmocka_unit_test(test_closing),      cmocka_unit_test(test_quadrature),
    };
    const int descriptor = mkstemp(file);
    if (descriptor < 0)
        return 1;
    close(descriptor);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(file);
    return failed;
}
