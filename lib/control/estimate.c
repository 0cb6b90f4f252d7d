/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shape estimator: computes the shape from a few sensors and the model,
 *   B v + G (s - S v)
 *   v, s  voltages, readings
 *   B     influence matrix
 *   S     readings that the voltages make, per volt
 *   G     gain of the tables: G (s - S v) is the most probable shape of all other causes, by the
 *         loads and faults expected in the scene
 *
 * Work of a tick: at most (sensors + outputs) (inputs + sensors) multiply-adds, whatever the data
 * are.
 */
#include <string.h>
#include "estimate.h"
#include "boxls.h"
#include "control.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/product.h"
#include "sensor_check.h"

#define READY 1u
#define PADDED(n) (((size_t)(n) + 3u) & ~(size_t)3u)

/* List the arrays that the checksum of the estimator tables covers. Returns their number. */
static uint32_t list_parts(const pzs_estimator *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&tables->inputs, 3u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->direct, (size_t)tables->sensors * tables->inputs);
    part[2] = scrub_reals(tables->gain, (size_t)tables->outputs * tables->sensors);
    return 3;
}

uint32_t pzs_estimate_crc(const pzs_estimator *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

pzs_status pzs_estimator_seal(pzs_estimator *tables)
{
    if (tables == NULL || tables->direct == NULL || tables->gain == NULL)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = pzs_estimate_crc(tables);
    return PZS_OK;
}

/* ---- estimate of the shape ------------------------------------------- */

static pzs_status check(const pzs_estimator *tables, const pzs_control *control)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != control->state.problem->scene)
        return PZS_E_FORMAT;
    const bool fits = tables->inputs == control->state.problem->inputs &&
                      tables->outputs == control->state.problem->outputs;
    if (tables->direct == NULL || tables->gain == NULL || tables->sensors == 0 || !fits)
        return PZS_E_ARGUMENT;
    if (pzs_estimate_crc(tables) != tables->crc)
        return PZS_E_CRC;
    const bool are_finite =
        pzs_guard_nonfinite(tables->direct, (uint32_t)tables->sensors * tables->inputs) < 0 &&
        pzs_guard_nonfinite(tables->gain, (uint32_t)tables->outputs * tables->sensors) < 0;
    return are_finite ? PZS_OK : PZS_E_NONFINITE;
}

static pzs_status finish(pzs_estimate *estimate, pzs_status status, int32_t where)
{
    estimate->info.where = where;
    return status;
}

/* Set the pointers of the shape estimator to its controller, its tables and its arrays. */
static void place(pzs_estimate *estimate, pzs_control *control, const pzs_estimator *tables,
                  void *work)
{
    const size_t padded = PADDED(tables->sensors);
    pzs_real *first = work;
    estimate->state.control = control;
    estimate->state.tables = tables;
    estimate->state.expected = first;
    estimate->state.sensed = first + padded;
    estimate->state.difference = first + 2 * padded;
    estimate->state.repeats = (uint8_t *)(first + 3 * padded);
    estimate->state.stage = READY;
}

pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control,
                             const pzs_estimator *tables, void *work, size_t bytes)
{
    if (estimate == NULL)
        return PZS_E_ARGUMENT;
    memset(estimate, 0, sizeof *estimate);
    if (control == NULL || tables == NULL || work == NULL)
        return finish(estimate, PZS_E_ARGUMENT, -1);
    const pzs_status status =
        control->state.stage == CONTROL_READY ? check(tables, control) : PZS_E_STAGE;
    if (status != PZS_OK)
        return finish(estimate, status, -1);
    const size_t need = PZS_ESTIMATE_BYTES(tables->sensors);
    const int32_t missing = guard_missing_bytes(work, bytes, need);
    if (missing >= 0)
        return finish(estimate, PZS_E_WORKSPACE, missing);
    memset(work, 0, need);
    place(estimate, control, tables, work);
    return finish(estimate, PZS_OK, -1);
}

pzs_status pzs_estimate_tick(pzs_estimate *estimate, const pzs_real *sensed, pzs_real *shape)
{
    if (estimate == NULL || sensed == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (estimate->state.stage != READY)
        return PZS_E_STAGE;
    const pzs_estimator *tables = estimate->state.tables;
    const sensor_check all = {tables->sensors, estimate->state.expected, estimate->state.sensed,
                              estimate->state.difference, estimate->state.repeats};
    int32_t where = -1;
    bool is_repeated = true;
    pzs_product_matrix(estimate->state.expected, tables->direct,
                       estimate->state.control->state.voltage, tables->sensors, tables->inputs);
    const uint32_t unusable = pzs_sensor_check(&all, sensed, &where, &is_repeated);
    pzs_control_predict(estimate->state.control);
    pzs_product_matrix(shape, tables->gain, estimate->state.difference, tables->outputs,
                       tables->sensors);
    for (uint32_t i = 0; i < tables->outputs; i++)
        shape[i] += estimate->state.control->state.predicted[i];
    const pzs_status warning = unusable < tables->sensors ? PZS_W_SENSOR : PZS_W_HELD;
    return finish(estimate, unusable == 0 ? PZS_OK : warning, where);
}

/* ---- block of the control loop --------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_estimator *estimator = tables;
    return PZS_ESTIMATOR_BLOCK_BYTES(estimator->sensors, problem->outputs);
}

static void *work_of(pzs_estimate *estimate)
{
    return (uint8_t *)estimate + PZS_ALIGNED(sizeof *estimate);
}

/*
 * Initialise the shape estimator as a block (stage of the control tick). Its memory holds the
 * struct pzs_estimate, then the workspace of the estimator, then the estimated shape.
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_estimator *estimator = tables;
    pzs_estimate *estimate = self;
    const pzs_status status =
        pzs_estimate_init(estimate, signals->control, estimator, work_of(estimate),
                          PZS_ESTIMATE_BYTES(estimator->sensors));
    signals->where = estimate->info.where;
    signals->sensors = estimator->sensors;
    return status;
}

static pzs_real *shape_of(pzs_estimate *estimate)
{
    const size_t before = PZS_ALIGNED(sizeof *estimate) +
                          PZS_ALIGNED(PZS_ESTIMATE_BYTES(estimate->state.tables->sensors));
    return (void *)((uint8_t *)estimate + before);
}

/* Run the shape estimator in a control tick. A tick without readings has no measured shape. */
static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_estimate *estimate = self;
    place(estimate, signals->control, signals->tables, work_of(estimate));
    signals->measured = NULL;
    if (signals->readings == NULL)
        return PZS_OK;
    pzs_real *shape = shape_of(estimate);
    const pzs_status status = pzs_estimate_tick(estimate, signals->readings, shape);
    signals->measured = shape;
    signals->where = estimate->info.where;
    return status;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_estimator *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_estimator_block = {"estimator", PZS_PHASE_SHAPE, block_bytes,
                                            block_init,  block_tick,      block_parts};
