/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Resultants and capacitances of electric potentials at the corners of a layer
 * (potential_element.h). The potentials cause five fields: the voltage across the layer, and fields
 * along the axes 1 and 2 at both faces. Only capacitances depend on the variation of the fields
 * over the element.
 */
#include "potential_element.h"
#include <string.h>
#include "corner_weight.h"

enum { FIELDS = 5 };

static const double xi1[4] = {-1, 1, 1, -1}, xi2[4] = {-1, -1, 1, 1};

/* Shape functions of the electric potentials at the corners of an element. */
typedef struct shapes {
    double mean[4]; /* mean, over the element, of the bilinear shape function of each corner */
    double gradient[4][2]; /* gradient of each shape function at the centre of the element, along
                              the axes 1 and 2 of the shell (1/m) */
    double twist[4]; /* coefficient of xi1 xi2 in the shape function of each corner (dimensionless),
                        after the function is split into a part of uniform gradient and a remainder
                        with gradient 0 at the centre of the element */
    double dual[2][2]; /* gradients of xi1 and xi2 along the axes 1 and 2 of the shell (1/m) */
} shapes;

/*
 * Compute the gradients of the natural coordinates xi1 and xi2 of an element in the middle of a
 * ply.
 */
static void fill_dual(const laminate *laminate, const scene_element *element,
                      const laminate_place *place, int ply, double dual[2][2])
{
    const double middle = (laminate->ply[ply].z[0] + laminate->ply[ply].z[1]) / 2;
    const double z = element->metric ? middle : 0;
    double base[3][3];
    if (place->is_general)
        natural_dual_base(&place->natural, z, base);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 2; i++) {
            const double along = i == k ? 1 / (1 + place->curvature[k] * z) : 0;
            dual[k][i] = 2 / place->chord[k] * (place->is_general ? base[k][i] : along);
        }
}

static void fill_shapes(const laminate *laminate, const scene_element *element,
                        const laminate_place *place, int ply, shapes *shapes)
{
    fill_dual(laminate, element, place, ply, shapes->dual);
    for (int c = 0; c < 4; c++) {
        shapes->mean[c] = corner_share(place, c) / 4;
        shapes->twist[c] =
            (xi1[c] * xi2[c] - place->skew[0] * xi1[c] - place->skew[1] * xi2[c]) / 4;
        for (int i = 0; i < 2; i++)
            shapes->gradient[c][i] =
                (xi1[c] * shapes->dual[0][i] + xi2[c] * shapes->dual[1][i]) / 4;
    }
}

/*
 * List the five electric states of a ply, each of unit size: 1 V between its faces, then the
 * electric field along axis 1 at the inner and at the outer face (1 V/m), then those along axis 2.
 */
static void list_fields(int ply, laminate_field field[FIELDS])
{
    memset(field, 0, FIELDS * sizeof *field);
    for (int k = 0; k < FIELDS; k++) {
        field[k].ply = ply;
        field[k].axis = (k + 1) / 2;
        field[k].along[0] = k % 2;
        field[k].along[1] = 1 - k % 2;
    }
}

/*
 * Compute the five fields in a ply, as means over the element, while one of its eight potentials is
 * 1 V and the others are 0.
 *   node            in   index of the potential of 1 V: 2 corner + face (0: inner, 1: outer)
 *   coefficient [5] out  voltage across the ply (dimensionless); minus the gradient of the
 *       potential along axis 1 at the inner and outer face, then along axis 2 (1/m)
 */
static void coefficients(const shapes *shapes, int node, double coefficient[FIELDS])
{
    const int corner = node / 2, face = node % 2;
    memset(coefficient, 0, FIELDS * sizeof *coefficient);
    coefficient[0] = (face ? 1 : -1) * shapes->mean[corner];
    for (int axis = 0; axis < 2; axis++)
        coefficient[1 + 2 * axis + face] = -shapes->gradient[corner][axis];
}

/*
 * Return the part of the capacitance between two potentials of a ply (C/V) that comes from the
 * deviations of the fields from their means over the element.
 *   first, second    in  indices of the potentials: 2 corner + face (0: inner, 1: outer)
 *   uncoupled [5][5] in  capacitances of the ply for fields that vary with the mean 0: voltage
 *       across the ply, fields along axis 1 at the inner and outer face, and along axis 2
 */
