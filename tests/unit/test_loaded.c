/*
 * Laws of vibration about a loaded equilibrium: tension raises the frequencies of a strip, and
 * compression lowers them to zero at its buckling load, as the closed forms say; the tables of a
 * control loop and its certificate are those of the loaded structure where the scene asks for it.
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
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/loaded.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/simulation.h"
#include "../rigs/scene_run.h"

#define STRIP "tests/rigs/scenes/stretched-strip.yaml"
/* Hinges that hold the three mean displacements and leave rotation and thickness free. */
#define HINGED                                                                                     \
    "supports=[{edge: theta1-, fix: cone}, "                                                       \
    "{edge: theta1+, fix: cone}];"
#define PULLED                                                                                     \
    "supports=[{edge: theta1-, fix: cone}, "                                                       \
    "{edge: theta1+, fix: [u2 mean, u3 mean]}, {edge: theta1+, fix: u1 mean, value: 2.4e-4}];"     \
    "loads=[];"

#define COARSE "mesh.theta1.elements=8;simulate.plant.motion=modal;simulate.plant.modes=12;"
#define HELD(side) "{edge: " side ", fix: cone}"

static const double pi = 3.14159265358979323846, length = 0.4, thickness = 1e-3, modulus = 63e9,
                    density = 7600, expansion = 1e-5;

/* Compute the modes of the strip with changes of its scene. */
static void find_modes(loaded_modes *modes, scene *scene, const char *changes, int number)
{
    char error[SCENE_ERROR];
    if (scene_run_read(scene, STRIP, changes, error) < 0 ||
        loaded_modes_open(modes, scene, &(modes_request){number, CIRCUIT_SCENE}, error) < 0)
        fail_msg("%s", error);
}

static void close_modes(loaded_modes *modes, scene *scene)
{
    loaded_modes_close(modes);
    scene_free(scene);
}

/*
 * Squared angular frequency of bending mode n of a hinged strip under an axial strain, from the
 * closed form (n pi/L)^2 (N + D (n pi/L)^2)/(density h) with the force N and the bending stiffness
 * D per width; rotary inertia adds (n pi h/L)^2/12 to 1, 5e-6 for n = 1.
 */
static double strip_square(int n, double strain)
{
    const double wave = n * pi / length;
    const double force = modulus * thickness * strain, bending = modulus * pow(thickness, 3) / 12;
    return wave * wave * (force + bending * wave * wave) / (density * thickness);
}

/*
 * Law: prescribed displacements of its ends stretch the hinged strip, and the frequencies of its
 * first three bending modes are those of the closed form. The error of 16 elements for mode n is of
 * second order in the angle n pi/16 by which the mode turns in an element: at most a twelfth of its
 * square, as for the consistent mass matrix of a string.
 */
static void test_stretched_strip(void **state)
{
    scene scene;
    loaded_modes modes;
    int found = 0;
    (void)state;
    find_modes(&modes, &scene, PULLED, 5);
    assert_true(modes.is_loaded);
    for (int i = 0; i < 5 && found < 3; i++) {
        const double exact = strip_square(found + 1, 2.4e-4 / length);
        const double ratio = modes.vibration.square[i] / exact;
        const double angle = (found + 1) * pi / 16;
        if (fabs(ratio - 1) > 0.3)
            continue;
        print_message("    mode %d: %.4f Hz, squared frequency over the closed form %.5f\n",
                      found + 1, modes.vibration.frequency[i], ratio);
        assert_true(fabs(ratio - 1) < angle * angle / 12);
        found++;
    }
    assert_int_equal(found, 3);
    assert_true(
        fabs(modes.first.unloaded * modes.first.unloaded * 4 * pi * pi / strip_square(1, 0) - 1) <
        0.01);
    close_modes(&modes, &scene);
}

/*
 * Where the squared first frequency of a heated structure falls to zero, in multiples of the
 * temperature at which it buckles by the closed form (1): the end of the line through the values at
 * 0.2, 0.55 and 0.9 of this temperature, which lie on a line to the order of the thermal strain.
 *   format   in  changes of the scene, with one conversion for the temperature (K)
 *   buckling in  temperature at which the structure buckles by the closed form (K)
 */
