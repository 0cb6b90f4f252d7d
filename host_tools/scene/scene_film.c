/* SPDX-License-Identifier: BSD-2-Clause */
/* Thin actuators of a material by the numbers of their data sheet (scene_film.h). */
#include <math.h>
#include <string.h>
#include "scene_film.h"

static const form strain_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};

static const field film_fields[] = {
    {"voltage", read_real, offsetof(scene_film, voltage), &above_zero, 1, .of = OF_VOLTAGE,
     .help = "Voltage at which the strains and the force are given."},
    {"strain", read_pair, offsetof(scene_film, strain), .required = 1, .of = OF_NUMBER,
     .form = &strain_form,
     .help = "Free strains [along the fibres, across them] at that voltage, with their signs: a "
             "film in d33 mode (P1) elongates along, one in d31 mode (P2) contracts."},
    {"thickness", read_real, offsetof(scene_film, thickness), &above_zero, 1, .of = OF_LENGTH,
     .help = "Thickness of the film, which is that of its layer."},
    {"blocking_force", read_real, offsetof(scene_film, force), &above_zero, .of = OF_FORCE,
     .help = "Force along the fibres of a film that cannot elongate; gives E1."},
    {"width", read_real, offsetof(scene_film, width), &above_zero, .of = OF_LENGTH,
     .help = "Width of the film that has the blocking force."},
    {.key = NULL}};
static const form_case film_cases[] = {
    {"voltage strain thickness", "A film whose E1 is given."},
    {"voltage strain thickness blocking_force width", "A film whose E1 follows from the force."},
    {NULL, NULL}};
const form film_form = {.type = FORM_MAP, .fields = film_fields, .cases = film_cases};

int read_film(reader *reader, int node, void *to, const void *rule)
{
    scene_film *film = to;
    (void)rule;
    if (read_map(reader, node, film_fields, film) != 0)
        return -1;
    if ((film->force > 0) != (film->width > 0))
        return tree_fault(reader->t, node,
                          "'blocking_force' and 'width' belong together; give both or none");
    if (film->force > 0 && film->strain[0] == 0)
        return tree_fault(reader->t, node,
                          "a film that does not elongate along its fibres has no blocking force; "
                          "give E1 instead");
    return 0;
}

double scene_film_constant(const scene_film *film, int direction)
{
    return -film->strain[direction] * film->thickness / film->voltage;
}

double scene_film_modulus(const scene_film *film)
{
    return film->force / (fabs(film->strain[0]) * film->width * film->thickness);
}
