/* SPDX-License-Identifier: BSD-2-Clause */
/* One sensor after the other reads the end of its range (wrong_sensor.h). */
#include "wrong_sensor.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "storm_state.h"

enum {
    MOST_SENSORS = 64, /* largest number of sensors that are tried */
    SETTLE = 12,       /* time until the shape has settled (periods of the first observed mode) */
    WRONG = 2,         /* time for which a sensor is wrong (periods) */
    FEWEST = 40,       /* fewest and most ticks of a period */
    MOST = 2000
};

/* Part of its range that a wrong sensor reads, so that the range alone does not find it. */
static const double inside = 0.999;

/* A loop whose sensors become wrong one after the other. */
typedef struct trial_of_sensors {
    storm storm;
    const pzs_sensor_gate *gate;
    int period;     /* of the first mode that the loop observes (ticks) */
    double *before; /* [targets] shape before a sensor became wrong (m) */
    wrong_sensor *result;
} trial_of_sensors;

static pzs_status run_ticks(storm *storm, int ticks)
{
    pzs_status status = PZS_OK;
    for (int k = 0; k < ticks && !PZS_IS_ERROR(status); k++)
        status = storm_tick(storm);
    return status;
}

/*
 * Let a sensor read the end of its range that is farther from its reading, then be right until the
 * sensor gate trusts it again.
 */
static pzs_status try_sensor(trial_of_sensors *trial, size_t sensor)
{
    storm *storm = &trial->storm;
    wrong_sensor *result = trial->result;
    const double end = inside * trial->gate->range[sensor];
    storm_compute_shape(storm);
    memcpy(trial->before, storm->shape, storm->rig->targets * sizeof *trial->before);
    storm->wrong = (int)sensor;
    storm->wrong_value = storm->sensed[sensor] > 0 ? -end : end;
    pzs_status status = PZS_OK;
    for (int k = 0; k < WRONG * trial->period && !PZS_IS_ERROR(status); k++) {
        status = storm_tick(storm);
        result->is_stopped = status == PZS_W_RAMP;
        if (result->is_stopped)
            return PZS_OK;
        storm_compute_shape(storm);
        const double moved = storm_distance(storm, storm->shape, trial->before) / storm->rig->scale;
        if (moved > result->moved) {
            result->moved = moved;
            result->sensor = (int)sensor;
            result->error = storm->wrong_value;
        }
    }
    storm->wrong = -1;
    result->tried++;
    return PZS_IS_ERROR(status) ? status
                                : run_ticks(storm, WRONG * trial->period + trial->gate->patience);
}

static pzs_status try_all(trial_of_sensors *trial)
{
    storm *storm = &trial->storm;
    const size_t sensors = storm->rig->sensors,
                 count = sensors < MOST_SENSORS ? sensors : MOST_SENSORS;
    memcpy(storm->target, storm->last_target, storm->rig->targets * sizeof *storm->target);
    pzs_status status = run_ticks(storm, SETTLE * trial->period);
    for (size_t k = 0; k < count && !PZS_IS_ERROR(status) && !trial->result->is_stopped; k++) {
        const size_t sensor = k * sensors / count;
        if (trial->gate->range[sensor] < SENSOR_GATE_NO_RANGE)
            status = try_sensor(trial, sensor);
    }
    return status;
}

int wrong_sensor_run(const storm_rig *rig, const pzs_sensor_gate *gate, double first,
                     wrong_sensor *result, char *error)
{
    static const storm_plant nominal = {.gain = 1, .frequency = 1, .step_limit = 1, .seed = 1};
    trial_of_sensors trial = {.gate = gate, .result = result};
    const double period = first > 0 ? 1 / (first * rig->interval) : 0;
    memset(result, 0, sizeof *result);
    trial.period = (int)fmin(fmax(ceil(period), FEWEST), MOST);
    trial.before = calloc(rig->targets + 1, sizeof *trial.before);
    if (!trial.before)
        return storm_no_memory(rig->analysis, error);
    int failed = storm_begin(&trial.storm, rig, &nominal, error);
    if (!failed) {
        const pzs_status status = try_all(&trial);
        if (PZS_IS_ERROR(status))
            failed = storm_explain(&trial.storm, status, error);
    }
    storm_end(&trial.storm);
    free(trial.before);
    return failed;
}
