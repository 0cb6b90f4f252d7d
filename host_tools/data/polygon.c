/* SPDX-License-Identifier: BSD-2-Clause */
/* Areas, parts and intersections of polygons in a plane (polygon.h). */
#include "polygon.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- areas ------------------------------------------------------------ */

/*
 * Return twice the area of a triangle; it is positive if the corners a, b, c run counterclockwise.
 */
static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/*
 * The area and the first moments of a polygon are signed sums over the triangles between the origin
 * and each of its sides.
 */
polygon_sums polygon_sums_of(const double (*point)[2], size_t count, const double origin[2])
{
    polygon_sums sums = {0, {0, 0}};
    for (size_t i = 0; i < count; i++) {
        const double *from = point[i], *to = point[(i + 1) % count];
        const double area = turn(origin, from, to) / 2;
        sums.area += area;
        for (int axis = 0; axis < 2; axis++)
            sums.moment[axis] +=
                area * ((from[axis] - origin[axis]) + (to[axis] - origin[axis])) / 3;
    }
    return sums;
}

polygon_box polygon_box_of(const double (*point)[2], size_t count)
{
    polygon_box box = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 2; axis++) {
            box.low[axis] = fmin(box.low[axis], point[i][axis]);
            box.high[axis] = fmax(box.high[axis], point[i][axis]);
        }
    return box;
}

bool polygon_boxes_meet(const polygon_box *one, const polygon_box *other)
{
    for (int axis = 0; axis < 2; axis++)
        if (!(one->low[axis] < other->high[axis] && other->low[axis] < one->high[axis]))
            return false;
    return true;
}

/* ---- clipping --------------------------------------------------------- */

/*
 * Compute the part of a polygon on the left of the line from a to b. Returns the number of its
 * points.
 */
static size_t clip_at_line(const double (*point)[2], size_t count, const double a[2],
                           const double b[2], double (*out)[2])
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        const double *from = point[i], *to = point[(i + 1) % count];
        const double left = turn(a, b, from), next = turn(a, b, to);
        if (left >= 0)
            memcpy(out[found++], from, sizeof *out);
        if ((left > 0 && next < 0) || (left < 0 && next > 0)) {
            const double part = left / (left - next);
            for (int k = 0; k < 2; k++)
                out[found][k] = from[k] + part * (to[k] - from[k]);
            found++;
        }
    }
    return found;
}

size_t polygon_clip(const double (*point)[2], size_t count, const double (*quad)[2],
                    double (*work)[2], double (*out)[2])
{
    count = clip_at_line(point, count, quad[0], quad[1], work);
    count = clip_at_line((const double(*)[2])work, count, quad[1], quad[2], out);
    count = clip_at_line((const double(*)[2])out, count, quad[2], quad[3], work);
    return clip_at_line((const double(*)[2])work, count, quad[3], quad[0], out);
}

/* ---- area in common --------------------------------------------------- */

/*
 * Side of a polygon, directed from left to right. The area between the side and a horizontal line
 * below the polygon counts with the factor `sign` (1 or -1) in the area of the polygon.
 */
typedef struct side {
    double x[2], y[2], sign;
} side;

/*
 * List the sides of a counterclockwise polygon that are not vertical. The area between a side and a
 * horizontal line below the polygon counts as positive if the polygon runs along this side to the
 * left. Returns the number of listed sides.
 */
static size_t list_sides(const double (*point)[2], size_t count, side *list)
{
    size_t sides = 0;
    for (size_t i = 0; i < count; i++) {
        const double *from = point[i], *to = point[(i + 1) % count];
        const int right = from[0] < to[0];
        if (from[0] == to[0])
            continue;
        list[sides].sign = right ? -1 : 1;
        for (int k = 0; k < 2; k++) {
            const double *end = k == right ? to : from;
            list[sides].x[k] = end[0];
            list[sides].y[k] = end[1];
        }
        sides++;
    }
    return sides;
}

static double height_at(const side *line, double x)
{
    const double part = (x - line->x[0]) / (line->x[1] - line->x[0]);
    return line->y[0] + part * (line->y[1] - line->y[0]);
}

/* Return the area of the region above the horizontal line y = base and below two polygon sides. */
static double area_below(const side *one, const side *other, double base)
{
    const double from = fmax(one->x[0], other->x[0]), to = fmin(one->x[1], other->x[1]);
    if (!(from < to))
        return 0;
    const double left[2] = {height_at(one, from) - base, height_at(other, from) - base};
    const double right[2] = {height_at(one, to) - base, height_at(other, to) - base};
    const double gap[2] = {left[0] - left[1], right[0] - right[1]};
    const double lower = fmin(left[0] + right[0], left[1] + right[1]) / 2;
    if (gap[0] * gap[1] >= 0)
        return (to - from) * lower;
    /*
     * The two sides cross. The area below both of them is bounded above by two line segments: from
     * the lower left end to the crossing, and from the crossing to the lower right end.
     */
    const double part = gap[0] / (gap[0] - gap[1]), middle = left[0] + part * (right[0] - left[0]);
    return (to - from) *
           (part * (fmin(left[0], left[1]) + middle) +
            (1 - part) * (middle + fmin(right[0], right[1]))) /
           2;
}

/*
 * Return the area common to two polygons. It is a sum over pairs of their sides: the area between
 * the height `base` and the lower of both sides over the range of x that they have in common;
 * negative if the sides run in opposite directions of x.
 *   one, other out  work arrays for the sides of each polygon
 */
