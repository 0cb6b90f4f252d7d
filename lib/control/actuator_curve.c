/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Curves of actuators whose displacement is not proportional to their voltage, such as
 * electrostatic ones, and their inverse. The effect e of an actuator is the function of its voltage
 * v to which its displacement is proportional. Between two points (v0, e0) and (v1, e1) of a curve
 *
 *   e = e0 + (e1 - e0) t (1 - b (1 - t)),  t = (v - v0) / (v1 - v0)
 *   b  bend of the segment, from -1 to 1: 0 for a straight line; the slope at the beginning is
 *      1 - b and that at the end 1 + b times the slope of the straight line
 *
 *   - With y = (e - e0) / (e1 - e0) the inverse is t = 2 y / (1 - b + sqrt((1 - b)^2 + 4 b y)), a
 *     sum without cancellation. The inverse needs no iterations.
 *   - An effect at a point of the curve has exactly the voltage of the point, and conversely.
 *   - The segment is found by bisection, in at most 7 steps (PZS_CURVE_POINTS).
 */
#include <string.h>
#include "actuator_curve.h"
#include "effect_range.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/* ---- tables ----------------------------------------------------------- */

/* List the arrays that the checksum of actuator curves covers. Returns their number. */
static uint32_t list_parts(const pzs_actuator_curves *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t points = (size_t)tables->sets * tables->points;
    part[0] = (pzs_table_part){&tables->inputs, 3u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->voltage, points);
    part[2] = scrub_reals(tables->effect, points);
    part[3] = scrub_reals(tables->bend, points - tables->sets);
    return 4;
}

