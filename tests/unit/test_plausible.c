/*
 * Laws of the plausibility rules: each speaks just above its limit and not just below; what the
 * shipped scenes say.
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
#include "../rigs/scene_assert.h"

/* Change of the ceramic into a film actuator whose data sheet holds at a voltage (V), a text. */
#define FILM(voltage)                                                                              \
    "materials.ceramic={E: 6e10, nu: 0.3, density: 7800, film: {voltage: " voltage                 \
    ", strain: [1e-4, -5e-5], thickness: 0.5e-3}};"
#define ACTUATED "sensors=[];outputs=[];actuators=[{name: v, drives: [{patches: up, factor: 2}]}];"
#define METRES "units={length: m, force: N, voltage: V, temperature: K};"
#define MILLIMETRES "units={length: mm, force: N, voltage: V, temperature: K};"

/* ---- rules on the numbers of a scene ---------------------------------- */

typedef struct edge_case {
    const char *rule, *units, *fires, *silent;
    double value; /* that the rule finds, in SI units or a ratio */
} edge_case;

/*
 * Both sides of every limit, the second one 1 % within it. The voltages: a factor of 2 on a layer
 * of 0.5 mm makes 4 kV/m of a volt.
 */
static const edge_case edges[] = {
    {"modulus", METRES, "materials.ceramic.E=2.01e12", "materials.ceramic.E=1.99e12", 2.01e12},
    {"modulus", METRES, "materials.ceramic.E=0.99e5", "materials.ceramic.E=1.01e5", 0.99e5},
    {"modulus", MILLIMETRES, "materials.ceramic.E=2.01e6", "materials.ceramic.E=1.99e6", 2.01e12},
    {"modulus", MILLIMETRES, "materials.ceramic.E=70e9", "materials.ceramic.E=70e3", 70e15},
    {"modulus", METRES,
     "materials.ceramic={E1: 1e9, E2: 1e9, G12: 2.01e12, G23: 1e9, nu12: 0, d31: 1e-10, "
     "permittivity: 1e-8}",
     "materials.ceramic={E1: 1e9, E2: 1e9, G12: 1.99e12, G23: 1e9, nu12: 0, d31: 1e-10, "
     "permittivity: 1e-8}",
     2.01e12},
    {"density", METRES, "materials.ceramic.density=3.01e4", "materials.ceramic.density=2.99e4",
     3.01e4},
    {"density", METRES, "materials.ceramic.density=0.99", "materials.ceramic.density=1.01", 0.99},
    {"density", MILLIMETRES, "materials.ceramic.density=7800", "materials.ceramic.density=7800e-12",
     7800e12},
    {"light_material", METRES, "materials.ceramic.density=99", "materials.ceramic.density=101", 99},
    {"light_material", METRES, "materials.ceramic.density=7.8",
     "materials.ceramic.density=7.8;materials.ceramic.E=0.99e9", 7.8},
    {"piezo_constant", METRES, "materials.ceramic.d31=1.01e-8", "materials.ceramic.d31=0.99e-8",
     1.01e-8},
    {"piezo_constant", METRES, "materials.ceramic.d31=-0.99e-13", "materials.ceramic.d31=-1.01e-13",
     0.99e-13},
    {"piezo_constant", MILLIMETRES, "materials.ceramic.d31=1.01e-5",
     "materials.ceramic.d31=0.99e-5", 1.01e-8},
    {"piezo_constant", METRES, "materials.ceramic={E: 1e9, nu: 0, e31: 10.1, permittivity: 1e-8}",
     "materials.ceramic={E: 1e9, nu: 0, e31: 9.9, permittivity: 1e-8}", 1.01e-8},
    {"missing_d32", METRES, "materials.ceramic={E: 6e10, nu: 0.3, d31: 1e-10, permittivity: 1e-8}",
     "materials.ceramic={E: 6e10, nu: 0.3, d31: 1e-10, d32: 0, permittivity: 1e-8}", 1},
    {"missing_d32", METRES, "materials.ceramic={E: 6e10, nu: 0.3, e31: 10, permittivity: 1e-8}",
     "materials.ceramic={E: 6e10, nu: 0.3, e31: 10, e32: 10, permittivity: 1e-8}", 1},
    {"permittivity", METRES, "materials.ceramic.permittivity=1.01e-6",
     "materials.ceramic.permittivity=0.99e-6", 1.01e-6},
    {"permittivity", METRES, "materials.ceramic.permittivity=8.7e-12",
     "materials.ceramic.permittivity=8.9e-12", 8.7e-12},
    {"permittivity", MILLIMETRES, "materials.ceramic.permittivity=1.01e-6",
     "materials.ceramic.permittivity=15 nF/m", 1.01e-6},
    {"pyroelectric", METRES, "materials.ceramic.pyroelectric=-1.01e-2",
     "materials.ceramic.pyroelectric=-0.99e-2", 1.01e-2},
    {"pyroelectric", MILLIMETRES, "materials.ceramic.pyroelectric=1.01e-5",
     "materials.ceramic.pyroelectric=0.99e-5", 1.01e-2},
    {"expansion", METRES, "materials.ceramic.alpha=1.01e-3", "materials.ceramic.alpha=0.99e-3",
     1.01e-3},
    {"expansion", MILLIMETRES, "materials.ceramic.alpha=[0, 0, -1.01e-3]",
     "materials.ceramic.alpha=[0, 0, -0.99e-3]", 1.01e-3},
    {"thickness", METRES, "layers.1.thickness=1.01", "layers.1.thickness=0.99", 1.01},
    {"thickness", MILLIMETRES, "layers.1.thickness=0.99e-4", "layers.1.thickness=1.01e-4", 0.99e-7},
    {"applied_field", METRES, ACTUATED "actuators.v.applied=-252.5",
     ACTUATED "actuators.v.applied=-247.5", 1.01e6},
    {"applied_field", METRES, ACTUATED "actuators.v.applied=252.5",
     ACTUATED "actuators.v.applied=252.5;materials.ceramic.field_limit=2e6", 1.01e6},
    {"field_limit_ceramic", METRES, "materials.ceramic.field_limit=2.02e7",
     "materials.ceramic.field_limit=1.98e7", 2.02e7},
    {"field_limit_ceramic", MILLIMETRES,
     "materials.ceramic.d31=1.9e-7;materials.ceramic.field_limit=1e6",
     "materials.ceramic.d31=1.9e-7;materials.ceramic.field_limit=1e3", 1e9},
    {"field_limit_ceramic", METRES, "materials.ceramic.field_limit=4.95e4",
     "materials.ceramic.field_limit=5.05e4", 4.95e4},
    {"field_limit", METRES,
     "materials.ceramic.d31=2e-11;materials.ceramic.d32=2e-11;materials.ceramic.field_limit=7.07e8",
     "materials.ceramic.d31=2e-11;materials.ceramic.d32=2e-11;materials.ceramic.field_limit=6.93e8",
     7.07e8},
    {"field_limit", METRES,
     "materials.ceramic.d31=2e-11;materials.ceramic.d32=2e-11;materials.ceramic.field_limit=4.95e4",
     "materials.ceramic.d31=2e-11;materials.ceramic.d32=2e-11;materials.ceramic.field_limit=5.05e4",
     4.95e4},
    {"limit_field", METRES, ACTUATED "limits={voltage: [-252.5, 1]}",
     ACTUATED "limits={voltage: [-247.5, 1]}", 1.01e6},
    {"no_voltage_limits", METRES,
     ACTUATED "control={rate: 10};limits={each: [{actuator: v, voltage: [-1, 1]}]};"
              "limits={step_limit: 1}",
     ACTUATED "control={rate: 10};limits={each: [{actuator: v, voltage: [-1, 1]}]}", 1},
    {"damping", METRES, "dynamics={damping: 0.101}", "dynamics={damping: 0.099}", 0.101},
    {"damping", METRES, "dynamics={damping: [0.01, 0.5]}", "dynamics={damping: [0.01, 0.05]}", 0.5},
    {"limit_field", METRES,
     ACTUATED "limits={voltage: [-9, 9], each: [{actuator: v, voltage: [0, 252.5]}]}",
     ACTUATED "limits={voltage: [-9, 9], each: [{actuator: v, voltage: [0, 247.5]}]}", 1.01e6},
    {"limit_field", METRES, ACTUATED FILM("504.9") "limits={voltage: [-252.5, 1]}",
     ACTUATED FILM("505.1") "limits={voltage: [-252.5, 1]}", 1.01e6},
    {"held_voltage", METRES,
     ACTUATED "limits={voltage: [-9, 9], each: [{actuator: v, hold: -9.5}]}",
     ACTUATED "limits={voltage: [-9, 9], each: [{actuator: v, hold: -9}]}", 0.5},
    {"limit_field", METRES, ACTUATED "limits={voltage: [-900, 900]}",
     ACTUATED "limits={voltage: [-900, 900], each: [{actuator: v, hold: 0}]}", 3.6e6},
};

