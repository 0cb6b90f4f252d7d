/*
 * Concentrated masses: natural frequencies against closed forms, weight, rigid motions, refusals.
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
#include "../../host_tools/model/design_build.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/vibration.h"
#include "../rigs/scene_assert.h"

#define FREE_PLATE "tests/rigs/scenes/spring-plate.yaml"
#define EPSILON 2.220446049250313e-16

/* The plate as a strip of length 1, width 0.1 and thickness 0.01, clamped at theta1 = 0. */
#define STRIP                                                                                      \
    "materials.steel={E: 2.1e11, nu: 0, density: 8000};layers.0.thickness=0.01;"                   \
    "supports=[{edge: theta1-, fix: clamped}];outputs=[];mesh.theta2={from: 0, to: 0.1, "          \
    "elements: 1};"
#define CLAMPED                                                                                    \
    "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: clamped}, {edge: theta2-, "     \
    "fix: clamped}, {edge: theta2+, fix: clamped}];"

static const double strip_mass = 8000 * 0.01 * 0.1, strip_bending = 2.1e11 * 0.1 * 1e-6 / 12;

/* Compute vibration modes of a scene, which stays open. */
static void solve_modes(scene_run *run, vibration *modes, const char *name, const char *changes,
                        int number)
{
    char error[SCENE_ERROR] = "";
    open_run(run, name, changes);
    if (vibration_solve(modes, &run->analysis.design, number, MASS_LUMPED, error) < 0)
        fail_msg("%s", error);
}

static double square(const char *name, const char *changes, int mode)
{
    scene_run run;
    vibration modes;
    solve_modes(&run, &modes, name, changes, mode + 2);
    const double found = modes.square[mode];
    vibration_free(&modes);
    scene_run_close(&run);
    return found;
}

/* ---- vibration --------------------------------------------------------- */

/*
 * Left-hand side of the frequency equation of a cantilever with a mass at its tip, `ratio` times
 * that of the beam; its first zero is beta, with the squared angular frequency beta^4 EI/(m L^3).
 */
static double frequency_equation(double beta, double ratio)
{
    return 1 + cos(beta) * cosh(beta) +
           ratio * beta * (cos(beta) * sinh(beta) - sin(beta) * cosh(beta));
}