static uint32_t checksum(const pzs_actuator_curves *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool are_complete(const pzs_actuator_curves *tables)
{
    const bool has_sets = tables->sets == 1 || tables->sets == tables->inputs;
    return tables->inputs > 0 && has_sets && tables->points >= 2 &&
           tables->points <= PZS_CURVE_POINTS && tables->voltage != NULL && tables->effect != NULL;
}

pzs_status pzs_actuator_curves_seal(pzs_actuator_curves *tables)
{
    if (tables == NULL || !are_complete(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = checksum(tables);
    return PZS_OK;
}

/*
 * Curve of one actuator: its effect, to which its displacement is proportional, as a function of
 * its voltage.
 */
typedef struct actuator_curve {
    const pzs_real *voltage; /* [points] voltages of the points of the curve, ascending (V) */
    const pzs_real *effect; /* [points] effects (values to which the displacement of the actuator is
                               proportional) at the points of the curve, ascending */
    const pzs_real *bend; /* [points - 1] bend of each segment of the curve (dimensionless): 0 for a
                             straight line, otherwise positive or negative curvature, from -1 to 1;
                             NULL: all are 0 */
    uint32_t points;
} actuator_curve;

static actuator_curve curve_of(const pzs_actuator_curves *tables, uint32_t input)
{
    const size_t set = tables->sets > 1 ? input : 0, first = set * tables->points;
    const actuator_curve result = {tables->voltage + first, tables->effect + first,
                                   tables->bend != NULL ? tables->bend + first - set : NULL,
                                   tables->points};
    return result;
}

/* Whether numbers are finite and each is larger than the one before. */
static bool are_rising(const pzs_real *number, uint32_t count)
{
    const pzs_real most = PZS_BY_BITS(1e30f, 1e30);
    uint32_t i = 1;
    while (i < count && number[i] > number[i - 1])
        i++;
    return i == count && number[0] >= -most && number[count - 1] <= most;
}

/* Whether all bends of a curve lie between -1 and 1, so that the curve falls nowhere. */
static bool are_bends_valid(const actuator_curve *curve)
{
    uint32_t i = 0;
    while (curve->bend != NULL && i + 1 < curve->points && curve->bend[i] >= -1 &&
           curve->bend[i] <= 1)
        i++;
    return curve->bend == NULL || i + 1 == curve->points;
}

/*
 * Whether the curve of input k is valid: finite, ascending, and defined between the voltage limits
 * of the input.
 */
static bool is_valid(const actuator_curve *curve, const pzs_problem *problem, uint32_t k)
{
    return are_rising(curve->voltage, curve->points) && are_rising(curve->effect, curve->points) &&
           are_bends_valid(curve) && curve->voltage[0] <= problem->lower[k] &&
           curve->voltage[curve->points - 1] >= problem->upper[k];
}

/*
 * Return the largest absolute effect on the curve of an actuator; the displacement of the actuator
 * is proportional to its effect.
 */
static pzs_real largest_effect(const actuator_curve *curve)
{
    const pzs_real first = number_absolute(curve->effect[0]);
    const pzs_real last = number_absolute(curve->effect[curve->points - 1]);
    return first > last ? first : last;
}

/* ---- one actuator ----------------------------------------------------- */

/*
 * Return the segment that contains a number between the first and the last of ascending numbers:
 * number[i] <= value < number[i + 1].
 */
static uint32_t segment_of(const pzs_real *number, uint32_t count, pzs_real value)
{
    uint32_t low = 0, high = count - 1;
    while (high - low > 1) {
        const uint32_t middle = (low + high) / 2;
        const bool is_above = value >= number[middle];
        low = is_above ? middle : low;
        high = is_above ? high : middle;
    }
    return low;
}

static pzs_real bend_of(const actuator_curve *curve, uint32_t segment)
{
    return curve->bend != NULL ? curve->bend[segment] : 0;
}

static pzs_real smaller(pzs_real one, pzs_real other)
{
    return one < other ? one : other;
}

static pzs_real effect_at(const actuator_curve *curve, pzs_real voltage)
{
    const uint32_t last = curve->points - 1;
    if (!(voltage > curve->voltage[0]))
        return curve->effect[0];
    if (!(voltage < curve->voltage[last]))
        return curve->effect[last];
    const uint32_t i = segment_of(curve->voltage, curve->points, voltage);
    const pzs_real *v = curve->voltage + i, *e = curve->effect + i;
    const pzs_real bend = bend_of(curve, i), t = (voltage - v[0]) / (v[1] - v[0]);
    return smaller(e[0] + (e[1] - e[0]) * (t * ((1 - bend) + bend * t)), e[1]);
}

static pzs_real voltage_at(const actuator_curve *curve, pzs_real effect)
{
    const uint32_t last = curve->points - 1;
    if (!(effect > curve->effect[0]))
        return curve->voltage[0];
    if (!(effect < curve->effect[last]))
        return curve->voltage[last];
    const uint32_t i = segment_of(curve->effect, curve->points, effect);
    const pzs_real *v = curve->voltage + i, *e = curve->effect + i;
    const pzs_real bend = bend_of(curve, i), y = (effect - e[0]) / (e[1] - e[0]);
    const pzs_real square = (1 - bend) * (1 - bend) + 4 * bend * y;
    if (!(y > 0) || !(square > 0))
        return v[y > 0 ? 1 : 0];
    const pzs_real t = 2 * y / ((1 - bend) + PZS_SQRT(square));
    return smaller(v[0] + t * (v[1] - v[0]), v[1]);
}

pzs_real pzs_actuator_curve_effect(const pzs_actuator_curves *tables, uint32_t input,
                                   pzs_real voltage)
{
    const actuator_curve curve = curve_of(tables, input);
    return effect_at(&curve, voltage);
}

pzs_real pzs_actuator_curve_voltage(const pzs_actuator_curves *tables, uint32_t input,
                                    pzs_real effect)
{
    const actuator_curve curve = curve_of(tables, input);
    return voltage_at(&curve, effect);
}

/* ---- blocks ----------------------------------------------------------- */

/*
 * Whether the effect of the reference voltage of input k equals this voltage. The displacement of
 * an actuator is proportional to its effect. The regularisation draws the effect of an input to the
 * reference voltage, and thus draws the voltage there only if both are equal.
 */
static bool is_reference_kept(const actuator_curve *curve, const pzs_problem *problem, uint32_t k)
{
    const pzs_real reference = problem->reference_voltage[k];
    const pzs_real error = number_absolute(effect_at(curve, reference) - reference);
    return !(problem->regularisation > 0) ||
           error <= EFFECT_ROUNDING * PZS_EPSILON * largest_effect(curve);
}

static pzs_status check_curves(const pzs_actuator_curves *tables, const pzs_problem *problem,
                               int32_t *where)
{
    for (uint32_t k = 0; k < tables->inputs; k++) {
        const actuator_curve curve = curve_of(tables, k);
        *where = (int32_t)k;
        if (!is_valid(&curve, problem, k))
            return PZS_E_LIMITS;
        if (!is_reference_kept(&curve, problem, k))
            return PZS_E_ARGUMENT;
    }
    *where = -1;
    return PZS_OK;
}

static pzs_status check(const pzs_actuator_curves *tables, const pzs_problem *problem,
                        int32_t *where)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    /*
     * Actuator curves are refused where sums of voltages are limited, because the optimiser would
     * limit sums of effects instead (values to which the displacements of the actuators are
     * proportional).
     */
    if (!are_complete(tables) || tables->inputs != problem->inputs || problem->limit_rows != NULL)
        return PZS_E_ARGUMENT;
    if (checksum(tables) != tables->crc)
        return PZS_E_CRC;
    return check_curves(tables, problem, where);
}

static size_t curve_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_CURVE_BLOCK_BYTES(problem->inputs);
}

static pzs_real *effects_of(pzs_actuator_effects *effects)
{
    return (void *)((uint8_t *)effects + PZS_ALIGNED(sizeof *effects));
}

/*
 * Compute the effects of the voltages of the last tick: values to which the displacements of the
 * actuators are proportional.
 *   effect [inputs] out, may be the array of the voltages
 */
static void find_effects(const pzs_actuator_curves *tables, pzs_real *effect,
                         const pzs_real *voltage)
{
    for (uint32_t k = 0; k < tables->inputs; k++)
        effect[k] = pzs_actuator_curve_effect(tables, k, voltage[k]);
}

/*
 * Replace voltages [inputs] by their effects, values to which the displacements of the actuators
 * are proportional (pzs_loop_signals.take_effects).
 */
static void take_effects(const pzs_loop_signals *signals, pzs_real *voltage)
{
    find_effects(signals->curves, voltage, voltage);
}

static pzs_status curve_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_actuator_effects *effects = self;
    /*
     * Actuator curves are refused together with the compensation of hysteresis. The curves replace
     * voltages by values to which the displacements are proportional, and the compensation would
     * take these for voltages.
     */
    if (signals->has_inverse || signals->curves != tables)
        return PZS_E_STAGE;
    effects->effect = effects_of(effects);
    find_effects(tables, effects_of(effects), signals->control->state.voltage);
    return PZS_OK;
}

