/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hessian of the voltage optimisation problem: B'W^2 B + regularisation I, with the influence
 * matrix B and the output weights W (control.h).
 */
#include <string.h>
#include "control.h"
#include "../core/guard.h"
#include "../core/product.h"
#include "../core/product_wide.h"

/*
 * Largest number of rows of the influence matrix whose products are added to the Hessian together.
 */
#define TOGETHER 64u

void pzs_control_form_row(const pzs_control *control, const pzs_real *table, uint32_t k)
{
    const uint32_t inputs = control->state.problem->inputs,
                   outputs = control->state.problem->outputs,
                   width = control->state.optimiser.width;
    const pzs_real *weight = control->state.problem->weight;
    const pzs_real *influence = control->state.influence + k;
    pzs_real *hessian = control->state.optimiser.hessian, *row = hessian + (size_t)k * width,
             *column = control->state.weighted;
    memset(row, 0, width * sizeof *row);
    if (table != NULL) {
        memcpy(row, table + (size_t)k * inputs, inputs * sizeof(pzs_real));
    } else {
        for (uint32_t i = 0; i < outputs; i++)
            column[i] = weight[i] * weight[i] * influence[(size_t)i * inputs];
        pzs_product_sum_rows(row + k, influence, inputs, column, outputs, inputs - k);
        for (uint32_t j = 0; j < k; j++)
            row[j] = hessian[(size_t)j * width + k];
    }
    row[k] += control->state.problem->regularisation;
}

/*
 * On a host with AVX2, compute the Hessian from influence matrix and output weights, with the bits
 * of pzs_control_form_row. Each group of rows of the influence matrix is read once, and only half
 * of the products are formed. Returns false on other processors, where nothing is computed.
 */
static bool form_wide(const pzs_control *control)
{
    const pzs_optimiser *optimiser = &control->state.optimiser;
    const size_t inputs = optimiser->inputs, width = optimiser->width,
                 outputs = control->state.problem->outputs, size = width + WIDE_BLOCK;
    const size_t fit = inputs * width / (2u * size), most = fit < TOGETHER ? fit : TOGETHER;
    pzs_real *groups = optimiser->tableau, *scaled = groups + most * size;
    pzs_real factor[TOGETHER];
    if (!product_is_wide(inputs))
        return false;
    memset(optimiser->hessian, 0, inputs * width * sizeof(pzs_real));
    for (size_t i = 0; i < outputs; i += most) {
        const pzs_real *weight = control->state.problem->weight + i;
        const size_t count = outputs - i < most ? outputs - i : most;
        for (size_t k = 0; k < count; k++)
            factor[k] = -(weight[k] * weight[k]);
        pzs_wide_group(groups, scaled, control->state.influence + i * inputs, inputs, factor, 1,
                       count, inputs);
        for (size_t k = 0; k < inputs; k += WIDE_BLOCK)
            pzs_wide_update_rows(optimiser->hessian, width, inputs, k, groups, scaled, count);
    }
    pzs_wide_mirror(optimiser->hessian, width, inputs);
    for (size_t k = 0; k < inputs; k++)
        optimiser->hessian[k * width + k] += control->state.problem->regularisation;
    return true;
}

int32_t pzs_control_form_hessian(const pzs_control *control, const pzs_real *table)
{
    const pzs_optimiser *optimiser = &control->state.optimiser;
    const bool is_formed = table == NULL && form_wide(control);
    for (uint32_t k = 0; k < optimiser->inputs; k++) {
        if (!is_formed)
            pzs_control_form_row(control, table, k);
        const int32_t bad = pzs_guard_nonfinite(optimiser->hessian + (size_t)k * optimiser->width,
                                                optimiser->width);
        if (bad >= 0)
            return (int32_t)(k * optimiser->width) + bad;
    }
    return -1;
}
