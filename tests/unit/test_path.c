/*
 * Laws of the nonlinear path: the way, rigid motion, reactions, contact, actuation, influence.
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
#include "../../lib/model/model.h"
#include "../rigs/mode_stiffness.h"
#include "../rigs/path_run.h"
#include "../../lib/model/shell.h"

/* ---- follower pressures and closed forms ------------------------------ */

/* Law: a clamped quarter of a thin ring under a small pressure p opens by p R^4/(2 E I), to second
 * order in its sides. */
static void test_pressed_arc(void **state)
{
    (void)state;
    for (int n = 3; n <= 48; n *= 2) {
        const double side = acos(-1.0) / 2 / n, exact = 1e-4 * 1e8 / 2 / (2.1e7 / (12 * 0.91));
        char changes[512];
        scene_run r;
        snprintf(
            changes, sizeof changes,
            IMPROVED
            "equilibrium.tolerance=1e-9;mesh.theta1.elements=%d;supports=[{edge: theta1-, fix: "
            "clamped}, "
            "{at: nodes, fix: u2}];loads=[{face: inner, pressure: 1e-4, follower: normal}]",
            n);
        solve_run(&r, "ring-follower", changes);
        assert_true(fabs(scene_run_value(&r, 1) / exact - 1) < side * side / 10 + 1e-4);
        scene_run_close(&r);
    }
}

enum { MOST_SIDES = 14 };

/*
 * Displacements over the even one at both ends of a quarter of a ring of chords, less 1. In the
 * stretched ring acts the moment -B e/R, with the bending stiffness B and the strain e, because the
 * stress falls as 1/(R + z). Chords of half angles x turn by cos x: the moment becomes
 * -B e/R (1 - x^2/2), and the ring bends by the curvature (x^2/2 less its mean) e/R. The normal
 * displacement w of an inextensible ring follows from w'' + w = -R^2 times the curvature, with
 * w' = 0 at both ends.
 */
static void bend_by_chords(const double *angle, int sides, double end[2])
{
    const double quarter = angle[sides];
    double mean = 0;
    end[0] = end[1] = 0;
    for (int i = 0; i < sides; i++)
        mean += pow(angle[i + 1] - angle[i], 3) / 8 / quarter;
    for (int i = 0; i < sides; i++) {
        const double side = angle[i + 1] - angle[i], excess = side * side / 8 - mean;
        end[0] += excess * (cos(angle[i]) - cos(angle[i + 1]));
        end[1] += excess * (sin(angle[i + 1]) - sin(angle[i]));
    }
}

/*
 * Law: a ring under a pressure on its middle widens by p R^2 (1 - nu^2)/(E h) everywhere, to second
 * order in its sides, however uneven they are; R/h = 100 makes it 10,000 times as soft in bending.
 * In the improved element the error is that of the bending moment in a ring of chords, within 1 %
 * of the largest change x^2/2 of this moment.
 */
static void test_uneven_ring_inflates_evenly(void **state)
{
    (void)state;
    const double quarter = acos(0.0);
    const struct {
        const char *points;
        double side, angle[MOST_SIDES + 1];
        int sides;
    } mesh[] = {
        {"[0, 0.1, 0.5, 1.1, pi/2]", 0.6, {0, 0.1, 0.5, 1.1, quarter}, 4},
        {"[0, 0.05, 0.1, 0.2, 0.25, 0.4, 0.5, 0.6, 0.7, 0.8, 1, 1.1, 1.3, 1.4, pi/2]",
         0.2,
         {0, 0.05, 0.1, 0.2, 0.25, 0.4, 0.5, 0.6, 0.7, 0.8, 1, 1.1, 1.3, 1.4, quarter},
         14},
    };
    static const char *const way[] = {
        IMPROVED "loads=[{face: middle, pressure: 0.01, follower: normal}]",
        IMPROVED "loads=[{face: middle, pressure: 0.01}]",
        IMPROVED "kinematics=linear;loads=[{face: middle, pressure: 0.01}]",
        PUBLISHED "kinematics=linear;loads=[{face: middle, pressure: 0.01}]",
    };
    for (size_t i = 0; i < COUNT(mesh) * COUNT(way); i++) {
        const double side = mesh[i / COUNT(way)].side;
        const bool is_published = i % COUNT(way) == COUNT(way) - 1;
        double bent[2];
        char changes[512];
        scene_run r;
        snprintf(changes, sizeof changes, "equilibrium.tolerance=1e-9;mesh.theta1={points: %s};%s",
                 mesh[i / COUNT(way)].points, way[i % COUNT(way)]);
        solve_run(&r, "ring-follower", changes);
        bend_by_chords(mesh[i / COUNT(way)].angle, mesh[i / COUNT(way)].sides, bent);
        for (int k = 0; k < 2; k++) {
            const double error = scene_run_value(&r, k) / (0.01 * 1e4 * 0.91 / 2.1e7) - 1;
            print_message("ring of %d sides, %s: error %.5f, of chords %.5f\n",
                          mesh[i / COUNT(way)].sides, way[i % COUNT(way)], error, bent[k]);
            if (is_published)
                assert_true(fabs(error) < side * side / 100);
            else
                assert_true(fabs(error - bent[k]) < 0.01 * side * side / 8);
        }
        scene_run_close(&r);
    }
}

