/*
 * Laws of retired scene keys: each is refused with its new name, and the migration of a scene
 * replaces them, keeps every other byte, and means the same.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/scene/scene.h"
#include "../../host_tools/scene/scene_migrate.h"

static char file[] = "/tmp/test_migrate_XXXXXX";

/* A scene in which the sections of a case stand between `target` and the end. */
#define HEAD                                                                                       \
    "name: t   # what it is\n"                                                                     \
    "kinematics: nonlinear\n"                                                                      \
    "surface: {type: plate}\n"                                                                     \
    "mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {points: [0, 0.5, 1]}}\n"               \
    "materials: {pzt: {E: 60e9, nu: 0.3, d31: 1e-10}}\n"                                           \
    "layers: [{name: top, material: pzt, thickness: 1e-3}]\n"                                      \
    "patches: [{name: p, layer: top, grid: [2, 1]}]\n"                                             \
    "actuators: [{name: v, drives: [{patches: p}]}]\n"                                             \
    "supports: [{edge: theta1-, fix: clamped}]\n"                                                  \
    "loads: [{face: outer, pressure: 1}]\n"                                                        \
    "outputs: [{name: tip, u3: middle, at: {theta1: 2, theta2: 0}}]\n"                             \
    "target: {u3: middle, at: nodes, value: x*y}\n"

static void write_text(const char *text)
{
    FILE *const out = fopen(file, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(text, 1, strlen(text), out), strlen(text));
    fclose(out);
}

/* Return the migrated text of a scene with the given sections. */
static char *migrated(const char *sections)
{
    char all[4000], error[SCENE_ERROR], *text;
    size_t bytes;
    snprintf(all, sizeof all, "%s%s", HEAD, sections);
    write_text(all);
    if (scene_migrate(file, &text, &bytes, error) != 0)
        fail_msg("%s", error);
    assert_int_equal(strlen(text), bytes);
    return text;
}

/* ---- names ------------------------------------------------------------ */

static const struct {
    const char *before, *after;
} texts[] = {
    {"", ""},
    {"dof_per_node: 7 # unknowns: 7\n", "dof_per_node: 7 # unknowns: 7\n"},
    {"unknowns:   7 # dof\n", "dof_per_node:   7 # dof\n"},
    {"\"unknowns\": '7'\n", "\"dof_per_node\": '7'\n"},
    {"element: source\n", "element: published\n"},
    {"element: {preset: \"corrected\", tau: 1}\n", "element: {preset: \"improved\", tau: 1}\n"},
    {"equilibrium:\n    steps: 2\n    change: 1e-6   # change\n    mixed: 0\n    systems: 50\n",
     "equilibrium:\n    load_steps: 2\n    tolerance: 1e-6   # change\n"
     "    extrapolated_iterations: 0\n    linear_solves: 50\n"},
    {"limits: {slew: 20, effort: {relative: 0.1}}\n",
     "limits: {step_limit: 20, regularisation: {relative: 0.1}}\n"},
    {"estimate: {readings: [{output: tip, noise: 1}], volts: 3}\n",
     "estimate: {readings: [{output: tip, noise: 1}], voltages: 3}\n"},
    {"simulate:\n  ticks: 9\n  influence: rest # rest\n  events:\n"
     "  - {at: 1, load: 0, amount: 2, known: yes}\n  - {at: 2, nan: 1, ticks: 2}\n"
     "  - {at: 3, frozen: 1, ticks: 2}\n  - {at: 4, lost: 1}\n  - {at: 5, dead: [v], told: found}\n"
     "  - {told: 3, stuck: [v], at: 6}\n",
     "simulate:\n  ticks: 9\n  influence: undeformed # rest\n  events:\n"
     "  - {at: 1, load: 0, factor: 2, feed_forward: yes}\n"
     "  - {at: 2, missing_sensors: 1, ticks: 2}\n  - {at: 3, stuck_sensors: 1, ticks: 2}\n"
     "  - {at: 4, missed_ticks: 1}\n  - {at: 5, dead: [v], announced: detected}\n"
     "  - {announced: 3, stuck: [v], at: 6}\n"},
    /* an alias repeats a node, whose text is replaced once */
    {"simulate: {ticks: 9, events: [&e {at: 5, dead: [v], told: 0}, *e]}\n",
     "simulate: {ticks: 9, events: [&e {at: 5, dead: [v], announced: 0}, *e]}\n"},
    /* characters of several bytes in front of a key, and line ends of two */
    {"about: \xC3\xA4\xE2\x82\xAC\r\nlimits: {voltage: [-1, 1], \"effort\": 0}\r\n",
     "about: \xC3\xA4\xE2\x82\xAC\r\nlimits: {voltage: [-1, 1], \"regularisation\": 0}\r\n"},
    /* the tick rate moves, and a step limit becomes a rate limit if the quotient is exact */
    {"limits: {slew: 20, effort: 0} # 20 V\n# loop\nsimulate:\n  ticks: 9\n  rate: 1000  # Hz\n"
     "  seed: 2\n",
     "limits: {rate_limit: 20000, regularisation: 0} # 20 V\ncontrol:\n  rate: 1000  # Hz\n# loop\n"
     "simulate:\n  ticks: 9\n  seed: 2\n"},
    {"limits: {slew: 0.1}\nsimulate: {ticks: 9, rate: 500, seed: 2}\n",
     "limits: {rate_limit: 50}\ncontrol: {rate: 500}\nsimulate: {ticks: 9, seed: 2}\n"},
    {"limits: {slew: 1/3}\nsimulate: {ticks: 9, rate: '4'}\n",
     "limits: {rate_limit: 1.3333333333333333}\ncontrol: {rate: '4'}\nsimulate: {ticks: 9}\n"},
    {"units: {voltage: V}\nlimits: {slew: 0.02 kV}\nsimulate:\n  rate: 1 kHz\n  ticks: 9",
     "units: {voltage: V}\nlimits: {rate_limit: 20000}\ncontrol:\n  rate: 1 kHz\nsimulate:\n  "
     "ticks: 9"},
    {"limits: {slew: 1e59}\nsimulate: {rate: 1000, ticks: 9}\n",
     "limits: {step_limit: 1e59}\ncontrol: {rate: 1000}\nsimulate: {ticks: 9}\n"},
};

