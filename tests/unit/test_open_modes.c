/*
 * Laws of vibration with open electrodes: frequencies and coupling factors of a bar and of a bender
 * against exact solutions, rigid motions, static responses of the modes against the influence
 * matrix, and electrodes without capacitance.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/loaded.h"
#include "../../host_tools/model/modal.h"
#include "../rigs/scene_run.h"

#define BAR "tests/rigs/scenes/coupled-bar.yaml"
#define BIMORPH "tests/rigs/scenes/coupled-bimorph.yaml"

static const double pi = 3.14159265358979323846;
/* Constants of the ceramic in both scenes, in SI units. */
static const double modulus = 60e9, stress_per_field = 12, permittivity = 8e-9, density = 7600;

enum { MODES = 3, ELEMENTS = 16 };

/* Frequencies of a scene with open and with short-circuited electrodes, and coupling factors. */
typedef struct frequencies {
    double open[MODES], shorted[MODES], squared[MODES];
} frequencies;

/* Compute the modes of a scene with changes. */
static void find_modes(loaded_modes *modes, scene *scene, const char *name, const char *changes,
                       modes_request request)
{
    char error[SCENE_ERROR];
    if (scene_run_read(scene, name, changes, error) < 0 ||
        loaded_modes_open(modes, scene, &request, error) < 0)
        fail_msg("%s", error);
}

static void close_modes(loaded_modes *modes, scene *scene)
{
    loaded_modes_close(modes);
    scene_free(scene);
}

/* Frequencies of the first modes on a mesh with a number of elements along theta1. */
static frequencies on_mesh(const char *name, int elements)
{
    frequencies found;
    char changes[80];
    scene scene;
    loaded_modes modes;
    snprintf(changes, sizeof changes, "mesh.theta1.elements=%d", elements);
    find_modes(&modes, &scene, name, changes, (modes_request){MODES, CIRCUIT_SCENE});
    assert_int_equal(modes.coupling.count, MODES);
    assert_int_equal(modes.vibration.open, 1);
    memcpy(found.open, modes.vibration.frequency, sizeof found.open);
    memcpy(found.shorted, modes.coupling.short_frequency, sizeof found.shorted);
    memcpy(found.squared, modes.coupling.squared, sizeof found.squared);
    close_modes(&modes, &scene);
    return found;
}

/* Root of a function between two arguments at which its signs differ. */
static double root(double (*function)(double x), double from, double to)
{
    for (int i = 0; i < 200; i++) {
        const double middle = (from + to) / 2;
        if (function(from) * function(middle) > 0)
            from = middle;
        else
            to = middle;
    }
    return from;
}

/*
 * Check frequencies on two meshes against an exact one. The error is of second order in the angle
 * by which the mode turns in an element, and Richardson's extrapolation of both meshes leaves an
 * error of fourth order.
 *   turn    in  angle by which the mode turns over the whole length (rad)
 *   neglect in  relative size of what the exact solution leaves out
 */
static void check_frequency(const char *what, double exact, double coarse, double fine, double turn,
                            double neglect)
{
    const double angle = turn / ELEMENTS, limit = (4 * fine - coarse) / 3;
    print_message("    %s: %.4f, %.4f Hz; error %.1e, %.1e, extrapolated %.1e\n", what, exact, fine,
                  coarse / exact - 1, fine / exact - 1, limit / exact - 1);
    assert_true(fabs(coarse / exact - 1) < angle * angle / 4 + neglect);
    assert_true(fabs(fine / exact - 1) < angle * angle / 16 + neglect);
    assert_true(fabs(limit / exact - 1) < pow(angle, 4) + neglect);
}

/* Check the coupling factors on two meshes against those of exact frequencies. */
static void check_coupling(double open, double shorted, double coarse, double fine, double turn)
{
    const double exact = 1 - pow(shorted / open, 2), angle = turn / ELEMENTS;
    print_message("    coupling factor squared %.6f, error %.1e, %.1e\n", exact, coarse - exact,
                  fine - exact);
    assert_true(fabs(fine - exact) < angle * angle / 16 &&
                fabs(coarse - exact) < angle * angle / 4);
    assert_true(fabs((4 * fine - coarse) / 3 - exact) < pow(angle, 4));
}

/* ---- bar ---------------------------------------------------------------- */

/* Squared electric over elastic stiffness of the ceramic, k31^2/(1 - k31^2). */
static double coupling_ratio(void)
{
    return stress_per_field * stress_per_field / (modulus * permittivity);
}

/*
 * Characteristic function of a bar that is fixed at one end: x is its length over the length of a
 * wave turning by one radian. No charge on the whole electrode leaves the stress at the free end as
 * E u' = -(e31^2/permittivity) u/length, so that tan(x)/x = -(1 - k31^2)/k31^2.
 */