static double first_beta(double ratio)
{
    double low = 0.1, high = 2;
    for (int i = 0; i < 100; i++) {
        const double middle = (low + high) / 2;
        if (frequency_equation(middle, ratio) > 0)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/*
 * Law: the first squared frequency of a strip with a mass at its tip is that of the beam. Shear and
 * rotary inertia of the strip lower it by about (h/L)^2 = 1e-4; the error of the mesh falls with
 * the square of the element length, which two meshes show.
 */
static void test_tip_mass(void **state)
{
    static const double ratio[3] = {0.1, 1, 10};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double exact = pow(first_beta(ratio[k]), 4) * strip_bending / strip_mass;
        double error[2];
        for (int mesh = 0; mesh < 2; mesh++) {
            char changes[1024];
            snprintf(changes, sizeof changes,
                     STRIP "mesh.theta1.elements=%d;masses=[{edge: theta1+, per: length, mass: "
                           "%.17g}]",
                     10 << mesh, ratio[k] * strip_mass / 0.1);
            error[mesh] = square(FREE_PLATE, changes, 0) / exact - 1;
        }
        print_message("    tip mass %g: errors %.2g %.2g\n", ratio[k], error[0], error[1]);
        assert_true(fabs(error[0]) < 1 / 100.0);
        assert_true(fabs((4 * error[1] - error[0]) / 3) < 1e-4);
    }
}

/*
 * Law: a strip without weight that carries a mass m with the moment of inertia J at its tip has the
 * two bending frequencies of the pencil EI/L^3 [[12, -6], [-6, 4]], diag(m, J), here with L = 1;
 * one of torsion, about G b h^3/(3 J L), lies between them.
 */
static void test_rotary_inertia(void **state)
{
    const double m = 2, inertia = 0.4, k = strip_bending;
    const double half = (12 * k / m + 4 * k / inertia) / 2,
                 product = (12 * 4 - 6 * 6) * k * k / (m * inertia);
    const double root = sqrt(half * half - product), exact[2] = {half - root, half + root};
    (void)state;
    for (int mode = 0; mode < 2; mode++)
        assert_near("squared frequency",
                    square(FREE_PLATE,
                           STRIP "materials.steel.density=8e-3;mesh.theta1.elements=40;masses=[{"
                                 "points: [[1, 0.05]], mass: 2, rotary_inertia: 0.4}]",
                           2 * mode),
                    exact[mode], 2e-3);
}

/*
 * Law: the frequencies of a plate with a mass m at a point satisfy 1/(m w^2) = c + sum over the
 * modes of the plate without it of s^2 w^2/(w_k^2 (w_k^2 - w^2)), where c is the static compliance
 * of the point and s its displacement in the mode k. Modes that are left out add at most
 * w^2/(w_n^2 - w^2) times their part of the compliance, where n is the last mode in the sum.
 */
static void test_plate(void **state)
{
    static const double mass[3] = {10, 100, 1000};
    enum { MODES = 30 };
    const char *const plate = CLAMPED "mesh.theta1.elements=8;mesh.theta2.elements=8;"
                                      "outputs=[{name: a, z: mean, at: {theta1: 0.5, theta2: "
                                      "0.5}}];loads=[{point: {theta1: 0.5, theta2: 0.5}, z: 1}];";
    scene_run run;
    vibration modes;
    (void)state;
    solve_run(&run, FREE_PLATE, plate);
    const double compliance = scene_run_value(&run, 0);
    scene_run_close(&run);
    solve_modes(&run, &modes, FREE_PLATE, plate, MODES);
    for (int k = 0; k < 3; k++) {
        char changes[1024];
        snprintf(changes, sizeof changes, "%smasses=[{at: {theta1: 0.5, theta2: 0.5}, mass: %g}]",
                 plate, mass[k]);
        const double found = square(FREE_PLATE, changes, 0);
        double sum = compliance, left = compliance, last = 0;
        for (int mode = 0; mode < MODES; mode++) {
            scene_run_observe(&run, modes.shape + mode * run.analysis.design.mesh.free_dof);
            const double s = scene_run_value(&run, 0);
            last = modes.square[mode];
            sum += s * s * found / (last * (last - found));
            left -= s * s / last;
        }
        const double bound = left * found / (last - found), want = 1 / (mass[k] * found);
        print_message("    mass %g: first squared frequency %.6g of %.6g\n", mass[k], found,
                      modes.square[0]);
        assert_true(bound < 0.01 * want);
        assert_true(want - sum >= -1e-9 * want && want - sum <= bound);
    }
    vibration_free(&modes);
    scene_run_close(&run);
}

/* ---- rigid motions ------------------------------------------------------ */

typedef struct weighed {
    const char *name, *density, *masses;
    double mass;
} weighed;

/* Law: a rigid translation has the sum of all masses, on flat and curved shells. */
static void test_translation(void **state)
{
    static const weighed of[] = {
        {FREE_PLATE, "", "masses=[{at: {theta1: 1, theta2: 0}, mass: 7, on: outer}]", 7},
        {FREE_PLATE, "", "masses=[{edge: theta1+, mass: 7}]", 5 * 7},
        {FREE_PLATE, "", "masses=[{edge: theta1+, per: length, mass: 7}]", 7},
        {FREE_PLATE, "", "masses=[{at: {theta1: [0, 0.5]}, per: area, mass: 7}]", 3.5},
        {FREE_PLATE, "", "masses=[{points: [[0.3, 0.4], [0.61, 0.7]], mass: 7}]", 14},
        {"hemisphere", "element=improved;materials.shell.density=1;",
         "masses=[{at: nodes, mass: 1e-3, on: inner}]", 17 * 17e-3},
        {"tests/rigs/scenes/spring-disc.yaml", "", "masses=[{set: centre, mass: 7}]", 7},
        {"tests/rigs/scenes/spring-disc.yaml", "", "masses=[{points: [[1e-3, 2e-3]], mass: 7}]", 7},
    };
    static const double still[3] = {0, 0, 0};
    (void)state;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++)
        for (int axis = 0; axis < 3; axis++) {
            double sum[2], shift[3] = {0, 0, 0};
            shift[axis] = 1;
            for (int with_masses = 0; with_masses < 2; with_masses++) {
                scene scene;
                design design;
                mass mass;
                char changes[512], error[SCENE_ERROR] = "";
                snprintf(changes, sizeof changes, "%s%s", of[i].density,
                         with_masses ? of[i].masses : "");
                if (scene_run_read(&scene, of[i].name, changes, error) < 0 ||
                    design_build(&design, &scene, error) < 0 ||
                    mass_build(&mass, &design, MASS_LUMPED, error) < 0)
                    fail_msg("%s", error);
                sum[with_masses] = mass_rigid(&mass, NULL, shift, still, NULL);
                mass_free(&mass);
                design_free(&design);
                scene_free(&scene);
            }
            const double tolerance = 1e4 * EPSILON * (sum[1] + of[i].mass);
            if (!(fabs(sum[1] - sum[0] - of[i].mass) <= tolerance))
                fail_msg("%s: %.15g, should be %.15g", of[i].masses, sum[1] - sum[0], of[i].mass);
        }
}