static double buckling_end(const char *format, double buckling)
{
    double square[3];
    for (int i = 0; i < 3; i++) {
        scene scene;
        loaded_modes modes;
        char changes[700];
        snprintf(changes, sizeof changes, format, buckling * (0.2 + 0.35 * i));
        find_modes(&modes, &scene, changes, 1);
        assert_true(modes.is_loaded);
        square[i] = modes.vibration.square[0];
        close_modes(&modes, &scene);
    }
    const double slope = (square[2] - square[0]) / 0.7, end = 0.2 - square[0] / slope;
    print_message("    buckles at %.5f of the closed form; off the line by %.1e\n", end,
                  (square[0] + square[2]) / 2 / square[1] - 1);
    assert_true(fabs((square[0] + square[2]) / 2 / square[1] - 1) < 1e-4);
    return end;
}

/*
 * Law: heat compresses the hinged strip, whose squared first frequency falls linearly with the
 * temperature and is zero at that of buckling, (pi h/L)^2/(12 expansion). The state before buckling
 * is a uniform compression, so that the frequencies at three temperatures lie on a line to the
 * order of the thermal strain, 6e-6, and its end is that of the closed form to the error of the
 * mesh: a quarter of the squared angle pi/16 by which the mode turns in an element, a twelfth for
 * each of the stiffness, the prestress and the mass.
 */
static void test_buckling_strip(void **state)
{
    const double buckling = pow(pi * thickness / length, 2) / (12 * expansion);
    (void)state;
    const double end = buckling_end(HINGED "loads=[{temperature: %.17g}]", buckling);
    assert_true(fabs(end - 1) < pow(pi / 16, 2) / 4);
}

/*
 * Law: a simply supported square plate that may not expand, with Poisson's ratio 0.3: its squared
 * frequency falls linearly with the temperature, to zero at that of buckling. The uniform
 * compression N = E h expansion T/(1 - 0.3) buckles it at N = 2 (pi/a)^2 D.
 */
static void test_buckling_plate(void **state)
{
    const double side = 0.4, buckling = pow(pi * thickness / side, 2) / (6 * 1.3 * expansion);
    static const char changes[] =
        "mesh.theta1.elements=8;mesh.theta2.elements=8;mesh.theta2.to=0.4;materials.ceramic.nu=0.3;"
        "supports=[" HELD("theta1-") ", " HELD("theta1+") ", " HELD("theta2-") ", " HELD(
            "theta2+") "];loads=[{temperature: %.17g}]";
    (void)state;
    assert_true(fabs(buckling_end(changes, buckling) - 1) < pow(pi / 8, 2) / 4);
}

/* ---- deformed shapes ----------------------------------------------------- */

enum { COMPARED = 5 };

/* Supports that hold an edge and its rotation; `value` is the rest of the last support. */
#define HELD_EDGE(value)                                                                           \
    "supports=[{edge: theta1-, fix: cone}, {edge: theta1-, fix: rotation, about: y" value "}]"

/* Compute the first frequencies of the strip without loads, with changes. */
static void strip_frequencies(const char *changes, double frequency[COMPARED])
{
    scene scene;
    loaded_modes modes;
    char all[700];
    snprintf(all, sizeof all, "loads=[];%s", changes);
    find_modes(&modes, &scene, all, COMPARED);
    memcpy(frequency, modes.vibration.frequency, COMPARED * sizeof *frequency);
    close_modes(&modes, &scene);
}

/* Largest relative difference of frequencies. */
static double largest_difference(const double *frequency, const double *reference)
{
    double most = 0;
    for (int i = 0; i < COMPARED; i++)
        most = fmax(most, fabs(frequency[i] / reference[i] - 1));
    return most;
}

/*
 * Law: a strip that a support has turned by 30 or 60 degrees vibrates as before, to rounding:
 * machine epsilon times the condition number of the stiffness matrix.
 */