/* Migration replaces names and keeps every other byte; a migrated scene needs no migration. */
static void test_texts(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char expected[4000];
        char *const first = migrated(texts[i].before), *const second = migrated(texts[i].after);
        snprintf(expected, sizeof expected, "%s%s", HEAD, texts[i].after);
        assert_string_equal(first, expected);
        assert_string_equal(second, expected);
        free(first);
        free(second);
    }
}

/* ---- meaning ---------------------------------------------------------- */

/*
 * Whatever the step limit and the tick rate, the migrated scene has exactly that step limit: the
 * quotient rate_limit / rate, rounded, or the step limit itself.
 */
static void test_step_limit_bits(void **state)
{
    uint64_t random = 88172645463325252u;
    int rates = 0;
    (void)state;
    for (int i = 0; i < 400; i++) {
        char sections[200], error[SCENE_ERROR];
        double number[2];
        scene scene;
        for (int k = 0; k < 2; k++) {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            number[k] = (double)(random >> 11) * 0x1p-53 * 1000 + 1e-3;
        }
        snprintf(sections, sizeof sections,
                 "limits: {slew: %.17g}\nsimulate: {ticks: 9, rate: %.17g}\n", number[0],
                 number[1]);
        char *const text = migrated(sections);
        if (scene_read_text(&scene, file, text, strlen(text), error) != 0)
            fail_msg("%s", error);
        assert_true(scene.limits.step_limit == number[0] && scene.control.rate == number[1]);
        rates += strstr(text, "rate_limit") != NULL;
        scene_free(&scene);
        free(text);
    }
    assert_in_range(rates, 200, 400);
}

/* ---- refusals --------------------------------------------------------- */

static void assert_refused(const char *sections, const char *const *set, int sets,
                           const char *expected)
{
    char all[4000], error[SCENE_ERROR];
    scene scene;
    snprintf(all, sizeof all, "%s%s", HEAD, sections);
    write_text(all);
    if (scene_read(&scene, file, set, sets, error) == 0)
        fail_msg("accepted: %s", sections);
    if (!strstr(error, expected))
        fail_msg("expected '%s', got '%s'", expected, error);
}

