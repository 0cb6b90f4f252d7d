/*
 * Speed against error, nonlinear shells: pzs_equilibrium from rest in one load step, both elements, mesh by mesh,
 * against converged answers; then pairs of meshes by Richardson's extrapolation, and the plain Newton method.
 *
 *   bench_path [--json FILE]   FILE gets the lines that peers/compare.py reads
 *
 * Timed is the equilibrium alone. Reading the scene, mesh, element tables and the factor at rest are made once by the
 * host and stand in a column of their own. Times are medians of this process; use the ratios between rows.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "analysis.h"
#include "clock.h"

enum { RUNS = 7, MESHES = 8, PAIRS = 4 };

/* A scene, the name of the case and the converged displacements of A and B in peers/cases.py, and its ladder. */
typedef struct ladder {
    const char *scene, *name;
    double sign_a, converged[2];
    int turned;                                       /* cases.py names theta2 first */
    struct { int n[2]; } mesh[MESHES], pair[PAIRS];   /* ending with 0; of a pair, the coarser mesh */
} ladder;

typedef struct run { double build, solve, end[2]; unsigned systems, steps, negative; pzs_status status; } run;

static const char *const elements[2] = {"source", "corrected"};

static FILE *json;

/* One mesh, `mixed` systems with extrapolated resultants. */
static run measure(const ladder *l, const char *element, const int n[2], int mixed)
{
    char file[512], text[4][64], error[SCENE_ERROR];
    const char *const set[4] = {text[0], text[1], text[2], text[3]};
    double solve[RUNS];
    scene s;
    analysis a;
    run r = {0};
    snprintf(file, sizeof file, SCENE_FOLDER "/%s.yaml", l->scene);
    snprintf(text[0], sizeof text[0], "element=%s", element);
    snprintf(text[1], sizeof text[1], "mesh.theta1.elements=%d", n[0]);
    snprintf(text[2], sizeof text[2], "mesh.theta2.elements=%d", n[1]);
    snprintf(text[3], sizeof text[3], "equilibrium={mixed: %d}", mixed);
    const double begin = now();
    if (scene_read(&s, file, set, mixed == 12 ? 3 : 4, error) < 0 || analysis_prepare(&a, &s, error) < 0) {
        fprintf(stderr, "%s\n", error);
        exit(1);
    }
    r.build = now() - begin;
    pzs_path *path = &a.path.run;
    for (int k = 0; k < RUNS; k++) {
        pzs_path_rest(path);
        const double from = now();
        r.status = pzs_equilibrium(path, a.path.full);
        solve[k] = now() - from;
    }
    double *y = calloc(a.design.structure.output.count + 1u, sizeof *y);
    if (!y)
        exit(1);
    pzs_observe(&a.design.structure, path->u, y);
    r.solve = median(solve, RUNS);
    r.end[0] = l->sign_a * y[a.design.named_first[0]];
    r.end[1] = y[a.design.named_first[1]];
    r.systems = path->systems;
    r.steps = path->steps_taken;
    r.negative = path->negative;
    free(y);
    analysis_free(&a);
    scene_free(&s);
    return r;
}

/* The worse of the two relative errors. */
static double error_of(const ladder *l, const double end[2])
{
    return fmax(fabs(end[0] / l->converged[0] - 1), fabs(end[1] / l->converged[1] - 1));
}

static void name_mesh(const ladder *l, const int n[2], char *text, size_t size)
{
    snprintf(text, size, "%dx%d", n[l->turned], n[!l->turned]);
}

static void report(const ladder *l, const char *mesh, const char *element, const run *r)
{
    if (json)
        fprintf(json, "{\"code\": \"piezoshape\", \"case\": \"%s\", \"mesh\": \"%s\", \"element\": \"%s\", \"steps\": %u, "
                "\"iterations\": %u, \"seconds\": %.9f, \"a\": %.9f, \"b\": %.9f}\n",
                l->name, mesh, element, r->steps, r->systems, 1e-6 * r->solve, r->end[0], r->end[1]);
    printf("%-11s %-10s %-12s %9.4f %9.4f %7.2f%% %8u %8u %9.2f %9.2f%s\n", l->name, element, mesh, r->end[0], r->end[1],
           100 * error_of(l, r->end), r->steps, r->systems, 1e-3 * r->solve, 1e-3 * r->build, r->negative ? "  unstable" : "");
}

