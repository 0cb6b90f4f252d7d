/*
 * Independent parts of a computation in several threads: order, early end, numbers of threads; the
 * certificate of a loop with the same bits for any number of threads; the error of one storm. What
 * a loop's tests keep for speed: modes, and matrices that every tick multiplies.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include "../../lib/core/product.h"
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/storm_batch.h"
#include "../../host_tools/system/parallel.h"
#include "../rigs/scene_run.h"

enum { PARTS = 200 };

static void use_threads(const char *threads)
{
    assert_int_equal(setenv("PZS_THREADS", threads, 1), 0);
}

/* A work whose parts take random times, and which ends after part `last`. */
typedef struct sums {
    int last, accepted;
    pthread_t caller;
    double sum[PARTS];
    bool is_in_order, is_by_caller;
} sums;

static void add_part(void *context, int part)
{
    sums *sums = context;
    const int terms = 100 + part * 7919 % 1000 * 20;
    for (int i = 1; i <= terms; i++)
        sums->sum[part] += 1.0 / (i + part);
}

static bool accept_part(void *context, int part)
{
    sums *sums = context;
    sums->is_in_order = sums->is_in_order && part == sums->accepted && sums->sum[part] > 0;
    sums->is_by_caller = sums->is_by_caller && pthread_equal(pthread_self(), sums->caller);
    sums->accepted++;
    return part < sums->last;
}

static sums run_sums(const char *threads, int parts, int last)
{
    sums sums = {.last = last, .caller = pthread_self(), .is_in_order = true, .is_by_caller = true};
    const parallel_work work = {.context = &sums, .run = add_part, .accept = accept_part};
    use_threads(threads);
    parallel_run(&work, parts);
    return sums;
}

/*
 * Law: every part runs once, results are accepted in the order of the parts by the calling thread,
 * and none after the part that ends the work, for any number of threads.
 */
static void test_order(void **state)
{
    static const char *const threads[] = {"1", "2", "4", "64"};
    const sums alone = run_sums("1", PARTS, PARTS);
    (void)state;
    for (int i = 0; i < 4; i++) {
        const sums all = run_sums(threads[i], PARTS, PARTS), few = run_sums(threads[i], PARTS, 17),
                   none = run_sums(threads[i], 0, PARTS), one = run_sums(threads[i], 1, PARTS);
        assert_memory_equal(all.sum, alone.sum, sizeof all.sum);
        assert_true(all.is_in_order && all.is_by_caller && few.is_in_order && few.is_by_caller);
        assert_int_equal(all.accepted, PARTS);
        assert_int_equal(few.accepted, 18);
        assert_int_equal(none.accepted, 0);
        assert_int_equal(one.accepted, 1);
    }
}

/* Law: a number of threads that is no number from 1 on is the number of processors, at most 64. */
static void test_number_of_threads(void **state)
{
    static const char *const wrong[] = {"", "0", "-3", "two", "2x", "99999999999999999999999"};
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    const int processors = online < PARALLEL_LIMIT ? (int)online : PARALLEL_LIMIT;
    (void)state;
    for (int i = 0; i < 6; i++) {
        use_threads(wrong[i]);
        assert_int_equal(parallel_threads(), processors);
    }
    use_threads("3");
    assert_int_equal(parallel_threads(), 3);
    use_threads("1000");
    assert_int_equal(parallel_threads(), PARALLEL_LIMIT);
}

static void open_panel(scene_run *run)
{
    if (scene_run_open(run, "tests/rigs/scenes/storm-panel.yaml", "") < 0 ||
        analysis_influence(&run->analysis, run->error) < 0)
        fail_msg("%s", run->error);
    certificate_make(&run->analysis.certificate, &run->analysis);
}

/* Law: certificate and margins of a loop have the same bits with one, four and seven threads. */
static void test_certificate(void **state)
{
    static const char *const threads[] = {"1", "4", "7"};
    certificate_loop loop[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        scene_run run;
        use_threads(threads[i]);
        open_panel(&run);
        if (certify_loop(&run.analysis, run.error) < 0 ||
            certify_margins(&run.analysis, true, run.error) < 0)
            fail_msg("%s", run.error);
        loop[i] = run.analysis.certificate.loop;
        scene_run_close(&run);
    }
    assert_true(loop[0].is_stable && loop[0].has_margins && loop[0].rate_to > 0);
    assert_memory_equal(&loop[0], &loop[1], sizeof loop[0]);
    assert_memory_equal(&loop[0], &loop[2], sizeof loop[0]);
}