/*
 * Whether the effects of the voltages of the last tick equal those that the controller has chosen,
 * up to rounding errors. The displacement of an actuator is proportional to its effect.
 *   effect [inputs] in
 */
static bool is_known(const pzs_actuator_curves *tables, const pzs_control *control,
                     const pzs_real *effect)
{
    const pzs_real *base = control->state.optimiser.base;
    uint32_t k = 0;
    for (; k < tables->inputs; k++) {
        const actuator_curve curve = curve_of(tables, k);
        const pzs_real most = EFFECT_ROUNDING * PZS_EPSILON * largest_effect(&curve);
        if (!(number_absolute(effect[k] - base[k]) <= most))
            break;
    }
    return k == tables->inputs && control->state.behind == PZS_BEHIND_NOTHING;
}

/*
 * Replace voltages and voltage limits in the controller by effects, values to which the
 * displacements of the actuators are proportional. The limits become the effects of the lowest and
 * the highest voltage that this tick allows.
 */
static pzs_status curve_tick(void *self, pzs_loop_signals *signals)
{
    pzs_actuator_effects *effects = self;
    pzs_control *control = signals->control;
    const pzs_actuator_curves *tables = signals->tables;
    pzs_real *effect = effects_of(effects);
    effects->effect = effect;
    signals->where = -1;
    find_effects(tables, effect, signals->given);
    for (uint32_t k = 0; k < tables->inputs; k++) {
        pzs_real low, high;
        const actuator_curve curve = curve_of(tables, k);
        if (!effect_set_range(control, k, signals->given[k], &low, &high) && signals->where < 0)
            signals->where = (int32_t)k;
        control->state.lower[k] = effect_at(&curve, low);
        control->state.upper[k] = effect_at(&curve, high);
    }
    effect_take(control, effect, is_known(tables, control, effect));
    signals->curves = tables;
    signals->take_effects = take_effects;
    return signals->where < 0 ? PZS_OK : PZS_W_STEP_LIMIT;
}

static size_t inverse_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    (void)problem;
    return 0;
}

static pzs_status inverse_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_status status = check(tables, signals->control->state.problem, &signals->where);
    (void)self;
    if (status != PZS_OK)
        return status;
    signals->curves = tables;
    signals->take_effects = take_effects;
    return PZS_OK;
}

/*
 * Return the voltage, inside the range [low, high] that this tick allows, that has the effect which
 * the optimiser has chosen for an input. The displacement of an actuator is proportional to its
 * effect.
 *   given in  voltage of the last tick (V)
 */
static pzs_real voltage_of(const actuator_curve *curve, pzs_real wanted, pzs_real given,
                           pzs_real low, pzs_real high)
{
    /*
     * Damaged memory may give a wanted effect (proportional to the displacement of the actuator)
     * that is not finite; the last voltage is then kept.
     */
    if (!number_is_finite(wanted))
        return number_clamp(given, low, high);
    if (!(wanted < effect_at(curve, high)))
        return high;
    if (!(wanted > effect_at(curve, low)))
        return low;
    return number_clamp(voltage_at(curve, wanted), low, high);
}

/*
 * Replace the effects that the optimiser has chosen (values to which the displacements of the
 * actuators are proportional) by voltages. During the control step, limits of effects stood in the
 * place of the voltage limits and step limits. The latter are first computed again, bit by bit as
 * before.
 */
static pzs_status inverse_tick(void *self, pzs_loop_signals *signals)
{
    pzs_control *control = signals->control;
    const pzs_actuator_curves *tables = signals->tables;
    (void)self;
    if (signals->curves != tables)
        return PZS_E_STAGE;
    pzs_control_restore_limits(control);
    for (uint32_t k = 0; k < tables->inputs; k++) {
        pzs_real low, high;
        const actuator_curve curve = curve_of(tables, k);
        const pzs_real given = signals->given[k], wanted = control->state.voltage[k];
        (void)effect_set_range(control, k, given, &low, &high);
        control->state.voltage[k] = voltage_of(&curve, wanted, given, low, high);
    }
    return PZS_OK;
}

static uint32_t curve_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_actuator_curves *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_curve_block = {"curve",    PZS_PHASE_READINGS, curve_bytes,
                                        curve_init, curve_tick,         curve_parts};
const pzs_block_type pzs_curve_inverse_block = {"curve inverse", PZS_PHASE_VOLTAGE, inverse_bytes,
                                                inverse_init,    inverse_tick,      NULL};
