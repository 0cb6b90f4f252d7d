/* Scenes run on the nonlinear path (path_run.h). */
#include "path_run.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

void open_run(scene_run *r, const char *scene, const char *changes)
{
    if (scene_run_open(r, scene, changes) < 0)
        fail_msg("%s %s: %s", scene, changes, r->error);
}

void solve_run(scene_run *r, const char *scene, const char *changes)
{
    open_run(r, scene, changes);
    if (scene_run_solve(r) < 0)
        fail_msg("%s %s: %s", scene, changes, r->error);
}

pzs_path *path_of(scene_run *r)
{
    return &r->analysis.path.run;
}

size_t dof_of(const scene_run *r)
{
    return (size_t)r->analysis.design.mesh.dof;
}

double largest(const double *x, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

double apart(const double *x, const double *y, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = isfinite(x[i]) ? fmax(most, fabs(x[i] - y[i])) : HUGE_VAL;
    return most / largest(y, n);
}