static const plausible_warning *find_rule(const plausible *warnings, const char *rule)
{
    for (int i = 0; i < warnings->count; i++)
        if (strcmp(warnings->warning[i].rule, rule) == 0)
            return &warnings->warning[i];
    return NULL;
}

/* Warnings of the numbers of a scene, by name or path. */
static void warnings_of(const char *name, const char *changes, plausible *warnings)
{
    scene_run r;
    memset(warnings, 0, sizeof *warnings);
    open_run(&r, name, changes);
    plausible_scene(warnings, &r.scene);
    scene_run_close(&r);
}

/* Each rule fires above its limit with the number that it found, and is silent below. */
static void test_edges(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        const edge_case *c = &edges[i];
        plausible warnings;
        warnings_of(PLATE, with(c->units, c->fires), &warnings);
        const plausible_warning *w = find_rule(&warnings, c->rule);
        if (!w)
            fail_msg("%s is silent at %s", c->rule, c->fires);
        assert_near(c->fires, w->value, c->value, 1e-12);
        assert_true(w->value > w->limit ? w->limit < c->value : w->limit > c->value);
        if (!strchr(w->text, ';'))
            fail_msg("no cure in '%s'", w->text);
        warnings_of(PLATE, with(c->units, c->silent), &warnings);
        if (find_rule(&warnings, c->rule))
            fail_msg("%s fires at %s: %s", c->rule, c->silent, find_rule(&warnings, c->rule)->text);
    }
}

/*
 * Law: an applied voltage is warned of if its field opposes the poling and exceeds the field_limit,
 * in either direction of the poling; 252.5 V make 1.01 MV/m.
 */
static void test_depolarising_voltage(void **state)
{
    (void)state;
    static const double voltage[] = {252.5, -252.5, 247.5, -247.5};
    for (int k = 0; k < 8; k++) {
        char changes[400];
        plausible warnings;
        snprintf(changes, sizeof changes,
                 METRES ACTUATED "materials.ceramic.field_limit=1e6;layers.1.poling=%d;"
                                 "patches.0.grid=[3, 1];"
                                 "actuators.v.applied=[-1, %g, %g]",
                 k < 4 ? 3 : -3, voltage[k % 4], -0.9 * voltage[k % 4]);
        warnings_of(PLATE, changes, &warnings);
        const plausible_warning *w = find_rule(&warnings, "depolarising_voltage");
        assert_int_equal(w != NULL, k == 0 || k == 5);
        if (!w)
            continue;
        assert_near("use of the field_limit", w->value, 1.01, 1e-12);
        assert_non_null(strstr(w->text, "layer 'upper' of material 'ceramic'"));
        assert_non_null(strstr(w->text, "applied to 'v'"));
    }
}

/*
 * Strengths of materials (MPa) with their moduli (GPa): under tension along 1 and 2, under
 * compression along 1 and 2, under shear.
 */
static const struct {
    const char *name;
    double e1, e2, strength[5];
} strong[] = {
    {"soft rubber", 0.0005, 0.0005, {5, 5, 5, 5, 3}},
    {"silicone", 0.001, 0.001, {8, 8, 8, 8, 4}},
    {"polyurethane elastomer", 0.03, 0.03, {50, 50, 50, 50, 30}},
    {"polyethylene", 0.2, 0.2, {15, 15, 15, 15, 9}},
    {"polycarbonate", 2.4, 2.4, {65, 65, 80, 80, 40}},
    {"PVDF, drawn", 3, 3, {250, 50, 250, 50, 60}},
    {"foam core", 0.07, 0.07, {1.9, 1.9, 0.9, 0.9, 0.8}},
    {"balsa", 3.5, 0.1, {13, 0.9, 12, 1, 2}},
    {"spruce", 11, 0.4, {80, 2.5, 40, 5, 7}},
    {"CFRP", 140, 9, {1500, 40, 1200, 200, 70}},
    {"GFRP", 40, 8, {1000, 30, 600, 110, 70}},
    {"concrete", 30, 30, {3, 3, 40, 40, 4}},
    {"granite", 50, 50, {8, 8, 200, 200, 14}},
    {"glass", 70, 70, {30, 30, 1000, 1000, 40}},
    {"fused silica", 72, 72, {50, 50, 1100, 1100, 60}},
    {"glass fibre", 72, 72, {3400, 3400, 3400, 3400, 2000}},
    {"silicon", 130, 130, {1000, 1000, 5000, 5000, 1000}},
    {"alumina", 370, 370, {300, 300, 2600, 2600, 300}},
    {"lead", 16, 16, {12, 12, 12, 12, 7}},
    {"annealed aluminium", 70, 70, {15, 15, 15, 15, 9}},
    {"steel", 210, 210, {400, 400, 400, 400, 230}},
    {"spring steel", 210, 210, {1900, 1900, 1900, 1900, 1100}},
    {"PZT", 63, 63, {30, 30, 600, 600, 30}},
    {"PMN-PT", 15, 15, {30, 30, 300, 300, 20}},
};

