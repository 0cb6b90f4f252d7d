/* SPDX-License-Identifier: BSD-2-Clause */
/* Natural frequencies and loop stability on standard output (print_vibration.h). */
#include "print_vibration.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "print_matrix.h"
#include "print_mesh_error.h"
#include "../../lib/model/model.h"
#include "../model/modal.h"
#include "../text/words.h"

/* ---- modes ------------------------------------------------------------ */

/*
 * Largest static displacement of a node in one vibration mode per unit of an input (1 V for a
 * voltage); NAN for a rigid motion.
 */
static double moved_by(const design *design, const vibration *vibration, int mode, int input)
{
    return vibration->largest[mode] * vibration_static(vibration, design, mode, input);
}

/*
 * Index of the amplifier that moves a vibration mode most, or -1 where no amplifier moves the mode.
 */
static int strongest(const design *design, const vibration *vibration, int mode)
{
    int best = -1;
    double most = 0;
    for (int k = 0; k < design->amplifiers; k++) {
        const double size = fabs(moved_by(design, vibration, mode, k));
        if (size > most) {
            most = size;
            best = k;
        }
    }
    return best;
}

/* Whether voltages of amplifiers move the modes: not where the amplifiers are open. */
static bool has_inputs(const loaded_modes *modes)
{
    return modes->analysis.design.amplifiers > 0 && modes->circuit != CIRCUIT_OPEN;
}

/* Print the frequency with short-circuited electrodes and the coupling factor of a mode. */
static void print_coupling(const coupling *coupling, int mode)
{
    if (mode < coupling->count && isfinite(coupling->short_frequency[mode]))
        printf(" %16.6g", coupling->short_frequency[mode]);
    else if (mode < coupling->count)
        printf(" %16s", "-");
    if (mode < coupling->count && isfinite(coupling->squared[mode]))
        printf(" %10.6f", fmax(coupling->squared[mode], 0));
    else if (mode < coupling->count)
        printf(" %10s", "-");
}

static void print_mode(const loaded_modes *modes, int mode)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    const int input = has_inputs(modes) ? strongest(design, vibration, mode) : -1;
    printf("  %4d %16.6g", mode + 1, vibration->frequency[mode]);
    print_coupling(&modes->coupling, mode);
    for (int axis = 0; axis < 3 && vibration->mass > 0; axis++)
        printf(" %8.2f%%", 100 * vibration->effective[mode][axis] / vibration->mass);
    if (input >= 0)
        printf("   %-16s %12.4e", design->amplifier_name[input],
               fabs(moved_by(design, vibration, mode, input)));
    putchar('\n');
}

/* Print the circuits of the electrodes while the structure vibrates. */
static void print_circuit(const loaded_modes *modes)
{
    const vibration *vibration = &modes->vibration;
    const int open = vibration->open - vibration->bare;
    if (open == 0)
        fputs("electrodes short-circuited", stdout);
    else if (modes->circuit == CIRCUIT_OPEN)
        printf("%d electrode%s open", open, open == 1 ? "" : "s");
    else
        printf("%d electrode%s of sensors open, the others short-circuited", open,
               open == 1 ? "" : "s");
    if (vibration->bare > 0)
        fputs(", bare faces without charge", stdout);
    putchar('\n');
}

/*
 * Print the origin of the vibration modes: computed from the structure with its mass, or given by
 * the scene together with a measured influence matrix.
 */
static void print_source(const loaded_modes *modes)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    const char *from = design->dynamics.damping_given ? "given" : "assumed: the scene gives none";
    if (design->measured.modes > 0) {
        printf("%s: %d of %d measured natural frequencies, as the scene gives them\n", design->name,
               vibration->count, design->measured.modes);
        printf("  damping ratio of the first mode %g, %s\n", design->dynamics.damping, from);
        return;
    }
    printf("%s: natural frequencies %s, ", design->name,
           modes->is_loaded ? "about the equilibrium under loads and voltages"
                            : "in the reference state");
    print_circuit(modes);
    if (modes->is_loaded)
        printf("  first mode without loads and voltages: %.6g Hz\n", modes->first.unloaded);
    printf("  mass %.6g; damping ratio %g, %s; %d linear solves, no mode missed\n", vibration->mass,
           design->dynamics.damping, from, vibration->solves);
}

