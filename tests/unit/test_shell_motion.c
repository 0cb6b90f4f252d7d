/*
 * Laws of the motion of a shell with mass at large rotation: the oracle's trajectories, energy,
 * momentum, damping, and equilibria.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/design_build.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/shell_motion.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/model.h"
#include "../rigs/scene_assert.h"
#include "../rigs/testdata.h"
#include "../rigs/uniform.h"

#define MOTION "tests/rigs/scenes/motion.yaml"
#define FREE "supports=[];"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

/* Number of steps of the test of the energy, and elements of its plate along both directions. */
#ifdef LONG_MOTION
enum { ENERGY_STEPS = 10000 };
#define ENERGY_MESH "mesh.theta1.elements=6;mesh.theta2.elements=4;"
#else
enum { ENERGY_STEPS = 1000 };
#define ENERGY_MESH "mesh.theta1.elements=4;mesh.theta2.elements=1;"
#endif

static const double pi = 3.14159265358979323846;

/* A structure, supported or free, its equilibrium solver, its modes and its motion. */
typedef struct rig {
    scene scene;
    design design;
    pzs_model model;
    equilibrium equilibrium;
    vibration vibration;
    shell_motion motion;
    double *value; /* [inputs] input values of the structure */
    void *work;
} rig;

/*
 * Open the motion of a scene in time steps of `step` (s).
 *   modes in  number of damped modes; 0: no damping
 */
static void open_rig(rig *r, const char *name, const char *changes, int modes, double step)
{
    char error[SCENE_ERROR] = "";
    memset(r, 0, sizeof *r);
    if (scene_run_read(&r->scene, name, changes, error) < 0 ||
        design_build(&r->design, &r->scene, error) < 0)
        fail_msg("%s", error);
    const pzs_structure *s = &r->design.structure;
    const size_t bytes =
        PZS_MODEL_BYTES(s->free_dof, pzs_linalg_reals(s->first_column, s->free_dof));
    r->work = malloc(bytes);
    r->value = calloc(s->input.count, sizeof *r->value);
    assert_true(r->work && r->value);
    assert_int_equal(pzs_model_init(&r->model, s, r->work, bytes), PZS_OK);
    assert_int_equal(equilibrium_open(&r->equilibrium, &r->design, &r->model), PZS_OK);
    if (modes > 0 && vibration_solve(&r->vibration, &r->design, modes, MASS_LUMPED, error) < 0)
        fail_msg("%s", error);
    if (shell_motion_open(&r->motion, &r->equilibrium, NULL, step, error) < 0)
        fail_msg("%s", error);
}

/* Open the motion again with the damping of the scene. */
static void damp(rig *r)
{
    char error[SCENE_ERROR] = "";
    const double step = r->motion.step_most;
    shell_motion_close(&r->motion);
    if (shell_motion_open(&r->motion, &r->equilibrium, &r->vibration, step, error) < 0)
        fail_msg("%s", error);
}

static void close_rig(rig *r)
{
    shell_motion_close(&r->motion);
    vibration_free(&r->vibration);
    equilibrium_close(&r->equilibrium);
    design_free(&r->design);
    scene_free(&r->scene);
    free(r->value);
    free(r->work);
}

static size_t dof_of(const rig *r)
{
    return r->design.structure.free_dof;
}

static void advance(rig *r, double seconds)
{
    assert_true(shell_motion_advance(&r->motion, r->value, seconds));
}

static double energy_of(rig *r)
{
    return shell_motion_kinetic(&r->motion) + shell_motion_strain_energy(&r->motion) +
           shell_motion_potential(&r->motion, r->value);
}

/* ---- the oracle --------------------------------------------------------- */

/* Largest difference of any displacement from row `k` of the oracle's array u. */
static double distance(const rig *r, const testdata_array *u, int k)
{
    const pzs_structure *s = &r->design.structure;
    double most = 0;
    assert_int_equal(u->columns, s->nodes * s->dof_per_node);
    for (int i = 0; i < u->columns; i++) {
        const uint16_t dof = s->node_dof[i];
        const double found = dof == PZS_CONSTRAINED ? 0 : r->motion.displacement[dof];
        most = fmax(most, fabs(found - u->value[(size_t)k * (size_t)u->columns + (size_t)i]));
    }
    return most;
}

