/*
 * Scenes with a measured influence matrix and measured vibration modes: the same certificate and
 * the same damped tick as from the structure that both were computed from; static responses that
 * follow from the matrix; a plant that vibrates; and modes that are wrong.
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
#include <cmocka.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/damper.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/matrix_modes.h"
#include "../../host_tools/model/plausible.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/plant.h"
#include "../../host_tools/simulate/storm_state.h"
#include "../rigs/scene_assert.h"
#include "../rigs/test_folder.h"

enum { MODES = 8, MOST_TARGETS = 64 };

/* ---- a plate as if it were measured ------------------------------------- */

/*
 * Changes of the scene that make it a clamped, almost square plate with 2 x 2 pairs of patches and
 * eight modes.
 */
static const char plate_changes[] =
    "mesh.theta1.elements=4;mesh.theta2.elements=4;"
    "patches=[{name: up, layer: upper, grid: [2, 2]}, {name: low, layer: lower, grid: [2, 2]}];"
    "dynamics={modes: 8, damping: [0.01, 0.012, 0.008, 0.01, 0.006, 0.01, 0.02, 0.01]};"
    "simulate={ticks: 10, plant: {modes: 8}}";

/* The same plate with a row of four pairs of patches. */
#define ROW_OF_PATCHES                                                                             \
    "mesh.theta1.elements=4;mesh.theta2.elements=4;"                                               \
    "patches=[{name: up, layer: upper, grid: [4, 1]}, {name: low, layer: lower, grid: [4, 1]}];"   \
    "dynamics={modes: 8, damping: [0.01, 0.012, 0.008, 0.01, 0.006, 0.01, 0.02, 0.01]};"           \
    "simulate={ticks: 10, plant: {modes: 8}}"

static void write_matrix(const analysis *a)
{
    const size_t inputs = a->design.structure.input.count;
    FILE *file = write_file("matrix.csv");
    for (int i = 0; i < a->design.targets; i++)
        for (int k = 0; k < a->design.amplifiers; k++)
            fprintf(file, "%.17g%c", a->influence[(size_t)i * inputs + (size_t)k],
                    k + 1 < a->design.amplifiers ? ' ' : '\n');
    assert_int_equal(fclose(file), 0);
}

/*
 * Write the mode shapes, a row for each target, and the static responses, a row for each amplifier.
 * The modal coordinates are those of unit modal mass, multiplied by 1 + scale times the number of
 * the mode.
 */
static void write_modes(const analysis *a, const vibration *vibration, double scale)
{
    const design *design = &a->design;
    double *shape = calloc((size_t)design->targets * MODES, sizeof *shape);
    FILE *shapes = write_file("shapes.csv"), *responses = write_file("responses.csv");
    assert_non_null(shape);
    for (int mode = 0; mode < MODES; mode++)
        design_shape(design, vibration->shape + (size_t)mode * (size_t)design->mesh.free_dof,
                     shape + mode * design->targets);
    for (int i = 0; i < design->targets; i++)
        for (int mode = 0; mode < MODES; mode++)
            fprintf(shapes, "%.17g%c", shape[mode * design->targets + i] / (1 + scale * mode),
                    mode + 1 < MODES ? ' ' : '\n');
    for (int k = 0; k < design->amplifiers; k++)
        for (int mode = 0; mode < MODES; mode++)
            fprintf(responses, "%.17g%c",
                    (1 + scale * mode) * vibration_static(vibration, design, mode, k),
                    mode + 1 < MODES ? ' ' : '\n');
    assert_int_equal(fclose(shapes) | fclose(responses), 0);
    free(shape);
}

static void write_scene(const analysis *a, const vibration *vibration, bool has_responses)
{
    const design *design = &a->design;
    FILE *file = write_file("scene.yaml");
    fputs("name: measured\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
          "influence:\n  file: matrix.csv\n  modes:\n",
          file);
    for (int mode = 0; mode < MODES; mode++) {
        fprintf(file,
                "    - {frequency: %.17g, damping: %.17g, shape: {file: shapes.csv, column: %d}",
                vibration->frequency[mode], design->dynamics.damping_of_mode[mode], mode + 1);
        if (has_responses)
            fprintf(file, ", response: {file: responses.csv, column: %d}", mode + 1);
        fputs("}\n", file);
    }
    fputs("control: {rate: 1000}\nlimits: {voltage: [-200, 200], step_limit: 13}\n"
          "simulate: {ticks: 10, plant: {hysteresis: 0.1}}\ntarget: {value: [",
          file);
    for (int i = 0; i < design->targets; i++)
        fprintf(file, "%s%.17g", i ? ", " : "", design->target[i]);
    fputs("]}\n", file);
    assert_int_equal(fclose(file), 0);
}

