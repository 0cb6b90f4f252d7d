/*
 * The laws with which `make bench-laws` compares the vibration damper are what their names say.
 * Here: each runs on a plant that differs from its model, within all limits; positive position
 * feedback damps a mode. `test_rivals FILE` writes readings and voltages of every tick, from which
 * tests/oracle/rivals.py computes the voltages anew.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <complex.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>
#include "../rigs/loop_tests.h"
#include "../rigs/rival.h"

enum { TICKS = 200, DELAY = 2, JUMP = 40, LOADED = 120 };
static const double interval = 2e-3, step_limit = 15;

static FILE *dump; /* NULL: nothing is written */

static void write_reals(const double *value, size_t count)
{
    if (dump)
        assert_int_equal(fwrite(value, sizeof *value, count, dump), count);
}

/* A plate, of whose modes the observer knows those that turn by less than 2 rad in a tick. */
static void small_plate(modal_structure *structure, size_t modes)
{
    const supported_plate plate = {1.3, 12, modes, 4, 3, 7, 5, 0.005};
    structure_of_supported_plate(structure, &plate);
}

static const rival_settings *all_settings(size_t *count)
{
    static rival_settings of[11];
    const damper_settings observer = rival_observer(0.25, 0.1);
    size_t k = 0;
    of[k++] = (rival_settings){.kind = RIVAL_STEP, .share = 1};
    of[k++] = (rival_settings){.kind = RIVAL_STEP, .share = 0.2};
    of[k++] = (rival_settings){.kind = RIVAL_LEAKY, .gain = 0.1, .leak = 0.01};
    of[k++] = (rival_settings){.kind = RIVAL_CLIPPED, .share = 0.3, .regularisation = 0.01};
    of[k++] = (rival_settings){.kind = RIVAL_LQG, .damper = observer, .weight = 1};
    of[k++] = (rival_settings){.kind = RIVAL_LQG_BOUNDED, .damper = observer, .weight = 100};
    of[k++] = (rival_settings){
        .kind = RIVAL_LQG_BOUNDED, .damper = observer, .weight = 10, .governor = 0.5};
    of[k++] = (rival_settings){.kind = RIVAL_PPF,
                               .share = 0.2,
                               .gain = 0.05,
                               .modes = 3,
                               .feedback = 0.3,
                               .filter_ratio = 0.3,
                               .filter_frequency = 1.3};
    of[k++] = (rival_settings){.kind = RIVAL_WISH, .damper = observer, .damping = 1};
    of[k++] = (rival_settings){.kind = RIVAL_WISH, .damper = observer, .damping = 0.5, .cut = 0.7};
    of[k++] = (rival_settings){.kind = RIVAL_DAMPER, .damper = damper_default_settings()};
    *count = k;
    return of;
}

/* Numbers that describe a rival: sizes, settings, limits; then its structure. */
static void write_rival(const rival *rival)
{
    const damped_loop *loop = &rival->loop;
    const modal_structure *s = loop->structure;
    const rival_settings *set = &rival->settings;
    const double numbers[] = {set->kind,
                              (double)s->modes,
                              (double)s->outputs,
                              (double)s->inputs,
                              (double)loop->modes,
                              TICKS,
                              DELAY,
                              interval,
                              step_limit,
                              s->limit,
                              loop->problem.regularisation,
                              set->share,
                              set->regularisation,
                              set->gain,
                              set->leak,
                              set->weight,
                              (double)set->modes,
                              set->feedback,
                              set->filter_ratio,
                              set->filter_frequency,
                              set->damping,
                              set->cut,
                              set->damper.damping,
                              set->damper.cut,
                              set->damper.mix,
                              loop->gains.share,
                              set->damper.kick,
                              set->damper.drift,
                              set->damper.slow,
                              set->governor};
    write_reals(numbers, sizeof numbers / sizeof *numbers);
    write_reals(s->omega, s->modes);
    write_reals(s->ratio, s->modes);
    write_reals(s->shape, s->outputs * s->modes);
    write_reals(s->modal, s->modes * s->inputs);
    write_reals(s->influence, s->outputs * s->inputs);
}

