/* SPDX-License-Identifier: BSD-2-Clause */
/* What the commands of pzs share (command_parts.h). */
#define _POSIX_C_SOURCE 200809L
#include "command_parts.h"
#include <stdio.h>
#include <sys/stat.h>
#include "../system/progress.h"
#include "outfile.h"

int complain(const char *error, int code)
{
    progress_stop();
    fprintf(stderr, "pzs: %s\n", error);
    return code;
}

/* Print that a shipped scene does not exist, with the most similar name. Returns an exit code. */
static int no_scene(const char *name)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    shipped_suggest(&near, name);
    fprintf(stderr,
            "pzs: no shipped scene '%s'%s; see pzs list; a file needs its ending, as %s.yaml\n",
            name, suggest_text(&near, text), name);
    return OPTIONS_WRONG;
}

int find_scene(const options *options, char path[OPTIONS_PATH])
{
    struct stat there;
    shipped_path(options->scene, path);
    if (shipped_is_name(options->scene) && stat(path, &there) != 0)
        return no_scene(options->scene);
    return 0;
}

int open_scene(const options *options, scene *scene)
{
    char path[OPTIONS_PATH], error[SCENE_ERROR];
    const int status = find_scene(options, path);
    if (status)
        return status;
    return scene_read(scene, path, options->set, options->sets, error) == 0
               ? 0
               : complain(error, OPTIONS_WRONG);
}

int failed_code(const analysis *analysis)
{
    return analysis_ended_early(analysis) ? 1 : OPTIONS_WRONG;
}

int estimate_error(const options *options, const scene *scene, const mesh_values *values,
                   mesh_measure *measure, const void *context, mesh_error *result)
{
    char error[SCENE_ERROR];
    if (!options->estimates_error)
        return 0;
    progress_stage("coarser meshes");
    if (mesh_error_make(result, scene, values, measure, context, error) < 0)
        return complain(error, OPTIONS_WRONG);
    return 0;
}

int write_reports(const options *options, write_report *write, const void *result)
{
    const char *const path[2] = {options->report, options->svg};
    int status = 0;
    for (int k = 0; k < 2 && status == 0; k++) {
        outfile output;
        if (!path[k])
            continue;
        status = outfile_begin(&output, path[k]);
        if (status)
            break;
        const report_job job = {output.file, k == 1, options->words, options->words_given};
        status = outfile_end(&output, write(&job, result));
    }
    return status;
}

int write_vtu(const vtk_solution *solution, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    return outfile_end(&output, vtk_write_solution(output.file, solution));
}
