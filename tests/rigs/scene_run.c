/* A scene run as a user runs it (scene_run.h). */
#include "pzs.h"
#include "scene_run.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CHANGES = 24 };

int scene_run_open(scene_run *r, const char *name, const char *changes)
{
    char path[512], text[4096];
    const char *set[MOST_CHANGES];
    int sets = 0;
    memset(r, 0, sizeof *r);
    snprintf(path, sizeof path, strchr(name, '/') ? "%s" : SCENE_FOLDER "/%s.yaml", name);
    snprintf(text, sizeof text, "%s", changes);
    for (char *part = strtok(text, ";"); part && sets < MOST_CHANGES; part = strtok(NULL, ";"))
        set[sets++] = part;
    if (scene_read(&r->scene, path, set, sets, r->error) < 0 ||
        analysis_prepare(&r->analysis, &r->scene, r->error) < 0)
        return -1;
    r->u = calloc((size_t)r->analysis.design.mesh.free_dof, sizeof *r->u);
    r->output = calloc((size_t)r->analysis.design.structure.output.count + 1, sizeof *r->output);
    snprintf(r->error, sizeof r->error, "out of memory");
    return r->u && r->output ? 0 : -1;
}

int scene_run_solve(scene_run *r)
{
    const int status = analysis_solve(&r->analysis, r->u, r->error);
    scene_run_observe(r, r->u);
    return status;
}

void scene_run_observe(scene_run *r, const double *u)
{
    pzs_observe(&r->analysis.design.structure, u, r->output);
}

double scene_run_value(const scene_run *r, int k)
{
    return analysis_output(&r->analysis, k, 0, r->output);
}

void scene_run_close(scene_run *r)
{
    analysis_free(&r->analysis);
    scene_free(&r->scene);
    free(r->u);
    free(r->output);
    memset(r, 0, sizeof *r);
}
