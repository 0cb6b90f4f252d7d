/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs calibrate --hysteresis` (calibrate_hysteresis.h). */
#include "calibrate_hysteresis.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "../model/identify.h"
#include "../text/json.h"
#include "outfile.h"

enum { USUAL_PLAYS = 8 };

static int complain(const char *text)
{
    fprintf(stderr, "pzs: %s\n", text);
    return OPTIONS_WRONG;
}

static void print_list(FILE *file, const char *key, const scene_short_list *list)
{
    fprintf(file, "  %s: [", key);
    for (int i = 0; i < list->count; i++)
        fprintf(file, "%s%.6g", i ? ", " : "", list->value[i]);
    fputs("]\n", file);
}

/* Print the section `hysteresis` of a scene file in YAML. */
static void print_section(FILE *file, const scene_hysteresis *hysteresis)
{
    fprintf(file, "hysteresis:\n  range: [%.6g, %.6g]\n", hysteresis->range[0],
            hysteresis->range[1]);
    print_list(file, "slopes", &hysteresis->slope);
    print_list(file, "slack", &hysteresis->slack);
    print_list(file, "above", &hysteresis->above);
    print_list(file, "below", &hysteresis->below);
    fprintf(file, "  offset: %.6g\n", hysteresis->offset);
    print_list(file, "creep_time", &hysteresis->creep_time);
    print_list(file, "creep", &hysteresis->creep);
}

static int write_section(const identification *found, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    print_section(output.file, &found->hysteresis);
    return outfile_end(&output, ferror(output.file));
}

static void print_result(const identification *found, const pokes *samples, const char *path)
{
    printf("%lu samples: position %.6g per volt of effect, over the full range of the voltage\n",
           (unsigned long)samples->count, found->gain);
    printf(
        "  error of the fit over the range of the position: %.3g%% (root mean square), %.3g%% at "
        "most;\n  a straight line leaves %.3g%%\n",
        100 * found->rms, 100 * found->largest, 100 * found->straight);
    if (path)
        printf("%s: the section for a scene\n", path);
    else
        print_section(stdout, &found->hysteresis);
}

static void print_json(const identification *found, const pokes *samples)
{
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_number(&json, "samples", (double)samples->count);
    json_number(&json, "gain", found->gain);
    json_number(&json, "fit_rms", found->rms);
    json_number(&json, "fit_largest", found->largest);
    json_number(&json, "straight_line_rms", found->straight);
    json_close(&json, '}');
}

/*
 * Shortest and longest accepted duration of a sweep, a measurement in which the voltage of an
 * actuator rises and falls (s). Outside this range, the number of samples a second that the user
 * has stated must be wrong.
 */
static const double shortest = 1e-4, longest = 1e8;

/*
 * Check the duration of a sweep, a measurement in which the voltage rises and falls; the identified
 * creep of the actuator depends on this duration. Returns 0, or an exit code.
 */
static int check_duration(const pokes *samples, double rate)
{
    char text[200];
    const double duration = (double)samples->count / rate;
    if (duration >= shortest && duration <= longest)
        return 0;
    snprintf(text, sizeof text,
             "--hysteresis %g: a sweep of %lu samples would last %.3g s, and sweeps last %g to %g "
             "s; write the samples a second of the sweep",
             rate, (unsigned long)samples->count, duration, shortest, longest);
    return complain(text);
}

int calibrate_hysteresis(const options *options, const pokes *samples)
{
    char error[SCENE_ERROR];
    identification found;
    if (samples->actuators != 1)
        return complain("a sweep has one column of voltages; sweep all electrodes alike");
    if (check_duration(samples, options->sample_rate) != 0)
        return OPTIONS_WRONG;
    double *position = calloc(samples->count + 1, sizeof *position);
    if (!position)
        return complain("out of memory");
    for (size_t i = 0; i < samples->count; i++)
        for (size_t k = 0; k < samples->outputs; k++)
            position[i] += samples->shape[i * samples->outputs + k] / (double)samples->outputs;
    const sweep sweep = {samples->count, samples->voltage, position, options->sample_rate};
    int status = identify(&found, &sweep, USUAL_PLAYS, 0, error) < 0 ? complain(error) : 0;
    if (status == 0 && options->output)
        status = write_section(&found, options->output);
    if (status == 0 && options->as_json)
        print_json(&found, samples);
    else if (status == 0)
        print_result(&found, samples, options->output);
    free(position);
    return status;
}
