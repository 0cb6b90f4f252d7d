/*
 * Linear image of the demonstration: the device assembles and factors the stiffness matrix of the
 * structure and computes the influence matrix itself.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "print.h"
#include DEMO_TABLES

#if DEMO_ALL_INPUTS != DEMO_INPUTS
#error "tables with sensors need pzs_influence_open; run `pzs tables --image control`"
#endif

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

static pzs_real model_work[REALS(DEMO_MODEL_BYTES)] BOARD_LARGE;
static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real influence[DEMO_OUTPUTS * DEMO_INPUTS];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS];

typedef struct stage_counts {
    uint32_t start, ready, assembled, factored, solved;
} stage_counts;

/* Compute the influence matrix of the structure, and take the counter after each stage. */
static pzs_status compute_influence(pzs_model *model, stage_counts *count)
{
    pzs_status status;
    count->start = board_count();
    status = pzs_model_init(model, &demo_structure, model_work, sizeof model_work);
    count->ready = board_count();
    if (PZS_IS_ERROR(status))
        return status;
    status = pzs_assemble(model, NULL, NULL);
    count->assembled = board_count();
    if (PZS_IS_ERROR(status))
        return status;
    status = pzs_factor(model);
    count->factored = board_count();
    if (PZS_IS_ERROR(status))
        return status;
    status = pzs_influence(model, influence);
    count->solved = board_count();
    return status;
}

static void report(const pzs_model *model, pzs_status status, const stage_counts *count)
{
    print_text("model");
    print_hex("scene", demo_structure.scene);
    print_count("status", status);
    print_count("dof", demo_structure.free_dof);
    print_real("condition", model->info.condition);
    print_real("residual", model->info.residual);
    print_count("refinements", model->info.refinements);
    print_text("\ncost model");
    print_count("init", board_instructions(count->start, count->ready));
    print_count("assemble", board_instructions(count->ready, count->assembled));
    print_count("factor", board_instructions(count->assembled, count->factored));
    print_count("influence", board_instructions(count->factored, count->solved));
    print_text(" instructions\n");
}

pzs_status demo_open(demo_image *image)
{
    pzs_model model = {0};
    stage_counts count = {0};
    pzs_status status;

    if (drill_model(&demo_structure, model_work, sizeof model_work))
        return PZS_E_ARGUMENT;
    status = compute_influence(&model, &count);
    report(&model, status, &count);

    image->problem = &demo_problem;
    image->target = demo_target;
    image->influence = influence;
    image->work = control_work;
    image->bytes = sizeof control_work;
    image->wanted = wanted;
    image->measured = measured;
    return status;
}