/* ---- weight -------------------------------------------------------------- */

/*
 * Law: the reactions under gravity carry the weight of the shell and of the masses, and the masses
 * alone do not change a static displacement without gravity, in any bit.
 */
static void test_weight(void **state)
{
    const char *const held = CLAMPED "outputs=[{name: r, reaction: z, at: nodes}, {name: m, "
                                     "reaction: moment_y, at: nodes}, {name: u, z: mean, at: "
                                     "{theta1: 0.5, theta2: 0.5}}];";
    const char *const masses = "masses=[{points: [[0.3, 0.4]], mass: 70, on: outer}];";
    double u[2];
    char changes[1024];
    scene_run run;
    (void)state;
    snprintf(changes, sizeof changes, "%s%sloads=[{weight: {axis: z, gravity: -9.81}}]", held,
             masses);
    solve_run(&run, FREE_PLATE, changes);
    const double plate = 8000 * 0.02, g = 9.81;
    assert_near("reaction", scene_run_value(&run, 0), (plate + 70) * g, 1e-9);
    assert_near("moment about the centre", scene_run_value(&run, 1), 70 * g * (0.5 - 0.3), 1e-9);
    scene_run_close(&run);
    for (int k = 0; k < 2; k++) {
        snprintf(changes, sizeof changes, "%s%sloads=[{face: outer, pressure: 100}]", held,
                 k ? masses : "");
        solve_run(&run, FREE_PLATE, changes);
        u[k] = scene_run_value(&run, 2);
        scene_run_close(&run);
    }
    assert_true(u[0] != 0);
    assert_memory_equal(&u[0], &u[1], sizeof *u);
}

/* ---- refusals -------------------------------------------------------------- */

/* Check that the mesh of a scene is refused with each of some changes. */
static void assert_refused_on(const char *name, const refusal *item, size_t items)
{
    for (size_t i = 0; i < items; i++) {
        scene_run run;
        assert_int_equal(scene_run_open(&run, name, item[i].set), -1);
        if (!strstr(run.error, item[i].expected))
            fail_msg("%s: %s", item[i].set, run.error);
        scene_run_close(&run);
    }
}

static void test_refused(void **state)
{
    static const refusal bad[] = {
        {"masses=[{at: nodes, mass: 0}]", "mass"},
        {"masses=[{at: nodes, mass: -1}]", "mass"},
        {"masses=[{at: nodes, mass: .nan}]", "mass"},
        {"masses=[{at: nodes, mass: .inf}]", "mass"},
        {"masses=[{at: nodes}]", "mass"},
        {"masses=[{mass: 1}]", "one of at, edge, set and points"},
        {"masses=[{at: nodes, points: [[0, 0]], mass: 1}]", "one of at, edge, set and points"},
        {"masses=[{points: [], mass: 1}]", "empty"},
        {"masses=[{at: {theta1: 99, theta2: 0}, mass: 1}]", "no node"},
        {"masses=[{at: nodes, mass: 1, rotary_inertia: -1}]", "rotary_inertia"},
        {"masses=[{at: nodes, mass: 1, rotary_inertia: 1, per: area}]", "rotary_inertia"},
        {"masses=[{points: [[0, 0]], mass: 1, per: area}]", "points"},
        {"masses=[{set: rim, mass: 1}]", "set"},
        {"masses=[{name: a, at: nodes, mass: 1}, {name: a, at: nodes, mass: 1}]", "two masses"},
        {"masses=[{at: nodes, mass: 3 mm}]", "a mass"},
    };
    static const refusal on_mesh[] = {
        {"masses=[{points: [[9, 9]], mass: 1}]", "not on the mesh"},
        {"masses=[{points: [[0.01, .nan]], mass: 1}]", "points"},
        {"masses=[{at: nodes, per: length, mass: 1}]", "needs an edge"},
    };
    static const refusal on_dish[] = {
        {"masses=[{points: [[9, 9, 5]], mass: 1}]", "point 1, [9, 9, 5], is not on the mesh"},
        {"masses=[{points: [[9, 9]], mass: 1}]", "point 1, [9, 9], is not on the mesh"},
    };
    (void)state;
    assert_refused("plate-50-patches", bad, sizeof bad / sizeof *bad);
    assert_refused_on("plate-50-patches", on_mesh, sizeof on_mesh / sizeof *on_mesh);
    assert_refused_on("tests/rigs/scenes/dish.yaml", on_dish, sizeof on_dish / sizeof *on_dish);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tip_mass), cmocka_unit_test(test_rotary_inertia),
        cmocka_unit_test(test_plate),    cmocka_unit_test(test_translation),
        cmocka_unit_test(test_weight),   cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