/* ---- the way does not matter, and what one step may miss -------------- */

/* Law: 1, 2, 5 and 10 load steps end in one state, stable, where the improved element is used. */
static void test_steps_agree(void **state)
{
    (void)state;
    static const char *const steps[] = {"2", "5", "10"};
    scene_run one;
    solve_run(&one, "annular-plate", IMPROVED MESH(4, 8) "equilibrium={tolerance: 1e-8};");
    for (size_t i = 0; i < COUNT(steps); i++) {
        char changes[256];
        snprintf(changes, sizeof changes,
                 IMPROVED MESH(4, 8) "equilibrium={tolerance: 1e-8, load_steps: %s}", steps[i]);
        scene_run r;
        solve_run(&r, "annular-plate", changes);
        assert_int_equal(path_of(&r)->info.negative_pivots, 0);
        assert_true(apart(r.u, one.u, dof_of(&one)) < 1e-7);
        scene_run_close(&r);
    }
    scene_run_close(&one);
}

/*
 * Law: meshes on which the mixed iterates lead astray settle all the same; the plain Newton method
 * reaches the same shape in no fewer load steps.
 */
static void test_astray_meshes(void **state)
{
    (void)state;
    static const char *const mesh[] = {MESH(4, 16), MESH(8, 16), MESH(32, 16)};
    for (size_t i = 0; i < COUNT(mesh); i++) {
        char changes[256];
        snprintf(changes, sizeof changes,
                 PUBLISHED "%sequilibrium={linear_solves: 1000, tolerance: 1e-7}", mesh[i]);
        scene_run mixed;
        solve_run(&mixed, "annular-plate", changes);
        snprintf(changes, sizeof changes,
                 PUBLISHED
                 "%sequilibrium={linear_solves: 1000, tolerance: 1e-7, extrapolated_iterations: 0}",
                 mesh[i]);
        scene_run plain;
        solve_run(&plain, "annular-plate", changes);
        print_message("annular plate %s: mixed %u steps %u systems, plain %u steps %u systems\n",
                      mesh[i], path_of(&mixed)->info.load_steps,
                      path_of(&mixed)->info.linear_solves, path_of(&plain)->info.load_steps,
                      path_of(&plain)->info.linear_solves);
        assert_int_equal(mixed.analysis.status, PZS_OK);
        assert_true(path_of(&mixed)->info.load_steps < path_of(&plain)->info.load_steps);
        assert_true(apart(mixed.u, plain.u, dof_of(&plain)) < 1e-5);
        scene_run_close(&mixed);
        scene_run_close(&plain);
    }
}

/* Law: with extrapolated resultants the hemisphere settles in one load step, the plain Newton
 * method needs more. */
static void test_mixed_beats_plain(void **state)
{
    (void)state;
    scene_run mixed;
    solve_run(&mixed, "hemisphere", PUBLISHED MESH(4, 4));
    scene_run plain;
    solve_run(&plain, "hemisphere",
              PUBLISHED MESH(4, 4) "equilibrium={extrapolated_iterations: 0}");
    assert_int_equal(path_of(&mixed)->info.load_steps, 1);
    assert_true(path_of(&plain)->info.load_steps > 1);
    assert_true(path_of(&plain)->info.linear_solves > path_of(&mixed)->info.linear_solves);
    assert_true(apart(mixed.u, plain.u, dof_of(&plain)) < 1e-4);
    scene_run_close(&mixed);
    scene_run_close(&plain);
}

/* ---- rigid motion ----------------------------------------------------- */

/* Twice the strain energy at u, from strains (*linear: from strains of first order alone). */
static double energy(const scene_run *r, const double *u, int linear)
{
    const pzs_structure *structure = &r->analysis.design.structure;
    double sum = 0;
    for (uint32_t e = 0; e < structure->elements; e++) {
        const pzs_element_type *type = &structure->type[structure->element_type[e]];
        double v[SHELL_MAX], f[SHELL_MAX], strain[4][10];
        pzs_model_gather(&r->analysis.model, structure->element[e], SHELL_NODES, u, v);
        pzs_shell_force(type, structure->dof_per_node, v, f);
        for (unsigned i = 0; linear && i < SHELL_NODES * structure->dof_per_node; i++)
            sum += v[i] * f[i];
        pzs_shell_strains_at(type, structure->dof_per_node, v, strain);
        for (int m = 0; !linear && m < 4; m++)
            for (int i = 0; i < 10; i++)
                for (int j = 0; j < 10; j++)
                    sum += strain[m][i] * strain[m][j] * mode_stiffness(type, m, i, j);
    }
    return sum;
}

