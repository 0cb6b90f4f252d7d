/*
 * Charges, sensors and open electrodes: laws and closed forms, each on a scene run as a user runs
 * it.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/model/electrode.h"
#include "../../host_tools/model/electrodes.h"
#include "../../lib/model/model.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../rigs/mode_stiffness.h"
#include "../rigs/scene_assert.h"
#include "../rigs/uniform.h"
#include "../../lib/model/shell.h"

/* ---- sensors of a bimorph --------------------------------------------- */

static const double beam[5] = {292.351, 227.384, 162.417, 97.450, 32.483};

/* Law: a statically determinate strip gives its open electrodes the volts of beam theory on any
 * mesh. */
static void test_sensor_volts(void **state)
{
    (void)state;
    for (int e = 0; e < 2; e++) {
        scene_run r;
        solve_run(&r, "bimorph-sensor", elements[e]);
        for (int k = 0; k < 5; k++)
            assert_true(fabs(scene_run_value(&r, 1 + k) - beam[k]) < 6e-4);
        scene_run_close(&r);
    }
}

/* Volt of the first electrode at 10 mm of tip over that of beam theory, less 1. */
static double sensor_error(int size)
{
    char changes[128];
    scene_run r;
    snprintf(changes, sizeof changes, "mesh.theta1.elements=%d", size);
    solve_run(&r, "bimorph-sensor", changes);
    const double error = scene_run_value(&r, 1) * (-0.01 / scene_run_value(&r, 0)) / 292.3510 - 1;
    scene_run_close(&r);
    return error;
}

/* Law: at a given tip the volts converge with the square of the element: + 1.0 % on five, + .011 %
 * on forty. */
static void test_sensor_order(void **state)
{
    (void)state;
    const double e5 = sensor_error(5), e10 = sensor_error(10), e20 = sensor_error(20),
                 e40 = sensor_error(40);
    assert_true(fabs(e5 - 1.0e-2) < 5e-4);
    assert_true(fabs(e40 - 1.1e-4) < 5e-6);
    /* Between 20 and 40 elements what is measured is small: the digits of the reference are left
     * out by differences. */
    assert_true(fabs((e5 - e10) / (e10 - e20) - 4) < 0.1 &&
                fabs((e10 - e20) / (e20 - e40) - 4) < 0.1);
}

/* Law: no charge comes to an open electrode, no volt to a short one; with their charge given, open
 * ones hold it. */
static void test_circuits(void **state)
{
    (void)state;
    scene_run r;
    solve_run(&r, "bimorph-sensor", "");
    analysis *analysis = &r.analysis;
    double charge[5], amount[16] = {0}, voltage[5];
    for (int k = 0; k < 5; k++) {
        assert_true(fabs(analysis->charge[k]) < 1e-12 * 1e-9 * 300);
        voltage[k] = analysis->input_value[analysis->design.electrodes.input[k]];
    }
    scene_run_close(&r);
    solve_run(&r, "bimorph-sensor", "sensors.s.circuit=short");
    for (int k = 0; k < 5; k++) {
        assert_true(r.analysis.input_value[r.analysis.design.electrodes.input[k]] == 0);
        charge[k] = r.analysis.charge[k];
        assert_true(charge[k] < 0);
    }
    scene_run_close(&r);
    /* Held at the charges of the short circuit, open electrodes stay without volts; half of it,
     * half of the volts. */
    solve_run(&r, "bimorph-sensor", "");
    analysis = &r.analysis;
    for (int half = 0; half < 2; half++) {
        memset(amount, 0, sizeof amount);
        amount[analysis->design.amplifiers] = 1;
        for (int k = 0; k < 5; k++)
            analysis->electric.settings.charge[k] = charge[k] * (half ? 0.5 : 1);
        assert_int_equal(pzs_open_voltages(&analysis->electric, amount), PZS_OK);
        for (int k = 0; k < 5; k++)
            assert_true(fabs(amount[analysis->design.electrodes.input[k]] -
                             (half ? voltage[k] / 2 : 0)) < 1e-10 * 300);
    }
    scene_run_close(&r);
}

