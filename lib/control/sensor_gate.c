/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sensor gate: readings that cannot be become missing readings before any other block sees them.
 *
 *   - Range: a reading whose size exceeds its range is missing in this tick.
 *   - Redundancy: parity relations are sums over all readings that are zero for whatever voltages,
 *     observed vibration modes and loads of the scene make of them. Their values y are zero but for
 *     noise and for what the model leaves out. An error e_i of reading i adds e_i P_i to them, with
 *     row i of the parity table P.
 *
 * Sensors are gated only if their errors explain y: the error of each exceeds its threshold, and
 * |e_i P_i| is `ratio` times the norm of what the least-squares fit of the errors leaves of y. An
 * unknown load also violates the relations, but it moves the neighbours of each sensor, too, so
 * that no few sensors explain it.
 *
 * A tick adds at most one sensor, the one that would explain most of y, to those that it suspects.
 * As long as they do not explain y, their readings are used, and the next tick adds another one. A
 * gated sensor is trusted again when it has agreed with the others for `patience` ticks. Where the
 * relations hold for all that the model knows (`replaces`), readings without the estimated errors
 * replace gated and missing ones.
 *
 * Work of a tick (multiply-adds): sensors * quick. Where a reading is missing or gated, or the
 * first `quick` values of y are large enough for a sensor to be wrong: sensors * (2 * relations),
 * and at most 2 * most * most * relations more.
 */
#include <string.h>
#include "pzs_loop.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Smallest square of the part of a row of the parity table, relative to the row, that lies outside
 * the rows of the sensors excluded before, for a sensor to be suspected. Where the part is smaller,
 * the error of the reading can hardly be distinguished from theirs.
 */
#define LEAST_SUSPECT PZS_R(0.02)
/*
 * The same square for a sensor whose reading is missing or gated already. A smaller part means that
 * the errors of the sensors before explain all that this one can do, but for rounding.
 */
#define LEAST_EXCLUDED PZS_R(1e-5)
/* The same square for a reading to be replaced. */
#define LEAST_REPLACED PZS_R(0.05)
/* Part of its threshold below which the error of a gated sensor counts as gone. */
#define GONE PZS_R(0.5)

/* List the arrays that the checksum of the sensor gate's tables covers. Returns their number. */
static uint32_t list_parts(const pzs_sensor_gate *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t sensors = tables->sensors, judged = tables->relations > 0 ? sensors : 0;
    part[0] = (pzs_table_part){&tables->sensors, 6u * sizeof tables->sensors};
    part[1] = scrub_reals(tables->range, sensors);
    part[2] = scrub_reals(tables->parity, sensors * tables->relations);
    part[3] = scrub_reals(tables->scale, judged);
    part[4] = scrub_reals(tables->threshold, judged);
    part[5] = scrub_reals(&tables->quiet, 2);
    return 6;
}

