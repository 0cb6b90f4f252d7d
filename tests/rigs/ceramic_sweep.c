/*
 * A sweep of an actuator of test ceramic (ceramic_sweep.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "ceramic_sweep.h"
#include <stdio.h>
#include "uniform.h"

enum { REVERSALS = 7, HALF = 39, HOLD = 300, EVERY = 3 };

/* Go to a voltage on a straight line. */
static void go_to(ceramic_sweep *record, double voltage, int steps)
{
    const double from = record->count > 0 ? record->voltage[record->count - 1] : 0;
    for (int i = 1; i <= steps; i++)
        for (int k = 0; k < EVERY; k++)
            record->voltage[record->count++] = from + (voltage - from) * i / steps;
}

void ceramic_sweep_measure(ceramic_sweep *record, test_ceramic *ceramic, double interval,
                           double gain)
{
    const double limit = ceramic->limit;
    unsigned seed = 3;
    record->count = 0;
    go_to(record, 0, 1);
    for (int k = 0; k < REVERSALS; k++) {
        const double part = 1 - 0.85 * k / (REVERSALS - 1);
        go_to(record, part * limit, HALF);
        go_to(record, -part * limit, HALF);
    }
    go_to(record, 0.5 * limit, 19);
    go_to(record, 0.5 * limit, HOLD);
    for (size_t i = 0; i < record->count; i++)
        record->position[i] = gain * (ceramic_act(ceramic, record->voltage[i], interval) +
                                      uniform(&seed, -0.0035, 0.0035) * limit);
    record->sweep = (sweep){record->count, record->voltage, record->position, 1 / interval};
}

void ceramic_sweep_section(const scene_hysteresis *hysteresis, char *text, size_t room)
{
    const scene_short_list *const list[] = {&hysteresis->slope,      &hysteresis->slack,
                                            &hysteresis->above,      &hysteresis->below,
                                            &hysteresis->creep_time, &hysteresis->creep};
    static const char *const key[] = {"slopes", "slack", "above", "below", "creep_time", "creep"};
    size_t at = (size_t)snprintf(text, room, "hysteresis={range: [%g, %g], offset: %g",
                                 hysteresis->range[0], hysteresis->range[1], hysteresis->offset);
    for (int i = 0; i < 6; i++) {
        at += (size_t)snprintf(text + at, room - at, ", %s: [", key[i]);
        for (int k = 0; k < list[i]->count; k++)
            at +=
                (size_t)snprintf(text + at, room - at, "%s%.9g", k ? ", " : "", list[i]->value[k]);
        at += (size_t)snprintf(text + at, room - at, "]");
    }
    (void)snprintf(text + at, room - at, "}");
}
