/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Two special parts of a target. Target rows that depend on constrained dof alone cannot be changed
 * by any voltage; their weights become 0. Free functions are shapes that may be added to the target
 * at no cost. The projector that removes the weighted least-squares fit by the free functions from
 * a vector is
 *   P = I - F F'W^2, with F orthonormal: F'W^2 F = I.
 *   W  weights of the target rows
 *   F  free functions at the target nodes
 */
#include "design.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows on constrained dof ------------------------------------------- */

static bool is_prescribed(const mesh *mesh, uint16_t dof)
{
    for (int k = 0; k < mesh->prescribed_count; k++)
        if (mesh->prescribed_dof[k] == dof)
            return true;
    return false;
}

/*
 * Whether a controlled displacement (target row) depends on constrained dof alone, so that voltages
 * cannot change it.
 */
static bool is_constrained(const design *design, int row)
{
    const pzs_rows *rows = &design->structure.output;
    for (uint32_t entry = rows->start[row]; entry < rows->start[row + 1]; entry++)
        if (!is_prescribed(&design->mesh, rows->dof[entry]))
            return false;
    return true;
}

/*
 * Set the weights of the controlled displacements (target rows) on constrained dof to 0, and keep
 * their former weights in fixed_weight.
 */
static void separate_fixed_rows(design *design)
{
    for (int i = 0; i < design->targets; i++)
        if (is_constrained(design, i)) {
            design->fixed_weight[i] = design->weight[i];
            design->weight[i] = 0;
            design->fixed_rows++;
        }
}

/* ---- free functions --------------------------------------------------- */

static double difference(const double *first, const double *second, int i)
{
    return second ? first[i] - second[i] : first[i];
}

/*
 * Return entry i of the vector (shape - wanted) minus a combination of the first `count` free
 * functions of the target (shapes that may be added at no cost).
 *   coefficient [count] in  coefficients of this combination
 */
static double residual_entry(const design *design, const double *shape, const double *wanted,
                             const double *coefficient, int count, int i)
{
    double residual = difference(shape, wanted, i);
    for (int j = 0; j < count; j++)
        residual -=
            coefficient[j] * design->free_value[(size_t)j * (size_t)design->targets + (size_t)i];
    return residual;
}

/*
 * Compute the weighted least-squares fit of the first `count` free functions of the target (shapes
 * that may be added at no cost) to the vector (shape - wanted). A second iteration corrects
 * rounding errors.
 *   coefficient [count] out  coefficients of the functions
 */
static void fit(const design *design, const double *shape, const double *wanted, int count,
                double *coefficient)
{
    double more[DESIGN_FREE];
    memset(coefficient, 0, (size_t)count * sizeof *coefficient);
    for (int again = 0; again < 2; again++) {
        memset(more, 0, sizeof more);
        for (int i = 0; i < design->targets; i++) {
            const double residual = design->weight[i] * design->weight[i] *
                                    residual_entry(design, shape, wanted, coefficient, count, i);
            for (int j = 0; j < count; j++)
                more[j] +=
                    residual * design->free_value[(size_t)j * (size_t)design->targets + (size_t)i];
        }
        for (int j = 0; j < count; j++)
            coefficient[j] += more[j];
    }
}

/*
 * Sum of the squares of a shape [targets], weighted with the weights of the target rows (controlled
 * displacements).
 */
static double weighted_squares(const design *design, const double *shape)
{
    double sum = 0;
    for (int i = 0; i < design->targets; i++)
        sum += pow(design->weight[i] * shape[i], 2);
    return sum;
}

/*
 * Bound of the rounding errors in a vector from which the free functions (shapes that may be added
 * to the target at no cost) have been removed: weighted norm of the errors over that of the vector.
 */
static double rounding(const design *design)
{
    return 8 * DBL_EPSILON * sqrt((double)design->targets);
}

/*
 * Subtract from a shape [targets] its fit by the first `count` free functions of the target (shapes
 * that may be added at no cost). If only rounding errors remain, the displacements that count in
 * the shape error are set to 0.
 */
static void remove_fit(const design *design, int count, double *shape)
{
    double coefficient[DESIGN_FREE];
    const double before = weighted_squares(design, shape);
    fit(design, shape, NULL, count, coefficient);
    for (int i = 0; i < design->targets; i++)
        shape[i] = residual_entry(design, shape, NULL, coefficient, count, i);
    if (weighted_squares(design, shape) > pow(rounding(design), 2) * before)
        return;
    for (int i = 0; i < design->targets; i++)
        shape[i] = design->weight[i] > 0 ? 0 : shape[i];
}

/*
 * Evaluate free function j (a shape that may be added to the target at no cost) at the target
 * nodes, orthogonalise it to the preceding free functions and scale it to the weighted norm 1.
 * Returns 0, or -1 with error filled.
 */