/* ---- reciprocity ------------------------------------------------------ */

#define FOUR                                                                                       \
    "patches=[{name: up, layer: upper, grid: [3, 2]}, {name: low, layer: lower, grid: [3, 2]}];"   \
    "actuators=[{name: v, drives: [{patches: up, factor: 0.7}]}];sensors.0.drives=[{patches: "     \
    "low, factor: -1.3}];outputs=[];"

static double random_part(void)
{
    static uint32_t seed = 7;
    return uniform(&seed, -1, 1);
}

/* The lower layer of the scene PLATE poled along its axis 1, which is 30 degrees from theta1. */
#define POLED_ALONG                                                                                \
    "layers.0.poling=1;layers.0.angle=30;materials.ceramic.d15=500e-12;"                           \
    "materials.ceramic.permittivity_across=9e-9;"

static const char *const poled_elements[5] = {PUBLISHED, IMPROVED, IMPROVED "dof_per_node=6;",
                                              IMPROVED POLED_ALONG,
                                              "element={shear: equilibrium};" POLED_ALONG};

/* Law: the charge of one electrode per volt of another is that of the other per volt of the one. */
static void test_reciprocity(void **state)
{
    (void)state;
    for (int e = 0; e < 5; e++) {
        scene_run r;
        open_run(&r, PLATE, with(poled_elements[e], FOUR));
        const pzs_electrodes *tables = &r.analysis.design.electrodes;
        const size_t inputs = r.analysis.design.structure.input.count;
        const double *per = r.analysis.electric.state.sensitivity;
        assert_int_equal(tables->count, 12);
        for (size_t i = 0; i < 12; i++)
            for (size_t j = 0; j < i; j++)
                assert_true(fabs(per[i * inputs + tables->input[j]] -
                                 per[j * inputs + tables->input[i]]) < 1e-12 * per[0]);
        scene_run_close(&r);
    }
}

/*
 * Law: at any shape the charge's derivative by the displacement is the force of a volt there; at
 * rest it is the transpose of the actuation column. The charge is quadratic in the displacement, so
 * its central difference is exact.
 */
static void test_sensor_row(void **state)
{
    (void)state;
    for (int e = 0; e < 5; e++)
        for (int bent = 0; bent < 2; bent++) {
            scene_run r;
            open_run(&r, PLATE, with(poled_elements[e], FOUR "kinematics=nonlinear"));
            pzs_solver *run = &r.analysis.equilibrium.solver;
            const pzs_electrodes *tables = &r.analysis.design.electrodes;
            const int dof = r.analysis.design.mesh.free_dof;
            double *shape = calloc((size_t)dof, sizeof *shape),
                   *step = calloc((size_t)dof, sizeof *step);
            double *force = calloc((size_t)dof, sizeof *force),
                   *column = calloc((size_t)dof, sizeof *column);
            double above[12], below[12];
            for (int i = 0; i < dof; i++) {
                shape[i] = bent ? 0.01 * random_part() : 0;
                step[i] = 0.01 * random_part();
                run->state.displacement[i] = shape[i] + step[i];
            }
            pzs_charges_at(run, tables, above);
            for (int i = 0; i < dof; i++)
                run->state.displacement[i] = shape[i] - step[i];
            pzs_charges_at(run, tables, below);
            memcpy(run->state.displacement, shape, (size_t)dof * sizeof *shape);
            for (int k = 0; k < 12; k++) {
                double work = 0, size = 0;
                memset(force, 0, (size_t)dof * sizeof *force);
                pzs_nonlinear_unit_force(run, tables->input[k], force);
                memset(column, 0, (size_t)dof * sizeof *column);
                pzs_model_add_input(&r.analysis.model, tables->input[k], 1, column);
                for (int i = 0; i < dof; i++) {
                    work += force[i] * step[i];
                    size += fabs(force[i] * step[i]);
                    assert_true(bent ||
                                fabs(force[i] - column[i]) < 1e-12 * fabs(column[i]) + 1e-15);
                }
                assert_true(fabs((above[k] - below[k]) / 2 - work) <
                            1e-12 * size + 1e-13 * fabs(above[k]));
            }
            free(shape);
            free(step);
            free(force);
            free(column);
            scene_run_close(&r);
        }
}