static void open_case(rig *r, const testdata *t, double step)
{
    char changes[512];
    const bool is_ring = strcmp(testdata_word(t, "surface"), "ring") == 0,
               is_improved = strcmp(testdata_word(t, "element"), "improved") == 0;
    const double *mesh = testdata_values(t, "mesh");
    snprintf(changes, sizeof changes,
             "element=%s;dof_per_node=%d;mesh.theta1.to=%.17g;mesh.theta1.elements=%d;"
             "mesh.theta2.elements=%d;loads.0.u3=%s;%s",
             testdata_word(t, "element"), is_improved ? 6 : 7, is_ring ? 1.0 : 2.0, (int)mesh[0],
             (int)mesh[1], testdata_word(t, "force"),
             is_ring ? "surface={type: cylinder, radius: 2, axial: theta2};" : "");
    open_rig(r, MOTION, changes, 0, step);
    r->value[0] = 30;
    r->value[1] = 1;
}

/* Largest distance from the oracle's trajectory at all its times, with steps of `step`. */
static double error_of_case(const testdata *t, double step, double *energy)
{
    const testdata_array *time = testdata_find(t, "time"), *u = testdata_find(t, "u");
    rig r;
    double most = 0;
    open_case(&r, t, step);
    *energy = 0;
    for (int k = 0; k < time->columns; k++) {
        advance(&r, time->value[k] - (k > 0 ? time->value[k - 1] : 0));
        most = fmax(most, distance(&r, u, k));
        *energy = fmax(*energy, fabs(energy_of(&r)) / shell_motion_kinetic(&r.motion));
    }
    close_rig(&r);
    return most;
}

/*
 * Law: the trajectories are those of an explicit method of order 8 on the numpy elements, with an
 * error of second order in the step: halving the step divides the error by 4, but for the next term
 * of the error, which is of fourth order.
 */
static void test_oracle(void **state)
{
    FILE *file = fopen(SOURCE_FOLDER "/tests/oracle/data/motion.txt", "r");
    testdata t;
    int cases = 0;
    (void)state;
    assert_non_null(file);
    for (; testdata_next(file, &t); cases++, testdata_free(&t)) {
        double energy;
        const double step = *testdata_values(&t, "step");
        const double coarse = error_of_case(&t, step, &energy),
                     fine = error_of_case(&t, step / 2, &energy);
        print_message("    %-16s error %.3e with steps of %g ms, ratio %.3f, energy %.1e\n", t.name,
                      fine, 500 * step, coarse / fine, energy);
        assert_true(fabs(coarse / fine - 4) < 0.2);
        assert_true(fine < 1e-3);
    }
    fclose(file);
    assert_int_equal(cases, 3);
}

/* ---- energy and momentum ------------------------------------------------ */

#define THIN "layers.0.thickness=0.005;layers.1.thickness=0.005;"

/* Set the velocity to that of a mode with the given largest displacement of a node. */
static void push_mode(rig *r, int mode, double amplitude)
{
    const double *shape = r->vibration.shape + (size_t)mode * dof_of(r);
    const double factor = sqrt(r->vibration.square[mode]) * amplitude / r->vibration.largest[mode];
    for (size_t i = 0; i < dof_of(r); i++)
        r->motion.velocity[i] += factor * shape[i];
}

/*
 * Law: without damping and loads the energy is kept to 1e-6 at an amplitude of 20 thicknesses, with
 * 50 steps a period of the first mode, 3 factorisations and 4.5 linear solves a step.
 */
static void test_energy(void **state)
{
    rig r;
    double most = 0;
    (void)state;
    open_rig(&r, MOTION, THIN ENERGY_MESH, 4, 1);
    const double step = 2 * pi / sqrt(r.vibration.square[0]) / 50;
    r.motion.step_most = step;
    push_mode(&r, 0, 20 * 0.01);
    push_mode(&r, 1, 4 * 0.01);
    const double first = energy_of(&r);
    double reached = 0;
    for (int k = 0; k < ENERGY_STEPS; k++) {
        advance(&r, step);
        if (k % 10 == 0)
            most = fmax(most, fabs(energy_of(&r) / first - 1));
        for (size_t i = 0; i < dof_of(&r); i++)
            reached = fmax(reached, fabs(r.motion.displacement[i]));
    }
    most = fmax(most, fabs(energy_of(&r) / first - 1));
    const double solves = (double)r.motion.linear_solves / (double)r.motion.steps;
    print_message("    energy to %.1e after %ld steps, %.2f linear solves a step, %d at most, %.2f "
                  "factorisations, %.2f corrections, largest unknown %.3g\n",
                  most, r.motion.steps, solves, r.motion.solves_most,
                  (double)r.motion.factorisations / (double)r.motion.steps,
                  (double)r.motion.corrections / (double)r.motion.steps, reached);
    assert_int_equal(r.motion.steps, ENERGY_STEPS);
    assert_true(most < 1e-6);
    assert_true(r.motion.factorisations <= 3 * r.motion.steps && solves <= 4.5);
    assert_true(reached > 0.15);
    close_rig(&r);
}