static void prepare(scene_run *run)
{
    if (analysis_influence(&run->analysis, run->error) < 0)
        fail_msg("%s", run->error);
    certificate_make(&run->analysis.certificate, &run->analysis);
}

/*
 * Open a plate, and the scene that is made of its influence matrix and its modes, with modal
 * coordinates scaled as in write_modes.
 *   changes  in  how the plate differs from that of the scene file
 */
static void open_pair(scene_run *plate, scene_run *measured, const char *changes, double scale)
{
    open_run(plate, "tests/rigs/scenes/storm-twins.yaml", changes);
    prepare(plate);
    write_matrix(&plate->analysis);
    write_modes(&plate->analysis, &plate->analysis.certificate.vibration, scale);
    write_scene(&plate->analysis, &plate->analysis.certificate.vibration, true);
    open_run(measured, path_of("scene.yaml"), "");
    prepare(measured);
}

static void open_both(scene_run *plate, scene_run *measured, double scale)
{
    open_pair(plate, measured, plate_changes, scale);
}

static void assert_equal_arrays(const char *what, const pzs_real *one, const pzs_real *other,
                                size_t count, double tolerance)
{
    double size = 0;
    for (size_t i = 0; i < count; i++)
        size = fmax(size, fabs((double)other[i]));
    for (size_t i = 0; i < count; i++)
        if (!(fabs((double)(one[i] - other[i])) <= tolerance * size))
            fail_msg("%s %zu: %.17g, should be %.17g", what, i, (double)one[i], (double)other[i]);
}

/*
 * Law: from matrix and modes of a plate the tables of the damped tick are those of the plate, to
 * rounding: the shapes are sums of a few products, and the gains of the observer come from a
 * Riccati equation that is solved to 1e-12.
 */
static void test_same_tick(void **state)
{
    scene_run plate, measured;
    damper of_plate, of_measured;
    const damper_options options = {1000, 0, damper_default_settings()};
    (void)state;
    open_both(&plate, &measured, 1);
    assert_int_equal(damper_make(&of_plate, &plate.analysis, NULL, &options, plate.error), 0);
    assert_int_equal(damper_make(&of_measured, &measured.analysis, NULL, &options, plate.error), 0);
    const pzs_vibration *one = &of_measured.tables, *other = &of_plate.tables;
    const size_t modes = other->modes, inputs = other->inputs, outputs = other->outputs;
    assert_true(modes >= 2);
    assert_int_equal(one->modes, modes);
    assert_int_equal(one->sensors, other->sensors);
    assert_equal_arrays("shape", one->shape, other->shape, outputs * modes, 1e-14);
    assert_equal_arrays("modal", one->modal, other->modal, modes * inputs, 1e-14);
    assert_equal_arrays("turn", one->turn, other->turn, 4 * modes, 1e-14);
    assert_equal_arrays("observer", one->observer, other->observer, 3 * modes * modes, 1e-11);
    assert_equal_arrays("explain", one->explain, other->explain, modes * modes, 1e-13);
    assert_equal_arrays("damping", one->damping, other->damping, modes * inputs, 1e-12);
    assert_near("share", (double)one->share, (double)other->share, 1e-14);
    damper_close(&of_plate);
    damper_close(&of_measured);
    scene_run_close(&plate);
    scene_run_close(&measured);
}

/*
 * Law: the certificate of the measured scene is that of the plate from which its influence matrix
 * and its modes come, storms included, where both state the same hysteresis: 10 %, which a plate of
 * ceramic has without a number.
 */
