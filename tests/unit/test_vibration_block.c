/*
 * The damped tick: vibration modes observed and damped by the control step.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/damped_loop.h"
#include "../rigs/uniform.h"

/* Ticks of one period of the first mode. */
static int period_of(const modal_structure *s, double interval)
{
    return (int)(6.283185307179586 / s->omega[0] / interval);
}

static int clip(double x, int least, int most)
{
    const int rounded = (int)x;
    const int raised = rounded < least ? least : rounded;
    return raised > most ? most : raised;
}

/* One of the targets of a storm: the goal, its opposite, or a shape of voltages up to twice the
 * limits. */
static void throw_target(const modal_structure *s, unsigned *seed, double *wanted)
{
    const int which = (int)uniform(seed, 0, 4);
    memset(wanted, 0, s->outputs * sizeof *wanted);
    if (which < 2)
        for (size_t i = 0; i < s->outputs; i++)
            wanted[i] = which == 0 ? s->goal[i] : -s->goal[i];
    for (size_t j = 0; j < s->inputs && which >= 2; j++) {
        const double any = uniform(seed, -2 * s->limit, 2 * s->limit);
        const double end = any < 0 ? -2 * s->limit : 2 * s->limit;
        const double v = which == 2 ? any : end;
        for (size_t i = 0; i < s->outputs; i++)
            wanted[i] += s->influence[i * s->inputs + j] * v;
    }
}

/*
 * Targets thrown every .6 periods of the first mode, then the goal. Returns the largest distance
 * from the bounded optimum of the plant in the last period.
 */
static double storm(damped_loop *d, plant_error error, int rest)
{
    const modal_structure *s = d->structure;
    const int period = period_of(s, d->interval), every = clip(0.6 * period, 10, 1200), throws = 10,
              last = clip(period, 20, 500);
    double *wanted = calloc(2 * s->outputs, sizeof *wanted), *best = wanted + s->outputs, end = 0;
    unsigned seed = 3;
    assert_non_null(wanted);
    damped_loop_reset(d, error);
    damped_loop_optimum(d, s->goal, best);
    for (int k = 0; k < throws * every + rest; k++) {
        if (k < throws * every && k % every == 0)
            throw_target(s, &seed, wanted);
        const double *now = k < throws * every ? wanted : s->goal;
        assert_false(PZS_IS_ERROR(damped_loop_tick(d, now)));
        if (k >= throws * every + rest - last)
            end = fmax(end, damped_loop_distance(d, best));
    }
    free(wanted);
    return end;
}

/* Thirty storms: five plants, three delays, two step limits. Returns the number that do not settle
 * within 5 %. */
static int thirty_storms(const modal_structure *s, double interval, const damper_settings *settings,
                         double *worst)
{
    static const int delay[] = {0, 1, 3};
    static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};
    int failed = 0;
    *worst = 0;
    for (int slew = 0; slew < 2; slew++)
        for (int k = 0; k < 3; k++) {
            damped_loop d;
            damped_loop_open(&d, s, interval, s->limit / (slew ? 60 : 15), delay[k], NULL, 0,
                             settings);
            for (int p = 0; p < 5; p++) {
                const plant_error error = {gain[p], frequency[p], 1, delay[k], 0, 0, 1e-4};
                const double end = storm(&d, error, 1200);
                failed += !(end < 0.05);
                *worst = fmax(*worst, end);
            }
            damped_loop_close(&d);
        }
    return failed;
}

static void plate_settles_after_storms(void **state)
{
    const damper_settings settings = damper_default_settings();
    modal_structure s;
    double worst;
    (void)state;
    structure_of_plate(&s, 60);
    const int failed = thirty_storms(&s, 1e-3, &settings, &worst);
    print_message("plate: %d of 30 storms fail, worst %.3g\n", failed, worst);
    assert_int_equal(failed, 0);
    structure_close(&s);
}

/* Ticks until the distance from a shape stays below 5 %. */
static int settle(damped_loop *d, const double *wanted, int ticks)
{
    double *best = calloc(d->structure->outputs, sizeof *best);
    int last = -1;
    assert_non_null(best);
    damped_loop_optimum(d, wanted, best);
    for (int k = 0; k < ticks; k++) {
        damped_loop_tick(d, wanted);
        if (!(damped_loop_distance(d, best) < 0.05))
            last = k;
    }
    free(best);
    return last + 1;
}

static void plate_settles_fast(void **state)
{
    const damper_settings settings = damper_default_settings();
    modal_structure s;
    damped_loop d;
    (void)state;
    structure_of_plate(&s, 60);
    damped_loop_open(&d, &s, 1e-3, 20, 0, NULL, 0, &settings);
    const int step = settle(&d, s.goal, 660);
    double load = 0, goal = 0;
    for (size_t i = 0; i < s.outputs; i++) {
        load += pow(s.load_shape[i], 2);
        goal += pow(s.goal[i], 2);
    }
    d.load = 0.3 * sqrt(goal / load);
    const int disturbed = settle(&d, s.goal, 660);
    print_message("plate: target step %d ticks, load step %d ticks, %zu modes\n", step, disturbed,
                  d.modes);
    assert_in_range(step, 1, 92);
    assert_in_range(disturbed, 1, 70);
    damped_loop_close(&d);
    structure_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plate_settles_fast),
        cmocka_unit_test(plate_settles_after_storms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
