/* SPDX-License-Identifier: BSD-2-Clause */
/* Measurements of a control loop on a modal plant (loop_tests.h). */
#include "loop_tests.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "uniform.h"

int loop_period(const modal_structure *structure, double interval)
{
    return (int)(6.283185307179586 / structure->omega[0] / interval);
}

static int clip(double x, int least, int most)
{
    const int rounded = (int)x;
    const int raised = rounded < least ? least : rounded;
    return raised > most ? most : raised;
}

void loop_throw_target(const modal_structure *structure, unsigned *seed, double *wanted)
{
    const int which = (int)uniform(seed, 0, 4);
    memset(wanted, 0, structure->outputs * sizeof *wanted);
    if (which < 2)
        for (size_t i = 0; i < structure->outputs; i++)
            wanted[i] = which == 0 ? structure->goal[i] : -structure->goal[i];
    for (size_t j = 0; j < structure->inputs && which >= 2; j++) {
        const double any = uniform(seed, -2 * structure->limit, 2 * structure->limit);
        const double end = any < 0 ? -2 * structure->limit : 2 * structure->limit;
        const double v = which == 2 ? any : end;
        for (size_t i = 0; i < structure->outputs; i++)
            wanted[i] += structure->influence[i * structure->inputs + j] * v;
    }
}

double loop_storm(damped_loop *loop, plant_error error, unsigned seed, int rest)
{
    const modal_structure *structure = loop->structure;
    const int period = loop_period(structure, loop->interval), every = clip(0.6 * period, 10, 1200),
              throws = 10, last = clip(period, 20, 500);
    double *wanted = calloc(2 * structure->outputs, sizeof *wanted),
           *best = wanted + structure->outputs, end = 0;
    assert_non_null(wanted);
    damped_loop_reset(loop, error);
    damped_loop_optimum(loop, structure->goal, best);
    for (int k = 0; k < throws * every + rest; k++) {
        if (k < throws * every && k % every == 0)
            loop_throw_target(structure, &seed, wanted);
        const double *now = k < throws * every ? wanted : structure->goal;
        assert_false(PZS_IS_ERROR(damped_loop_tick(loop, now)));
        if (k >= throws * every + rest - last)
            end = fmax(end, damped_loop_distance(loop, best));
    }
    free(wanted);
    return end;
}

void loop_storms(damped_loop *loop, int delay, unsigned seed, int enough, storm_tally *tally)
{
    static const double gain[LOOP_PLANTS] = {1.33, 1.33, 1, 0.8, 0.8},
                        frequency[LOOP_PLANTS] = {1.1, 0.9, 1, 1.1, 0.9};
    const int rest = clip(12 * loop_period(loop->structure, loop->interval), 1200, 1500);
    for (int k = 0; k < LOOP_PLANTS && tally->failed < enough; k++) {
        const plant_error error = {gain[k], frequency[k], 1, delay, 0, 0, 1e-4};
        const double end = loop_storm(loop, error, seed, rest);
        tally->storms++;
        tally->failed += !(end < 0.05);
        tally->worst = fmax(tally->worst, end);
    }
}

int loop_settle(damped_loop *loop, const double *wanted, int ticks)
{
    double *best = calloc(loop->structure->outputs, sizeof *best);
    int last = -1;
    assert_non_null(best);
    damped_loop_optimum(loop, wanted, best);
    for (int k = 0; k < ticks; k++) {
        (void)damped_loop_tick(loop, wanted);
        if (!(damped_loop_distance(loop, best) < 0.05))
            last = k;
    }
    free(best);
    return last + 1;
}

double loop_moderate_load(const modal_structure *structure)
{
    double load = 0, goal = 0;
    for (size_t i = 0; i < structure->outputs; i++) {
        load += pow(structure->load_shape[i], 2);
        goal += pow(structure->goal[i], 2);
    }
    return 0.3 * sqrt(goal / load);
}

int loop_load_step(damped_loop *loop, int ticks)
{
    const modal_structure *structure = loop->structure;
    double *nothing = calloc(2 * structure->outputs, sizeof *nothing),
           *best = nothing + structure->outputs;
    double load = 0;
    int last = 0;
    assert_non_null(nothing);
    damped_loop_reset(loop, loop->error);
    loop->load = loop_moderate_load(structure);
    damped_loop_optimum(loop, nothing, best);
    for (size_t i = 0; i < structure->outputs; i++)
        load += pow(loop->load * structure->load_shape[i], 2);
    for (int k = 0; k < ticks; k++) {
        double left = 0;
        (void)damped_loop_tick(loop, nothing);
        for (size_t i = 0; i < structure->outputs; i++)
            left += pow(loop->shape[i] - best[i], 2);
        last = left > 0.05 * 0.05 * load ? k + 1 : last;
    }
    free(nothing);
    loop->load = 0;
    return last;
}

int loop_impulse(damped_loop *loop, int ticks)
{
    const modal_structure *structure = loop->structure;
    double *nothing = calloc(structure->outputs, sizeof *nothing);
    int last = 0;
    assert_non_null(nothing);
    damped_loop_reset(loop, loop->error);
    const double start = loop->velocity[0] = loop_moderate_load(structure) * structure->load[0];
    for (int k = 0; k < ticks; k++) {
        double left = 0;
        (void)damped_loop_tick(loop, nothing);
        for (size_t i = 0; i < structure->outputs; i++)
            left += loop->shape[i] * loop->shape[i] / (double)structure->outputs;
        last = sqrt(left) > 0.05 * fabs(start) ? k + 1 : last;
    }
    free(nothing);
    return last;
}

int loop_undamped_ticks(const modal_structure *structure, double interval)
{
    return (int)(log(20) / (structure->ratio[0] * structure->omega[0] * interval));
}

double loop_tracking_error(damped_loop *loop, double periods)
{
    const modal_structure *structure = loop->structure;
    const double period = periods * loop_period(structure, loop->interval);
    const int ticks = (int)(3 * period);
    double *wanted = calloc(2 * structure->outputs, sizeof *wanted),
           *half = wanted + structure->outputs, sum = 0, goal = 0;
    for (size_t i = 0; i < structure->outputs; i++)
        half[i] = structure->goal[i] / 2;
    damped_loop_reset(loop, loop->error);
    for (int k = 0; k < ticks; k++) {
        const double factor = sin(6.283185307179586 * k / period);
        for (size_t i = 0; i < structure->outputs; i++)
            wanted[i] = factor * half[i];
        (void)damped_loop_tick(loop, wanted);
        for (size_t i = 0; i < structure->outputs && k > ticks / 3; i++) {
            sum += pow(loop->shape[i] - wanted[i], 2);
            goal += pow(wanted[i], 2);
        }
    }
    free(wanted);
    return sqrt(sum / goal);
}

double loop_noise(damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    const plant_error noisy = {.gain = 1, .frequency = 1, .ratio = 1, .noise = 1e-3};
    double *nothing = calloc(structure->outputs, sizeof *nothing), sum = 0;
    const int from = 600, ticks = 3000;
    assert_non_null(nothing);
    damped_loop_reset(loop, noisy);
    for (int k = 0; k < ticks; k++) {
        (void)damped_loop_tick(loop, nothing);
        for (size_t j = 0; j < structure->inputs && k >= from; j++)
            sum += pow((double)loop->loop.info.voltage[j] / structure->limit, 2);
    }
    free(nothing);
    return sqrt(sum / (ticks - from) / (double)structure->inputs);
}
