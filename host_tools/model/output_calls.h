/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that compute the outputs of a scene: one object for each row of the table in
 * output_types.h, in a file output_NAME.c. There are three kinds of outputs:
 *   rows      The output is a linear function of the displacement, so that it can be a reading of
 *       the device (add_row).
 *   elements  The output at a node is a mean over the elements at the node, of strains and stresses
 *       that are recovered in them (in_element).
 *   value     The output is neither of these (value).
 * An output with rows and also elements or a value, such as a strain or a rotation, uses its rows
 * under linear kinematics alone.
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
 * Solved structure, from which the function `value` of an output (output_calls) takes a value.
 */
typedef struct output_state {
    const struct design *design;
    const struct equilibrium *equilibrium; /* solver of the nonlinear equilibrium, for outputs of
                                              contact */
    const struct reactions *reactions;     /* forces of the supports, for outputs of reactions */
    const double *input_value; /* [inputs] input values of the structure: voltages (V), also of open
                                  electrodes, load factors and temperatures (K) */
    const double *charge;      /* [electrodes] charges of the electrodes (C) */
} output_state;

typedef struct output_calls {
    /*
     * Add the output at a node, as a linear function of the displacement, to a dense row; NULL: the
     * output is no such function.
     *   dense [free_dof] in/out  output per unit of each free dof
     */
    void (*add_row)(const mesh *mesh, const scene_output *output, int node, double *dense);
    /*
     * Return the output in one element, from the strains and stresses that are recovered there;
     * NULL: the output is not recovered in elements.
     */
    double (*in_element)(const struct stress_field *field, const scene_output *output, int element);
    /*
     * Return value i (node or electrode) of output k of the scene; NULL: the output is computed by
     * add_row or in_element. An output that has add_row, too, has this value under nonlinear
     * kinematics.
     */
    double (*value)(const output_state *state, int k, int i);
    /*
     * Check that the output exists at a node. Returns 0, or -1 with error filled; NULL: it exists
     * at all nodes.
     */
    int (*check)(const mesh *mesh, const scene_output *output, int node, char *error);
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
 * Whether the values of an output are recovered from the strains and stresses of elements. Such
 * values exist only for the last computed equilibrium.
 */
bool output_is_recovered(const scene_output *output);

#endif