/* ---- energy ----------------------------------------------------------- */

/* u K u / 2, element by element from strains. */
static double elastic_energy(const analysis *analysis, const double *u)
{
    const pzs_structure *structure = &analysis->design.structure;
    double sum = 0;
    for (uint32_t e = 0; e < structure->elements; e++) {
        double own[SHELL_MAX], force[SHELL_MAX];
        pzs_model_gather(&analysis->model, structure->element[e], SHELL_NODES, u, own);
        pzs_shell_force(&structure->type[structure->element_type[e]], structure->dof_per_node, own,
                        force);
        for (unsigned i = 0; i < 4u * structure->dof_per_node; i++)
            sum += own[i] * force[i] / 2;
    }
    return sum;
}

/* V C V / 2 of what the electrodes hold while the shell is held. */
static double electric_energy(const analysis *analysis)
{
    const pzs_electrodes *tables = &analysis->design.electrodes;
    double sum = 0;
    for (uint32_t k = 0; k < tables->count; k++)
        for (uint32_t i = tables->direct.start[k]; i < tables->direct.start[k + 1]; i++)
            sum += analysis->input_value[tables->input[k]] * tables->direct.value[i] *
                   analysis->input_value[tables->direct.dof[i]] / 2;
    return sum;
}

/* Law: the work of a force on a shell with open electrodes is its elastic and electric energy. */
static void test_energy(void **state)
{
    (void)state;
    static const char *const scenes[2] = {"bimorph-sensor", PLATE};
    static const char *const loads[2] = {
        "", "loads=[{line: theta1+, u1: 1e4, on: outer}, {line: theta1-, u1: -1e4, on: outer}]"};
    for (int e = 0; e < 5; e++)
        for (int k = e < 3 ? 0 : 1; k < 2; k++) {
            scene_run r;
            solve_run(&r, scenes[k], with(poled_elements[e], loads[k]));
            const analysis *analysis = &r.analysis;
            const pzs_rows *input = &analysis->design.structure.input;
            double work = 0;
            for (int j = analysis->design.amplifiers;
                 j < analysis->design.amplifiers + analysis->design.loads; j++)
                for (uint32_t t = input->start[j]; t < input->start[j + 1]; t++)
                    work += input->value[t] * r.u[input->dof[t]] / 2;
            const double electric = electric_energy(analysis);
            assert_true(electric > 1e-3 * work);
            assert_near(scenes[k], elastic_energy(analysis, r.u) + electric, work, 1e-10);
            scene_run_close(&r);
        }
}

/* ---- capacitance and coupling ----------------------------------------- */

#define YOUNG 60e9
#define D31 (-200e-12)
#define D33 450e-12
#define CLAMPED_PERMITTIVITY 8e-9
#define LAYER 0.5e-3
#define AREA (0.06 * 0.04)

/* Permittivity at constant stress: that at constant strain and d C d, nu = 0.3. */
static double free_permittivity(void)
{
    const double nu = 0.3, c = YOUNG / ((1 + nu) * (1 - 2 * nu)), d[3] = {D31, D31, D33};
    double sum = CLAMPED_PERMITTIVITY;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum += d[i] * d[j] * c * (i == j ? 1 - nu : nu);
    return sum;
}

/* Law: a clamped electrode holds permittivity A / h a volt, a free one that at constant stress,
 * whatever the element. */