/* Number of warnings on a material with the strengths of row k, times a factor (MPa). */
static int strength_warnings(size_t k, const char *units, double mega, double factor)
{
    char changes[600];
    plausible warnings;
    const double *s = strong[k].strength, scale = factor * mega;
    snprintf(changes, sizeof changes,
             "%smaterials.ceramic={E1: %.9g, E2: %.9g, G12: %.9g, nu12: 0.01, d31: 1e-10, "
             "permittivity: 1e-8, "
             "strength: {tension: [%.9g, %.9g], compression: [%.9g, %.9g], shear: %.9g}}",
             units, strong[k].e1 * 1e3 * mega, strong[k].e2 * 1e3 * mega, strong[k].e2 * 400 * mega,
             s[0] * scale, s[1] * scale, s[2] * scale, s[3] * scale, s[4] * scale);
    warnings_of(PLATE, changes, &warnings);
    return (find_rule(&warnings, "strength") != NULL) +
           (find_rule(&warnings, "strength_soft") != NULL) +
           (find_rule(&warnings, "strength_ratio") != NULL);
}

/*
 * Law: no real material is warned of, in m or mm; strengths in Pa in place of MPa are, and
 * strengths in MPa in place of Pa, for every material.
 */
static void test_strengths(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof strong / sizeof *strong; k++) {
        if (strength_warnings(k, METRES, 1e6, 1) + strength_warnings(k, MILLIMETRES, 1, 1) > 0)
            fail_msg("%s: a warning", strong[k].name);
        if (strength_warnings(k, MILLIMETRES, 1, 1e6) == 0)
            fail_msg("%s: silent at 1e6 times its strength", strong[k].name);
        if (strength_warnings(k, METRES, 1e6, 1e-6) == 0)
            fail_msg("%s: silent at 1e-6 times its strength", strong[k].name);
    }
}

/* Law: the bands of strength over modulus and of compression over tension are kept to 1 %. */
static void test_strength_bands(void **state)
{
    static const struct {
        const char *rule, *text;
        bool is_warned;
    } cases[] = {
        {"strength", "E: 1e9, nu: 0, strength: {tension: 3.03e8}", true},
        {"strength", "E: 1e9, nu: 0, strength: {tension: 2.97e8, shear: 1e8}", false},
        {"strength", "E: 1e9, nu: 0, strength: {tension: 0.99e4, shear: 1e5}", true},
        {"strength", "E: 1e9, nu: 0, strength: {tension: 1.01e4, shear: 1e5}", false},
        {"strength_soft", "E: 1e8, nu: 0, strength: {tension: 3.03e9, shear: 1e5}", true},
        {"strength_soft", "E: 1e8, nu: 0, strength: {tension: 2.97e9, shear: 1e5}", false},
        {"strength_ratio", "E: 1e9, nu: 0, strength: {tension: 1e5, compression: 1.01e7}", true},
        {"strength_ratio", "E: 1e9, nu: 0, strength: {tension: 1e5, compression: 0.99e7}", false},
        {"strength_ratio", "E: 1e9, nu: 0, strength: {tension: 1e6, compression: 0.99e4}", true},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char changes[300];
        plausible warnings;
        snprintf(changes, sizeof changes,
                 METRES "materials.ceramic={d31: 1e-10, permittivity: 1e-8, %s}", cases[i].text);
        warnings_of(PLATE, changes, &warnings);
        if ((find_rule(&warnings, cases[i].rule) != NULL) != cases[i].is_warned)
            fail_msg("%s at %s", cases[i].rule, cases[i].text);
    }
}

/* The rules on the optimum of a target fire outside their ranges and not just inside. */
static void test_target(void **state)
{
    (void)state;
    static const struct {
        const char *rule;
        plausible_optimum fires, silent;
    } cases[] = {
        {"zero_target", {0, 0, 0, 0, 0}, {1.01e-9, 0.5, 1, 0, 0}},
        {"zero_target", {0.99e-9, 0.5, 1, 0, 0}, {1, 0.5, 1, 0, 0}},
        {"unreached_target", {1, 0.901, 1, 0, 0}, {1, 0.899, 1, 0, 0}},
        {"dependent_voltages", {1, 0.5, 1, 1, 0}, {1, 0.5, 1, 0, 0}},
        {"idle_voltages", {1, 0.5, 0.99e-4, 0, 0}, {1, 0.5, 1.01e-4, 0, 0}},
        {"idle_voltages", {1, 0.5, 0, 0, 0}, {1, 0.5, (double)NAN, 0, 0}},
        {"sensor_range", {1, 0.5, 1, 0, 1.01}, {1, 0.5, 1, 0, 0.99}},
    };
    scene_run r;
    open_run(&r, PLATE, "");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        plausible warnings = {.count = 0};
        plausible_target(&warnings, &r.scene, &cases[i].fires);
        if (warnings.count != 1 || !find_rule(&warnings, cases[i].rule))
            fail_msg("case %zu: %d warnings", i, warnings.count);
        plausible_target(&warnings, &r.scene, &cases[i].silent);
        assert_int_equal(warnings.count, 1);
    }
    scene_run_close(&r);
}

/* Loads are compared with the voltages: the rule fires above 0.3, and not without finite limits. */
static void test_sudden_loads(void **state)
{
    scene_run r;
    (void)state;
    open_run(&r, PLATE, "");
    plausible warnings = {.count = 0};
    plausible_loads(&warnings, &r.scene, 0.299, 1);
    plausible_loads(&warnings, &r.scene, 1, 0);
    plausible_loads(&warnings, &r.scene, 0, 1);
    assert_int_equal(warnings.count, 0);
    plausible_loads(&warnings, &r.scene, 0.301, 1);
    assert_int_equal(warnings.count, 1);
    assert_non_null(find_rule(&warnings, "sudden_loads"));
    scene_run_close(&r);
}

/* Rules on numbers with units are silent where the scene's units are not known. */
static void test_unitless(void **state)
{
    static const char *const unknown[] = {"units={force: N};",
                                          "units={length: inch, force: lbf, voltage: volt};"};
    (void)state;
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++)
        for (int k = 0; k < 2; k++) {
            plausible warnings;
            warnings_of(PLATE, with(unknown[k], edges[i].fires), &warnings);
            const int ratios = (find_rule(&warnings, "uneven_piezo") != NULL) +
                               (find_rule(&warnings, "missing_d32") != NULL) +
                               (find_rule(&warnings, "damping") != NULL) +
                               (find_rule(&warnings, "held_voltage") != NULL) +
                               (find_rule(&warnings, "no_voltage_limits") != NULL);
            if (warnings.count > ratios)
                fail_msg("without SI units: %s", warnings.warning[0].text);
        }
}

