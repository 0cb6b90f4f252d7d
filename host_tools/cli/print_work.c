/* SPDX-License-Identifier: BSD-2-Clause */
/* Instructions of a control tick on a device, as text and as JSON (print_work.h). */
#include "print_work.h"
#include <stdio.h>
#include <string.h>
#include "../model/tick_work.h"

/*
 * Compute upper bounds of the processor instructions of a control tick that runs a list of blocks
 * (stages of the tick).
 */
static void find_bounds(work_report *report, const analysis *analysis, const loop_blocks *blocks)
{
    const scene_control *control = &analysis->design.control;
    report->limit = loop_blocks_work_limit(blocks);
    for (int k = 0; k < LOOP_PROCESSORS; k++)
        loop_blocks_bound(blocks, &loop_processor_table[k], &report->bounds[k]);
    report->rate = control->clock / LOOP_WORK_CYCLES / report->bounds[0].all;
    report->holds = !(control->clock > 0) || report->rate >= control->rate * (1 - 1e-9);
    report->is_made = true;
}

void work_report_make(work_report *report, const analysis *analysis)
{
    const design *design = &analysis->design;
    char ignored[SCENE_ERROR];
    loop_parts parts;
    memset(report, 0, sizeof *report);
    report->holds = true;
    if (design->amplifiers == 0 || design->targets == 0 || design->problem.influence == NULL ||
        loop_parts_open(&parts, analysis, ignored) < 0)
        return;
    find_bounds(report, analysis, &parts.blocks);
    report->gate.is_used = parts.gate.is_used;
    report->gate.judged = parts.gate.judged;
    report->gate.most = parts.gate.tables.most;
    report->gate.certain = parts.gate.certain;
    report->gate.moved = parts.gate.moved;
    if (parts.gate.is_used)
        sensor_gate_text(&parts.gate, report->gate.text);
    loop_parts_close(&parts);
}

void work_report_search(work_report *report, const analysis *analysis)
{
    if (!report->is_made)
        return;
    report->measured = tick_work_longest(&analysis->design, report->limit);
    for (int k = 0; k < LOOP_PROCESSORS; k++) {
        const double unused = (double)report->limit - (double)report->measured;
        report->longest[k] = report->bounds[k].all - loop_processor_table[k].optimiser * unused;
    }
}

/*
 * Print one row of the table of processor instructions in a control tick: the name of a stage of
 * the tick, and its number of instructions on each processor.
 */
static void print_row(const char *name, const double value[LOOP_PROCESSORS])
{
    printf("    %-28s", name);
    for (int k = 0; k < LOOP_PROCESSORS; k++)
        printf(" %24.0f", value[k]);
    putchar('\n');
}

static void print_blocks(const work_report *report)
{
    double value[LOOP_PROCESSORS];
    for (int i = 0; i < report->bounds[0].count; i++) {
        const pzs_block_type *type = report->bounds[0].block[i].type;
        const bool is_alone = type->phase == PZS_PHASE_COMMISSION;
        char name[64];
        snprintf(name, sizeof name, "%s%s", type->name, is_alone ? " (not in control)" : "");
        for (int k = 0; k < LOOP_PROCESSORS; k++)
            value[k] = report->bounds[k].block[i].most;
        print_row(name, value);
    }
    for (int k = 0; k < LOOP_PROCESSORS; k++)
        value[k] = report->bounds[k].rest;
    print_row("memory, checks, last gate", value);
    for (int k = 0; k < LOOP_PROCESSORS; k++)
        value[k] = report->bounds[k].all;
    print_row("all, at most", value);
    print_row("longest of the jumps", report->longest);
}

void print_work(const work_report *report, const design *design)
{
    if (!report->is_made)
        return;
    printf("  The optimiser makes at most %llu multiply-adds in a tick, and %llu in the longest of "
           "%d ticks with targets that jump.\n  %-30s",
           (unsigned long long)report->limit, (unsigned long long)report->measured, TICK_WORK_TICKS,
           "Instructions of a tick:");
    for (int k = 0; k < LOOP_PROCESSORS; k++)
        printf(" %24s", loop_processor_table[k].name);
    putchar('\n');
    print_blocks(report);
    if (report->rate > 0)
        printf("  At %g cycles an instruction a Cortex-M4F at %g MHz holds %.0f ticks a second.\n",
               LOOP_WORK_CYCLES, design->control.clock / 1e6, report->rate);
    putchar('\n');
}

void print_gate(const work_report *report)
{
    if (report->gate.is_used)
        printf("  %s\n", report->gate.text);
}

void print_gate_json(const work_report *report, json *json)
{
    if (!report->gate.is_used)
        return;
    json_open(json, "sensor_gate", '{');
    json_number(json, "judged", report->gate.judged);
    json_number(json, "most", report->gate.most);
    json_number(json, "certain", report->gate.certain);
    json_number(json, "moved", report->gate.moved);
    json_close(json, '}');
}

void print_work_json(const work_report *report, json *json)
{
    if (!report->is_made)
        return;
    json_open(json, "tick", '{');
    json_number(json, "work_limit", (double)report->limit);
    json_number(json, "work_measured", (double)report->measured);
    json_number(json, "rate_most", report->rate);
    json_bool(json, "holds", report->holds);
    json_open(json, "instructions", '{');
    for (int k = 0; k < LOOP_PROCESSORS; k++) {
        const loop_bounds *bounds = &report->bounds[k];
        json_open(json, loop_processor_table[k].key, '{');
        json_number(json, "all", bounds->all);
        json_number(json, "longest", report->longest[k]);
        json_number(json, "rest", bounds->rest);
        json_open(json, "blocks", '{');
        for (int i = 0; i < bounds->count; i++)
            json_number(json, bounds->block[i].type->name, bounds->block[i].most);
        json_close(json, '}');
        json_close(json, '}');
    }
    json_close(json, '}');
    json_close(json, '}');
}

int work_report_check(const work_report *report, const design *design, char *error)
{
    if (report->holds)
        return 0;
    return scene_fault(design->simulate.at, error,
                       "control.rate: %g ticks a second are more than the %.0f that a processor of "
                       "%g MHz holds, with at most %.0f instructions in a tick and %g cycles an "
                       "instruction; lower the rate, raise the clock, or use fewer amplifiers, "
                       "targets or blocks",
                       design->control.rate, report->rate, design->control.clock / 1e6,
                       report->bounds[0].all, LOOP_WORK_CYCLES);
}
