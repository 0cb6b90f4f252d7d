/*
 * Speed against error, nonlinear shells: pzs_equilibrium from rest in one load step, both elements,
 * mesh by mesh, against converged answers; then pairs of meshes by Richardson's extrapolation, and
 * the plain Newton method.
 *
 * Timed is the equilibrium, with the tangent at the shape reached that judges it and is not in the
 * number of systems. Reading the scene, mesh, element tables and the factor at rest are done once
 * by the host and stand in a column of their own. Times are processor times, medians of this
 * process; use the ratios between rows.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "../../host_tools/model/analysis.h"
#include "clock.h"

enum { RUNS = 7, MESHES = 14, PAIRS = 5, PLAIN = 3 };

/* Elements along theta1 and theta2. Graded: finer towards both ends of theta1 and towards the start
 * of theta2. */
typedef struct grid {
    int n[2], graded;
} grid;

/* A scene, and its case of peers/cases.py: name, converged displacements of A and B, whether its
 * meshes name theta2 first. */
typedef struct ladder {
    const char *scene, *name;
    double sign_a, converged[2];
    int turned;
    grid mesh[MESHES], pair[PAIRS], plain[PLAIN]; /* each up to one without elements; pair: the
                                                     coarser mesh */
} ladder;

static const ladder ladders[2] = {{"hemisphere",
                                   "hemisphere",
                                   -1,
                                   {8.147, 4.0735},
                                   0,
                                   {{{4, 4}, 0},
                                    {{8, 8}, 0},
                                    {{12, 8}, 0},
                                    {{10, 10}, 0},
                                    {{16, 10}, 0},
                                    {{12, 12}, 0},
                                    {{16, 16}, 0},
                                    {{18, 18}, 0},
                                    {{20, 20}, 0}},
                                   {{{4, 4}, 0}, {{6, 6}, 0}, {{8, 8}, 0}},
                                   {{{8, 8}, 0}, {{16, 16}, 0}}},
                                  {"annular-plate",
                                   "annular",
                                   1,
                                   {13.86, 17.49},
                                   1,
                                   {{{4, 8}, 0},
                                    {{2, 16}, 0},
                                    {{6, 12}, 0},
                                    {{4, 30}, 0},
                                    {{6, 30}, 0},
                                    {{10, 40}, 0},
                                    {{16, 32}, 0},
                                    {{16, 64}, 0},
                                    {{4, 16}, 1},
                                    {{5, 18}, 1},
                                    {{5, 20}, 1},
                                    {{6, 24}, 1},
                                    {{8, 32}, 1}},
                                   {{{3, 15}, 0}, {{5, 20}, 0}, {{8, 16}, 0}},
                                   {{{4, 30}, 0}, {{5, 20}, 1}}}};

static const char *const elements[2] = {"published", "improved"};

/* Times in milliseconds; end: displacements of A and B. */
typedef struct run {
    pzs_status status;
    double tables, solve, end[2], error;
    unsigned systems, steps, negative;
} run;

/* The worse of the two relative errors. */
static double error_of(const ladder *l, const double end[2])
{
    return fmax(fabs(end[0] / l->converged[0] - 1), fabs(end[1] / l->converged[1] - 1));
}

/* Equilibrium from rest, with the plain Newton method or as the scene says. */
static void solve(const ladder *l, analysis *analysis, int plain, run *r)
{
    pzs_solver *solver = &analysis->equilibrium.solver;
    double time[RUNS], *y = calloc(analysis->design.structure.output.count + 1u, sizeof *y);
    if (!y)
        exit(1);
    if (plain)
        solver->settings.extrapolated_iterations = 0;
    for (int k = 0; k < RUNS; k++) {
        pzs_solver_reset(solver);
        const double begin = processor_time();
        r->status = pzs_equilibrium(solver, analysis->equilibrium.full_input);
        time[k] = 1e-3 * (processor_time() - begin);
    }
    pzs_observe(&analysis->design.structure, solver->info.displacement, y);
    r->solve = median(time, RUNS);
    r->end[0] = l->sign_a * y[analysis->design.named_first[0]];
    r->end[1] = y[analysis->design.named_first[1]];
    r->error = error_of(l, r->end);
    r->systems = solver->info.linear_solves;
    r->steps = solver->info.load_steps;
    r->negative = solver->info.negative_pivots;
    free(y);
}

