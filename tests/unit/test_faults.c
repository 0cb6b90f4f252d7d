/*
 * Dead and stuck electrodes found from the shape, on the plate with 25 pairs of patches. The plant
 * is not quite what the tables say: a quarter weaker, every electrode by its own 10 %, noisy
 * sensors, loads that jump and drift.
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
#include "../../lib/core/guard.h"
#include "../rigs/testdata.h"
#include "../../lib/control/control.h"

#ifndef LONG_TICKS
#define LONG_TICKS 20000
#endif

enum {
    N = 25,
    M = 121,
    DEAD = 1,
    STUCK = 2,
    FOUND_WITHIN = 12,
    COMPENSATED_WITHIN = 20,
    LOADS = 4,
    LATE = 5
};
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

typedef struct rig {
    problem_rig problem;
    pzs_control control;
    pzs_fault_detector watch;
    pzs_real goal[M], wanted[M], measured[M];
    double strength[N]; /* what an electrode really does, of what the tables say */
    double held[N];     /* V while it does not follow */
    double load[LOADS], noise;
    double late_shape[LATE + 1][M], late_model[LATE + 1][M];
    int fault[N], time;
    int lost; /* every how manyth sensor shows nothing, 0: none */
    void *work, *watch_work;
    unsigned seed;
    uint16_t delay;
} rig;

static double noise(rig *r)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += uniform(&r->seed, 0, 1);
    return sum;
}

static void rig_start(rig *r)
{
    memset(r->fault, 0, sizeof r->fault);
    r->time = 0;
    problem_seal(&r->problem);
    assert_int_equal(
        pzs_control_init(&r->control, &r->problem.tables, NULL, r->work, PZS_CONTROL_BYTES(N, M)),
        PZS_OK);
    free(r->watch_work);
    r->watch_work = malloc(PZS_FAULT_DETECTOR_BYTES(N, M, r->delay));
    assert_int_equal(pzs_fault_detector_init(&r->watch, &r->control, r->delay, r->watch_work,
                                             PZS_FAULT_DETECTOR_BYTES(N, M, r->delay)),
                     PZS_OK);
}

static void rig_open(rig *r, unsigned seed)
{
    FILE *file = fopen("tests/oracle/data/table7.txt", "r");
    testdata d;
    assert_non_null(file);
    assert_int_equal(testdata_next(file, &d), 1);
    memset(r, 0, sizeof *r);
    r->seed = seed;
    problem_open(&r->problem, N, M, -300, 300, 20);
    for (int i = 0; i < M * N; i++)
        r->problem.influence[i] = (pzs_real)testdata_values(&d, "influence")[i];
    testdata_free(&d);
    fclose(file);
    for (int i = 0; i < M; i++) {
        const double x = 0.02 * (i / 11), y = 0.02 * (i % 11);
        r->goal[i] = (pzs_real)(0.1 * x * (y - 0.1));
    }
    for (int k = 0; k < N; k++)
        r->strength[k] = 0.8 / 1.1 * uniform(&r->seed, 0.9, 1.1);
    r->noise = 1e-7;
    r->work = malloc(PZS_CONTROL_BYTES(N, M));
    assert_non_null(r->work);
    rig_start(r);
}

static void rig_close(rig *r)
{
    free(r->work);
    free(r->watch_work);
}

/* Shapes of loads: pressure, a force at the tip, twist, one side. */
static double load_shape(int load, int i)
{
    const double x = (i / 11) / 10.0, y = (i % 11) / 10.0 - 0.5;
    switch (load) {
    case 0: return x * x * (6 - 4 * x + x * x) / 3;
    case 1: return x * x * (3 - x) / 2;
    case 2: return x * x * y;
    default: return x * x * (3 - x) / 2 * (y > 0 ? y : 0);
    }
}

/* What the sensors show under the volts of the last tick; late ones, and what the model has moved
 * by since. */
static void look(rig *r)
{
    double *shape = r->late_shape[r->time % (r->delay + 1)],
           *model = r->late_model[r->time % (r->delay + 1)];
    const int then = (r->time < r->delay ? 0 : r->time - r->delay) % (r->delay + 1);
    for (int i = 0; i < M; i++) {
        shape[i] = model[i] = 0;
        for (int k = 0; k < LOADS; k++)
            shape[i] += r->load[k] * load_shape(k, i);
        for (int k = 0; k < N; k++) {
            const double voltage = (double)r->control.info.voltage[k],
                         per = (double)r->problem.influence[i * N + k];
            shape[i] += r->strength[k] * per * (r->fault[k] ? r->held[k] : voltage);
            model[i] += per * voltage;
        }
        r->measured[i] = (pzs_real)(r->late_shape[then][i] + r->noise * noise(r) +
                                    (model[i] - r->late_model[then][i]));
    }
    r->time++;
}

