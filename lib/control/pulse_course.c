/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Course in time of the responses to a test pulse of the fault detector of a loop that damps
 * vibration (pulse_course.h).
 */
#include <string.h>
#include "pulse_course.h"
#include "pulse_fit.h"

/*
 * Windows over which the course of a test pulse is averaged: WINDOW parts of the pulse long, one
 * period of the first vibration mode, because a pulse lasts 3.2 periods. The first window begins
 * with part FIRST: before, vibration from the last motion of the target has not decayed, and the
 * pulse is below 0.04 of its height.
 */
enum { PARTS = PZS_PULSE_PARTS, WINDOW = 5, FIRST = 2 };

/* Return the part of the test pulse to which a tick belongs. */
static uint32_t part_of(const pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t ticks = state->tables->pulse_ticks;
    return tick < ticks ? tick * PARTS / ticks : PARTS - 1u;
}

/* Return the first tick of a part of the test pulse. */
static uint32_t first_tick(const pzs_pulse_detector_state *state, uint32_t part)
{
    return (part * state->tables->pulse_ticks + PARTS - 1u) / PARTS;
}

void pzs_pulse_course_voltages(pzs_pulse_detector_state *state, uint32_t tick,
                               const pzs_real *voltage)
{
    pzs_pulse_course *course = &state->course;
    const uint32_t inputs = state->tables->inputs, part = part_of(state, tick);
    if (tick == 0)
        memset(course, 0, sizeof *course);
    for (uint32_t k = 0; k < 2; k++) {
        const pzs_real *product = state->product[k];
        const uint32_t own = tested_input(state, k), other = tested_input(state, 1u - k);
        pzs_real explained = 0;
        for (uint32_t j = 0; j < inputs; j++) {
            const bool is_tested = j == own || j == other;
            explained += is_tested ? 0 : product[j] * (voltage[j] - state->first_voltage[j]);
        }
        course->others[k][part] += explained;
        course->given[k][part] += voltage[own] - state->first_voltage[own];
    }
}

void pzs_pulse_course_readings(pzs_pulse_detector_state *state, uint32_t tick)
{
    const pzs_selftest_tables *tables = state->tables;
    const uint32_t part = part_of(state, tick);
    pzs_real shown[2] = {0, 0};
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real scale = state->is_missing[i] ? 0 : tables->scale[i];
        const pzs_real change = scale * scale * (state->last_reading[i] - state->first_reading[i]);
        const pzs_real *row = state->direct + (size_t)i * tables->inputs;
        const pzs_real mode = mode_reading(state, i);
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t j = tested_input(state, k);
            shown[k] += (row[j] - state->vibrating[j] * mode) * change;
        }
    }
    for (uint32_t k = 0; k < 2; k++)
        state->course.shown[k][part] += shown[k];
}

/* Return the sum of `count` numbers. */
static pzs_real sum_of(const pzs_real *number, uint32_t count)
{
    pzs_real sum = 0;
    for (uint32_t k = 0; k < count; k++)
        sum += number[k];
    return sum;
}

/*
 * Return the sum, over the window of the course that begins with the given part, of the scalar
 * products between the modelled response of an electrode under test and the changes of the readings
 * (1/V), without those that the other electrodes explain with their measured gain.
 *   number in  SUSPECT or REFERENCE
 */
static pzs_real unexplained_in(const pzs_pulse_detector_state *state, uint32_t number,
                               uint32_t part)
{
    const pzs_real all = sum_of(state->course.shown[number] + part, WINDOW);
    const pzs_real others = sum_of(state->course.others[number] + part, WINDOW);
    return all - state->fit.response[PZS_PULSE_OTHERS] * others;
}

/*
 * Return the mean, over the window of the course that begins with the given part, of the voltage
 * change of an electrode under test that the readings show (V).
 *   number in  SUSPECT or REFERENCE
 */
static pzs_real shown_in(const pzs_pulse_detector_state *state, uint32_t number, uint32_t part)
{
    const uint32_t other = 1u - number;
    const uint32_t own_input = tested_input(state, number);
    const uint32_t other_input = tested_input(state, other);
    const pzs_real own = state->product[number][own_input];
    const pzs_real both = state->product[number][other_input];
    const pzs_real its = state->product[other][other_input];
    const pzs_real first = unexplained_in(state, number, part);
    const pzs_real second = unexplained_in(state, other, part);
    const uint32_t ticks = first_tick(state, part + WINDOW) - first_tick(state, part);
    return (its * first - both * second) / ((own * its - both * both) * (pzs_real)ticks);
}

/*
 * Return the mean, over the window of the course that begins with the given part, of the voltage
 * change that an electrode under test was given (V).
 *   number in  SUSPECT or REFERENCE
 */
static pzs_real given_in(const pzs_pulse_detector_state *state, uint32_t number, uint32_t part)
{
    const uint32_t ticks = first_tick(state, part + WINDOW) - first_tick(state, part);
    return sum_of(state->course.given[number] + part, WINDOW) / (pzs_real)ticks;
}

/* Range of numbers: the smallest and the largest of them. */
typedef struct range {
    pzs_real least, most;
} range;

/* Return a range that is extended, if necessary, so that it holds a number. */
static range extend(range old, pzs_real number)
{
    const pzs_real least = number < old.least ? number : old.least;
    const pzs_real most = number > old.most ? number : old.most;
    return (range){least, most};
}

/*
 * Return the course error of an electrode under test: SUSPECT or REFERENCE. It is infinite where
 * damaged memory leaves no number to compare.
 */
static pzs_real course_error(const pzs_pulse_detector_state *state, uint32_t number)
{
    const pzs_real gain = state->response.gain[number];
    range given = {(pzs_real)INFINITY, -(pzs_real)INFINITY}, rest = given;
    for (uint32_t part = 0; part + WINDOW <= PARTS; part++) {
        const pzs_real pulse = given_in(state, number, part);
        given = extend(given, pulse);
        if (part >= FIRST)
            rest = extend(rest, shown_in(state, number, part) - gain * pulse);
    }
    const bool is_known = rest.most >= rest.least && given.most > given.least;
    return is_known ? (rest.most - rest.least) / (given.most - given.least) : (pzs_real)INFINITY;
}

void pzs_pulse_course_errors(pzs_pulse_detector_state *state)
{
    for (uint32_t k = 0; k < 2; k++)
        state->response.course_error[k] = course_error(state, k);
}
