/*
 * Hysteresis, creep and their inverse: the operators against their textbook definition, the inverse
 * against the effect, memories that no voltages leave, and the two blocks in a loop.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/control/hysteresis.h"

#ifdef __SANITIZE_ADDRESS__
enum { SHARE = 10 }; /* one of so many repetitions is run with the sanitizers */
#else
enum { SHARE = 1 };
#endif

enum { N = 6, M = 20, PLAYS = 8, CREEPS = 3, SEGMENTS = 4 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

/* Rounding of a sum of all parts of an effect, relative to the range of the voltages. */
static const double rounding = 64 * (double)PZS_EPSILON;

/* ---- random tables -------------------------------------------------------- */

typedef struct ceramic {
    pzs_hysteresis tables;
    pzs_real middle[N], half_range[N], offset[N], slope[N * SEGMENTS];
    pzs_real slack[N * PLAYS], above[N * PLAYS], below[N * PLAYS];
    pzs_real creep[N * CREEPS], rate[CREEPS];
    pzs_real play_memory[PLAYS], creep_memory[CREEPS];
    unsigned seed;
} ceramic;

static double draw(ceramic *c, double least, double most)
{
    return uniform(&c->seed, least, most);
}

/* A weight that is 0 in one of four cases. */
static pzs_real draw_weight(ceramic *c, double most)
{
    const double weight = draw(c, -most / 3, most);
    return (pzs_real)(weight > 0 ? weight : 0);
}

static void fill_input(ceramic *c, int k)
{
    const double most = draw(c, 20, 400);
    double slack = 0;
    c->middle[k] = (pzs_real)draw(c, -most / 2, most / 2);
    c->half_range[k] = (pzs_real)most;
    c->offset[k] = (pzs_real)draw(c, -most / 2, most / 2);
    for (int i = 0; i < SEGMENTS; i++)
        c->slope[k * SEGMENTS + i] = (pzs_real)draw(c, 0.1, 1);
    for (int i = 0; i < PLAYS; i++) {
        slack += draw(c, 0.01, 0.2) * most;
        c->slack[k * PLAYS + i] = (pzs_real)slack;
        c->above[k * PLAYS + i] = draw_weight(c, 0.2);
        c->below[k * PLAYS + i] = draw_weight(c, 0.2);
    }
    for (int j = 0; j < CREEPS; j++)
        c->creep[k * CREEPS + j] = draw_weight(c, 0.05);
}

static void open_ceramic(ceramic *c, unsigned seed)
{
    memset(c, 0, sizeof *c);
    c->seed = seed;
    for (int k = 0; k < N; k++)
        fill_input(c, k);
    for (int j = 0; j < CREEPS; j++)
        c->rate[j] = (pzs_real)draw(c, 0.001, 0.1);
    c->tables = (pzs_hysteresis){.scene = SCENE,
                                 .inputs = N,
                                 .sets = N,
                                 .plays = PLAYS,
                                 .creeps = CREEPS,
                                 .middle = c->middle,
                                 .half_range = c->half_range,
                                 .offset = c->offset,
                                 .slope = c->slope,
                                 .slack = c->slack,
                                 .above = c->above,
                                 .below = c->below,
                                 .creep = c->creep,
                                 .creep_rate = c->rate};
    assert_int_equal(pzs_hysteresis_seal(&c->tables), PZS_OK);
}

static hysteresis_memory memory_of(ceramic *c)
{
    const hysteresis_memory memory = {c->play_memory, c->creep_memory};
    return memory;
}

static double range_of(const ceramic *c, int k)
{
    return fabs((double)c->middle[k]) + (double)c->half_range[k];
}

/* A voltage in the range of input k: anywhere, near the last one, or at one of the ends. */
static pzs_real draw_voltage(ceramic *c, int k, pzs_real last)
{
    const double low = (double)(c->middle[k] - c->half_range[k]),
                 high = (double)(c->middle[k] + c->half_range[k]), kind = draw(c, 0, 1);
    double voltage = draw(c, low, high);
    if (kind < 0.4)
        voltage = (double)last + draw(c, -0.02, 0.02) * (high - low);
    else if (kind < 0.5)
        voltage = kind < 0.45 ? low : high;
    return (pzs_real)fmin(fmax(voltage, low), high);
}

static double effect(ceramic *c, int k, pzs_real voltage)
{
    return (double)pzs_hysteresis_effect(&c->tables, (uint32_t)k, memory_of(c), voltage);
}

static void remember(ceramic *c, int k, pzs_real voltage)
{
    pzs_hysteresis_remember(&c->tables, (uint32_t)k, memory_of(c), voltage, 1);
}

static void rest(ceramic *c, int k, pzs_real voltage)
{
    pzs_hysteresis_rest(&c->tables, (uint32_t)k, memory_of(c), voltage);
}

/* ---- the operators -------------------------------------------------------- */

/* The effect by its definition, from plays that follow the voltage each on its own. */
typedef struct textbook {
    long double play[PLAYS], creep[CREEPS];
} textbook;

static long double clip(long double value, long double low, long double high)
{
    return fminl(fmaxl(value, low), high);
}

static void textbook_remember(textbook *t, const ceramic *c, int k, long double voltage)
{
    const long double s = voltage - (long double)c->middle[k];
    for (int i = 0; i < PLAYS; i++) {
        const long double slack = (long double)c->slack[k * PLAYS + i];
        t->play[i] = clip(t->play[i], s - slack, s + slack);
    }
    for (int j = 0; j < CREEPS; j++)
        t->creep[j] += (long double)c->rate[j] *
                       ((long double)c->creep[k * CREEPS + j] * voltage - t->creep[j]);
}

static long double textbook_effect(const textbook *t, const ceramic *c, int k, long double voltage)
{
    const long double s = voltage - (long double)c->middle[k], half = (long double)c->half_range[k];
    long double sum = (long double)c->offset[k];
    for (int i = 0; i < SEGMENTS; i++) {
        const long double low = i == 0 ? -HUGE_VALL : (i - 2) * half / 2,
                          high = i == 3 ? HUGE_VALL : (i - 1) * half / 2;
        sum += (long double)c->slope[k * SEGMENTS + i] * (clip(s, low, high) - clip(0, low, high));
    }
    for (int i = 0; i < PLAYS; i++) {
        const long double slack = (long double)c->slack[k * PLAYS + i];
        const long double place = clip(t->play[i], s - slack, s + slack);
        sum += place * (long double)(place > 0 ? c->above : c->below)[k * PLAYS + i];
    }
    for (int j = 0; j < CREEPS; j++)
        sum += t->creep[j];
    return sum;
}

/*
 * Law: after any voltages the effect of any voltage is that of the definition, in which every play
 * follows the voltage by itself. A creep adds up one rounding in each tick, which it forgets at its
 * rate of at least 0.001.
 */
static void test_textbook(void **state)
{
    (void)state;
    for (unsigned seed = 1; seed <= 20; seed++) {
        ceramic c;
        textbook t = {{0}, {0}};
        open_ceramic(&c, seed);
        const int k = (int)(seed % N);
        pzs_real voltage = 0;
        rest(&c, k, voltage);
        for (int i = 0; i < PLAYS; i++)
            t.play[i] = -(long double)c.middle[k];
        for (int step = 0; step < 1000 / SHARE; step++) {
            voltage = draw_voltage(&c, k, voltage);
            const double error = (double)((long double)effect(&c, k, voltage) -
                                          textbook_effect(&t, &c, k, (long double)voltage));
            assert_true(fabs(error) <= 4 * rounding * range_of(&c, k));
            remember(&c, k, voltage);
            textbook_remember(&t, &c, k, (long double)voltage);
        }
    }
}

/* Law: with one set of numbers, every electrode has the effect of electrode 0 with a set of its
 * own. */
static void test_one_set(void **state)
{
    ceramic c;
    (void)state;
    open_ceramic(&c, 17);
    pzs_hysteresis single = c.tables;
    single.sets = 1;
    assert_int_equal(pzs_hysteresis_seal(&single), PZS_OK);
    for (int step = 0; step < 200; step++) {
        const pzs_real voltage = draw_voltage(&c, 0, 0), next = draw_voltage(&c, 0, voltage);
        rest(&c, 0, voltage);
        const pzs_real effect = pzs_hysteresis_effect(&c.tables, 0, memory_of(&c), next);
        assert_true(pzs_hysteresis_effect(&single, N - 1, memory_of(&c), next) == effect);
        assert_true(pzs_hysteresis_voltage(&single, N - 1, memory_of(&c), voltage, effect) ==
                    pzs_hysteresis_voltage(&c.tables, 0, memory_of(&c), voltage, effect));
        pzs_hysteresis_remember(&single, N - 1, memory_of(&c), next, 1);
        assert_true(pzs_hysteresis_effect(&single, 3, memory_of(&c), voltage) ==
                    pzs_hysteresis_effect(&c.tables, 0, memory_of(&c), voltage));
    }
}

/* Law: the effect rises with the voltage by PZS_LEAST_SLOPE at least, whatever was before. */
static void test_monotonic(void **state)
{
    ceramic c;
    (void)state;
    open_ceramic(&c, 3);
    for (int k = 0; k < N; k++) {
        pzs_real voltage = 0;
        rest(&c, k, voltage);
        for (int step = 0; step < 2000 / SHARE; step++) {
            const pzs_real one = draw_voltage(&c, k, voltage), other = draw_voltage(&c, k, voltage);
            const double rise =
                (effect(&c, k, other) - effect(&c, k, one)) * (other > one ? 1 : -1);
            const double least = (double)PZS_LEAST_SLOPE * fabs((double)(other - one));
            assert_true(rise >= least - rounding * range_of(&c, k));
            voltage = one;
            remember(&c, k, voltage);
        }
    }
}

/*
 * Law: the effect of the inverse is the wanted effect to 1e-12 of the range in double, for any
 * effect between those of the ends of the range, and the inverse does not fall.
 */
static void test_inverse(void **state)
{
    (void)state;
    for (unsigned seed = 1; seed <= 40; seed++) {
        ceramic c;
        open_ceramic(&c, 100 + seed);
        const int k = (int)(seed % N);
        const double exact = PZS_BY_BITS(4e-6, 1e-12) * range_of(&c, k);
        pzs_real voltage = c.middle[k];
        rest(&c, k, voltage);
        for (int step = 0; step < 2500 / SHARE; step++) {
            const double low = effect(&c, k, c.middle[k] - c.half_range[k]),
                         high = effect(&c, k, c.middle[k] + c.half_range[k]);
            const double wanted =
                step % 3 ? draw(&c, low, high) : effect(&c, k, draw_voltage(&c, k, voltage));
            const pzs_real one = pzs_hysteresis_voltage(&c.tables, (uint32_t)k, memory_of(&c),
                                                        voltage, (pzs_real)wanted);
            const pzs_real more =
                pzs_hysteresis_voltage(&c.tables, (uint32_t)k, memory_of(&c), voltage,
                                       (pzs_real)(wanted + draw(&c, 0, 0.1) * range_of(&c, k)));
            assert_true(fabs(effect(&c, k, one) - wanted) <= exact);
            assert_true((double)more >= (double)one - 10 * exact);
            voltage = draw(&c, 0, 1) < 0.5 ? one : draw_voltage(&c, k, voltage);
            remember(&c, k, voltage);
        }
    }
}

/* Return the largest difference of two memories of plays. */
static double apart(const pzs_real *one, const pzs_real *other)
{
    double most = 0;
    for (int i = 0; i < PLAYS; i++)
        most = fmax(most, fabs((double)(one[i] - other[i])));
    return most;
}

/*
 * Laws of Prandtl-Ishlinskii operators. Wiping out: a swing forgets every smaller one before it.
 * Minor loops close: back at a turning point, the effect is what it was there. The rate does not
 * count: a path in small steps leaves the memory of the same path in large ones.
 */
static void test_memory(void **state)
{
    ceramic c;
    pzs_real kept[PLAYS];
    (void)state;
    open_ceramic(&c, 7);
    memset(c.creep, 0, sizeof c.creep);
    for (int k = 0; k < N; k++)
        for (int turn = 0; turn < 100; turn++) {
            const pzs_real low = c.middle[k] - (pzs_real)draw(&c, 0.5, 1) * c.half_range[k],
                           high = c.middle[k] + (pzs_real)draw(&c, 0.5, 1) * c.half_range[k],
                           inner = c.middle[k] + (pzs_real)draw(&c, -0.4, 0.4) * c.half_range[k];
            const double small = rounding * range_of(&c, k);
            rest(&c, k, inner);
            remember(&c, k, low);
            remember(&c, k, high);
            memcpy(kept, c.play_memory, sizeof kept);
            const double before = effect(&c, k, high);
            for (int step = 0; step < 50; step++)
                remember(&c, k, (pzs_real)draw(&c, (double)inner, (double)high));
            remember(&c, k, high);
            assert_true(apart(kept, c.play_memory) <= small);
            assert_true(fabs(effect(&c, k, high) - before) <= small);
            rest(&c, k, (pzs_real)0);
            for (int step = 0; step <= 64; step++)
                remember(&c, k, (pzs_real)step / 64 * low);
            for (int step = 0; step <= 64; step++)
                remember(&c, k, low + (pzs_real)step / 64 * (high - low));
            assert_true(apart(kept, c.play_memory) <= small);
        }
}

/* Law: at a constant voltage, with or without missed ticks, a creep has gone the part 1 - (1 -
 * rate)^n of its way after n ticks.
 */
static void test_creep(void **state)
{
    ceramic c;
    (void)state;
    open_ceramic(&c, 11);
    rest(&c, 2, 0);
    for (int n = 1; n <= 200; n++) {
        if (n % 7 == 0) /* ticks 7, 14, ... are missed, and made up for with the next one */
            continue;
        pzs_hysteresis_remember(&c.tables, 2, memory_of(&c), c.middle[2],
                                n % 7 == 1 && n > 1 ? 2 : 1);
        for (int j = 0; j < CREEPS; j++) {
            const double end = (double)(c.creep[2 * CREEPS + j] * c.middle[2]);
            const double exact = -end * expm1(n * log1p(-(double)c.rate[j]));
            assert_true(fabs((double)c.creep_memory[j] - exact) <=
                        n * (double)PZS_EPSILON * fabs(end));
        }
    }
}

/*
 * Law: whatever the memory holds, after one tick it is one that voltages can leave: each play
 * within its slack of the one before, each creep within twice its range. A swing over the whole
 * range then leaves the memory of an undamaged electrode.
 */
static void test_damaged_memory(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e30, -1e30, 0, 50};
    enum { BAD = sizeof bad / sizeof *bad };
    ceramic c;
    pzs_real kept[PLAYS];
    (void)state;
    open_ceramic(&c, 13);
    for (int trial = 0; trial < 2000 / SHARE; trial++) {
        const int k = trial % N;
        const pzs_real low = c.middle[k] - c.half_range[k], high = c.middle[k] + c.half_range[k];
        const pzs_real voltage = draw_voltage(&c, k, 0);
        for (int i = 0; i < PLAYS; i++)
            c.play_memory[i] = (pzs_real)bad[(int)draw(&c, 0, BAD)];
        for (int j = 0; j < CREEPS; j++)
            c.creep_memory[j] = (pzs_real)bad[(int)draw(&c, 0, BAD)];
        remember(&c, k, voltage);
        double place = (double)(voltage - c.middle[k]), before = 0;
        for (int i = 0; i < PLAYS; i++) {
            const double slack = (double)c.slack[k * PLAYS + i] - before;
            assert_true(fabs((double)c.play_memory[i] - place) <=
                        slack + rounding * range_of(&c, k));
            place = (double)c.play_memory[i];
            before += slack;
        }
        for (int j = 0; j < CREEPS; j++)
            assert_true(fabs((double)c.creep_memory[j]) <=
                        2 * (double)c.creep[k * CREEPS + j] * range_of(&c, k));
        assert_true(isfinite(effect(&c, k, voltage)));
        remember(&c, k, low);
        remember(&c, k, high);
        memcpy(kept, c.play_memory, sizeof kept);
        rest(&c, k, voltage);
        remember(&c, k, low);
        remember(&c, k, high);
        for (int i = 0; i < PLAYS; i++) {
            const double slack = (double)c.slack[k * PLAYS + i];
            if (slack < (double)c.half_range[k])
                assert_true(fabs((double)(kept[i] - c.play_memory[i])) <=
                            rounding * range_of(&c, k));
        }
    }
}

