/* Words that the report pages and the terminal share: units of a scene's numbers, what happens in a
 * simulation. */
#ifndef WORDS_H
#define WORDS_H

#include "../simulate/simulate.h"

typedef enum words_quantity {
    QUANTITY_LENGTH,
    QUANTITY_ANGLE,
    QUANTITY_FORCE,
    QUANTITY_LINE_FORCE,
    QUANTITY_PRESSURE,
    QUANTITY_VOLTAGE,
    QUANTITY_CHARGE,
    QUANTITY_TEMPERATURE,
    QUANTITY_NODES,
    QUANTITY_OTHER
} words_quantity;

enum { WORDS_UNIT = 3 * SCENE_NAME, WORDS_PHASE = 160 };

/* Unit of a quantity, made from those of the scene; empty where the scene leaves one of them out.
 * Returns text. */
const char *words_unit(const scene *scene, words_quantity quantity, char text[WORDS_UNIT]);

/* Does the scene name no unit at all? Then any consistent ones do. */
int words_unitless(const scene *scene);

/* What theta1 (direction 0) or theta2 (1) measures on the scene's surface, what a load's value is,
 * what an output gives. */
words_quantity words_of_theta(const scene *scene, int direction);
words_quantity words_of_load(const scene_load *load);
words_quantity words_of_output(const scene_output *output);

/* At what shape the estimator's gains of a simulation are made. */
const char *words_influence(const scene *scene);

/* The events of a phase. */
void words_phase(const simulation *simulation, const simulate_phase *phase, char text[WORDS_PHASE]);

#endif