/* Law: an improved shell follows a finite turn of one edge as a rigid body, without strain energy,
 * whatever the modulus of its material is in the units of the scene. */
static void test_rigid_motion(void **state)
{
    (void)state;
    static const char *const changes[] = {IMPROVED, METRIC_OFF, "materials.m.E=1e-6",
                                          "materials.m.E=2e11", "materials.m.E=1e15"};
    for (size_t k = 0; k < COUNT(changes); k++) {
        scene_run r;
        solve_run(&r, "tests/rigs/scenes/rigid.yaml", changes[k]);
        const design *design = &r.analysis.design;
        for (int n = 0; n < design->mesh.nodes; n++) {
            const double *x = design->mesh.point[n].position,
                         want[3] = {0, x[1] * (cos(0.6) - 1) - x[2] * sin(0.6),
                                    x[1] * sin(0.6) + x[2] * (cos(0.6) - 1)};
            for (int i = 0; i < 3; i++)
                assert_true(fabs(r.output[design->named_first[i] + n] - want[i]) < 1e-11 * 10);
        }
        const double part = energy(&r, r.u, 0) / energy(&r, r.u, 1);
        print_message("rigid turn: %.1e of the energy of the strains of first order\n", part);
        assert_true(part < 1e-20);
        scene_run_close(&r);
    }
}

/* Law: in local components a turned mesh costs energy, which falls with the fourth power of the
 * element size. */
static void test_rigid_motion_of_the_source(void **state)
{
    (void)state;
    double cost[2];
    for (int k = 0; k < 2; k++) {
        char changes[128];
        snprintf(changes, sizeof changes,
                 PUBLISHED "mesh.theta1.elements=%d;mesh.theta2.elements=%d", 8 << k, 8 << k);
        scene_run r;
        solve_run(&r, "tests/rigs/scenes/rigid.yaml", changes);
        cost[k] = energy(&r, r.u, 0);
        scene_run_close(&r);
    }
    print_message("energy of a turned mesh falls by %.3g\n", cost[0] / cost[1]);
    assert_true(cost[0] / cost[1] > 12 && cost[0] / cost[1] < 20);
}

/* ---- prescribed displacements ----------------------------------------- */

/* Internal force at u. f [dof] out */
static void internal_force(const scene_run *r, const double *u, double *f)
{
    const pzs_structure *structure = &r->analysis.design.structure;
    memset(f, 0, structure->free_dof * sizeof *f);
    for (uint32_t e = 0; e < structure->elements; e++) {
        double v[SHELL_MAX], own[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)];
        pzs_model_gather(&r->analysis.model, structure->element[e], SHELL_NODES, u, v);
        pzs_shell_system(&structure->type[structure->element_type[e]], structure->dof_per_node, v,
                         NULL, NULL, own, k);
        pzs_model_scatter(&r->analysis.model, structure->element[e], SHELL_NODES, 1, own, f);
    }
}

/* Law: a strip moved to a place has the shape it has under the force that holds it there, which is
 * its reaction. */
static void test_prescribed_and_reaction(void **state)
{
    (void)state;
    static const char *const element[] = {PUBLISHED, IMPROVED};
    for (size_t k = 0; k < COUNT(element); k++) {
        char changes[256];
        char mesh[128];
        scene_run force;
        snprintf(mesh, sizeof mesh, "%s", element[k]);
        solve_run(&force, "tests/rigs/scenes/strip.yaml", mesh);
        assert_true(scene_run_value(&force, 0) > 5);
        snprintf(changes, sizeof changes,
                 "%sloads.0.u3=0;supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 "
                 "mean, value: %.17g}]",
                 mesh, scene_run_value(&force, 0));
        scene_run moved;
        open_run(&moved, "tests/rigs/scenes/strip.yaml", changes);
        const size_t n = dof_of(&moved);
        assert_int_equal(n, dof_of(&force));
        assert_int_equal(scene_run_solve(&moved), 0);
        assert_int_equal(path_of(&moved)->info.load_steps, 1);
        double *f = calloc(n, sizeof *f), reaction = 0;
        internal_force(&moved, moved.u, f);
        for (int i = 0; i < moved.analysis.design.mesh.prescribed_count; i++)
            reaction += f[moved.analysis.design.mesh.prescribed_dof[i]];
        assert_true(fabs(reaction / 2.5 - 1) < 1e-7);
        assert_true(apart(moved.u, force.u, n) < 1e-7);
        free(f);
        scene_run_close(&force);
        scene_run_close(&moved);
    }
}

/* ---- contact ---------------------------------------------------------- */

/* Law: the improved element passes the whole force on to the base (the half of a ring's, a quarter
 * of a cylinder's). */
