/* SPDX-License-Identifier: BSD-2-Clause */
/* Bicubic spline functions fitted to scattered values (bicubic.h). */
#include "bicubic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"

/*
 * ORDER: number of cubic B-splines along one coordinate that differ from zero in a cell, a
 * rectangle between knots. TERMS: number of their products for both coordinates.
 */
enum { ORDER = 4, TERMS = ORDER * ORDER };

/*
 * Number of data points that a cell of the bicubic spline function has on average where the caller
 * does not choose the number of cells.
 */
static const double points_of_cell = 4;

/*
 * Weight of the penalty on the second derivatives of the bicubic spline function, relative to the
 * weight of the points in an average cell. It is so small that the penalty moves the function by
 * less than the spline's own error of approximation.
 */
static const double penalty = 1e-6;

/*
 * Points count as lying on a straight line in the plane of x and y if 1 - r^2 is at most this
 * number, with the correlation coefficient r of x and y. With x and y relative to their ranges, the
 * region of the points is then about a hundred times as long as wide.
 */
static const double narrow = 1e-4;

/* ---- B-splines ---------------------------------------------------------- */

/*
 * Compute the four cubic B-splines that differ from zero in a cell of the spline function, or one
 * of their derivatives with respect to the coordinate `at` in the cell.
 *   at         in   coordinate in the cell, from 0 to 1
 *   derivative in   order of the derivative: 0, 1 or 2
 *   value [4]  out  values of the four functions
 */
static void splines(double at, int derivative, double value[ORDER])
{
    const double back = 1 - at;
    const double table[3][ORDER] = {
        {back * back * back / 6, (4 - 6 * at * at + 3 * at * at * at) / 6,
         (4 - 6 * back * back + 3 * back * back * back) / 6, at * at * at / 6},
        {-back * back / 2, (3 * at - 4) * at / 2, (4 - 3 * back) * back / 2, at * at / 2},
        {back, 3 * at - 2, 1 - 3 * at, at}};
    memcpy(value, table[derivative], sizeof table[derivative]);
}

/*
 * A cell of the bicubic spline function, and the coordinates of a point in it, each from 0 to 1
 * inside the cell.
 */
typedef struct cell_point {
    int cell[2];
    double at[2];
} cell_point;

static double cell_size(const bicubic *function, int direction)
{
    return (function->to[direction] - function->from[direction]) / function->cells[direction];
}

static cell_point find_cell(const bicubic *function, const double place[2])
{
    cell_point found;
    for (int k = 0; k < 2; k++) {
        const double along = (place[k] - function->from[k]) / cell_size(function, k);
        const double last = function->cells[k] - 1;
        found.cell[k] = (int)fmax(0, fmin(floor(along), last));
        found.at[k] = along - found.cell[k];
    }
    return found;
}

/*
 * Return the index of one coefficient of the spline function. It belongs to one of the 16 products
 * of B-splines that differ from zero in a cell.
 *   term in  number of the product, 0 to 15
 */
static uint32_t row_of(const bicubic *function, const int cell[2], int term)
{
    return (uint32_t)((cell[1] + term / ORDER) * (function->cells[0] + ORDER - 1) + cell[0] +
                      term % ORDER);
}

/*
 * Compute the 16 products of cubic B-splines that differ from zero in a cell of the spline
 * function, or one of their derivatives with respect to x and y.
 *   at         [2]  in   coordinates of the point in the cell, each from 0 to 1
 *   derivative [2]  in   order of the derivative with respect to x and to y
 *   product    [16] out  the products at the point
 */
static void products(const bicubic *function, const double at[2], const int derivative[2],
                     double product[TERMS])
{
    double value[2][ORDER];
    for (int k = 0; k < 2; k++) {
        splines(at[k], derivative[k], value[k]);
        for (int i = 0; i < ORDER; i++)
            value[k][i] /= pow(cell_size(function, k), derivative[k]);
    }
    for (int term = 0; term < TERMS; term++)
        product[term] = value[0][term % ORDER] * value[1][term / ORDER];
}

/* ---- normal equations --------------------------------------------------- */

/*
 * Add a weight times v v^T to the matrix of the normal equations for one cell of the spline
 * function. The vector v [16] holds the products of B-splines that differ from zero in the cell.
 */
static void add_square(const double product[TERMS], double weight, double matrix[TERMS][TERMS])
{
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j < TERMS; j++)
            matrix[i][j] += weight * product[i] * product[j];
}

/*
 * Compute the penalty of one cell of the bicubic spline function f: integral of f_xx^2 + 2 f_xy^2 +
 * f_yy^2 (derivatives) over the cell, over its area, times the weight of the penalty. Gauss's rule
 * of four points along each coordinate is exact.
 */