static double open_bar(double x)
{
    return x * cos(x) + coupling_ratio() * sin(x);
}

/* Law: frequencies and coupling factors of the bar, open and short-circuited, are the exact ones.
 */
static void test_bar(void **state)
{
    const frequencies coarse = on_mesh(BAR, ELEMENTS), fine = on_mesh(BAR, 2 * ELEMENTS);
    const double unit = sqrt(modulus / density) / 0.05 / (2 * pi);
    (void)state;
    for (int i = 0; i < MODES; i++) {
        const double shorted = (i + 0.5) * pi, open = root(open_bar, shorted, (i + 1) * pi);
        check_frequency("short", unit * shorted, coarse.shorted[i], fine.shorted[i], shorted, 0);
        check_frequency("open", unit * open, coarse.open[i], fine.open[i], open, 0);
        check_coupling(open, shorted, coarse.squared[i], fine.squared[i], open);
    }
}

/* ---- bender ------------------------------------------------------------- */

/* Characteristic function of a short-circuited cantilever, whose roots are those of its modes. */
static double short_bender(double x)
{
    return 1 + cosh(x) * cos(x);
}

/*
 * Characteristic function of a cantilever bender with one open electrode. Its voltage turns with
 * the slope of the tip, so that the moment at the tip is -r E I/length times the slope, with
 * r = b^2/(C E I) for the moment b = e31 t/2 per volt and the capacitance C = permittivity/(2 t)
 * per area, t being the thickness of a layer: r = 3/4 coupling_ratio.
 */
static double open_bender(double x)
{
    const double r = 0.75 * coupling_ratio();
    return x * short_bender(x) + r * (cosh(x) * sin(x) + sinh(x) * cos(x));
}

/*
 * Law: frequencies and coupling factors of a thin bimorph are those of the theory of beams, which
 * leaves out the shear: relative size (turn h/length)^2 for the thickness h, 1e-6 turn^2.
 */
static void test_bender(void **state)
{
    const frequencies coarse = on_mesh(BIMORPH, ELEMENTS), fine = on_mesh(BIMORPH, 2 * ELEMENTS);
    const double thickness = 1e-4, length = 0.1;
    const double unit =
        sqrt(modulus * thickness * thickness / (12 * density)) / (length * length) / (2 * pi);
    (void)state;
    for (int i = 0; i < MODES; i++) {
        const double shorted = root(short_bender, i * pi + 0.1, (i + 1) * pi),
                     open = root(open_bender, shorted, shorted + 0.25 * pi),
                     neglect = pow(open * thickness / length, 2);
        check_frequency("short", unit * shorted * shorted, coarse.shorted[i], fine.shorted[i],
                        shorted, neglect);
        check_frequency("open", unit * open * open, coarse.open[i], fine.open[i], open, neglect);
        check_coupling(open * open, shorted * shorted, coarse.squared[i], fine.squared[i], open);
    }
}

/* ---- circuits ------------------------------------------------------------ */

#define DRIVEN                                                                                     \
    "sensors=[];actuators=[{name: v, drives: [{patches: up, factor: 0.5}, {patches: low, factor: " \
    "0.5}]}];limits={voltage: [-1, 1]};target={u3: middle, at: nodes, value: x};"

/*
 * Law: the electrodes of an open amplifier vibrate like those of an open sensor, those of a driven
 * amplifier like those of a short-circuited sensor, and a short circuit asked for is that of the
 * scene: the same matrices, so that the frequencies agree to what the method knows them.
 */
static void test_circuits(void **state)
{
    static const struct {
        const char *changes;
        electrode_circuit circuit;
        bool is_open;
    } of[] = {{"", CIRCUIT_SCENE, true},
              {"", CIRCUIT_OPEN, true},
              {"sensors.0.circuit=short", CIRCUIT_OPEN, true},
              {DRIVEN, CIRCUIT_OPEN, true},
              {"", CIRCUIT_SHORT, false},
              {"sensors.0.circuit=short", CIRCUIT_SCENE, false},
              {DRIVEN, CIRCUIT_SCENE, false},
              {DRIVEN, CIRCUIT_SHORT, false}};
    const frequencies reference = on_mesh(BIMORPH, ELEMENTS);
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        scene scene;
        loaded_modes modes;
        find_modes(&modes, &scene, BIMORPH, of[k].changes, (modes_request){MODES, of[k].circuit});
        assert_int_equal(modes.vibration.open, of[k].is_open);
        assert_int_equal(modes.coupling.count, of[k].is_open ? MODES : 0);
        for (int i = 0; i < MODES; i++) {
            const double expected = of[k].is_open ? reference.open[i] : reference.shorted[i];
            assert_true(fabs(modes.vibration.frequency[i] / expected - 1) < 1e-9);
        }
        close_modes(&modes, &scene);
    }
}