/*
 * Law: an electrode of any outline is reported if its area is below that of two elements. The
 * elements of the first row are squares of 0.02.
 */
static void test_small_electrode(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        char changes[300];
        plausible warnings;
        snprintf(changes, sizeof changes,
                 "sensors=[];outputs=[];patches=[{name: up, layer: upper, outlines: [{grid: {from: "
                 "[0.01, 0], to: [%g, 0.02], count: [1, 1]}}]}]",
                 0.01 + 0.04 * (k ? 1.01 : 0.99));
        warnings_of(PLATE, changes, &warnings);
        assert_int_equal(warnings.count, 1 - k);
        if (k == 0) {
            assert_string_equal(warnings.warning[0].rule, "small_electrode");
            assert_near("elements", warnings.warning[0].value, 1.98, 1e-12);
            assert_non_null(strstr(warnings.warning[0].text, "electrode 1 of patches 'up'"));
        }
    }
}

/*
 * Law: a place that is not at a node of a mesh of quadrilaterals is reported with its distance over
 * the size of the elements, the farthest of several.
 */
static void test_distant_place(void **state)
{
    (void)state;
    double value[2];
    plausible warnings;
    warnings_of("tests/rigs/scenes/holed-panel.yaml", "outputs=[]", &warnings);
    assert_null(find_rule(&warnings, "distant_place"));
    for (int k = 0; k < 2; k++) {
        char changes[200];
        snprintf(changes, sizeof changes,
                 "outputs=[{name: a, u3: middle, at: {x: -10, y: -10, z: 0}}, "
                 "{name: b, u3: middle, at: {x: %g, y: -10, z: 0}}]",
                 -10 - 0.4 * (k + 1));
        warnings_of("tests/rigs/scenes/holed-panel.yaml", changes, &warnings);
        assert_non_null(find_rule(&warnings, "distant_place"));
        value[k] = find_rule(&warnings, "distant_place")->value;
    }
    assert_near("twice the distance", value[1], 2 * value[0], 1e-9);
}

/*
 * Law: hysteresis of more than a quarter of the voltage range is warned of where the control loop
 * has a self-test, and only there.
 */
static void test_tested_hysteresis(void **state)
{
#define TESTED "safety={selftest: {amplitude: 5}};simulate.plant.hysteresis="
    plausible warnings;
    (void)state;
    warnings_of("plate-closed-loop", TESTED "0.253", &warnings);
    assert_non_null(find_rule(&warnings, "selftest_hysteresis"));
    warnings_of("plate-closed-loop", TESTED "0.247", &warnings);
    assert_null(find_rule(&warnings, "selftest_hysteresis"));
    warnings_of("plate-closed-loop", "simulate.plant.hysteresis=0.253", &warnings);
    assert_null(find_rule(&warnings, "selftest_hysteresis"));
}

/* A warning names its line; one that comes from a change names the change; more than there is room
 * for are counted. */
static void test_places(void **state)
{
    char many[4096] = METRES "layers=[";
    plausible warnings;
    (void)state;
    warnings_of("plate-50-patches", "", &warnings);
    assert_int_equal(warnings.count, 1);
    assert_non_null(
        strstr(warnings.warning[0].text,
               "plate-50-patches.yaml:34:9: electric field in patches 'up' at the voltage limit"));
    assert_near("600 V on 0.25 mm", warnings.warning[0].value, 2.4e6, 1e-12);
    warnings_of(PLATE, METRES "layers.2={material: ceramic, thickness: 2}", &warnings);
    assert_non_null(strstr(warnings.warning[0].text, "--set layers.2: thickness of layer 2"));
    for (int i = 0; i < 30; i++)
        snprintf(many + strlen(many), sizeof many - strlen(many),
                 "{name: l%d, material: ceramic, thickness: %d},", i, 2 + i);
    snprintf(
        many + strlen(many), sizeof many - strlen(many),
        "];patches=[];sensors=[];outputs=[];loads=[];supports=[{edge: theta1-, fix: clamped}]");
    warnings_of(PLATE, many, &warnings);
    assert_int_equal(warnings.count, PLAUSIBLE_MOST);
    assert_int_equal(warnings.dropped, 30 - PLAUSIBLE_MOST);
}

/* ---- real materials ---------------------------------------------------- */

/* Variants of a material that must be warned of. */
enum { SOFT = 1, STIFF = 2, WEAK = 4, STRONG = 8, ELASTIC = SOFT | STIFF, PIEZO = 15 };

/*
 * Constants of real materials: Young's moduli (GPa), equal in isotropic ones, density (kg/m3),
 * piezoelectric constants (pm/V). `warned` names the units by which a factor of 1000 is noticed:
 * the modulus too small (SOFT) or large (STIFF), the constants too small (WEAK) or large (STRONG).
 * A polymer of a thousandth of its stiffness is a rubber, which no rule can tell.
 */