static run measure(const ladder *l, const char *element, const grid *g, int plain)
{
    char file[512], text[3][64], error[SCENE_ERROR];
    const char *const set[5] = {text[0], text[1], text[2], "mesh.theta1.centre=1.4",
                                "mesh.theta2.grading=4"};
    scene scene;
    analysis analysis;
    run r = {0};
    snprintf(file, sizeof file, SCENE_FOLDER "/%s.yaml", l->scene);
    snprintf(text[0], sizeof text[0], "element=%s", element);
    for (int i = 0; i < 2; i++)
        snprintf(text[1 + i], sizeof text[1 + i], "mesh.theta%d.elements=%d", 1 + i, g->n[i]);
    const double begin = processor_time();
    if (scene_read(&scene, file, set, g->graded ? 5 : 3, error) < 0 ||
        analysis_prepare(&analysis, &scene, error) < 0) {
        fprintf(stderr, "%s\n", error);
        exit(1);
    }
    r.tables = 1e-3 * (processor_time() - begin);
    solve(l, &analysis, plain, &r);
    analysis_free(&analysis);
    scene_free(&scene);
    return r;
}

/* The mesh as cases.py names it; good until the next but one. */
static const char *name_of(const ladder *l, const grid *g)
{
    static char text[2][32];
    static int turn;
    turn = !turn;
    snprintf(text[turn], sizeof text[turn], "%dx%d%s", g->n[l->turned], g->n[!l->turned],
             g->graded ? "-graded" : "");
    return text[turn];
}

/* Return the remark of a row about a path that does not arrive, or arrives unstable. */
static const char *remark(pzs_status status, uint32_t negative)
{
    if (PZS_IS_ERROR(status))
        return "  does not arrive";
    return negative ? "  unstable" : "";
}

static void print_row(const ladder *l, const char *element, const char *mesh, const run *r)
{
    printf("%-11s %-10s %-14s %9.4f %9.4f %7.2f%% %6u %8u %10.2f %10.2f%s\n", l->name, element,
           mesh, r->end[0], r->end[1], 100 * r->error, r->steps, r->systems, r->solve, r->tables,
           remark(r->status, r->negative));
}

static void single(const ladder *l, const char *element, const grid *g)
{
    const run r = measure(l, element, g, 0);
    print_row(l, element, name_of(l, g), &r);
}

/*
 * (4 u_2n - u_n)/3 for both times together. Its estimate of the finer mesh's error, (u_n - u_2n)/3,
 * holds where it is the true one to within half of the worse of A and B.
 */
static void extrapolated(const ladder *l, const char *element, const grid *g)
{
    const grid twice = {{2 * g->n[0], 2 * g->n[1]}, g->graded};
    const run coarse = measure(l, element, g, 0), fine = measure(l, element, &twice, 0);
    run both = fine;
    char mesh[80];
    double estimate[2];
    for (int i = 0; i < 2; i++) {
        estimate[i] = (coarse.end[i] - fine.end[i]) / 3;
        both.end[i] = fine.end[i] - estimate[i];
    }
    both.error = error_of(l, both.end);
    both.solve += coarse.solve;
    both.tables += coarse.tables;
    both.systems += coarse.systems;
    both.negative += coarse.negative;
    snprintf(mesh, sizeof mesh, "%s, %s", name_of(l, g), name_of(l, &twice));
    print_row(l, element, mesh, &both);
    printf("%24s estimate of the finer mesh's error %+.2f%% %+.2f%%, true %+.2f%% %+.2f%%: %s\n",
           "", 100 * estimate[0] / l->converged[0], 100 * estimate[1] / l->converged[1],
           100 * (fine.end[0] / l->converged[0] - 1), 100 * (fine.end[1] / l->converged[1] - 1),
           both.negative == 0 && both.error <= fine.error / 2 ? "holds" : "fails");
}

static void against_plain(const ladder *l, const char *element, const grid *g)
{
    for (int plain = 0; plain < 2; plain++) {
        const run r = measure(l, element, g, plain);
        printf("%-11s %-10s %-14s %-24s %6u %8u %10.2f%s\n", l->name, element, name_of(l, g),
               plain ? "plain Newton" : "independent resultants", r.steps, r.systems, r.solve,
               remark(r.status, r.negative));
    }
}

int main(void)
{
    printf("%-11s %-10s %-14s %9s %9s %8s %6s %8s %10s %10s\n", "case", "element", "mesh", "A", "B",
           "error", "steps", "systems", "solve ms", "tables ms");
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 2; e++)
            for (const grid *g = ladders[c].mesh; g->n[0]; g++)
                single(&ladders[c], elements[e], g);
    puts("\nRichardson's extrapolation of two meshes");
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 2; e++)
            for (const grid *g = ladders[c].pair; g->n[0]; g++)
                extrapolated(&ladders[c], elements[e], g);
    puts("\nNewton's method with independent resultants against the plain one, which needs load "
         "steps; those that do not settle are halved");
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 2; e++)
            for (const grid *g = ladders[c].plain; g->n[0]; g++)
                against_plain(&ladders[c], elements[e], g);
    return 0;
}
