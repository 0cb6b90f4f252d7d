/* SPDX-License-Identifier: BSD-2-Clause */
/* Mass tables of a structure (mass_tables.h). */
#include "mass_tables.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/shell.h"
#include "../model/mass.h"

/*
 * Largest difference of two entries that count as equal, relative to the largest entry of the
 * matrix: rounding errors of the 12 operations from the triads of the nodes to an entry.
 */
static const double equal_to = 16 * DBL_EPSILON;

static size_t packed_entries(const design *design)
{
    return SHELL_PACKED(SHELL_NODES * (size_t)design->mesh.dof_per_node);
}

static double largest_entry(const double *matrix, size_t entries)
{
    double largest = 0;
    for (size_t i = 0; i < entries; i++)
        largest = fmax(largest, fabs(matrix[i]));
    return largest;
}

/* Whether all entries of two packed matrices differ by at most `limit`. */
static bool are_equal(const double *one, const double *other, size_t entries, double limit)
{
    for (size_t i = 0; i < entries; i++)
        if (!(fabs(one[i] - other[i]) <= limit))
            return false;
    return true;
}

/* Index of the first of the types found so far that has the mass matrix of an element. */
static uint16_t find_type(const mass_tables *mass, const double *entry, size_t entries)
{
    const double limit = equal_to * largest_entry(entry, entries);
    uint16_t type = 0;
    while (type < mass->tables.types &&
           !are_equal(mass->matrix + type * entries, entry, entries, limit))
        type++;
    return type;
}

static void fill(mass_tables *mass, const design *design, const struct mass *host)
{
    const size_t entries = packed_entries(design);
    for (int element = 0; element < design->mesh.elements; element++) {
        const double *entry = mass_element(host, element);
        const uint16_t type = find_type(mass, entry, entries);
        if (type == mass->tables.types) {
            memcpy(mass->matrix + type * entries, entry, entries * sizeof *entry);
            mass->tables.types++;
        }
        mass->element_type[element] = type;
    }
    mass->tables.element_type = mass->element_type;
    mass->tables.matrix = mass->matrix;
    pzs_mass_seal(&mass->tables, &design->structure);
}

int mass_tables_make(mass_tables *mass, const design *design, double lumped, char *error)
{
    const size_t elements = (size_t)design->mesh.elements;
    struct mass host;
    memset(mass, 0, sizeof *mass);
    if (mass_build(&host, design, lumped, error) < 0)
        return -1;
    mass->element_type = malloc(elements * sizeof *mass->element_type);
    mass->matrix = malloc(elements * packed_entries(design) * sizeof *mass->matrix);
    const bool has_memory = mass->element_type && mass->matrix;
    if (has_memory)
        fill(mass, design, &host);
    else
        scene_fault(design->at, error, "the mass of %zu elements does not fit into memory",
                    elements);
    mass_free(&host);
    return has_memory ? 0 : -1;
}

void mass_tables_free(mass_tables *mass)
{
    free(mass->element_type);
    free(mass->matrix);
    memset(mass, 0, sizeof *mass);
}
