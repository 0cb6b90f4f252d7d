/* SPDX-License-Identifier: BSD-2-Clause */
/* Moving least squares at scattered points (scatter.h), with the nearest points from a k-d tree. */
#include "scatter.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NEAREST = 16, DEPTH = 64, SAMPLES = 500 };

struct scatter {
    int axes;
    size_t count;
    double *point;  /* [count][SCATTER_AXES] in the order of the tree, unused coordinates 0 */
    double *value;  /* [count] in the same order */
    size_t *source; /* [count] order under construction */
};

/* The nearest points found so far, with ascending distance. */
typedef struct neighbours {
    size_t count, most;
    size_t index[NEAREST];
    double square[NEAREST]; /* squared distances */
} neighbours;

/* ---- tree ------------------------------------------------------------- */

/*
 * The tree is the array of points: the middle one of a range divides it along an axis that changes
 * with the depth, and each half is divided in the same way.
 */
typedef struct tree_range {
    size_t first, end;
    int axis;
} tree_range;

static const double *sort_point;
static int sort_axis;

static int compare(const void *left, const void *right)
{
    const double x = sort_point[*(const size_t *)left * SCATTER_AXES + (size_t)sort_axis];
    const double y = sort_point[*(const size_t *)right * SCATTER_AXES + (size_t)sort_axis];
    return (x > y) - (x < y);
}

/* Arrange `source` as a tree over the given points. */
static void build(scatter *scatter, const double *point)
{
    tree_range stack[DEPTH] = {{0, scatter->count, 0}};
    int waiting = 1;
    sort_point = point;
    while (waiting > 0) {
        const tree_range range = stack[--waiting];
        if (range.end - range.first < 2)
            continue;
        sort_axis = range.axis;
        qsort(scatter->source + range.first, range.end - range.first, sizeof *scatter->source,
              compare);
        const size_t middle = (range.first + range.end) / 2;
        const int next = (range.axis + 1) % scatter->axes;
        stack[waiting++] = (tree_range){range.first, middle, next};
        stack[waiting++] = (tree_range){middle + 1, range.end, next};
    }
}

scatter *scatter_open(int axes, size_t count, const double *point, const double *value)
{
    scatter *scatter = calloc(1, sizeof *scatter);
    double *padded = calloc(count * SCATTER_AXES + 1, sizeof *padded);
    if (scatter) {
        scatter->axes = axes;
        scatter->count = count;
        scatter->point = calloc(count * SCATTER_AXES + 1, sizeof *scatter->point);
        scatter->value = calloc(count + 1, sizeof *scatter->value);
        scatter->source = calloc(count + 1, sizeof *scatter->source);
    }
    if (!padded || !scatter || !scatter->point || !scatter->value || !scatter->source) {
        free(padded);
        scatter_close(scatter);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        scatter->source[i] = i;
        memcpy(padded + i * SCATTER_AXES, point + i * (size_t)axes, (size_t)axes * sizeof *point);
    }
    build(scatter, padded);
    for (size_t i = 0; i < count; i++) {
        memcpy(scatter->point + i * SCATTER_AXES, padded + scatter->source[i] * SCATTER_AXES,
               SCATTER_AXES * sizeof *padded);
        scatter->value[i] = value[scatter->source[i]];
    }
    free(padded);
    return scatter;
}

void scatter_close(scatter *scatter)
{
    if (!scatter)
        return;
    free(scatter->point);
    free(scatter->value);
    free(scatter->source);
    free(scatter);
}

/* ---- nearest points --------------------------------------------------- */

static void offer(neighbours *found, size_t index, double square)
{
    size_t k = found->count;
    if (k == found->most && !(square < found->square[k - 1]))
        return;
    if (k < found->most)
        found->count++;
    else
        k--;
    for (; k > 0 && found->square[k - 1] > square; k--) {
        found->square[k] = found->square[k - 1];
        found->index[k] = found->index[k - 1];
    }
    found->square[k] = square;
    found->index[k] = index;
}

static double square_distance(const double *x, const double *y)
{
    double sum = 0;
    for (int a = 0; a < SCATTER_AXES; a++)
        sum += (x[a] - y[a]) * (x[a] - y[a]);
    return sum;
}

/* A range of the tree that is to be searched unless it lies beyond the points found so far. */
typedef struct search_range {
    tree_range range;
    double beyond; /* square of a lower bound of its distance */
} search_range;

static void search(const scatter *scatter, const double place[SCATTER_AXES], neighbours *found)
{
    search_range stack[2 * DEPTH] = {{{0, scatter->count, 0}, 0}};
    int waiting = 1;
    while (waiting > 0) {
        const search_range next = stack[--waiting];
        const tree_range range = next.range;
        if (range.end <= range.first ||
            (found->count == found->most && next.beyond > found->square[found->count - 1]))
            continue;
        const size_t middle = (range.first + range.end) / 2;
        const double *point = scatter->point + middle * SCATTER_AXES;
        const double across = place[range.axis] - point[range.axis];
        const int axis = (range.axis + 1) % scatter->axes;
        const search_range low = {{range.first, middle, axis}, across > 0 ? across * across : 0};
        const search_range high = {{middle + 1, range.end, axis}, across < 0 ? across * across : 0};
        offer(found, middle, square_distance(place, point));
        stack[waiting++] = across > 0 ? low : high; /* the nearer half is searched first */
        stack[waiting++] = across > 0 ? high : low;
    }
}

