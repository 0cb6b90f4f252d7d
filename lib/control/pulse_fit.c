/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Least-squares fit of the readings during a test pulse, by which the fault detector of a loop that
 * damps vibration tests an electrode suspected of a fault and a healthy one together (pulse_fit.h).
 */
#include <string.h>
#include "pulse_fit.h"
#include "../core/product.h"

/*
 * Largest unexplained part of a measured response to a test pulse, as a ratio of sums of squares:
 * the part whose shape is not that of the modelled responses, divided by the modelled response. A
 * larger part means that something else has disturbed the pulse.
 */
#define DISTURBED PZS_R(0.25)
/*
 * Weight of an additional equation in the least-squares fit of a test pulse, relative to the
 * squared modelled response to the suspected electrode. The equation says that all electrodes
 * without a pulse, whose voltages the controller may change meanwhile, have the gain 1 (measured
 * divided by modelled response).
 */
#define EXPECTED PZS_R(0.05)
/*
 * Columns of the least-squares fit of the readings during a test pulse: modelled responses to the
 * suspected electrode (SUSPECT) and to a healthy electrode (REFERENCE), readings of a vibration of
 * the first mode (MODE), and modelled response to all other electrodes (OTHERS).
 */
enum { MODE = PZS_PULSE_MODE, OTHERS = PZS_PULSE_OTHERS, COLUMNS = PZS_PULSE_COLUMNS };

static pzs_real square(pzs_real number)
{
    return number * number;
}

/*
 * Set column[COLUMNS] to the responses of sensor i that the model predicts, times the scale of the
 * sensor: to the test pulse of the suspected electrode, to that of the reference electrode (a
 * healthy one) and to the voltages of all others (dimensionless), and to a vibration of the first
 * mode (1/m).
 */
static void model_responses(const pzs_pulse_detector_state *state, uint32_t i,
                            pzs_real column[COLUMNS])
{
    const pzs_real scale = state->is_missing[i] ? 0 : state->tables->scale[i];
    const pzs_real *row = state->direct + (size_t)i * state->tables->inputs;
    column[SUSPECT] = scale * row[state->suspect] * state->voltage[state->suspect];
    column[REFERENCE] = scale * row[state->reference] * state->voltage[state->reference];
    column[MODE] = scale * mode_reading(state, i);
    column[OTHERS] = scale * state->difference[i];
}

/*
 * Add two equations to the least-squares fit of a test pulse, which make it unique where the
 * columns are not independent:
 *   - The electrodes without a pulse have the gain 1 (measured divided by modelled response).
 *   - There is no vibration of the first mode. If its readings are not known (mode_reading), this
 *     is the only equation for the vibration.
 */
static void add_equations(pzs_pulse_fit *fit)
{
    fit->matrix[OTHERS][OTHERS] += EXPECTED * fit->own;
    fit->response[OTHERS] += EXPECTED * fit->own;
    fit->energy += EXPECTED * fit->own;
    fit->matrix[MODE][MODE] *= 1 + PZS_PULSE_MODE_WEIGHT;
    if (!(fit->matrix[MODE][MODE] > 0))
        fit->matrix[MODE][MODE] = 1;
}

/*
 * Compute the scalar products, over the sensors, of the measured response to a test pulse with the
 * columns of its least-squares fit: modelled responses to the suspected electrode, to the reference
 * electrode, and to all others, whose voltages the controller goes on to change, and a vibration of
 * the first mode.
 */
static pzs_pulse_fit compare_pulse(const pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    pzs_pulse_fit fit = {{{0}}, {0}, 0, 0};
    for (uint32_t i = 0; i < tables->sensors; i++) {
        pzs_real column[COLUMNS];
        model_responses(state, i, column);
        const pzs_real scale = state->is_missing[i] ? 0 : tables->scale[i];
        const pzs_real measured = scale * state->reading[i];
        for (uint32_t k = 0; k < COLUMNS; k++) {
            fit.response[k] += column[k] * measured;
            for (uint32_t j = 0; j <= k; j++)
                fit.matrix[k][j] += column[k] * column[j];
        }
        fit.energy += square(measured);
    }
    fit.own = fit.matrix[SUSPECT][SUSPECT];
    add_equations(&fit);
    return fit;
}

