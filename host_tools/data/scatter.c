/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Interpolation by moving least squares at scattered points (scatter.h); a k-d tree finds the
 * nearest points.
 */
#include "scatter.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NEAREST = 16, DEPTH = 64, SAMPLES = 500 };

struct scatter {
    int axes;
    size_t count;
    double *point;  /* [count][SCATTER_AXES] coordinates of the points in the order of the k-d tree;
                       coordinates beyond `axes` are 0 */
    double *value;  /* [count] given values at the scattered points, in the order of the k-d tree
                       that holds the points */
    size_t *source; /* [count] number, in the order of the caller, of the scattered point at each
                       position of the k-d tree; used while the tree is built */
};

/*
 * Scattered points nearest to the place of interpolation that a search has found so far, with
 * ascending distance.
 */
typedef struct neighbours {
    size_t count, most;
    size_t index[NEAREST];
    double square[NEAREST]; /* squared distances of the nearest points from the place of
                               interpolation */
} neighbours;

/* ---- tree ------------------------------------------------------------- */

/*
 * Range of the array of points that forms a k-d tree: the middle point of a range divides the range
 * along an axis that changes with the depth, and both halves are divided in the same way.
 */
typedef struct tree_range {
    size_t first, end;
    int axis;
} tree_range;

static const double *sort_point;
static int sort_axis;

static int compare(const void *left, const void *right)
{
    const double first = sort_point[*(const size_t *)left * SCATTER_AXES + (size_t)sort_axis];
    const double second = sort_point[*(const size_t *)right * SCATTER_AXES + (size_t)sort_axis];
    return (first > second) - (first < second);
}

/*
 * Build the k-d tree: sort the numbers of the points, member `source`, into its order.
 *   point [count][SCATTER_AXES] in  coordinates of the points
 */
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

static double square_distance(const double *first, const double *second)
{
    double sum = 0;
    for (int axis = 0; axis < SCATTER_AXES; axis++)
        sum += (first[axis] - second[axis]) * (first[axis] - second[axis]);
    return sum;
}

/*
 * Range of the k-d tree that is still to be searched; the range is skipped if it is farther from
 * the place of interpolation than the nearest points found so far.
 */
typedef struct search_range {
    tree_range range;
    double beyond; /* lower bound of the squared distance between the place of interpolation and the
                      points of this range of the k-d tree */
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
        stack[waiting++] = across > 0 ? low : high; /* Of the two halves of a range of the k-d tree,
                                                       the half that is nearer to the place of
                                                       interpolation is searched first. */
        stack[waiting++] = across > 0 ? high : low;
    }
}

/* ---- local fit -------------------------------------------------------- */

/*
 * Weighted means and second moments of the coordinates and values of those scattered points that
 * are nearest to the place of interpolation.
 */
typedef struct moments {
    double centre[SCATTER_AXES], value; /* weighted means, over the points nearest to the place of
                                           interpolation, of their coordinates and of their values
                                         */
    double spread[SCATTER_AXES][SCATTER_AXES];
    double cross[SCATTER_AXES]; /* weighted covariance of the value with each coordinate, over the
                                   points nearest to the place of interpolation */
} moments;

static moments moments_of(const scatter *scatter, const neighbours *found)
{
    moments moments;
    double sum = 0, weight[NEAREST];
    memset(&moments, 0, sizeof moments);
    for (size_t k = 0; k < found->count; k++) {
        weight[k] = found->square[0] / found->square[k]; /* weight of a nearest point: inverse of
                                                            its squared distance from the place of
                                                            interpolation, scaled so that the first
                                                            of these points has the weight 1 */
        sum += weight[k];
    }
    for (size_t k = 0; k < found->count; k++) {
        const double *place = scatter->point + found->index[k] * SCATTER_AXES;
        weight[k] /= sum;
        moments.value += weight[k] * scatter->value[found->index[k]];
        for (int row = 0; row < SCATTER_AXES; row++)
            moments.centre[row] += weight[k] * place[row];
    }
    for (size_t k = 0; k < found->count; k++) {
        const double *place = scatter->point + found->index[k] * SCATTER_AXES;
        const double value = scatter->value[found->index[k]] - moments.value;
        for (int row = 0; row < SCATTER_AXES; row++) {
            moments.cross[row] += weight[k] * (place[row] - moments.centre[row]) * value;
            for (int column = 0; column < SCATTER_AXES; column++)
                moments.spread[row][column] += weight[k] * (place[row] - moments.centre[row]) *
                                               (place[column] - moments.centre[column]);
        }
    }
    return moments;
}

/*
 * Apply a Jacobi rotation to a symmetric matrix so that its entry (row, column) becomes 0, and to
 * the matrix of eigenvectors.
 */
static void rotate(double matrix[SCATTER_AXES][SCATTER_AXES],
                   double vectors[SCATTER_AXES][SCATTER_AXES], int row, int column)
{
    if (matrix[row][column] == 0)
        return;
    const double ratio = (matrix[column][column] - matrix[row][row]) / (2 * matrix[row][column]);
    const double tangent = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio));
    const double cosine = 1 / hypot(1, tangent), sine = tangent * cosine;
    for (int i = 0; i < SCATTER_AXES; i++) {
        const double left = matrix[i][row], right = matrix[i][column];
        matrix[i][row] = cosine * left - sine * right;
        matrix[i][column] = sine * left + cosine * right;
    }
    for (int i = 0; i < SCATTER_AXES; i++) {
        const double left = matrix[row][i], right = matrix[column][i],
                     left_vector = vectors[i][row], right_vector = vectors[i][column];
        matrix[row][i] = cosine * left - sine * right;
        matrix[column][i] = sine * left + cosine * right;
        vectors[i][row] = cosine * left_vector - sine * right_vector;
        vectors[i][column] = sine * left_vector + cosine * right_vector;
    }
}

/*
 * Return the value at a place of the linear function that was fitted to the nearest points. The
 * function is constant in directions in which the points spread less than 1e-4 of their largest
 * spread.
 */
static double linear_value(moments *moments, const double place[SCATTER_AXES])
{
    static const double narrow = 1e-8; /* smallest variance of the points along a principal axis,
                                          relative to the largest variance: where it is smaller, the
                                          slope of the fitted function along this axis is set to 0
                                        */
    double vectors[SCATTER_AXES][SCATTER_AXES] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double widest = 0, value = moments->value;
    for (int sweep = 0; sweep < 12; sweep++)
        for (int axis = 0; axis < SCATTER_AXES; axis++)
            for (int other = axis + 1; other < SCATTER_AXES; other++)
                rotate(moments->spread, vectors, axis, other);
    for (int k = 0; k < SCATTER_AXES; k++)
        widest = fmax(widest, moments->spread[k][k]);
    for (int k = 0; k < SCATTER_AXES; k++) {
        double slope = 0, along = 0;
        for (int axis = 0; axis < SCATTER_AXES; axis++) {
            slope += vectors[axis][k] * moments->cross[axis];
            along += vectors[axis][k] * (place[axis] - moments->centre[axis]);
        }
        if (moments->spread[k][k] > narrow * widest)
            value += slope / moments->spread[k][k] * along;
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
    moments moments = moments_of(scatter, &found);
    return linear_value(&moments, at);
}

static int ascending(const void *left, const void *right)
{
    const double first = *(const double *)left, second = *(const double *)right;
    return (first > second) - (first < second);
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