/* ---- the loop ------------------------------------------------------------- */

typedef struct rig {
    ceramic ceramic; /* of the tables, whose memory is that of the plant's input 0 */
    problem_rig problem;
    pzs_amplifier amplifier;
    pzs_real wanted[M], measured[M], given[N];
    pzs_real plant_play[N * PLAYS], plant_creep[N * CREEPS];
    const pzs_hysteresis *truth; /* tables of the plant; NULL: the effect is the voltage */
    pzs_block block[8];
    size_t count;
    pzs_loop loop;
    void *work;
    double noise; /* largest noise of a reading; a reading that repeats counts as stuck */
    unsigned seed;
} rig;

enum { WITHOUT = 0, COMPENSATED = 1, QUANTISED = 2 };

static hysteresis_memory plant_memory(rig *r, int k)
{
    const hysteresis_memory memory = {r->plant_play + k * PLAYS, r->plant_creep + k * CREEPS};
    return memory;
}

static void append(rig *r, const pzs_block_type *type, const void *tables)
{
    r->block[r->count++] = (pzs_block){type, tables};
}

static void list_blocks(rig *r, int options)
{
    r->count = 0;
    if (options & COMPENSATED)
        append(r, &pzs_effect_block, &r->ceramic.tables);
    append(r, &pzs_step_block, &r->problem.tables);
    if (options & COMPENSATED)
        append(r, &pzs_inverse_block, &r->ceramic.tables);
    if (options & QUANTISED)
        append(r, &pzs_amplifier_block, &r->amplifier);
}