static void test_turned_strip(void **state)
{
    static const char *const turn[] = {"", ", value: 30 deg", ", value: 60 deg"};
    double frequency[3][COMPARED];
    scene_run run;
    (void)state;
    assert_int_equal(
        scene_run_open(&run, STRIP,
                       "kinematics=linear;loads=[];simulate.influence=undeformed;" HELD_EDGE("")),
        0);
    const double rounding = 2.220446049250313e-16 * run.analysis.model.info.condition;
    scene_run_close(&run);
    for (int i = 0; i < 3; i++) {
        char changes[200];
        snprintf(changes, sizeof changes, HELD_EDGE("%s"), turn[i]);
        strip_frequencies(changes, frequency[i]);
        const double most = largest_difference(frequency[i], frequency[0]);
        print_message("    turned%s: %.10f Hz, largest difference %.1e, rounding %.1e\n", turn[i],
                      frequency[i][0], most, rounding);
        assert_true(most < rounding);
    }
}

/*
 * Law: a strip that voltages roll to an arc of one radian vibrates like a strip that is made as
 * this arc. The strains, at most thickness/(2 radius), change the frequencies by their own order,
 * and on n elements both differ by the second order of the angle 1/n of an element. The voltage V
 * on layers of thickness t causes the curvature 1.5 d31 V/t^2.
 */
static void test_rolled_strip(void **state)
{
    static const char arc[] = "kinematics=linear;simulate.influence=undeformed;surface={type: "
                              "cylinder, radius: 0.4, axial: theta2};mesh.theta1.to=1;"
                              "target.value=x;";
    const double layer = thickness / 2, curvature = 1 / length,
                 voltage = curvature * layer * layer / (1.5 * 190e-12);
    double rolled[COMPARED], made[COMPARED];
    (void)state;
    for (int elements = 16; elements <= 32; elements *= 2) {
        char changes[500];
        const double angle = 1.0 / elements;
        snprintf(changes, sizeof changes,
                 "mesh.theta1.elements=%d;supports=[{edge: theta1-, fix: clamped}];"
                 "materials.ceramic.d32=0;actuators.0.applied=%.17g",
                 elements, voltage);
        strip_frequencies(changes, rolled);
        snprintf(changes, sizeof changes,
                 "%smesh.theta1.elements=%d;supports=[{edge: theta1-, fix: clamped}]", arc,
                 elements);
        strip_frequencies(changes, made);
        print_message("    %d elements: rolled %.4f Hz, made as an arc %.4f Hz, largest difference "
                      "%.1e\n",
                      elements, rolled[0], made[0], largest_difference(rolled, made));
        assert_true(largest_difference(rolled, made) < angle * angle + layer * curvature);
    }
}

/*
 * Law: with linear kinematics the modes are those of the reference state, and the first frequency
 * under the loads is known beside them: the same as with nonlinear kinematics. Without loads there
 * is none, and beyond buckling it is zero.
 */
static void test_first_frequency(void **state)
{
    static const char *const changes[] = {"kinematics=linear;simulate.influence=undeformed", "",
                                          "loads=[]", HINGED "loads=[{temperature: 0.6}]"};
    loaded_frequency first[4];
    (void)state;
    for (int i = 0; i < 4; i++) {
        scene scene;
        char error[SCENE_ERROR];
        assert_int_equal(scene_run_read(&scene, STRIP, changes[i], error), 0);
        first[i] = loaded_first(&scene);
        if (i == 0) {
            loaded_modes modes;
            assert_int_equal(
                loaded_modes_open(&modes, &scene, &(modes_request){1, CIRCUIT_SCENE}, error), 0);
            assert_false(modes.is_loaded);
            assert_true(fabs(modes.vibration.frequency[0] / first[0].unloaded - 1) < 1e-9);
            loaded_modes_close(&modes);
        }
        scene_free(&scene);
    }
    print_message("    %.2f Hz, loaded %.2f Hz\n", first[0].unloaded, first[0].loaded);
    assert_true(first[0].loaded > 4 * first[0].unloaded);
    assert_true(fabs(first[1].loaded / first[0].loaded - 1) < 1e-7 && isnan(first[2].loaded));
    assert_true(first[3].unloaded > 0 && first[3].loaded == 0);
}

/*
 * Law: in tables about the loaded equilibrium the static responses of all modes, summed over the
 * mode shapes, are the influence matrix, to rounding of the eigenvectors; the tension makes its
 * entries less than a tenth of those of the unloaded strip.
 */
