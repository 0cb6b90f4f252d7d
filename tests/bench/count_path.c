/* One equilibrium of a scene, for callgrind to count (count_path.sh):  count_path SCENE ELEMENTS1 ELEMENTS2 */
#include <stdio.h>
#include "analysis.h"

int main(int count, char **argument)
{
    char file[512], text[2][64], error[SCENE_ERROR];
    const char *const set[2] = {text[0], text[1]};
    scene s;
    analysis a;
    if (count != 4)
        return 2;
    snprintf(file, sizeof file, SCENE_FOLDER "/%s.yaml", argument[1]);
    snprintf(text[0], sizeof text[0], "mesh.theta1.elements=%s", argument[2]);
    snprintf(text[1], sizeof text[1], "mesh.theta2.elements=%s", argument[3]);
    if (scene_read(&s, file, set, 2, error) < 0 || analysis_prepare(&a, &s, error) < 0) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    pzs_equilibrium(&a.path.run, a.path.full);
    printf("systems %u elements %u unknowns %u reals %u\n", (unsigned)a.path.run.systems, (unsigned)a.design.structure.elements,
           (unsigned)a.model.k.n, (unsigned)a.model.k.start[(a.model.k.n + PZS_TILE - 1) / PZS_TILE]);
    analysis_free(&a);
    scene_free(&s);
    return 0;
}