static pzs_status init(rig *r)
{
    const pzs_status status = start_loop(&r->loop, r->block, r->count, &r->work);
    if (status == PZS_OK)
        memcpy(r->given, r->loop.info.voltage, sizeof r->given);
    return status;
}

/* A problem on electrodes of random ceramic, with voltage limits at the ends of its range. */
static void prepare(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    open_ceramic(&r->ceramic, seed);
    r->amplifier = (pzs_amplifier){PZS_R(0.05), PZS_R(0.02)};
    problem_open(&r->problem, N, M, 0, 0, 0);
    fill_random(&r->seed, r->problem.influence, M * N, 1e-6);
    for (int k = 0; k < N; k++) {
        r->problem.lower[k] = r->ceramic.middle[k] - r->ceramic.half_range[k];
        r->problem.upper[k] = r->ceramic.middle[k] + r->ceramic.half_range[k];
        r->problem.step_limit[k] =
            (pzs_real)uniform(&r->seed, 0.02, 0.3) * r->ceramic.half_range[k];
    }
    problem_seal(&r->problem);
}

static void open_rig(rig *r, unsigned seed, int options)
{
    prepare(r, seed);
    list_blocks(r, options);
    assert_int_equal(init(r), PZS_OK);
    for (int k = 0; k < N; k++)
        pzs_hysteresis_rest(&r->ceramic.tables, (uint32_t)k, plant_memory(r, k), r->given[k]);
}

