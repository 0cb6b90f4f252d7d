/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sensor gate: readings that cannot be become missing readings before any other block sees them.
 *
 *   - Range: a reading whose size exceeds its range is missing in this tick.
 *   - Redundancy: an orthonormal basis Q spans all readings that voltages, observed vibration modes
 *     and loads of the scene can make. What a wrong reading adds lies outside. The residuals
 *         r = (1 - Q Q') w s        (w s: readings, each times its weight)
 *     are zero but for noise and for what the model leaves out. While the largest of
 *     |r_i| / root(1 - |Q_i|^2) is large enough, sensor i is excluded, and the residuals and the
 *     errors of the excluded sensors are those of the least-squares fit to the other sensors.
 *
 * Sensors are gated only if that explains the readings: the error of each exceeds its threshold and
 * `ratio` times the largest residual that is left. An unknown load also leaves residuals, but in
 * the neighbours of each sensor, too, so that no few sensors explain them.
 *
 * A gated sensor is trusted again when it has agreed with the others for `patience` ticks. Where
 * the basis spans all that the model knows (`replaces`), the fit replaces gated and missing
 * readings.
 *
 * Work of a tick: 2 * sensors * directions multiply-adds; for each excluded sensor, at most `most`,
 * sensors * (directions + most) more.
 */
#include <string.h>
#include "pzs_loop.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Smallest part of an error in a reading that must show in its own residual for the sensor to be
 * suspected. Where the part is smaller, the other sensors hardly determine the reading.
 */
#define LEAST_SUSPECT PZS_R(0.05)
/*
 * The same part for a sensor without a reading. A smaller part means that the sensor has almost no
 * effect on the residuals of the others, and that rounding would decide.
 */
#define LEAST_EXCLUDED PZS_R(0.001)
/* Part of its threshold below which the error of a gated sensor counts as gone. */
#define GONE PZS_R(0.5)

/* List the arrays that the checksum of the sensor gate's tables covers. Returns their number. */
static uint32_t list_parts(const pzs_sensor_gate *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t sensors = tables->sensors, judged = tables->directions > 0 ? sensors : 0;
    part[0] = (pzs_table_part){&tables->sensors, 5u * sizeof tables->sensors};
    part[1] = scrub_reals(tables->range, sensors);
    part[2] = scrub_reals(tables->weight, judged);
    part[3] = scrub_reals(tables->basis, sensors * tables->directions);
    part[4] = scrub_reals(tables->free, judged);
    part[5] = scrub_reals(tables->threshold, judged);
    part[6] = scrub_reals(&tables->ratio, 1);
    return 7;
}

static uint32_t crc_of(const pzs_sensor_gate *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool has_arrays(const pzs_sensor_gate *tables)
{
    const bool is_judged = tables->weight != NULL && tables->basis != NULL &&
                           tables->free != NULL && tables->threshold != NULL;
    return tables->sensors > 0 && tables->range != NULL && (tables->directions == 0 || is_judged);
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
    const bool is_judged = tables->directions > 0;
    return has_arrays(tables) && tables->sensors == sensors && tables->directions < sensors &&
           tables->most <= PZS_SENSOR_GATE_LIMIT && (tables->most > 0) == is_judged &&
           (!is_judged || (tables->patience > 0 && tables->ratio >= 1));
}

/* Return the index of the first number that is not above 0, which may be NaN, or -1. */
static int32_t find_not_positive(const pzs_real *value, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!(value[i] > 0))
            return (int32_t)i;
    return -1;
}

/* Return the first sensor with a range, weight or threshold that is not above 0, or -1. */
static int32_t find_bad_sensor(const pzs_sensor_gate *tables)
{
    const uint32_t judged = tables->directions > 0 ? tables->sensors : 0;
    int32_t bad = find_not_positive(tables->range, tables->sensors);
    bad = bad < 0 ? find_not_positive(tables->weight, judged) : bad;
    return bad < 0 ? find_not_positive(tables->threshold, judged) : bad;
}

static bool is_finite_basis(const pzs_sensor_gate *tables)
{
    const uint32_t sensors = tables->sensors, directions = tables->directions;
    return directions == 0 || (pzs_guard_nonfinite(tables->basis, sensors * directions) < 0 &&
                               pzs_guard_nonfinite(tables->weight, sensors) < 0 &&
                               pzs_guard_nonfinite(tables->free, sensors) < 0);
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
    if (!is_finite_basis(tables))
        return PZS_E_NONFINITE;
    *where = find_bad_sensor(tables);
    return *where < 0 ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- sensors that are left out of the fit ------------------------------- */

/*
 * The sensors that are left out of the fit in a tick, in the order in which they were excluded.
 * Their rows of 1 - Q Q' are factored: column k of the factor, over all sensors, is row k of
 * pzs_sensor_gate_state.column.
 */
typedef struct exclusions {
    uint32_t count;
    uint16_t sensor[PZS_SENSOR_GATE_LIMIT];
    pzs_real part[PZS_SENSOR_GATE_LIMIT]; /* residuals in the coordinates of the factor's columns */
    pzs_real error[PZS_SENSOR_GATE_LIMIT]; /* weighted errors of the readings: reading minus the
                                              fit to the sensors that are not excluded */
    pzs_real left; /* largest weighted residual of the other sensors, over the root of its free
                      part */
} exclusions;

static size_t width_of(const pzs_sensor_gate_state *gate)
{
    return PZS_FOURS(gate->tables->sensors);
}

static bool is_usable(const pzs_sensor_gate_state *gate, uint32_t sensor)
{
    return gate->reading[sensor] == PZS_READING_USED;
}

/*
 * Compute the weighted residuals of all sensors from the usable readings of this tick. The residual
 * is right only once the other sensors are excluded, whose readings count as 0 here.
 */
static void find_residuals(pzs_sensor_gate_state *gate)
{
    const pzs_sensor_gate *tables = gate->tables;
    const size_t sensors = tables->sensors, directions = tables->directions;
    pzs_real *weighted = gate->column;
    for (uint32_t i = 0; i < sensors; i++)
        weighted[i] = is_usable(gate, i) ? tables->weight[i] * gate->gated[i] : 0;
    pzs_product_sum_rows(gate->coordinate, tables->basis, directions, weighted, sensors,
                         directions);
    for (size_t i = 0; i < directions; i++)
        gate->coordinate[i] = -gate->coordinate[i];
    pzs_product_add(gate->residual, weighted, tables->basis, gate->coordinate, sensors, directions);
    memcpy(gate->free, tables->free, sensors * sizeof *gate->free);
}

/*
 * Compute row `sensor` of 1 - Q Q', without the parts along the columns of the sensors excluded
 * before.
 *   row [sensors] out
 */
static void find_row(pzs_sensor_gate_state *gate, const exclusions *excluded, uint32_t sensor,
                     pzs_real *row)
{
    const pzs_sensor_gate *tables = gate->tables;
    const size_t sensors = tables->sensors, directions = tables->directions;
    for (size_t i = 0; i < directions; i++)
        gate->coordinate[i] = -tables->basis[sensor * directions + i];
    pzs_product_matrix(row, tables->basis, gate->coordinate, sensors, directions);
    row[sensor] += 1;
    for (uint32_t k = 0; k < excluded->count; k++) {
        const pzs_real *column = gate->column + k * width_of(gate);
        const pzs_real factor = column[sensor];
        for (size_t i = 0; i < sensors; i++)
            row[i] -= factor * column[i];
    }
}

/*
 * Exclude a sensor from the fit: the residuals and their free parts become those of a fit without
 * it. Returns false and changes neither where less than `least` of an error of this reading shows
 * in its residual.
 */
static bool exclude(pzs_sensor_gate_state *gate, exclusions *excluded, uint32_t sensor,
                    pzs_real least)
{
    const size_t sensors = gate->tables->sensors;
    pzs_real *column = gate->column + excluded->count * width_of(gate);
    find_row(gate, excluded, sensor, column);
    if (!(column[sensor] >= least))
        return false;
    const pzs_real scale = 1 / PZS_SQRT(column[sensor]), part = scale * gate->residual[sensor];
    for (size_t i = 0; i < sensors; i++) {
        column[i] *= scale;
        gate->residual[i] -= part * column[i];
        gate->free[i] -= column[i] * column[i];
    }
    gate->residual[sensor] = gate->free[sensor] = 0;
    excluded->sensor[excluded->count] = (uint16_t)sensor;
    excluded->part[excluded->count++] = part;
    return true;
}

/* Compute the errors of all excluded sensors together. */
static void find_errors(const pzs_sensor_gate_state *gate, exclusions *excluded)
{
    for (uint32_t k = excluded->count; k-- > 0;) {
        const pzs_real *column = gate->column + k * width_of(gate);
        pzs_real left = excluded->part[k];
        for (uint32_t m = k + 1; m < excluded->count; m++)
            left -= column[excluded->sensor[m]] * excluded->error[m];
        excluded->error[k] = left / column[excluded->sensor[k]];
    }
}

/*
 * Return the sensor whose residual is largest in relation to its noise, or -1 where none can be
 * suspected. This largest ratio becomes excluded->left.
 */
static int32_t find_suspect(const pzs_sensor_gate_state *gate, exclusions *excluded)
{
    pzs_real square = 0;
    int32_t suspect = -1;
    for (uint32_t i = 0; i < gate->tables->sensors; i++) {
        const pzs_real residual = gate->residual[i];
        if (!(gate->free[i] >= LEAST_SUSPECT))
            continue;
        if (residual * residual > square * gate->free[i]) {
            square = residual * residual / gate->free[i];
            suspect = (int32_t)i;
        }
    }
    excluded->left = PZS_SQRT(square);
    return suspect;
}

/*
 * Whether a sensor may be the only wrong one: the error of its reading that would explain the
 * contradictions between the readings reaches the threshold of this sensor in the tables.
 */
static bool is_suspect(const pzs_sensor_gate_state *gate, int32_t suspect)
{
    return suspect >= 0 && number_absolute(gate->residual[suspect]) >=
                               gate->tables->threshold[suspect] * gate->free[suspect];
}

/*
 * Whether the sensors excluded from number `first` on explain the readings: the error of each
 * reaches its threshold, and is large compared with what is left.
 */
static bool explain(const pzs_sensor_gate *tables, const exclusions *excluded, uint32_t first)
{
    const pzs_real least = tables->ratio * excluded->left;
    for (uint32_t k = first; k < excluded->count; k++) {
        const pzs_real size = number_absolute(excluded->error[k]);
        if (!(size >= tables->threshold[excluded->sensor[k]] && size >= least))
            return false;
    }
    return true;
}

/* ---- judgement of the sensors -------------------------------------------- */

/* Return the number of sensors without a usable reading, or gated in earlier ticks. */
static uint32_t count_absent(const pzs_sensor_gate_state *gate)
{
    uint32_t absent = 0;
    for (uint32_t i = 0; i < gate->tables->sensors; i++)
        absent += !is_usable(gate, i) || gate->distrust[i] > 0;
    return absent;
}

/* Exclude the sensors without a usable reading, and those gated in earlier ticks. */
static void exclude_absent(pzs_sensor_gate_state *gate, exclusions *excluded)
{
    for (uint32_t i = 0; i < gate->tables->sensors && excluded->count < gate->tables->most; i++)
        if (!is_usable(gate, i) || gate->distrust[i] > 0)
            (void)exclude(gate, excluded, i, LEAST_EXCLUDED);
}

/* Distrust the sensors excluded from number `first` on. */
static void distrust(pzs_sensor_gate_state *gate, const exclusions *excluded, uint32_t first)
{
    for (uint32_t k = first; k < excluded->count; k++)
        gate->distrust[excluded->sensor[k]] = gate->tables->patience;
}

/*
 * Whether a gated sensor agrees with the others in this tick: its error is below half its
 * threshold, or no longer stands out from what the others leave, as under a load that the tables do
 * not know.
 */
static bool agrees(const pzs_sensor_gate *tables, const exclusions *excluded, uint32_t number)
{
    const pzs_real threshold = tables->threshold[excluded->sensor[number]];
    const pzs_real among_others = tables->ratio * excluded->left;
    const pzs_real least = threshold > among_others ? threshold : among_others;
    return number_absolute(excluded->error[number]) < GONE * least;
}

/*
 * Count the ticks in which a gated sensor agrees with the others. A tick in which it does not makes
 * it begin again.
 */
static void forgive(pzs_sensor_gate_state *gate, const exclusions *excluded)
{
    const pzs_sensor_gate *tables = gate->tables;
    for (uint32_t k = 0; k < excluded->count; k++) {
        uint16_t *distrust = &gate->distrust[excluded->sensor[k]];
        if (!is_usable(gate, excluded->sensor[k]) || *distrust == 0)
            continue;
        *distrust = agrees(tables, excluded, k) ? (uint16_t)(*distrust - 1u) : tables->patience;
    }
}

/*
 * Find sensors that contradict the others. More sensors are excluded as long as one is suspect; the
 * largest number of them that explains the readings is gated. Judges nothing while more sensors are
 * absent than may be excluded. Returns the sensors without a trusted reading.
 */
static exclusions judge(pzs_sensor_gate_state *gate)
{
    const uint32_t most = gate->tables->most;
    exclusions excluded = {.count = 0};
    gate->info.is_unexplained = false;
    if (gate->tables->directions == 0 || count_absent(gate) > most)
        return excluded;
    find_residuals(gate);
    exclude_absent(gate, &excluded);
    find_errors(gate, &excluded);
    int32_t suspect = find_suspect(gate, &excluded);
    exclusions best = excluded;
    const uint32_t first = excluded.count;
    while (excluded.count < most && is_suspect(gate, suspect) &&
           exclude(gate, &excluded, (uint32_t)suspect, LEAST_EXCLUDED)) {
        find_errors(gate, &excluded);
        suspect = find_suspect(gate, &excluded);
        if (explain(gate->tables, &excluded, first))
            best = excluded;
    }
    gate->info.is_unexplained = best.count < excluded.count || is_suspect(gate, suspect);
    distrust(gate, &best, first);
    forgive(gate, &best);
    return best;
}

/* ---- block of the control loop ------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_sensor_gate *gate = tables;
    (void)problem;
    return PZS_SENSOR_GATE_BLOCK_BYTES(gate->sensors, gate->directions, gate->most);
}

/* Set the pointers of the block to its tables and to its arrays. */
static void place(pzs_sensor_gate_state *gate, const pzs_sensor_gate *tables)
{
    gate->tables = tables;
    const size_t width = width_of(gate);
    gate->gated = (void *)((uint8_t *)gate + PZS_ALIGNED(sizeof *gate));
    gate->residual = gate->gated + width;
    gate->free = gate->residual + width;
    gate->coordinate = gate->free + width;
    gate->column = gate->coordinate + PZS_FOURS(tables->directions);
    gate->distrust = (void *)(gate->column + tables->most * width);
    gate->reading = (void *)(gate->distrust + width);
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

/* Copy the readings; one that is missing or beyond its range becomes NaN. */
static void take_readings(pzs_sensor_gate_state *gate, const pzs_real *readings)
{
    for (uint32_t i = 0; i < gate->tables->sensors; i++) {
        const bool is_missing = !number_is_finite(readings[i]);
        const bool is_inside = number_absolute(readings[i]) <= gate->tables->range[i];
        gate->gated[i] = is_inside ? readings[i] : (pzs_real)NAN;
        gate->reading[i] = (uint8_t)(is_inside ? PZS_READING_USED : PZS_READING_RANGE);
        if (is_missing)
            gate->reading[i] = (uint8_t)PZS_READING_MISSING;
    }
}

/* Take the readings of distrusted sensors away, and count the gated ones. */
static void take_distrusted(pzs_sensor_gate_state *gate)
{
    gate->info.count = 0;
    for (uint32_t i = 0; i < gate->tables->sensors; i++) {
        if (is_usable(gate, i) && gate->distrust[i] > 0) {
            gate->reading[i] = (uint8_t)PZS_READING_CONTRADICTED;
            gate->gated[i] = (pzs_real)NAN;
        }
        gate->info.count = (uint16_t)(gate->info.count + (gate->reading[i] > PZS_READING_MISSING));
    }
}

/*
 * Replace the readings of excluded sensors by their fit to the others, except where these hardly
 * determine it. Returns the number of replaced readings.
 */
static uint32_t replace(pzs_sensor_gate_state *gate, const exclusions *excluded,
                        const pzs_real *readings)
{
    const pzs_sensor_gate *tables = gate->tables;
    uint32_t replaced = 0;
    for (uint32_t k = 0; k < excluded->count && tables->replaces != 0; k++) {
        const uint32_t i = excluded->sensor[k];
        const pzs_real root = gate->column[k * width_of(gate) + i];
        if (root * root < LEAST_SUSPECT || is_usable(gate, i))
            continue;
        const bool has_reading = gate->reading[i] == PZS_READING_CONTRADICTED;
        const pzs_real error = excluded->error[k] / tables->weight[i];
        gate->gated[i] = has_reading ? readings[i] - error : -error;
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
static pzs_status status_of(const pzs_sensor_gate_state *gate, uint32_t replaced, int32_t *where)
{
    *where = find_state(gate, PZS_READING_RANGE);
    if (*where >= 0)
        return gate->info.count < gate->tables->sensors ? PZS_W_GATED : PZS_OK;
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
    take_readings(gate, signals->readings);
    const exclusions excluded = judge(gate);
    take_distrusted(gate);
    const uint32_t replaced = replace(gate, &excluded, signals->readings);
    signals->readings = signals->measured = gate->gated;
    return status_of(gate, replaced, &signals->where);
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