static double varying_part(const laminate_place *place, const shapes *shapes, int first, int second,
                           double uncoupled[FIELDS][FIELDS])
{
    static const double shared[4] = {4.0 / 36, 2.0 / 36, 1.0 / 36, 2.0 / 36};
    const int one = first / 2, other = second / 2;
    const double product = shared[(one + 4 - other) % 4] + corner_pair_excess(place, one, other) -
                           shapes->mean[one] * shapes->mean[other];
    double twist = 0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            twist += (shapes->dual[0][i] * shapes->dual[0][j] +
                      shapes->dual[1][i] * shapes->dual[1][j]) *
                     uncoupled[1 + 2 * i + first % 2][1 + 2 * j + second % 2];
    return (first % 2 == second % 2 ? 1 : -1) * product * uncoupled[0][0] +
           shapes->twist[one] * shapes->twist[other] * twist / 3;
}

void potential_element_resultants(const laminate *laminate, const scene_element *element,
                                  const laminate_place *place, int ply,
                                  double resultants[POTENTIAL_NODES][LAMINATE_STRAINS])
{
    double unit[FIELDS][LAMINATE_STRAINS], coefficient[FIELDS];
    laminate_field field[FIELDS];
    shapes shapes;
    fill_shapes(laminate, element, place, ply, &shapes);
    list_fields(ply, field);
    for (int i = 0; i < FIELDS; i++)
        laminate_resultants(laminate, element, place, &field[i], unit[i]);
    for (int node = 0; node < POTENTIAL_NODES; node++) {
        coefficients(&shapes, node, coefficient);
        for (int k = 0; k < LAMINATE_STRAINS; k++) {
            resultants[node][k] = 0;
            for (int i = 0; i < FIELDS; i++)
                resultants[node][k] += coefficient[i] * unit[i][k];
        }
    }
}

void potential_element_capacitance(const laminate *laminate, const scene_element *element,
                                   const laminate_place *place, int ply, int other,
                                   double capacitance[POTENTIAL_NODES][POTENTIAL_NODES])
{
    double coupled[FIELDS][FIELDS], uncoupled[FIELDS][FIELDS], row[FIELDS], column[FIELDS];
    laminate_field first[FIELDS], second[FIELDS];
    shapes own, others;
    fill_shapes(laminate, element, place, ply, &own);
    fill_shapes(laminate, element, place, other, &others);
    list_fields(ply, first);
    list_fields(other, second);
    for (int i = 0; i < FIELDS; i++)
        for (int j = 0; j < FIELDS; j++) {
            coupled[i][j] =
                laminate_capacitance(laminate, element, place, &first[i], &second[j], true);
            uncoupled[i][j] =
                laminate_capacitance(laminate, element, place, &first[i], &second[j], false);
        }
    for (int node = 0; node < POTENTIAL_NODES; node++)
        for (int partner = 0; partner < POTENTIAL_NODES; partner++) {
            double *entry = &capacitance[node][partner];
            coefficients(&own, node, row);
            coefficients(&others, partner, column);
            *entry = varying_part(place, &own, node, partner, uncoupled);
            for (int i = 0; i < FIELDS; i++)
                for (int j = 0; j < FIELDS; j++)
                    *entry += row[i] * coupled[i][j] * column[j];
        }
}

void potential_element_charges(const laminate *laminate, const scene_element *element,
                               const laminate_place *place, int ply, const laminate_field *uniform,
                               double charge[POTENTIAL_NODES])
{
    double coefficient[FIELDS];
    laminate_field field[FIELDS];
    shapes shapes;
    fill_shapes(laminate, element, place, ply, &shapes);
    list_fields(ply, field);
    for (int node = 0; node < POTENTIAL_NODES; node++) {
        charge[node] = 0;
        coefficients(&shapes, node, coefficient);
        for (int i = 0; i < FIELDS; i++)
            charge[node] += coefficient[i] * laminate_capacitance(laminate, element, place,
                                                                  &field[i], uniform, true);
    }
}

void potential_element_field(const laminate *laminate, const scene_element *element,
                             const laminate_place *place, int ply,
                             const double potential[POTENTIAL_NODES], double *voltage,
                             double along[2][2])
{
    double coefficient[FIELDS];
    shapes shapes;
    fill_shapes(laminate, element, place, ply, &shapes);
    *voltage = 0;
    memset(along, 0, 4 * sizeof(double));
    for (int node = 0; node < POTENTIAL_NODES; node++) {
        coefficients(&shapes, node, coefficient);
        *voltage += coefficient[0] * potential[node];
        for (int k = 0; k < 4; k++)
            along[k / 2][k % 2] += coefficient[1 + k] * potential[node];
    }
}
