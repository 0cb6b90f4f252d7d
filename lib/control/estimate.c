/*
 * The shape from a few sensors, through the model: y = B v + G (s - S v), what the volts make and,
 * as likely as the loads and faults that the tables were made for, what makes the sensors show
 * something else.
 *
 * Work of a tick: (sensors + outputs) (inputs + sensors) multiply-adds at most; nothing depends on
 * the data.
 */
#include <string.h>
#include "estimate.h"
#include "boxls.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/product.h"
#include "sense.h"

#define READY 1u
#define FOURS(n) (((size_t)(n) + 3u) & ~(size_t)3u)

uint32_t pzs_estimate_crc(const pzs_estimator *t)
{
    const uint16_t counts[3] = {t->inputs, t->outputs, t->sensors};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = pzs_guard_crc(crc, t->direct, (size_t)t->sensors * t->inputs * sizeof(pzs_real));
    return ~pzs_guard_crc(crc, t->gain, (size_t)t->outputs * t->sensors * sizeof(pzs_real));
}

pzs_status pzs_estimator_seal(pzs_estimator *tables)
{
    if (tables == NULL || tables->direct == NULL || tables->gain == NULL)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = pzs_estimate_crc(tables);
    return PZS_OK;
}

/* ---- estimate --------------------------------------------------------- */

static pzs_status check(const pzs_estimator *t, const pzs_control *c)
{
    if (t->format != PZS_TABLE_FORMAT || t->scene != c->state.problem->scene)
        return PZS_E_FORMAT;
    const int fits =
        t->inputs == c->state.problem->inputs && t->outputs == c->state.problem->outputs;
    if (t->direct == NULL || t->gain == NULL || t->sensors == 0 || !fits)
        return PZS_E_ARGUMENT;
    if (pzs_estimate_crc(t) != t->crc)
        return PZS_E_CRC;
    const int finite = pzs_guard_nonfinite(t->direct, (uint32_t)t->sensors * t->inputs) < 0 &&
                       pzs_guard_nonfinite(t->gain, (uint32_t)t->outputs * t->sensors) < 0;
    return finite ? PZS_OK : PZS_E_NONFINITE;
}

static pzs_status finish(pzs_estimate *e, pzs_status status, int32_t where)
{
    e->info.where = where;
    return status;
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
    const size_t need = PZS_ESTIMATE_BYTES(tables->sensors), padded = FOURS(tables->sensors);
    const int32_t lacking = guard_missing_bytes(work, bytes, need);
    if (lacking >= 0)
        return finish(estimate, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    pzs_real *at = work;
    estimate->state.control = control;
    estimate->state.tables = tables;
    estimate->state.expected = at, at += padded;
    estimate->state.sensed = at, at += padded;
    estimate->state.difference = at, at += padded;
    estimate->state.repeats = (uint8_t *)at;
    estimate->state.stage = READY;
    return finish(estimate, PZS_OK, -1);
}

pzs_status pzs_estimate_tick(pzs_estimate *e, const pzs_real *sensed, pzs_real *shape)
{
    if (e == NULL || sensed == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (e->state.stage != READY)
        return PZS_E_STAGE;
    const pzs_estimator *t = e->state.tables;
    const sensor_set all = {t->sensors, e->state.expected, e->state.sensed, e->state.difference,
                            e->state.repeats};
    int32_t where = -1;
    pzs_product_matrix(e->state.expected, t->direct, e->state.control->state.voltage, t->sensors,
                       t->inputs);
    const uint32_t lost = pzs_sensor_check(&all, sensed, &where);
    pzs_control_predict(e->state.control);
    pzs_product_matrix(shape, t->gain, e->state.difference, t->outputs, t->sensors);
    for (uint32_t i = 0; i < t->outputs; i++)
        shape[i] += e->state.control->state.predicted[i];
    return finish(e, lost == 0 ? PZS_OK : lost < t->sensors ? PZS_W_SENSOR : PZS_W_HELD, where);
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_estimator *t = tables;
    return PZS_ESTIMATOR_BLOCK_BYTES(t->sensors, problem->outputs);
}

/* In `self`: the estimate, its workspace, the shape. */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_estimator *t = tables;
    pzs_estimate *e = self;
    void *work = (uint8_t *)self + PZS_ALIGNED(sizeof *e);
    const pzs_status status =
        pzs_estimate_init(e, signals->control, t, work, PZS_ESTIMATE_BYTES(t->sensors));
    signals->where = e->info.where;
    signals->sensors = t->sensors;
    return status;
}

static pzs_real *shape_of(pzs_estimate *e)
{
    const size_t before =
        PZS_ALIGNED(sizeof *e) + PZS_ALIGNED(PZS_ESTIMATE_BYTES(e->state.tables->sensors));
    return (void *)((uint8_t *)e + before);
}

/* Without a frame there is no new shape either. */
static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_estimate *e = self;
    signals->measured = NULL;
    if (signals->readings == NULL)
        return PZS_OK;
    pzs_real *shape = shape_of(e);
    const pzs_status status = pzs_estimate_tick(e, signals->readings, shape);
    signals->measured = shape;
    signals->where = e->info.where;
    return status;
}

const pzs_block_type pzs_estimator_block = {"estimator", PZS_PHASE_SHAPE, block_bytes, block_init,
                                            block_tick};
