/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs calibrate --vibration` (calibrate_vibration.h). */
#include "calibrate_vibration.h"
#include <math.h>
#include <stdio.h>
#include "../model/identify_modes.h"
#include "../text/json.h"
#include "outfile.h"

enum { USUAL_MODES = 5 };

/* Print numbers in YAML, separated by commas, and the bracket that ends their list. */
static void print_list(FILE *file, const double *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        fprintf(file, "%s%.6g", i ? ", " : "", value[i]);
    fputs("]\n", file);
}

/*
 * Print measured vibration modes as the key `modes` of the section `influence` of a scene file in
 * YAML.
 */
static void print_modes(FILE *file, const identified_modes *found, const pokes *samples)
{
    fputs("influence:\n  modes:\n", file);
    for (int mode = 0; mode < found->modes; mode++) {
        fprintf(file, "    - frequency: %.7g\n      damping: %.4g\n      shape: [",
                found->frequency[mode], found->damping[mode]);
        print_list(file, found->shape + (size_t)mode * samples->outputs, samples->outputs);
        if (!found->responses.is_found)
            continue;
        fputs("      response: [", file);
        print_list(file, found->responses.value + (size_t)mode * samples->actuators,
                   samples->actuators);
    }
}

static int write_modes(const identified_modes *found, const pokes *samples, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    print_modes(output.file, found, samples);
    return outfile_end(&output, ferror(output.file));
}

/*
 * Return the largest standard error of the identified static responses of the vibration modes to
 * the voltages, relative to the largest of these responses.
 */
static double response_error(const identified_modes *found, size_t actuators)
{
    double most = 0, error = 0;
    for (size_t i = 0; i < (size_t)found->modes * actuators; i++) {
        most = fmax(most, fabs(found->responses.value[i]));
        error = fmax(error, found->responses.error[i]);
    }
    return error / most;
}

/*
 * Print whether the static responses of the vibration modes to the voltages are identified, and how
 * late the voltages act.
 */
static void print_responses(const identified_modes *found, const pokes *samples, double rate)
{
    if (found->responses.is_found)
        printf(
            "  response to the voltages: standard error at most %.2g%% of the largest; it begins "
            "%.3g s (%.3g samples) after the voltages\n"
            "  (delay of amplifiers, converters and filters); shapes of another unit of length "
            "than the scene's need another response\n",
            100 * response_error(found, samples->actuators), found->responses.delay,
            found->responses.delay * rate);
    else
        printf("  response to the voltages: not identified, because %s.\n"
               "  The scene fits it to the matrix, or takes the key response\n",
               found->responses.reason);
}

static void print_result(const identified_modes *found, const pokes *samples,
                         const options *options)
{
    const char *path = options->output;
    printf(
        "%lu samples, %d intervals of constant voltages, which show %.3g to %.3g Hz: %d mode%s\n",
        (unsigned long)samples->count, found->steps, found->shown[0], found->shown[1], found->modes,
        found->modes == 1 ? "" : "s");
    printf("  %16s %12s %14s %12s\n", "frequency (Hz)", "std. error", "damping ratio",
           "std. error");
    for (int mode = 0; mode < found->modes; mode++)
        printf("  %16.6g %12.2g %14.4g %12.2g\n", found->frequency[mode],
               found->frequency_error[mode], found->damping[mode], found->damping_error[mode]);
    if (found->twins > 0)
        printf("  %d pair%s of equal frequency, as of a round mirror: any two combinations of the "
               "shapes are modes, too\n",
               found->twins, found->twins == 1 ? "" : "s");
    printf("  the modes leave %.3g (standard deviation) of a reading, %.3g%% of the vibration\n",
           found->noise, 100 * found->left);
    print_responses(found, samples, options->vibration_rate);
    if (path)
        printf("%s: the key modes for the section influence of a scene\n", path);
    else
        print_modes(stdout, found, samples);
}

static void print_json(const identified_modes *found, const pokes *samples)
{
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_number(&json, "intervals", found->steps);
    json_number(&json, "noise", found->noise);
    json_number(&json, "left", found->left);
    json_numbers(&json, "shown", found->shown, 2);
    json_number(&json, "delay", found->responses.is_found ? found->responses.delay : (double)NAN);
    if (!found->responses.is_found)
        json_string(&json, "no_response", found->responses.reason);
    json_open(&json, "modes", '[');
    for (int mode = 0; mode < found->modes; mode++) {
        json_open(&json, NULL, '{');
        json_number(&json, "frequency", found->frequency[mode]);
        json_number(&json, "frequency_error", found->frequency_error[mode]);
        json_number(&json, "damping", found->damping[mode]);
        json_number(&json, "damping_error", found->damping_error[mode]);
        if (found->responses.is_found)
            json_numbers(&json, "response",
                         found->responses.value + (size_t)mode * samples->actuators,
                         (int)samples->actuators);
        json_close(&json, '}');
    }
    json_close(&json, ']');
    json_close(&json, '}');
}

/*
 * Largest part of the measured vibration that may remain unexplained by the identified vibration
 * modes without a warning.
 */
static const double usual_left = 0.1;

/*
 * Warn where the identified vibration modes explain too little of the measured vibration, and of
 * vibration modes whose damping ratio is smaller than its standard error.
 */
static void warn_of_modes(const identified_modes *found)
{
    const char *head = "\nWarnings:\n";
    if (found->left > usual_left) {
        fprintf(stderr,
                "%s  vibration_left: the modes leave %.3g%% of the vibration, above %.3g%%: check "
                "that the voltages are those applied at these samples, check the rate, or allow "
                "more modes with --number\n",
                head, 100 * found->left, 100 * usual_left);
        head = "";
    }
    for (int mode = 0; mode < found->modes; mode++) {
        if (found->damping[mode] > found->damping_error[mode])
            continue;
        fprintf(stderr,
                "%s  uncertain_mode: mode %d, %.6g Hz: damping ratio %.3g with a standard error of "
                "%.3g; it may be no mode of the structure: lower --number, or record longer\n",
                head, mode + 1, found->frequency[mode], found->damping[mode],
                found->damping_error[mode]);
        head = "";
    }
}

int calibrate_vibration(const options *options, const pokes *samples)
{
    char error[SCENE_ERROR];
    identified_modes found;
    const int most = options->number ? options->number : USUAL_MODES;
    int status = 0;
    if (identify_modes(&found, samples, options->vibration_rate, most, error) < 0) {
        fprintf(stderr, "pzs: %s\n", error);
        status = OPTIONS_WRONG;
    }
    if (status == 0 && options->output)
        status = write_modes(&found, samples, options->output);
    if (status == 0 && options->as_json)
        print_json(&found, samples);
    else if (status == 0)
        print_result(&found, samples, options);
    if (status == 0)
        warn_of_modes(&found);
    identified_modes_free(&found);
    return status;
}