static void test_modes_sum_to_influence(void **state)
{
    scene_run loaded, unloaded;
    vibration vibration;
    modal modal;
    double most = 0, largest = 0, before = 0;
    (void)state;
    assert_int_equal(scene_run_open(&loaded, STRIP, "mesh.theta1.elements=8"), 0);
    assert_int_equal(
        scene_run_open(&unloaded, STRIP, "mesh.theta1.elements=8;simulate.influence=undeformed"),
        0);
    assert_int_equal(analysis_influence(&loaded.analysis, loaded.error), 0);
    assert_int_equal(analysis_influence(&unloaded.analysis, unloaded.error), 0);
    const design *design = &loaded.analysis.design;
    const size_t inputs = design->structure.input.count, amplifiers = (size_t)design->amplifiers;
    assert_int_equal(
        analysis_vibration(&loaded.analysis, &vibration, design->mesh.free_dof, loaded.error), 0);
    assert_true(modal_open(&modal, design, &vibration, amplifiers));
    for (size_t i = 0; i < (size_t)design->targets; i++)
        for (size_t k = 0; k < amplifiers; k++) {
            double sum = 0;
            for (size_t mode = 0; mode < modal.modes; mode++)
                sum +=
                    modal.shape[i * modal.modes + mode] * modal.response[mode * modal.inputs + k];
            most = fmax(most, fabs(sum - loaded.analysis.influence[i * inputs + k]));
            largest = fmax(largest, fabs(loaded.analysis.influence[i * inputs + k]));
            before = fmax(before, fabs(unloaded.analysis.influence[i * inputs + k]));
        }
    print_message("    sum of modes to %.1e; the largest entry is %.4f of the unloaded one\n",
                  most / largest, largest / before);
    assert_true(most < 1e-9 * largest);
    assert_true(largest < 0.1 * before);
    modal_close(&modal);
    vibration_free(&vibration);
    scene_run_close(&loaded);
    scene_run_close(&unloaded);
}

/*
 * Law: tables about the loaded equilibrium pass their certificate on the stretched strip, also
 * about the shape of the target; tables of the unloaded strip, whose modes are a fifth as fast, are
 * refused, and the refusal names the cure.
 */
static void test_loop(void **state)
{
    static const char *const changes[] = {COARSE, COARSE "simulate.influence=undeformed"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene_run run;
        char text[SCENE_ERROR];
        assert_int_equal(scene_run_open(&run, STRIP, changes[i]), 0);
        certificate *certificate = &run.analysis.certificate;
        assert_int_equal(analysis_influence(&run.analysis, run.error), 0);
        certificate_make(certificate, &run.analysis);
        certificate->load_ratio = 5;
        assert_true(certificate->is_loaded == (i == 0));
        if (certify_loop(&run.analysis, run.error) < 0)
            fail_msg("%s", run.error);
        assert_true(certificate->loop.is_made && certificate->loop.is_stable == (i == 0));
        certify_failure(certificate, text);
        if (i == 0)
            assert_true(fabs(certificate->loop.target.first - 1) < 0.01);
        else
            assert_non_null(strstr(text, "influence: loaded"));
        scene_run_close(&run);
    }
}

/* Tables about the loaded equilibrium need nonlinear kinematics of the structure and of the plant.
 */
static void test_refusals(void **state)
{
    static const char *const changes[][2] = {
        {"kinematics=linear", "'influence: loaded' needs the nonlinear structure"},
        {"simulate.plant.kinematics=linear", "'influence: loaded' needs a nonlinear plant"}};
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene scene;
        char error[SCENE_ERROR];
        assert_int_equal(scene_run_read(&scene, STRIP, changes[i][0], error), -1);
        assert_non_null(strstr(error, changes[i][1]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stretched_strip),
                                       cmocka_unit_test(test_buckling_strip),
                                       cmocka_unit_test(test_buckling_plate),
                                       cmocka_unit_test(test_turned_strip),
                                       cmocka_unit_test(test_rolled_strip),
                                       cmocka_unit_test(test_first_frequency),
                                       cmocka_unit_test(test_modes_sum_to_influence),
                                       cmocka_unit_test(test_loop),
                                       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
