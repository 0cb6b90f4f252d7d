/* Results on standard output (print.h). */
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "print_outputs.h"
#include "print_vibration.h"
#include "words.h"
#include "../tables/tables.h"

/* ---- head ------------------------------------------------------------- */

static const char *precision_needed(const analysis *a)
{
    if (tables_fit_float(a))
        return "float or double";
    if (a->model.info.condition > 1e14) /* what pzs_factor calls no structure */
        return "double; loose at rest, held by a contact or by its prescribed displacements alone";
    return a->nonlinear ? "the nonlinear path needs double"
                        : "double, or float with refinement, which says where it ends";
}

/* Plies are integrated with the exact metric through the thickness, or as those of a flat plate. */
static const char *metric_word(const scene *s)
{
    return s->element.metric ? "exact metric" : "flat metric";
}

/* What the sensors of an estimate see. */
static void print_sensors(const analysis *a, const char *influence)
{
    char text[SCENE_ERROR];
    estimator e;
    if (!a->design.scene->estimate.given || estimator_open(&e, a, text) < 0)
        return;
    estimator_text(&e, a, text);
    printf("  %s, %s\n", influence, text);
    estimator_close(&e);
}

void print_estimate_json(json *j, const estimator *e)
{
    json_open(j, "estimate", '{');
    json_number(j, "sensors", e->sensors);
    json_number(j, "rank", e->rank);
    json_number(j, "condition", e->condition);
    json_number(j, "missed", e->missed / e->disturbed);
    json_number(j, "worst_missed", e->worst_missed / e->worst_disturbed);
    json_close(j, '}');
}

static void json_sensors(json *j, const analysis *a)
{
    char text[SCENE_ERROR];
    estimator e;
    if (!a->design.scene->estimate.given || estimator_open(&e, a, text) < 0)
        return;
    print_estimate_json(j, &e);
    estimator_close(&e);
}

void print_head(const analysis *a, const char *influence)
{
    const scene *s = a->design.scene;
    const mesh *m = &a->design.mesh;
    printf("%s: %s\n", s->name, s->about ? s->about : "");
    printf("  %d x %d elements of %d kind%s, %d nodes, %d free unknowns, half bandwidth %d\n",
           s->line[0].elements, s->line[1].elements, m->kinds, m->kinds == 1 ? "" : "s", m->nodes,
           m->dof, mesh_half_bandwidth(m));
    printf("  element: %s kinematics, %s through the thickness, %d unknowns a node\n",
           s->element.cartesian ? "Cartesian" : "local", metric_word(s), s->element.unknowns);
    if (words_unitless(s))
        puts("  units: the scene names none; any consistent ones, angles in rad");
    if (a->model.info.condition > 0)
        printf("  condition %.1e after scaling: %s\n", a->model.info.condition,
               precision_needed(a));
    print_sensors(a, influence);
}

static void json_head(json *j, const analysis *a)
{
    const mesh *m = &a->design.mesh;
    json_string(j, "scene", a->design.scene->name);
    json_number(j, "real_bits", PZS_REAL_BITS);
    json_string(j, "unit_length", a->design.scene->unit_length);
    json_number(j, "elements", m->elements);
    json_number(j, "kinds", m->kinds);
    json_number(j, "nodes", m->nodes);
    json_number(j, "dof", m->dof);
    json_number(j, "half_bandwidth", mesh_half_bandwidth(m));
    json_string(j, "kinematics_of_element",
                a->design.scene->element.cartesian ? "cartesian" : "local");
    json_string(j, "metric", a->design.scene->element.metric ? "exact" : "flat");
    json_number(j, "condition", a->model.info.condition);
    plausible_json(j, &a->warnings);
    json_sensors(j, a);
}

/* ---- check ------------------------------------------------------------ */

/* What an image needs of a device; the tables are made and thrown away. Returns 0, or -1 where the
 * scene has no such image. */
static int image_size(const analysis *a, tables_image image, tables_size *size, tables_memory *need)
{
    const int controlled = a->design.problem.inputs > 0;
    FILE *nowhere = (image == TABLES_CONTROL && !controlled) ||
                            (image != TABLES_CONTROL && a->design.free_functions > 0) ||
                            (image == TABLES_NONLINEAR && !a->path.full)
                        ? NULL
                        : fopen("/dev/null", "w");
    if (!nowhere)
        return -1;
    const int failed = tables_write(nowhere, a, image, "t", size);
    *need = tables_need(a, image);
    fclose(nowhere);
    return failed;
}