static const struct {
    const char *name;
    double e1, e2, density, d31, d32, d33;
    unsigned warned;
} real[] = {
    {"silicone rubber", 0.002, 0.002, 1100, 0, 0, 0, SOFT},
    {"PDMS", 0.00075, 0.00075, 965, 0, 0, 0, SOFT},
    {"natural rubber", 0.0015, 0.0015, 930, 0, 0, 0, SOFT},
    {"hard nitrile rubber", 0.2, 0.2, 1300, 0, 0, 0, 0},
    {"cord in rubber", 1, 0.01, 1200, 0, 0, 0, ELASTIC},
    {"polyurethane", 0.025, 0.025, 1200, 0, 0, 0, SOFT},
    {"polyurethane foam", 0.0002, 0.0002, 60, 0, 0, 0, SOFT},
    {"polyethylene", 0.2, 0.2, 920, 0, 0, 0, 0},
    {"PMMA", 3, 3, 1180, 0, 0, 0, STIFF},
    {"PTFE", 0.45, 0.45, 2180, 0, 0, 0, SOFT},
    {"epoxy", 3.2, 3.2, 1200, 0, 0, 0, STIFF},
    {"foam core, PVC", 0.07, 0.07, 60, 0, 0, 0, SOFT | STIFF},
    {"foam core, PMI", 0.092, 0.092, 75, 0, 0, 0, SOFT | STIFF},
    {"balsa", 3.5, 0.1, 150, 0, 0, 0, ELASTIC},
    {"cork", 0.02, 0.02, 200, 0, 0, 0, SOFT},
    {"spruce", 11, 0.4, 430, 0, 0, 0, STIFF},
    {"CFRP", 135, 9, 1600, 0, 0, 0, ELASTIC},
    {"CFRP fabric", 65, 65, 1550, 0, 0, 0, STIFF},
    {"GFRP", 40, 8, 1900, 0, 0, 0, ELASTIC},
    {"aramid ply", 75, 5.5, 1380, 0, 0, 0, ELASTIC},
    {"borosilicate glass", 64, 64, 2230, 0, 0, 0, ELASTIC},
    {"fused silica", 72, 72, 2200, 0, 0, 0, ELASTIC},
    {"glass ceramic", 90, 90, 2530, 0, 0, 0, ELASTIC},
    {"concrete", 30, 30, 2400, 0, 0, 0, ELASTIC},
    {"aluminium", 70, 70, 2700, 0, 0, 0, ELASTIC},
    {"titanium", 114, 114, 4430, 0, 0, 0, ELASTIC},
    {"steel", 210, 210, 7850, 0, 0, 0, ELASTIC},
    {"copper", 120, 120, 8960, 0, 0, 0, ELASTIC},
    {"lead", 16, 16, 11340, 0, 0, 0, ELASTIC},
    {"gold", 78, 78, 19300, 0, 0, 0, ELASTIC},
    {"tungsten", 400, 400, 19300, 0, 0, 0, ELASTIC},
    {"beryllium", 287, 287, 1850, 0, 0, 0, STIFF},
    {"silicon", 130, 130, 2330, 0, 0, 0, ELASTIC},
    {"silicon carbide", 420, 420, 3210, 0, 0, 0, ELASTIC},
    {"alumina", 370, 370, 3900, 0, 0, 0, ELASTIC},
    {"diamond", 1050, 1050, 3520, 0, 0, 0, STIFF},
    {"PZT-5A", 61, 61, 7750, -171, -171, 374, PIEZO},
    {"PZT-5H", 60.6, 60.6, 7500, -274, -274, 593, PIEZO},
    {"PZT-4", 81, 81, 7500, -123, -123, 289, PIEZO},
    {"PZT without density", 62, 62, 0, -180, -180, 0, PIEZO},
    {"PZT, film of fibres", 30.3, 15.9, 5440, 240, -100, 0, PIEZO},
    {"barium titanate", 116, 116, 5700, -78, -78, 190, PIEZO},
    {"KNN", 90, 90, 4500, -50, -50, 120, PIEZO},
    {"PMN-PT, 001", 15, 15, 8060, -1330, -1330, 2820, PIEZO},
    {"PMN-PT, 011", 20, 20, 8060, 610, -1883, 1020, PIEZO},
    {"quartz", 78, 78, 2650, 2.3, -2.3, 0, PIEZO},
    {"aluminium nitride", 330, 330, 3260, -2, -2, 5, PIEZO},
    {"zinc oxide", 127, 127, 5680, -5.1, -5.1, 12.3, PIEZO},
    {"lithium niobate", 203, 203, 4640, -1, -1, 6, PIEZO},
    {"PVDF", 3, 3, 1780, 23, 3, -33, PIEZO},
    {"PVDF-TrFE", 2, 2, 1880, 12, 12, -32, PIEZO},
    {"polylactide", 3, 3, 1250, 10, -10, 0, PIEZO},
};

/* Warnings of the material with number k, its moduli and piezoelectric constants multiplied. */
static void warnings_of_material(size_t k, double elastic, double piezo, plausible *warnings)
{
    char text[1000], moduli[200], error[SCENE_ERROR];
    const double e1 = elastic * real[k].e1, e2 = elastic * real[k].e2;
    scene scene;
    snprintf(moduli, sizeof moduli, "E: %.9g GPa, nu: 0.3", e1);
    if (e1 != e2)
        snprintf(moduli, sizeof moduli, "E1: %.9g GPa, E2: %.9g GPa, G12: %.9g GPa, nu12: 0.3", e1,
                 e2, e2 / 2);
    const int length = snprintf(
        text, sizeof text,
        "name: m\nsurface: {type: plate}\nunits: {length: m, force: N, voltage: V, temperature: "
        "K}\n"
        "mesh: {theta1: {from: 0, to: 1, elements: 1}, theta2: {from: 0, to: 1, elements: 1}}\n"
        "materials: {m: {%s, density: %.9g, d31: %.9g pm/V, d32: %.9g pm/V, d33: %.9g pm/V}}\n"
        "layers: [{material: m, thickness: 1e-3}]\nsupports: [{edge: theta1-, fix: clamped}]\n",
        moduli, real[k].density, piezo * real[k].d31, piezo * real[k].d32, piezo * real[k].d33);
    memset(warnings, 0, sizeof *warnings);
    if (scene_read_text(&scene, "m.yaml", text, (size_t)length, error) < 0)
        fail_msg("%s: %s", real[k].name, error);
    plausible_scene(warnings, &scene);
    scene_free(&scene);
}

/*
 * Law: no real material is warned of. A modulus or a piezoelectric constant that is wrong by a
 * factor of 1000 is, except where the result is another real material.
 */
static void test_materials(void **state)
{
    static const struct {
        unsigned variant;
        double elastic, piezo;
    } factor[] = {{SOFT, 1e-3, 1}, {STIFF, 1e3, 1}, {WEAK, 1, 1e-3}, {STRONG, 1, 1e3}};
    plausible warnings;
    (void)state;
    for (size_t k = 0; k < sizeof real / sizeof *real; k++) {
        warnings_of_material(k, 1, 1, &warnings);
        if (warnings.count > 0)
            fail_msg("%s: %s", real[k].name, warnings.warning[0].text);
        for (size_t i = 0; i < 4; i++) {
            warnings_of_material(k, factor[i].elastic, factor[i].piezo, &warnings);
            const bool is_warned = warnings.count > 0;
            if (is_warned != ((real[k].warned & factor[i].variant) != 0))
                fail_msg("%s, moduli x %g, constants x %g: %d warnings", real[k].name,
                         factor[i].elastic, factor[i].piezo, warnings.count);
        }
    }
}

/*
 * Law: permittivities, pyroelectric constants and thermal expansions of real materials are not
 * warned of, from vacuum to relaxors, from glass ceramics to rubber. A number in a thousandth of
 * its unit, or a relative permittivity in the place of an absolute one, is.
 */