/*
 * Displacement or velocity vector of a point of the middle surface at a node, in global axes, with
 * that of its director.
 */
static void global(const rig *r, int node, const double *vector, double of_place[3],
                   double of_director[3])
{
    const pzs_structure *s = &r->design.structure;
    const surface_point *point = &r->design.mesh.point[node];
    memset(of_place, 0, 3 * sizeof *of_place);
    memset(of_director, 0, 3 * sizeof *of_director);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++) {
            of_place[i] += point->triad[a][i] * vector[s->node_dof[node * s->dof_per_node + a]];
            of_director[i] +=
                point->triad[a][i] * vector[s->node_dof[node * s->dof_per_node + 3 + a]];
        }
}

/*
 * Momentum of a free structure: linear momentum along the three axes, then angular momentum about
 * the origin. The product of the mass matrix and the velocity is the momentum of each unknown.
 */
static void momentum_of(rig *r, double momentum[6])
{
    double *product = calloc(dof_of(r), sizeof *product);
    assert_non_null(product);
    memset(momentum, 0, 6 * sizeof *momentum);
    mass_multiply(&r->motion.mass, &r->model, r->motion.velocity, 1, product);
    for (int node = 0; node < r->design.structure.nodes; node++) {
        const surface_point *point = &r->design.mesh.point[node];
        double place[3], director[3], force[3], moment[3];
        global(r, node, r->motion.displacement, place, director);
        global(r, node, product, force, moment);
        for (int i = 0; i < 3; i++) {
            place[i] += point->position[i];
            director[i] += point->triad[2][i];
            momentum[i] += force[i];
        }
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            momentum[3 + i] += place[j] * force[k] - place[k] * force[j] + director[j] * moment[k] -
                               director[k] * moment[j];
        }
    }
    free(product);
}

/*
 * Law: a free structure keeps its linear and angular momentum and its energy while it tumbles and
 * bends, on a plate and on a curved panel. Viscosity keeps the linear momentum and takes energy.
 * The tolerance of the iteration is 1e-6 of the change in a step, which the energy feels; the
 * momentum does not, because internal forces of any stress resultants have no resultant.
 */
static void test_momentum(void **state)
{
    static const char *const of[] = {
        "", "dynamics={damping: {rayleigh: [0, 1e-3]}};",
        "surface={type: cylinder, radius: 2, axial: theta2};mesh.theta1.to=1;"};
    (void)state;
    for (int c = 0; c < 3; c++) {
        rig r;
        double before[6], after[6], size[2] = {0, 0};
        uint32_t seed = 3;
        open_rig(&r, MOTION, with(FREE "loads=[];mesh.theta1.elements=3;", of[c]), 9, 0.002);
        damp(&r);
        r.motion.modes = 0;
        r.motion.viscosity = c == 1 ? r.motion.viscosity : 0;
        for (int mode = 6; mode < 9; mode++)
            push_mode(&r, mode, 0.3);
        for (int mode = 0; mode < 6; mode++)
            for (size_t i = 0; i < dof_of(&r); i++)
                r.motion.velocity[i] +=
                    0.5 * uniform(&seed, -1, 1) * r.vibration.shape[(size_t)mode * dof_of(&r) + i];
        momentum_of(&r, before);
        const double first = energy_of(&r);
        for (int k = 0; k < 400; k++)
            advance(&r, 0.002);
        momentum_of(&r, after);
        double worst[2] = {0, 0};
        for (int i = 0; i < 6; i++) {
            size[i / 3] = hypot(size[i / 3], before[i]);
            worst[i / 3] = fmax(worst[i / 3], fabs(after[i] - before[i]));
        }
        print_message("    momentum to %.1e, angular to %.1e, energy %.1e, %.2f solves a step\n",
                      worst[0] / size[0], worst[1] / size[1], energy_of(&r) / first - 1,
                      (double)r.motion.linear_solves / (double)r.motion.steps);
        assert_true(worst[0] < 1e-12 * size[0]);
        assert_true(c == 1 || worst[1] < 1e-7 * size[1]);
        assert_true(energy_of(&r) < (c == 1 ? 0.999 : 1 + 1e-6) * first);
        assert_true(c == 1 || energy_of(&r) > (1 - 1e-6) * first);
        close_rig(&r);
    }
}

