/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs shape`: the optimal voltages for the target of a scene, and others to compare
 * (command_shape.h). */
#include "command_shape.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../model/voltages.h"
#include "../system/progress.h"
#include "command_parts.h"
#include "export.h"
#include "print_shape.h"

/* Compute the displacements and the shape error of a scene with all voltages zero. */
static int shape_before(shape_run *run, char *error)
{
    const design *design = &run->analysis->design;
    double *none = calloc((size_t)design->amplifiers, sizeof *none);
    const int failed = none
                           ? voltages_given(run->analysis, "no voltages", none, &run->before, error)
                           : scene_fault(design->limits.at, error, "out of memory");
    free(none);
    return failed;
}

/* Compute the voltages of all results of `pzs shape`, in the order of shape_run.results. */
static int shape_results(shape_run *run, const options *options, char *error)
{
    analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    const common_limits own = {.source = LIMITS_SCENE}, none = {.source = LIMITS_NONE};
    const common_limits *limit = options->limits ? options->limit : &own;
    const int limits = options->limits ? options->limits : 1;
    const size_t most = 1 + 4 * (size_t)limits + (size_t)design->compares;
    run->results = calloc(most, sizeof *run->results);
    if (!run->results)
        return scene_fault(design->limits.at, error, "%zu sets of voltages do not fit into memory",
                           most);
    progress_stage("voltages");
    if (shape_before(run, error) < 0 ||
        voltages_optimum(analysis, none, &run->results[run->count++], error) < 0)
        return -1;
    for (int i = 0; i < limits; i++) {
        progress_count(i, limits);
        if (voltages_optimum(analysis, limit[i], &run->results[run->count++], error) < 0 ||
            (analysis->is_nonlinear &&
             voltages_linear(analysis, limit[i], &run->results[run->count++], error) < 0) ||
            voltages_clipped(analysis, limit[i], &run->results[run->count++], error) < 0 ||
            voltages_regularised(analysis, limit[i], &run->results[run->count++], error) < 0)
            return -1;
    }
    run->compared = run->count;
    for (int i = 0; i < design->compares; i++)
        if (voltages_given(analysis, design->compare[i].name, design->compare[i].value,
                           &run->results[run->count++], error) < 0)
            return -1;
    progress_stage("modes of the target");
    return modes_run(&run->modes, analysis, limit, limits, error);
}

static int write_shape(const report_job *job, const void *result)
{
    const shape_run *run = result;
    return report_shape(job, run->analysis, run->results, run->count, &run->modes);
}

/*
 * Estimate the discretisation error of the shape error that the optimal voltages leave. The voltage
 * limits are those of the first option --limit, or those of the scene file where no such option is
 * given. Returns an exit code.
 */
static int shape_error(shape_run *run, const options *options)
{
    const common_limits own = {.source = LIMITS_SCENE};
    mesh_values values = {.count = 0};
    char error[SCENE_ERROR];
    if (!options->estimates_error)
        return 0;
    mesh_values_add(&values, mesh_shape_name, run->results[1].error);
    if (mesh_values_add_influence(&values, run->analysis, error) < 0)
        return complain(error, 1);
    return estimate_error(options, run->analysis->design.scene, &values, mesh_measure_shape,
                          options->limits ? &options->limit[0] : &own, &run->analysis->mesh_error);
}

/*
 * Return the numbers that the plausibility warnings on the target use:
 *   - the size of the target;
 *   - the error and the largest voltage (relative to its limit) of the optimum within the first
 *     limits, those of --limit or of the scene;
 *   - the largest number of linearly dependent amplifiers in any result.
 */
static plausible_optimum optimum_of(const shape_run *run)
{
    const design *design = &run->analysis->design;
    const voltages *best = &run->results[1];
    const double limit = fmax(fabs(best->limit[0]), fabs(best->limit[1]));
    double largest = 0, entry = 0;
    int dependent = 0;
    for (int i = 0; i < run->count; i++)
        dependent = run->results[i].dependent > dependent ? run->results[i].dependent : dependent;
    for (int i = 0; i < design->targets; i++)
        entry = fmax(entry, fabs(design->wanted[i]));
    for (int k = 0; k < best->amplifiers; k++)
        largest = fmax(largest, fabs(best->voltage[k]));
    const double share = isfinite(limit) && limit > 0 ? largest / limit : (double)NAN;
    return (plausible_optimum){
        .target = entry > 0 ? run->before.rms / entry : 0,
        .error = best->error,
        .share = share,
        .dependent = dependent,
    };
}

/* Add plausibility warnings on the optimum, and the discretisation error. Returns an exit code. */
static int check_shape(shape_run *run, const options *options)
{
    analysis *analysis = run->analysis;
    const voltages *best = &run->results[1];
    const plausible_optimum optimum = optimum_of(run);
    plausible_voltages(&analysis->warnings, analysis->design.scene, best->voltage, best->name);
    plausible_result(&analysis->warnings, &analysis->design.mesh, best->displacement,
                     !analysis->is_nonlinear, best->name);
    plausible_target(&analysis->warnings, analysis->design.scene, &optimum);
    return shape_error(run, options);
}

/* Print the results and write them to the files that the options name. Returns an exit code. */
static int write_results(const shape_run *run, const options *options)
{
    const voltages *best = &run->results[1];
    int status = 0;
    progress_stop();
    (options->as_json ? print_shape_json : print_shape)(run);
    if (options->vtu)
        status = write_vtu(&(vtk_solution){.analysis = run->analysis,
                                           .displacement = best->displacement,
                                           .voltage = best->voltage,
                                           .shape = best->shape,
                                           .target = best->aligned_target},
                           options->vtu);
    if (status == 0)
        status = write_reports(options, write_shape, run);
    return status == 0 ? export_shape(options, run) : status;
}

int command_shape(const options *options, analysis *analysis)
{
    shape_run run;
    char error[SCENE_ERROR];
    int status;
    memset(&run, 0, sizeof run);
    run.analysis = analysis;
    analysis->is_nonlinear = analysis->design.kinematics != KINEMATICS_LINEAR;
    progress_stage("influence matrix");
    if (analysis_influence(analysis, error) < 0 || shape_results(&run, options, error) < 0)
        status = complain(error, failed_code(analysis));
    else
        status = check_shape(&run, options);
    if (status == 0)
        status = write_results(&run, options);
    for (int i = 0; i < run.count; i++)
        voltages_free(&run.results[i]);
    free(run.results);
    voltages_free(&run.before);
    modes_free(&run.modes);
    return status;
}
