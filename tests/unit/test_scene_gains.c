/*
 * Gains and leaks of modes of a scene: the modes that the tables hold, what is refused, and the
 * stability of the loop with them.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _XOPEN_SOURCE 700
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/model/certificate_gains.h"
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../rigs/scene_assert.h"
#include "../rigs/uniform.h"

static const char plate[] = "plate-50-patches";

/* A scene of the plate with its influence matrix and the given gains of modes. */
static void open_plate(scene_run *run, const char *changes)
{
    if (scene_run_open(run, plate, changes) < 0 ||
        analysis_influence(&run->analysis, run->error) < 0)
        fail_msg("%s", run->error);
}

/* ---- modes ------------------------------------------------------------------- */

/* Entry of the Hessian of the optimisation. */
static double hessian(const design *d, int j, int k)
{
    double sum = j == k ? d->problem.regularisation : 0;
    for (int i = 0; i < d->targets; i++)
        sum += d->weight[i] * d->weight[i] * d->influence[i * d->amplifiers + j] *
               d->influence[i * d->amplifiers + k];
    return sum;
}

/*
 * The modes are orthonormal in the Hessian, `effect` is the Hessian times the voltages, and an
 * amplifier that is held takes part in none.
 *   bound in  relative error of scalar products
 */
static void check_modes(const design *d, int held, double bound)
{
    const pzs_modal_gains *t = &d->gains.tables;
    const int n = d->amplifiers;
    double *product = calloc((size_t)n, sizeof *product);
    for (int i = 0; i < t->modes; i++) {
        const double *pattern = t->pattern + i * n;
        double most = 0;
        for (int j = 0; j < n; j++) {
            product[j] = 0;
            for (int k = 0; k < n; k++)
                product[j] += hessian(d, j, k) * pattern[k];
            most = fmax(most, fabs(product[j]));
        }
        for (int j = 0; j < n; j++)
            assert_true(j == held || fabs(t->effect[i * n + j] - product[j]) <= bound * most);
        for (int other = 0; other <= i; other++) {
            double sum = 0;
            for (int k = 0; k < n; k++)
                sum += t->effect[i * n + k] * t->pattern[other * n + k];
            assert_true(fabs(sum - (other == i)) <= bound);
        }
        if (held >= 0)
            assert_true(fpclassify(pattern[held]) == FP_ZERO &&
                        fpclassify(t->effect[i * n + held]) == FP_ZERO);
    }
    free(product);
}

/* Norm of the voltages of 1 m of a mode; the inverse of its singular value. */
static double voltage_of(const design *d, int mode)
{
    double sum = 0;
    for (int k = 0; k < d->amplifiers; k++)
        sum += pow(d->gains.tables.pattern[mode * d->amplifiers + k], 2);
    return sqrt(sum);
}

static void singular_vectors_are_orthonormal(void **state)
{
    scene_run run;
    (void)state;
    open_plate(&run, "control={modal_gains: {modes: 12, gain: 0.5}};"
                     "limits.each=[{actuator: v_2_3, hold: 5}]");
    const design *d = &run.analysis.design;
    int held = -1;
    for (int k = 0; k < d->amplifiers; k++)
        held = design_is_held(d, k) ? k : held;
    assert_true(held >= 0);
    check_modes(d, held, 1e3 * d->targets * DBL_EPSILON);
    for (int mode = 1; mode < 12; mode++)
        assert_true(voltage_of(d, mode) >= voltage_of(d, mode - 1));
    scene_run_close(&run);
}

/*
 * The first mode of functions is the best fit of its function, and `left` is what the fit leaves;
 * the fit of the second is a combination of the first two modes.
 */