static void test_contact_resultant(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *changes;
        int output;
        double force;
    } cases[] = {
        {"ring-contact", IMPROVED MESH(30, 1), 1, -88.5 * 2.1e7 / (120 * 1e4) / 2},
        {"ring-contact", METRIC_OFF MESH(30, 1) BASE_100, 1, -88.5 * 2.1e7 / (120 * 1e4) / 2},
        {"cylinder-contact", IMPROVED "equilibrium={tolerance: 1e-6};", 2,
         -87.5 * 2.1e7 * 200 / (120 * .91 * 1e4) / 4},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        scene_run r;
        solve_run(&r, cases[i].scene, cases[i].changes);
        const double got = scene_run_value(&r, cases[i].output);
        if (!(fabs(got / cases[i].force - 1) < 1e-6))
            fail_msg("%s %s: %.9g of %.9g", cases[i].scene, cases[i].changes, got, cases[i].force);
        scene_run_close(&r);
    }
}

/* Law: facets that lie on a drum sag into it by (length)^2 / (8 R), which is a quarter on twice
 * the elements. */
static void test_contact_sag(void **state)
{
    (void)state;
    for (int elements = 30; elements <= 60; elements += 30) {
        const double length = acos(-1.0) * 100 / elements;
        char changes[64];
        scene_run r;
        snprintf(changes, sizeof changes, PUBLISHED "mesh.theta1.elements=%d;", elements);
        solve_run(&r, "ring-contact", changes);
        assert_true(fabs(r.analysis.equilibrium.contact.info.sag / (length * length / 8000) - 1) <
                    5e-3);
        assert_int_equal(r.analysis.equilibrium.contact.info.penetration, 0);
        scene_run_close(&r);
    }
}

/* Law: the state does not depend on the stiffness of contact. */
static void test_contact_stiffness(void **state)
{
    (void)state;
    static const char *const element[] = {PUBLISHED, IMPROVED};
    static const char *const stiffness[] = {"1e-3", "1e-2", "0.1", "1", "100", "1e3", "1e4"};
    for (size_t e = 0; e < COUNT(element); e++) {
        char changes[256];
        scene_run ten;
        snprintf(changes, sizeof changes, "%sequilibrium.tolerance=1e-8;" BASE_100, element[e]);
        solve_run(&ten, "ring-contact", changes);
        for (size_t k = 0; k < COUNT(stiffness); k++) {
            scene_run r;
            snprintf(changes, sizeof changes,
                     "%sequilibrium.tolerance=1e-8;" BASE_100 "contact.stiffness=%s", element[e],
                     stiffness[k]);
            solve_run(&r, "ring-contact", changes);
            if (!(apart(r.u, ten.u, dof_of(&ten)) < 1e-6))
                fail_msg("%s: shapes apart by %.2g, %u systems", changes,
                         apart(r.u, ten.u, dof_of(&ten)), path_of(&r)->info.linear_solves);
            scene_run_close(&r);
        }
        scene_run_close(&ten);
    }
}

/* Law: on rubber and cord, whose skin is soft and whose bending is softer, neither. */
static void test_contact_stiffness_of_rubber(void **state)
{
    (void)state;
    static const char *const stiffness[] = {"1e-3", "0.1", "1", "10", "1e3"};
    scene_run hundred;
    solve_run(&hundred, "torus-contact",
              PUBLISHED TORUS_36 MESH(24, 18) "equilibrium={tolerance: 1e-8};");
    for (size_t k = 0; k < COUNT(stiffness); k++) {
        char changes[256];
        scene_run r;
        snprintf(
            changes, sizeof changes,
            PUBLISHED TORUS_36 MESH(24, 18) "equilibrium={tolerance: 1e-8};contact.stiffness=%s",
            stiffness[k]);
        solve_run(&r, "torus-contact", changes);
        assert_int_equal(path_of(&r)->info.load_steps, 1);
        assert_true(apart(r.u, hundred.u, dof_of(&r)) < 1e-6);
        scene_run_close(&r);
    }
    scene_run_close(&hundred);
}

/* Law: a body is where its formula is zero, whatever the formula's scale and slope. */
static void test_body_by_formula(void **state)
{
    (void)state;
    static const char *const formula[] = {"sqrt((x-200.5)^2+y^2)-100", "(x-200.5)^2+y^2-1e4",
                                          "1e-6*((x-200.5)^2+y^2)^2-1e2"};
    scene_run body;
    solve_run(&body, "ring-contact", IMPROVED "equilibrium.tolerance=1e-8;" BASE_100);
    for (size_t i = 0; i < COUNT(formula); i++) {
        char changes[256];
        scene_run r;
        snprintf(changes, sizeof changes,
                 IMPROVED "equilibrium.tolerance=1e-8;contact.body={type: psi, value: %s}",
                 formula[i]);
        solve_run(&r, "ring-contact", changes);
        assert_true(apart(r.u, body.u, dof_of(&r)) < 1e-6);
        scene_run_close(&r);
    }
    scene_run_close(&body);
}