/* ---- small amplitudes --------------------------------------------------- */

/*
 * Law: at small amplitudes a mode of `pzs modes` turns by 2 atan(w h/2) in a step of length h, and
 * decays by its damping ratio. With the damping force c v at half the step, displacement q and
 * velocity v of the mode after a step are those of the scalar formula, to the square of the
 * amplitude.
 */
static void test_small_amplitude(void **state)
{
    static const char *const of[] = {"dynamics={damping: 0.02};",
                                     "dynamics={damping: [0.05, 0.01]};",
                                     "dynamics={damping: {rayleigh: [2, 1e-4]}};"};
    (void)state;
    for (int c = 0; c < 3; c++)
        for (int mode = 0; mode < 3; mode++) {
            const double step = 0.003;
            rig r;
            open_rig(&r, MOTION, of[c], 6, step);
            damp(&r);
            const double w = sqrt(r.vibration.square[mode]),
                         damping = 2 * modal_damping(&r.design.dynamics, mode, w) * w;
            const double b = r.motion.viscosity, time = (step + b) / 2;
            double q = 0, v = 1e-7;
            push_mode(&r, mode, v / w * r.vibration.largest[mode]);
            for (int k = 0; k < 100; k++) {
                /* (v1 - v)/h + w w ((q + q1)/2 + b (q1 - q)/(2 h)) + rest (q1 - q)/h = 0 with
                 * q1 - q = h v + time (v1 - v). */
                const double rest = damping - b * w * w;
                const double change =
                    (v / time - w * w * q) /
                    (1 / (step * time) + w * w * (1 + b / step) / 2 + rest / step);
                advance(&r, step);
                q += change;
                v += (change - step * v) / time;
            }
            double found = 0, *product = calloc(dof_of(&r), sizeof *product);
            mass_multiply(&r.motion.mass, &r.model, r.motion.displacement, 1, product);
            for (size_t i = 0; i < dof_of(&r); i++)
                found += product[i] * r.vibration.shape[(size_t)mode * dof_of(&r) + i];
            free(product);
            assert_true(fabs(found - q) < 1e-6 * 1e-7 / w);
            close_rig(&r);
        }
}

/* ---- damping ------------------------------------------------------------ */

/* Law: without loads the energy never rises, for any damping and any step. */
static void test_dissipation(void **state)
{
    static const char *const of[] = {"dynamics={damping: 0.3};",
                                     "dynamics={damping: [0.2, 0.001]};",
                                     "dynamics={damping: {rayleigh: [5, 0.01]}};"};
    uint32_t seed = 5;
    (void)state;
    for (int c = 0; c < 12; c++) {
        const double step = pow(10, -5 + 0.5 * c);
        rig r;
        open_rig(&r, MOTION, of[c % 3], 4, step);
        damp(&r);
        for (size_t i = 0; i < dof_of(&r); i++)
            r.motion.velocity[i] = 2 * uniform(&seed, -1, 1);
        double before = energy_of(&r);
        const double first = before;
        for (int k = 0; k < 20; k++) {
            if (!shell_motion_advance(&r.motion, r.value, step))
                fail_msg("no convergence in step %d of %g s", k, step);
            const double energy = energy_of(&r);
            if (!(energy <= before + 1e-7 * first))
                fail_msg("steps of %g s: energy %.15g after %.15g", step, energy, before);
            before = energy;
        }
        close_rig(&r);
    }
}

/* ---- equilibria --------------------------------------------------------- */

/*
 * Law: an equilibrium of the solver, under loads, follower loads, voltages and springs, is an
 * equilibrium of the motion, and the deviation from it is zero. After a push the strongly damped
 * structure returns there.
 */