static void break_down(rig *r, int input, int how)
{
    r->fault[input] = how;
    r->held[input] = how == STUCK ? (double)r->control.info.voltage[input] : 0;
}

/* The sensors that are lost. */
static void blind(rig *r)
{
    for (int i = 0; i < M; i++)
        if (r->lost > 0 && i % r->lost == 0)
            r->measured[i] = (pzs_real)NAN;
}

/* One tick; volts inside limits and slew but where an electrode was just found. Returns the status
 * of the watch. */
static pzs_status tick(rig *r, double factor)
{
    pzs_real before[N];
    memcpy(before, r->control.info.voltage, sizeof before);
    for (int i = 0; i < M; i++)
        r->wanted[i] = (pzs_real)(factor * (double)r->goal[i]);
    look(r);
    blind(r);
    const pzs_status status = pzs_tick(&r->control, r->wanted, r->measured);
    assert_true(status == PZS_OK || status == PZS_W_ITERATIONS ||
                (r->lost && status == PZS_W_SENSOR));
    for (int k = 0; k < N; k++) {
        assert_true(r->control.info.voltage[k] >= r->problem.lower[k] &&
                    r->control.info.voltage[k] <= r->problem.upper[k]);
        assert_true(fabs((double)r->control.info.voltage[k] - (double)before[k]) <=
                    (double)r->problem.step_limit[k] * (1 + 2 * (double)PZS_EPSILON));
    }
    return pzs_fault_detector_tick(&r->watch, r->measured);
}

/* Of the true shape, over the goal. */
static double shape_error(const rig *r)
{
    const double *shape = r->late_shape[(r->time - 1) % (r->delay + 1)];
    double sum = 0, all = 0;
    for (int i = 0; i < M; i++) {
        sum += pow(shape[i] - (double)r->wanted[i], 2);
        all += pow((double)r->goal[i], 2);
    }
    return sqrt(sum / all);
}

static int is_held(const rig *r, int input)
{
    return r->watch.info.electrode[input] == PZS_ELECTRODE_HELD;
}

/* ---- tests ------------------------------------------------------------ */

/* Has it volts whose loss shows, though it does less than the tables say? */
static int matters(const rig *r, int input)
{
    return fabs((double)r->control.info.voltage[input]) * r->strength[input] >
           4 * (double)r->watch.settings.amplitude[input];
}

/* Ticks until all of count electrodes are held, at most `most`; nobody else is. */
static int find(rig *r, const int *input, int count, double factor, int most)
{
    int ticks = 0, all = 0;
    while (ticks < most && all < count) {
        const pzs_status status = tick(r, factor);
        assert_true(status == PZS_OK ||
                    (status == PZS_W_ELECTRODE && r->fault[r->watch.info.where] != 0));
        all = 0;
        for (int i = 0; i < count; i++)
            all += is_held(r, input[i]);
        ticks++;
    }
    for (int k = 0; k < N; k++)
        assert_true(r->fault[k] != 0 || !is_held(r, k));
    return all == count ? ticks : -1;
}

static void settle(rig *r, double factor, int ticks)
{
    for (int t = 0; t < ticks; t++)
        assert_int_equal(tick(r, factor), PZS_OK);
}

/*
 * Two electrodes die at once while a shape is held: both found within the promised ticks, held at 0
 * V, no other touched; after 20 ticks the shape is within 10 % of the best without them.
 */
static void test_two_die(void **state)
{
    int most = 0, pairs = 0;
    double worst = 0;
    rig r;
    (void)state;
    rig_open(&r, 3);
    assert_int_equal(r.watch.info.unobservable, 0);
    for (int a = 0; a < N; a++)
        for (int b = a + 1; b < N; b += 1 + N / 8) {
            const int pair[2] = {a, b};
            rig_start(&r);
            settle(&r, 1, 50);
            if (!matters(&r, a) || !matters(&r, b))
                continue;
            break_down(&r, a, DEAD);
            break_down(&r, b, DEAD);
            const int ticks = find(&r, pair, 2, 1, 30);
            assert_in_range(ticks, 1, COMPENSATED_WITHIN);
            settle(&r, 1, COMPENSATED_WITHIN - ticks);
            const double error = shape_error(&r);
            settle(&r, 1, 200);
            assert_true(!(r.control.info.voltage[a] * r.control.info.voltage[b] > 0 ||
                          r.control.info.voltage[a] * r.control.info.voltage[b] < 0));
            worst = fmax(worst, error / shape_error(&r));
            most = ticks > most ? ticks : most;
            pairs++;
        }
    print_message(
        "  %d pairs found within %d ticks; after %d at most %.3f of the best without them\n", pairs,
        most, COMPENSATED_WITHIN, worst);
    assert_true(pairs > 20 && worst < 1.1);
    rig_close(&r);
}