static void close_rig(rig *r)
{
    free(r->work);
}

/* Let one interval pass on the plant, and measure its shape at the end. gain: of the plant. */
static void measure(rig *r, double gain)
{
    pzs_real acting[N];
    for (int k = 0; k < N; k++) {
        acting[k] = r->given[k];
        if (r->truth) {
            acting[k] =
                pzs_hysteresis_effect(r->truth, (uint32_t)k, plant_memory(r, k), r->given[k]);
            pzs_hysteresis_remember(r->truth, (uint32_t)k, plant_memory(r, k), r->given[k], 1);
        }
    }
    for (int i = 0; i < M; i++) {
        r->measured[i] = (pzs_real)uniform(&r->seed, -r->noise, r->noise);
        for (int k = 0; k < N; k++)
            r->measured[i] += (pzs_real)gain * r->problem.influence[i * N + k] * acting[k];
    }
}

/* Shape of random voltages of `factor` times the range, as the next target. */
static void throw_target(rig *r, double factor)
{
    memset(r->wanted, 0, sizeof r->wanted);
    for (int k = 0; k < N; k++) {
        const double voltage = (double)r->ceramic.middle[k] + uniform(&r->seed, -factor, factor) *
                                                                  (double)r->ceramic.half_range[k];
        for (int i = 0; i < M; i++)
            r->wanted[i] += r->problem.influence[i * N + k] * (pzs_real)voltage;
    }
}

