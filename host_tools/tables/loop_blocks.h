/*
 * The blocks around the control step that a scene asks for: for the loop on the host, and as C
 * source for a firmware. The table in loop_blocks.c is the only place that lists them.
 */
#ifndef LOOP_BLOCKS_H
#define LOOP_BLOCKS_H

#include "../model/estimator.h"
#include "emit.h"

typedef struct loop_blocks {
    const design *design;
    const estimator *estimator;
    pzs_known_loads known_loads; /* tables of the blocks that have none elsewhere */
    pzs_amplifier amplifier;
    pzs_fault_detection detection;
    pzs_block block[PZS_BLOCK_LIMIT];
    int count;
} loop_blocks;

/* What a scene's controller has beside the step: the shape from few sensors, loads that are known,
 * amplifiers with steps or a dead band. */
int loop_estimates(const scene *scene);
int loop_feeds(const scene *scene);
int loop_quantises(const scene *scene);

/*
 * The list of a scene, in the order of a tick. It points into *l, the design and the estimator.
 *   d in  after design_control
 *   e in  after estimator_open; all zero where the scene neither estimates nor feeds forward
 */
void loop_blocks_fill(loop_blocks *blocks, const design *design, const estimator *estimator);

/* Their tables, PREFIX_blocks, and PREFIX_LOOP_BYTES; after the tables of estimator, known loads
 * and problem. */
void loop_blocks_write(emitter *emitter, const loop_blocks *blocks);

/* What a firmware is wired by: PREFIX_TICK_RATE, indices of amplifiers and sensors by their names,
 * the outputs as a comment. */
void loop_names_write(emitter *emitter, const analysis *analysis);

#endif