static void test_same_certificate(void **state)
{
    scene_run plate, measured;
    (void)state;
    open_both(&plate, &measured, 0);
    const certificate *one = &measured.analysis.certificate, *other = &plate.analysis.certificate;
    assert_true(one->has_modes && one->is_assessed && one->has_own_damping);
    assert_near("radius", one->radius, other->radius, 1e-9);
    assert_near("stable rate", one->stable_rate, other->stable_rate, 1e-9);
    assert_int_equal(certificate_refuses(one), certificate_refuses(other));
    assert_true(certificate_refuses(other)); /* The loop of the plate must need a vibration model,
                                                or the comparison would show nothing. */
    assert_int_equal(certify_loop(&plate.analysis, plate.error), 0);
    assert_int_equal(certify_loop(&measured.analysis, measured.error), 0);
    assert_true(other->loop.is_made && other->loop.is_stable && other->loop.storms == 30);
    assert_int_equal(one->loop.storms, other->loop.storms);
    assert_int_equal(one->loop.failed, other->loop.failed);
    assert_int_equal(one->loop.modes, MODES);
    assert_int_equal(one->loop.observed, other->loop.observed);
    assert_int_equal(one->loop.older, other->loop.older);
    assert_near("growth", one->loop.radius, other->loop.radius, 1e-9);
    assert_near("worst storm", one->loop.worst, other->loop.worst, 1e-6);
    assert_near("ticks", one->loop.ticks, other->loop.ticks, 1e-12);
    assert_near("first mode", certificate_first(one), certificate_first(other), 1e-15);
    scene_run_close(&plate);
    scene_run_close(&measured);
}

/*
 * Law: the best shape of a storm is that of the structure's whole influence matrix, also where the
 * controller leaves out entries. A loop that comes to rest at this shape passes, although the
 * controller's own matrix promises another one; a loop that stays away from it fails.
 */
static void test_dropped_entries(void **state)
{
    static const struct {
        const char *whole, *cut;
        bool passes; /* whether the loop that leaves out entries passes its storms */
    } cases[] = {
        {"target.value=1e-5", "target.value=1e-5;influence.drop_below=0.3", true},
        {"target.value=1e-3", "target.value=1e-3;influence.drop_below=0.45", false},
    };
    scene_run plate, measured;
    (void)state;
    open_pair(&plate, &measured, ROW_OF_PATCHES, 0);
    scene_run_close(&measured);
    scene_run_close(&plate);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_run whole, cut;
        open_run(&whole, path_of("scene.yaml"), cases[i].whole);
        open_run(&cut, path_of("scene.yaml"), cases[i].cut);
        prepare(&whole);
        prepare(&cut);
        assert_true(cut.analysis.design.dropped.entries > 0);
        assert_int_equal(certify_loop(&whole.analysis, whole.error), 0);
        assert_int_equal(certify_loop(&cut.analysis, cut.error), 0);
        assert_int_equal(whole.analysis.certificate.loop.failed, 0);
        assert_int_equal(cut.analysis.certificate.loop.failed == 0, cases[i].passes);
        scene_run_close(&cut);
        scene_run_close(&whole);
    }
}

/*
 * Distance from the target, apart from its free functions, of the static shape of the structure of
 * a storm under given voltages.
 */
static double distance_at(const storm *storm, const double *voltage)
{
    const storm_rig *rig = storm->rig;
    double shape[MOST_TARGETS];
    assert_true(rig->targets <= MOST_TARGETS);
    for (size_t i = 0; i < rig->targets; i++) {
        shape[i] = 0;
        for (size_t k = 0; k < rig->amplifiers; k++)
            shape[i] += storm->plant->gain * rig->influence[i * rig->amplifiers + k] * voltage[k];
    }
    return storm_distance(storm, shape, storm->last_target);
}

/*
 * Law: the best shape of a storm is nearest to the target of all shapes that the structure's whole
 * influence matrix allows within the limits, apart from the free functions of the target, also
 * where the controller leaves out entries. The distance is convex in the voltages, so that it is
 * least where no single voltage that moves by 1e-5 of its range makes it smaller.
 */