/* ---- local fit -------------------------------------------------------- */

/* Weighted moments of the nearest points about their centre. */
typedef struct moments {
    double centre[SCATTER_AXES], value; /* means of coordinates and values */
    double spread[SCATTER_AXES][SCATTER_AXES];
    double cross[SCATTER_AXES]; /* of coordinates and values */
} moments;

static moments moments_of(const scatter *scatter, const neighbours *found)
{
    moments m;
    double sum = 0, weight[NEAREST];
    memset(&m, 0, sizeof m);
    for (size_t k = 0; k < found->count; k++) {
        weight[k] = found->square[0] / found->square[k]; /* the nearest point has weight 1 */
        sum += weight[k];
    }
    for (size_t k = 0; k < found->count; k++) {
        const double *x = scatter->point + found->index[k] * SCATTER_AXES;
        weight[k] /= sum;
        m.value += weight[k] * scatter->value[found->index[k]];
        for (int a = 0; a < SCATTER_AXES; a++)
            m.centre[a] += weight[k] * x[a];
    }
    for (size_t k = 0; k < found->count; k++) {
        const double *x = scatter->point + found->index[k] * SCATTER_AXES;
        const double value = scatter->value[found->index[k]] - m.value;
        for (int a = 0; a < SCATTER_AXES; a++) {
            m.cross[a] += weight[k] * (x[a] - m.centre[a]) * value;
            for (int b = 0; b < SCATTER_AXES; b++)
                m.spread[a][b] += weight[k] * (x[a] - m.centre[a]) * (x[b] - m.centre[b]);
        }
    }
    return m;
}

/* One Jacobi rotation of a symmetric matrix that makes s[a][b] zero; v collects the rotations. */
static void rotate(double s[SCATTER_AXES][SCATTER_AXES], double v[SCATTER_AXES][SCATTER_AXES],
                   int a, int b)
{
    if (s[a][b] == 0)
        return;
    const double ratio = (s[b][b] - s[a][a]) / (2 * s[a][b]);
    const double t = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio));
    const double c = 1 / hypot(1, t), d = t * c;
    for (int i = 0; i < SCATTER_AXES; i++) {
        const double x = s[i][a], y = s[i][b];
        s[i][a] = c * x - d * y;
        s[i][b] = d * x + c * y;
    }
    for (int i = 0; i < SCATTER_AXES; i++) {
        const double x = s[a][i], y = s[b][i], p = v[i][a], q = v[i][b];
        s[a][i] = c * x - d * y;
        s[b][i] = d * x + c * y;
        v[i][a] = c * p - d * q;
        v[i][b] = d * p + c * q;
    }
}

/*
 * Value of the fitted linear function at a place. Directions in which the points spread less than
 * 1e-4 of the widest have no slope: there the function is constant.
 */
static double linear_value(moments *m, const double place[SCATTER_AXES])
{
    static const double narrow = 1e-8; /* of squared widths */
    double v[SCATTER_AXES][SCATTER_AXES] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double widest = 0, value = m->value;
    for (int sweep = 0; sweep < 12; sweep++)
        for (int a = 0; a < SCATTER_AXES; a++)
            for (int b = a + 1; b < SCATTER_AXES; b++)
                rotate(m->spread, v, a, b);
    for (int k = 0; k < SCATTER_AXES; k++)
        widest = fmax(widest, m->spread[k][k]);
    for (int k = 0; k < SCATTER_AXES; k++) {
        double slope = 0, along = 0;
        for (int a = 0; a < SCATTER_AXES; a++) {
            slope += v[a][k] * m->cross[a];
            along += v[a][k] * (place[a] - m->centre[a]);
        }
        if (m->spread[k][k] > narrow * widest)
            value += slope / m->spread[k][k] * along;
    }
    return value;
}

double scatter_value(const scatter *scatter, const double *place, double *distance)
{
    static const size_t most[SCATTER_AXES] = {4, 9, 16};
    neighbours found = {.most = most[scatter->axes - 1]};
    double at[SCATTER_AXES] = {0, 0, 0};
    memcpy(at, place, (size_t)scatter->axes * sizeof *place);
    search(scatter, at, &found);
    if (distance)
        *distance = found.count > 0 ? sqrt(found.square[0]) : (double)NAN;
    if (found.count == 0)
        return (double)NAN;
    const double farthest = found.square[found.count - 1];
    if (found.square[0] <= 1e-24 * farthest || found.square[0] < DBL_MIN)
        return scatter->value[found.index[0]];
    moments m = moments_of(scatter, &found);
    return linear_value(&m, at);
}

static int ascending(const void *left, const void *right)
{
    const double x = *(const double *)left, y = *(const double *)right;
    return (x > y) - (x < y);
}

double scatter_spacing(const scatter *scatter)
{
    double gap[SAMPLES];
    size_t count = 0;
    const size_t stride = scatter->count / SAMPLES + 1;
    for (size_t i = 0; i < scatter->count && count < SAMPLES; i += stride) {
        neighbours found = {.most = 2};
        search(scatter, scatter->point + i * SCATTER_AXES, &found);
        gap[count++] = found.count == 2 ? sqrt(found.square[1]) : 0;
    }
    qsort(gap, count, sizeof *gap, ascending);
    return count > 0 ? gap[count / 2] : 0;
}