/* The reader answers each retired name with the new one, with the place, and reads nothing else. */
static void test_refused(void **state)
{
    static const char *const rows[][2] = {
        {"unknowns: 7\n", ":13:1: 'unknowns' in scene is now called 'dof_per_node'"},
        {"equilibrium: {steps: 2}\n", ":13:15: 'steps' in equilibrium is now called 'load_steps'"},
        {"equilibrium: {change: 2}\n", "'change' in equilibrium is now called 'tolerance'"},
        {"equilibrium: {mixed: 2}\n",
         "'mixed' in equilibrium is now called 'extrapolated_iterations'"},
        {"equilibrium: {systems: 2}\n", "'systems' in equilibrium is now called 'linear_solves'"},
        {"limits: {slew: 2}\n",
         "'slew' in limits is now called 'step_limit' in volts a tick, or 'rate_limit' in volts "
         "per second"},
        {"limits: {effort: 2}\n", "'effort' in limits is now called 'regularisation'"},
        {"estimate: {readings: [{output: tip, noise: 1}], volts: 3}\n",
         "'volts' in estimate is now called 'voltages'"},
        {"simulate: {ticks: 9, rate: 5}\n",
         "'rate' in simulate is now called 'control: {rate: ...}'"},
        {"simulate: {ticks: 9, influence: rest}\n",
         "'influence: rest' is now called 'undeformed'; write 'undeformed'"},
        {"simulate: {ticks: 9, events: [{at: 0, dead: [v], announced: found}]}\n",
         "'announced: found' is now called 'detected'; write 'detected'"},
        {"element: {preset: source}\n", "'preset: source' is now called 'published'"},
    };
    static const char *const events[][2] = {{"nan", "missing_sensors"}, {"frozen", "stuck_sensors"},
                                            {"lost", "missed_ticks"},   {"amount", "factor"},
                                            {"told", "announced"},      {"known", "feed_forward"}};
    static const char *const set[] = {"limits={slew: 3}"};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_refused(rows[i][0], NULL, 0, rows[i][1]);
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        char sections[100], expected[100];
        snprintf(sections, sizeof sections, "simulate: {ticks: 9, events: [{at: 1, %s: 1}]}\n",
                 events[i][0]);
        snprintf(expected, sizeof expected, "'%s' in events is now called '%s'", events[i][0],
                 events[i][1]);
        assert_refused(sections, NULL, 0, expected);
    }
    assert_refused("", set, 1, "--set limits: 'slew' in limits is now called");
    /* a retired name elsewhere is unknown, and a key of a rate needs the rate */
    assert_refused("limits: {mixed: 2}\n", NULL, 0, "unknown key 'mixed' in limits");
    assert_refused("limits: {rate_limit: 2}\n", NULL, 0,
                   ":13:22: 'rate_limit: 2' is per second, but the scene has no tick rate");
    assert_refused("control: {rate: 5}\nlimits: {rate_limit: 2, step_limit: 1}\n", NULL, 0,
                   ":14:10: 'rate_limit' and 'step_limit' are both given; keep one");
    assert_refused("control: {rate: 5}\nlimits: {rate_limit: 1e-60}\n", NULL, 0,
                   "'rate_limit: 1e-60' over the tick rate");
    assert_refused("simulate: {ticks: 9}\nlimits: {rate_limit: 2}\n", NULL, 0,
                   "the scene has no tick rate");
}

static void assert_not_migrated(const char *text, const char *expected)
{
    char error[SCENE_ERROR], *result;
    size_t bytes;
    write_text(text);
    if (scene_migrate(file, &result, &bytes, error) == 0)
        fail_msg("migrated: %s", text);
    assert_null(result);
    if (!strstr(error, expected))
        fail_msg("expected '%s', got '%s'", expected, error);
}

/* What cannot be replaced in the text, and what is no valid scene, is said with its place. */
static void test_not_migrated(void **state)
{
    (void)state;
    assert_not_migrated(HEAD "\"unkn\\x6fwns\": 7\n",
                        ":13:1: 'unknowns' is not written plainly here");
    assert_not_migrated(HEAD "simulate: &s\n  ticks: 9\n  rate: 5\n",
                        ":15:3: 'rate' cannot be moved by itself");
    assert_not_migrated(HEAD "control: {}\nsimulate: {ticks: 9, rate: 5}\n",
                        ":14:22: 'rate' cannot be moved by itself");
    assert_not_migrated(HEAD "limits: {slew: -1}\n", "'step_limit: -1' must be above 0");
    assert_not_migrated("unknowns: 7\n", "'name' is missing in scene");
    assert_not_migrated("", "the file is empty");
    assert_not_migrated("name: [\n", "not YAML");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texts),
        cmocka_unit_test(test_step_limit_bits),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_not_migrated),
    };
    const int descriptor = mkstemp(file);
    if (descriptor < 0)
        return 1;
    close(descriptor);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(file);
    return failed;
}
