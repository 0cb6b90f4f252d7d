/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Many independent simulations of a loop with a vibrating structure, in several threads
 * (storm_batch.h).
 */
#include "storm_batch.h"
#include <string.h>
#include "../system/parallel.h"
#include "../system/progress.h"

/* Result of one simulation of a batch; `error` is filled where it has failed. */
typedef struct outcome {
    storm_result result;
    bool has_failed;
    char error[SCENE_ERROR];
} outcome;

typedef struct batch {
    const storm_rig *rig;
    const storm_task *task;
    int count;
    storm_visit *visit;
    void *context;
    const outcome *failed; /* first simulation that has failed, or NULL */
    outcome outcome[STORM_BATCH_LIMIT];
} batch;

static void run_task(void *context, int i)
{
    batch *batch = context;
    const storm_task *task = &batch->task[i];
    outcome *outcome = &batch->outcome[i];
    const int status = task->growth_ticks > 0
                           ? storm_growth(batch->rig, &task->plant, task->growth_ticks,
                                          &outcome->result, outcome->error)
                           : storm_run(batch->rig, &task->plant, &outcome->result, outcome->error);
    outcome->has_failed = status < 0;
}

static bool accept_result(void *context, int i)
{
    batch *batch = context;
    const outcome *outcome = &batch->outcome[i];
    progress_count(i + 1, batch->count);
    if (outcome->has_failed) {
        batch->failed = outcome;
        return false;
    }
    return batch->visit(batch->context, &batch->task[i], &outcome->result);
}

int storm_batch_run(const storm_rig *rig, const storm_task *task, int count, storm_visit *visit,
                    void *context, char *error)
{
    batch batch = {.rig = rig, .task = task, .count = count, .visit = visit, .context = context};
    const parallel_work work = {.context = &batch, .run = run_task, .accept = accept_result};
    progress_count(0, count);
    parallel_run(&work, count);
    if (!batch.failed)
        return 0;
    memcpy(error, batch.failed->error, sizeof batch.failed->error);
    return -1;
}
