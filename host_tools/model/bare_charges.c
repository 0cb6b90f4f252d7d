/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Charges at the nodes of bare faces (faces of a layer without electrodes) while the strains are
 * zero (bare_charges.h).
 */
#include "bare_charges.h"
#include "load_forces.h"

/*
 * Return the address of one entry of the matrix of charges: the charge of an electrode, or at a
 * potential, per unit of an input.
 *   row in  row of the electrode or potential in the matrix
 */
static double *entry_of(const design *design, double *dense, int row, int input)
{
    return dense + (size_t)row * design->structure.input.count + (size_t)input;
}

/*
 * Return the row that an electric potential of a bare face (without electrode) has in the matrix of
 * the charges per unit of the inputs.
 */
static int row_of(const design *design, int potential)
{
    return design->electrodes.count - design->bare.count + potential;
}

/*
 * Compute the eight nodal charges (C) that a uniform voltage or a uniform temperature change of one
 * layer causes in one layer of an element at zero strain. A nodal charge is conjugate to the
 * electric potential at a node: one node at each of four corners on two faces.
 */
static void charges_of(const design *design, int layer, int element, const laminate_field *uniform,
                       double charge[POTENTIAL_NODES])
{
    const mesh *mesh = &design->mesh;
    potential_element_charges(&mesh->laminate, &mesh->formulation,
                              &mesh->place[mesh->element_type[element]], layer, uniform, charge);
}

void bare_charges_add_electrode(const design *design, int element, int ply, double factor, int row,
                                double *dense)
{
    const laminate_field voltage = {.ply = ply};
    const int input = design->electrodes.input[row];
    for (int layer = 0; layer < design->layers && design->bare.count > 0; layer++) {
        double charge[POTENTIAL_NODES];
        int number[POTENTIAL_NODES];
        if (!bare_faces_has(&design->bare, layer, element))
            continue;
        charges_of(design, layer, element, &voltage, charge);
        bare_faces_numbers(&design->bare, layer, element, number);
        for (int k = 0; k < POTENTIAL_NODES; k++) {
            if (number[k] < 0)
                continue;
            *entry_of(design, dense, row_of(design, number[k]), input) += factor * charge[k];
            *entry_of(design, dense, row, design->bare.first_input + number[k]) +=
                factor * charge[k];
        }
    }
}

/*
 * Add the charges at the nodes of one element on a bare face (without electrode) of a layer to the
 * matrix of charges, in the column of a temperature input (temperature load or heater).
 *   factor in  temperature of the layer per kelvin of the input
 */
static void add_temperature(const design *design, int layer, int element,
                            const laminate_field *temperature, double factor, int input,
                            double *dense)
{
    double charge[POTENTIAL_NODES];
    int number[POTENTIAL_NODES];
    charges_of(design, layer, element, temperature, charge);
    bare_faces_numbers(&design->bare, layer, element, number);
    for (int k = 0; k < POTENTIAL_NODES; k++)
        if (number[k] >= 0)
            *entry_of(design, dense, row_of(design, number[k]), input) += factor * charge[k];
}

void bare_charges_add_heater(const design *design, int element, int ply, double factor, int input,
                             double *dense)
{
    const laminate_field kelvin = {.ply = ply, .axis = LAMINATE_HEATED_PLY};
    for (int layer = 0; layer < design->layers && design->bare.count > 0; layer++)
        if (bare_faces_has(&design->bare, layer, element))
            add_temperature(design, layer, element, &kelvin, factor, input, dense);
}

static void add_temperatures(const design *design, int layer, int element, double *dense)
{
    const laminate_field kelvin = {.ply = -1, .temperature = {1, 1}};
    for (int k = 0; k < design->actuators; k++)
        if (scene_heats_all(&design->actuator[k]))
            add_temperature(design, layer, element, &kelvin, 1, design->actuator[k].first, dense);
    for (int k = 0; k < design->loads; k++)
        if (design->load[k].type == LOAD_TEMPERATURE) {
            const laminate_field load = load_temperatures(&design->load[k]);
            add_temperature(design, layer, element, &load, 1, design->amplifiers + k, dense);
        }
}

/*
 * Add the capacitances between the nodes on bare faces (without electrodes) of two layers, in one
 * element, to the matrix of charges: charge at each node of `layer` per volt at each node of
 * `other`.
 *   dense [electrodes and potentials][inputs] in/out  charges (C) per unit of each input
 */
static void add_pair(const design *design, int layer, int other, int element, double *dense)
{
    const double(*capacitance)[POTENTIAL_NODES] =
        bare_faces_capacitance(&design->bare, layer, other, element);
    int number[POTENTIAL_NODES], partner[POTENTIAL_NODES];
    bare_faces_numbers(&design->bare, layer, element, number);
    bare_faces_numbers(&design->bare, other, element, partner);
    for (int k = 0; k < POTENTIAL_NODES; k++)
        for (int m = 0; m < POTENTIAL_NODES; m++)
            if (number[k] >= 0 && partner[m] >= 0)
                *entry_of(design, dense, row_of(design, number[k]),
                          design->bare.first_input + partner[m]) += capacitance[k][m];
}

void bare_charges_add(const design *design, int element, double *dense)
{
    for (int layer = 0; layer < design->layers && design->bare.count > 0; layer++) {
        if (!bare_faces_has(&design->bare, layer, element))
            continue;
        for (int other = 0; other < design->layers; other++)
            if (bare_faces_has(&design->bare, other, element))
                add_pair(design, layer, other, element, dense);
        add_temperatures(design, layer, element, dense);
    }
}