void print_check(const analysis *a)
{
    tables_size size;
    tables_memory need;
    print_head(a, "at rest");
    printf("\n  %-10s %22s %22s %22s\n  %-10s %11s %10s %11s %10s %11s %10s\n", "image",
           "tables, flash (KB)", "workspace, RAM (KB)", "stack, at most (KB)", "", "float",
           "double", "float", "double", "float", "double");
    for (tables_image image = 0; image < TABLES_IMAGES; image++)
        if (image_size(a, image, &size, &need) == 0)
            printf("  %-10s %11.1f %10.1f %11.1f %10.1f %11.1f %10.1f\n", tables_image_name[image],
                   (double)(size.bytes + size.reals * 4) / 1024,
                   (double)(size.bytes + size.reals * 8) / 1024, (double)need.work[0] / 1024,
                   (double)need.work[1] / 1024, (double)need.stack[0] / 1024,
                   (double)need.stack[1] / 1024);
    putchar('\n');
    print_certificate(&a->certificate);
    puts("\n  the scene is sound");
}

static void json_pair(json *j, const char *key, double in_float, double in_double)
{
    json_open(j, key, '{');
    json_number(j, "float", in_float);
    json_number(j, "double", in_double);
    json_close(j, '}');
}

void print_check_json(const analysis *a)
{
    tables_size size;
    tables_memory need;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_head(&j, a);
    json_open(&j, "images", '{');
    for (tables_image image = 0; image < TABLES_IMAGES; image++) {
        if (image_size(a, image, &size, &need) < 0)
            continue;
        json_open(&j, tables_image_name[image], '{');
        json_pair(&j, "flash", (double)(size.bytes + size.reals * 4),
                  (double)(size.bytes + size.reals * 8));
        json_pair(&j, "ram", (double)need.work[0], (double)need.work[1]);
        json_pair(&j, "stack", (double)need.stack[0], (double)need.stack[1]);
        json_close(&j, '}');
    }
    json_close(&j, '}');
    print_certificate_json(&j, &a->certificate);
    json_close(&j, '}');
}

/* ---- solve ------------------------------------------------------------ */

/* What is to be known of a contact: load steps added for its body, how far facets sag, a warning
 * of the last step. */
static void print_contact(const analysis *a)
{
    const pzs_solver *run = &a->path.run;
    const char *unit = a->design.scene->unit_length;
    const char *space = *unit ? " " : "";
    char where[SCENE_ERROR];
    if (!a->design.scene->contact.given)
        return;
    if (run->info.shortened_steps > 0)
        printf("  contact: the body moves far for its size; %u load step%s shortened for it\n",
               run->info.shortened_steps, run->info.shortened_steps == 1 ? "" : "s");
    printf("  contact: the body is at most %.3g%s%s deep between nodes (the sag of elements)\n",
           a->path.contact.info.sag, space, unit);
    if (a->status != PZS_W_BEHIND)
        return;
    path_penetration(&a->path, a->status, where);
    printf("  WARNING: %s: %s\n", pzs_status_text(a->status), where);
}

static void print_path(const analysis *a)
{
    const pzs_solver *run = &a->path.run;
    printf("  %u load step%s, %u linear systems, %s (%u negative pivots)\n", run->info.load_steps,
           run->info.load_steps == 1 ? "" : "s", run->info.linear_solves,
           run->info.negative_pivots ? "UNSTABLE" : "stable", run->info.negative_pivots);
    printf(
        "  settled to %.0e of the displacement (equilibrium.change), solver residual %.1e of the load\n",
        run->settings.tolerance, run->info.residual);
    print_contact(a);
}

/* What the solver's own checks leave out. */
static void print_discretisation(void)
{
    puts(
        "  discretisation error: not part of these figures; compare with a finer mesh, as --set mesh.theta1.elements=N\n");
}

void print_solve(analysis *a, const double *value)
{
    print_head(a, "at rest");
    if (a->design.scene->kinematics == KINEMATICS_AUTO && isfinite(a->cost))
        printf("  kinematics auto: linear differs by %.3g of the displacement, tolerance %g: %s\n",
               a->cost, a->design.scene->tolerance,
               a->nonlinear ? "nonlinear is needed" : "linear is enough");
    if (a->nonlinear)
        print_path(a);
    else
        printf(
            "  linear solve: solver residual %.1e, solver error estimate %.1e in the energy norm, %d refinements\n",
            a->model.info.residual, a->model.info.error_estimate, a->model.info.refinements);
    print_discretisation();
    for (int k = 0; k < a->design.scene->outputs; k++)
        print_output(a, k, value);
    print_electrodes(a);
}