static void test_electric_and_thermal(void **state)
{
    static const struct {
        const char *rule, *key;
        double value[5]; /* SI units */
        double wrong;    /* number in a wrong unit (SI units) */
    } real_constant[] = {
        {"permittivity", "permittivity", {8.854e-12, 1.062e-10, 1.5e-8, 7e-8, 3e-7}, 1700},
        {"pyroelectric", "pyroelectric", {-3e-4, 2.7e-5, -2.3e-4, 5.5e-4, -1.8e-3}, 0.3},
        {"expansion", "alpha", {-0.9e-6, 0.02e-6, 12e-6, 2.2e-4, 3e-4}, 10},
    };
    (void)state;
    for (size_t k = 0; k < sizeof real_constant / sizeof *real_constant; k++)
        for (int i = 0; i <= 5; i++) {
            char changes[200];
            plausible warnings;
            const double value = i < 5 ? real_constant[k].value[i] : real_constant[k].wrong;
            snprintf(changes, sizeof changes, METRES "materials.ceramic.%s=%.9g",
                     real_constant[k].key, value);
            warnings_of(PLATE, changes, &warnings);
            if ((find_rule(&warnings, real_constant[k].rule) != NULL) != (i == 5))
                fail_msg("%s: %d warnings", changes, warnings.count);
        }
}

/* ---- stacks ------------------------------------------------------------ */

/*
 * Law: stacks on the market are not warned of; a stroke or stiffness that is a thousand or a
 * million times too large is, and a stroke of 0.
 */
static void test_stacks(void **state)
{
    static const struct {
        double stiffness, stroke; /* N/um, nm/V */
    } stack[] = {
        {20, 80},     {50, 150},    {120, 22},
        {430, 180},   {4500, 15},                   /* small to very large stacks */
        {0.5, 900},   {0.56, 5880}, {0.001, 17000}, /* with a lever; a bender */
        {10000, 0.4},                               /* a single layer */
    };
    static const double factor[][2] = {{1, 1}, {1e3, 1}, {1, 1e3}, {1e6, 1}, {1, 1e6}, {1, 0}};
    (void)state;
    for (size_t k = 0; k < sizeof stack / sizeof *stack; k++)
        for (size_t i = 0; i < sizeof factor / sizeof *factor; i++) {
            char changes[200];
            plausible warnings;
            snprintf(
                changes, sizeof changes,
                "supports=[{set: rim, fix: clamped}];"
                "actuators=[{name: s, stacks: {points: [[0, 0]], along: z, stiffness: %g N/um, "
                "stroke: %g nm/V}}]",
                factor[i][0] * stack[k].stiffness, factor[i][1] * stack[k].stroke);
            warnings_of("tests/rigs/scenes/spring-disc.yaml", changes, &warnings);
            if ((warnings.count > 0) != (i > 0))
                fail_msg("%s: %d warnings, %s", changes, warnings.count,
                         warnings.count ? warnings.warning[0].text : "");
        }
}

/* ---- the mesh at local loads ------------------------------------------ */

/*
 * A force on a cylinder of R/h = 100, R = L: 2 (R/h)^(1/4) (R/L)^(1/2) = 6.3 elements on a quarter
 * turn. Four, which the rule refuses, miss more than a quarter of the published displacement;
 * eight, which it accepts, less.
 */
static void test_point_resolution(void **state)
{
    scene_run r;
    plausible warnings;
    (void)state;
    warnings_of("pinched-cylinder", "mesh.theta2.elements=6", &warnings);
    const plausible_warning *w = find_rule(&warnings, "resolution");
    assert_non_null(w);
    assert_near("2 100^(1/4) over 6", w->value, 2 * pow(100, 0.25) / 6, 1e-12);
    warnings_of("pinched-cylinder", "mesh.theta2.elements=7", &warnings);
    assert_null(find_rule(&warnings, "resolution"));
    solve_run(&r, "pinched-cylinder",
              "element=improved;mesh.theta1.elements=4;mesh.theta2.elements=4");
    assert_true(scene_run_value(&r, 0) / -1.8248e-5 < 0.75);
    scene_run_close(&r);
    solve_run(&r, "pinched-cylinder",
              "element=improved;mesh.theta1.elements=8;mesh.theta2.elements=8");
    assert_true(scene_run_value(&r, 0) / -1.8248e-5 > 0.75);
    scene_run_close(&r);
}

/* Flat shells and strips narrower than the bending length have no dent, whatever their mesh. */
static void test_no_dent(void **state)
{
    plausible warnings;
    (void)state;
    warnings_of("clamped-plate", "mesh.theta1.elements=1;mesh.theta2.elements=1", &warnings);
    assert_null(find_rule(&warnings, "resolution"));
    warnings_of("ring-contact", "mesh.theta1.elements=6", &warnings);
    assert_null(find_rule(&warnings, "resolution"));
}

/* A load along the rim of a cylinder bends it over sqrt(R h) = 30: elements of 300/n across the
 * rim. */
static void test_edge_resolution(void **state)
{
    static const char *const rim =
        "loads=[{line: theta1-, u3: 1}];mesh.theta2.elements=2;mesh.theta1.elements=";
    plausible warnings;
    (void)state;
    warnings_of("pinched-cylinder", with(rim, "9"), &warnings);
    const plausible_warning *w = find_rule(&warnings, "resolution");
    assert_non_null(w);
    assert_near("300/9 over 30", w->value, 300 / 9.0 / 30, 1e-12);
    warnings_of("pinched-cylinder", with(rim, "10"), &warnings);
    assert_null(find_rule(&warnings, "resolution"));
}

/* ---- displacements, strains, voltages --------------------------------- */

static void scale(const scene_run *r, double factor)
{
    for (int i = 0; i < r->analysis.design.mesh.free_dof; i++)
        r->u[i] *= factor;
}

static int fires(const scene_run *r, const char *rule, int is_linear)
{
    plausible warnings;
    memset(&warnings, 0, sizeof warnings);
    plausible_result(&warnings, &r->analysis.design.mesh, r->u, is_linear, "the test");
    return find_rule(&warnings, rule) != NULL;
}

/* A tip that moves by w: the displacement rule fires from w above the thickness on, and only for
 * small displacements. */
static void test_displacement(void **state)
{
    scene_run r;
    (void)state;
    solve_run(&r, "bimorph-actuator", "");
    scale(&r, 1e-3 / scene_run_value(&r, 0));
    scale(&r, 1.01);
    assert_true(fires(&r, "displacement", 1));
    assert_false(fires(&r, "displacement", 0));
    scale(&r, 0.99 / 1.01);
    assert_false(fires(&r, "displacement", 1));
    scene_run_close(&r);
}

/* Law: a bimorph of the tip displacement w bends to 2 w / L^2 everywhere, and its faces strain by t
 * times that. */