/* ---- loads that rise over the first solves ---- */

/*
 * Law: the equilibrium does not depend on how the loads of a load step rise; the number of linear
 * solves does. Half of the load in the first solve saves two of eleven on the slit annular plate;
 * loads that rise over six solves take the soft hyperboloid through in one load step.
 */
static void test_ramp(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *changes;
        int ramp;
        uint32_t most; /* largest number of linear solves with the ramp, in one load step */
    } cases[] = {
        {"annular-plate", IMPROVED, 2, 9},
        {"hyperboloid-soft", IMPROVED "mesh.theta1.elements=16;mesh.theta2.elements=16;", 6, 23},
        {"roll-up", "", 3, 12},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        char changes[256];
        scene_run r[2];
        for (int k = 0; k < 2; k++) {
            snprintf(changes, sizeof changes,
                     "%sequilibrium={load_steps: %d, ramp_solves: %d, tolerance: %s}",
                     cases[i].changes, k ? 1 : 1 + (i == 1), k ? cases[i].ramp : 1,
                     i == 1 ? "1e-5" : "1e-4");
            solve_run(&r[k], cases[i].scene, changes);
        }
        assert_int_equal(r[1].analysis.equilibrium.solver.info.load_steps, 1);
        print_message("%s: %u linear solves, %.2e apart\n", cases[i].scene,
                      (unsigned)r[1].analysis.equilibrium.solver.info.linear_solves,
                      apart(r[0].u, r[1].u, dof_of(&r[0])));
        assert_true(r[1].analysis.equilibrium.solver.info.linear_solves <= cases[i].most);
        assert_true(apart(r[0].u, r[1].u, dof_of(&r[0])) < 1e-4);
        scene_run_close(&r[0]);
        scene_run_close(&r[1]);
    }
}

/* ---- squared height ---- */

/*
 * Law: a strip of thickness h that its voltage rolls up to the curvature K = r,1 . d,1 (r: place,
 * d: director) without a membrane force stretches by the factor l with l^2 = 1 - a (K/l)^2. a
 * replaces the squared height: h^2/12 where it is fitted, h^2/4 where it is taken at the faces, 0
 * where it is omitted. Each of n elements is a chord of l L, between directors at the angle phi
 * with 2 sin(phi/2) = L K/l.
 */
static void test_squared_height(void **state)
{
    (void)state;
    enum { ELEMENTS = 20 };
    static const struct {
        const char *option;
        double part; /* of h^2 */
    } rows[] = {{"on", 1. / 12}, {"off", 1. / 4}, {"omitted", 0}};
    const double bend = acos(-1.0) / 10, thickness = 1, length = 10. / ELEMENTS;
    for (size_t i = 0; i < COUNT(rows); i++) {
        char changes[300];
        scene_run r;
        snprintf(changes, sizeof changes,
                 "mesh.theta1.elements=%d;layers.0.thickness=0.5;layers.1.thickness=0.5;"
                 "actuators.v.applied=4*0.5^2*(pi/10)/(3*1e-6);equilibrium={tolerance: 1e-10};"
                 "element={quadratic: %s}",
                 ELEMENTS, rows[i].option);
        solve_run(&r, "roll-up", changes);
        const double a = rows[i].part * thickness * thickness,
                     stretch = sqrt(0.5 + sqrt(0.25 - a * bend * bend)),
                     phi = 2 * asin(length * bend / stretch / 2), half = ELEMENTS * phi / 2,
                     rise = stretch * length * sin(half) * sin(half) / sin(phi / 2);
        print_message("quadratic: %s: tip rises by %.9f, expected %.9f\n", rows[i].option,
                      scene_run_value(&r, 1), rise);
        assert_true(fabs(scene_run_value(&r, 1) / rise - 1) < 1e-9);
        scene_run_close(&r);
    }
}

/* ---- linear or not ---------------------------------------------------- */

/* Law: kinematics auto takes the linear displacement where it is within the scene's tolerance of
 * the other, which it takes if not. */
