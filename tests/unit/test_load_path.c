/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load paths: points are equilibria, limit points and bifurcations lie where theory and literature
 * say, and an equilibrium that depends on the way of loading is named.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/follow_path.h"
#include "../rigs/scene_assert.h"

#define ROOF_8 "mesh.theta1.elements=8;mesh.theta2.elements=8"
#define COLUMN "tests/rigs/scenes/column.yaml"
#define PULLED "tests/rigs/scenes/pulled-cylinder.yaml"

static void follow(scene_run *run, load_path *path, const char *scene, const char *changes)
{
    open_run(run, scene, changes);
    if (load_path_follow(path, &run->analysis, run->error) < 0 || !path->is_complete)
        fail_msg("%s", run->error);
}

/* Value of the scene's first output at a point of the path. */
static double output_at(const scene_run *run, const load_path *path, int point)
{
    return analysis_output(&run->analysis, 0, 0, path->value + (size_t)point * (size_t)path->rows);
}

/*
 * Solve for a part of the load, in small load steps. Returns the first output, or NAN where no
 * equilibrium is found, as above a limit load.
 */
static double by_load_steps(const char *scene, const char *changes, double load_factor)
{
    scene_run run;
    open_run(&run, scene, changes);
    pzs_solver *solver = &run.analysis.equilibrium.solver;
    const uint32_t inputs = run.analysis.design.structure.input.count;
    double *value = calloc(inputs, sizeof *value);
    assert_non_null(value);
    for (uint32_t j = 0; j < inputs; j++)
        value[j] = load_factor * run.analysis.equilibrium.full_input[j];
    solver->settings.load_steps = 8;
    solver->settings.tolerance = 1e-8;
    solver->settings.solve_limit = 10000;
    const pzs_status status = pzs_equilibrium(solver, value);
    assert_true(status == PZS_OK || status == PZS_E_DIVERGED || status == PZS_E_LIMIT);
    scene_run_observe(&run, solver->info.displacement);
    const double result = status == PZS_OK ? scene_run_value(&run, 0) : (double)NAN;
    free(value);
    scene_run_close(&run);
    return result;
}

/* Before the first limit point the path consists of the equilibria that load steps find. */
static void test_points_are_equilibria(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", ROOF_8);
    for (int i = 4; i < path.event[0].point; i += 4) {
        const double other = by_load_steps("hinged-roof", ROOF_8, path.point[i].load_factor);
        assert_true(fabs(output_at(&run, &path, i) / other - 1) < 1e-7);
        assert_int_equal(path.point[i].negative_pivots, 0);
    }
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * Limit load of the roof of 12.7 mm: 2225 N (Sze, Liu, Lo 2004), within 1 %; the part between the
 * limit points is unstable.
 */
static void test_snap_through(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", "");
    assert_int_equal(path.events, 2);
    assert_int_equal(path.event[0].type, LOAD_PATH_LIMIT);
    assert_int_equal(path.event[1].type, LOAD_PATH_LIMIT);
    assert_true(fabs(path.event[0].load_factor * 3000 / 2225 - 1) < 0.01);
    for (int i = 0; i < path.points; i++) {
        const int is_between = i > path.event[0].point && i <= path.event[1].point;
        assert_int_equal(path.point[i].negative_pivots, is_between);
    }
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * The limit point is located to 1e-4 of the load: a load below it by that much still has an
 * equilibrium on the path, no point of the path lies above, and one lies within 1 %; a load above
 * it has none there: load steps end behind the snap-through, or nowhere.
 */
static void test_limit_is_located(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", ROOF_8);
    const double limit = path.event[0].load_factor;
    double highest = 0;
    for (int i = 0; i <= path.event[1].point; i++)
        highest = fmax(highest, path.point[i].load_factor);
    assert_true(highest <= limit * (1 + 1e-6) && highest > 0.99 * limit);
    const double below = by_load_steps("hinged-roof", ROOF_8, limit * (1 - 1e-4));
    assert_true(fabs(below) < fabs(output_at(&run, &path, path.event[0].point + 1)));
    const double above = by_load_steps("hinged-roof", ROOF_8, limit * (1 + 1e-4));
    assert_true(isnan(above) || fabs(above) > fabs(output_at(&run, &path, path.event[1].point)));
    load_path_free(&path);
    scene_run_close(&run);
}

/* The roof of 6.35 mm snaps back: load and displacement of the centre both decrease. */
static void test_snap_back(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    int returns = 0;
    follow(&run, &path, "hinged-roof", ROOF_8 ";layers.0.thickness=6.35");
    for (int i = 1; i < path.points; i++)
        returns += path.point[i].load_factor < path.point[i - 1].load_factor &&
                   fabs(output_at(&run, &path, i)) < fabs(output_at(&run, &path, i - 1));
    assert_true(returns >= 5);
    assert_true(path.event[1].load_factor < 0);
    load_path_free(&path);
    scene_run_close(&run);
}

/* A column buckles at Euler's force, half the load of the scene, within the error of 16 elements.
 */
static void test_column_of_euler(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, COLUMN, "");
    assert_int_equal(path.events, 1);
    assert_int_equal(path.event[0].type, LOAD_PATH_BIFURCATION);
    assert_true(fabs(path.event[0].load_factor / 0.5 - 1) < 0.005);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * The pulled cylinder: one load step ends off the path, which the comparison says; the path leads
 * to the published displacement within 1 %. The comparison leaves the solver as it was.
 */
static void test_answer_off_the_path(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    solve_run(&run, PULLED, "");
    const pzs_solver_info before = run.analysis.equilibrium.solver.info;
    assert_true(analysis_path_difference(&run.analysis, run.u) > 0.01);
    assert_memory_equal(&before, &run.analysis.equilibrium.solver.info, sizeof before);
    assert_memory_equal(run.u, run.analysis.equilibrium.solver.info.displacement,
                        (size_t)run.analysis.design.mesh.free_dof * sizeof *run.u);
    scene_run_close(&run);
    follow(&run, &path, PULLED, "");
    assert_int_equal(analysis_continue(&run.analysis, run.u, run.error), 0);
    scene_run_observe(&run, run.u);
    assert_true(fabs(scene_run_value(&run, 0) / 2.768 - 1) < 0.01);
    load_path_free(&path);
    scene_run_close(&run);
}

/* Where the answer does not depend on the way, the difference is of the size of the tolerance. */
static void test_answer_on_the_path(void **state)
{
    (void)state;
    scene_run run;
    solve_run(&run, "hyperboloid", "mesh.theta1.elements=8;mesh.theta2.elements=8");
    assert_true(analysis_path_difference(&run.analysis, run.u) < 1e-4);
    scene_run_close(&run);
}

/* Scenes that the method does not follow are refused by name, also one without a load. */
static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *changes, *says;
    } bad[] = {{"scordelis-lo", "", "needs kinematics"},
               {"ring-contact", "", "contact"},
               {"hinged-roof", "loads=[]", "no load"},
               {"hinged-roof", "loads.0.u3=0", "no load"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scene_run run;
        load_path path;
        open_run(&run, bad[i].scene, bad[i].changes);
        assert_int_equal(load_path_follow(&path, &run.analysis, run.error), -1);
        assert_non_null(strstr(run.error, bad[i].says));
        load_path_free(&path);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_are_equilibria), cmocka_unit_test(test_snap_through),
        cmocka_unit_test(test_limit_is_located),      cmocka_unit_test(test_snap_back),
        cmocka_unit_test(test_column_of_euler),       cmocka_unit_test(test_answer_off_the_path),
        cmocka_unit_test(test_answer_on_the_path),    cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