static void test_strain(void **state)
{
    const double epsilon = 2.2e-16;
    int where = 0;
    scene_run r;
    (void)state;
    solve_run(&r, "bimorph-actuator", "");
    const double law = 0.5e-3 * 2 * scene_run_value(&r, 0) / (0.1 * 0.1);
    const double tolerance = r.analysis.model.info.condition * epsilon;
    const double strain = plausible_strain(&r.analysis.design.mesh, r.u, 1, &where);
    assert_near("strain of the faces", strain, law, tolerance);
    scale(&r, 0.01 / law);
    scale(&r, 1.01);
    assert_true(fires(&r, "strain", 1));
    scale(&r, 0.99 / 1.01);
    assert_false(fires(&r, "strain", 1));
    scene_run_close(&r);
}

/*
 * Law: a strip rolled up to a circle turns by 2 pi but strains by kappa t only, within what the
 * chords of its elements and the square of the strain make: (kappa l)^2/24 + (kappa t)^2/2. To the
 * linear strain the rotation is one.
 */
static void test_strain_of_rotation(void **state)
{
    const double kappa = 2 * 3.14159265358979324 / 10, l = 0.25, t = 0.05, law = kappa * t;
    int where = 0;
    scene_run r;
    (void)state;
    solve_run(&r, "roll-up", "");
    const double strain = plausible_strain(&r.analysis.design.mesh, r.u, 0, &where);
    assert_true(fabs(strain - law) < pow(kappa * l, 2) / 24 + law * law / 2);
    assert_true(plausible_strain(&r.analysis.design.mesh, r.u, 1, &where) > 1);
    scene_run_close(&r);
}

/* Of several results the worst stands, whatever their order. */
static void test_worst(void **state)
{
    plausible warnings;
    scene_run r;
    (void)state;
    memset(&warnings, 0, sizeof warnings);
    solve_run(&r, "bimorph-sensor", "");
    const double factors[3] = {1, 2, 0.25};
    for (int i = 0; i < 3; i++) {
        scale(&r, factors[i]);
        plausible_result(&warnings, &r.analysis.design.mesh, r.u, 1,
                         i == 1 ? "the worst" : "another");
    }
    assert_int_equal(warnings.count, 1);
    assert_non_null(strstr(warnings.warning[0].text, "of the worst"));
    scene_run_close(&r);
}

/* Voltages that were found: only where the scene's limits leave them free, or are not kept. */
static void test_found_voltages(void **state)
{
    static const struct {
        const char *changes;
        double volt;
        int fires;
    } cases[] = {{ACTUATED, 252.5, 1},
                 {ACTUATED, -252.5, 1},
                 {ACTUATED, 247.5, 0},
                 {ACTUATED "limits={voltage: [-300, 300]}", 252.5, 0},
                 {ACTUATED "limits={voltage: [-9, 9]}", 252.5, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        plausible warnings;
        scene_run r;
        memset(&warnings, 0, sizeof warnings);
        open_run(&r, PLATE, with(METRES, cases[i].changes));
        plausible_voltages(&warnings, &r.scene, &cases[i].volt, "the test");
        assert_int_equal(warnings.count, cases[i].fires);
        scene_run_close(&r);
    }
}

/* ---- meshes and laminates ---------------------------------------------- */

/* Law: each number of a general mesh that is out of its range is warned of, with its cure. */
static void test_general_mesh(void **state)
{
    (void)state;
    static const char *const rule[] = {"irregular_mesh", "coarse_mesh", "twisted_strip",
                                       "narrow_element"};
    static const quad_report bad = {3, 2, 1, 4, 200, 0.3, 0.2}, good = {.jacobian = 0.31};
    const scene scene = {.name = "scene"};
    const quad_mesh quads = {.nodes = 4};
    mesh mesh = {.scene = &scene, .quads = &quads, .elements = 1, .quad_report = bad};
    plausible warnings;
    memset(&warnings, 0, sizeof warnings);
    plausible_mesh(&warnings, &mesh);
    assert_int_equal(warnings.count, 4);
    for (int k = 0; k < 4; k++)
        assert_true(find_rule(&warnings, rule[k]) && strchr(warnings.warning[k].text, ';'));
    memset(&warnings, 0, sizeof warnings);
    mesh.quad_report = good;
    plausible_mesh(&warnings, &mesh);
    assert_int_equal(warnings.count, 0);
}

/*
 * Law: a soft core between stiff faces is warned of where its shear counts, and with the shear from
 * equilibrium where the faces bend by themselves. A plate of one material is not.
 */
static void test_soft_core(void **state)
{
    (void)state;
    static const struct {
        const char *shear, *core, *rule;
    } row[] = {{"uniform", "1", NULL},
               {"equilibrium", "1", NULL},
               {"uniform", "0.001", "uniform_shear"},
               {"equilibrium", "0.01", NULL},
               {"equilibrium", "0.0001", "faces"}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char changes[500];
        plausible warnings;
        scene_run r;
        memset(&warnings, 0, sizeof warnings);
        snprintf(changes, sizeof changes,
                 "element={preset: improved, shear: %s};materials={face: {E: 1, nu: 0.3}, core: "
                 "{E: %s, nu: 0.3}};layers=[{material: face, thickness: 0.002}, {material: core, "
                 "thickness: 0.016}, {material: face, thickness: 0.002}]",
                 row[i].shear, row[i].core);
        open_run(&r, "vlasov-plate", changes);
        plausible_mesh(&warnings, &r.analysis.design.mesh);
        assert_int_equal(warnings.count, row[i].rule != NULL);
        assert_true(!row[i].rule || find_rule(&warnings, row[i].rule));
        scene_run_close(&r);
    }
}

/* Law: a thickness out of proportion to the structure is warned of, on both sides of both limits.
 */
static void test_slenderness(void **state)
{
    (void)state;
    static const double factor[4] = {0.99e-5, 1.01e-5, 0.49, 0.51}; /* of the shorter side */
    for (int i = 0; i < 4; i++) {
        char changes[200];
        plausible warnings = {.count = 0};
        scene_run r;
        open_run(&r, "vlasov-plate", "");
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int node = 0; node < r.analysis.design.mesh.nodes; node++) {
            low = fmin(low, r.analysis.design.mesh.point[node].position[0]);
            high = fmax(high, r.analysis.design.mesh.point[node].position[0]);
        }
        scene_run_close(&r);
        snprintf(changes, sizeof changes, "layers=[{material: plate, thickness: %.17g}]",
                 factor[i] * (high - low));
        open_run(&r, "vlasov-plate", changes);
        plausible_mesh(&warnings, &r.analysis.design.mesh);
        assert_int_equal(find_rule(&warnings, "slenderness") != NULL, i == 0 || i == 3);
        scene_run_close(&r);
    }
}