static void set_penalty(const bicubic *function, double matrix[TERMS][TERMS])
{
    static const double place[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                    0.8611363115940526};
    static const double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                     0.3478548451374538};
    static const int order[3][2] = {{2, 0}, {1, 1}, {0, 2}};
    const double cells = (double)function->cells[0] * function->cells[1],
                 area = cell_size(function, 0) * cell_size(function, 1),
                 scale = penalty * (double)function->points / cells * area * area;
    memset(matrix, 0, TERMS * sizeof *matrix);
    for (int point = 0; point < 16; point++)
        for (int part = 0; part < 3; part++) {
            const double at[2] = {(1 + place[point % 4]) / 2, (1 + place[point / 4]) / 2};
            const double twice = part == 1 ? 2 : 1;
            double product[TERMS];
            products(function, at, order[part], product);
            add_square(product, scale * twice * weight[point % 4] * weight[point / 4] / 4, matrix);
        }
}

/*
 * Add the 16 x 16 matrix that one cell of the spline function contributes to the matrix of the
 * normal equations of the whole fit, whose lower triangle is stored.
 */
static void add_cell(const bicubic *function, const int cell[2], double matrix[TERMS][TERMS],
                     pzs_envelope *equations)
{
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j < TERMS; j++) {
            const uint32_t row = row_of(function, cell, i), column = row_of(function, cell, j);
            if (column <= row)
                *pzs_linalg_entry(equations, row, column) += matrix[i][j];
        }
}

static void add_penalties(const bicubic *function, pzs_envelope *equations)
{
    double matrix[TERMS][TERMS];
    set_penalty(function, matrix);
    for (int i = 0; i < function->cells[0] * function->cells[1]; i++) {
        const int cell[2] = {i % function->cells[0], i / function->cells[0]};
        add_cell(function, cell, matrix, equations);
    }
}

static void add_points(const bicubic *function, size_t count, const double (*point)[3],
                       pzs_envelope *equations)
{
    static const int value[2] = {0, 0};
    for (size_t k = 0; k < count; k++) {
        const cell_point found = find_cell(function, point[k]);
        double product[TERMS], matrix[TERMS][TERMS] = {{0}};
        products(function, found.at, value, product);
        function->points_in[found.cell[1] * function->cells[0] + found.cell[0]]++;
        add_square(product, 1, matrix);
        add_cell(function, found.cell, matrix, equations);
        for (int i = 0; i < TERMS; i++)
            function->coefficient[row_of(function, found.cell, i)] += product[i] * point[k][2];
    }
}

/*
 * Allocate the symmetric matrix of the normal equations of the spline fit, one row for each product
 * of two B-splines. A row is stored from the first column whose product can overlap with its own.
 * Returns 0, or -1 when memory runs out; the caller releases the arrays in either case.
 */
static int open_equations(const bicubic *function, pzs_envelope *equations, uint16_t *first,
                          uint32_t rows)
{
    const uint32_t reach = (uint32_t)((ORDER - 1) * (function->cells[0] + ORDER));
    memset(equations, 0, sizeof *equations);
    equations->n = rows;
    for (uint32_t row = 0; row < rows; row++)
        first[row] = (uint16_t)(row > reach ? row - reach : 0);
    equations->first = first;
    equations->value = calloc(pzs_linalg_reals(first, rows), sizeof *equations->value);
    equations->inverse = calloc(rows, sizeof *equations->inverse);
    equations->start = calloc(rows / PZS_TILE + 2, sizeof *equations->start);
    if (!equations->value || !equations->inverse || !equations->start)
        return -1;
    pzs_linalg_layout(equations);
    return 0;
}

/*
 * Solve the normal equations of the fit for the coefficients of the spline function. Returns 0, or
 * -1 if the points determine no function.
 */
static int solve(bicubic *function, size_t count, const double (*point)[3], uint32_t rows)
{
    pzs_envelope equations;
    uint16_t *first = calloc(rows, sizeof *first);
    int status = -1;
    memset(&equations, 0, sizeof equations);
    if (first && open_equations(function, &equations, first, rows) == 0) {
        add_penalties(function, &equations);
        add_points(function, count, point, &equations);
        const linalg_inertia inertia = pzs_linalg_factor(&equations);
        status = inertia.zero < 0 && inertia.negative == 0 ? 0 : -1;
        if (status == 0)
            pzs_linalg_solve(&equations, function->coefficient);
    }
    free(equations.value);
    free(equations.inverse);
    free(equations.start);
    free(first);
    return status;
}

/* ---- fit ---------------------------------------------------------------- */