/*
 * Law: vibration modes that are asked for again have the bits of a new computation, whatever was
 * asked for between.
 */
static void test_kept_modes(void **state)
{
    static const int number[] = {6, 20, 9, 20, 6, 9};
    scene_run run;
    (void)state;
    open_panel(&run);
    const design *design = &run.analysis.design;
    for (int i = 0; i < 6; i++) {
        vibration kept, anew;
        assert_int_equal(analysis_vibration(&run.analysis, &kept, number[i], run.error), 0);
        assert_int_equal(vibration_solve(&anew, design, number[i], MASS_LUMPED, run.error), 0);
        assert_int_equal(kept.count, number[i]);
        const size_t bytes = (size_t)number[i] * sizeof(double);
        assert_memory_equal(kept.frequency, anew.frequency, bytes);
        assert_memory_equal(kept.shape, anew.shape, bytes * (size_t)design->mesh.free_dof);
        vibration_free(&kept);
        vibration_free(&anew);
    }
    assert_int_equal(run.analysis.modes->count, 4); /* 3, and those of the certificate */
    scene_run_close(&run);
}

/*
 * Law: the matrices of a tick have the bits of the products of the library, for short and long
 * rows, few and many rows, and rows in any order.
 */
static void test_tick_matrix(void **state)
{
    enum { MOST = 200 };
    static double matrix[MOST][MOST], vector[MOST], expected[MOST], found[MOST];
    static uint32_t turned[MOST];
    (void)state;
    for (int i = 0; i < MOST * MOST; i++)
        matrix[i / MOST][i % MOST] = sin(i + 1.0) * exp(8 * cos(3.0 * i));
    for (int rows = 1; rows < MOST; rows += 23)
        for (int columns = 1; columns < MOST; columns += 14) {
            const size_t m = (size_t)rows, n = (size_t)columns;
            tick_matrix table;
            for (size_t k = 0; k < n; k++)
                vector[k] = cos(7.0 * (double)k);
            for (size_t i = 0; i < m; i++) {
                turned[i] = (uint32_t)(m - 1 - i);
                pzs_product_matrix(&expected[i], matrix[turned[i]], vector, 1, n);
            }
            assert_true(tick_matrix_open(&table, matrix[0], MOST, turned, m, n));
            tick_matrix_multiply(&table, vector, found);
            assert_memory_equal(found, expected, m * sizeof *found);
            tick_matrix_close(&table);
        }
}

static bool count_result(void *context, const storm_task *task, const storm_result *result)
{
    int *count = context;
    (void)task;
    *count += result->ticks > 0;
    return true;
}

/*
 * Law: where storms of a batch fail, the error is that of the first of them, with its place in the
 * scene, and the results before it have been visited, for any number of threads.
 */
static void test_error_of_a_storm(void **state)
{
    static const char *const threads[] = {"1", "4"};
    enum { STORMS = 12, WRONG = 5 };
    (void)state;
    for (int i = 0; i < 2; i++) {
        storm_task task[STORMS];
        scene_run run;
        storm_rig rig;
        loop_blocks blocks;
        const estimator none = {0};
        const damper unused = {0};
        int visited = 0;
        open_panel(&run);
        use_threads(threads[i]);
        loop_blocks_fill(&blocks, &run.analysis.design, &none, &unused);
        assert_int_equal(storm_open(&rig, &run.analysis, NULL, run.error), 0);
        storm_use(&rig, blocks.block, blocks.count, 0);
        for (int k = 0; k < STORMS; k++)
            task[k] = (storm_task){.plant = {.gain = k >= WRONG ? (double)NAN : 0.8,
                                             .frequency = 1,
                                             .step_limit = 0.25,
                                             .seed = (uint64_t)k}};
        memset(run.error, 0, sizeof run.error);
        assert_int_equal(storm_batch_run(&rig, task, STORMS, count_result, &visited, run.error),
                         -1);
        print_message("    %s\n", run.error);
        assert_int_equal(visited, WRONG);
        assert_non_null(strstr(run.error, "storm-panel.yaml:"));
        assert_non_null(strstr(run.error, "storm: "));
        storm_close(&rig);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),       cmocka_unit_test(test_number_of_threads),
        cmocka_unit_test(test_certificate), cmocka_unit_test(test_kept_modes),
        cmocka_unit_test(test_tick_matrix), cmocka_unit_test(test_error_of_a_storm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
