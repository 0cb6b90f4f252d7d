/* SPDX-License-Identifier: BSD-2-Clause */
/* Voronoi areas of scattered points (point_area.h): their convex hull is cut by half-planes. */
#include "point_area.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct point {
    double x, y;
    size_t index;
} point;

/*
 * Convex polygon from which the Voronoi cell of a point is cut. Its memory has room for the corners
 * of the convex hull and one more corner for each cut.
 */
typedef struct polygon {
    size_t corners;
    double (*corner)[2];
} polygon;

/*
 * Return twice the area of a triangle; it is positive if the corners a, b, c run counterclockwise.
 */
static double turn(const point *a, const point *b, const point *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static int left_first(const void *left, const void *right)
{
    const point *first = left, *second = right;
    if (first->x != second->x)
        return first->x < second->x ? -1 : 1;
    return (first->y > second->y) - (first->y < second->y);
}

/*
 * Find the convex hull of points that are sorted by x, by the monotone chain algorithm (hull [2
 * count + 2] out). Returns the number of corners of the hull.
 */
static size_t hull_of(const point *sorted, size_t count, point *hull)
{
    size_t corners = 0;
    for (size_t i = 0; i < count; i++) {
        while (corners >= 2 && turn(&hull[corners - 2], &hull[corners - 1], &sorted[i]) <= 0)
            corners--;
        hull[corners++] = sorted[i];
    }
    const size_t lower = corners + 1;
    for (size_t i = count - 1; i-- > 0;) {
        while (corners >= lower && turn(&hull[corners - 2], &hull[corners - 1], &sorted[i]) <= 0)
            corners--;
        hull[corners++] = sorted[i];
    }
    return corners > 1 ? corners - 1 : corners;
}

static double area_of(const polygon *shape)
{
    double sum = 0;
    for (size_t i = 0; i < shape->corners; i++) {
        const double *from_corner = shape->corner[i],
                     *to_corner = shape->corner[(i + 1) % shape->corners];
        sum += from_corner[0] * to_corner[1] - from_corner[1] * to_corner[0];
    }
    return sum / 2;
}

/*
 * Copy the part of a convex polygon that lies in the half-plane normal . x <= limit to another
 * polygon; it has at most one corner more.
 */
static void cut(const polygon *from, const double normal[2], double limit, polygon *to)
{
    to->corners = 0;
    for (size_t i = 0; i < from->corners; i++) {
        const double *from_corner = from->corner[i],
                     *to_corner = from->corner[(i + 1) % from->corners];
        const double at_a = normal[0] * from_corner[0] + normal[1] * from_corner[1] - limit,
                     at_b = normal[0] * to_corner[0] + normal[1] * to_corner[1] - limit;
        if (at_a <= 0)
            memcpy(to->corner[to->corners++], from_corner, sizeof *to->corner);
        if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0)) {
            const double share = at_a / (at_a - at_b);
            to->corner[to->corners][0] = from_corner[0] + share * (to_corner[0] - from_corner[0]);
            to->corner[to->corners++][1] = from_corner[1] + share * (to_corner[1] - from_corner[1]);
        }
    }
}

/* Return the largest distance of a polygon's corners from a point. */
static double reach_of(const polygon *shape, const point *centre)
{
    double most = 0;
    for (size_t i = 0; i < shape->corners; i++)
        most = fmax(most, hypot(shape->corner[i][0] - centre->x, shape->corner[i][1] - centre->y));
    return most;
}

/*
 * Return the area of the Voronoi cell of one point within the convex hull; `cell` and `other` are
 * scratch polygons.
 */
static double cell_area(const point *points, size_t count, size_t own, const polygon *hull,
                        polygon *cell, polygon *other)
{
    double sharing = 1;
    const point *centre = &points[own];
    cell->corners = hull->corners;
    memcpy(cell->corner, hull->corner, hull->corners * sizeof *hull->corner);
    double reach = reach_of(cell, centre);
    /*
     * The points are sorted by x; the loop runs outwards from the centre of the Voronoi cell. A
     * point at more than twice the distance of the cell's farthest corner does not cut the cell.
     * The loop ends where this holds for x alone on both sides.
     */
    for (size_t step = 1; step < count; step++) {
        int is_near = 0;
        for (int side = 0; side < 2; side++) {
            if (side ? step > own : own + step >= count)
                continue;
            const point *neighbour = side ? &points[own - step] : &points[own + step];
            const double normal[2] = {neighbour->x - centre->x, neighbour->y - centre->y};
            is_near |= fabs(normal[0]) <= 2 * reach;
            if (normal[0] == 0 && normal[1] == 0)
                sharing++;
            else if (hypot(normal[0], normal[1]) <= 2 * reach) {
                const double middle[2] = {(centre->x + neighbour->x) / 2,
                                          (centre->y + neighbour->y) / 2};
                const polygon swap = *cell;
                cut(cell, normal, normal[0] * middle[0] + normal[1] * middle[1], other);
                *cell = *other;
                *other = swap;
                reach = reach_of(cell, centre);
            }
        }
        if (!is_near)
            break;
    }
    return area_of(cell) / sharing;
}

/*
 * Compute the lengths that belong to points on a line: half of the sum of the distances to the two
 * neighbours.
 */
static void lengths(const point *sorted, size_t count, double *area)
{
    for (size_t i = 0; i < count; i++)
        area[i] = 0;
    for (size_t i = 0; i + 1 < count; i++) {
        const double length = hypot(sorted[i + 1].x - sorted[i].x, sorted[i + 1].y - sorted[i].y);
        area[sorted[i].index] += length / 2;
        area[sorted[i + 1].index] += length / 2;
    }
}

static void areas(const point *sorted, size_t count, const polygon *hull, polygon work[2],
                  double *area)
{
    for (size_t i = 0; i < count; i++)
        area[sorted[i].index] = cell_area(sorted, count, i, hull, &work[0], &work[1]);
}

int point_areas(size_t count, double (*place)[3], double *area)
{
    point *sorted = calloc(count + 1, sizeof *sorted), *hull = calloc(2 * count + 3, sizeof *hull);
    double(*corner)[2] = calloc(3 * (2 * count + 3), sizeof *corner);
    const size_t room = 2 * count + 3;
    const int failed = !sorted || !hull || !corner ? -1 : 0;
    for (size_t i = 0; i < count && !failed; i++)
        sorted[i] = (point){place[i][0], place[i][1], i};
    if (!failed && count > 0) {
        qsort(sorted, count, sizeof *sorted, left_first);
        polygon shape = {hull_of(sorted, count, hull), corner};
        polygon work[2] = {{0, corner + room}, {0, corner + 2 * room}};
        for (size_t i = 0; i < shape.corners; i++) {
            corner[i][0] = hull[i].x;
            corner[i][1] = hull[i].y;
        }
        const double size =
            hypot(sorted[count - 1].x - sorted[0].x, sorted[count - 1].y - sorted[0].y);
        if (shape.corners < 3 || area_of(&shape) <= 1e-12 * size * size)
            lengths(sorted, count, area);
        else
            areas(sorted, count, &shape, work, area);
    }
    free(sorted);
    free(hull);
    free(corner);
    return failed;
}
