/* SPDX-License-Identifier: BSD-2-Clause */
/* Construction of the design of a scene (design_build.h). */
#include "design_build.h"
#include <string.h>
#include "electrodes.h"

/* Build mesh, inputs and outputs of a scene with a structure. */
static int build_structure(design *design, char *error)
{
    return mesh_build(&design->mesh, design->scene, error) == 0 &&
                   design_structure(design, error) == 0
               ? 0
               : -1;
}

/* Build points, inputs and outputs of a scene with a measured influence matrix. */
static int build_measured(design *design, char *error)
{
    return mesh_points(&design->mesh, design->scene, error) == 0 &&
                   design_measured(design, error) == 0
               ? 0
               : -1;
}

int design_build(design *design, const scene *scene, char *error)
{
    memset(design, 0, sizeof *design);
    design->scene = scene;
    if ((scene->influence.given ? build_measured : build_structure)(design, error) == 0 &&
        design_target_rows(design, error) == 0 && electrodes_build(design, error) == 0)
        return 0;
    design_free(design);
    return -1;
}