/* Law: a thickness of more than a fifth of the smallest radius of curvature is warned of. */
static void test_thick_curvature(void **state)
{
    (void)state;
    static const double thickness[2] = {0.199, 0.201}; /* over the radius of 25 */
    for (int i = 0; i < 2; i++) {
        char changes[100];
        plausible warnings = {.count = 0};
        scene_run r;
        snprintf(changes, sizeof changes, "layers.0.thickness=%.17g", 25 * thickness[i]);
        open_run(&r, "scordelis-lo", changes);
        plausible_mesh(&warnings, &r.analysis.design.mesh);
        assert_int_equal(find_rule(&warnings, "thick_curvature") != NULL, i == 1);
        scene_run_close(&r);
    }
}

/*
 * Law: places from a file in another unit than the scene's are warned of by the thickness over the
 * shorter side (0.2 m), on both sides of both limits, and heights in another unit than x and y by
 * their range over that side. The points of a saddle are 0.3 m x 0.2 m, with heights of +-1 unit.
 */
static void test_places_in_another_unit(void **state)
{
    (void)state;
    static const struct {
        double thickness, height;
        const char *rule;
    } row[] = {
        {1.98e-5, 0.01, "file_slenderness"}, {2.02e-5, 0.01, NULL}, {0.098, 0.01, NULL},
        {0.102, 0.01, "file_slenderness"},   {2e-3, 0.29, NULL},    {2e-3, 0.31, "points_height"}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char changes[800];
        plausible warnings;
        scene_run r;
        memset(&warnings, 0, sizeof warnings);
        const double z = row[i].height;
        snprintf(changes, sizeof changes,
                 "element=improved;surface={type: points, points: [[0, 0, %g], [0.3, 0, %g], "
                 "[0, 0.2, %g], [0.3, "
                 "0.2, %g]]};mesh={theta1: {elements: 6}, theta2: {elements: 6}};"
                 "layers=[{material: plate, thickness: %.17g}];outputs=[];loads=[];"
                 "supports=[{edge: theta1-, fix: clamped}]",
                 z, -z, -z, z, row[i].thickness);
        if (scene_run_open(&r, "vlasov-plate", changes) < 0)
            fail_msg("%s", r.error);
        plausible_mesh(&warnings, &r.analysis.design.mesh);
        for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
            const bool is_expected =
                row[k].rule && row[i].rule && strcmp(row[i].rule, row[k].rule) == 0;
            if (row[k].rule && (find_rule(&warnings, row[k].rule) != NULL) != is_expected)
                fail_msg("row %zu: %s", i, row[k].rule);
        }
        scene_run_close(&r);
    }
}

/* ---- shipped scenes --------------------------------------------------- */

/*
 * What `pzs solve` warns of in the shipped scenes, in the order of the rules. Scenes of unit loads
 * and moduli (crossply, vlasov-plate, varadan-cylinder) have no units; ratios are judged there as
 * everywhere.
 */
static const struct {
    const char *scene, *warnings;
} shipped[] = {
    {"annular-plate", ""},
    {"bimorph-actuator", ""},
    {"bimorph-sensor", " displacement"},
    {"clamped-plate", ""},
    {"crawley-lazarus", " displacement"},
    {"crossply", " uniform_shear displacement strain"},
    {"cylinder-contact", " strain"},
    {"hemisphere", " strain"},
    {"hemisphere-linear", " displacement"},
    {"hyperboloid", " strain"},
    {"hyperboloid-patches", " limit_field strain"},
    {"hyperboloid-soft", " strain"},
    {"mirror", ""},
    {"pinched-cylinder", ""},
    {"plate-50-patches", " limit_field"},
    {"plate-closed-loop", " limit_field"},
    {"plate-few-sensors", " limit_field"},
    {"ring-contact", " strain"},
    {"ring-follower", " strain"},
    {"roll-up", " strain"},
    {"scordelis-lo", " displacement"},
    {"spiral", ""},
    {"torus-contact", " strain"},
    {"torus-pressure", " strain"},
    {"torus-spline", " strain"},
    {"varadan-cylinder", " displacement strain"},
    {"vlasov-plate", " displacement strain"},
};

static void test_shipped(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof shipped / sizeof *shipped; i++) {
        char found[400] = "";
        plausible warnings;
        scene_run r;
        memset(&warnings, 0, sizeof warnings);
        solve_run(&r, shipped[i].scene, "");
        plausible_scene(&warnings, &r.scene);
        plausible_mesh(&warnings, &r.analysis.design.mesh);
        plausible_result(&warnings, &r.analysis.design.mesh, r.u, !r.analysis.is_nonlinear,
                         "the solution");
        for (int k = 0; k < warnings.count; k++)
            snprintf(found + strlen(found), sizeof found - strlen(found), " %s",
                     warnings.warning[k].rule);
        if (strcmp(found, shipped[i].warnings) != 0)
            fail_msg("%s warns of%s, expected%s", shipped[i].scene, found, shipped[i].warnings);
        scene_run_close(&r);
    }
}

/*
 * Law: where twice as many load steps end before the full load, the warning tells how much of it
 * they reach, and no number is infinite.
 */
static void test_path_end(void **state)
{
    (void)state;
    scene_run run;
    plausible warnings = {.count = 0};
    open_run(&run, "cantilever", "");
    plausible_path(&warnings, &run.scene, HUGE_VAL, 0.43, 0);
    assert_int_equal(warnings.count, 1);
    assert_string_equal(warnings.warning[0].rule, "path_end");
    assert_true(warnings.warning[0].value == 0.43);
    assert_non_null(strstr(warnings.warning[0].text, "end before the full load: 0.43 of it"));
    plausible_path(&warnings, &run.scene, 0.02, 1, 0);
    assert_int_equal(warnings.count, 2);
    assert_string_equal(warnings.warning[1].rule, "path");
    scene_run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_path_end),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_depolarising_voltage),
        cmocka_unit_test(test_strengths),
        cmocka_unit_test(test_strength_bands),
        cmocka_unit_test(test_target),
        cmocka_unit_test(test_sudden_loads),
        cmocka_unit_test(test_unitless),
        cmocka_unit_test(test_small_electrode),
        cmocka_unit_test(test_distant_place),
        cmocka_unit_test(test_tested_hysteresis),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_electric_and_thermal),
        cmocka_unit_test(test_stacks),
        cmocka_unit_test(test_point_resolution),
        cmocka_unit_test(test_no_dent),
        cmocka_unit_test(test_edge_resolution),
        cmocka_unit_test(test_displacement),
        cmocka_unit_test(test_strain),
        cmocka_unit_test(test_strain_of_rotation),
        cmocka_unit_test(test_worst),
        cmocka_unit_test(test_found_voltages),
        cmocka_unit_test(test_general_mesh),
        cmocka_unit_test(test_soft_core),
        cmocka_unit_test(test_slenderness),
        cmocka_unit_test(test_thick_curvature),
        cmocka_unit_test(test_places_in_another_unit),
        cmocka_unit_test(test_shipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
