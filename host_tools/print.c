/* Results on standard output (print.h). */
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "json.h"

/* ---- head ------------------------------------------------------------- */

void print_head(const analysis *a)
{
    const scene *s = a->design.scene;
    const mesh *m = &a->design.mesh;
    printf("%s: %s\n", s->name, s->about ? s->about : "");
    printf("  %d x %d elements of %d kind%s, %d nodes, %d free unknowns, half bandwidth %d\n", s->line[0].elements, s->line[1].elements,
           m->kinds, m->kinds == 1 ? "" : "s", m->nodes, m->dof, mesh_half_bandwidth(m));
    if (a->model.condition > 0)
        printf("  condition %.1e after scaling: %s\n", a->model.condition,
           a->model.condition < 1e7 ? "a float device is safe" : "a float device needs refinement, or use double");
}

static void json_head(json *j, const analysis *a)
{
    const mesh *m = &a->design.mesh;
    json_string(j, "scene", a->design.scene->name);
    json_string(j, "unit_length", a->design.scene->unit_length);
    json_number(j, "elements", m->elements);
    json_number(j, "kinds", m->kinds);
    json_number(j, "nodes", m->nodes);
    json_number(j, "dof", m->dof);
    json_number(j, "half_bandwidth", mesh_half_bandwidth(m));
    json_number(j, "condition", a->model.condition);
}

/* ---- solve ------------------------------------------------------------ */

/* One line for an output at a point, or the least and the most of one on many nodes; electrodes one by one. */
static void print_output(const analysis *a, int k, const double *value)
{
    const scene_output *output = &a->design.scene->output[k];
    const int count = analysis_outputs(a, k);
    const char *unit = analysis_unit(a, k);
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int i = 0; i < count; i++) {
        least = fmin(least, analysis_output(a, k, i, value));
        most = fmax(most, analysis_output(a, k, i, value));
    }
    if (count > 1 && output->electric != ELECTRIC_NONE) {
        printf("  %-20s", output->name);
        for (int i = 0; i < count; i++)
            printf(" %.6e", analysis_output(a, k, i, value));
        printf(" %s\n", unit);
        return;
    }
    if (count > 1) {
        printf("  %-20s %16.9e .. %.9e %s on %d nodes\n", output->name, least, most, unit, count);
        return;
    }
    printf("  %-20s %16.9e %s", output->name, most, unit);
    if (isfinite(output->reference))
        printf("   reference %.6e, ratio %.4f", output->reference, most / output->reference);
    putchar('\n');
}

static void print_path(const pzs_path *run)
{
    printf("  %u load step%s, %u linear systems, %s (%u negative pivots), residual %.1e\n\n", run->steps_taken, run->steps_taken == 1 ? "" : "s",
           run->systems, run->negative ? "UNSTABLE" : "stable", run->negative, run->residual);
}

void print_solve(const analysis *a, const double *value)
{
    print_head(a);
    if (a->design.scene->kinematics == KINEMATICS_AUTO)
        printf("  kinematics auto: linear differs by %.3g of the displacement, tolerance %g: %s\n", a->cost, a->design.scene->tolerance,
               a->nonlinear ? "nonlinear is needed" : "linear is enough");
    if (a->nonlinear)
        print_path(&a->path.run);
    else
        printf("  residual %.1e, estimated error %.1e in energy, %d passes\n\n", a->model.residual, a->model.error, a->model.passes);
    for (int k = 0; k < a->design.scene->outputs; k++)
        print_output(a, k, value);
}

static void json_path(json *j, const analysis *a)
{
    const pzs_path *run = &a->path.run;
    json_string(j, "status", pzs_status_text(a->status));
    json_number(j, "load_factor", run->factor);
    json_number(j, "steps", run->steps_taken);
    json_number(j, "systems", run->systems);
    json_number(j, "iterations", (double)run->systems - run->steps_taken);
    json_number(j, "residual", run->residual);
    json_number(j, "negative_pivots", run->negative);
    json_open(j, "seconds", '{');
    json_number(j, "total", a->seconds);
    json_close(j, '}');
}

/* Values of one output under its name. */
static void json_output(json *j, const analysis *a, int k, const double *value)
{
    const int count = analysis_outputs(a, k);
    double *all = calloc((size_t)count, sizeof *all);
    for (int i = 0; all && i < count; i++)
        all[i] = analysis_output(a, k, i, value);
    json_numbers(j, a->design.scene->output[k].name, all, all ? count : 0);
    free(all);
}

void print_solve_json(const analysis *a, const double *value)
{
    const design *d = &a->design;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_head(&j, a);
    json_string(&j, "kinematics", a->nonlinear ? "nonlinear" : "linear");
    if (d->scene->kinematics == KINEMATICS_AUTO)
        json_number(&j, "cost_of_linear", a->cost);
    if (a->nonlinear) {
        json_path(&j, a);
    } else {
        json_number(&j, "residual", a->model.residual);
        json_number(&j, "error", a->model.error);
        json_number(&j, "passes", a->model.passes);
    }
    json_open(&j, "outputs", '{');
    for (int k = 0; k < d->scene->outputs; k++)
        json_output(&j, a, k, value);
    json_close(&j, '}');
    json_open(&j, "ratios", '{');
    for (int k = 0; k < d->scene->outputs; k++)
        if (isfinite(d->scene->output[k].reference))
            json_number(&j, d->scene->output[k].name, analysis_output(a, k, 0, value) / d->scene->output[k].reference);
    json_close(&j, '}');
    json_close(&j, '}');
}