/*
 * Print the sums of the effective modal masses of all computed vibration modes, as shares of the
 * mass of the structure.
 */
static void print_sum(const loaded_modes *modes)
{
    const vibration *vibration = &modes->vibration;
    printf("  %-21s", "together");
    printf("%*s", modes->coupling.count > 0 ? 28 : 0, "");
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int i = 0; i < vibration->count; i++)
            sum += vibration->effective[i][axis] / vibration->mass;
        printf(" %8.2f%%", 100 * sum);
    }
    putchar('\n');
}

void print_vibration(const loaded_modes *modes)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    char unit[WORDS_UNIT];
    words_unit(&design->units, QUANTITY_LENGTH, unit);
    print_source(modes);
    printf("\n  %4s %16s", "mode", "frequency (Hz)");
    if (modes->coupling.count > 0)
        printf(" %16s %10s", "short-circuited", "coupling k2");
    if (vibration->mass > 0)
        printf(" %9s %9s %9s", "mass x", "mass y", "mass z");
    if (has_inputs(modes))
        printf(*unit ? "   %-16s largest displacement by 1 V (%s)"
                     : "   %-16s largest displacement by 1 V",
               "strongest input", unit);
    putchar('\n');
    for (int i = 0; i < vibration->count; i++)
        print_mode(modes, i);
    if (vibration->mass > 0)
        print_sum(modes);
    print_matrix_modes(design);
    print_mesh_error(&modes->mesh_error);
    plausible_print(stdout, &modes->warnings);
}

/*
 * Write the values of the scene's outputs in a mode whose largest displacement is one unit of
 * length, for outputs that are linear functions of the displacement.
 */
static void json_outputs(json *json, const loaded_modes *modes, int mode)
{
    const analysis *analysis = &modes->analysis;
    const design *design = &analysis->design;
    const double *shape = modes->vibration.shape + (size_t)mode * (size_t)design->mesh.free_dof;
    json_open(json, "observability", '{');
    for (int k = 0; k < design->outputs; k++) {
        if (!analysis_output_is_row(analysis, k))
            continue;
        json_open(json, design->output[k].name, '[');
        for (int i = 0; i < analysis_outputs(analysis, k); i++)
            json_number(json, NULL,
                        pzs_model_observe_row(&design->structure, shape,
                                              (uint32_t)(design->named_first[k] + i)) /
                            modes->vibration.largest[mode]);
        json_close(json, ']');
    }
    json_close(json, '}');
}

/* Write the damping ratio of each mode; null for rigid motions. */
static void json_damping(json *json, const loaded_modes *modes)
{
    const vibration *vibration = &modes->vibration;
    json_open(json, "damping", '[');
    for (int i = 0; i < vibration->count; i++)
        json_number(json, NULL, vibration_damping(vibration, &modes->analysis.design, i));
    json_close(json, ']');
}

static void json_mode(json *json, const loaded_modes *modes, int mode)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    json_open(json, NULL, '{');
    json_number(json, "frequency", vibration->frequency[mode]);
    json_numbers(json, "effective_mass", vibration->effective[mode], 3);
    if (modes->circuit != CIRCUIT_OPEN) {
        json_open(json, "controllability", '{');
        for (int k = 0; k < design->amplifiers; k++)
            json_number(json, design->amplifier_name[k], moved_by(design, vibration, mode, k));
        json_close(json, '}');
    }
    json_outputs(json, modes, mode);
    json_close(json, '}');
}