static void test_best_shape(void **state)
{
    const estimator none = {0};
    const damper unused = {0};
    const storm_plant plant = {.gain = 0.8, .frequency = 1, .step_limit = 1, .seed = 1};
    scene_run plate, measured, run;
    loop_blocks blocks;
    storm_rig rig;
    storm storm;
    int inside = 0;
    (void)state;
    open_pair(&plate, &measured, ROW_OF_PATCHES ";target.value=5e-3*x*(x+y)", 0);
    scene_run_close(&measured);
    scene_run_close(&plate);
    open_run(&run, path_of("scene.yaml"), "target.free=[piston];influence.drop_below=0.3");
    prepare(&run);
    const design *design = &run.analysis.design;
    assert_true(design->dropped.entries > 0 && design->free_functions == 1);
    loop_blocks_fill(&blocks, design, &none, &unused);
    assert_int_equal(storm_open(&rig, &run.analysis, NULL, run.error), 0);
    storm_use(&rig, blocks.block, blocks.count, 0);
    assert_int_equal(storm_begin(&storm, &rig, &plant, run.error), 0);
    double *best = storm.previous_voltage;
    const double least = distance_at(&storm, best);
    assert_true(fabs(storm_distance(&storm, storm.best_shape, storm.last_target) - least) <=
                64 * DBL_EPSILON * (storm_distance(&storm, storm.best_shape, NULL) + rig.scale));
    for (size_t k = 0; k < rig.amplifiers; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double voltage = best[k],
                         moved = voltage + sign * 1e-5 * (rig.upper[k] - rig.lower[k]);
            best[k] = moved;
            if (moved > rig.lower[k] && moved < rig.upper[k]) {
                assert_true(distance_at(&storm, best) > least);
                inside++;
            }
            best[k] = voltage;
        }
    assert_true(inside > (int)rig.amplifiers);
    storm_end(&storm);
    storm_close(&rig);
    scene_run_close(&run);
}

/*
 * Law: a plant with measured modes vibrates. Immediately after a step of the voltages its shape is
 * the static shape minus the parts of its modes, whose static responses have the gain of the plant.
 */
static void test_plant(void **state)
{
    scene_run plate, measured;
    plant plant;
    double before[64], after[64], wanted = 0, size = 0;
    const double zero[4] = {0}, voltage[4] = {10, 0, 0, 0};
    (void)state;
    open_both(&plate, &measured, 1);
    scene_run_close(&measured);
    open_run(&measured, path_of("scene.yaml"), "simulate.plant={gain: 0.5, hysteresis: 0}");
    prepare(&measured);
    const design *design = &measured.analysis.design;
    assert_int_equal(plant_open(&plant, design, measured.error), 0);
    assert_true(plant.has_inertia && plant.modal.modes == MODES);
    assert_int_equal(plant_shape(&plant, zero, before, measured.error), 0);
    assert_int_equal(plant_shape(&plant, voltage, after, measured.error), 0);
    for (int i = 0; i < design->targets; i++) {
        double expected = 0.5 * 10 * design->measured.matrix[i * 4];
        for (int mode = 0; mode < MODES; mode++)
            expected -= 0.5 * 10 * design->measured.mode[mode].shape[i] *
                        design->measured.mode[mode].response[0];
        wanted = fmax(wanted, fabs(after[i] - expected));
        size = fmax(size, fabs(5 * design->measured.matrix[i * 4]));
        assert_true(before[i] == 0);
    }
    assert_true(wanted < 1e-13 * size);
    plant_close(&plant);
    scene_run_close(&plate);
    scene_run_close(&measured);
}

/* ---- static responses from the matrix ------------------------------------ */

#define HEAD "name: m\ncontrol: {rate: 1000}\ntarget: {value: [1, 2, 3, 4]}\n"

/*
 * Law: where a scene gives no static response of the modes, the response is that of the
 * least-squares fit. A matrix that is a sum of shapes times responses and of a residual orthogonal
 * to the shapes thus gives these responses, whether an output is ignored or not.
 */