/* ---- shape ------------------------------------------------------------ */

static double largest(const double *x, int n)
{
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

static void limit_text(const voltages *v, char text[32])
{
    if (isinf(v->limit[0]) && isinf(v->limit[1]))
        snprintf(text, 32, "none");
    else
        snprintf(text, 32, "%g .. %g", v->limit[0], v->limit[1]);
}

/* No sign on a printed zero. */
static double rounded_volt(double volt)
{
    return fabs(volt) < 0.005 ? 0 : volt;
}

/* Volts of each actuator as its grid lies on the surface: a row along theta2 for each step of theta1. */
static void print_volts(const scene *s, const voltages *v)
{
    printf("\n  %s, volts:\n", v->name);
    for (int k = 0; k < s->actuators; k++) {
        const scene_actuator *actuator = &s->actuator[k];
        for (int i = 0; i < actuator->grid[0]; i++) {
            printf("    %-12s", i == 0 ? actuator->name : "");
            for (int j = 0; j < actuator->grid[1]; j++)
                printf(" %9.2f", rounded_volt(v->volt[actuator->first + i * actuator->grid[1] + j]));
            putchar('\n');
        }
    }
}

/* What the volts of the linear model cost on the nonlinear structure: the error that the smaller image adds. */
static double cost_of_linear(const shape_run *run)
{
    return run->volts[2].error - run->volts[1].error;
}

static const char *image_needed(const shape_run *run)
{
    return cost_of_linear(run) <= run->scene.tolerance ? "control" : "nonlinear";
}

static void print_choice(const shape_run *run)
{
    const voltages *best = &run->volts[1];
    printf("\nnonlinear structure: optimum after %d relinearisation%s, %d linear systems\n", best->relinearised,
           best->relinearised == 1 ? "" : "s", best->systems);
    printf("the linear model's volts cost %.3f%% more error there, tolerance %g%%: the firmware %s\n", 100 * cost_of_linear(run),
           100 * run->scene.tolerance, strcmp(image_needed(run), "control") == 0 ? "is served by the control or linear image"
                                                                                 : "needs the nonlinear image");
}

void print_shape(const shape_run *run)
{
    const design *d = &run->analysis.design;
    print_head(&run->analysis);
    printf("  influence of %d amplifiers on %d target nodes, worst residual %.1e\n\n", d->amplifiers, d->targets, run->analysis.model.residual);
    printf("  %-26s %-16s %12s %7s %12s %10s\n", "volts", "limits (V)", "shape error", "active", "largest (V)", "KKT");
    for (int i = 0; i < run->count; i++) {
        const voltages *v = &run->volts[i];
        char limits[32];
        limit_text(v, limits);
        printf("  %-26s %-16s %11.3f%% %7d %12.2f ", v->name, limits, 100 * v->error, v->active, largest(v->volt, d->amplifiers));
        if (isfinite(v->optimality))
            printf("%10.1e\n", v->optimality);
        else
            puts("         -");
    }
    print_volts(&run->scene, &run->volts[1]);
    for (int i = run->compared; i < run->count; i++)
        print_volts(&run->scene, &run->volts[i]);
    const voltages *best = &run->volts[1];
    char limits[32];
    limit_text(best, limits);
    if (run->analysis.nonlinear)
        print_choice(run);
    printf("\nshape error %.3f%% of the target with every volt inside its limit (%s)\n", 100 * best->error, limits);
}

void print_shape_json(const shape_run *run)
{
    const design *d = &run->analysis.design;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_head(&j, &run->analysis);
    json_number(&j, "amplifiers", d->amplifiers);
    json_number(&j, "targets", d->targets);
    json_string(&j, "kinematics", run->analysis.nonlinear ? "nonlinear" : "linear");
    if (run->analysis.nonlinear) {
        json_number(&j, "cost_of_linear", cost_of_linear(run));
        json_string(&j, "image", image_needed(run));
    }
    json_open(&j, "results", '[');
    for (int i = 0; i < run->count; i++) {
        const voltages *v = &run->volts[i];
        json_open(&j, NULL, '{');
        json_string(&j, "name", v->name);
        json_numbers(&j, "limits", v->limit, 2);
        json_number(&j, "shape_error", v->error);
        json_number(&j, "active", v->active);
        json_number(&j, "passes", v->passes);
        json_number(&j, "kkt", v->optimality);
        json_number(&j, "relinearised", v->relinearised);
        json_number(&j, "systems", v->systems);
        json_numbers(&j, "volts", v->volt, d->amplifiers);
        json_close(&j, '}');
    }
    json_close(&j, ']');
    json_close(&j, '}');
}