/*
 * An electrode sticks while nothing is asked of it; when the target turns round, it is found within
 * the promised ticks, late sensors included, and held where it stuck or was last asked to be.
 */
static void test_stuck(void **state)
{
    (void)state;
    for (uint16_t delay = 0; delay <= LATE; delay = (uint16_t)(delay + LATE)) {
        int most = 0, count = 0;
        rig r;
        rig_open(&r, 5);
        r.delay = delay;
        for (int k = 0; k < N; k++) {
            rig_start(&r);
            settle(&r, 1, 60);
            if (!matters(&r, k))
                continue;
            break_down(&r, k, STUCK);
            settle(&r, 1, 40);
            const int ticks = find(&r, &k, 1, -1, 40);
            assert_in_range(ticks, 1, FOUND_WITHIN + 1 + delay);
            most = ticks > most ? ticks : most;
            count++;
        }
        print_message("  delay %d: %d electrodes, found within %d ticks of being called for\n",
                      delay, count, most);
        assert_true(count > 10);
        rig_close(&r);
    }
}

/* With a tenth of the sensors lost for good electrodes are found all the same; with half of them
 * nobody is blamed. */
static void test_lost_sensors(void **state)
{
    static const int lost[2] = {10, 2};
    (void)state;
    for (int i = 0; i < 2; i++) {
        const int pair[2] = {0, 19};
        rig r;
        rig_open(&r, 9);
        r.lost = lost[i];
        settle(&r, 1, 60);
        break_down(&r, pair[0], DEAD);
        break_down(&r, pair[1], DEAD);
        assert_true((find(&r, pair, 2, 1, COMPENSATED_WITHIN) > 0) == (i == 0));
        if (i == 1) { /* back again: the electrodes are found once they are called for */
            assert_int_equal(r.watch.info.found, 0);
            r.lost = 0;
            assert_true(find(&r, pair, 2, -1, 2 * COMPENSATED_WITHIN) > 0);
        }
        rig_close(&r);
    }
}

/* A hold during a probe stays; an electrode released works again where it is sound, and is found
 * again where not. */
static void test_hold_and_release(void **state)
{
    const int one = 0;
    rig r;
    (void)state;
    rig_open(&r, 11);
    settle(&r, 1, 60);
    break_down(&r, one, DEAD);
    for (int t = 0; t < 5; t++)
        tick(&r, 1);
    assert_int_equal(r.watch.info.electrode[one], PZS_ELECTRODE_TESTED);
    const pzs_real held = r.control.info.voltage[one];
    assert_int_equal(pzs_hold(&r.control, 0, held), PZS_OK);
    settle(&r, 1, 40);
    assert_true(!(r.control.info.voltage[one] < held) && !(r.control.info.voltage[one] > held));
    assert_int_equal(pzs_release(&r.control, 0), PZS_OK);
    settle(&r, 1, 100);
    assert_in_range(find(&r, &one, 1, -1, 200), 1, 200);
    assert_int_equal(pzs_release(&r.control, 0), PZS_OK);
    assert_in_range(find(&r, &one, 1, 1, 40), 1, 40);
    r.fault[one] = 0;
    assert_int_equal(pzs_release(&r.control, 0), PZS_OK);
    settle(&r, 1, 100);
    assert_int_equal(r.watch.info.found, 2);
    assert_true(fabs((double)r.control.info.voltage[one]) > 100);
    rig_close(&r);
}

/*
 * No electrode is blamed for what others do: targets that jump and wander, loads that jump, drift
 * and stop, plants that change, noise, sensors that come and go.
 */