static void test_equilibrium(void **state)
{
    static const char *const of[] = {
        "loads.0.u3=5;", "loads=[{face: outer, pressure: 4, follower: pressure}];",
        "loads=[{face: outer, pressure: 4, follower: normal}];",
        "loads.0.u3=5;springs=[{at: nodes, along: z, stiffness: 3, per: area}];"};
    (void)state;
    for (int c = 0; c < 4; c++) {
        rig r;
        open_rig(&r, MOTION, with("dynamics={damping: {rayleigh: [10, 0.05]}};", of[c]), 3, 0.05);
        damp(&r);
        const size_t dof = dof_of(&r);
        memcpy(r.value, r.equilibrium.full_input, r.design.structure.input.count * sizeof *r.value);
        r.value[0] = 40;
        pzs_solver *solver = &r.equilibrium.solver;
        const pzs_status status = pzs_equilibrium(solver, r.value);
        if (status != PZS_OK)
            fail_msg("%s: %s", of[c], pzs_status_text(status));
        double *still = malloc(dof * sizeof *still), size = 0, moved = 0, left = 0, away = 0;
        memcpy(still, solver->info.displacement, dof * sizeof *still);
        shell_motion_rest(&r.motion, still, r.value);
        advance(&r, 0.5);
        for (size_t i = 0; i < dof; i++) {
            size = fmax(size, fabs(still[i]));
            moved = fmax(moved, fabs(r.motion.displacement[i] - still[i]));
        }
        const double *deviation = shell_motion_deviation(&r.motion, r.value);
        for (size_t i = 0; i < dof; i++)
            away = fmax(away, fabs(deviation[i]));
        push_mode(&r, 0, 0.3);
        advance(&r, 0.1);
        double most = 0;
        for (size_t i = 0; i < dof; i++)
            most = fmax(most, fabs(r.motion.displacement[i] - still[i]));
        advance(&r, 12);
        for (size_t i = 0; i < dof; i++)
            left = fmax(left, fabs(r.motion.displacement[i] - still[i]));
        print_message("    largest unknown %.3g, moved %.1e, deviation %.1e; pushed by %.2g, then "
                      "%.1e\n",
                      size, moved, away, most, left);
        assert_true(size > 0.3 && most > 0.01);
        assert_true(moved < 1e-8 * size && away < 1e-8 * size);
        assert_true(left < 1e-7 * size);
        free(still);
        close_rig(&r);
    }
}

/* Law: the impulse of a load changes the momentum of a free structure by force times time. */
static void test_kick(void **state)
{
    rig r;
    double momentum[6];
    (void)state;
    open_rig(&r, MOTION, FREE, 0, 0.01);
    shell_motion_kick(&r.motion, 1, 0.25);
    momentum_of(&r, momentum);
    const double expected[6] = {0, 0, 0.25, 0.5 * 0.25, -2 * 0.25, 0};
    for (int i = 0; i < 6; i++)
        assert_true(fabs(momentum[i] - expected[i]) < 1e-12);
    close_rig(&r);
}

/* Law: the step is a whole part of the tick, and half a radian of the fastest followed mode. */
static void test_step(void **state)
{
    double square[4] = {0, 1, 400, 1e6};
    const vibration of = {.count = 4, .rigid = 1, .square = square};
    (void)state;
    assert_near("one followed", shell_motion_step(&of, 1), 0.5, 1e-15);
    assert_near("two followed", shell_motion_step(&of, 0.1), 0.025, 1e-15);
    assert_near("slow", shell_motion_step(&of, 1e-4), 1e-4, 1e-15);
    assert_near("none followed", shell_motion_step(&of, 5), 0.5, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracle),      cmocka_unit_test(test_energy),
        cmocka_unit_test(test_momentum),    cmocka_unit_test(test_small_amplitude),
        cmocka_unit_test(test_dissipation), cmocka_unit_test(test_equilibrium),
        cmocka_unit_test(test_kick),        cmocka_unit_test(test_step),
    };
    /* Under the sanitizers the first two, with thousands of steps, would take too long. */
    const size_t from = SANITIZED ? 2 : 0;
    return _cmocka_run_group_tests("shell_motion", tests + from,
                                   sizeof tests / sizeof *tests - from, NULL, NULL);
}