/* Run a rival while target and load jump; every voltage is inside its limits to the last bit. */
static void run(rival *rival)
{
    damped_loop *loop = &rival->loop;
    const modal_structure *s = loop->structure;
    const plant_error error = {1.2, 0.95, 1, DELAY, 0, 0, 1e-4};
    double *wanted = calloc(s->outputs, sizeof *wanted), moved = 0;
    unsigned seed = 5;
    assert_non_null(wanted);
    damped_loop_reset(loop, error);
    for (int k = 0; k < TICKS; k++) {
        if (k % JUMP == 0)
            loop_throw_target(s, &seed, wanted);
        loop->load = k < LOADED ? 0 : loop_moderate_load(s);
        assert_false(PZS_IS_ERROR(damped_loop_tick(loop, wanted)));
        write_reals(wanted, s->outputs);
        write_reals(loop->sensed, s->outputs);
        write_reals(loop->loop.info.voltage, s->inputs);
        for (size_t j = 0; j < s->inputs; j++)
            moved = fmax(moved, fabs(loop->loop.info.voltage[j]));
    }
    assert_true(moved > step_limit && moved <= s->limit);
    free(wanted);
}

static void rivals_stay_within_limits(void **state)
{
    size_t count;
    const rival_settings *of = all_settings(&count);
    modal_structure s;
    (void)state;
    small_plate(&s, 20);
    for (size_t k = 0; k < count; k++) {
        rival rival;
        rival_open(&rival, &s, interval, step_limit, DELAY, &of[k]);
        write_rival(&rival);
        run(&rival);
        rival_close(&rival);
    }
    structure_close(&s);
}

/* Decay a radian: -x, the real part of a root of (x^2 + 1)(x^2 + 2 ratio x + 1) = gain near i. */
static double exact_decay(double gain, double ratio)
{
    double complex x = I;
    for (int k = 0; k < 50; k++) {
        const double complex mode = x * x + 1, filter = x * x + 2 * ratio * x + 1;
        x -= (mode * filter - gain) / (2 * x * filter + mode * (2 * x + 2 * ratio));
    }
    return -creal(x);
}

/*
 * Law: a mode with positive position feedback of gain g and a filter of its own frequency w and the
 * damping ratio z decays, without damping of its own, like exp(-s t), where -s is the largest real
 * part of the roots of (x^2 + w^2)(x^2 + 2 z w x + w^2) = g w^4. The vibration is so small that no
 * limit acts. All modes are observed. With 200 ticks a period the sampled loop differs by less than
 * the angle of a tick, 3 %, of it; the part of the other root has decayed to 1 %.
 */
static void position_feedback_damps_at_its_rate(void **state)
{
    const double gain = 0.09, ratio = 0.3, per_period = 6.283185307179586;
    const rival_settings settings = {.kind = RIVAL_PPF,
                                     .share = 0,
                                     .modes = 1,
                                     .feedback = gain,
                                     .filter_ratio = ratio,
                                     .filter_frequency = 1};
    modal_structure s;
    rival rival;
    damped_loop *loop = &rival.loop;
    (void)state;
    small_plate(&s, 12);
    s.ratio[0] = 0;
    rival_open(&rival, &s, per_period / s.omega[0] / 200, s.limit, 0, &settings);
    double *nothing = calloc(s.outputs, sizeof *nothing);
    double before = 0, after = 0;
    const double numbers[] = {-1, gain, ratio, per_period / 200};
    write_reals(numbers, 4);
    loop->position[0] = loop_moderate_load(&s) * s.load[0];
    for (size_t i = 0; i < s.outputs; i++)
        loop->shape[i] = s.shape[i * s.modes] * loop->position[0];
    damped_loop_keep(loop);
    for (int k = 0; k < 20 * 200; k++) {
        const double now[] = {loop->position[0], loop->velocity[0], rival.state[0], rival.state[1]};
        write_reals(now, 4);
        assert_false(PZS_IS_ERROR(damped_loop_tick(loop, nothing)));
        const double square = pow(loop->position[0], 2) + pow(loop->velocity[0], 2);
        before += k >= 12 * 200 && k < 16 * 200 ? square : 0;
        after += k >= 16 * 200 ? square : 0;
    }
    const double rate = log(before / after) / 2 / (4 * per_period);
    print_message("decay a radian of the first mode %.4f\n", rate);
    assert_true(fabs(rate - exact_decay(gain, ratio)) < per_period / 200 * rate);
    free(nothing);
    rival_close(&rival);
    structure_close(&s);
}

int main(int count, char **argument)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rivals_stay_within_limits),
        cmocka_unit_test(position_feedback_damps_at_its_rate),
    };
    dump = count > 1 ? fopen(argument[1], "wb") : NULL;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    return dump && fclose(dump) != 0 ? 1 : failed;
}