static void test_no_false_alarm(void **state)
{
    double factor = 1, drift[LOADS] = {0};
    long probed = 0;
    rig r;
    (void)state;
    rig_open(&r, 7);
    for (int t = 0; t < LONG_TICKS; t++) {
        factor = (uniform(&r.seed, 0, 1) < 0.02 ? uniform(&r.seed, -1.5, 1.5) : factor) +
                 uniform(&r.seed, -0.01, 0.01);
        for (int k = 0; k < LOADS; k++) {
            const double jump = uniform(&r.seed, 0, 1), change = uniform(&r.seed, 0, 1);
            if (change < 0.01)
                drift[k] = 0;
            else if (change < 0.02)
                drift[k] = uniform(&r.seed, -5e-5, 5e-5);
            r.load[k] = jump < 0.01 ? uniform(&r.seed, -1e-3, 1e-3)
                                    : fmin(fmax(r.load[k] + drift[k], -2e-3), 2e-3);
        }
        r.lost = t % 500 < 30 ? 3 + t / 500 % 20 : 0;
        for (int k = 0; k < N && t % 100 == 0; k++)
            r.strength[k] = 0.8 / 1.1 * uniform(&r.seed, 0.9, 1.1);
        assert_int_equal(tick(&r, factor), PZS_OK);
        for (int k = 0; k < N; k++)
            probed += r.watch.info.electrode[k] == PZS_ELECTRODE_TESTED;
    }
    print_message("  %d ticks; probed %.2f %% of the time\n", LONG_TICKS,
                  100.0 * (double)probed / LONG_TICKS / N);
    assert_int_equal(r.watch.info.found, 0);
    assert_true(probed > 0);
    rig_close(&r);
}

/* A controller whose plant is as the tables say is not disturbed: the same volts, to the last bit,
 * as without a watch. */
static void test_leaves_alone(void **state)
{
    pzs_real voltage[N];
    rig r;
    (void)state;
    for (int watched = 0; watched < 2; watched++) {
        rig_open(&r, 13);
        r.noise = 0;
        for (int k = 0; k < N; k++)
            r.strength[k] = 1;
        for (int t = 0; t < 100; t++) {
            if (!watched)
                assert_int_equal(pzs_fault_detector_init(&r.watch, &r.control, 0, r.watch_work,
                                                         PZS_FAULT_DETECTOR_BYTES(N, M, 0)),
                                 PZS_OK);
            assert_int_equal(tick(&r, t < 50 ? 0.2 : 0.25), PZS_OK);
        }
        if (watched)
            assert_memory_equal(voltage, r.control.info.voltage, sizeof voltage);
        memcpy(voltage, r.control.info.voltage, sizeof voltage);
        rig_close(&r);
    }
}

/* Electrodes that do the same, or nothing, or have neither slew nor limits, cannot be told apart:
 * they are not watched. */
static void test_blind(void **state)
{
    rig r;
    (void)state;
    rig_open(&r, 17);
    for (int i = 0; i < M; i++) {
        r.problem.influence[i * N + 1] = r.problem.influence[i * N];
        r.problem.influence[i * N + 7] = 0;
    }
    r.problem.step_limit[9] = r.problem.upper[9] = (pzs_real)HUGE_VAL;
    rig_start(&r);
    assert_int_equal(r.watch.info.unobservable, 4);
    for (int k = 0; k < N; k++)
        assert_int_equal(r.watch.info.electrode[k], k < 2 || k == 7 || k == 9
                                                        ? PZS_ELECTRODE_UNOBSERVABLE
                                                        : PZS_ELECTRODE_OBSERVED);
    settle(&r, 1, 60);
    break_down(&r, 0, DEAD);
    settle(&r, -1, 60);
    assert_int_equal(r.watch.info.found, 0);
    rig_close(&r);
}

/* How often a test of this electrode starts within 400 ticks of a target that stands still. */
static int count_tests(rig *r, int input)
{
    int count = 0;
    bool was_tested = false;
    for (int t = 0; t < 400; t++) {
        const bool is_tested = r->watch.info.electrode[input] == PZS_ELECTRODE_TESTED;
        count += is_tested && !was_tested;
        was_tested = is_tested;
        assert_int_equal(tick(r, 1), PZS_OK);
    }
    return count;
}

/*
 * A flipped bit in the sums of a healthy electrode causes one test of it at most, and leaves the
 * fault detector able to find its fault afterwards.
 */