static void test_fitted(void **state)
{
    scene_run m;
    vibration vibration;
    (void)state;
    /*
     * The mode shapes are (1, 1, 0, 0) and (1, 2, 0, 1), their responses (3, -1) and (2, 5); the
     * residual is (0, 0, 7, 0) for the first amplifier and (0, 0, -7, 0) for the second.
     */
    write_text("matrix.csv", "5 4\n7 9\n9 9\n7 -7\n2 5\n");
    write_text("scene.yaml",
               "name: m\ninfluence: {file: matrix.csv, ignore: [3], modes: [{frequency: 3 Hz, "
               "shape: [1, 1, 99, 0, 0]}, {frequency: 0.01 kHz, shape: [1, 2, 0, 0, 1]}]}\n"
               "target: {value: [1, 2, 0, 3, 4]}\n");
    open_run(&m, path_of("scene.yaml"), "");
    assert_int_equal(vibration_solve(&vibration, &m.analysis.design, 5, MASS_LUMPED, m.error), 0);
    assert_int_equal(vibration.count, 2);
    assert_near("second frequency", vibration.frequency[1], 10, 1e-15);
    const double wanted[2][2] = {{3, -1}, {2, 5}};
    for (int mode = 0; mode < 2; mode++)
        for (int k = 0; k < 2; k++)
            assert_near("response", vibration_static(&vibration, &m.analysis.design, mode, k),
                        wanted[mode][k], 32 * DBL_EPSILON);
    assert_near("largest", vibration.largest[1], 2, 0);
    vibration_free(&vibration);
    scene_run_close(&m);
}

/*
 * Law: the loop passes its certificate also with static responses that were fitted to the matrix of
 * a plate. The responses differ from the exact ones because the static response of the modes left
 * out is not quite orthogonal to the shapes at the outputs.
 */
static void test_fitted_plate(void **state)
{
    scene_run plate, measured;
    double apart = 0, size = 0;
    (void)state;
    open_both(&plate, &measured, 1);
    scene_run_close(&measured);
    write_scene(&plate.analysis, &plate.analysis.certificate.vibration, false);
    open_run(&measured, path_of("scene.yaml"), "");
    prepare(&measured);
    const vibration *one = &measured.analysis.certificate.vibration,
                    *other = &plate.analysis.certificate.vibration;
    for (int mode = 0; mode < 4; mode++)
        for (int k = 0; k < 4; k++) {
            const double exact =
                (1 + mode) * vibration_static(other, &plate.analysis.design, mode, k);
            size = fmax(size, fabs(exact));
            apart = fmax(apart,
                         fabs(vibration_static(one, &measured.analysis.design, mode, k) - exact));
        }
    print_message("    fitted responses of four modes: %.2g of the largest\n", apart / size);
    assert_int_equal(certify_loop(&measured.analysis, measured.error), 0);
    assert_true(measured.analysis.certificate.loop.is_stable);
    scene_run_close(&plate);
    scene_run_close(&measured);
}

/* ---- shapes that do not belong to the matrix ------------------------------ */

/* Value of a warning on the scene, or 0 where the rule gives none. */
static double warned(const scene_run *m, const char *rule)
{
    plausible warnings;
    memset(&warnings, 0, sizeof warnings);
    plausible_scene(&warnings, &m->scene);
    for (int i = 0; i < warnings.count; i++)
        if (strcmp(warnings.warning[i].rule, rule) == 0)
            return warnings.warning[i].value;
    return 0;
}

/* Swap two outputs in the shapes of all modes of a scene. */
static void swap_outputs(scene_run *m, int i, int j)
{
    for (int mode = 0; mode < MODES; mode++) {
        double *shape = m->scene.influence.mode[mode].shape, kept = shape[i];
        shape[i] = shape[j];
        shape[j] = kept;
    }
}

/* Multiply the static responses of all modes of a scene by a factor. */
static void scale_responses(scene_run *m, double factor)
{
    for (int mode = 0; mode < MODES; mode++)
        for (int k = 0; k < m->scene.amplifiers; k++)
            m->scene.influence.mode[mode].response[k] *= factor;
}

/*
 * Law: the modes of a plate explain its matrix, each at most the whole, and nothing is warned of.
 * With two outputs of the shapes swapped, the swap is found and undone; with all outputs in another
 * order, the modes explain no more than in random order; responses in another unit are told.
 */