static void functions_become_modes(void **state)
{
    scene_run run;
    (void)state;
    open_plate(&run,
               "control={modal_gains: {modes: [\"x^2\", \"x^2*y\", tip], gain: [0.5, 0.4, 1], "
               "leak: 0.01}}");
    const design *d = &run.analysis.design;
    const pzs_modal_gains *t = &d->gains.tables;
    const int n = d->amplifiers;
    check_modes(d, -1, 1e4 * d->targets * DBL_EPSILON);
    assert_true(fabs(t->gain[1] - 0.4) < DBL_EPSILON && fabs(t->leak[2] - 0.01) < DBL_EPSILON);
    for (int function = 0; function < 2; function++) {
        double all = 0, misfit = 0;
        double part[2] = {0, 0};
        for (int i = 0; i < d->targets; i++) {
            const double *place = d->mesh.point[d->target_node[i]].position;
            const double value = place[0] * place[0] * (function ? place[1] : 1);
            const double weighted = value * d->weight[i] * d->weight[i];
            all += value * weighted;
            for (int mode = 0; mode <= function; mode++)
                for (int k = 0; k < n; k++)
                    part[mode] += weighted * d->influence[i * n + k] * t->pattern[mode * n + k];
        }
        /* The modes are a basis of the best fits, so that these parts give the least misfit only if
           no other voltages reduce it. */
        for (int i = 0; i < d->targets; i++) {
            const double *place = d->mesh.point[d->target_node[i]].position;
            double rest = place[0] * place[0] * (function ? place[1] : 1);
            for (int mode = 0; mode <= function; mode++)
                for (int k = 0; k < n; k++)
                    rest -= part[mode] * d->influence[i * n + k] * t->pattern[mode * n + k];
            misfit += pow(d->weight[i] * rest, 2);
        }
        assert_true(fabs(sqrt(misfit / all) - d->gains.left[function]) <= 1e-6);
        assert_true(d->gains.left[function] < 0.5);
    }
    scene_run_close(&run);
}

/* ---- what is refused ---------------------------------------------------------- */