static void test_capacitance(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        scene_run r;
        open_run(&r, PLATE, with(elements[e], ONE_LAYER));
        const analysis *analysis = &r.analysis;
        assert_near("clamped", analysis->design.electrodes.direct.value[0],
                    CLAMPED_PERMITTIVITY * AREA / LAYER, 1e-12);
        assert_near("free",
                    analysis->electric.state.sensitivity[analysis->design.electrodes.input[0]],
                    free_permittivity() * AREA / LAYER, 1e-10);
        scene_run_close(&r);
    }
}

/*
 * Law: in a package the improved element lets each ply thicken by itself, s33 = 0: an electrode on
 * one half of a free plate of thickness 2 t holds A/t (eps - 2 d31^2 (E/(1 - nu))/8) a volt, eps at
 * constant stress, by the theory of thin plates.
 */
static void test_capacitance_in_a_package(void **state)
{
    (void)state;
    for (int e = 1; e < 3; e++) {
        scene_run r;
        open_run(&r, PLATE, elements[e]);
        const double want = AREA / LAYER * (free_permittivity() - 2 * D31 * D31 * YOUNG / 0.7 / 8);
        assert_near("free half",
                    r.analysis.electric.state.sensitivity[r.analysis.design.electrodes.input[0]],
                    want, 1e-9);
        scene_run_close(&r);
    }
}

/* Law: a free bar pulled along 1 is softer with its electrodes short than open, by 1/(1 - k31^2).
 */
static void test_coupling(void **state)
{
    (void)state;
    static const char *const circuit[2] = {"sensors.s.circuit=short;", "sensors.s.circuit=open;"};
    const double k31 = D31 * D31 * YOUNG / free_permittivity();
    for (int e = 0; e < 3; e++) {
        double stretch[2];
        for (int open = 0; open < 2; open++) {
            scene_run r;
            char changes[512];
            snprintf(changes, sizeof changes,
                     "%s" ONE_LAYER "%sloads=[{line: theta1+, u1: 1e4}, {line: theta1-, u1: -1e4}]",
                     elements[e], circuit[open]);
            solve_run(&r, PLATE, changes);
            stretch[open] = r.output[r.analysis.design.named_first[2] - 1];
            const double stiffer = analysis_stiffening(&r.analysis);
            if (open)
                assert_near("as it is told", stiffer, 1 / (1 - k31), 1e-9);
            else
                assert_true(isnan(stiffer));
            scene_run_close(&r);
        }
        assert_true(k31 > 0.1);
        assert_near("open over short", stretch[1] / stretch[0], 1 - k31, 1e-9);
    }
}

/* Law: the influence with open electrodes is what solves with open electrodes give, input by input.
 */
static void test_open_influence(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, PLATE, FOUR "target={u3: middle, at: nodes, value: x}");
    analysis *analysis = &r.analysis;
    const size_t inputs = analysis->design.structure.input.count;
    double voltage[6], size = 0;
    assert_int_equal(analysis_influence(analysis, r.error), 0);
    for (int j = 0; j < 6; j++) {
        memset(voltage, 0, sizeof voltage);
        voltage[j] = 1;
        assert_int_equal(analysis_reach(analysis, voltage, 0, r.u, r.error), 0);
        scene_run_observe(&r, r.u);
        for (int i = 0; i < analysis->design.targets; i++)
            size = fmax(size, fabs(r.output[i]));
        for (int i = 0; i < analysis->design.targets; i++)
            assert_true(fabs(r.output[i] - analysis->influence[(size_t)i * inputs + (size_t)j]) <
                        1e-9 * size);
    }
    /* Columns of the open ones are per unit of charge. */
    for (int k = 0; k < 6; k++) {
        double amount[12] = {0};
        analysis->electric.settings.charge[6 + k] = 1;
        assert_int_equal(pzs_open_voltages(&analysis->electric, amount), PZS_OK);
        assert_int_equal(pzs_solve(&analysis->model, amount, r.u), PZS_OK);
        scene_run_observe(&r, r.u);
        analysis->electric.settings.charge[6 + k] = 0;
        for (int i = 0; i < analysis->design.targets; i++)
            assert_true(
                fabs(r.output[i] - analysis->influence[(size_t)i * inputs +
                                                       analysis->design.electrodes.input[6 + k]]) <
                1e-9 * size / CLAMPED_PERMITTIVITY);
    }
    scene_run_close(&r);
}

