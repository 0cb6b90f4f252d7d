/*
 * Control image of the demonstration: the influence matrix comes with the tables.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include DEMO_TABLES

#ifdef DEMO_CURVES
#error "actuators with curves need the blocks of the control loop: build demo_loop.c"
#endif

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS];

pzs_status demo_open(demo_image *image)
{
    image->problem = &demo_problem;
    image->target = demo_target;
    image->influence = demo_problem.influence;
    image->work = control_work;
    image->bytes = sizeof control_work;
    image->wanted = wanted;
    image->measured = measured;
    return PZS_OK;
}