/* Take the voltages as amplifiers do, which checks them: no tolerance. */
static void take(rig *r, const bool *is_held)
{
    for (int k = 0; k < N; k++) {
        const pzs_real voltage = r->loop.info.voltage[k];
        const pzs_real change =
            voltage > r->given[k] ? voltage - r->given[k] : r->given[k] - voltage;
        assert_true(isfinite(voltage) && voltage >= r->problem.lower[k] &&
                    voltage <= r->problem.upper[k]);
        assert_true((is_held && is_held[k]) || change <= r->problem.step_limit[k]);
        r->given[k] = voltage;
    }
}

/*
 * Law: in 1e5 ticks of targets that jump far beyond the limits, on a plant whose ceramic is another
 * than the tables say, with inputs held and released, readings lost and restarts, no voltage leaves
 * its limits or its step limit by one bit, and the last gate never has to correct one.
 */
static void test_inside_limits(void **state)
{
    (void)state;
    for (unsigned trial = 0; trial < 10; trial++) {
        static rig r;
        static ceramic other;
        bool is_held[N] = {false};
        open_rig(&r, 300 + trial, trial % 2 ? COMPENSATED | QUANTISED : COMPENSATED);
        open_ceramic(&other, 900 + trial);
        r.truth = &other.tables;
        for (int tick = 0; tick < 10000 / SHARE; tick++) {
            if (tick % 7 == 0)
                throw_target(&r, 3);
            const uint16_t k = (uint16_t)uniform(&r.seed, 0, N);
            if (tick % 101 == 50) {
                is_held[k] = true;
                (void)pzs_hold(r.loop.info.control, k, (pzs_real)uniform(&r.seed, -500, 500));
            } else if (tick % 101 == 80) {
                (void)pzs_release(r.loop.info.control, k);
            }
            measure(&r, 0.8);
            r.measured[3] = tick % 11 == 0 ? (pzs_real)NAN : r.measured[3];
            r.wanted[0] = tick % 501 == 500 ? (pzs_real)NAN : r.wanted[0];
            const pzs_status status =
                pzs_loop_tick(&r.loop, r.wanted, tick % 13 == 0 ? NULL : r.measured);
            if (PZS_IS_ERROR(status) || status == PZS_W_OUTPUT)
                fail_msg("trial %u tick %d: %s", trial, tick, pzs_status_text(status));
            take(&r, is_held);
            if (tick % 997 == 996) {
                memset(is_held, 0, sizeof is_held);
                assert_int_equal(pzs_loop_start(&r.loop, r.given), PZS_OK);
            }
        }
        close_rig(&r);
    }
}

/*
 * Law: tables of a line of slope 1 without plays and creep change nothing. Two loops, with and
 * without the blocks, give the same voltages but for the rounding of the optimiser.
 */
static void test_no_hysteresis(void **state)
{
    static rig one, other;
    double worst = 0;
    (void)state;
    open_rig(&one, 21, WITHOUT);
    prepare(&other, 21);
    memset(other.ceramic.above, 0, sizeof other.ceramic.above);
    memset(other.ceramic.below, 0, sizeof other.ceramic.below);
    memset(other.ceramic.creep, 0, sizeof other.ceramic.creep);
    for (int k = 0; k < N; k++)
        other.ceramic.offset[k] = other.ceramic.middle[k];
    for (int i = 0; i < N * SEGMENTS; i++)
        other.ceramic.slope[i] = 1;
    assert_int_equal(pzs_hysteresis_seal(&other.ceramic.tables), PZS_OK);
    list_blocks(&other, COMPENSATED);
    assert_int_equal(init(&other), PZS_OK);
    for (int tick = 0; tick < 500; tick++) {
        if (tick % 20 == 0) {
            throw_target(&one, 1.5);
            memcpy(other.wanted, one.wanted, sizeof one.wanted);
        }
        measure(&one, 0.9);
        measure(&other, 0.9);
        assert_int_equal(pzs_loop_tick(&one.loop, one.wanted, one.measured), PZS_OK);
        assert_int_equal(pzs_loop_tick(&other.loop, other.wanted, other.measured), PZS_OK);
        take(&one, NULL);
        take(&other, NULL);
        for (int k = 0; k < N; k++)
            worst = fmax(worst,
                         fabs((double)(one.given[k] - other.given[k])) / range_of(&one.ceramic, k));
    }
    assert_true(worst <= PZS_BY_BITS(2e-3, 1e-10)); /* of the condition of random matrices */
    close_rig(&one);
    close_rig(&other);
}