static void test_shares(void **state)
{
    static const char *const rules[] = {"modes_share", "mode_share", "shuffled_modes",
                                        "swapped_outputs", "reversed_column"};
    scene_run plate, m;
    matrix_modes found;
    double sum = 0;
    (void)state;
    open_both(&plate, &m, 0);
    const scene_influence *influence = &m.scene.influence;
    const size_t amplifiers = (size_t)m.scene.amplifiers;
    for (int i = 0; i < 5; i++)
        if (warned(&m, rules[i]) != 0)
            fail_msg("%s warns of %g", rules[i], warned(&m, rules[i]));
    assert_int_equal(matrix_modes_find(&found, influence, amplifiers, true), 0);
    for (int mode = 0; mode < MODES; mode++)
        sum += found.of_mode[mode];
    print_message(
        "    share %.5f, of single modes together %.5f; rest %.2g, in random order %.2g\n",
        found.share, sum, found.rest, found.random_rest);
    assert_true(found.share > 0.9 && found.share <= 1 && found.rest <= 1 - found.share);
    assert_int_equal(found.swaps, 0);
    const double rest = found.rest;
    matrix_modes_free(&found);
    swap_outputs(&m, 3, 17);
    assert_int_equal(matrix_modes_find(&found, influence, amplifiers, true), 0);
    assert_int_equal(found.swaps, 1);
    assert_int_equal(found.swapped[0], 3);
    assert_int_equal(found.swapped[1], 17);
    assert_true(fabs(found.swapped_rest - rest) < 1e-9);
    assert_true(found.rest > 1.5 * rest);
    matrix_modes_free(&found);
    assert_true(warned(&m, "swapped_outputs") > MATRIX_SWAP_BAR);
    swap_outputs(&m, 3, 17);
    scale_responses(&m, 1e-3);
    assert_near("share of responses in mm", warned(&m, "modes_share"), 2e-3, 0.1);
    scale_responses(&m, 1e6);
    assert_true(warned(&m, "modes_share") < -1e5 && warned(&m, "mode_share") > 1e5);
    scale_responses(&m, 1e-3);
    assert_true(warned(&m, "modes_share") == 0 && warned(&m, "swapped_outputs") == 0);
    for (int i = 0; i < influence->outputs; i++)
        swap_outputs(&m, i, (i * 7 + 5) % influence->outputs);
    assert_true(warned(&m, "shuffled_modes") > 0.95);
    scene_run_close(&plate);
    scene_run_close(&m);
}

/* Change the sign of the static responses of all modes of a scene to one actuator. */
static void reverse_response(scene_run *m, int actuator)
{
    for (int mode = 0; mode < MODES; mode++)
        m->scene.influence.mode[mode].response[actuator] *= -1;
}

/*
 * Law: an actuator whose responses have another sign than its column of the matrix is named, alone
 * and beside others, although the modes still explain more than half of the matrix.
 */
static void test_reversed_columns(void **state)
{
    scene_run plate, m;
    plausible warnings;
    (void)state;
    open_both(&plate, &m, 0);
    reverse_response(&m, 1);
    memset(&warnings, 0, sizeof warnings);
    plausible_scene(&warnings, &m.scene);
    const plausible_warning *warning = NULL;
    for (int i = 0; i < warnings.count; i++)
        if (strcmp(warnings.warning[i].rule, "reversed_column") == 0)
            warning = &warnings.warning[i];
    assert_non_null(warning);
    assert_true(warning->value < -0.9 && warning->value >= -1 - 8 * DBL_EPSILON);
    assert_non_null(strstr(warning->text, m.scene.actuator[1].name));
    assert_null(strstr(warning->text, m.scene.actuator[0].name));
    reverse_response(&m, 1);
    assert_true(warned(&m, "reversed_column") == 0);
    scene_run_close(&plate);
    scene_run_close(&m);
}

/* Uniform random number in -1 ... 1 from a linear congruential generator. */
static double random_number(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(int32_t)*seed / 2147483648.0;
}

enum { SIDE = 11, NOISY = SIDE * SIDE, INPUTS = 25, GIVEN = 6 };

/*
 * Influence matrix of a square of 11 x 11 outputs: six modes of random responses, and noise.
 *   noise  in   root mean square of the noise over that of the modes' static parts
 *   matrix out  [NOISY][INPUTS]
 *   shape  out  [GIVEN][NOISY]
 */