static void heading(void)
{
    printf("%-11s %-10s %-12s %9s %9s %8s %8s %8s %9s %9s\n", "case", "element", "mesh", "A", "B", "error", "steps", "systems",
           "solve ms", "tables ms");
}

/*
 * (4 u_2n - u_n)/3. It is a run of the comparison only where its estimate holds: the error (u_2n - u_n)/3 that it
 * takes off the finer mesh is, at A and at B, the true one to within half of the worse of the two.
 */
static void extrapolated(const ladder *l, const char *element, const int n[2])
{
    const int twice[2] = {2 * n[0], 2 * n[1]};
    const run coarse = measure(l, element, n, 12), fine = measure(l, element, twice, 12);
    run both = fine;
    char mesh[32], name[64];
    double off = 0;
    for (int i = 0; i < 2; i++) {
        both.end[i] = (4 * fine.end[i] - coarse.end[i]) / 3;
        off = fmax(off, fabs(both.end[i] - l->converged[i]) / l->converged[i]);
    }
    both.solve += coarse.solve;
    both.build += coarse.build;
    both.systems += coarse.systems;
    both.negative += coarse.negative;
    name_mesh(l, n, mesh, sizeof mesh);
    snprintf(name, sizeof name, "%s and x2", mesh);
    if (both.negative == 0 && off <= error_of(l, fine.end) / 2)
        report(l, name, element, &both);
    else
        printf("%-11s %-10s %-12s %9.4f %9.4f %7.2f%%   estimate refused: the finer mesh has %.2f %%\n", l->name, element, name,
               both.end[0], both.end[1], 100 * off, 100 * error_of(l, fine.end));
}

static void plain(const ladder *l, const char *element, const int n[2])
{
    char mesh[32];
    const run mixed = measure(l, element, n, 12), r = measure(l, element, n, 0);
    name_mesh(l, n, mesh, sizeof mesh);
    printf("%-11s %-10s %-7s independent resultants %2u step%s %3u systems %9.2f ms; plain Newton %3u step%s %4u systems %9.2f ms%s\n",
           l->name, element, mesh, mixed.steps, mixed.steps == 1 ? " " : "s", mixed.systems, 1e-3 * mixed.solve, r.steps,
           r.steps == 1 ? " " : "s", r.systems, 1e-3 * r.solve, PZS_IS_ERROR(r.status) ? ", does not arrive" : "");
}

int main(int count, char **argument)
{
    static const ladder ladders[2] = {
        {"hemisphere", "hemisphere", -1, {8.147, 4.0735}, 0,
         {{{4, 4}}, {{8, 8}}, {{10, 10}}, {{12, 12}}, {{16, 16}}, {{20, 20}}, {{24, 24}}}, {{{4, 4}}, {{5, 5}}, {{6, 6}}, {{8, 8}}}},
        {"annular-plate", "annular", 1, {13.86, 17.49}, 1,
         {{{2, 4}}, {{4, 8}}, {{6, 12}}, {{4, 30}}, {{10, 40}}, {{16, 32}}, {{10, 80}}}, {{{2, 15}}, {{3, 15}}, {{3, 20}}, {{5, 20}}}}};
    if (count > 1 && (count != 3 || strcmp(argument[1], "--json") != 0 || !(json = fopen(argument[2], "w")))) {
        fprintf(stderr, "usage: bench_path [--json FILE]\n");
        return 2;
    }
    heading();
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 2; e++) {
            for (int m = 0; m < MESHES && ladders[c].mesh[m].n[0]; m++) {
                const run r = measure(&ladders[c], elements[e], ladders[c].mesh[m].n, 12);
                char mesh[32];
                name_mesh(&ladders[c], ladders[c].mesh[m].n, mesh, sizeof mesh);
                report(&ladders[c], mesh, elements[e], &r);
            }
            for (int p = 0; p < PAIRS && ladders[c].pair[p].n[0]; p++)
                extrapolated(&ladders[c], elements[e], ladders[c].pair[p].n);
        }
    puts("\nWith the plain Newton method (equilibrium: {mixed: 0}), load steps cut where they do not settle:");
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 2; e++)
            for (int m = 1; m < 3; m++)
                plain(&ladders[c], elements[e], ladders[c].mesh[m].n);
    return json && fclose(json) != 0;
}
