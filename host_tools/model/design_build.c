/* SPDX-License-Identifier: BSD-2-Clause */
/* Design of a scene (design_build.h). */
#include "design_build.h"
#include <string.h>
#include "electrodes.h"

int design_build(design *design, const scene *scene, char *error)
{
    memset(design, 0, sizeof *design);
    design->scene = scene;
    if (mesh_build(&design->mesh, scene, error) == 0 && design_structure(design, error) == 0 &&
        design_target_rows(design, error) == 0 && electrodes_build(design, error) == 0)
        return 0;
    design_free(design);
    return -1;
}