static void find_rectangle(bicubic *function, size_t count, const double (*point)[3])
{
    for (int k = 0; k < 2; k++) {
        function->from[k] = HUGE_VAL;
        function->to[k] = -HUGE_VAL;
        for (size_t i = 0; i < count; i++) {
            function->from[k] = fmin(function->from[k], point[i][k]);
            function->to[k] = fmax(function->to[k], point[i][k]);
        }
    }
}

/*
 * Whether the points of the fit lie on a straight line in the plane of x and y: all x or all y are
 * equal, or 1 - r^2 is at most `narrow`, with the correlation coefficient r of x and y.
 */
static bool are_on_line(const bicubic *function, size_t count, const double (*point)[3])
{
    const double sides[2] = {function->to[0] - function->from[0],
                             function->to[1] - function->from[1]};
    double mean[2] = {0, 0}, square[2] = {0, 0}, product = 0;
    if (!(sides[0] > 0) || !(sides[1] > 0))
        return true;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            mean[k] += (point[i][k] - function->from[k]) / sides[k] / (double)count;
    for (size_t i = 0; i < count; i++) {
        double part[2];
        for (int k = 0; k < 2; k++) {
            part[k] = (point[i][k] - function->from[k]) / sides[k] - mean[k];
            square[k] += part[k] * part[k];
        }
        product += part[0] * part[1];
    }
    return !(square[0] * square[1] - product * product > narrow * square[0] * square[1]);
}

/*
 * Set the numbers of cells of the spline function along x and y: the given ones, or numbers with
 * which the cells are about square.
 */
static void choose_cells(bicubic *function, const int cells[2])
{
    const double wanted = (double)function->points / points_of_cell,
                 sides[2] = {function->to[0] - function->from[0],
                             function->to[1] - function->from[1]};
    for (int k = 0; k < 2; k++) {
        const double number = round(sqrt(wanted * sides[k] / sides[1 - k]));
        function->cells[k] = cells[k] ? cells[k] : (int)fmax(1, fmin(number, BICUBIC_CELLS));
    }
}

static void measure(bicubic *function, size_t count, const double (*point)[3])
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double error = bicubic_at(function, point[i][0], point[i][1]).value - point[i][2];
        sum += error * error;
        if (fabs(error) > function->largest) {
            function->largest = fabs(error);
            function->worst = i;
        }
    }
    function->rms = sqrt(sum / (double)count);
}

int bicubic_fit(bicubic *function, size_t count, const double (*point)[3], const int cells[2])
{
    memset(function, 0, sizeof *function);
    function->points = count;
    find_rectangle(function, count, point);
    if (count < 3 || are_on_line(function, count, point))
        return -1;
    choose_cells(function, cells);
    const uint32_t rows =
        (uint32_t)((function->cells[0] + ORDER - 1) * (function->cells[1] + ORDER - 1));
    function->coefficient = calloc(rows, sizeof *function->coefficient);
    function->points_in =
        calloc((size_t)(function->cells[0] * function->cells[1]), sizeof *function->points_in);
    if (!function->coefficient || !function->points_in || solve(function, count, point, rows) < 0) {
        bicubic_free(function);
        return -1;
    }
    measure(function, count, point);
    return 0;
}

void bicubic_free(bicubic *function)
{
    free(function->coefficient);
    free(function->points_in);
    memset(function, 0, sizeof *function);
}

bicubic_jet bicubic_at(const bicubic *function, double x, double y)
{
    static const int order[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {0, 2}, {1, 1}};
    const double place[2] = {x, y};
    const cell_point found = find_cell(function, place);
    bicubic_jet jet;
    double all[6] = {0};
    for (int k = 0; k < 6; k++) {
        double product[TERMS];
        products(function, found.at, order[k], product);
        for (int i = 0; i < TERMS; i++)
            all[k] += product[i] * function->coefficient[row_of(function, found.cell, i)];
    }
    jet.value = all[0];
    memcpy(jet.first, &all[1], sizeof jet.first);
    memcpy(jet.second, &all[3], sizeof jet.second);
    return jet;
}

bool bicubic_is_known(const bicubic *function, double x, double y)
{
    const double place[2] = {x, y};
    const cell_point found = find_cell(function, place);
    unsigned sum = 0;
    for (int neighbour = 0; neighbour < 9; neighbour++) {
        const int column = found.cell[0] + neighbour % 3 - 1,
                  row = found.cell[1] + neighbour / 3 - 1;
        if (column >= 0 && column < function->cells[0] && row >= 0 && row < function->cells[1])
            sum += function->points_in[row * function->cells[0] + column];
    }
    return sum > 0;
}