static void make_noisy(double noise, double *matrix, double shape[GIVEN][NOISY], uint32_t *seed)
{
    static const double pi = 3.14159265358979;
    memset(matrix, 0, NOISY * INPUTS * sizeof *matrix);
    for (int mode = 0; mode < GIVEN; mode++)
        for (int i = 0; i < NOISY; i++)
            shape[mode][i] = cos(pi * (mode / 2) * (i / SIDE) / (SIDE - 1.0)) *
                             cos(pi * (mode % 3) * (i % SIDE) / (SIDE - 1.0));
    for (int k = 0; k < INPUTS; k++)
        for (int mode = 0; mode < GIVEN; mode++) {
            const double response = random_number(seed) / (1 + mode);
            for (int i = 0; i < NOISY; i++)
                matrix[i * INPUTS + k] += response * shape[mode][i];
        }
    double squares = 0;
    for (int i = 0; i < NOISY * INPUTS; i++)
        squares += matrix[i] * matrix[i];
    const double size = noise * sqrt(3 * squares / (NOISY * INPUTS));
    for (int i = 0; i < NOISY * INPUTS; i++)
        matrix[i] += size * random_number(seed);
}

/*
 * Law: two of 121 outputs that are swapped are found where the squared distance of their rows is
 * ten times what noise leaves of a row, although the swap changes the whole by a tenth only, which
 * a bar of 1.5 on the whole would miss. Outputs in the right order are not called swapped.
 */
static void test_swaps_in_noise(void **state)
{
    static double matrix[NOISY * INPUTS], shape[GIVEN][NOISY];
    scene_measured_mode mode[GIVEN];
    const scene_influence measured = {
        .outputs = NOISY, .modes = GIVEN, .mode = mode, .matrix = matrix};
    uint32_t seed = 7;
    int tried = 0;
    (void)state;
    memset(mode, 0, sizeof mode);
    for (int k = 0; k < GIVEN; k++)
        mode[k].shape = shape[k];
    for (int trial = 0; trial < 200; trial++) {
        matrix_modes found;
        make_noisy(0.3, matrix, shape, &seed);
        assert_int_equal(matrix_modes_find(&found, &measured, INPUTS, true), 0);
        assert_true(found.swap_gain < MATRIX_SWAP_BAR);
        const double of_row = found.rest / NOISY;
        double size = 0, apart = 0;
        const int i = trial % NOISY, other = (i * 7 + 60) % NOISY;
        for (int k = 0; k < NOISY * INPUTS; k++)
            size += matrix[k] * matrix[k];
        for (int k = 0; k < INPUTS; k++)
            apart += pow(matrix[i * INPUTS + k] - matrix[other * INPUTS + k], 2) / size;
        matrix_modes_free(&found);
        if (apart < 10 * of_row || apart > 25 * of_row)
            continue;
        for (int k = 0; k < GIVEN; k++) {
            const double kept = shape[k][i];
            shape[k][i] = shape[k][other];
            shape[k][other] = kept;
        }
        assert_int_equal(matrix_modes_find(&found, &measured, INPUTS, true), 0);
        assert_true(found.swap_gain > MATRIX_SWAP_BAR);
        assert_int_equal(found.swapped[0] + found.swapped[1], i + other);
        assert_true(found.rest < 1.5 * found.swapped_rest);
        matrix_modes_free(&found);
        tried++;
    }
    print_message("    %d of %d swaps found, each changes what is left by less than a half\n",
                  tried, tried);
    assert_true(tried >= 20);
}

/* Law: without modes nothing is known of vibration, and the certificate says how to change that. */
static void test_without_modes(void **state)
{
    scene_run m;
    damper damper;
    (void)state;
    write_text("matrix.csv", "1 0\n0 1\n1 1\n1 -1\n");
    write_text("scene.yaml", HEAD "influence: {file: matrix.csv}\n");
    open_run(&m, path_of("scene.yaml"), "");
    prepare(&m);
    assert_false(m.analysis.certificate.has_modes);
    assert_non_null(strstr(m.analysis.certificate.reason, "influence: {modes:"));
    assert_int_equal(damper_open(&damper, &m.analysis, NULL, m.error), 0);
    assert_false(damper.is_used);
    scene_run_close(&m);
}

