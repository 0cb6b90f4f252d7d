/*
 * Equilibria over meshes and loads, found from rest by automatic load steps: every one must end
 * settled, its forces in balance, or with a status that names why not, within its budget of
 * systems.
 *
 *   sweep_path [full]   half the meshes and half the loads, or all of them; progress on stderr, TAP
 * on stdout
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include "../rigs/scene_run.h"

enum { MESHES = 10, FEW = 5, LEVELS = 20, STATUSES = 6 };

/*
 * Balance of a settled equilibrium, path.residual: |imbalance| / |applied force|, rows scaled to
 * unit diagonal at rest. Where a thin shell has moved far, rounding leaves more: in those rows the
 * stiffness has entries near 1, so the forces at u are known to about the root of the sum of their
 * hundred products, in roundings of |u| in the same scale.
 */
static const double balanced = 1e-8;
static const double roundings = 16;
static const double most_seconds = 1500, most_seconds_reduced = 60;

typedef struct shell {
    const char *scene;
    int mesh[MESHES][2];
} shell;

static const shell shells[] = {
    {"annular-plate",
     {{4, 8}, {2, 4}, {3, 12}, {4, 16}, {6, 12}, {8, 16}, {5, 24}, {8, 24}, {6, 32}, {10, 40}}},
    {"hemisphere",
     {{4, 4}, {2, 2}, {3, 6}, {4, 8}, {8, 4}, {6, 6}, {8, 8}, {10, 10}, {12, 8}, {14, 14}}},
    {"hyperboloid",
     {{4, 4}, {3, 6}, {6, 3}, {6, 6}, {5, 10}, {8, 8}, {10, 6}, {10, 10}, {12, 12}, {14, 14}}},
    {"hyperboloid-soft",
     {{4, 4}, {3, 6}, {6, 3}, {6, 6}, {5, 10}, {8, 8}, {10, 6}, {10, 10}, {12, 12}, {14, 14}}},
};

typedef struct tally {
    long runs, one_step, cut, unstable, failed[STATUSES]; /* failed: from DIVERGED to SYSTEMS, then
                                                             another */
    long systems_one, systems_cut, systems_failed, most_one;
    long unbalanced, unnamed;
    double residual; /* largest of a settled one */
    double rounding; /* and in roundings of |u| */
} tally;

static void add(tally *to, const tally *from)
{
    to->runs += from->runs;
    to->one_step += from->one_step;
    to->cut += from->cut;
    to->unstable += from->unstable;
    for (int i = 0; i < STATUSES; i++)
        to->failed[i] += from->failed[i];
    to->systems_one += from->systems_one;
    to->systems_cut += from->systems_cut;
    to->systems_failed += from->systems_failed;
    to->most_one = from->most_one > to->most_one ? from->most_one : to->most_one;
    to->unbalanced += from->unbalanced;
    to->unnamed += from->unnamed;
    to->residual = fmax(to->residual, from->residual);
    to->rounding = fmax(to->rounding, from->rounding);
}

static void print(const char *name, const tally *t)
{
    printf("# %-34s %5ld runs: one step %4ld (%5ld systems, most %2ld), cut %3ld (%5ld), diverged "
           "%ld limit %ld budget %ld (%ld); "
           "unstable %ld, residual %.1e, %.2g roundings\n",
           name, t->runs, t->one_step, t->systems_one, t->most_one, t->cut, t->systems_cut,
           t->failed[0], t->failed[1], t->failed[PZS_E_SOLVES - PZS_E_DIVERGED], t->systems_failed,
           t->unstable, t->residual, t->rounding);
}

/* What one rounding of the displacement is worth in path->residual. */
static double rounding(const pzs_solver *solver)
{
    const pzs_model *model = solver->state.model;
    double u2 = 0, load2 = 0;
    for (uint32_t i = 0; i < model->state.structure->free_dof; i++) {
        u2 += pow(solver->info.displacement[i] / model->state.scale[i], 2);
        load2 += pow(solver->state.load[i] * model->state.scale[i], 2);
    }
    return PZS_EPSILON * sqrt(u2 / load2);
}