/*
 * Replace the matrix of the least-squares fit of a test pulse by its L D L^T factors. Returns
 * whether the modelled responses to the two electrodes with a pulse (the suspected one and a
 * healthy one) are independent of each other.
 */
static bool factor_fit(pzs_pulse_fit *fit)
{
    for (uint32_t k = 0; k < COLUMNS; k++) {
        const pzs_real diagonal = fit->matrix[k][k];
        for (uint32_t j = 0; j < k; j++) {
            for (uint32_t i = 0; i < j; i++)
                fit->matrix[k][j] -= fit->matrix[k][i] * fit->matrix[j][i] * fit->matrix[i][i];
            fit->matrix[k][j] /= fit->matrix[j][j];
            fit->matrix[k][k] -= square(fit->matrix[k][j]) * fit->matrix[j][j];
        }
        if (!(fit->matrix[k][k] > (k < MODE ? PZS_PULSE_DEPENDENT * diagonal : 0)))
            return false;
    }
    return true;
}

/*
 * Solve for the factors of the first `count` columns in the least-squares fit of a test pulse:
 * gains (measured divided by modelled response), and the vibration of the first mode.
 *   response [count] in/out  scalar products of the measured response with the columns; factors
 */
static void solve_fit(const pzs_pulse_fit *fit, pzs_real *response, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t j = 0; j < k; j++)
            response[k] -= fit->matrix[k][j] * response[j];
    for (uint32_t k = count; k-- > 0;) {
        response[k] /= fit->matrix[k][k];
        for (uint32_t j = k + 1u; j < count; j++)
            response[k] -= fit->matrix[j][k] * response[j];
    }
}

void pzs_pulse_find_jumps(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    const pzs_pulse_fit *fit = &state->fit;
    pzs_real jumped[OTHERS] = {0};
    for (uint32_t j = 0; j < tables->inputs; j++)
        state->move[j] = fit->response[OTHERS] * state->late_voltage[j];
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t j = tested_input(state, k);
        state->move[j] = fit->response[k] * state->late_voltage[j];
    }
    pzs_product_matrix(state->difference, state->direct, state->move, tables->sensors,
                       tables->inputs);
    for (uint32_t i = 0; i < tables->sensors; i++) {
        pzs_real column[COLUMNS];
        model_responses(state, i, column);
        const pzs_real jump = tables->scale[i] * (state->late_reading[i] - state->difference[i]);
        for (uint32_t k = 0; k < OTHERS; k++)
            jumped[k] += column[k] * jump;
    }
    solve_fit(fit, jumped, OTHERS);
    memcpy(state->response.jumped, jumped, sizeof state->response.jumped);
}

void pzs_pulse_predict(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    memcpy(state->move, state->voltage, tables->inputs * sizeof *state->move);
    state->move[state->suspect] = 0;
    state->move[state->reference] = 0;
    pzs_product_matrix(state->difference, state->direct, state->move, tables->sensors,
                       tables->inputs);
}

void pzs_pulse_measure(pzs_pulse_detector_state *state)
{
    pzs_pulse_fit fit = compare_pulse(state);
    pzs_pulse_response *result = &state->response;
    pzs_real rest = fit.energy, product[COLUMNS];
    memcpy(product, fit.response, sizeof product);
    memset(result, 0, sizeof *result);
    if (!factor_fit(&fit))
        return;
    solve_fit(&fit, fit.response, COLUMNS);
    for (uint32_t k = 0; k < COLUMNS; k++)
        rest -= product[k] * fit.response[k];
    memcpy(result->gain, fit.response, sizeof result->gain);
    result->unexplained = rest / fit.own;
    result->is_measured = rest <= DISTURBED * fit.own;
    state->fit = fit;
}