/* |W (shape - wanted)|^2 for effects. */
static double objective(const rig *r, const pzs_real *acting)
{
    double sum = 0;
    for (int i = 0; i < M; i++) {
        double misfit = -(double)r->wanted[i];
        for (int k = 0; k < N; k++)
            misfit += (double)(r->problem.influence[i * N + k] * acting[k]);
        sum += misfit * misfit;
    }
    return sum;
}

/*
 * Law: without readings, on a plant that is as the tables say, every tick without step limits gives
 * the bounded optimum of the stroke that the electrodes then have: a second controller, whose
 * limits are the effects of both voltage limits, finds no better one.
 */
static void test_optimum_of_stroke(void **state)
{
    (void)state;
    for (unsigned seed = 40; seed < 60; seed++) {
        static rig r;
        pzs_real low[N], high[N], free_step[N];
        static double work[PZS_CONTROL_BYTES(N, M) / sizeof(double) + 8];
        prepare(&r, seed);
        for (int k = 0; k < N; k++)
            r.problem.step_limit[k] = free_step[k] = (pzs_real)HUGE_VAL;
        problem_seal(&r.problem);
        list_blocks(&r, COMPENSATED);
        assert_int_equal(init(&r), PZS_OK);
        for (int k = 0; k < N; k++)
            pzs_hysteresis_rest(&r.ceramic.tables, (uint32_t)k, plant_memory(&r, k), r.given[k]);
        for (int tick = 0; tick < 30; tick++) {
            pzs_real acting[N];
            pzs_control best;
            pzs_problem problem = r.problem.tables;
            throw_target(&r, 1.5);
            for (int k = 0; k < N; k++) {
                pzs_hysteresis_remember(&r.ceramic.tables, (uint32_t)k, plant_memory(&r, k),
                                        r.given[k], 1);
                low[k] = pzs_hysteresis_effect(&r.ceramic.tables, (uint32_t)k, plant_memory(&r, k),
                                               r.problem.lower[k]);
                high[k] = pzs_hysteresis_effect(&r.ceramic.tables, (uint32_t)k, plant_memory(&r, k),
                                                r.problem.upper[k]);
            }
            problem.lower = low;
            problem.upper = high;
            assert_int_equal(pzs_problem_seal(&problem), PZS_OK);
            assert_int_equal(pzs_control_init(&best, &problem, NULL, work, sizeof work), PZS_OK);
            assert_int_equal(pzs_step(&best, r.wanted), PZS_OK);
            assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, NULL), PZS_OK);
            take(&r, NULL);
            const pzs_compensator *compensator = pzs_loop_find(&r.loop, &pzs_effect_block);
            double scale = 0;
            for (int k = 0; k < N; k++) {
                acting[k] = pzs_hysteresis_effect(&r.ceramic.tables, (uint32_t)k,
                                                  plant_memory(&r, k), r.given[k]);
                assert_true(fabs((double)(compensator->info.effect[k] - acting[k])) <=
                            rounding * range_of(&r.ceramic, k));
            }
            for (int i = 0; i < M; i++)
                scale += (double)(r.wanted[i] * r.wanted[i]);
            assert_true(fabs(objective(&r, acting) - objective(&r, best.info.voltage)) <=
                        PZS_BY_BITS(1e-4, 1e-11) * scale);
        }
        close_rig(&r);
    }
}

/* Root mean square of measured - wanted over that of the target. */
static double misfit_of(const rig *r)
{
    double sum = 0, size = 0;
    for (int i = 0; i < M; i++) {
        sum += pow((double)(r->measured[i] - r->wanted[i]), 2);
        size += pow((double)r->wanted[i], 2);
    }
    return sqrt(sum / size);
}

/*
 * Law: tables of the true ceramic bring a loop to a target inside its limits in one tick; tables of
 * a wrong one bring it there too, and nothing is left to shake: hysteresis that is not there, none
 * where there is much, and 1.5 times as much. A tick leaves the part |1 - e| of the misfit, where
 * e, the true slope over that of the tables, is at most 1.75 in these cases.
 */