/* ---- pyroelectricity --------------------------------------------------- */

/*
 * Law: a free pyroelectric plate warmed by T shows p T h / eps volts, p and eps at constant stress;
 * clamped in the mean of its temperature, one warmer outside by as much as it is colder inside
 * shows none.
 */
static void test_pyroelectricity(void **state)
{
    (void)state;
    const double c = YOUNG / ((1 + 0.3) * (1 - 2 * 0.3)), bulk = c * (1 + 0.3),
                 p = -3e-4 + bulk * 4e-6 * (2 * D31 + D33);
    for (int e = 0; e < 3; e++) {
        scene_run r;
        solve_run(&r, PLATE, with(elements[e], ONE_LAYER "loads=[{temperature: 7}]"));
        assert_near("volts", scene_run_value(&r, 2), p * 7 * LAYER / free_permittivity(), 1e-9);
        assert_true(fabs(scene_run_value(&r, 3)) < 1e-12 * AREA * 3e-4 * 7);
        scene_run_close(&r);
        solve_run(&r, PLATE,
                  with(elements[e], ONE_LAYER "loads=[{temperature: {inner: -7, outer: 7}}]"));
        assert_true(fabs(scene_run_value(&r, 2)) <
                    1e-9 * fabs(p * 7 * LAYER / free_permittivity()));
        scene_run_close(&r);
    }
}

/* ---- large displacements ---------------------------------------------- */

#define FAR                                                                                        \
    "kinematics=nonlinear;equilibrium={tolerance: 1e-8};loads=[];mesh.theta1.elements=20;"         \
    "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 mean, value: %s}];"

static void bend_far(scene_run *r, const char *element, const char *by, const char *changes)
{
    char all[1024];
    snprintf(all, sizeof all, "%s" FAR "%s", element, by, changes);
    solve_run(r, "bimorph-sensor", all);
}

/* Law: a small displacement gives the volts of the linear analysis, a large one not. */
static void test_linear_limit(void **state)
{
    (void)state;
    scene_run linear, small, large;
    solve_run(&linear, "bimorph-sensor", "mesh.theta1.elements=20");
    bend_far(&small, PUBLISHED, "-1e-6", "");
    bend_far(&large, PUBLISHED, "-0.05", "");
    const double tip = scene_run_value(&linear, 0);
    for (int k = 1; k < 6; k++)
        assert_near("volts", scene_run_value(&small, k) / -1e-6, scene_run_value(&linear, k) / tip,
                    1e-6);
    assert_true(scene_run_value(&large, 1) / -0.05 < 1.09 * scene_run_value(&linear, 1) / tip);
    scene_run_close(&linear);
    scene_run_close(&small);
    scene_run_close(&large);
}

/* Law: open electrodes cost Newton's method no system; their charge is nothing; load steps change
 * nothing in the end. */
static void test_open_systems(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        scene_run open, stepped, closed;
        bend_far(&closed, elements[e], "-0.05", "sensors.s.circuit=short");
        bend_far(&open, elements[e], "-0.05", "");
        bend_far(&stepped, elements[e], "-0.05", "equilibrium.load_steps=3");
        assert_int_equal(open.analysis.equilibrium.solver.info.linear_solves,
                         closed.analysis.equilibrium.solver.info.linear_solves);
        assert_int_equal(stepped.analysis.equilibrium.solver.info.load_steps, 3);
        for (int k = 0; k < 5; k++) {
            assert_true(fabs(open.analysis.charge[k]) < 1e-12 * fabs(closed.analysis.charge[k]));
            assert_near("volts", scene_run_value(&stepped, 1 + k), scene_run_value(&open, 1 + k),
                        1e-8);
        }
        scene_run_close(&open);
        scene_run_close(&stepped);
        scene_run_close(&closed);
    }
}