static int add_free(design *design, int j, char *error)
{
    const scene_mode *from = &design->scene->target.free[j];
    double *value = design->free_value + (size_t)j * (size_t)design->targets;
    if (design_target_values(design, from->value, from->at, value, error) < 0)
        return -1;
    remove_fit(design, j, value);
    const double size = sqrt(weighted_squares(design, value));
    if (!(size > 0))
        return scene_fault(from->at, error,
                           "free function '%s' is zero at the nodes of the target that can "
                           "move, or a combination of the free functions before it; remove it",
                           from->name);
    for (int i = 0; i < design->targets; i++)
        value[i] /= size;
    design->free_functions = j + 1;
    return 0;
}

/*
 * Subtract from free function j (a shape that may be added to the target at no cost) its part along
 * the preceding ones, for orthonormal functions: sums over the target rows without weights. The
 * second of two iterations corrects rounding errors.
 */
static void separate_basis(design *design, int j)
{
    const size_t targets = (size_t)design->targets;
    double *value = design->free_basis + (size_t)j * targets;
    for (int again = 0; again < 2; again++)
        for (int k = 0; k < j; k++) {
            const double *other = design->free_basis + (size_t)k * targets;
            double product = 0;
            for (size_t i = 0; i < targets; i++)
                product += value[i] * other[i];
            for (size_t i = 0; i < targets; i++)
                value[i] -= product * other[i];
        }
}

/*
 * Make the free functions of the target (shapes that may be added to it at no cost) orthonormal
 * over the target rows whose weight is not 0. The supervisor of the control loop needs these
 * functions, because it compares shapes without weights.
 */
static void fill_basis(design *design)
{
    const size_t targets = (size_t)design->targets;
    for (int j = 0; j < design->free_functions; j++) {
        double *value = design->free_basis + (size_t)j * targets, square = 0;
        for (size_t i = 0; i < targets; i++)
            value[i] = design->weight[i] > 0 ? design->free_value[(size_t)j * targets + i] : 0;
        separate_basis(design, j);
        for (size_t i = 0; i < targets; i++)
            square += value[i] * value[i];
        for (size_t i = 0; i < targets; i++)
            value[i] /= sqrt(square);
    }
}

void design_take_free(const design *design, double *shape)
{
    if (design->free_functions > 0)
        remove_fit(design, design->free_functions, shape);
}

double design_misfit(const design *design, const double *shape, const double *wanted,
                     double *misfit)
{
    double coefficient[DESIGN_FREE], sum = 0;
    fit(design, shape, wanted, design->free_functions, coefficient);
    for (int i = 0; i < design->targets; i++) {
        misfit[i] = residual_entry(design, shape, wanted, coefficient, design->free_functions, i);
        sum += pow(design->fixed_weight[i] * misfit[i], 2);
    }
    return sum;
}

double design_squares(const design *design, const double *shape, const double *wanted)
{
    double coefficient[DESIGN_FREE], sum = 0;
    fit(design, shape, wanted, design->free_functions, coefficient);
    for (int i = 0; i < design->targets; i++)
        sum += pow(design->weight[i] * residual_entry(design, shape, wanted, coefficient,
                                                      design->free_functions, i),
                   2);
    return sum;
}

void design_influence_free(const design *design, const double *influence, size_t stride,
                           double *column, double *out)
{
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    for (size_t i = 0; i < targets; i++)
        memcpy(out + i * amplifiers, influence + i * stride, amplifiers * sizeof *out);
    for (size_t k = 0; k < amplifiers && design->free_functions > 0; k++) {
        for (size_t i = 0; i < targets; i++)
            column[i] = out[i * amplifiers + k];
        design_take_free(design, column);
        for (size_t i = 0; i < targets; i++)
            out[i * amplifiers + k] = design->weight[i] > 0 ? column[i] : 0;
    }
}

int design_target_rows(design *design, char *error)
{
    const scene_target *target = &design->scene->target;
    const size_t targets = (size_t)design->targets;
    if (!target->given)
        return 0;
    design->fixed_weight = calloc(targets, sizeof *design->fixed_weight);
    design->free_value = calloc(targets * (size_t)target->frees + 1, sizeof *design->free_value);
    design->free_basis = calloc(targets * (size_t)target->frees + 1, sizeof *design->free_basis);
    if (!design->fixed_weight || !design->free_value || !design->free_basis)
        return scene_fault(target->what.at, error, "%d target nodes do not fit into memory",
                           design->targets);
    separate_fixed_rows(design);
    for (int j = 0; j < target->frees && design->fixed_rows < design->targets; j++)
        if (add_free(design, j, error) < 0)
            return -1;
    fill_basis(design);
    return design_target_values(design, target->value, target->what.at, design->target, error);
}