static void json_path(json *j, const analysis *a)
{
    const pzs_solver *run = &a->path.run;
    json_string(j, "status", pzs_status_text(a->status));
    json_number(j, "load_factor", run->info.load_factor);
    json_number(j, "steps", run->info.load_steps);
    json_number(j, "steps_shortened", run->info.shortened_steps);
    json_number(j, "systems", run->info.linear_solves);
    json_number(j, "iterations", (double)run->info.linear_solves - run->info.load_steps);
    json_number(j, "residual", run->info.residual);
    json_number(j, "solver_residual", run->info.residual);
    json_number(j, "negative_pivots", run->info.negative_pivots);
}

/* The same of a linear structure: one system, refined. */
static void json_linear(json *j, const analysis *a)
{
    json_string(j, "status", pzs_status_text(a->status));
    json_number(j, "steps", 1);
    json_number(j, "systems", 1);
    json_number(j, "iterations", a->model.info.refinements);
    json_number(j, "residual", a->model.info.residual);
    json_number(j, "solver_residual", a->model.info.residual);
    json_number(j, "negative_pivots", a->model.info.negative_pivots);
    json_number(j, "solver_error_estimate", a->model.info.error_estimate);
}

/* On a nonlinear structure `solve` is the whole path; the stiffness at rest is assembled and
 * factored before it. */
static void json_seconds(json *j, const analysis *a)
{
    json_open(j, "seconds", '{');
    json_number(j, "assemble", a->seconds.assemble);
    json_number(j, "factor", a->seconds.factor);
    json_number(j, "solve", a->seconds.solve);
    json_number(j, "total", a->seconds.assemble + a->seconds.factor + a->seconds.solve);
    json_close(j, '}');
}

