/*
 * Identification of hysteresis and creep from one sweep, and what its inverse leaves on ceramics of
 * other families: Bouc-Wen, Preisach, plays.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>
#include "../rigs/ceramic_sweep.h"
#include "../rigs/scene_run.h"
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/compensation.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/storm.h"
#include "../../lib/control/hysteresis.h"

static const double limit = 300, interval = 1e-3;
static const char *const family_name[FAMILIES] = {"Bouc-Wen", "Preisach", "plays"};

/* The compensation that a sweep gives. */
static void compensate(compensation *compensation, const identification *found)
{
    const pzs_problem problem = {.inputs = 1};
    compensation_fill(compensation, &found->hysteresis, &problem, 1 / interval);
}

/* Wanted effect of tick k of 1500: four sines, at most 0.8 of the limit, swelling and fading. */
static double wanted_effect(int k)
{
    static const double cycles[] = {6, 14.6, 26.2, 43.4}, phase[] = {0.3, 2.1, 4.4, 5.2};
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += sin(6.283185307179586 * cycles[i] * k / 1500 + phase[i]) / 3.4;
    const double swell = 0.4 + 0.6 * fabs(sin(k / 300.0));
    return 0.8 * limit * sum * swell * fmin(1, k / 50.0);
}

/* Largest and RMS distance of the effect from the wanted one, over the range; NULL: no inverse. */
static void run_open_loop(test_ceramic *c, const compensation *compensation, double *largest,
                          double *rms)
{
    double play[SCENE_PLAYS], creep[SCENE_CREEPS], voltage = 0, squares = 0;
    const hysteresis_memory memory = {play, creep};
    const double start = ceramic_act(c, 0, interval);
    *largest = 0;
    if (compensation)
        pzs_hysteresis_rest(&compensation->tables, 0, memory, 0);
    for (int k = 0; k < 1500; k++) {
        const double wanted = wanted_effect(k);
        if (compensation) {
            voltage = pzs_hysteresis_voltage(&compensation->tables, 0, memory, voltage, wanted);
            voltage = fmin(fmax(voltage, -limit), limit);
            pzs_hysteresis_remember(&compensation->tables, 0, memory, voltage, 1);
        }
        const double error =
            ceramic_act(c, compensation ? voltage : wanted, interval) - start - wanted;
        *largest = fmax(*largest, fabs(error) / (2 * limit));
        squares += error * error / 1500;
    }
    *rms = sqrt(squares) / (2 * limit);
}

/*
 * Law: on a ceramic with 20 % of hysteresis and creep of 3 % for each time constant, the inverse
 * leaves at most 3 % of the range on Preisach's relays and 5 % on a Bouc-Wen ceramic, and less than
 * 0.7 times what is left without it. On plays, its own family, it leaves less than 1 %.
 */
static void test_open_loop(void **state)
{
    static const double most[FAMILIES] = {0.05, 0.03, 0.01};
    (void)state;
    for (int family = 0; family < FAMILIES; family++) {
        static test_ceramic c;
        static ceramic_sweep r;
        identification found;
        compensation inverse;
        char error[SCENE_ERROR];
        double bare[2], left[2];
        open_test_ceramic(&c, (ceramic_family)family, limit, 0.2, 0.03);
        ceramic_sweep_measure(&r, &c, interval, 1);
        if (identify(&found, &r.sweep, 8, 1, error) < 0)
            fail_msg("%s", error);
        compensate(&inverse, &found);
        open_test_ceramic(&c, (ceramic_family)family, limit, 0.2, 0.03);
        run_open_loop(&c, NULL, &bare[0], &bare[1]);
        open_test_ceramic(&c, (ceramic_family)family, limit, 0.2, 0.03);
        run_open_loop(&c, &inverse, &left[0], &left[1]);
        print_message("%s: largest and RMS error %.2f and %.2f %% of the range, without inverse "
                      "%.2f and %.2f; fit %.2f %%, straight line %.2f %%\n",
                      family_name[family], 100 * left[0], 100 * left[1], 100 * bare[0],
                      100 * bare[1], 100 * found.rms, 100 * found.straight);
        for (int j = 0; j < found.hysteresis.creep.count; j++)
            assert_true(found.hysteresis.creep.value[j] < 0.06); /* twice the true creep */
        assert_true(left[0] <= most[family] && left[0] < 0.7 * bare[0] && left[1] < 0.5 * bare[1]);
    }
}