void print_vibration_json(const loaded_modes *modes)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_string(&json, "scene", design->name);
    json_number(&json, "mass", vibration->mass);
    json_number(&json, "rigid", vibration->rigid);
    json_damping(&json, modes);
    json_string(&json, "damping_from", design->dynamics.damping_given ? "scene" : "assumed");
    json_number(&json, "linear_solves", vibration->solves);
    json_string(&json, "state", modes->is_loaded ? "loaded" : "reference");
    json_number(&json, "first_unloaded", modes->first.unloaded);
    json_number(&json, "first_loaded", modes->first.loaded);
    json_number(&json, "open_electrodes", vibration->open - vibration->bare);
    json_numbers(&json, "frequency", vibration->frequency, vibration->count);
    if (modes->coupling.count > 0) {
        json_numbers(&json, "short_frequency", modes->coupling.short_frequency,
                     modes->coupling.count);
        json_numbers(&json, "coupling_squared", modes->coupling.squared, modes->coupling.count);
    }
    json_open(&json, "modes", '[');
    for (int i = 0; i < vibration->count; i++)
        json_mode(&json, modes, i);
    json_close(&json, ']');
    print_mesh_error_json(&json, &modes->mesh_error);
    plausible_json(&json, &modes->warnings);
    json_close(&json, '}');
}

/* ---- certificate ------------------------------------------------------ */

/* Print the lines of a text, each indented by two spaces. */
static void print_lines(const char *text)
{
    fputs(*text ? "  " : "", stdout);
    for (const char *letter = text; *letter; letter++)
        fputs(*letter == '\n' ? "\n  " : (char[2]){*letter, '\0'}, stdout);
    fputs(*text ? "\n" : "", stdout);
}

void print_certificate(const certificate *certificate)
{
    char text[CERTIFICATE_TEXT];
    if (!certificate->is_made)
        return;
    if (!certificate->has_modes) {
        printf("  vibration not known: %s\n", certificate->reason);
        return;
    }
    const char *origin = certificate->has_own_damping ? "given" : "assumed";
    printf("  first natural frequency%s %.4g Hz; damping ratio %g, %s\n",
           certificate->is_loaded ? " about the equilibrium under the loads" : "",
           certificate_first(certificate), certificate->damping, origin);
    certificate_text(certificate, text);
    print_lines(text);
}

/* Print why the control tick has no vibration model, and up to which tick rate it is stable. */
static void print_no_model(const certificate *certificate, bool is_quasi_static)
{
    const bool is_stable = certificate->is_assessed && !certificate_refuses(certificate);
    if (!certificate->has_modes || !certificate->is_assessed)
        printf("the tick has no vibration model, because vibration is not known: %s\n",
               certificate->reason);
    else if (certificate->has_gains)
        puts("the tick has gains of modes in the place of a vibration model");
    else if (is_quasi_static)
        puts("the tick has no vibration model, as --quasi-static asks for");
    else if (!(certificate->rate > 0))
        puts("the tick has no vibration model, because the scene gives no tick rate: write "
             "control: {rate: 1000}");
    else if (is_stable)
        puts("the tick has no vibration model and needs none at its rate");
    if (!certificate->is_assessed || certificate->has_gains || !isfinite(certificate->stable_rate))
        return;
    if (certificate->stable_rate > 0)
        printf("without a vibration model the loop is stable up to %.3g ticks a second\n",
               certificate->stable_rate);
    else
        puts("without a vibration model the loop was found stable at no tick rate");
}

void print_vibration_summary(const certificate *certificate, bool is_quasi_static)
{
    const certificate_loop *loop = &certificate->loop;
    if (loop->is_made && loop->observed > 0)
        printf("the tick damps %d mode%s from %.4g to %.4g Hz; "
               "%d of %d storms (stress tests) settle\n",
               loop->observed, loop->observed == 1 ? "" : "s", loop->observed_from,
               loop->observed_to, loop->storms - loop->failed, loop->storms);
    else if (loop->is_made)
        printf("the tick damps no mode, %s; %d of %d storms (stress tests) settle\n",
               loop->has_slow_mode ? "none moves the target enough" : "all are too fast",
               loop->storms - loop->failed, loop->storms);
    else if (certificate->is_made)
        print_no_model(certificate, is_quasi_static);
}

