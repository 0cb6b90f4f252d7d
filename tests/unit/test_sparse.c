/*
 * Laws of sparse influence matrices: the bits of the full matrix, and refusal of damaged tables.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>
#include "pzs.h"
#include "../../lib/control/control.h"
#include "../../lib/core/product.h"
#include "../rigs/damage_block.h"
#include "../rigs/uniform.h"
#include <math.h>
#include <string.h>

enum { N = 203, M = 120, TICKS = 12, FLIPS = 400 };

/* A voltage optimisation problem with the full influence matrix, and one with the sparse matrix. */
typedef struct rig {
    unsigned seed;
    unsigned inputs, outputs;
    pzs_real influence[M * N], hessian[N * N], weight[M], lower[N], upper[N], step_limit[N],
        reference[N];
    uint32_t start[M + 1];
    uint16_t dof[M * N];
    pzs_real value[M * N];
    pzs_sparse_influence sparse;
    pzs_problem full, compressed;
    pzs_control control[2];
    double work[2][PZS_CONTROL_BYTES(N, M) / sizeof(double) + 1];
} rig;

static rig desk;

static bool is_zero(pzs_real value)
{
    return value <= 0 && value >= 0;
}

/* Fill a random matrix of which a part of the entries is not zero. */
static void fill_matrix(rig *r, double density)
{
    for (unsigned k = 0; k < r->inputs * r->outputs; k++) {
        const double entry = uniform(&r->seed, -1, 1);
        r->influence[k] = uniform(&r->seed, 0, 1) < density ? (pzs_real)entry : 0;
    }
}

/* Store the entries of the full matrix that are not zero as sparse rows. */
static void compress(rig *r)
{
    uint32_t entries = 0;
    for (unsigned i = 0; i < r->outputs; i++) {
        for (unsigned j = 0; j < r->inputs; j++) {
            const pzs_real entry = r->influence[i * r->inputs + j];
            if (is_zero(entry))
                continue;
            r->dof[entries] = (uint16_t)j;
            r->value[entries++] = entry;
        }
        r->start[i + 1] = entries;
    }
    r->sparse = (pzs_sparse_influence){&pzs_sparse_influence_calls,
                                       {(uint16_t)r->outputs, r->start, r->dof, r->value}};
}

static void fill_vectors(rig *r)
{
    for (unsigned i = 0; i < r->outputs; i++)
        r->weight[i] = (pzs_real)uniform(&r->seed, .5, 1.5);
    for (unsigned j = 0; j < r->inputs; j++) {
        r->lower[j] = (pzs_real)uniform(&r->seed, -2, -.1);
        r->upper[j] = (pzs_real)uniform(&r->seed, .1, 2);
        r->step_limit[j] = (pzs_real)uniform(&r->seed, .2, 3);
        r->reference[j] = (pzs_real)uniform(&r->seed, -1, 1);
    }
}

/* Compute the Hessian as the controller does, so that both problems share its bits. */
static void form_hessian(rig *r)
{
    assert_int_equal(
        pzs_control_init(&r->control[0], &r->full, NULL, r->work[0], sizeof r->work[0]), PZS_OK);
    const pzs_optimiser *optimiser = &r->control[0].state.optimiser;
    for (unsigned i = 0; i < r->inputs; i++)
        for (unsigned j = 0; j < r->inputs; j++)
            r->hessian[i * r->inputs + j] = optimiser->hessian[i * optimiser->width + j];
}

static void open_rig(rig *r, unsigned inputs, unsigned outputs, double density)
{
    r->inputs = inputs;
    r->outputs = outputs;
    fill_matrix(r, density);
    compress(r);
    fill_vectors(r);
    r->full = (pzs_problem){.inputs = (uint16_t)inputs,
                            .outputs = (uint16_t)outputs,
                            .influence = r->influence,
                            .weight = r->weight,
                            .lower = r->lower,
                            .upper = r->upper,
                            .step_limit = r->step_limit,
                            .reference_voltage = r->reference};
    assert_int_equal(pzs_problem_seal(&r->full), PZS_OK);
    form_hessian(r);
    r->full.regularisation = PZS_R(0.01);
    r->full.hessian = r->hessian;
    r->compressed = r->full;
    r->compressed.influence = NULL;
    r->compressed.sparse = &r->sparse;
    assert_int_equal(pzs_problem_seal(&r->full), PZS_OK);
    assert_int_equal(pzs_problem_seal(&r->compressed), PZS_OK);
}