/* Scenes with wrong gains are refused with a message that names what is wrong. */
static void wrong_scenes_are_refused(void **state)
{
    static const struct {
        const char *gains, *message;
    } wrong[] = {
        {"{gain: 2}", "gain 2 plus leak 0 is 2"},
        {"{gain: -0.1}", "must be from 0 to 2"},
        {"{gain: 1.5, leak: 0.6}", "gain 1.5 plus leak 0.6 is 2.1"},
        {"{leak: 1.1}", "must be from 0 (no leak) to 1"},
        {"{modes: 3, gain: [1, 1, 1.9], leak: 0.2}", "gain 1.9 plus leak 0.2 of mode 3 is 2.1"},
        {"{modes: 3, gain: [1, 1]}", "2 values for 3 modes"},
        {"{modes: 3, gain: [1, 1, 2.5]}", "2.5 of mode 3 must be from 0 to 2"},
        {"{gain: [1, 1]}", "a list needs modes"},
        {"{gain: 1, other_gain: 1}", "there are none; add modes"},
        {"{modes: 0}", "must be from 1 to 4096"},
        {"{modes: []}", "0 modes are out of range"},
        {"{modes: 26}", "26 modes, but 25 amplifiers can move"},
        {"{modes: [x, y, x + y]}", "mode 3, 'x + y': what the actuators can make of it is a"},
        {"{modes: [x, 1 +]}", "is no number or formula"},
        {"{modes: [0*x]}", "mode 1, '0*x': the actuators cannot make it"},
        {"{modes: {file: no-such-file.csv}}", "no-such-file.csv"},
        {"{modes: 2, gains: 1}", "gains"},
        {"{modes: 2, other_leak: 2}", "must be from 0 (no leak) to 1"},
        {"{modes: 2, other_gain: 1.5, other_leak: 0.7}", "(other_gain, other_leak) is 2.2"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        scene_run run;
        char changes[200];
        snprintf(changes, sizeof changes, "control={modal_gains: %s}", wrong[i].gains);
        const bool failed = scene_run_open(&run, plate, changes) < 0 ||
                            analysis_influence(&run.analysis, run.error) < 0;
        if (!failed || !strstr(run.error, wrong[i].message))
            fail_msg("%s: %s", wrong[i].gains, failed ? run.error : "accepted");
        scene_run_close(&run);
    }
}

/* ---- growth without vibration ---------------------------------------------------- */

/*
 * Without delay the error of a mode is multiplied by 1 - leak - gain response, and with a delay of
 * one tick by a root of z^2 - (1 - gain - leak) z + gain (response - 1).
 */
static void growth_follows_the_characteristic_equation(void **state)
{
    static const double response[] = {0.8, 1, 1.33};
    unsigned seed = 3;
    (void)state;
    for (int i = 0; i < 200; i++) {
        const double leak = uniform(&seed, 0, 0.6), gain = uniform(&seed, 0.01, 1.9 - leak);
        double now = 0, late = 0;
        for (int k = 0; k < 3; k++) {
            const double b = 1 - gain - leak, c = gain * (response[k] - 1);
            const double root = b * b - 4 * c;
            now = fmax(now, fabs(1 - leak - gain * response[k]));
            late = fmax(late, root < 0 ? sqrt(c) : (fabs(b) + sqrt(root)) / 2);
        }
        assert_true(fabs(modal_gains_growth(gain, leak, 0) - now) <= 1e-6);
        assert_true(fabs(modal_gains_growth(gain, leak, 1) - late) <= 1e-6);
    }
}

/*
 * Gains that are unstable on a structure with 1.33 times the response are refused, with the largest
 * that is stable: 1.5 without delay, because 1 - 1.33 gain is above -1 below 1.5037.
 */
static void unstable_gains_are_refused(void **state)
{
    scene_run run;
    (void)state;
    open_plate(&run, "control={modal_gains: {modes: 3, gain: [1, 1.6, 1], other_gain: 0}}");
    assert_int_equal(modal_gains_check(&run.analysis.design, run.error), -1);
    assert_non_null(strstr(run.error, "gain 1.6 and leak 0 of mode 2 are unstable"));
    assert_non_null(strstr(run.error, "a gain of at most 1.5"));
    scene_run_close(&run);
    open_plate(&run, "control={modal_gains: {modes: 3, gain: [1, 1.5, 0], other_gain: 0}}");
    assert_int_equal(modal_gains_check(&run.analysis.design, run.error), 0);
    scene_run_close(&run);
}

/* ---- growth with vibration --------------------------------------------------------- */

enum { V = 3, N = 5, K = 3, DELAYS = 4, GROWTH_TICKS = 20000 };

/* A random structure of V vibration modes with N amplifiers, and a loop with K modes. */
typedef struct structure {
    double pattern[K * N], effect[K * N], gain[K], leak[K];
    double response[V * N], answer[V * N];
    double square[V], damping[V];
    size_t amplifier[N];
    pzs_modal_gains gains;
} structure;

static void fill_uniform(unsigned *seed, double *to, int count, double size)
{
    for (int i = 0; i < count; i++)
        to[i] = uniform(seed, -size, size);
}

/*
 * Patterns p_k and effects e_k with e_i'p_k = 1 for i = k and else 0: with the unit vectors a_k,
 * p_k = a_k and e_k = a_k, turned by the shear I + a b'.
 */
static void make_structure(structure *s, unsigned *seed)
{
    double a[N], b[N], ab = 0;
    memset(s, 0, sizeof *s);
    fill_uniform(seed, a, N, 0.7);
    fill_uniform(seed, b, N, 0.7);
    for (int k = 0; k < N; k++)
        ab += a[k] * b[k];
    for (int mode = 0; mode < K; mode++)
        for (int k = 0; k < N; k++) {
            s->pattern[mode * N + k] = (k == mode) + a[k] * b[mode];
            s->effect[mode * N + k] = (k == mode) - a[mode] * b[k] / (1 + ab);
        }
    fill_uniform(seed, s->response, V * N, 1);
    fill_uniform(seed, s->answer, V * N, 0.4);
    for (int i = 0; i < V; i++) {
        s->square[i] = pow(uniform(seed, 20, 400), 2);
        s->damping[i] = uniform(seed, 0.002, 0.05);
    }
    for (size_t k = 0; k < N; k++)
        s->amplifier[k] = k;
    for (int mode = 0; mode < K; mode++) {
        s->gain[mode] = uniform(seed, 0.05, 1);
        s->leak[mode] = uniform(seed, 0, 0.3);
    }
    if (uniform(seed, 0, 1) < 0.5) {
        s->gain[2] = s->gain[0];
        s->leak[2] = s->leak[0];
    }
    s->gains = (pzs_modal_gains){.inputs = N,
                                 .modes = K,
                                 .pattern = s->pattern,
                                 .effect = s->effect,
                                 .gain = s->gain,
                                 .leak = s->leak,
                                 .other_gain = uniform(seed, 0.05, 1),
                                 .other_leak = uniform(seed, 0, 0.3)};
}

/* State of the structure and its loop, in voltages. */
typedef struct motion {
    double deviation[V], velocity[V];
    double voltage[N], output[N], mean[N];
    double subtracted[DELAYS][N]; /* voltages that answer to the last measurements, newest first */
} motion;

static double static_of(const structure *s, int mode, const double *voltage)
{
    double sum = 0;
    for (int k = 0; k < N; k++)
        sum += s->response[mode * N + k] * voltage[k];
    return sum;
}

/* The part of a voltage vector in a mode with a gain. */
static double part_of(const structure *s, int mode, const double *voltage)
{
    double sum = 0;
    for (int k = 0; k < N; k++)
        sum += s->effect[mode * N + k] * voltage[k];
    return sum;
}

/* Change the voltages as the tick does: gain and leak of each mode and of the rest. */
static void step_voltages(const structure *s, motion *m, int delay)
{
    double step[N];
    for (int k = 0; k < N; k++)
        step[k] = -m->subtracted[delay][k] - m->voltage[k];
    const motion before = *m;
    for (int k = 0; k < N; k++)
        m->voltage[k] += s->gains.other_gain * step[k] - s->gains.other_leak * before.voltage[k];
    for (int mode = 0; mode < K; mode++) {
        const double change =
            (s->gain[mode] - s->gains.other_gain) * part_of(s, mode, step) -
            (s->leak[mode] - s->gains.other_leak) * part_of(s, mode, before.voltage);
        for (int k = 0; k < N; k++)
            m->voltage[k] += change * s->pattern[mode * N + k];
    }
}

static void advance(const structure *s, motion *m, const certificate_conditions *c)
{
    double change[N];
    memmove(m->subtracted[1], m->subtracted[0], (DELAYS - 1) * sizeof *m->subtracted);
    for (int k = 0; k < N; k++) {
        m->subtracted[0][k] = c->gain * (c->lag > 0 ? m->mean[k] : m->voltage[k]) - m->voltage[k];
        for (int i = 0; i < V; i++)
            m->subtracted[0][k] += s->answer[i * N + k] * m->deviation[i];
    }
    const motion before = *m;
    step_voltages(s, m, c->delay);
    const double kept = c->lag > 0 ? exp(-c->interval / c->lag) : 0;
    for (int k = 0; k < N; k++) {
        const double behind = c->lag > 0 ? c->lag / c->interval * (1 - kept) : 0;
        const double was = c->lag > 0 ? before.mean[k] : before.voltage[k];
        m->mean[k] = m->voltage[k] + behind * (before.output[k] - m->voltage[k]);
        m->output[k] = m->voltage[k] + kept * (before.output[k] - m->voltage[k]);
        change[k] = c->gain * (m->mean[k] - was);
    }
    for (int i = 0; i < V; i++) {
        const double w = sqrt(s->square[i]), z = s->damping[i], t = c->interval;
        const double d = w * sqrt(1 - z * z), decay = exp(-z * w * t);
        const double x = before.deviation[i] - static_of(s, i, change);
        const double v = before.velocity[i] * w;
        m->deviation[i] = decay * (x * cos(d * t) + (v + z * w * x) / d * sin(d * t));
        m->velocity[i] = decay * (v * cos(d * t) - (z * w * v + w * w * x) / d * sin(d * t)) / w;
    }
}

/* Growth of the motion in a tick, from many ticks. */
static double grow(const structure *s, const certificate_conditions *c)
{
    motion m;
    double log_norm = 0, *all = (double *)(void *)&m;
    const int count = (int)(sizeof m / sizeof *all);
    unsigned seed = 1;
    memset(&m, 0, sizeof m);
    fill_uniform(&seed, m.deviation, V, 1);
    fill_uniform(&seed, m.voltage, N, 1);
    for (int t = 0; t < GROWTH_TICKS; t++) {
        double square = 0;
        advance(s, &m, c);
        for (int i = 0; i < count; i++)
            square += all[i] * all[i];
        const double norm = sqrt(square);
        for (int i = 0; i < count; i++)
            all[i] /= norm;
        log_norm += t >= GROWTH_TICKS / 2 ? log(norm) : 0;
    }
    return exp(log_norm / (GROWTH_TICKS - GROWTH_TICKS / 2));
}

/*
 * The spectral radius is the growth of the loop in voltages, tick by tick, with delay and lag. The
 * norm of an oscillation is known to a factor of a few, so that its growth in 10,000 ticks is known
 * to 1e-3.
 */
static void radius_is_the_growth_of_the_loop(void **state)
{
    unsigned seed = 29;
    (void)state;
    for (int i = 0; i < 60; i++) {
        structure s;
        certificate_groups groups;
        make_structure(&s, &seed);
        const certificate_answers answers = {V, N, s.amplifier, s.response, s.answer};
        const certificate_conditions c = {.gain = uniform(&seed, 0.8, 1.33),
                                          .delay = i % DELAYS,
                                          .interval = uniform(&seed, 0.001, 0.02),
                                          .lag = i % 3 == 1 ? uniform(&seed, 0.001, 0.02) : 0};
        assert_true(certificate_groups_make(&groups, &s.gains, &answers));
        const double radius = certificate_groups_radius(&groups, s.square, s.damping, &c, 40);
        const double growth = grow(&s, &c);
        if (fabs(growth - radius) > 1e-3 * radius)
            fail_msg("loop %d: growth %.6g, radius %.6g", i, growth, radius);
        assert_int_equal(certificate_groups_decay(&groups, s.square, s.damping, &c, 40),
                         radius < 1);
        size_t order = 2 * V;
        for (size_t k = 0; k < groups.count; k++)
            order += groups.group[k].size * (1 + (size_t)c.delay + (c.lag > 0 ? 2 : 0));
        assert_int_equal(certificate_groups_order(&s.gains, V, N, &c), order);
        certificate_groups_free(&groups);
    }
}

/* Gain 1 and leak 0, of everything or of any modes, is the loop without gains. */
static void gain_1_is_the_loop_without_gains(void **state)
{
    static const char *const gains[] = {
        "{rate: 1000}", "{rate: 1000, modal_gains: {gain: 1}}",
        "{rate: 1000, modal_gains: {modes: 7, gain: 1}}",
        "{rate: 1000, modal_gains: {modes: [x, y, x^2], gain: [1, 0.999999999999, 1]}}"};
    double radius[4];
    (void)state;
    for (int i = 0; i < 4; i++) {
        scene_run run;
        char changes[200];
        snprintf(changes, sizeof changes, "control=%s", gains[i]);
        open_plate(&run, changes);
        certificate_make(&run.analysis.certificate, &run.analysis);
        radius[i] = run.analysis.certificate.radius;
        assert_int_equal(run.analysis.certificate.has_gains, i > 0);
        assert_true(fabs(radius[i] / radius[0] - 1) <= 1e-9);
        scene_run_close(&run);
    }
}

/*
 * A loop with gains never damps vibration: where the step alone would be unstable it is refused, or
 * stable by small gains.
 */
static void a_loop_with_gains_does_not_damp(void **state)
{
    (void)state;
    for (int is_slow = 0; is_slow < 2; is_slow++) {
        scene_run run;
        loop_parts parts;
        open_plate(&run, is_slow ? "control={rate: 1000, modal_gains: {gain: 0.0002}}"
                                 : "control={rate: 1000, modal_gains: {gain: 0.5}}");
        certificate_make(&run.analysis.certificate, &run.analysis);
        assert_int_equal(certificate_refuses(&run.analysis.certificate), !is_slow);
        assert_int_equal(loop_parts_open(&parts, &run.analysis, run.error), 0);
        assert_false(parts.damper.is_used);
        int with = 0;
        for (int k = 0; k < parts.blocks.count; k++)
            with += parts.blocks.block[k].type == &pzs_modal_gains_block;
        assert_int_equal(with, 1);
        loop_parts_close(&parts);
        scene_run_close(&run);
    }
}

/* The library refuses gains of modes in a loop that damps vibration. */
static void the_library_refuses_gains_beside_a_damper(void **state)
{
    scene_run run;
    loop_parts parts;
    pzs_block block[PZS_BLOCK_LIMIT];
    pzs_loop loop;
    pzs_real none;
    (void)state;
    open_plate(&run, "control={rate: 1000}");
    certificate_make(&run.analysis.certificate, &run.analysis);
    assert_int_equal(loop_parts_open(&parts, &run.analysis, run.error), 0);
    assert_true(parts.damper.is_used);
    pzs_modal_gains gains = {.scene = run.analysis.design.problem.scene,
                             .inputs = run.analysis.design.problem.inputs,
                             .other_gain = 1};
    assert_int_equal(pzs_modal_gains_seal(&gains), PZS_OK);
    block[0] = (pzs_block){&pzs_modal_gains_block, &gains};
    memcpy(block + 1, parts.blocks.block, (size_t)parts.blocks.count * sizeof *block);
    const size_t count = (size_t)parts.blocks.count + 1;
    assert_int_equal(pzs_loop_init(&loop, block, count, NULL, &none, 0), PZS_E_WORKSPACE);
    const size_t bytes = (size_t)loop.info.where;
    void *work = malloc(bytes);
    assert_non_null(work);
    assert_int_equal(pzs_loop_init(&loop, block, count, NULL, work, bytes), PZS_E_STAGE);
    assert_ptr_equal(loop.info.block, &pzs_modal_gains_block);
    free(work);
    loop_parts_close(&parts);
    scene_run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(singular_vectors_are_orthonormal),
        cmocka_unit_test(functions_become_modes),
        cmocka_unit_test(wrong_scenes_are_refused),
        cmocka_unit_test(growth_follows_the_characteristic_equation),
        cmocka_unit_test(unstable_gains_are_refused),
        cmocka_unit_test(radius_is_the_growth_of_the_loop),
        cmocka_unit_test(gain_1_is_the_loop_without_gains),
        cmocka_unit_test(a_loop_with_gains_does_not_damp),
        cmocka_unit_test(the_library_refuses_gains_beside_a_damper),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
