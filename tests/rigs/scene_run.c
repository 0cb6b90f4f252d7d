/*
 * A scene run as a user runs it: read, prepared and solved (scene_run.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "scene_run.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CHANGES = 24 };

int scene_run_read(scene *scene, const char *name, const char *changes, char error[SCENE_ERROR])
{
    char path[512], text[20000];
    const char *set[MOST_CHANGES];
    int sets = 0;
    snprintf(path, sizeof path, strchr(name, '/') ? "%s" : SCENE_FOLDER "/%s.yaml", name);
    snprintf(text, sizeof text, "%s", changes);
    for (char *part = strtok(text, ";"); part && sets < MOST_CHANGES; part = strtok(NULL, ";"))
        set[sets++] = part;
    return scene_read(scene, path, set, sets, error);
}

int scene_run_open(scene_run *run, const char *name, const char *changes)
{
    memset(run, 0, sizeof *run);
    if (scene_run_read(&run->scene, name, changes, run->error) < 0 ||
        analysis_prepare(&run->analysis, &run->scene, run->error) < 0)
        return -1;
    run->u = calloc((size_t)run->analysis.design.mesh.free_dof, sizeof *run->u);
    run->output =
        calloc((size_t)run->analysis.design.structure.output.count + 1, sizeof *run->output);
    snprintf(run->error, sizeof run->error, "out of memory");
    return run->u && run->output ? 0 : -1;
}

int scene_run_solve(scene_run *run)
{
    const int status = analysis_solve(&run->analysis, run->u, run->error);
    scene_run_observe(run, run->u);
    return status;
}

void scene_run_observe(scene_run *run, const double *displacement)
{
    pzs_observe(&run->analysis.design.structure, displacement, run->output);
}

double scene_run_value(const scene_run *run, int k)
{
    return analysis_output(&run->analysis, k, 0, run->output);
}

void scene_run_close(scene_run *run)
{
    analysis_free(&run->analysis);
    scene_free(&run->scene);
    free(run->u);
    free(run->output);
    memset(run, 0, sizeof *run);
}