/*
 * Law: from a sweep without noise of a ceramic whose numbers the tables can hold, these numbers
 * come back, and the misfit is rounding, where the weights of each play and all creeps are alike.
 */
static void test_own_numbers(void **state)
{
    static ceramic_sweep r;
    static test_ceramic unused;
    identification first, again;
    compensation known;
    char error[SCENE_ERROR];
    double play[SCENE_PLAYS], creep[SCENE_CREEPS];
    const hysteresis_memory memory = {play, creep};
    (void)state;
    open_test_ceramic(&unused, PLAYS_FAMILY, limit, 0.2, 0.03);
    ceramic_sweep_measure(&r, &unused, interval, 1);
    assert_int_equal(identify(&first, &r.sweep, 8, 0, error), 0);
    first.hysteresis.below = first.hysteresis.above;
    for (int j = 1; j < first.hysteresis.creep.count; j++)
        first.hysteresis.creep.value[j] = first.hysteresis.creep.value[0];
    compensate(&known, &first);
    pzs_hysteresis_rest(&known.tables, 0, memory, 0);
    for (size_t i = 0; i < r.count; i++) {
        r.position[i] = 1e-7 * pzs_hysteresis_effect(&known.tables, 0, memory, r.voltage[i]) - 3e-6;
        pzs_hysteresis_remember(&known.tables, 0, memory, r.voltage[i], 1);
    }
    assert_int_equal(identify(&again, &r.sweep, 8, 1e-7, error), 0);
    assert_true(again.rms < 1e-9);
    for (int k = 0; k < 8; k++) {
        assert_true(fabs(again.hysteresis.above.value[k] - first.hysteresis.above.value[k]) < 1e-6);
        assert_true(fabs(again.hysteresis.below.value[k] - first.hysteresis.above.value[k]) < 1e-6);
    }
    for (int j = 0; j < again.hysteresis.creep.count; j++)
        assert_true(fabs(again.hysteresis.creep.value[j] - first.hysteresis.creep.value[j]) < 1e-5);
}

/* ---- storms --------------------------------------------------------------- */

enum { AMPLIFIERS = 25, STRUCTURES = 5 }; /* structures of the certificate */

#define LINEAR_PLATE                                                                               \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant={kinematics: linear, modes: "  \
    "30};"

/* The electrodes of a plate. */
typedef struct plate_ceramic {
    test_ceramic electrode[AMPLIFIERS];
    double lowest[AMPLIFIERS], highest[AMPLIFIERS];
} plate_ceramic;

static void act_plate(void *state, const double *voltage, double *acting)
{
    plate_ceramic *plate = state;
    for (int k = 0; k < AMPLIFIERS; k++)
        acting[k] = ceramic_act(&plate->electrode[k], voltage[k], interval);
}

/* Electrodes at rest, of a family and with a width of hysteresis; the stroke is of a full swing. */
static void open_plate(plate_ceramic *plate, ceramic_family family, double width)
{
    static test_ceramic swung;
    open_test_ceramic(&swung, family, limit, width, 0.03);
    (void)ceramic_act(&swung, -limit, 0);
    const double high = ceramic_act(&swung, limit, 0), low = ceramic_act(&swung, -limit, 0);
    for (int k = 0; k < AMPLIFIERS; k++) {
        open_test_ceramic(&plate->electrode[k], family, limit, width, 0.03);
        plate->lowest[k] = low;
        plate->highest[k] = high;
    }
}

/* Storms that settle, of one on each structure; *worst: the farthest end. */
static int count_settled(const storm_rig *rig, ceramic_family family, double width, double *worst)
{
    static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};
    static plate_ceramic plate;
    int settled = 0;
    *worst = 0;
    for (int i = 0; i < STRUCTURES; i++) {
        char error[SCENE_ERROR];
        storm_result result;
        open_plate(&plate, family, width);
        const storm_ceramic ceramic = {act_plate, &plate, plate.lowest, plate.highest};
        const storm_plant plant = {.gain = gain[i],
                                   .frequency = frequency[i],
                                   .step_limit = i % 2 ? 0.25 : 1,
                                   .seed = 7,
                                   .ceramic = &ceramic};
        assert_int_equal(storm_run(rig, &plant, &result, error), 0);
        settled += result.passed;
        *worst = fmax(*worst, result.end);
    }
    return settled;
}

