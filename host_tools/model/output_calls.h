/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of the rows and values of the outputs of a scene, one object for each row of the table
 * in output_types.h, each in a file output_NAME.c. An output with rows is linear in the
 * displacement, so that it can be a reading of the device; an output of elements is the mean over
 * the elements at a node, of their recovered strains and stresses; an output with both has rows
 * under linear kinematics, and values of elements under nonlinear ones.
 */
#ifndef OUTPUT_CALLS_H
#define OUTPUT_CALLS_H

#include <stdbool.h>
#include "../mesh/mesh.h"

struct design;
struct equilibrium;
struct reactions;
struct stress_field;

/*
 * Solved structure from which the value of an output is taken that neither has rows nor belongs to
 * elements.
 */
typedef struct output_state {
    const struct design *design;
    const struct equilibrium *equilibrium; /* solver of the nonlinear equilibrium, for outputs of
                                              contact */
    const struct reactions *reactions;     /* forces of the supports, for outputs of reactions */
    const double *input_value; /* [inputs] voltages (V), with those of open electrodes, load factors
                                  and temperatures (K) */
    const double *charge;      /* [electrodes] charges of the electrodes (C) */
} output_state;

typedef struct output_calls {
    /*
     * Add the output at a node to a linear function of the displacement; NULL: the output is no
     * such function.
     *   dense [free_dof] in/out  output per unit of each free dof
     */
    void (*add_row)(const mesh *mesh, const scene_output *output, int node, double *dense);
    /*
     * Return the output in one element, from the strains and stresses that are recovered there;
     * NULL: the output does not belong to elements. With this function the output needs a layer
     * that is present at its nodes, or has the layer -1.
     */
    double (*in_element)(const struct stress_field *field, const scene_output *output, int element);
    /* Return value i of output k of the scene; NULL: the output has one of the functions above. */
    double (*value)(const output_state *state, int k, int i);
    bool needs_reactions; /* whether the function `value` reads the reactions */
} output_calls;

#define OUTPUT_CALLS(type, word, keys, of, quantity, spread, reading, finish, calls)               \
    extern const output_calls calls;
OUTPUT_TYPES(OUTPUT_CALLS)
#undef OUTPUT_CALLS

const output_calls *output_calls_of(const scene_output *output);

/* Whether an output is a linear function of the displacement under linear kinematics. */
bool output_has_rows(const scene_output *output);

/*
 * Whether the values of an output are recovered from strains and stresses of elements, which are
 * computed at the last equilibrium only.
 */
bool output_is_recovered(const scene_output *output);

#endif