static double sum_pairs(const double (*one_points)[2], size_t a_count, side *one,
                        const double (*b)[2], size_t b_count, side *other, double base)
{
    const size_t ones = list_sides(one_points, a_count, one),
                 others = list_sides(b, b_count, other);
    double sum = 0;
    for (size_t i = 0; i < ones; i++)
        for (size_t j = 0; j < others; j++)
            if (one[i].x[0] < other[j].x[1] && other[j].x[0] < one[i].x[1])
                sum += one[i].sign * other[j].sign * area_below(&one[i], &other[j], base);
    return sum;
}

/*
 * The area of a polygon is the sum, with signs, of the areas between its sides and a horizontal
 * line below. Summed over pairs of sides of two polygons, the areas below both sides give the
 * intersection. Both polygons are first clipped to the common rectangle of their bounding boxes.
 */
double polygon_common_area(const polygon *one, const polygon *other)
{
    const polygon_box one_box = polygon_box_of((const double(*)[2])one->point, one->count),
                      other_box = polygon_box_of((const double(*)[2])other->point, other->count);
    if (!polygon_boxes_meet(&one_box, &other_box))
        return 0;
    const double low[2] = {fmax(one_box.low[0], other_box.low[0]),
                           fmax(one_box.low[1], other_box.low[1])},
                 high[2] = {fmin(one_box.high[0], other_box.high[0]),
                            fmin(one_box.high[1], other_box.high[1])};
    const double quad[4][2] = {
        {low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}};
    const size_t room = POLYGON_ROOM(one->count + other->count);
    double(*point)[2] = calloc(3 * room, sizeof *point);
    side *list = calloc(2 * room, sizeof *list);
    double area = (double)NAN;
    if (point && list) {
        const size_t ones =
            polygon_clip((const double(*)[2])one->point, one->count, quad, point, point + room);
        const size_t others = polygon_clip((const double(*)[2])other->point, other->count, quad,
                                           point, point + 2 * room);
        area = sum_pairs((const double(*)[2])(point + room), ones, list,
                         (const double(*)[2])(point + 2 * room), others, list + room, low[1]);
    }
    free(point);
    free(list);
    return area;
}

/* ---- check ------------------------------------------------------------ */

/* Return whether point c, which lies on the straight line through a and b, lies between a and b. */
static bool lies_between(const double a[2], const double b[2], const double c[2])
{
    return c[0] >= fmin(a[0], b[0]) && c[0] <= fmax(a[0], b[0]) && c[1] >= fmin(a[1], b[1]) &&
           c[1] <= fmax(a[1], b[1]);
}

/* Return whether two sides, from a to b and from c to d, have a point in common. */
static bool do_cross(const double a[2], const double b[2], const double c[2], const double d[2])
{
    const double of_c = turn(a, b, c), of_d = turn(a, b, d), of_a = turn(c, d, a),
                 of_b = turn(c, d, b);
    if (((of_c > 0 && of_d < 0) || (of_c < 0 && of_d > 0)) &&
        ((of_a > 0 && of_b < 0) || (of_a < 0 && of_b > 0)))
        return true;
    return (of_c == 0 && lies_between(a, b, c)) || (of_d == 0 && lies_between(a, b, d)) ||
           (of_a == 0 && lies_between(c, d, a)) || (of_b == 0 && lies_between(c, d, b));
}

/*
 * Find two sides of a polygon that cross or touch, apart from the common point of neighbouring
 * sides. Returns whether there are two such sides.
 */
static bool find_crossing(const double (*point)[2], size_t count, size_t at[2])
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++) {
            const double *a = point[i], *b = point[i + 1], *c = point[j],
                         *d = point[(j + 1) % count];
            const bool follows = j == i + 1, precedes = i == 0 && j + 1 == count;
            bool is_bad = !follows && !precedes && do_cross(a, b, c, d);
            if (follows)
                is_bad = turn(a, b, d) == 0 && (lies_between(a, b, d) || lies_between(c, d, a));
            else if (precedes)
                is_bad = turn(c, a, b) == 0 && (lies_between(c, a, b) || lies_between(a, b, c));
            at[0] = i + 1;
            at[1] = j + 1;
            if (is_bad)
                return true;
        }
    return false;
}

/* Find the first point of an outline that is not finite or that equals the next point. */
static polygon_fault check_points(const double (*point)[2], size_t count, size_t at[2])
{
    for (size_t i = 0; i < count; i++) {
        const size_t next = (i + 1) % count;
        at[0] = i + 1;
        at[1] = next + 1;
        if (!isfinite(point[i][0]) || !isfinite(point[i][1]))
            return POLYGON_INFINITE;
        if (point[i][0] == point[next][0] && point[i][1] == point[next][1])
            return POLYGON_REPEATED;
    }
    return POLYGON_GOOD;
}

polygon_fault polygon_check(const double (*point)[2], size_t count, size_t at[2])
{
    at[0] = at[1] = 0;
    if (count < 3)
        return POLYGON_FEW;
    const polygon_fault fault = check_points(point, count, at);
    if (fault != POLYGON_GOOD)
        return fault;
    if (count > 3 && find_crossing(point, count, at))
        return POLYGON_CROSSED;
    const polygon_box box = polygon_box_of(point, count);
    const double size = (box.high[0] - box.low[0]) * (box.high[1] - box.low[1]);
    return fabs(polygon_sums_of(point, count, point[0]).area) > 1e-12 * size ? POLYGON_GOOD
                                                                             : POLYGON_FLAT;
}