/* Law: modes that are wrong are refused in one line that says what was found. */
static void test_wrong(void **state)
{
    static const struct {
        const char *modes, *expected;
    } bad[] = {
        {"[]", "0 modes are out of range (1 to 200)"},
        {"[{frequency: 3}]", "'shape'"},
        {"[{shape: [1, 2, 3, 4]}]", "'frequency'"},
        {"[{frequency: 0, shape: [1, 2, 3, 4]}]", "must be above 0"},
        {"[{frequency: 3, damping: 1, shape: [1, 2, 3, 4]}]", "part of critical damping"},
        {"[{frequency: 3, shape: [1, 2, 3]}]", "3 values for 4 outputs of the matrix"},
        {"[{frequency: 3, shape: [1, 2, 3, 4], response: [1]}]", "1 values for 2 actuators"},
        {"[{frequency: 3, shape: [1, 2, 3, .nan]}]", ".nan"},
        {"[{frequency: 3, shape: [1, 0, 0, 0]}, {frequency: 2, shape: [0, 1, 0, 0]}]",
         "a mode of 2 Hz after one of 3 Hz"},
        {"[{frequency: 3, shape: [0, 0, 0, 0]}]", "the shape of mode 1 is 0 at every output"},
        {"[{frequency: 3, shape: [1, 0, 0, 0], response: [1, 1]}, {frequency: 4, shape: [0, 1, 0, "
         "0]}]",
         "some modes have a response and some have none"},
    };
    (void)state;
    write_text("matrix.csv", "1 0\n0 1\n1 1\n1 -1\n");
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char text[600], error[SCENE_ERROR] = "no fault";
        scene scene;
        snprintf(text, sizeof text, HEAD "influence: {file: matrix.csv, modes: %s}\n",
                 bad[k].modes);
        write_text("scene.yaml", "%s", text);
        const int failed = scene_read(&scene, path_of("scene.yaml"), NULL, 0, error);
        if (!failed)
            scene_free(&scene);
        if (!failed || !strstr(error, bad[k].expected) || strchr(error, '\n'))
            fail_msg("%s: expected '%s', got '%s'", bad[k].modes, bad[k].expected, error);
    }
}

/*
 * Law: two modes of one frequency are modes like others, as those of a disc; with shapes that are
 * combinations of each other every command refuses the scene, for the matrix then determines no
 * static responses.
 */
static void test_double_modes(void **state)
{
    scene_run m;
    (void)state;
    write_text("matrix.csv", "1 0\n0 1\n1 1\n1 -1\n");
    write_text("scene.yaml",
               HEAD "influence: {file: matrix.csv, modes: [{frequency: 3, shape: [1, 0, 0, 0]}, "
                    "{frequency: 3, shape: [0, 1, 0, 0]}]}\n");
    open_run(&m, path_of("scene.yaml"), "");
    prepare(&m);
    assert_true(m.analysis.certificate.has_modes);
    assert_int_equal(m.analysis.certificate.vibration.count, 2);
    scene_run_close(&m);
    write_text("scene.yaml",
               HEAD "influence: {file: matrix.csv, modes: [{frequency: 3, shape: [1, 0, 0, 0]}, "
                    "{frequency: 4, shape: [2, 0, 0, 0]}]}\n");
    if (scene_run_open(&m, path_of("scene.yaml"), "") == 0)
        fail_msg("%s", "two modes of one shape are accepted");
    assert_non_null(strstr(m.error, "the shape of mode 2 is a combination"));
    scene_run_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_tick),       cmocka_unit_test(test_same_certificate),
        cmocka_unit_test(test_dropped_entries), cmocka_unit_test(test_best_shape),
        cmocka_unit_test(test_plant),           cmocka_unit_test(test_fitted),
        cmocka_unit_test(test_shares),          cmocka_unit_test(test_reversed_columns),
        cmocka_unit_test(test_swaps_in_noise),  cmocka_unit_test(test_fitted_plate),
        cmocka_unit_test(test_without_modes),   cmocka_unit_test(test_wrong),
        cmocka_unit_test(test_double_modes),
    };
    return cmocka_run_group_tests(tests, make_test_folder, remove_test_folder);
}