/*
 * Law: with five electrodes the coupling of the second mode, whose curvature changes its sign, is
 * larger than with one, and without a fixed edge the rigid motions keep the frequency 0 and have no
 * coupling factor.
 */
static void test_free_bimorph(void **state)
{
    scene scene;
    loaded_modes modes;
    double squared[2];
    (void)state;
    for (int k = 0; k < 2; k++) {
        const char *const changes =
            k ? "supports=[];patches.0.grid=[4, 1];patches.1.grid=[4, 1]" : "supports=[]";
        find_modes(&modes, &scene, BIMORPH, changes, (modes_request){8, CIRCUIT_OPEN});
        assert_int_equal(modes.vibration.rigid, 6);
        for (int i = 0; i < modes.vibration.count; i++) {
            const bool is_rigid = i < 6;
            assert_true(is_rigid == isnan(modes.coupling.squared[i]));
            assert_true(is_rigid == (modes.vibration.frequency[i] == 0));
        }
        squared[k] = modes.coupling.squared[7];
        close_modes(&modes, &scene);
    }
    print_message("    second mode of the free bimorph: %.5f, %.5f\n", squared[0], squared[1]);
    assert_true(fabs(squared[0]) < 1e-6 && squared[1] > 0.1);
}

/* Law: an open electrode on a material without permittivity is refused by its name. */
static void test_no_capacitance(void **state)
{
    scene scene;
    loaded_modes modes;
    char error[SCENE_ERROR];
    (void)state;
    assert_int_equal(
        scene_run_read(&scene, BIMORPH, DRIVEN "materials.ceramic.permittivity=0", error), 0);
    assert_int_equal(
        loaded_modes_open(&modes, &scene, &(modes_request){MODES, CIRCUIT_OPEN}, error), -1);
    assert_non_null(strstr(error, "open electrode v has no capacitance"));
    close_modes(&modes, &scene);
}

/* ---- static responses ---------------------------------------------------- */

#define MIXED                                                                                      \
    "mesh.theta1.elements=6;patches=[{name: low, layer: lower, grid: [3, 1]}, {name: up, layer: "  \
    "upper, grid: [3, 1]}];sensors=[{name: s, drives: [{patches: up}], circuit: open}];"           \
    "actuators=[{name: v, drives: [{patches: low}]}];limits={voltage: [-1, 1]};"                   \
    "target={u3: middle, at: nodes, value: x};"

/*
 * Law: the static responses of all modes, summed over the mode shapes, are the influence matrix,
 * also per unit of charge on the open electrodes, to rounding of the eigenvectors.
 *   changes in  changes of the scene of the bimorph
 */
static void check_sum(const char *changes)
{
    scene_run run;
    vibration vibration;
    modal modal;
    if (scene_run_open(&run, BIMORPH, changes) < 0 ||
        analysis_influence(&run.analysis, run.error) < 0)
        fail_msg("%s", run.error);
    const design *design = &run.analysis.design;
    const size_t inputs = design->structure.input.count;
    assert_int_equal(
        analysis_vibration(&run.analysis, &vibration, design->mesh.free_dof, run.error), 0);
    assert_true(modal_open(&modal, design, &vibration, inputs));
    for (size_t k = 0; k < inputs; k++) {
        double most = 0, largest = 0;
        for (size_t i = 0; i < (size_t)design->targets; i++) {
            double sum = 0;
            for (size_t mode = 0; mode < modal.modes; mode++)
                sum +=
                    modal.shape[i * modal.modes + mode] * modal.response[mode * modal.inputs + k];
            most = fmax(most, fabs(sum - run.analysis.influence[i * inputs + k]));
            largest = fmax(largest, fabs(run.analysis.influence[i * inputs + k]));
        }
        print_message("    input %zu: sum of modes to %.1e of %.2e\n", k, most / largest, largest);
        assert_true(most <= 1e-9 * largest);
    }
    modal_close(&modal);
    vibration_free(&vibration);
    scene_run_close(&run);
}

static void test_responses(void **state)
{
    (void)state;
    check_sum(MIXED);
    check_sum(MIXED "kinematics=nonlinear;simulate={ticks: 1, influence: loaded};"
                    "loads=[{line: theta1+, u3: 0.1}]");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bar),
        cmocka_unit_test(test_bender),
        cmocka_unit_test(test_circuits),
        cmocka_unit_test(test_free_bimorph),
        cmocka_unit_test(test_no_capacitance),
        cmocka_unit_test(test_responses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
