/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Circles and patterns of cells as polygons, which are the outlines of electrodes
 * (outline_patterns.h).
 */
#include "outline_patterns.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double full_circle = 6.283185307179586476925287;
static const double degree = 6.283185307179586476925287 / 360;

/* ---- arcs ------------------------------------------------------------- */

enum { SIDES = 720 };

static void point_on_circle(const double centre[2], double radius, double angle, double point[2])
{
    point[0] = centre[0] + radius * cos(angle);
    point[1] = centre[1] + radius * sin(angle);
}

/*
 * Write the corners of a polygon that approximates an arc around a centre.
 *   angle [2]         in   directions of the first and the last corner (rad), in either order
 *   point [sides + 1] out  corners
 */
static void write_arc(const double centre[2], double radius, const double angle[2], size_t sides,
                      double (*point)[2])
{
    const double step = (angle[1] - angle[0]) / (double)sides;
    const double corner = radius * sqrt(step / sin(step));
    for (size_t i = 0; i <= sides; i++)
        point_on_circle(centre, corner, angle[0] + step * (double)i, point[i]);
}

int outline_circle(scene_outlines *outlines, const double centre[2], double radius, scene_at at)
{
    const double turn[2] = {0, full_circle * (SIDES - 1) / SIDES};
    scene_outline *outline = outline_append(outlines, at);
    double(*point)[2] = outline ? outline_polygon(outline, SIDES) : NULL;
    if (!point)
        return -1;
    write_arc(centre, radius, turn, SIDES - 1, point);
    return 0;
}

/* ---- hexagons --------------------------------------------------------- */

double outline_hexagon_size(const hexagon_pattern *pattern)
{
    return pattern->pitch - pattern->gap;
}

/*
 * Append a hexagon around a point. Its sides face the direction pattern->angle and the directions
 * at multiples of 60 degrees to it.
 */
static int add_hexagon(scene_outlines *outlines, const hexagon_pattern *pattern,
                       const double middle[2], scene_at at)
{
    scene_outline *outline = outline_append(outlines, at);
    double(*point)[2] = outline ? outline_polygon(outline, 6) : NULL;
    for (int k = 0; point && k < 6; k++)
        point_on_circle(middle, outline_hexagon_size(pattern) / sqrt(3),
                        degree * (pattern->angle + 30 + 60 * k), point[k]);
    return point ? 0 : -1;
}

int outline_hexagons(scene_outlines *outlines, const hexagon_pattern *pattern, scene_at at)
{
    int status = add_hexagon(outlines, pattern, pattern->centre, at);
    for (int ring = 1; ring <= pattern->rings; ring++)
        for (int k = 0; k < 6 * ring && status == 0; k++) {
            double corner[2], middle[2];
            const double angle = degree * (pattern->angle + 60.0 * (k / ring));
            point_on_circle(pattern->centre, ring * pattern->pitch, angle, corner);
            point_on_circle(corner, k % ring * pattern->pitch, angle + 120 * degree, middle);
            status = add_hexagon(outlines, pattern, middle, at);
        }
    return status;
}

/* ---- rectangles ------------------------------------------------------- */

double outline_grid_size(const grid_pattern *pattern)
{
    const double first = (pattern->to[0] - pattern->from[0]) / pattern->count[0],
                 second = (pattern->to[1] - pattern->from[1]) / pattern->count[1];
    return fmin(first, second) - pattern->gap;
}

/*
 * Compute corner k (0 to 3, counted counterclockwise) of the rectangular electrode with the indices
 * i and j in a grid of cells.
 */
static void grid_corner(const grid_pattern *pattern, int i, int j, int k, double point[2])
{
    const int cell[2] = {i, j}, is_high[2] = {k == 1 || k == 2, k >= 2};
    double middle[2], at[2];
    for (int direction = 0; direction < 2; direction++) {
        const double size = pattern->to[direction] - pattern->from[direction];
        const int line = cell[direction] + is_high[direction];
        middle[direction] = (pattern->from[direction] + pattern->to[direction]) / 2;
        at[direction] = pattern->from[direction] + size * line / pattern->count[direction];
        at[direction] += (is_high[direction] ? -0.5 : 0.5) * pattern->gap;
        point[direction] = at[direction];
    }
    if (pattern->angle == 0)
        return;
    const double cosine = cos(degree * pattern->angle), sine = sin(degree * pattern->angle);
    point[0] = middle[0] + cosine * (at[0] - middle[0]) - sine * (at[1] - middle[1]);
    point[1] = middle[1] + sine * (at[0] - middle[0]) + cosine * (at[1] - middle[1]);
}

int outline_grid(scene_outlines *outlines, const grid_pattern *pattern, scene_at at)
{
    for (int i = 0; i < pattern->count[0]; i++)
        for (int j = 0; j < pattern->count[1]; j++) {
            scene_outline *outline = outline_append(outlines, at);
            double(*point)[2] = outline ? outline_polygon(outline, 4) : NULL;
            if (!point)
                return -1;
            for (int k = 0; k < 4; k++)
                grid_corner(pattern, i, j, k, point[k]);
        }
    return 0;
}

/* ---- rings of keystones ----------------------------------------------- */

/*
 * Electrode in the shape of a keystone, a sector of a ring whose sides are moved inwards: inner and
 * outer radius, directions of its two radii, and distance of its straight sides from these radii.
 */