static void test_wrong_tables(void **state)
{
    static const struct {
        double believed, present;
    } of[] = {{1, 1}, {1, 0}, {0.4, 1}, {1.5, 1}, {0, 1}};
    (void)state;
    for (size_t trial = 0; trial < sizeof of / sizeof *of; trial++) {
        static rig r;
        static ceramic truth;
        int first = -1;
        prepare(&r, 71);
        truth = r.ceramic;
        for (int i = 0; i < N * PLAYS; i++) {
            const pzs_real weight = r.ceramic.above[i] / 2;
            r.ceramic.above[i] = (pzs_real)of[trial].believed * weight;
            r.ceramic.below[i] = (pzs_real)of[trial].believed * weight;
            truth.above[i] = truth.below[i] = (pzs_real)of[trial].present * weight;
        }
        for (int k = 0; k < N; k++)
            r.problem.step_limit[k] = (pzs_real)HUGE_VAL;
        for (int i = 0; i < N * SEGMENTS; i++)
            r.ceramic.slope[i] = truth.slope[i] = 1;
        truth.tables.above = truth.above;
        truth.tables.below = truth.below;
        truth.tables.slope = truth.slope;
        problem_seal(&r.problem);
        assert_int_equal(pzs_hysteresis_seal(&r.ceramic.tables), PZS_OK);
        list_blocks(&r, COMPENSATED);
        assert_int_equal(init(&r), PZS_OK);
        for (int k = 0; k < N; k++)
            pzs_hysteresis_rest(&truth.tables, (uint32_t)k, plant_memory(&r, k), r.given[k]);
        r.truth = &truth.tables;
        throw_target(&r, 0.5);
        for (int tick = 0; tick < 200; tick++) {
            measure(&r, 1);
            if (first < 0 && misfit_of(&r) < PZS_BY_BITS(1e-4, 1e-9))
                first = tick;
            assert_int_equal(PZS_IS_ERROR(pzs_loop_tick(&r.loop, r.wanted, r.measured)), 0);
            take(&r, NULL);
        }
        if (first < 0 || misfit_of(&r) > PZS_BY_BITS(1e-3, 1e-8))
            fail_msg("believed %g, present %g: misfit %g", of[trial].believed, of[trial].present,
                     misfit_of(&r));
        if (trial == 0)
            assert_int_equal(first, 1);
        close_rig(&r);
    }
}

/* Flip a bit of the loop or of its workspace. */
static void flip(rig *r, size_t bytes)
{
    const size_t bit = (size_t)uniform(&r->seed, 0, 8.0 * (double)bytes);
    uint8_t *memory = r->work;
    memory[bit / 8 < bytes ? bit / 8 : 0] ^= (uint8_t)(1u << bit % 8);
}

/*
 * Run some ticks with readings. Where bytes > 0 a bit flips before every tenth tick, so that the
 * damage of one bit is found before that of the next one.
 */
static void run_ticks(rig *r, int ticks, size_t bytes)
{
    for (int tick = 0; tick < ticks; tick++) {
        if (bytes > 0 && tick % 10 == 0)
            flip(r, bytes);
        measure(r, 1);
        assert_false(PZS_IS_ERROR(pzs_loop_tick(&r->loop, r->wanted, r->measured)));
        take(r, NULL);
    }
}

/*
 * Law: whatever bit of the workspace flips between two ticks, no voltage leaves its limits, its
 * step limit or the finite numbers. 400 ticks after the last flip, the loop is as near to its
 * target as before the first one.
 */
static void test_flipped_bits(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 81, COMPENSATED);
    const size_t bytes = PZS_LOOP_BYTES(3, N) + PZS_STEP_BLOCK_BYTES(N, M) +
                         PZS_EFFECT_BLOCK_BYTES(N, PLAYS, CREEPS) + PZS_INVERSE_BLOCK_BYTES(N);
    r.truth = &r.ceramic.tables;
    r.noise = 1e-9;
    for (int turn = 0; turn < 100 / SHARE; turn++) {
        throw_target(&r, 0.5);
        run_ticks(&r, 400, 0);
        const double before = misfit_of(&r);
        run_ticks(&r, 200, bytes - 8);
        run_ticks(&r, 400, 0);
        if (!(fabs(misfit_of(&r) - before) < 1e-3))
            fail_msg("turn %d: misfit %g, %g before", turn, misfit_of(&r), before);
    }
    close_rig(&r);
}

/* ---- refused -------------------------------------------------------------- */

static pzs_status init_with(rig *r, pzs_real *entry, double value)
{
    const pzs_real kept = *entry;
    *entry = (pzs_real)value;
    assert_int_equal(pzs_hysteresis_seal(&r->ceramic.tables), PZS_OK);
    const pzs_status status = init(r);
    *entry = kept;
    assert_int_equal(pzs_hysteresis_seal(&r->ceramic.tables), PZS_OK);
    return status;
}

/*
 * The effect by the identified model has the bits of the effect by tables that hold the identified
 * model alone, whatever model the inverse uses; tables without an identified model return the
 * effect of their only model.
 */