/*
 * Write the stability of a control loop to the JSON member "certificate": the loop of a firmware
 * with the tables that `pzs tables` writes. If these contain a vibration model, the numbers are
 * those of the loop with vibration damping, otherwise of the loop without it.
 */
static void json_stability(json *json, const certificate *certificate)
{
    const certificate_loop *loop = &certificate->loop;
    if (!certificate->is_assessed || !(certificate->rate > 0))
        return;
    json_open(json, "certificate", '{');
    json_bool(json, "stable", loop->is_made ? loop->is_stable : !certificate_refuses(certificate));
    json_number(json, "radius", loop->is_made ? loop->radius : certificate->radius);
    json_number(json, "storms", loop->storms);
    json_number(json, "storms_failed", loop->failed);
    if (loop->is_made) {
        json_number(json, "storms_worst", loop->worst);
        json_number(json, "storms_allowed", CERTIFICATE_TOLERANCE);
        json_number(json, "storms_unit", loop->unit);
        json_number(json, "hysteresis", loop->hysteresis);
        json_number(json, "storms_unseen", loop->unseen);
        json_number(json, "hysteresis_storms", loop->hysteresis_storms);
        json_number(json, "hysteresis_storms_failed", loop->hysteresis_failed);
        json_number(json, "storms_alarms", loop->fading > 0 ? loop->alarms : (double)NAN);
        if (loop->gate.is_made) {
            json_number(json, "storms_gated", loop->gate.storms);
            json_number(json, "wrong_sensor", loop->gate.sensor);
            json_number(json, "wrong_sensor_moves", loop->gate.moved);
        }
        json_number(json, "fading_periods", loop->fading > 0 ? loop->fading : (double)NAN);
        json_number(json, "target_thicknesses",
                    loop->target.is_made ? loop->target.amplitude : (double)NAN);
        json_number(json, "target_radius",
                    loop->target.is_made ? loop->target.radius : (double)NAN);
        json_number(json, "target_storms", loop->target.storms);
        json_number(json, "target_storms_failed", loop->target.failed);
        json_number(json, "target_readings_older",
                    loop->target.is_made ? loop->target.older : (double)NAN);
        json_number(json, "target_readings_newer",
                    loop->target.is_made ? loop->target.newer : (double)NAN);
        json_number(json, "modes_observed", loop->observed);
        json_number(json, "load_step_periods", loop->load_step);
        json_number(json, "residual_periods", loop->residual);
        json_bool(json, "load_step_longer", loop->load_step >= CERTIFICATE_LOAD_MOST);
        json_number(json, "readings_older", loop->older);
        json_number(json, "readings_newer", loop->newer);
    }
    if (loop->has_margins) {
        const double frequency[2] = {loop->margin_slow, loop->margin_fast};
        json_open(json, "margin", '{');
        json_number(json, "gain", loop->margin_gain);
        json_number(json, "delay", loop->older);
        json_numbers(json, "frequency", frequency, 2);
        json_close(json, '}');
    }
    json_number(json, "rate_from", loop->is_made ? loop->rate_from : 0);
    json_number(json, "rate_to", loop->is_made ? loop->rate_to : certificate->stable_rate);
    json_close(json, '}');
}

void print_certificate_json(json *json, const certificate *certificate)
{
    if (!certificate->is_made)
        return;
    json_open(json, "vibration", '{');
    if (certificate->has_modes)
        json_numbers(json, "frequency", certificate->vibration.frequency,
                     certificate->vibration.count);
    else
        json_string(json, "missing", certificate->reason);
    if (certificate->has_modes && certificate->reason[0])
        json_string(json, "not_judged", certificate->reason);
    if (certificate->is_assessed) {
        json_number(json, "damping", certificate->damping);
        json_number(json, "modes", certificate->modes);
        json_number(json, "radius", certificate->radius);
        if (certificate->rate > 0)
            json_bool(json, "stable", !certificate_refuses(certificate));
        json_number(json, "rate_to", certificate->stable_rate);
    }
    json_close(json, '}');
    json_stability(json, certificate);
}
