/* Electrodes of a scene (electrodes.h). */
#include "electrodes.h"
#include <stdlib.h>
#include "../../lib/model/electrode.h"

/* A volt of an input across a ply, in one element. */
typedef struct across {
    int input, ply;
    double factor;
} across;

/* Those of one actuator or sensor whose first input is `first`; the plies of different drives may
 * be the same. */
static int append_across(const mesh *m, const scene_actuator *a, int first, int element,
                         across *list)
{
    int count = 0;
    for (int k = 0; k < a->drives; k++) {
        const scene_patches *patches = &m->scene->patches[a->drive[k].patches];
        const int patch = design_patch(m, element, patches);
        const across one = {first + patch, patches->layer, a->drive[k].factor};
        if (patch >= 0)
            list[count++] = one;
    }
    return count;
}

/* All in one element. list [patch grids] out */
static int all_across(const design *d, int element, across *list)
{
    const scene *s = d->scene;
    int count = 0;
    for (int k = 0; k < s->actuators; k++)
        count +=
            append_across(&d->mesh, &s->actuator[k], s->actuator[k].first, element, list + count);
    for (int k = 0; k < s->sensors; k++)
        count += append_across(&d->mesh, &s->sensor[k], d->sensor_first + s->sensor[k].first,
                               element, list + count);
    return count;
}

/* Charge per unit of every input on the electrodes of one element, held. dense [electrodes][inputs]
 * in/out */
static void add_element(const design *d, int element, across *list, double *dense)
{
    const mesh *m = &d->mesh;
    const scene *s = d->scene;
    const laminate_place *place = &m->place[m->element_kind[element]];
    const int count = all_across(d, element, list);
    for (int i = 0; i < count; i++) {
        const across *own = &list[i];
        double *row = dense + (size_t)electrodes_of(d, own->input) * d->structure.input.count;
        for (int j = 0; j < count; j++) {
            const laminate_field voltage = {list[j].ply, {0, 0}};
            row[list[j].input] +=
                own->factor * list[j].factor *
                laminate_charge(&m->laminate, &s->element, place, own->ply, &voltage);
        }
        for (int k = 0; k < s->actuators; k++) {
            const laminate_field kelvin = {-1, {1, 1}};
            if (s->actuator[k].is_temperature)
                row[s->actuator[k].first] +=
                    own->factor *
                    laminate_charge(&m->laminate, &s->element, place, own->ply, &kelvin);
        }
        for (int k = 0; k < s->loads; k++)
            if (s->load[k].type == LOAD_TEMPERATURE) {
                const laminate_field kelvin = design_kelvin(&s->load[k]);
                row[d->amplifiers + k] += own->factor * laminate_charge(&m->laminate, &s->element,
                                                                        place, own->ply, &kelvin);
            }
    }
}

/* Inputs that are volts: amplifiers but those of a temperature, then the sensors' electrodes. */
static uint16_t list_inputs(const design *d, uint16_t *input, uint8_t *open)
{
    const scene *s = d->scene;
    uint16_t count = 0;
    for (int k = 0; k < s->actuators; k++)
        for (int c = 0;
             c < s->actuator[k].grid[0] * s->actuator[k].grid[1] && !s->actuator[k].is_temperature;
             c++)
            input[count++] = (uint16_t)(s->actuator[k].first + c);
    for (int k = 0; k < s->sensors; k++)
        for (int c = 0; c < s->sensor[k].grid[0] * s->sensor[k].grid[1]; c++) {
            open[count] = (uint8_t)s->sensor[k].open;
            input[count++] = (uint16_t)(d->sensor_first + s->sensor[k].first + c);
        }
    return count;
}

static void sparse(const double *dense, size_t rows, size_t columns, uint32_t *start, uint16_t *dof,
                   double *value)
{
    uint32_t entries = 0;
    for (size_t k = 0; k < rows; k++) {
        for (size_t j = 0; j < columns; j++)
            if (dense[k * columns + j] != 0) {
                dof[entries] = (uint16_t)j;
                value[entries++] = dense[k * columns + j];
            }
        start[k + 1] = entries;
    }
}

static int is_wanted(const scene *s)
{
    int wanted = s->sensors > 0;
    for (int k = 0; k < s->outputs; k++)
        wanted |= s->output[k].electric != ELECTRIC_NONE;
    return wanted;
}

int electrodes_build(design *d, char *error)
{
    const size_t inputs = d->structure.input.count;
    pzs_electrodes *t = &d->electrodes;
    uint16_t *input = calloc(inputs + 1, sizeof *input), *dof = NULL;
    uint8_t *open = calloc(inputs + 1, sizeof *open);
    uint32_t *start = calloc(inputs + 1, sizeof *start);
    across *list = calloc((size_t)d->scene->patch_grids + 1, sizeof *list);
    double *dense = NULL, *value = NULL;
    const int wanted = is_wanted(d->scene), ready = input && open && start && list;
    t->input = input;
    t->open = open;
    t->count = wanted && ready ? list_inputs(d, input, open) : 0;
    dense = calloc(t->count * inputs + 1, sizeof *dense);
    dof = calloc(t->count * inputs + 1, sizeof *dof);
    value = calloc(t->count * inputs + 1, sizeof *value);
    if (ready && dense && dof && value) {
        for (int e = 0; e < d->mesh.elements && t->count > 0; e++)
            add_element(d, e, list, dense);
        sparse(dense, t->count, inputs, start, dof, value);
    }
    const pzs_rows direct = {t->count, start, dof, value};
    t->direct = direct;
    t->format = PZS_TABLE_FORMAT;
    t->scene = d->scene->hash;
    free(list);
    free(dense);
    if (!ready || !dense || !dof || !value)
        return scene_fault(d->scene, d->scene->at_surface, error,
                           "electrodes do not fit into memory");
    t->crc = pzs_electrode_crc(t, (uint32_t)inputs);
    return 0;
}

void electrodes_free(design *d)
{
    design_release(d->electrodes.input);
    design_release(d->electrodes.open);
    design_release(d->electrodes.direct.start);
    design_release(d->electrodes.direct.dof);
    design_release(d->electrodes.direct.value);
}

int electrodes_of(const design *d, int input)
{
    for (int k = 0; k < d->electrodes.count; k++)
        if (d->electrodes.input[k] == input)
            return k;
    return -1;
}

int electrodes_input(const design *d, const scene_output *output, int i)
{
    return (output->of_sensor ? d->sensor_first : 0) + output->first + i;
}
