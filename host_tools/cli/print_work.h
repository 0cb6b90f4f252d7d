/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Number of processor instructions in a control tick on a device, for each block (part) of the
 * tick, as `pzs check` prints it.
 */
#ifndef PRINT_WORK_H
#define PRINT_WORK_H

#include "../tables/loop_blocks.h"
#include "../text/json.h"

typedef struct work_report {
    bool is_made;      /* true where the scene has a controller with a target; otherwise the other
                          members of the report are unset */
    uint64_t limit;    /* limit of the optimiser's work in one control tick (multiply-adds) */
    uint64_t measured; /* work of the optimiser in the longest simulated control tick
                          (multiply-adds) */
    loop_bounds bounds[LOOP_PROCESSORS];
    double longest[LOOP_PROCESSORS]; /* upper bound of the instructions of the longest simulated
                                        tick, on each processor for which instructions are bounded
                                      */
    double rate; /* highest tick rate that a processor with the clock frequency of the scene file
                    reaches (1/s); 0 where the scene file gives no clock frequency */
    bool holds;  /* true where the processor reaches the tick rate of the scene, or the scene file
                    lacks the clock frequency or the tick rate */
    struct {
        bool is_used;
        int judged, most;      /* number of judged sensors; largest number of wrong ones */
        double certain, moved; /* what is found and what is not, as in struct sensor_gate */
        char text[SCENE_ERROR];
    } gate; /* what the sensor gate of the loop finds */
} work_report;

/*
 * Compute upper bounds of the number of processor instructions of a control tick.
 *   analysis in  analysis of a scene, with computed influence matrix, and after the stability tests
 *                of the control loop
 */
void work_report_make(work_report *report, const analysis *analysis);

/*
 * Search for the control tick with the largest work of the optimiser among many simulated ticks
 * with targets that jump, and store this work in a report that work_report_make has filled. The
 * search takes minutes with a thousand amplifiers.
 */
void work_report_search(work_report *report, const analysis *analysis);

void print_work(const work_report *report, const design *design);
void print_work_json(const work_report *report, json *json);

/*
 * Check that the processor of the scene computes a control tick within the tick period of the
 * scene. Returns 0, or -1 with error filled.
 */
int work_report_check(const work_report *report, const design *design, char *error);

/* Print what the sensor gate of the loop finds, as sentences or as a member of a JSON object. */
void print_gate(const work_report *report);
void print_gate_json(const work_report *report, json *json);

#endif
