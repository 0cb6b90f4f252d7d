/*
 * Speed against error: linear shells by both elements, mesh by mesh, against converged answers.
 * Times are medians of five runs of this process; use the ratios between rows.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/analysis.h"
#include "clock.h"

enum { RUNS = 5 };

typedef struct timing {
    double build, factor, solve, ratio;
    int dof;
} timing;

static timing measure(const char *name, const char *element, int n)
{
    char path[512], size[2][64], formulation[64], error[SCENE_ERROR];
    const char *const set[3] = {size[0], size[1], formulation};
    double build[RUNS], factor[RUNS], solve[RUNS];
    timing t = {0};
    snprintf(path, sizeof path, SCENE_FOLDER "/%s.yaml", name);
    snprintf(formulation, sizeof formulation, "element=%s", element);
    for (int analysis = 0; analysis < 2; analysis++)
        snprintf(size[analysis], sizeof size[analysis], "mesh.theta%d.elements=%d", analysis + 1,
                 n);
    for (int k = 0; k < RUNS; k++) {
        scene scene;
        analysis analysis;
        const double begin = now();
        if (scene_read(&scene, path, set, 3, error) < 0 ||
            analysis_prepare(&analysis, &scene, error) < 0) {
            fprintf(stderr, "%s\n", error);
            exit(1);
        }
        const double built = now();
        pzs_assemble(&analysis.model, NULL, NULL);
        pzs_factor(&analysis.model);
        const double factored = now();
        double *u = calloc((size_t)analysis.design.mesh.free_dof, sizeof *u),
               *y = calloc(analysis.design.structure.output.count + 1u, sizeof *y);
        if (!u || !y || analysis_solve(&analysis, u, error) < 0)
            exit(1);
        build[k] = built - begin;
        factor[k] = factored - built;
        solve[k] = now() - factored;
        pzs_observe(&analysis.design.structure, u, y);
        t.ratio = y[analysis.design.named_first[0]] / scene.output[0].reference;
        t.dof = analysis.design.mesh.free_dof;
        free(u);
        free(y);
        analysis_free(&analysis);
        scene_free(&scene);
    }
    t.build = median(build, RUNS);
    t.factor = median(factor, RUNS);
    t.solve = median(solve, RUNS);
    return t;
}

int main(void)
{
    static const struct {
        const char *name;
        double converged;
    } cases[] = {{"scordelis-lo", .9958},
                 {"pinched-cylinder", 1.0118},
                 {"hemisphere-linear", 1.0064},
                 {"clamped-plate", 1.0067}};
    static const char *const elements[] = {"published", "improved"};
    printf("%-18s %-10s %4s %6s %9s %9s %12s %12s %12s\n", "case", "element", "n", "dof", "ratio",
           "error", "scene us", "factor us", "solve us");
    for (int c = 0; c < 4; c++)
        for (int e = 0; e < 2; e++) {
            double last = 0;
            for (int n = 4; n <= 32; n *= 2) {
                const timing t = measure(cases[c].name, elements[e], n);
                printf("%-18s %-10s %4d %6d %9.4f %8.2f%% %12.0f %12.0f %12.0f\n", cases[c].name,
                       elements[e], n, t.dof, t.ratio, 100 * (t.ratio / cases[c].converged - 1),
                       t.build, t.factor, t.solve);
                if (n == 16)
                    printf("%-18s %-10s 8+16        %9.4f %8.2f%%   (4 u_16 - u_8)/3\n",
                           cases[c].name, elements[e], (4 * t.ratio - last) / 3,
                           100 * ((4 * t.ratio - last) / 3 / cases[c].converged - 1));
                last = t.ratio;
            }
        }
    puts("(error against converged answers of this element family, good to .2 %; scene: reading, "
         "mesh, element matrices, first factor)");
    return 0;
}