static pzs_status start_sparse(rig *r)
{
    return pzs_control_init(&r->control[1], &r->compressed, NULL, r->work[1], sizeof r->work[1]);
}

static void assert_same_results(const rig *r)
{
    const pzs_control_info *one = &r->control[0].info, *two = &r->control[1].info;
    assert_memory_equal(one->voltage, two->voltage, r->inputs * sizeof(pzs_real));
    assert_memory_equal(one->predicted, two->predicted, r->outputs * sizeof(pzs_real));
    assert_memory_equal(one->disturbance, two->disturbance, r->outputs * sizeof(pzs_real));
    assert_int_equal(one->work, two->work);
}

static void run_both(rig *r)
{
    pzs_real wanted[M], measured[M];
    pzs_report report[2];
    for (unsigned tick = 0; tick < TICKS; tick++) {
        for (unsigned i = 0; i < r->outputs; i++) {
            wanted[i] = (pzs_real)uniform(&r->seed, -3, 3);
            measured[i] = (pzs_real)uniform(&r->seed, -1, 1);
        }
        for (int k = 0; k < 2; k++) {
            const pzs_status status = tick % 3 == 2 ? pzs_step(&r->control[k], wanted)
                                                    : pzs_tick(&r->control[k], wanted, measured);
            assert_false(PZS_IS_ERROR(status));
            assert_int_equal(pzs_assess(&r->control[k], wanted, &report[k]), PZS_OK);
        }
        assert_same_results(r);
        assert_memory_equal(&report[0].relative_error, &report[1].relative_error, sizeof(pzs_real));
        assert_memory_equal(&report[0].kkt_violation, &report[1].kkt_violation, sizeof(pzs_real));
    }
}

/*
 * Law: with a sparse influence matrix, voltages, predictions and certificate have the bits of the
 * full matrix, for every number of inputs that the products treat in another way.
 */
