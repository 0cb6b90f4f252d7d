/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Comparison of measured vibration modes with a measured influence matrix B [outputs][amplifiers].
 * B is the sum of the modes' static parts (shape times static response to each amplifier) and a
 * remainder. If the remainder is large and falls when rows of B are swapped, the mode shapes list
 * the outputs in another order than B.
 */
#ifndef MATRIX_MODES_H
#define MATRIX_MODES_H

#include "../scene/scene.h"

typedef struct matrix_modes {
    double share; /* fraction of the influence matrix's squared entries that the static parts of all
                     modes (shape times static responses) explain; negative where responses have a
                     wrong unit */
    double *of_mode; /* [modes] share of the influence matrix (sum of the squares of its entries)
                        that each vibration mode explains. Under a constant voltage of one
                        amplifier, the mode contributes its shape times its static modal coordinate
                        to the column of the amplifier. */
    double *cosine;  /* [amplifiers] cosine of the angle between each column of the influence matrix
                        and the static part of all modes in it (sum of shape times static response);
                        NAN where one of the two is 0 */
    int swaps; /* number of pairs of outputs (rows of the influence matrix) that were swapped so
                  that the mode shapes explain more of the matrix */
    int swapped[2]; /* indices, counted from 0, of the pair of outputs (rows of the influence
                       matrix) that was swapped first, because this swap lets the mode shapes
                       explain most of the matrix */
    /*
     * squared entries of the influence matrix that the mode shapes explain only after the first
     * pair of outputs was swapped, divided by those that they leave of two average outputs after
     * all swaps, and by what chance reaches with few amplifiers, 1 + 8/amplifiers. 0 without a swap
     * or with one amplifier
     */
    double swap_gain;
    double random_rest; /* mean fraction of the squared entries of the influence matrix that the
                           mode shapes would not represent if their outputs were in random order. If
                           the member `rest` is near this value, mode shapes and influence matrix
                           probably list the outputs in different orders. */
    double rest; /* fraction of the squared entries of the influence matrix that no combination of
                    the mode shapes represents */
    double swapped_rest; /* the fraction `rest` (squared entries of the influence matrix that the
                            mode shapes cannot represent) after rows in the wrong order have been
                            swapped */
} matrix_modes;

/*
 * Smallest swap_gain at which two outputs count as swapped. It was chosen on simulated plates with
 * noise, unknown modes and outputs in the right order: 6 of 3,000 reached it. With one amplifier no
 * swap is looked for.
 */
#define MATRIX_SWAP_BAR 5.0

/*
 * Largest number of outputs with which the program searches for errors in the order of outputs:
 * pairs of outputs that have exchanged places in the mode shapes, compared with the influence
 * matrix.
 */
enum { MATRIX_SWAPPED_OUTPUTS = 400 };

/*
 * Compute an orthonormal basis of the shapes of all modes by Gram-Schmidt orthogonalisation.
 *   basis    [modes][outputs] out  orthonormal vectors
 *   triangle [modes][modes]   out  column k: coefficients of the shape of mode k in the basis (rows
 *       0 to k); 0 before the call
 * Returns the first mode whose shape is a combination of the shapes before it, or -1 if there is
 * none.
 */
int matrix_modes_basis(const scene_influence *measured, double *basis, double *triangle);

/*
 * Compute the static modal coordinates of all vibration modes under 1 V at one amplifier: from the
 * scene file, or by a least-squares fit of the mode shapes to the amplifier's column of the
 * influence matrix.
 *   basis     [modes][outputs] in   orthonormal basis of the mode shapes, from matrix_modes_basis
 *   triangle  [modes][modes]   in   mode shapes in this basis
 *   response  [modes]          out  modal coordinates (multiples of the mode shapes per volt)
 */
void matrix_modes_response(const scene_influence *measured, size_t amplifiers, size_t amplifier,
                           const double *basis, const double *triangle, double *response);

/*
 * Compare the measured vibration modes of a scene with its influence matrix.
 *   with_swaps in  whether to search for pairs of outputs that have exchanged places in the mode
 *                  shapes, compared with the influence matrix
 * Returns 0, or -1 where memory runs out or a shape is a combination of others; call
 * matrix_modes_free in either case.
 */
int matrix_modes_find(matrix_modes *found, const scene_influence *measured, size_t amplifiers,
                      bool with_swaps);
void matrix_modes_free(matrix_modes *found);

#endif
