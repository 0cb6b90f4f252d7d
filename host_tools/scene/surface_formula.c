/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Points and areas of reference surfaces that are given by formulas or fitted to points
 * (surface_formula.h).
 */
#include "surface_formula.h"
#include <math.h>
#include <string.h>
#include "expr_jet.h"
#include "gauss.h"
#include "surface_types.h"
#include "../quads/vector.h"

/*
 * Position in space of a point of a surface with its derivatives: `first` with respect to the
 * surface coordinates theta1 and theta2, `second` twice with respect to theta1 and twice with
 * respect to theta2.
 */
typedef struct place {
    double x[3], first[2][3], second[2][3];
} place;

/* Return the height z, with its derivatives, of a surface fitted to points, at given x and y. */
static expr_jet height_at(const bicubic *points, double x, double y)
{
    const bicubic_jet height = bicubic_at(points, x, y);
    expr_jet jet;
    jet.value = height.value;
    memcpy(jet.first, height.first, sizeof jet.first);
    memcpy(jet.second, height.second, sizeof jet.second);
    return jet;
}

/*
 * Return the position in space, with its derivatives, of the point of a surface at its coordinates
 * theta1 and theta2. Without a formula, x is theta1, y is theta2, and z is the height of the
 * surface fitted to points, or 0.
 */
static place place_at(const scene_surface *surface, double theta1, double theta2)
{
    expr_jet usual[3] = {
        {theta1, {1, 0}, {0, 0, 0}}, {theta2, {0, 1}, {0, 0, 0}}, {0, {0, 0}, {0, 0, 0}}};
    place at;
    if (surface->type == SURFACE_POINTS)
        usual[2] = height_at(&surface->points, theta1, theta2);
    for (int i = 0; i < 3; i++) {
        const expr *formula = surface->formula[i];
        const expr_jet jet = formula ? expr_jet_at(formula, theta1, theta2) : usual[i];
        at.x[i] = jet.value;
        for (int direction = 0; direction < 2; direction++) {
            at.first[direction][i] = jet.first[direction];
            at.second[direction][i] = jet.second[direction];
        }
    }
    return at;
}

int surface_is_general(const scene_surface *surface)
{
    return surface->type == SURFACE_FORMULA || surface->type == SURFACE_POINTS;
}

surface_point formula_at(const scene_surface *surface, double theta1, double theta2)
{
    const place at = place_at(surface, theta1, theta2);
    surface_point point;
    memset(&point, 0, sizeof point);
    memcpy(point.position, at.x, sizeof point.position);
    memcpy(point.triad[0], at.first[0], sizeof point.triad[0]);
    point.lame[0] = vector_normalise(point.triad[0]);
    point.lame[1] = sqrt(vector_dot(at.first[1], at.first[1]));
    vector_cross(at.first[0], at.first[1], point.triad[2]);
    const double normal = vector_normalise(point.triad[2]);
    vector_cross(point.triad[2], point.triad[0], point.triad[1]);
    for (int direction = 0; direction < 2; direction++)
        point.curvature[direction] = normal > 0
                                         ? -vector_dot(point.triad[2], at.second[direction]) /
                                               (point.lame[direction] * point.lame[direction])
                                         : (double)NAN; /* The curvature is undefined where the
                                                           surface has no normal. */
    return point;
}

void surface_formula_turn(const scene_surface *surface, const double theta[2], surface_point *point)
{
    const place at = place_at(surface, theta[0], theta[1]);
    memcpy(point->triad[1], at.first[1], sizeof point->triad[1]);
    vector_normalise(point->triad[1]);
    vector_cross(point->triad[1], point->triad[2], point->triad[0]);
}

double surface_formula_cosine(const scene_surface *surface, double theta1, double theta2)
{
    const place at = place_at(surface, theta1, theta2);
    return vector_dot(at.first[0], at.first[1]) /
           sqrt(vector_dot(at.first[0], at.first[0]) * vector_dot(at.first[1], at.first[1]));
}

/* Return the area of a surface per unit of its coordinates theta1 and theta2. */
static double density(const scene_surface *surface, double theta1, double theta2)
{
    const place at = place_at(surface, theta1, theta2);
    double normal[3];
    vector_cross(at.first[0], at.first[1], normal);
    return sqrt(vector_dot(normal, normal));
}

double formula_area(const scene_surface *surface, const double theta1[2], const double theta2[2])
{
    double sum = 0;
    for (int i = 0; i < GAUSS_POINTS; i++)
        for (int j = 0; j < GAUSS_POINTS; j++) {
            const gauss_point along1 = gauss_point_at(i, theta1[0], theta1[1]);
            const gauss_point along2 = gauss_point_at(j, theta2[0], theta2[1]);
            sum += along1.weight * along2.weight * density(surface, along1.place, along2.place);
        }
    return sum;
}
