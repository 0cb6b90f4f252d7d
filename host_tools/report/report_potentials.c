/* SPDX-License-Identifier: BSD-2-Clause */
/* Potentials of faces without electrode as arrays of a VTK file (report.h). */
#include <stdio.h>
#include <stdlib.h>
#include "../model/bare_faces.h"
#include "../text/words.h"
#include "report.h"

/*
 * Write the name of the array with the electric potentials of a face of a layer: layer, face and
 * unit.
 */
static void name_array(const design *design, int layer, int face, report_array *array)
{
    char unit[WORDS_UNIT];
    words_unit(&design->units, QUANTITY_VOLTAGE, unit);
    snprintf(array->name, sizeof array->name, "potential of layer %d %.60s, %s face%s%.30s%s",
             layer + 1, design->layer[layer].name, face ? "outer" : "inner", *unit ? " (" : "",
             unit, *unit ? ")" : "");
}

int report_potentials(const design *design, const double *value, report_array *array)
{
    int count = 0;
    for (int layer = 0; layer < design->layers; layer++)
        for (int face = 0; face < 2; face++) {
            report_array *own = &array[count];
            if (!(design->layer[layer].bare & (face ? BARE_OUTER : BARE_INNER)))
                continue;
            *own = (report_array){.components = 1};
            name_array(design, layer, face, own);
            own->value = calloc((size_t)design->mesh.nodes, sizeof *own->value);
            count++;
            for (int node = 0; own->value && node < design->mesh.nodes; node++)
                own->value[node] = bare_faces_potential(&design->bare, value, layer, face, node);
            if (own->value)
                continue;
            while (count > 0)
                free(array[--count].value);
            return -1;
        }
    return count;
}
