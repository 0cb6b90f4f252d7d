/*
 * The shape from a few sensors, through the model: y = B v + G (s - S v), what the volts make and, as likely as the
 * loads and faults that the tables were made for, what makes the sensors show something else. And the shape that known
 * loads make.
 *
 * Work of a tick: (sensors + outputs) (inputs + sensors) multiply-adds at most; nothing depends on the data.
 */
#include <string.h>
#include "estimate.h"
#include "boxls.h"
#include "control.h"
#include "guard.h"
#include "product.h"
#include "sense.h"

#define READY 1u
#define FOURS(n) (((size_t)(n) + 3u) & ~(size_t)3u)

uint32_t estimate_crc(const pzs_estimator *t)
{
    const uint16_t counts[3] = {t->inputs, t->outputs, t->sensors};
    uint32_t crc = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = guard_crc(crc, t->direct, (size_t)t->sensors * t->inputs * sizeof(pzs_real));
    return ~guard_crc(crc, t->gain, (size_t)t->outputs * t->sensors * sizeof(pzs_real));
}

uint32_t estimate_known_crc(const pzs_known *t)
{
    const uint16_t counts[2] = {t->amounts, t->outputs};
    const uint32_t crc = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    return ~guard_crc(crc, t->per, (size_t)t->outputs * t->amounts * sizeof(pzs_real));
}

/* ---- estimate --------------------------------------------------------- */

static pzs_status check(const pzs_estimator *t, const pzs_control *c)
{
    if (t->format != PZS_TABLE_FORMAT || t->scene != c->problem->scene)
        return PZS_E_FORMAT;
    const int fits = t->inputs == c->problem->inputs && t->outputs == c->problem->outputs;
    if (t->direct == NULL || t->gain == NULL || t->sensors == 0 || !fits)
        return PZS_E_ARGUMENT;
    if (estimate_crc(t) != t->crc)
        return PZS_E_CRC;
    const int finite = guard_nonfinite(t->direct, (uint32_t)t->sensors * t->inputs) < 0
                       && guard_nonfinite(t->gain, (uint32_t)t->outputs * t->sensors) < 0;
    return finite ? PZS_OK : PZS_E_NONFINITE;
}

static pzs_status finish(pzs_estimate *e, pzs_status status, int32_t where)
{
    e->where = where;
    return status;
}

pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control, const pzs_estimator *tables, void *work,
                             size_t bytes)
{
    if (estimate == NULL)
        return PZS_E_ARGUMENT;
    memset(estimate, 0, sizeof *estimate);
    if (control == NULL || tables == NULL || work == NULL)
        return finish(estimate, PZS_E_ARGUMENT, -1);
    const pzs_status status = control->stage == CONTROL_READY ? check(tables, control) : PZS_E_STAGE;
    if (status != PZS_OK)
        return finish(estimate, status, -1);
    const size_t need = PZS_ESTIMATE_BYTES(tables->sensors), padded = FOURS(tables->sensors);
    const int32_t lacking = guard_short(work, bytes, need);
    if (lacking >= 0)
        return finish(estimate, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    pzs_real *at = work;
    estimate->control = control;
    estimate->tables = tables;
    estimate->expected = at, at += padded;
    estimate->sensed = at, at += padded;
    estimate->difference = at, at += padded;
    estimate->frozen = (uint8_t *)at;
    estimate->stage = READY;
    return finish(estimate, PZS_OK, -1);
}

pzs_status pzs_estimate_tick(pzs_estimate *e, const pzs_real *sensed, pzs_real *shape)
{
    if (e == NULL || sensed == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (e->stage != READY)
        return PZS_E_STAGE;
    const pzs_estimator *t = e->tables;
    const senses all = { t->sensors, e->expected, e->sensed, e->difference, e->frozen };
    int32_t where = -1;
    product(e->expected, t->direct, e->control->volt, t->sensors, t->inputs);
    const uint32_t lost = sense(&all, sensed, &where);
    control_predict(e->control);
    product(shape, t->gain, e->difference, t->outputs, t->sensors);
    for (uint32_t i = 0; i < t->outputs; i++)
        shape[i] += e->control->predicted[i];
    return finish(e, lost == 0 ? PZS_OK : lost < t->sensors ? PZS_W_SENSOR : PZS_W_HELD, where);
}

/* ---- known loads ------------------------------------------------------ */

pzs_status pzs_known_check(const pzs_known *t)
{
    if (t == NULL || t->per == NULL || t->amounts == 0 || t->outputs == 0)
        return PZS_E_ARGUMENT;
    if (t->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (estimate_known_crc(t) != t->crc)
        return PZS_E_CRC;
    return guard_nonfinite(t->per, (uint32_t)t->outputs * t->amounts) < 0 ? PZS_OK : PZS_E_NONFINITE;
}

pzs_status pzs_feed_forward(const pzs_known *t, const pzs_real *amount, pzs_real *shape)
{
    if (t == NULL || amount == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (guard_nonfinite(amount, t->amounts) >= 0)
        return PZS_E_NONFINITE;
    for (uint32_t i = 0; i < t->outputs; i++) {
        const pzs_real *row = t->per + (size_t)i * t->amounts;
        for (uint32_t k = 0; k < t->amounts; k++)
            shape[i] -= row[k] * amount[k];
    }
    return PZS_OK;
}