typedef struct keystone {
    double radius[2], angle[2], half_gap;
} keystone;

/*
 * Compute the electrode in sector k of a ring (keystone). Its straight sides are parallel to the
 * radii that bound the sector, half a gap inside. Its inner radius is that of the ring plus half a
 * gap (0 if the ring has none), and at least the distance from the centre where both sides meet.
 */
static keystone keystone_of(const ring_pattern *pattern, int ring, int k)
{
    const double half_gap = pattern->gap / 2, inner = pattern->radius[ring];
    const double angle = full_circle / pattern->sectors[ring];
    keystone stone = {
        {inner > 0 ? inner + half_gap : 0, pattern->radius[ring + 1] - half_gap},
        {degree * pattern->angle + k * angle, degree * pattern->angle + (k + 1) * angle},
        half_gap};
    if (pattern->sectors[ring] > 1)
        stone.radius[0] = fmax(stone.radius[0], half_gap / sin(angle / 2));
    return stone;
}

double outline_ring_size(const ring_pattern *pattern)
{
    double least = HUGE_VAL;
    for (int ring = 0; ring < pattern->rings; ring++) {
        const keystone stone = keystone_of(pattern, ring, 0);
        const double angle = stone.angle[1] - stone.angle[0];
        least = fmin(least, stone.radius[1] - stone.radius[0]);
        if (pattern->sectors[ring] > 1)
            least = fmin(least, 2 * stone.radius[1] * sin(angle / 2) - pattern->gap);
    }
    return least;
}

/*
 * The arc of the given radius around the centre of the rings meets both straight sides of a
 * keystone-shaped electrode. Compute the directions of the two meeting points, seen from the centre
 * (angle [2] out, rad).
 */
static void arc_ends(const keystone *stone, double radius, double angle[2])
{
    const double inset = radius > 0 ? asin(fmin(1, stone->half_gap / radius)) : 0;
    angle[0] = stone->angle[0] + inset;
    angle[1] = stone->angle[1] - inset;
}

static int greatest_divisor(int larger, int smaller)
{
    while (smaller > 0) {
        const int rest = larger % smaller;
        larger = smaller;
        smaller = rest;
    }
    return larger;
}

/*
 * Return the number of sides of a full circle in a pattern of rings. It is a common multiple of the
 * numbers of sectors of all rings if one below 20000 exists, so that the arcs of neighbouring rings
 * have their corners in common.
 */
static int pattern_sides(const ring_pattern *pattern)
{
    int sides = SIDES;
    for (int ring = 0; ring < pattern->rings; ring++) {
        const int sectors = pattern->sectors[ring];
        const int more = sectors / greatest_divisor(sides, sectors);
        sides *= sides * more < 20000 ? more : 1;
    }
    return sides;
}

/*
 * Append the polygon of a ring with one sector, which is a full annulus: the outer circle, then the
 * inner circle in the opposite direction, joined by a cut from one circle to the other.
 */
static int add_annulus(scene_outline *outline, const ring_pattern *pattern, const keystone *stone,
                       size_t sides)
{
    const bool has_hole = stone->radius[0] > 0;
    const double outwards[2] = {stone->angle[0], stone->angle[1]},
                 back[2] = {stone->angle[1], stone->angle[0]};
    double(*point)[2] = outline_polygon(outline, (sides + 1) * (has_hole ? 2 : 1));
    if (!point)
        return -1;
    write_arc(pattern->centre, stone->radius[1], outwards, sides, point);
    if (has_hole)
        write_arc(pattern->centre, stone->radius[0], back, sides, point + sides + 1);
    return 0;
}

static int add_keystone(scene_outline *outline, const ring_pattern *pattern, const keystone *stone,
                        size_t sides)
{
    double outer[2], inner[2];
    arc_ends(stone, stone->radius[1], outer);
    arc_ends(stone, stone->radius[0], inner);
    const bool is_pointed = !(inner[1] - inner[0] > 1e-9) || !(stone->radius[0] > 0);
    const double back[2] = {inner[1], inner[0]};
    double(*point)[2] = outline_polygon(outline, sides + 1 + (is_pointed ? 1 : sides + 1));
    if (!point)
        return -1;
    write_arc(pattern->centre, stone->radius[1], outer, sides, point);
    if (is_pointed)
        point_on_circle(pattern->centre, stone->radius[0], (inner[0] + inner[1]) / 2,
                        point[sides + 1]);
    else
        write_arc(pattern->centre, stone->radius[0], back, sides, point + sides + 1);
    return 0;
}

int outline_rings(scene_outlines *outlines, const ring_pattern *pattern, scene_at at)
{
    const int around = pattern_sides(pattern);
    for (int ring = 0; ring < pattern->rings; ring++)
        for (int k = 0; k < pattern->sectors[ring]; k++) {
            const int sectors = pattern->sectors[ring];
            const size_t sides = (size_t)((around + sectors - 1) / sectors);
            const keystone stone = keystone_of(pattern, ring, k);
            scene_outline *outline = outline_append(outlines, at);
            if (!outline)
                return -1;
            const int status = sectors == 1 ? add_annulus(outline, pattern, &stone, sides)
                                            : add_keystone(outline, pattern, &stone, sides);
            if (status < 0)
                return -1;
        }
    return 0;
}
