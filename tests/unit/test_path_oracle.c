/*
 * Shapes reached by the nonlinear path against those of an independent program, unknown by unknown.
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
#include "../rigs/path_run.h"
#include "../rigs/testdata.h"

#ifndef DATA
#define DATA "tests/oracle/data"
#endif

/* The scene of a case of nonlinear.txt, by the start of the case's name, and what makes it that
 * case. */
static const struct {
    const char *name, *scene, *changes;
} scenes[] = {
    {"hemisphere-4x4", "hemisphere", ""},
    {"annular-2x4", "annular-plate", ""},
    {"ring-follower-unit", "ring-follower", ""},
    {"ring-follower-true", "ring-follower", "loads.0.follower=pressure;"},
    {"ring-contact", "ring-contact", ""},
    {"roll-up-0.5", "roll-up", HALF_TURN},
    {"roll-up-1", "roll-up", ""},
    {"hyperboloid-8x8", "hyperboloid", ""},
};

static void open_case(scene_run *r, const testdata *t, const char *equilibrium)
{
    char changes[512];
    const double *mesh = testdata_values(t, "mesh");
    for (size_t i = 0; i < COUNT(scenes); i++)
        if (strncmp(t->name, scenes[i].name, strlen(scenes[i].name)) == 0) {
            snprintf(changes, sizeof changes,
                     "%selement=%s;dof_per_node=7;mesh.theta1.elements=%d;mesh.theta2.elements=%d;"
                     "equilibrium={%s}",
                     scenes[i].changes, testdata_word(t, "element"), (int)mesh[0], (int)mesh[1],
                     equilibrium);
            solve_run(r, scenes[i].scene, changes);
            return;
        }
    fail_msg("no scene for %s", t->name);
}

/* Largest difference of any unknown from the case's, as a displacement of the faces, over the
 * largest displacement. */
static double off(const scene_run *r, const testdata *t)
{
    const pzs_structure *structure = &r->analysis.design.structure;
    const testdata_array *u = testdata_find(t, "u");
    double most = 0, size = 0;
    assert_int_equal(u->rows, structure->nodes);
    assert_int_equal(u->columns, structure->dof_per_node);
    for (int n = 0; n < structure->nodes; n++)
        for (int k = 0; k < structure->dof_per_node; k++) {
            const uint16_t dof = structure->node_dof[n * structure->dof_per_node + k];
            const double want = u->value[n * structure->dof_per_node + k],
                         weight = k < 3 ? 1 : structure->type[0].thickness;
            most = fmax(most, weight * fabs((dof == PZS_CONSTRAINED ? 0 : r->u[dof]) - want));
            size = fmax(size, weight * fabs(want));
        }
    return most / size;
}

/* Contact: the same nodes, the same pressures, the same force. */
static void check_contact(const scene_run *r, const testdata *t, double tolerance)
{
    const pzs_contact *contact = &r->analysis.equilibrium.contact;
    const double *multiplier = testdata_values(t, "multiplier"),
                 *active = testdata_values(t, "active"), *force = testdata_values(t, "force");
    const int nodes = r->analysis.design.mesh.nodes;
    double peak = largest(multiplier, (size_t)nodes);
    for (int n = 0; n < nodes; n++) {
        assert_int_equal(contact->state.touching[n], active[n] > 0);
        assert_true(fabs(contact->info.pressure[n] + multiplier[n]) < tolerance * peak);
    }
    assert_true(
        fabs(hypot(contact->info.force[0], contact->info.force[1]) / hypot(force[0], force[1]) -
             1) < tolerance);
}

/*
 * Law: every unknown of every shape is that of the independent program, to the rounding of some
 * thousand unknowns and terms, and without contact, where the programs treat their nodes
 * differently, no more systems lead there.
 */
static void test_shapes(void **state)
{
    (void)state;
    FILE *file = fopen(DATA "/nonlinear.txt", "r");
    testdata t;
    int cases = 0;
    assert_non_null(file);
    for (; testdata_next(file, &t); cases++, testdata_free(&t)) {
        char equilibrium[128];
        const double *systems = testdata_values(&t, "systems");
        scene_run r;
        open_case(&r, &t, "tolerance: 1e-10, extrapolated_iterations: 1000");
        const double error = off(&r, &t);
        const unsigned negative = path_of(&r)->info.negative_pivots;
        if (testdata_find(&t, "multiplier"))
            check_contact(&r, &t, 1e-9);
        scene_run_close(&r);
        snprintf(equilibrium, sizeof equilibrium, "tolerance: %g, extrapolated_iterations: 1000",
                 systems[0]);
        open_case(&r, &t, equilibrium);
        print_message("%-32s off by %.1e, %u systems of %g, %u negative pivots\n", t.name, error,
                      path_of(&r)->info.linear_solves, systems[1], negative);
        assert_true(error < 1e-12);
        assert_int_equal(negative, testdata_values(&t, "negative")[0]);
        assert_true(path_of(&r)->info.linear_solves <= systems[1] ||
                    testdata_find(&t, "multiplier"));
        scene_run_close(&r);
    }
    fclose(file);
    assert_int_equal(cases, 2 * COUNT(scenes));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shapes)};
    return cmocka_run_group_tests_name("path_oracle", tests, NULL, NULL);
}