static void test_auto(void **state)
{
    (void)state;
    static const struct {
        const char *changes, *known;
        int nonlinear;
    } cases[] = {
        {"kinematics=auto;loads.0.u3=0.01;", "kinematics=linear;dof_per_node=6;loads.0.u3=0.01;",
         0},
        {"kinematics=auto;loads.0.u3=0.01;tolerance=1e-6;", "loads.0.u3=0.01;", 1},
        {"kinematics=auto;", "", 1},
        {"kinematics=auto;tolerance=0.9;loads.0.u3=0.2;",
         "kinematics=linear;dof_per_node=6;loads.0.u3=0.2;", 0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        scene_run r, known;
        solve_run(&r, "tests/rigs/scenes/strip.yaml", cases[i].changes);
        solve_run(&known, "tests/rigs/scenes/strip.yaml", cases[i].known);
        assert_int_equal(r.analysis.is_nonlinear, cases[i].nonlinear);
        assert_int_equal(r.analysis.linear_error > r.scene.tolerance, cases[i].nonlinear);
        assert_true(apart(r.u, known.u, dof_of(&r)) == 0);
        scene_run_close(&r);
        scene_run_close(&known);
    }
}

/*
 * Law: a node has six dof where the seventh carries nothing and may lose its stiffness, which is
 * under nonlinear kinematics with the improved element; seven where the scene asks for them.
 */
static void test_default_dof(void **state)
{
    (void)state;
    static const struct {
        const char *changes;
        int dof_per_node;
    } cases[] = {
        {"", 6},
        {"kinematics=auto", 6},
        {"kinematics=linear", 7},
        {"dof_per_node=7", 7},
        {"element=published", 7},
        {"element={lin33: off}", 7},
        {"supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3}]", 6},
        {"supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3M, value: 1e-3}]", 7},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        scene_run r;
        open_run(&r, "tests/rigs/scenes/strip.yaml", cases[i].changes);
        assert_int_equal(r.analysis.design.mesh.dof_per_node, cases[i].dof_per_node);
        scene_run_close(&r);
    }
}

/* ---- actuation -------------------------------------------------------- */

/* Tip x of a strip in plane strain, whose free curvature 3 d31 V (1 + nu)/(4 t^2) makes
 * `half_turns`, on 40 elements; -10 on many. */
static double tip_of_strip(const char *element, int half_turns, const char *nu)
{
    char changes[512];
    scene_run r;
    snprintf(changes, sizeof changes,
             "%sactuators.v.applied=4*0.05^2*(%d*pi/10)/(3*1e-6*(1+%s));supports=[{edge: theta1-, "
             "fix: clamped}, "
             "{at: nodes, fix: u2}];materials.piezo={E: 1e6, nu: %s, d31: 1e-6, d32: 1e-6}",
             element, half_turns, nu, nu);
    solve_run(&r, "roll-up", changes);
    const double tip = scene_run_value(&r, 0);
    const uint32_t steps = path_of(&r)->info.load_steps;
    scene_run_close(&r);
    assert_true(element[8] == 's' || steps == 1);
    return tip;
}

/*
 * Tip x of a strip of length 10 and thickness h = 0.1 that rolls up freely. Its mean strain in the
 * sense of the element is 0, so that the middle surface shortens to 1 - a k^2/2 of its length with
 * the curvature k, where a is the constant that replaces the squared height; the difference of the
 * strains of both faces is h times the stretch of the middle times the angle per length.
 */
static double rolled_tip(int half_turns, double a)
{
    const double curvature = half_turns * acos(-1.0) / 10,
                 stretch = 1 - a * curvature * curvature / 2;
    return stretch * stretch * sin(10 * curvature / stretch) / curvature - 10;
}

/*
 * Law: the improved strip rolls up to half and full circles alike for every nu, in one load step;
 * the published element, whose middle surface shortens three times as much, is stiff in thickness
 * where its normal has turned.
 */
static void test_thickness_locking(void **state)
{
    (void)state;
    static const char *const nu[] = {"0.3", "0.45", "0.499"};
    for (int half_turns = 1; half_turns <= 2; half_turns++) {
        const double want = tip_of_strip(IMPROVED, half_turns, "0");
        const double longer = rolled_tip(half_turns, 0.01 / 4) - rolled_tip(half_turns, 0.01 / 12);
        const double published = tip_of_strip(PUBLISHED, half_turns, "0");
        print_message("%d half turns: published %.6f, improved %.6f, longer by %.6f\n", half_turns,
                      published, want, longer);
        assert_true(fabs(published - want - longer) < 0.02 * fabs(longer));
        for (size_t i = 0; i < COUNT(nu); i++)
            assert_true(fabs(tip_of_strip(IMPROVED, half_turns, nu[i]) / want - 1) < 1e-4);
        assert_true(fabs(tip_of_strip(PUBLISHED, half_turns, "0.3") / want - 1) > 3e-3);
    }
    assert_true(fabs(tip_of_strip(PUBLISHED, 2, "0.45") / tip_of_strip(IMPROVED, 2, "0") - 1) >
                0.05);
}

/* Law: at rest the force of an input's given resultants is its column of the linear structure. */
static void test_given_force_at_rest(void **state)
{
    (void)state;
    static const char *const element[] = {PUBLISHED, IMPROVED, IMPROVED "dof_per_node=6;"};
    for (size_t k = 0; k < COUNT(element); k++) {
        char changes[128];
        scene_run r;
        snprintf(changes, sizeof changes, "%skinematics=nonlinear", element[k]);
        open_run(&r, "plate-50-patches", changes);
        const pzs_structure *structure = &r.analysis.design.structure;
        const pzs_prescribed_resultants *g = &r.analysis.equilibrium.tables.resultants;
        double *f = calloc(structure->free_dof, sizeof *f),
               *column = calloc(structure->free_dof, sizeof *f), zero[SHELL_MAX] = {0};
        for (uint32_t j = 0; j < 25; j++) {
            memset(f, 0, structure->free_dof * sizeof *f);
            memset(column, 0, structure->free_dof * sizeof *f);
            pzs_model_add_input(&r.analysis.model, j, 1, column);
            assert_true(g->start[j + 1] > g->start[j]);
            for (uint32_t t = g->start[j]; t < g->start[j + 1]; t++) {
                double own[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
                memcpy(resultant, g->value[g->which[t]], sizeof *g->value);
                pzs_shell_force_at(&structure->type[structure->element_type[g->element[t]]],
                                   structure->dof_per_node, zero, resultant, own);
                pzs_model_scatter(&r.analysis.model, structure->element[g->element[t]], SHELL_NODES,
                                  -1, own, f);
            }
            assert_true(apart(f, column, structure->free_dof) < 1e-12);
        }
        free(f);
        free(column);
        scene_run_close(&r);
    }
}

/* ---- influence -------------------------------------------------------- */

/* Rows of the outputs at an equilibrium with input j changed by d, from that at the scene's
 * amounts. y [outputs] out */
static void outputs_beside(scene_run *r, uint32_t j, double d, double *y)
{
    pzs_solver *solver = path_of(r);
    double *amount = r->analysis.equilibrium.full_input;
    const double kept = amount[j];
    amount[j] += d;
    const pzs_status status = pzs_equilibrium(solver, amount);
    if (PZS_IS_ERROR(status))
        fail_msg("beside the equilibrium: %s", pzs_status_text(status));
    pzs_observe(&r->analysis.design.structure, solver->info.displacement, y);
    amount[j] = kept;
}

/* Central difference of the outputs by input j. y [outputs] out */
static void difference(scene_run *r, uint32_t j, double d, double *y)
{
    const size_t outputs = r->analysis.design.structure.output.count;
    double *minus = calloc(outputs, sizeof *minus);
    outputs_beside(r, j, d, y);
    outputs_beside(r, j, -d, minus);
    for (size_t i = 0; i < outputs; i++)
        y[i] = (y[i] - minus[i]) / (2 * d);
    free(minus);
}

typedef struct influence_case {
    const char *scene, *changes;
    double part; /* of an amount, the larger of the two differences */
} influence_case;

#define PLACES "outputs=[{name: x, x: middle, at: nodes}, {name: z, z: middle, at: nodes}];"
#define TIGHT "equilibrium={tolerance: 1e-12};"

static const influence_case influences[] = {
    {"roll-up",
     PUBLISHED PLACES TIGHT HALF_TURN
     "loads=[{line: theta1+, u3: 0.02}, {temperature: 100}];"
     "materials.piezo={E: 1e6, nu: 0.3, d31: 1e-6, d32: 1e-6, alpha: 1e-5}",
     2e-3},
    {"roll-up",
     IMPROVED PLACES TIGHT HALF_TURN
     "loads=[{line: theta1+, u3: 0.02}, {temperature: 100}];"
     "materials.piezo={E: 1e6, nu: 0.3, d31: 1e-6, d32: 1e-6, alpha: 1e-5}",
     2e-3},
    {"tests/rigs/scenes/strip.yaml",
     IMPROVED PLACES TIGHT "loads.0.u3=0.5;supports=[{edge: theta1-, fix: clamped}, {edge: "
                           "theta1+, fix: u3 mean, value: 5}]",
     2e-3},
    {"ring-contact",
     IMPROVED PLACES "equilibrium.tolerance=1e-12;" BASE_100 "contact.move=[-1, 0, 0]", 1e-3},
};

/*
 * Law: the influence at an equilibrium is the derivative of equilibria. With D(d) the central
 * difference over d, of error c d^2, D(d/2) is off by |D(d) - D(d/2)| / 3; three times that, and
 * the rounding of equilibria settled to 1e-12, are allowed.
 */
static void check_influence(const influence_case *c)
{
    scene_run r;
    solve_run(&r, c->scene, c->changes);
    const pzs_structure *structure = &r.analysis.design.structure;
    const size_t rows = structure->output.count, inputs = structure->input.count;
    double *influence = calloc(rows * inputs, sizeof *influence),
           *coarse = calloc(rows, sizeof *coarse), *fine = calloc(rows, sizeof *fine);
    assert_int_equal(pzs_influence_at(path_of(&r), influence), PZS_OK);
    for (uint32_t j = 0; j < (uint32_t)r.analysis.design.sensor_first; j++) {
        const double d =
            c->part *
            (r.analysis.equilibrium.full_input[j] != 0 ? r.analysis.equilibrium.full_input[j] : 1);
        difference(&r, j, d, coarse);
        difference(&r, j, d / 2, fine);
        const double scale = largest(fine, rows),
                     rounding = 1e-9 * largest(r.output, rows) / fabs(d);
        double off = 0, allowed = rounding;
        for (size_t i = 0; i < rows; i++) {
            off = fmax(off, fabs(influence[i * inputs + j] - fine[i]));
            allowed = fmax(allowed, fabs(coarse[i] - fine[i]));
        }
        if (!(off <= allowed && allowed < 1e-3 * scale + rounding))
            fail_msg("%s input %u: influence off by %.3g of %.3g, %.3g allowed", c->scene, j, off,
                     scale, allowed);
    }
    free(influence);
    free(coarse);
    free(fine);
    scene_run_close(&r);
}

static void test_influence(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++)
        check_influence(&influences[i]);
}

static void test_influence_of_prescribed(void **state)
{
    (void)state;
    check_influence(&influences[2]);
}

/*
 * Cantilevers under pressures that turn with them, whose tangent is not symmetric: volts, dead
 * loads, prescribed edges, both kinds of pressure, open electrodes; an arc that the pressure opens.
 */
static const influence_case followers[] = {
    {"roll-up",
     PUBLISHED PLACES TIGHT HALF_TURN
     "loads=[{line: theta1+, u3: 0.02}, {face: inner, pressure: 0.2, follower: normal}]",
     5e-4},
    {"roll-up",
     IMPROVED PLACES TIGHT HALF_TURN
     "loads=[{line: theta1+, u3: 0.02}, {face: inner, pressure: 0.2, follower: normal}]",
     5e-4},
    {"roll-up",
     IMPROVED PLACES TIGHT HALF_TURN "loads=[{face: outer, pressure: -0.2, follower: pressure}]",
     5e-4},
    {"tests/rigs/scenes/strip.yaml",
     IMPROVED PLACES TIGHT
     "loads=[{face: inner, pressure: 0.5, follower: normal}];"
     "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 mean, value: 2}]",
     2e-3},
    {"ring-follower",
     IMPROVED PLACES TIGHT
     "supports=[{edge: theta1-, fix: clamped}, {at: nodes, fix: u2}];"
     "loads=[{line: theta1+, u3: 1}, {face: inner, pressure: 2, follower: normal}]",
     2e-3},
    {"bimorph-sensor",
     IMPROVED PLACES TIGHT
     "kinematics=nonlinear;supports=[{edge: theta1-, fix: clamped}];"
     "loads=[{line: theta1+, u3: 1}, {face: inner, pressure: 200, follower: normal}]",
     2e-3},
};

static void test_influence_under_followers(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(followers); i++)
        check_influence(&followers[i]);
}