enum { GAUSS = 8 };
static const double gauss_x[GAUSS] = {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290,
                                      -0.1834346424956498, 0.1834346424956498,  0.5255324099163290,
                                      0.7966664774136267,  0.9602898564975363};
static const double gauss_w[GAUSS] = {0.1012285362903763, 0.2223810344533745, 0.3137066458778873,
                                      0.3626837833783620, 0.3626837833783620, 0.3137066458778873,
                                      0.2223810344533745, 0.1012285362903763};

/* Elastic energy at the shape reached: half of the resultants of the modes, given ones left out,
 * times their strains. */
static double energy_at(const analysis *analysis)
{
    const pzs_structure *structure = &analysis->design.structure;
    const pzs_solver *run = &analysis->equilibrium.solver;
    double sum = 0;
    for (uint32_t e = 0; e < structure->elements; e++) {
        const pzs_element_type *type = &structure->type[structure->element_type[e]];
        double u[SHELL_MAX], strain[4][10];
        pzs_model_gather(run->state.model, structure->element[e], SHELL_NODES,
                         run->info.displacement, u);
        pzs_shell_strains_at(type, structure->dof_per_node, u, strain);
        for (int m = 0; m < 4; m++)
            for (int i = 0; i < 10; i++)
                for (int j = 0; j < 10; j++)
                    sum += strain[m][i] * mode_stiffness(type, m, i, j) * strain[m][j] / 2;
    }
    return sum;
}

/*
 * Law: along a path at large rotation the work of a force, the integral of F du/dF dF by the
 * influence of each shape reached, is the elastic and electric energy at its end.
 */
static void test_energy_at_a_shape(void **state)
{
    (void)state;
    static const char *const element[2] = {PUBLISHED, IMPROVED};
    for (int e = 0; e < 2; e++) {
        scene_run r;
        double work = 0;
        open_run(&r, "bimorph-sensor",
                 with(element[e], "kinematics=nonlinear;equilibrium={tolerance: 1e-10};"
                                  "loads=[{point: {theta1: 0.1, theta2: 0}, u3: 0.1}];"
                                  "outputs=[{name: tip, u3: mean, at: {theta1: 0.1, theta2: 0}}]"));
        analysis *analysis = &r.analysis;
        const int inputs = analysis->design.structure.input.count,
                  load = analysis->design.amplifiers;
        double *influence = calloc((size_t)inputs, sizeof *influence),
               *amount = calloc((size_t)inputs, sizeof *amount);
        for (int g = 0; g < GAUSS; g++) {
            amount[load] = (1 + gauss_x[g]) / 2;
            assert_int_equal(pzs_equilibrium(&analysis->equilibrium.solver, amount), PZS_OK);
            assert_int_equal(pzs_influence_at(&analysis->equilibrium.solver, influence), PZS_OK);
            work += gauss_w[g] / 2 * 0.1 * amount[load] * influence[load];
        }
        if (analysis_solve(analysis, r.u, r.error) < 0)
            fail_msg("%s", r.error);
        scene_run_observe(&r, r.u);
        assert_true(fabs(r.output[0]) > 0.03);
        assert_true(electric_energy(analysis) > 1e-3 * work);
        assert_near("work", energy_at(analysis) + electric_energy(analysis), work, 1e-9);
        free(influence);
        free(amount);
        scene_run_close(&r);
    }
}

/* ---- misuse ----------------------------------------------------------- */

/* Law: tables that are damaged, of another structure or of no use are refused, and so is a stage
 * left out. */