/* One equilibrium from rest. */
static void run_level(pzs_solver *solver, const double *amount, size_t dof, tally *t)
{
    pzs_solver_reset(solver);
    const pzs_status status = pzs_equilibrium(solver, amount);
    int finite = solver->info.linear_solves <= solver->settings.solve_limit;
    for (size_t i = 0; i < dof; i++)
        finite = finite && isfinite(solver->info.displacement[i]);
    t->runs++;
    t->unnamed += !finite;
    if (PZS_IS_ERROR(status)) {
        const int known = status >= PZS_E_DIVERGED && status <= PZS_E_SOLVES;
        t->failed[known ? status - PZS_E_DIVERGED : STATUSES - 1]++;
        t->unnamed += !known;
        t->systems_failed += solver->info.linear_solves;
        return;
    }
    t->unstable += status == PZS_W_UNSTABLE;
    t->residual = fmax(t->residual, solver->info.residual);
    if (solver->info.residual > balanced)
        t->rounding = fmax(t->rounding, solver->info.residual / rounding(solver));
    t->unbalanced += !(solver->info.residual <= fmax(balanced, roundings * rounding(solver)));
    if (solver->info.load_steps == 1) {
        t->one_step++;
        t->systems_one += solver->info.linear_solves;
        t->most_one = (long)solver->info.linear_solves > t->most_one
                          ? (long)solver->info.linear_solves
                          : t->most_one;
    } else {
        t->cut++;
        t->systems_cut += solver->info.linear_solves;
    }
}

/* All loads of one mesh, tenths of the scene's up to twice it. Returns whether it could be run. */
static int run_mesh(const shell *shell, int mesh, const char *element, int stride, tally *t)
{
    char changes[256];
    scene_run r;
    const int *n = shell->mesh[mesh];
    snprintf(
        changes, sizeof changes,
        "element=%s;mesh.theta1.elements=%d;mesh.theta2.elements=%d;equilibrium={tolerance: 1e-9}",
        element, n[0], n[1]);
    const int opened = scene_run_open(&r, shell->scene, changes) == 0;
    if (!opened)
        printf("# %s %s: %s\n", shell->scene, changes, r.error);
    for (int level = stride; opened && level <= LEVELS; level += stride) {
        double amount[2];
        for (int j = 0; j < r.analysis.design.structure.input.count && j < 2; j++)
            amount[j] = r.analysis.equilibrium.full_input[j] * level / 10;
        const tally before = *t;
        run_level(&r.analysis.equilibrium.solver, amount, (size_t)r.analysis.design.mesh.free_dof,
                  t);
        if (t->unbalanced + t->unnamed > before.unbalanced + before.unnamed)
            printf("# %s %s %dx%d, load %.1f: residual %.2g, %u systems\n", shell->scene, element,
                   n[0], n[1], level / 10., r.analysis.equilibrium.solver.info.residual,
                   r.analysis.equilibrium.solver.info.linear_solves);
    }
    scene_run_close(&r);
    return opened;
}

int main(int argc, char **argv)
{
    static const char *const elements[] = {"published", "improved"};
    const int full = argc > 1 && strcmp(argv[1], "full") == 0;
    const clock_t began = clock();
    const double limit = full ? most_seconds : most_seconds_reduced;
    int opened = 1, in_time = 1;
    tally all;
    memset(&all, 0, sizeof all);
    for (size_t s = 0; s < sizeof shells / sizeof *shells; s++)
        for (int e = 0; e < 2; e++) {
            char name[64];
            tally here;
            memset(&here, 0, sizeof here);
            for (int mesh = 0; mesh < (full ? MESHES : FEW) && in_time; mesh++) {
                opened &= run_mesh(&shells[s], mesh, elements[e], full ? 1 : 2, &here);
                in_time = (double)(clock() - began) / CLOCKS_PER_SEC < limit;
                if (isatty(2))
                    fprintf(stderr, "\r%s %s, mesh %d of %d, %.0f s   ", shells[s].scene,
                            elements[e], mesh + 1, full ? MESHES : FEW,
                            (double)(clock() - began) / CLOCKS_PER_SEC);
            }
            snprintf(name, sizeof name, "%s, %s", shells[s].scene, elements[e]);
            print(name, &here);
            add(&all, &here);
        }
    if (isatty(2))
        fputc('\n', stderr);
    print("all", &all);
    const int ok[3] = {opened && in_time, all.unbalanced == 0, all.unnamed == 0};
    printf("1..3\n");
    printf("%sok 1 - every mesh and load was run in %.0f s, bound %.0f\n", ok[0] ? "" : "not ",
           (double)(clock() - began) / CLOCKS_PER_SEC, limit);
    printf("%sok 2 - every settled equilibrium is in balance to %g of its load\n",
           ok[1] ? "" : "not ", balanced);
    printf("%sok 3 - every other end is named, finite and within its budget\n",
           ok[2] ? "" : "not ");
    return ok[0] && ok[1] && ok[2] ? 0 : 1;
}