static uint32_t crc_of(const pzs_sensor_gate *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool has_arrays(const pzs_sensor_gate *tables)
{
    const bool is_judged =
        tables->parity != NULL && tables->scale != NULL && tables->threshold != NULL;
    return tables->sensors > 0 && tables->range != NULL && (tables->relations == 0 || is_judged);
}

pzs_status pzs_sensor_gate_seal(pzs_sensor_gate *tables)
{
    if (tables == NULL || !has_arrays(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = crc_of(tables);
    return PZS_OK;
}

/* ---- check of the tables ----------------------------------------------- */

static bool has_sizes(const pzs_sensor_gate *tables, uint16_t sensors)
{
    const bool is_judged = tables->relations > 0;
    return has_arrays(tables) && tables->sensors == sensors && tables->relations < sensors &&
           tables->most <= PZS_SENSOR_GATE_LIMIT && tables->most <= tables->relations &&
           (tables->most > 0) == is_judged && tables->quick <= tables->relations &&
           (tables->quick > 0) == is_judged &&
           (!is_judged || (tables->patience > 0 && tables->ratio >= 1 && tables->quiet >= 0));
}

/* Return the index of the first number that is not above 0, which may be NaN, or -1. */
static int32_t find_not_positive(const pzs_real *value, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!(value[i] > 0))
            return (int32_t)i;
    return -1;
}

/* Return the index of the first number below 0, or -1. */
static int32_t find_negative(const pzs_real *value, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (value[i] < 0)
            return (int32_t)i;
    return -1;
}

/* Return the first sensor with a range or threshold not above 0, or a scale below 0, or -1. */
static int32_t find_bad_sensor(const pzs_sensor_gate *tables)
{
    const uint32_t judged = tables->relations > 0 ? tables->sensors : 0;
    int32_t bad = find_not_positive(tables->range, tables->sensors);
    bad = bad < 0 ? find_not_positive(tables->threshold, judged) : bad;
    return bad < 0 ? find_negative(tables->scale, judged) : bad;
}

static bool is_finite_table(const pzs_sensor_gate *tables)
{
    const uint32_t sensors = tables->sensors, relations = tables->relations;
    return relations == 0 || (pzs_guard_nonfinite(tables->parity, sensors * relations) < 0 &&
                              pzs_guard_nonfinite(tables->scale, sensors) < 0);
}

static pzs_status check(const pzs_sensor_gate *tables, const pzs_loop_signals *signals,
                        int32_t *where)
{
    const uint32_t scene = signals->control->state.problem->scene;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != scene)
        return PZS_E_FORMAT;
    if (!has_sizes(tables, signals->sensors))
        return PZS_E_ARGUMENT;
    if (crc_of(tables) != tables->crc)
        return PZS_E_CRC;
    if (!is_finite_table(tables))
        return PZS_E_NONFINITE;
    *where = find_bad_sensor(tables);
    return *where < 0 ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- sensors whose errors are estimated ---------------------------------- */

/*
 * The sensors of a tick whose errors are estimated, in the order in which they were excluded from
 * the trusted ones. Their rows of the parity table are factored: row k is the sum over m <= k of
 * factor_mk times row m of pzs_sensor_gate_state.column, with factor_mk in the array `factor`.
 */
typedef struct exclusions {
    uint32_t count;
    uint32_t absent; /* number of sensors that have no usable reading, or are suspected or gated */
    uint16_t sensor[PZS_SENSOR_GATE_LIMIT];
    pzs_real part[PZS_SENSOR_GATE_LIMIT];  /* parts of the values of the parity relations along the
                                              rows of the array `column` */
    pzs_real error[PZS_SENSOR_GATE_LIMIT]; /* estimated error of each reading (unit of the sensor);
                                              a reading without a value counts as 0 */
    pzs_real left;       /* norm of what the errors leave of the values of the parity relations */
    int32_t unexplained; /* sensor that would explain most of a contradiction which the excluded
                            sensors do not explain; -1: there is no such contradiction */
} exclusions;

static size_t width_of(const pzs_sensor_gate_state *gate)
{
    return PZS_FOURS(gate->tables->relations);
}

/* Return the address of entry [row][column] of the array `factor`. */
static pzs_real *factor_of(const pzs_sensor_gate_state *gate, uint32_t row, uint32_t column)
{
    return gate->factor + row * gate->tables->most + column;
}

static bool is_usable(const pzs_sensor_gate_state *gate, uint32_t sensor)
{
    return gate->reading[sensor] == PZS_READING_USED;
}

/* Subtract `factor` times a vector [count] from another. */
static void subtract(pzs_real *from, pzs_real factor, const pzs_real *vector, size_t count)
{
    for (size_t i = 0; i < count; i++)
        from[i] -= factor * vector[i];
}

/*
 * Estimate the error of one more sensor: its part is taken out of the values of the parity
 * relations. Returns false and changes nothing where no more than the part `least` of the square of
 * its row lies outside the rows of the sensors excluded before.
 */
static bool exclude(pzs_sensor_gate_state *gate, exclusions *excluded, uint32_t sensor,
                    pzs_real least)
{
    const size_t relations = gate->tables->relations;
    const uint32_t k = excluded->count;
    const pzs_real *row = gate->tables->parity + sensor * relations;
    pzs_real *own = gate->column + k * width_of(gate);
    memcpy(own, row, relations * sizeof *own);
    for (uint32_t m = 0; m < k; m++) {
        const pzs_real *other = gate->column + m * width_of(gate);
        const pzs_real common = pzs_product_dot(own, other, relations);
        *factor_of(gate, m, k) = common;
        subtract(own, common, other, relations);
    }
    const pzs_real square = pzs_product_dot(own, own, relations);
    if (!(square > least * pzs_product_dot(row, row, relations)))
        return false;
    const pzs_real norm = PZS_SQRT(square);
    *factor_of(gate, k, k) = norm;
    for (size_t i = 0; i < relations; i++)
        own[i] /= norm;
    excluded->part[k] = pzs_product_dot(gate->parity, own, relations);
    subtract(gate->parity, excluded->part[k], own, relations);
    excluded->sensor[k] = (uint16_t)sensor;
    excluded->count = k + 1;
    return true;
}

/* Return the norm of the first `count` values of the parity relations. */
static pzs_real norm_of_parity(const pzs_sensor_gate_state *gate, size_t count)
{
    return PZS_SQRT(pzs_product_dot(gate->parity, gate->parity, count));
}

/* Compute the errors of all excluded sensors together, and what they leave. */
static void find_errors(const pzs_sensor_gate_state *gate, exclusions *excluded)
{
    excluded->left = norm_of_parity(gate, gate->tables->relations);
    for (uint32_t k = excluded->count; k-- > 0;) {
        pzs_real left = excluded->part[k];
        for (uint32_t m = k + 1; m < excluded->count; m++)
            left -= *factor_of(gate, k, m) * excluded->error[m];
        excluded->error[k] = left / *factor_of(gate, k, k);
    }
}

/*
 * Return the sensor whose error would explain most of what is left of the values of the parity
 * relations, or -1.
 */
static int32_t find_suspect(pzs_sensor_gate_state *gate)
{
    const pzs_sensor_gate *tables = gate->tables;
    const uint32_t sensors = tables->sensors;
    pzs_real most = 0;
    int32_t suspect = -1;
    pzs_product_matrix(gate->match, tables->parity, gate->parity, sensors, tables->relations);
    for (uint32_t i = 0; i < sensors; i++) {
        const pzs_real size = number_absolute(gate->match[i]) * tables->scale[i];
        if (size > most) {
            most = size;
            suspect = (int32_t)i;
        }
    }
    return suspect;
}

/*
 * Whether a sensor may be the only wrong one: the error of its reading that would explain most of
 * what is left reaches the threshold of this sensor in the tables.
 */
static bool is_suspect(const pzs_sensor_gate_state *gate, int32_t suspect)
{
    const pzs_sensor_gate *tables = gate->tables;
    if (suspect < 0)
        return false;
    const pzs_real scale = tables->scale[suspect];
    return number_absolute(gate->match[suspect]) * scale * scale >= tables->threshold[suspect];
}

/*
 * Whether the sensors excluded from number `first` on explain the readings: the error of each
 * reaches its threshold, and is large compared with what is left.
 */
static bool explain(const pzs_sensor_gate *tables, const exclusions *excluded, uint32_t first)
{
    for (uint32_t k = first; k < excluded->count; k++) {
        const uint32_t sensor = excluded->sensor[k];
        const pzs_real size = number_absolute(excluded->error[k]);
        const pzs_real least = tables->ratio * excluded->left * tables->scale[sensor];
        if (!(size >= tables->threshold[sensor] && size >= least))
            return false;
    }
    return first < excluded->count;
}

/* ---- list of gated and suspected sensors --------------------------------- */

/* Remove number k of the list of gated and suspected sensors. */
static void drop(pzs_sensor_gate_state *gate, uint32_t k)
{
    gate->suspects--;
    for (; k < gate->suspects; k++) {
        gate->suspect[k] = gate->suspect[k + 1];
        gate->distrust[k] = gate->distrust[k + 1];
    }
}

/* Empty the list of gated and suspected sensors where memory was damaged. */
static void mend(pzs_sensor_gate_state *gate)
{
    bool is_whole = gate->suspects <= gate->tables->most;
    for (uint32_t k = 0; is_whole && k < gate->suspects; k++)
        is_whole = gate->suspect[k] < gate->tables->sensors &&
                   gate->distrust[k] <= gate->tables->patience &&
                   (k == 0 || gate->distrust[k] == 0 || gate->distrust[k - 1] > 0);
    if (!is_whole)
        gate->suspects = 0;
}

/* Return the number of gated sensors, which come first in the list. */
static uint32_t count_gated(const pzs_sensor_gate_state *gate)
{
    uint32_t gated = 0;
    while (gated < gate->suspects && gate->distrust[gated] > 0)
        gated++;
    return gated;
}

/* Forget the sensors that are only suspected. */
static void acquit(pzs_sensor_gate_state *gate)
{
    gate->suspects = (uint16_t)count_gated(gate);
}

/* Forget suspected sensors that have no usable reading. */
static void drop_missing(pzs_sensor_gate_state *gate)
{
    for (uint32_t k = gate->suspects; k-- > 0;)
        if (gate->distrust[k] == 0 && !is_usable(gate, gate->suspect[k]))
            drop(gate, k);
}

static bool is_listed(const pzs_sensor_gate_state *gate, uint32_t sensor)
{
    for (uint32_t k = 0; k < gate->suspects; k++)
        if (gate->suspect[k] == sensor)
            return true;
    return false;
}

/*
 * Whether a gated sensor agrees with the others in this tick: its error is below half its
 * threshold, or no longer stands out from what is left, as under a load that the tables do not
 * know.
 */
static bool agrees(const pzs_sensor_gate *tables, const exclusions *excluded, uint32_t number)
{
    const uint32_t sensor = excluded->sensor[number];
    const pzs_real threshold = tables->threshold[sensor];
    const pzs_real among_others = tables->ratio * excluded->left * tables->scale[sensor];
    const pzs_real least = threshold > among_others ? threshold : among_others;
    return number_absolute(excluded->error[number]) < GONE * least;
}

/* Return the number of a sensor among the excluded ones, or their count if it is not. */
static uint32_t find_excluded(const exclusions *excluded, uint32_t sensor)
{
    uint32_t k = 0;
    while (k < excluded->count && excluded->sensor[k] != sensor)
        k++;
    return k;
}

/*
 * Count the ticks in which a gated sensor agrees with the others. A tick in which it does not makes
 * it begin again.
 */
static void forgive(pzs_sensor_gate_state *gate, const exclusions *excluded)
{
    const pzs_sensor_gate *tables = gate->tables;
    for (uint32_t k = count_gated(gate); k-- > 0;) {
        const uint32_t number = find_excluded(excluded, gate->suspect[k]);
        if (number == excluded->count || !is_usable(gate, gate->suspect[k]))
            continue;
        gate->distrust[k] = agrees(tables, excluded, number) ? (uint16_t)(gate->distrust[k] - 1u)
                                                             : tables->patience;
        if (gate->distrust[k] == 0)
            drop(gate, k);
    }
}

/* ---- judgement of the sensors -------------------------------------------- */

/* Exclude the sensors without a usable reading, then those of the list. */
static void exclude_absent(pzs_sensor_gate_state *gate, exclusions *excluded, bool has_missing)
{
    for (uint32_t i = 0; has_missing && i < gate->tables->sensors; i++)
        if (!is_usable(gate, i) && !is_listed(gate, i))
            (void)exclude(gate, excluded, i, LEAST_EXCLUDED);
    for (uint32_t k = 0; k < gate->suspects; k++)
        (void)exclude(gate, excluded, gate->suspect[k], LEAST_EXCLUDED);
}

/* Return the number of the first excluded sensor that is only suspected, or their count. */
static uint32_t first_suspected(const pzs_sensor_gate_state *gate, const exclusions *excluded)
{
    const uint32_t gated = count_gated(gate);
    return gated < gate->suspects ? find_excluded(excluded, gate->suspect[gated]) : excluded->count;
}

/* Suspect one more sensor. Returns whether it differs from the excluded ones. */
static bool suspect_one(pzs_sensor_gate_state *gate, exclusions *excluded, uint32_t sensor)
{
    if (!exclude(gate, excluded, sensor, LEAST_SUSPECT))
        return false;
    gate->suspect[gate->suspects] = (uint16_t)sensor;
    gate->distrust[gate->suspects++] = 0;
    find_errors(gate, excluded);
    return true;
}

/* Gate all suspected sensors. */
static void gate_suspected(pzs_sensor_gate_state *gate)
{
    for (uint32_t k = count_gated(gate); k < gate->suspects; k++)
        gate->distrust[k] = gate->tables->patience;
}

/* Forget suspected sensors whose errors are below their thresholds beside those of the others. */
static void acquit_small(pzs_sensor_gate_state *gate, const exclusions *excluded)
{
    const pzs_sensor_gate *tables = gate->tables;
    for (uint32_t k = gate->suspects; k-- > count_gated(gate);) {
        const uint32_t number = find_excluded(excluded, gate->suspect[k]);
        if (number < excluded->count &&
            number_absolute(excluded->error[number]) < tables->threshold[gate->suspect[k]])
            drop(gate, k);
    }
}

/*
 * Gate the suspected sensors if they explain the readings. Otherwise suspect one more, or forget
 * them all if there can be no more or if nothing is left to be explained.
 */
static void find_wrong(pzs_sensor_gate_state *gate, exclusions *excluded)
{
    const pzs_sensor_gate *tables = gate->tables;
    const uint32_t first = first_suspected(gate, excluded);
    if (explain(tables, excluded, first)) {
        gate_suspected(gate);
        return;
    }
    const int32_t suspect = excluded->left >= tables->quiet ? find_suspect(gate) : -1;
    if (!is_suspect(gate, suspect)) {
        acquit(gate);
        return;
    }
    excluded->unexplained = suspect;
    if (excluded->absent >= tables->most || !suspect_one(gate, excluded, (uint32_t)suspect)) {
        if (count_gated(gate) < gate->suspects)
            drop(gate, count_gated(gate));
    } else if (explain(tables, excluded, first)) {
        gate_suspected(gate);
        excluded->unexplained = -1;
    } else {
        acquit_small(gate, excluded);
    }
}

/* Compute the values of the parity relations from number `first` up to `end`. */
static void find_parity(pzs_sensor_gate_state *gate, uint32_t first, uint32_t end)
{
    const pzs_sensor_gate *tables = gate->tables;
    pzs_product_sum_rows(gate->parity + first, tables->parity + first, tables->relations,
                         gate->gated, tables->sensors, end - first);
}

/*
 * Find sensors that contradict the others. Judges nothing while more sensors are absent than may be
 * excluded.
 *   missing  in   number of readings that are missing or beyond their range
 *   excluded out  sensors whose errors are estimated
 */
static void judge(pzs_sensor_gate_state *gate, uint32_t missing, exclusions *excluded)
{
    const pzs_sensor_gate *tables = gate->tables;
    excluded->count = 0;
    excluded->unexplained = -1;
    excluded->absent = gate->suspects + missing;
    for (uint32_t k = 0; k < gate->suspects; k++)
        excluded->absent -= !is_usable(gate, gate->suspect[k]);
    if (tables->relations == 0 || excluded->absent > tables->most) {
        acquit(gate);
        return;
    }
    find_parity(gate, 0, tables->quick);
    if (excluded->absent == 0 && norm_of_parity(gate, tables->quick) < tables->quiet)
        return;
    find_parity(gate, tables->quick, tables->relations);
    exclude_absent(gate, excluded, missing > 0);
    find_errors(gate, excluded);
    find_wrong(gate, excluded);
    forgive(gate, excluded);
}

/* ---- block of the control loop ------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_sensor_gate *gate = tables;
    (void)problem;
    return PZS_SENSOR_GATE_BLOCK_BYTES(gate->sensors, gate->relations, gate->most);
}

/* Set the pointers of the block to its tables and to its arrays. */
static void place(pzs_sensor_gate_state *gate, const pzs_sensor_gate *tables)
{
    gate->tables = tables;
    const size_t width = PZS_FOURS(tables->sensors);
    gate->gated = (void *)((uint8_t *)gate + PZS_ALIGNED(sizeof *gate));
    gate->match = gate->gated + width;
    gate->parity = gate->match + width;
    gate->column = gate->parity + width_of(gate);
    gate->factor = gate->column + tables->most * width_of(gate);
    gate->reading = (void *)(gate->factor + PZS_FOURS((size_t)tables->most * tables->most));
    gate->info.reading = gate->reading;
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_status status = check(tables, signals, &signals->where);
    if (status != PZS_OK)
        return status;
    memset(self, 0, block_bytes(tables, signals->control->state.problem));
    place(self, tables);
    return PZS_OK;
}

/*
 * Copy the readings; one that is missing or beyond its range becomes 0. Returns the number of
 * these.
 */
static uint32_t take_readings(pzs_sensor_gate_state *gate, const pzs_real *readings)
{
    const uint32_t sensors = gate->tables->sensors;
    const pzs_real *range = gate->tables->range;
    pzs_real *gated = gate->gated;
    uint32_t missing = 0;
    memset(gate->reading, PZS_READING_USED, sensors);
    for (uint32_t i = 0; i < sensors; i++) {
        gated[i] = readings[i];
        if (number_absolute(readings[i]) <= range[i])
            continue;
        gated[i] = 0;
        gate->reading[i] =
            (uint8_t)(number_is_finite(readings[i]) ? PZS_READING_RANGE : PZS_READING_MISSING);
        missing++;
    }
    return missing;
}

/* Let readings that are missing, beyond their range or gated be NaN, and count the last two. */
static void take_away(pzs_sensor_gate_state *gate, uint32_t missing)
{
    const uint32_t gated = count_gated(gate);
    gate->info.count = 0;
    for (uint32_t k = 0; k < gated; k++)
        if (is_usable(gate, gate->suspect[k]))
            gate->reading[gate->suspect[k]] = (uint8_t)PZS_READING_CONTRADICTED;
    for (uint32_t i = 0; missing + gated > 0 && i < gate->tables->sensors; i++) {
        if (is_usable(gate, i))
            continue;
        gate->gated[i] = (pzs_real)NAN;
        gate->info.count = (uint16_t)(gate->info.count + (gate->reading[i] > PZS_READING_MISSING));
    }
}

/*
 * Replace the readings of excluded sensors by what the parity relations make of the others, except
 * where these hardly determine it. Returns the number of replaced readings.
 */
static uint32_t replace(pzs_sensor_gate_state *gate, const exclusions *excluded,
                        const pzs_real *readings)
{
    const pzs_sensor_gate *tables = gate->tables;
    uint32_t replaced = 0;
    for (uint32_t k = 0; k < excluded->count && tables->replaces != 0; k++) {
        const uint32_t i = excluded->sensor[k];
        const pzs_real own = *factor_of(gate, k, k) * tables->scale[i];
        if (own * own < LEAST_REPLACED || is_usable(gate, i))
            continue;
        const bool has_reading = gate->reading[i] == PZS_READING_CONTRADICTED;
        gate->gated[i] = (has_reading ? readings[i] : 0) - excluded->error[k];
        replaced++;
    }
    return replaced;
}

/* Return the first reading whose state is at least `least`, or -1. */
static int32_t find_state(const pzs_sensor_gate_state *gate, pzs_reading_state least)
{
    for (uint32_t i = 0; i < gate->tables->sensors; i++)
        if (gate->reading[i] >= least)
            return (int32_t)i;
    return -1;
}

/*
 * Status of a tick: missing readings are announced here only if they were replaced, because the
 * next blocks announce them otherwise, and nothing where no reading is left, which they announce.
 */
static pzs_status status_of(const pzs_sensor_gate_state *gate, const exclusions *excluded,
                            uint32_t replaced, int32_t *where)
{
    *where = gate->info.count > 0 ? find_state(gate, PZS_READING_RANGE) : -1;
    if (*where >= 0)
        return gate->info.count < gate->tables->sensors ? PZS_W_GATED : PZS_OK;
    *where = excluded->unexplained;
    if (*where >= 0)
        return PZS_W_CONTRADICTION;
    if (replaced > 0)
        *where = find_state(gate, PZS_READING_MISSING);
    return *where >= 0 ? PZS_W_SENSOR : PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_sensor_gate_state *gate = self;
    place(gate, signals->tables);
    if (signals->readings == NULL)
        return PZS_OK;
    mend(gate);
    const uint32_t missing = take_readings(gate, signals->readings);
    drop_missing(gate);
    exclusions excluded;
    judge(gate, missing, &excluded);
    gate->info.is_unexplained = excluded.unexplained >= 0;
    take_away(gate, missing);
    const uint32_t replaced = replace(gate, &excluded, signals->readings);
    signals->readings = signals->measured = gate->gated;
    return status_of(gate, &excluded, replaced, &signals->where);
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_sensor_gate *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_sensor_gate_block = {"sensor_gate", PZS_PHASE_READINGS, block_bytes,
                                              block_init,    block_tick,         block_parts};