static void test_influence_in_contact(void **state)
{
    (void)state;
    check_influence(&influences[3]);
}

/* Law: at rest it is the linear influence. */
static void test_influence_at_rest(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "plate-50-patches", IMPROVED "kinematics=nonlinear");
    const pzs_structure *structure = &r.analysis.design.structure;
    const size_t size = (size_t)structure->output.count * structure->input.count;
    double *linear = calloc(size, sizeof *linear), *here = calloc(size, sizeof *here),
           *none = calloc(structure->input.count, sizeof *none);
    assert_int_equal(pzs_equilibrium(path_of(&r), none), PZS_OK);
    assert_int_equal(pzs_influence_at(path_of(&r), here), PZS_OK);
    assert_int_equal(pzs_assemble(&r.analysis.model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&r.analysis.model), PZS_OK);
    assert_int_equal(pzs_influence(&r.analysis.model, linear), PZS_OK);
    /* One is refined, one is not. */
    assert_true(apart(here, linear, size) < 10 * PZS_EPSILON * r.analysis.model.info.condition);
    free(linear);
    free(here);
    free(none);
    scene_run_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pressed_arc),
        cmocka_unit_test(test_uneven_ring_inflates_evenly),
        cmocka_unit_test(test_steps_agree),
        cmocka_unit_test(test_astray_meshes),
        cmocka_unit_test(test_mixed_beats_plain),
        cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_rigid_motion_of_the_source),
        cmocka_unit_test(test_prescribed_and_reaction),
        cmocka_unit_test(test_contact_resultant),
        cmocka_unit_test(test_contact_sag),
        cmocka_unit_test(test_contact_stiffness),
        cmocka_unit_test(test_contact_stiffness_of_rubber),
        cmocka_unit_test(test_body_by_formula),
        cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_squared_height),
        cmocka_unit_test(test_auto),
        cmocka_unit_test(test_default_dof),
        cmocka_unit_test(test_thickness_locking),
        cmocka_unit_test(test_given_force_at_rest),
        cmocka_unit_test(test_influence),
        cmocka_unit_test(test_influence_of_prescribed),
        cmocka_unit_test(test_influence_under_followers),
        cmocka_unit_test(test_influence_in_contact),
        cmocka_unit_test(test_influence_at_rest),
    };
    return cmocka_run_group_tests_name("path", tests, NULL, NULL);
}
