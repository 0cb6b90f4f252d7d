/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shape errors for a target that is a list of shapes (modes of the target), each taken as the only
 * target (modes.h).
 */
#include "modes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../system/progress.h"

/*
 * For one of several target shapes that the scene file gives as alternatives, optimise the voltages
 * without voltage limits. Store the relative shape error of this optimum and its largest absolute
 * voltage.
 */
static int run_unconstrained(analysis *analysis, mode *mode, char *error)
{
    voltages result;
    const int failed =
        voltages_optimum(analysis, (common_limits){.source = LIMITS_NONE}, &result, error);
    mode->unconstrained_error = result.error;
    for (int k = 0; !failed && k < result.amplifiers; k++)
        mode->largest_voltage = fmax(mode->largest_voltage, fabs(result.voltage[k]));
    voltages_free(&result);
    return failed;
}

static int run_limited(analysis *analysis, common_limits limit, mode_left *result, char *error)
{
    voltages best, cut, tuned;
    memset(&cut, 0, sizeof cut);
    memset(&tuned, 0, sizeof tuned);
    const int failed = voltages_optimum(analysis, limit, &best, error) < 0 ||
                       voltages_clipped(analysis, limit, &cut, error) < 0 ||
                       voltages_regularised(analysis, limit, &tuned, error) < 0;
    memcpy(result->limit, best.limit, sizeof result->limit);
    result->optimum = best.error;
    result->active_limits = best.active_limits;
    result->clipped = cut.error;
    result->regularised = tuned.error;
    voltages_free(&best);
    voltages_free(&cut);
    voltages_free(&tuned);
    return failed ? -1 : 0;
}

/*
 * Root mean square of the target displacements, weighted with the weights of the target rows
 * (controlled displacements).
 */
static double target_size(const design *design)
{
    double weights = 0;
    for (int i = 0; i < design->targets; i++)
        weights += pow(design->weight[i], 2);
    return sqrt(design_squares(design, design->target, NULL) / weights);
}

/*
 * Compute the shape errors and the largest voltage for target shape number k, where the scene file
 * gives several shapes as alternative targets.
 *   loaded  [targets] in  displacement under the scene's loads, which is subtracted from the target
 *           shape
 */
static int run_mode(modes *modes, int k, analysis *analysis, const double *loaded,
                    const common_limits *limit, char *error)
{
    design *design = &analysis->design;
    const scene_mode *wanted = &design->goal.mode[k];
    if (design_target_values(design, wanted->value, wanted->at, design->target, error) < 0)
        return -1;
    for (int i = 0; i < design->targets; i++)
        design->wanted[i] = design->target[i] - loaded[i];
    modes->mode[k].size = target_size(design);
    int failed = run_unconstrained(analysis, &modes->mode[k], error);
    for (int bound = 0; !failed && bound < modes->limits; bound++)
        failed =
            run_limited(analysis, limit[bound], &modes->left[k * modes->limits + bound], error);
    return failed;
}

int modes_run(modes *modes, analysis *analysis, const common_limits *limit, int limits, char *error)
{
    design *design = &analysis->design;
    const size_t targets = (size_t)design->targets, count = (size_t)design->goal.modes;
    memset(modes, 0, sizeof *modes);
    modes->limits = limits;
    modes->mode = calloc(count + 1, sizeof *modes->mode);
    modes->left = calloc(count * (size_t)limits + 1, sizeof *modes->left);
    double *kept = calloc(3 * targets + 1,
                          sizeof *kept); /* [3][targets] copies of the target shape and of the
                                            displacements that the voltages are to cause (target
                                            less displacement under loads), and their difference */
    int failed =
        !modes->mode || !modes->left || !kept
            ? scene_fault(design->goal.what.at, error, "%zu modes do not fit into memory", count)
            : 0;
    if (!failed) {
        memcpy(kept, design->target, targets * sizeof *kept);
        memcpy(kept + targets, design->wanted, targets * sizeof *kept);
        for (size_t i = 0; i < targets; i++)
            kept[2 * targets + i] = kept[i] - kept[targets + i];
        for (; !failed && modes->count < (int)count; modes->count++) {
            progress_count(modes->count, (int)count);
            failed = run_mode(modes, modes->count, analysis, kept + 2 * targets, limit, error);
        }
        memcpy(design->target, kept, targets * sizeof *kept);
        memcpy(design->wanted, kept + targets, targets * sizeof *kept);
    }
    free(kept);
    return failed;
}

void modes_free(modes *modes)
{
    free(modes->mode);
    free(modes->left);
    memset(modes, 0, sizeof *modes);
}