static void test_refusals(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "bimorph-sensor", "");
    pzs_model *model = &r.analysis.model;
    const pzs_electrodes good = r.analysis.design.electrodes;
    const uint16_t inputs = r.analysis.design.structure.input.count;
    pzs_electric electric;
    double work[200], amount[8] = {0}, charge[5];
    const size_t need = PZS_ELECTRIC_BYTES(5, 5, inputs);
    assert_true(need <= sizeof work);
    assert_int_equal(pzs_electric_init(&electric, model, &good, work, need - 1), PZS_E_WORKSPACE);
    assert_int_equal(electric.info.where, need);
    assert_int_equal(pzs_electric_init(NULL, model, &good, work, need), PZS_E_ARGUMENT);
    pzs_electrodes bad = good;
    bad.scene++;
    assert_int_equal(pzs_electric_init(&electric, model, &bad, work, need), PZS_E_FORMAT);
    bad = good;
    bad.crc++;
    assert_int_equal(pzs_electric_init(&electric, model, &bad, work, need), PZS_E_CRC);
    const uint16_t beyond[5] = {1, 2, 3, 4, inputs}, falling[5] = {2, 1, 3, 4, 5};
    for (int k = 0; k < 2; k++) {
        bad = good;
        bad.input = k ? beyond : falling;
        bad.crc = pzs_electrode_crc(&bad, inputs);
        assert_int_equal(pzs_electric_init(&electric, model, &bad, work, need), PZS_E_ARGUMENT);
    }
    assert_int_equal(pzs_electric_init(&electric, model, &good, work, need), PZS_OK);
    assert_int_equal(pzs_open_voltages(&electric, amount), PZS_E_STAGE);
    assert_int_equal(pzs_charges(&electric, amount, charge), PZS_E_STAGE);
    assert_int_equal(pzs_influence_open(&electric, work), PZS_E_STAGE);
    assert_int_equal(pzs_electric_factor(&electric), PZS_OK);
    amount[0] = (double)NAN;
    for (int j = 1; j < inputs; j++)
        amount[j] = j;
    assert_int_equal(pzs_open_voltages(&electric, amount), PZS_E_NONFINITE);
    for (int j = 1; j < inputs; j++)
        assert_true(amount[j] == j); /* untouched, volts of open electrodes too */
    pzs_solver never = {0};
    assert_int_equal(pzs_charges_at(NULL, &good, charge), PZS_E_ARGUMENT);
    assert_int_equal(pzs_charges_at(&never, &good, charge), PZS_E_ARGUMENT);
    /* An electrode that holds a negative charge a volt is no electrode. */
    double negative[5];
    for (int k = 0; k < 5; k++)
        negative[k] = k == 3 ? -1 : good.direct.value[k];
    bad = good;
    bad.direct.value = negative;
    bad.crc = pzs_electrode_crc(&bad, inputs);
    assert_int_equal(pzs_electric_init(&electric, model, &bad, work, need), PZS_OK);
    assert_int_equal(pzs_electric_factor(&electric), PZS_E_NEGATIVE);
    assert_int_equal(electric.info.where, 3);
    scene_run_close(&r);
}

/* ---- poling along the surface ----------------------------------------- */

#define SHEAR_D15 740e-12
#define SHEAR_LENGTH 0.05
#define SHEAR_AREA (SHEAR_LENGTH * 0.01)
#define SHEAR_THICKNESS 1e-3
#define SHEAR_LAYER(poled) "layers=[{name: strip, material: ceramic, thickness: 1e-3, " poled "}];"

/*
 * Law: a voltage across a strip that is poled along its length shears it, and the tip of a
 * cantilever moves by -d15 V L/h, on any mesh, with any element, along either axis of the layer and
 * with either sign of the poling; the free charge is that of the permittivity at constant stress.
 */