/*
 * Laws of the loop around a vibrating plate whose ceramic is of another family than plays. No storm
 * of the certificate fails. Storms on this ceramic settle within 5 % of the target from the optimum
 * of the stroke on every structure of the certificate, with Preisach's relays and with a Bouc-Wen
 * ceramic, also where the ceramic has half of the hysteresis that the sweep has shown.
 */
static void test_storms(void **state)
{
    (void)state;
    for (int family = 0; family < PLAYS_FAMILY; family++) {
        static test_ceramic c;
        static ceramic_sweep r;
        scene_run run;
        identification found;
        char error[SCENE_ERROR], changes[2000] = LINEAR_PLATE;
        const size_t used = sizeof LINEAR_PLATE - 1;
        open_test_ceramic(&c, (ceramic_family)family, limit, 0.2, 0.03);
        ceramic_sweep_measure(&r, &c, interval, 1);
        assert_int_equal(identify(&found, &r.sweep, 8, 1, error), 0);
        ceramic_sweep_section(&found.hysteresis, changes + used, sizeof changes - used);
        if (scene_run_open(&run, "plate-closed-loop", changes) < 0 ||
            analysis_influence(&run.analysis, run.error) < 0)
            fail_msg("%s", run.error);
        certificate_make(&run.analysis.certificate, &run.analysis);
        assert_int_equal(certify_loop(&run.analysis, run.error), 0);
        const damper_options options = {run.scene.control.rate, 0,
                                        run.analysis.certificate.settings};
        const estimator none = {0};
        damper damper;
        loop_blocks blocks;
        storm_rig rig;
        assert_int_equal(damper_make(&damper, &run.analysis, NULL, &options, error), 0);
        loop_blocks_fill(&blocks, &run.analysis.design, &none, &damper);
        assert_int_equal(storm_open(&rig, &run.analysis, NULL, error), 0);
        storm_use(&rig, blocks.block, blocks.count, 0);
        assert_int_equal(run.analysis.certificate.loop.failed, 0);
        for (int half = 0; half < 2; half++) {
            double worst;
            const int settled =
                count_settled(&rig, (ceramic_family)family, half ? 0.1 : 0.2, &worst);
            print_message("tables of %s, %s of the hysteresis: %d of %d storms settle, the worst "
                          "%.4f of the target from the optimum\n",
                          family_name[family], half ? "half" : "all", settled, STRUCTURES, worst);
            assert_int_equal(settled, STRUCTURES);
        }
        storm_close(&rig);
        damper_close(&damper);
        scene_run_close(&run);
    }
}

/* What is no sweep is refused by name. */
static void test_refused(void **state)
{
    static ceramic_sweep r;
    static test_ceramic c;
    identification found;
    char error[SCENE_ERROR];
    (void)state;
    open_test_ceramic(&c, PLAYS_FAMILY, limit, 0.1, 0);
    ceramic_sweep_measure(&r, &c, interval, -1);
    assert_int_equal(identify(&found, &r.sweep, 8, 0, error), -1);
    assert_non_null(strstr(error, "does not rise with the voltage"));
    r.position[17] = NAN;
    assert_int_equal(identify(&found, &r.sweep, 8, 0, error), -1);
    assert_non_null(strstr(error, "sample 18 of the sweep is not a number"));
    memset(r.voltage, 0, sizeof r.voltage);
    r.position[17] = 0;
    assert_int_equal(identify(&found, &r.sweep, 8, 0, error), -1);
    assert_non_null(strstr(error, "the voltage of the sweep is constant"));
    r.sweep.count = 20;
    assert_int_equal(identify(&found, &r.sweep, 8, 0, error), -1);
    assert_non_null(strstr(error, "20 samples of a sweep are out of range (100 to 60000)"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_loop), cmocka_unit_test(test_own_numbers),
        cmocka_unit_test(test_storms), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
