/*
 * One equilibrium of a scene from rest, in a process of its own:  run_path SCENE [path=value ...]
 * for callgrind to count (count_path.sh) and for peers/run.py to time.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include "../../host_tools/model/analysis.h"
#include "clock.h"

enum { MOST_SETTINGS = 8 };

int main(int count, char **argument)
{
    char file[512], error[SCENE_ERROR];
    const char *set[MOST_SETTINGS];
    scene scene;
    analysis analysis;
    if (count < 2 || count - 2 > MOST_SETTINGS)
        return 2;
    for (int i = 2; i < count; i++)
        set[i - 2] = argument[i];
    snprintf(file, sizeof file, SCENE_FOLDER "/%s.yaml", argument[1]);
    if (scene_read(&scene, file, set, count - 2, error) < 0 ||
        analysis_prepare(&analysis, &scene, error) < 0) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    const double begin = processor_time();
    pzs_equilibrium(&analysis.equilibrium.solver, analysis.equilibrium.full_input);
    const double end = processor_time();
    printf("elements %u unknowns %u seconds %.9f\n", (unsigned)analysis.design.structure.elements,
           (unsigned)analysis.model.state.stiffness.n, 1e-6 * (end - begin));
    analysis_free(&analysis);
    scene_free(&scene);
    return 0;
}