static void test_damaged_sums(void **state)
{
    const pzs_real bad[3] = {(pzs_real)1e30, (pzs_real)HUGE_VAL, (pzs_real)NAN};
    (void)state;
    for (int b = 0; b < 9; b++) {
        int input = 0;
        rig r;
        rig_open(&r, 41);
        settle(&r, 1, 60);
        while (input < N - 1 && !matters(&r, input))
            input++;
        assert_true(matters(&r, input));
        pzs_real *const sums[3] = {r.watch.state.moved, r.watch.state.response,
                                   r.watch.state.lost_voltage};
        sums[b / 3][input] = bad[b % 3];
        assert_true(count_tests(&r, input) <= 1);
        break_down(&r, input, DEAD);
        assert_true(find(&r, &input, 1, 1, FOUND_WITHIN) > 0);
        rig_close(&r);
    }
}

/* Whatever the swings are changed to in the middle of a probe, volts and limits in force stay
 * inside the table's limits. */
static void test_swings_changed(void **state)
{
    const pzs_real bad[4] = {(pzs_real)NAN, (pzs_real)HUGE_VAL, (pzs_real)-1e30, 0};
    (void)state;
    for (int b = 0; b < 4; b++) {
        int probed = 0;
        rig r;
        rig_open(&r, 31);
        settle(&r, 1, 50);
        for (int k = 0; k < N; k += 3)
            if (matters(&r, k))
                break_down(&r, k, DEAD);
        for (int t = 0; t < 40; t++) {
            look(&r);
            assert_false(PZS_IS_ERROR(pzs_tick(&r.control, r.wanted, r.measured)));
            assert_false(PZS_IS_ERROR(pzs_fault_detector_tick(&r.watch, r.measured)));
            for (int k = 0; k < N; k++) {
                probed += r.watch.info.electrode[k] == PZS_ELECTRODE_TESTED;
                r.watch.settings.amplitude[k] = probed ? bad[b] : r.watch.settings.amplitude[k];
                assert_true(r.control.info.voltage[k] >= r.problem.lower[k] &&
                            r.control.info.voltage[k] <= r.problem.upper[k]);
                assert_true(r.control.info.lower[k] >= r.problem.lower[k] &&
                            r.control.info.upper[k] <= r.problem.upper[k]);
            }
        }
        assert_true(probed > 0);
        rig_close(&r);
    }
}

/* Every way to start wrongly has its status. */
static void test_misuse(void **state)
{
    const size_t bytes = PZS_FAULT_DETECTOR_BYTES(N, M, 2);
    pzs_fault_detector detector;
    pzs_control none;
    rig r;
    (void)state;
    memset(&detector, 0, sizeof detector);
    memset(&none, 0, sizeof none);
    rig_open(&r, 19);
    char *work = malloc(bytes + 8);
    assert_int_equal(pzs_fault_detector_tick(&detector, r.measured), PZS_E_STAGE);
    assert_int_equal(pzs_fault_detector_tick(NULL, r.measured), PZS_E_ARGUMENT);
    assert_int_equal(pzs_fault_detector_init(NULL, &r.control, 2, work, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_fault_detector_init(&detector, NULL, 2, work, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_fault_detector_init(&detector, &r.control, 2, NULL, bytes),
                     PZS_E_ARGUMENT);
    assert_int_equal(
        pzs_fault_detector_init(&detector, &r.control, PZS_DELAY_LIMIT + 1, work, bytes),
        PZS_E_ARGUMENT);
    assert_int_equal(pzs_fault_detector_init(&detector, &none, 2, work, bytes), PZS_E_STAGE);
    assert_int_equal(pzs_fault_detector_init(&detector, &r.control, 2, work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(detector.info.where, bytes);
    assert_int_equal(pzs_fault_detector_init(&detector, &r.control, 2, work + 1, bytes),
                     PZS_E_WORKSPACE);
    assert_int_equal(pzs_fault_detector_tick(&detector, r.measured), PZS_E_STAGE);
    assert_int_equal(pzs_fault_detector_init(&detector, &r.control, 2, work, bytes), PZS_OK);
    assert_int_equal(pzs_fault_detector_tick(&detector, NULL), PZS_OK);
    free(work);
    rig_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_die),        cmocka_unit_test(test_stuck),
        cmocka_unit_test(test_lost_sensors),   cmocka_unit_test(test_hold_and_release),
        cmocka_unit_test(test_no_false_alarm), cmocka_unit_test(test_leaves_alone),
        cmocka_unit_test(test_blind),          cmocka_unit_test(test_swings_changed),
        cmocka_unit_test(test_misuse),         cmocka_unit_test(test_damaged_sums),
    };
    return cmocka_run_group_tests_name("faults", tests, NULL, NULL);
}