static void test_identified(void **state)
{
    static ceramic weak, whole;
    (void)state;
    open_ceramic(&weak, 41);
    open_ceramic(&whole, 41);
    for (int k = 0; k < N * PLAYS; k++) {
        weak.above[k] *= PZS_R(0.25);
        weak.below[k] *= PZS_R(0.5);
    }
    for (int k = 0; k < N * SEGMENTS; k++)
        weak.slope[k] += PZS_R(0.3);
    for (int k = 0; k < N; k++) {
        pzs_compensator compensator;
        pzs_real voltage = weak.middle[k];
        memset(&compensator, 0, sizeof compensator);
        compensator.state.tables = &weak.tables;
        pzs_real plays[N * PLAYS] = {0}, creeps[N * CREEPS] = {0};
        compensator.state.play = plays;
        compensator.state.creep = creeps;
        const hysteresis_memory memory = {plays + k * PLAYS, creeps + k * CREEPS};
        pzs_hysteresis_rest(&weak.tables, (uint32_t)k, memory, voltage);
        pzs_hysteresis_rest(&whole.tables, (uint32_t)k, memory_of(&whole), voltage);
        for (int tick = 0; tick < 50; tick++) {
            voltage = draw_voltage(&weak, k, voltage);
            weak.tables.identified_offset = tick % 2 ? whole.offset : NULL;
            weak.tables.identified_slope = tick % 2 ? whole.slope : NULL;
            weak.tables.identified_above = tick % 2 ? whole.above : NULL;
            weak.tables.identified_below = tick % 2 ? whole.below : NULL;
            assert_int_equal(pzs_hysteresis_seal(&weak.tables), PZS_OK);
            const pzs_real found = pzs_hysteresis_identified(&compensator, (uint32_t)k, voltage);
            const pzs_real expected =
                tick % 2 ? (pzs_real)effect(&whole, k, voltage)
                         : pzs_hysteresis_effect(&weak.tables, (uint32_t)k, memory, voltage);
            assert_memory_equal(&found, &expected, sizeof found);
            (void)pzs_hysteresis_remember(&weak.tables, (uint32_t)k, memory, voltage, 1);
            remember(&whole, k, voltage);
        }
    }
    weak.tables.identified_slope = NULL;
    assert_int_equal(pzs_hysteresis_seal(&weak.tables), PZS_E_ARGUMENT);
}

/* Tables that would not make a rising effect, or that belong to another problem, are refused. */
static void test_refused(void **state)
{
    static rig r;
    static const double bad[] = {NAN, INFINITY, -0.01};
    static pzs_real identified[N * PLAYS];
    (void)state;
    prepare(&r, 91);
    list_blocks(&r, COMPENSATED);
    assert_int_equal(init(&r), PZS_OK);
    pzs_real *const entries[] = {&r.ceramic.slope[5],      &r.ceramic.above[9],
                                 &r.ceramic.below[17],     &r.ceramic.creep[4],
                                 &r.ceramic.half_range[3], &r.ceramic.slack[PLAYS + 3]};
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
        for (int k = 0; k < 3; k++)
            assert_int_equal(init_with(&r, entries[i], bad[k]), PZS_E_LIMITS);
    assert_int_equal(r.loop.info.where, 1);
    assert_int_equal(init_with(&r, &r.ceramic.rate[0], 1.5), PZS_E_ARGUMENT);
    r.ceramic.tables.identified_offset = r.ceramic.tables.offset;
    r.ceramic.tables.identified_slope = r.ceramic.tables.slope;
    r.ceramic.tables.identified_above = r.ceramic.tables.above;
    r.ceramic.tables.identified_below = identified;
    for (int k = 0; k < 3; k++)
        assert_int_equal(init_with(&r, &identified[9], bad[k]), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.ceramic.slope[5], 0), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.ceramic.slack[PLAYS + 3], 0.001), PZS_E_LIMITS);
    r.ceramic.slope[0] *= 2;
    assert_int_equal(init(&r), PZS_E_CRC);
    r.ceramic.slope[0] /= 2;
    r.ceramic.tables.scene++;
    assert_int_equal(init(&r), PZS_E_FORMAT);
    r.ceramic.tables.scene--;
    r.ceramic.tables.inputs--;
    assert_int_equal(pzs_hysteresis_seal(&r.ceramic.tables), PZS_E_ARGUMENT); /* a set is too many
                                                                               */
    r.ceramic.tables.sets = 1;
    assert_int_equal(pzs_hysteresis_seal(&r.ceramic.tables), PZS_OK);
    assert_int_equal(init(&r), PZS_E_ARGUMENT);
    r.ceramic.tables.inputs++;
    r.ceramic.tables.sets = N;
    assert_int_equal(pzs_hysteresis_seal(&r.ceramic.tables), PZS_OK);
    assert_int_equal(pzs_hysteresis_seal(NULL), PZS_E_ARGUMENT);
    r.count = 2; /* without the inverse */
    assert_int_equal(init(&r), PZS_E_STAGE);
    r.count = 0;
    append(&r, &pzs_step_block, &r.problem.tables);
    append(&r, &pzs_inverse_block, &r.ceramic.tables);
    assert_int_equal(init(&r), PZS_OK);
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_E_STAGE);
    list_blocks(&r, COMPENSATED);
    r.problem.upper[2] = (pzs_real)HUGE_VAL;
    problem_seal(&r.problem);
    assert_int_equal(init(&r), PZS_E_LIMITS);
    assert_int_equal(r.loop.info.where, 2);
    close_rig(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_textbook),       cmocka_unit_test(test_one_set),
        cmocka_unit_test(test_monotonic),      cmocka_unit_test(test_inverse),
        cmocka_unit_test(test_memory),         cmocka_unit_test(test_creep),
        cmocka_unit_test(test_damaged_memory), cmocka_unit_test(test_inside_limits),
        cmocka_unit_test(test_no_hysteresis),  cmocka_unit_test(test_optimum_of_stroke),
        cmocka_unit_test(test_wrong_tables),   cmocka_unit_test(test_flipped_bits),
        cmocka_unit_test(test_refused),        cmocka_unit_test(test_identified)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