static void test_same_bits(void **state)
{
    static const unsigned sizes[][2] = {{1, 1},   {3, 7},    {14, 20},  {25, 60},   {64, 90},
                                        {127, 9}, {128, 60}, {131, 50}, {132, 120}, {203, 33}};
    static const double densities[] = {0.03, 0.3, 1};
    (void)state;
    desk.seed = 3;
    for (unsigned s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (unsigned d = 0; d < 3; d++) {
            open_rig(&desk, sizes[s][0], sizes[s][1], densities[d]);
            assert_int_equal(pzs_control_init(&desk.control[0], &desk.full, NULL, desk.work[0],
                                              sizeof desk.work[0]),
                             PZS_OK);
            assert_int_equal(start_sparse(&desk), PZS_OK);
            run_both(&desk);
        }
}

/* Law: products of sparse rows have the bits of products of the full table. */
static void test_products(void **state)
{
    (void)state;
    static pzs_real vector[N + 4], full[N], sparse[N];
    desk.seed = 8;
    desk.outputs = M;
    for (desk.inputs = 1; desk.inputs <= N; desk.inputs += desk.inputs < 120 ? 7 : 1) {
        fill_matrix(&desk, .4);
        compress(&desk);
        for (unsigned j = 0; j < N; j++)
            vector[j] = (pzs_real)uniform(&desk.seed, -1, 1);
        pzs_product_matrix(full, desk.influence, vector, M, desk.inputs);
        pzs_product_sparse(sparse, &desk.sparse.rows, vector, desk.inputs);
        assert_memory_equal(full, sparse, M * sizeof *full);
        pzs_product_sum_rows(full, desk.influence, desk.inputs, vector, M, desk.inputs);
        pzs_product_sum_sparse(sparse, &desk.sparse.rows, vector, desk.inputs);
        assert_memory_equal(full, sparse, desk.inputs * sizeof *full);
    }
}

/* Law: a flipped bit anywhere in the sparse matrix is found by the checksum. */
static void test_flipped_bits(void **state)
{
    (void)state;
    desk.seed = 4;
    open_rig(&desk, 25, 60, .2);
    const size_t entries = desk.start[60];
    void *const array[3] = {desk.start, desk.dof, desk.value};
    const size_t bytes[3] = {61 * sizeof *desk.start, entries * sizeof *desk.dof,
                             entries * sizeof *desk.value};
    for (unsigned k = 0; k < FLIPS; k++) {
        const size_t bit = (size_t)uniform(&desk.seed, 0, 8.0 * (double)bytes[k % 3]);
        flip(array[k % 3], bit);
        assert_int_equal(start_sparse(&desk), PZS_E_CRC);
        flip(array[k % 3], bit);
    }
    assert_int_equal(start_sparse(&desk), PZS_OK);
}

/*
 * Assert that a sealed problem is refused at the output `where`, -1 where no output is to blame.
 */
static void assert_refused(int32_t where)
{
    assert_int_equal(pzs_problem_seal(&desk.compressed), PZS_OK);
    assert_int_equal(start_sparse(&desk), PZS_E_ARGUMENT);
    assert_int_equal(desk.control[1].info.where, where);
    desk.sparse.rows.start = desk.start;
    desk.sparse.rows.dof = desk.dof;
    desk.sparse.rows.value = desk.value;
    desk.sparse.rows.count = 60;
    desk.sparse.call = &pzs_sparse_influence_calls;
    desk.compressed.hessian = desk.hessian;
}

/* Law: index lists that would be read or written outside of arrays are refused, with the row. */
static void test_wrong_lists(void **state)
{
    (void)state;
    desk.seed = 5;
    open_rig(&desk, 25, 60, .3);
    uint32_t *start = desk.start;
    uint16_t *dof = desk.dof;
    const uint32_t first = start[7];
    const uint16_t kept = dof[first], other = dof[first + 1];
    dof[first] = 25;
    assert_refused(7);
    dof[first] = other;
    assert_refused(7);
    dof[first] = other, dof[first + 1] = kept;
    assert_refused(7);
    dof[first] = kept, dof[first + 1] = other;
    start[7] = start[60] + 1;
    assert_refused(6);
    start[7] = start[6] - 1;
    assert_refused(6);
    start[7] = first;
    start[0] = 1;
    assert_refused(-1);
    start[0] = 0;
    const uint32_t last = start[60];
    start[60] = 60 * 25 + 1;
    assert_refused(-1);
    start[60] = last;
    desk.sparse.rows.count = 59;
    assert_refused(-1);
    desk.sparse.rows.start = NULL;
    assert_refused(-1);
    desk.sparse.rows.dof = NULL;
    assert_refused(-1);
    desk.sparse.rows.value = NULL;
    assert_refused(-1);
    desk.sparse.call = NULL;
    assert_refused(-1);
    desk.compressed.hessian = NULL;
    assert_refused(-1);
    assert_int_equal(pzs_problem_seal(&desk.compressed), PZS_OK);
    assert_int_equal(start_sparse(&desk), PZS_OK);
}

/* Law: an entry that is not finite is refused with its index. */
static void test_nonfinite(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    desk.seed = 6;
    open_rig(&desk, 25, 60, .3);
    for (unsigned k = 0; k < 3; k++) {
        const pzs_real kept = desk.value[11 + k];
        desk.value[11 + k] = (pzs_real)bad[k];
        assert_int_equal(pzs_problem_seal(&desk.compressed), PZS_OK);
        assert_int_equal(start_sparse(&desk), PZS_E_NONFINITE);
        assert_int_equal(desk.control[1].info.where, 11 + k);
        desk.value[11 + k] = kept;
    }
}

/* Law: a full matrix that the firmware gives is used in the place of the sparse one. */
static void test_given_matrix(void **state)
{
    (void)state;
    static pzs_real doubled[M * N];
    pzs_real wanted[M] = {0};
    desk.seed = 7;
    open_rig(&desk, 25, 60, .3);
    for (unsigned k = 0; k < 25 * 60; k++)
        doubled[k] = 2 * desk.influence[k];
    assert_int_equal(pzs_control_init(&desk.control[1], &desk.compressed, doubled, desk.work[1],
                                      sizeof desk.work[1]),
                     PZS_OK);
    assert_int_equal(
        pzs_control_init(&desk.control[0], &desk.full, doubled, desk.work[0], sizeof desk.work[0]),
        PZS_OK);
    wanted[3] = 1;
    for (int k = 0; k < 2; k++)
        assert_false(PZS_IS_ERROR(pzs_tick(&desk.control[k], wanted, NULL)));
    assert_same_results(&desk);
}

/* ---- in a loop ------------------------------------------------------------- */

static pzs_status start_loop(pzs_loop *loop, const pzs_block *block, int count)
{
    static double work[2 * PZS_CONTROL_BYTES(25, 60)];
    return pzs_loop_init(loop, block, (uint16_t)count, NULL, work, sizeof work);
}

/* Law: damage of the sparse matrix is found while the loop runs, before all slices passed twice. */
static void test_scrub(void **state)
{
    (void)state;
    static pzs_loop loop;
    const pzs_block block[] = {{&pzs_step_block, &desk.compressed}};
    pzs_real wanted[60] = {0};
    desk.seed = 9;
    open_rig(&desk, 25, 60, .3);
    assert_int_equal(start_loop(&loop, block, 1), PZS_OK);
    const size_t bytes = sizeof(pzs_real) * (25 * 25 + 60 + 4 * 25 + desk.start[60]) +
                         sizeof(uint16_t) * desk.start[60] + sizeof(uint32_t) * 61 + 64;
    const size_t most = 2 * (bytes / 64 + 2);
    for (size_t k = 0; k < most; k++)
        assert_int_not_equal(pzs_loop_tick(&loop, wanted, wanted), PZS_E_CRC);
    flip(desk.value, 100);
    size_t ticks = 0;
    while (ticks <= most && pzs_loop_tick(&loop, wanted, wanted) != PZS_E_CRC)
        ticks++;
    assert_true(ticks <= most);
}

/* Law: blocks that read single entries of the influence matrix refuse a sparse one. */
static void test_blocks(void **state)
{
    (void)state;
    static pzs_loop loop;
    pzs_fault_detection detection = {.delay = 0};
    pzs_reading_delay late = {.inputs = 25, .sensors = 60, .delay = 1};
    desk.seed = 10;
    open_rig(&desk, 25, 60, .3);
    assert_int_equal(pzs_reading_delay_seal(&late), PZS_OK);
    const pzs_block_type *const type[] = {&pzs_fault_detector_block, &pzs_reading_delay_block};
    const void *const tables[] = {&detection, &late};
    for (int k = 0; k < 2; k++) {
        const pzs_block before[] = {{type[k], tables[k]}, {&pzs_step_block, &desk.compressed}},
                        after[] = {{&pzs_step_block, &desk.compressed}, {type[k], tables[k]}};
        const bool comes_first = type[k]->phase < pzs_step_block.phase;
        assert_int_equal(start_loop(&loop, comes_first ? before : after, 2), PZS_E_ARGUMENT);
        assert_ptr_equal(loop.info.block, type[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_products),     cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_flipped_bits), cmocka_unit_test(test_wrong_lists),
        cmocka_unit_test(test_nonfinite),    cmocka_unit_test(test_given_matrix),
        cmocka_unit_test(test_scrub),        cmocka_unit_test(test_blocks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