void print_solve_json(analysis *a, const double *value)
{
    const design *d = &a->design;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_head(&j, a);
    json_string(&j, "kinematics", a->nonlinear ? "nonlinear" : "linear");
    if (d->scene->kinematics == KINEMATICS_AUTO)
        json_number(&j, "cost_of_linear", a->cost);
    (a->nonlinear ? json_path : json_linear)(&j, a);
    json_seconds(&j, a);
    print_outputs_json(&j, a, value, 0);
    print_output_places_json(&j, a, value, 0);
    json_open(&j, "ratios", '{');
    for (int k = 0; k < d->scene->outputs; k++)
        if (isfinite(d->scene->output[k].reference))
            json_number(&j, d->scene->output[k].name,
                        analysis_output(a, k, 0, value) / d->scene->output[k].reference);
    json_close(&j, '}');
    if (d->electrodes.count > 0)
        print_electrodes_json(&j, a);
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
static double rounded_volt(double voltage)
{
    return fabs(voltage) < 0.005 ? 0 : voltage;
}

/* Volts of each actuator as its grid lies on the surface: theta1 down, theta2 across. */
static void print_volts(const scene *s, const voltages *v)
{
    printf("\n  %s, voltages:\n", v->name);
    for (int k = 0; k < s->actuators; k++) {
        const scene_actuator *actuator = &s->actuator[k];
        const int *grid = actuator->grid, is_grid = grid[0] * grid[1] > 1;
        if (is_grid) {
            printf("    %-12s theta2 ", actuator->name);
            for (int j = 0; j < grid[1]; j++)
                printf(" %9d", j + 1);
            putchar('\n');
        }
        for (int i = 0; i < grid[0]; i++) {
            if (is_grid)
                printf("    %12s %-6d ", i == 0 ? "theta1" : "", i + 1);
            else
                printf("    %-20s", actuator->name);
            for (int j = 0; j < grid[1]; j++)
                printf(" %9.2f", rounded_volt(v->volt[actuator->first + i * grid[1] + j]));
            putchar('\n');
        }
    }
}

/* What the volts of the linear model cost on the nonlinear structure: the error that the smaller
 * image adds. */
static double cost_of_linear(const shape_run *run)
{
    return run->volts[2].error - run->volts[1].error;
}

static const char *image_needed(const shape_run *run)
{
    return cost_of_linear(run) <= run->analysis->design.scene->tolerance ? "control" : "nonlinear";
}

static void print_choice(const shape_run *run)
{
    const voltages *best = &run->volts[1];
    const double tolerance = run->analysis->design.scene->tolerance;
    printf("\nnonlinear structure: optimum after %d relinearisation%s, %d linear systems\n",
           best->relinearised, best->relinearised == 1 ? "" : "s", best->systems);
    printf(
        "the linear model's voltages cost %.3f%% more error there, tolerance %g%%: the firmware %s\n",
        100 * cost_of_linear(run), 100 * tolerance,
        strcmp(image_needed(run), "control") == 0 ? "is served by the control or linear image"
                                                  : "needs the nonlinear image");
}

/* Is output k a displacement of one node? */
static int is_single(const analysis *a, int k)
{
    return print_is_displacement(a, k) && analysis_outputs(a, k) == 1;
}

static double reached(const analysis *a, int k, const voltages *v)
{
    return pzs_model_observe_row(&a->design.structure, v->u, (uint32_t)a->design.named_first[k]);
}

/* The displacements of single nodes that the scene asks for, under each set of volts. */
static void print_reached(const shape_run *run)
{
    const analysis *a = run->analysis;
    const scene *s = a->design.scene;
    int columns = 0;
    for (int k = 0; k < s->outputs; k++) {
        if (!is_single(a, k))
            continue;
        if (columns++ == 0)
            printf("\n  displacement, %-13s", s->unit_length);
        printf(" %13.13s", s->output[k].name);
    }
    for (int i = -1; columns > 0 && i < run->count; i++) {
        const voltages *v = i < 0 ? &run->before : &run->volts[i];
        printf("\n  %-27s", v->name);
        for (int k = 0; k < s->outputs; k++)
            if (is_single(a, k))
                printf(" %13.5e", reached(a, k, v));
    }
    if (columns > 0)
        putchar('\n');
}

/* Amplifiers that have less than the range of the table. */
static void print_narrower(const voltages *v, int amplifiers)
{
    if (v->narrower + v->held > 0)
        printf("\n  of %d amplifiers, with narrower limits than the table says (own limits, "
               "field_limit): %d; held: %d\n",
               amplifiers, v->narrower, v->held);
}

/* Rows that no error counts, where they are not as wanted; and the free functions. */
static void print_target_rows(const design *d, const voltages *v)
{
    const char *comma = "";
    if (v->fixed_off > 0)
        printf("\n  %d of %d target rows lie on constrained dof and cannot move, %d of them away "
               "from the target;\n"
               "  the shape error does not count them, with them it would be %.3f%%\n",
               d->fixed_rows, d->targets, v->fixed_off, 100 * v->error_all);
    if (d->free_functions > 0)
        printf("\n  free functions, taken out of target and error: ");
    for (int k = 0; k < d->free_functions; k++, comma = ", ")
        printf("%s%s", comma, d->scene->target.free[k].name);
    if (d->free_functions > 0)
        putchar('\n');
}

/* Outputs at several nodes under the optimum within the first limits; outputs that belong to `pzs
 * solve` by name. */
static void print_reached_nodes(const analysis *a, const voltages *best, double *value)
{
    const scene *s = a->design.scene;
    int left = 0;
    pzs_observe(&a->design.structure, best->u, value);
    for (int k = 0; k < s->outputs; k++)
        if (print_is_displacement(a, k) && analysis_outputs(a, k) > 1) {
            printf("\n  displacement, %s, under \"%s\":\n", s->unit_length, best->name);
            print_output_table(a, k, value);
        }
    for (int k = 0; k < s->outputs; k++)
        if (!print_is_displacement(a, k))
            printf("%s %s",
                   left++ ? "," : "\n  outputs of contact and electrodes are printed by pzs solve:",
                   s->output[k].name);
    if (left)
        putchar('\n');
}

void print_shape(const shape_run *run)
{
    const analysis *a = run->analysis;
    const design *d = &a->design;
    print_head(a, "at rest");
    printf("  influence of %d amplifiers on %d target nodes, largest solver residual %.1e\n\n",
           d->amplifiers, d->targets, a->model.info.residual);
    printf("  %-26s %-16s %12s %7s %12s %10s\n", "voltages", "limits (V)", "shape error", "active",
           "largest (V)", "KKT");
    for (int i = 0; i < run->count; i++) {
        const voltages *v = &run->volts[i];
        char limits[32];
        limit_text(v, limits);
        if (isnan(v->error))
            printf("  %-26s %-16s %12s %7d %12.2f ", v->name, limits, "no equil.", v->active,
                   largest(v->volt, d->amplifiers));
        else
            printf("  %-26s %-16s %11.3f%% %7d %12.2f ", v->name, limits, 100 * v->error, v->active,
                   largest(v->volt, d->amplifiers));
        if (isfinite(v->optimality))
            printf("%10.1e\n", v->optimality);
        else
            puts("         -");
    }
    puts("\n  regularised, then clipped: with the one parameter that leaves the smallest error, "
         "chosen knowing the answer");
    print_narrower(&run->volts[1], d->amplifiers);
    print_target_rows(d, &run->volts[1]);
    print_reached(run);
    double *value = calloc((size_t)d->structure.output.count + 1, sizeof *value);
    if (value)
        print_reached_nodes(a, &run->volts[1], value);
    free(value);
    print_volts(d->scene, &run->volts[1]);
    for (int i = run->compared; i < run->count; i++)
        print_volts(d->scene, &run->volts[i]);
    const voltages *best = &run->volts[1];
    char limits[32];
    limit_text(best, limits);
    if (a->nonlinear)
        print_choice(run);
    print_modes(d->scene, &run->modes);
    printf("\nshape error %.3f%% of the target with every voltage inside its limit (%s)\n",
           100 * best->error, limits);
}

/* The displacements that the scene asks for, under one set of voltages. */
static void json_reached(json *j, const analysis *a, const voltages *v)
{
    double *value = calloc((size_t)a->design.structure.output.count + 1, sizeof *value);
    if (!value)
        return;
    pzs_observe(&a->design.structure, v->u, value);
    print_outputs_json(j, a, value, 1);
    print_output_places_json(j, a, value, 1);
    free(value);
}

static void json_voltages(json *j, const analysis *a, const voltages *v)
{
    const scene *s = a->design.scene;
    char name[SCENE_LABEL];
    json_numbers(j, "limits", v->limit, 2);
    json_number(j, "held", v->held);
    json_number(j, "narrower", v->narrower);
    json_number(j, "shape_error", v->error);
    json_number(j, "shape_error_all_rows", v->error_all);
    json_number(j, "fixed_rows_off", v->fixed_off);
    json_number(j, "active", v->active);
    json_number(j, "passes", v->passes);
    json_number(j, "kkt", v->optimality);
    if (v->regularisation > 0)
        json_number(j, "regularisation", v->regularisation);
    json_number(j, "relinearised", v->relinearised);
    json_number(j, "systems", v->systems);
    json_open(j, "volts", '{');
    for (int k = 0; k < v->volts; k++) {
        scene_amplifier_name(s, k, name);
        json_number(j, name, v->volt[k]);
    }
    json_close(j, '}');
    json_reached(j, a, v);
}

/* The optimum within the first limits at the top, then every set of volts. */
void print_shape_json(const shape_run *run)
{
    const analysis *a = run->analysis;
    const design *d = &a->design;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_head(&j, a);
    json_number(&j, "amplifiers", d->amplifiers);
    json_number(&j, "targets", d->targets);
    json_number(&j, "fixed_rows", d->fixed_rows);
    json_number(&j, "free_functions", d->free_functions);
    json_string(&j, "kinematics", a->nonlinear ? "nonlinear" : "linear");
    if (a->nonlinear) {
        json_number(&j, "cost_of_linear", cost_of_linear(run));
        json_string(&j, "image", image_needed(run));
    }
    json_number(&j, "shape_error_before", run->before.error);
    json_number(&j, "clipped_error", run->volts[a->nonlinear ? 3 : 2].error);
    json_number(&j, "regularised_error", run->volts[a->nonlinear ? 4 : 3].error);
    json_voltages(&j, a, &run->volts[1]);
    json_open(&j, "results", '[');
    for (int i = 0; i < run->count; i++) {
        json_open(&j, NULL, '{');
        json_string(&j, "name", run->volts[i].name);
        json_voltages(&j, a, &run->volts[i]);
        json_close(&j, '}');
    }
    json_close(&j, ']');
    if (run->modes.count > 0)
        print_modes_json(&j, d->scene, &run->modes);
    json_close(&j, '}');
}