static void test_shear_bender(void **state)
{
    (void)state;
    static const char *const element[] = {PUBLISHED, IMPROVED, "element={shear: equilibrium};",
                                          "element={rho: 0};"};
    static const char *const layer[] = {
        "", SHEAR_LAYER("poling: -1, angle: 180") "mesh.theta1.elements=1;",
        SHEAR_LAYER("poling: -2, angle: 90") "mesh.theta1.elements=4;"};
    const double modulus = 60e9 / 2.6, volt = 100;
    for (size_t e = 0; e < sizeof element / sizeof *element; e++)
        for (size_t k = 0; k < sizeof layer / sizeof *layer; k++) {
            scene_run r;
            solve_run(&r, "shear-bender", with(element[e], layer[k]));
            assert_near("tip", scene_run_value(&r, 0),
                        -SHEAR_D15 * volt / SHEAR_THICKNESS * SHEAR_LENGTH, 1e-10);
            assert_near("charge", scene_run_value(&r, 2),
                        (15e-9 + SHEAR_D15 * SHEAR_D15 * modulus) * volt * SHEAR_AREA /
                            SHEAR_THICKNESS,
                        1e-10);
            scene_run_close(&r);
        }
}

#define FINGERS                                                                                    \
    "layers.strip.finger_distance=0.5e-3;"                                                         \
    "supports=[{at: {theta1: 0, theta2: 0}, fix: [u1 mean, u2 mean, u3 mean, u1 difference, u2 "   \
    "difference]}, {at: {theta1: 0, theta2: 0.01}, fix: [u1 mean]}];"

/*
 * Law: with interdigitated electrodes at the distance p a free strip elongates by -d33 V L/p, and
 * its electrodes, whose area is the thickness over p times that of the surface, have the charge of
 * the permittivity at constant stress.
 */
static void test_fingers(void **state)
{
    (void)state;
    const double d31 = -270e-12, d33 = 590e-12, young = 60e9, nu = 0.3, volt = 100, p = 0.5e-3;
    const double lame = young * nu / (1 + nu) / (1 - 2 * nu), shear = young / (2 * (1 + nu));
    const double sum = 2 * d31 + d33,
                 permittivity = 13e-9 + lame * sum * sum + 2 * shear * (2 * d31 * d31 + d33 * d33);
    for (int e = 0; e < 3; e++) {
        scene_run r;
        solve_run(&r, "shear-bender", with(elements[e], FINGERS));
        assert_near("elongation", scene_run_value(&r, 1), -d33 * volt / p * SHEAR_LENGTH, 1e-10);
        assert_near("charge", scene_run_value(&r, 2),
                    permittivity * volt / p * SHEAR_AREA * SHEAR_THICKNESS / p, 1e-10);
        scene_run_close(&r);
    }
}

/*
 * Law: a field across the poling depolarises nothing; that of interdigitated electrodes is along
 * the poling and limits the voltage to the depolarisation field times their distance.
 */
static void test_limits_along_the_surface(void **state)
{
    (void)state;
    static const char *const changes[2] = {
        "materials.ceramic.field_limit=4e5;",
        "materials.ceramic.field_limit=4e5;layers.strip.finger_distance=0.5e-3;"};
    const double expected[2] = {HUGE_VAL, 4e5 * 0.5e-3};
    for (int k = 0; k < 2; k++) {
        scene_run r;
        open_run(&r, "shear-bender", changes[k]);
        const scene_drive *drive = &r.scene.actuator[0].drive[0];
        assert_true(design_depolarising_voltage(&r.scene, drive) == expected[k]);
        scene_run_close(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sensor_volts),    cmocka_unit_test(test_sensor_order),
        cmocka_unit_test(test_circuits),        cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_sensor_row),      cmocka_unit_test(test_energy),
        cmocka_unit_test(test_capacitance),     cmocka_unit_test(test_capacitance_in_a_package),
        cmocka_unit_test(test_coupling),        cmocka_unit_test(test_open_influence),
        cmocka_unit_test(test_pyroelectricity), cmocka_unit_test(test_linear_limit),
        cmocka_unit_test(test_open_systems),    cmocka_unit_test(test_energy_at_a_shape),
        cmocka_unit_test(test_refusals),        cmocka_unit_test(test_shear_bender),
        cmocka_unit_test(test_fingers),         cmocka_unit_test(test_limits_along_the_surface),
    };
    return cmocka_run_group_tests_name("electric", tests, NULL, NULL);
}
