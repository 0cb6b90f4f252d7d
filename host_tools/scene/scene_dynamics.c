/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sections `dynamics` (data for vibration in addition to the densities) and `control` (data of the
 * control loop on the device) of a scene file.
 */
#include "scene_parts.h"

static const range ratio = {
    0, 1, 1,
    "must lie between 0 and 1, ends left out; it is a part of critical damping: "
    "write 0.01 for 1 %"};
static const range counted = {1, 200, 0, "must be from 1 to 200"};

static int read_list(reader *reader, int node, scene_dynamics *dynamics)
{
    int i, k = 0;
    dynamics->damping_of_mode =
        new_items(reader, node, TREE_LIST, sizeof *dynamics->damping_of_mode, &dynamics->dampings);
    if (!dynamics->damping_of_mode)
        return -1;
    if (dynamics->dampings == 0)
        return tree_fault(reader->t, node,
                          "'damping' is an empty list; give a ratio for each of "
                          "the first modes");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++)
        if (read_real(reader, i, &dynamics->damping_of_mode[k], &ratio) != 0)
            return -1;
    dynamics->damping = dynamics->damping_of_mode[0];
    return 0;
}

static int read_rayleigh(reader *reader, int node, void *to, const void *rule)
{
    scene_dynamics *dynamics = to;
    dynamics->is_rayleigh = true;
    return read_pair(reader, node, dynamics->rayleigh, rule);
}

static const form coefficients_form = {
    .type = FORM_LIST, .item = &not_negative_form, .least = 2, .most = 2};

static const field rayleigh_fields[] = {
    {"rayleigh", read_rayleigh, 0, &not_negative, 1, .of = OF_NUMBER, .form = &coefficients_form,
     .help = "Rayleigh's coefficients a of mass (rad/s) and b of stiffness (s/rad): the damping "
             "ratio at the angular frequency w is a/(2 w) + b w/2."},
    {.key = NULL}};

/*
 * Read damping ratios: one for all vibration modes, a list with one for each of the first vibration
 * modes, or Rayleigh's coefficients as {rayleigh: [a, b]}.
 */
static int read_damping(reader *reader, int node, void *to, const void *rule)
{
    scene_dynamics *dynamics = to;
    (void)rule;
    dynamics->damping_given = true;
    if (reader->t->node[node].kind == TREE_LIST)
        return read_list(reader, node, dynamics);
    if (reader->t->node[node].kind != TREE_MAP)
        return read_real(reader, node, &dynamics->damping, &ratio);
    if (read_map(reader, node, rayleigh_fields, dynamics) != 0)
        return -1;
    if (dynamics->rayleigh[0] + dynamics->rayleigh[1] > 0)
        return 0;
    return tree_fault(reader->t, node, "both of Rayleigh's coefficients are 0; one must be above");
}

static const form ratio_form = {.type = FORM_NUMBER, .range = &ratio};
static const form ratios_form = {.type = FORM_LIST, .item = &ratio_form, .least = 1};
static const form rayleigh_form = {.type = FORM_MAP, .fields = rayleigh_fields};
static const form *const damping_forms[] = {&ratio_form, &ratios_form, &rayleigh_form, NULL};
static const form damping_form = {.type = FORM_ANY, .any = damping_forms};

static const field dynamics_fields[] = {
    {"damping", read_damping, .of = OF_NUMBER, .form = &damping_form,
     .help = "Damping as a ratio to critical damping: one for every mode, a list for the first "
             "modes whose last entry holds for all others, or {rayleigh: [a, b]}; default 0.005."},
    {"modes", read_int, offsetof(scene_dynamics, modes), &counted, .of = OF_NUMBER,
     .help = "Number of vibration modes with which the control loop is assessed; default 30."},
    {"mass_per_area", read_real, offsetof(scene_dynamics, mass_per_area), &not_negative,
     .of = OF_AREA_DENSITY,
     .help = "Mass per area that belongs to no layer, such as wiring or a coating, at the middle "
             "of the laminate."},
    {.key = NULL}};

const form dynamics_form = {.type = FORM_MAP, .fields = dynamics_fields};

int read_dynamics(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    return read_map(reader, node, dynamics_fields, &scene->dynamics);
}

static const range margin_range = {0, 1, 0, "must be 0 or 1"};

static const form margin_form = {.type = FORM_WHOLE, .range = &margin_range};

static int read_margin(reader *reader, int node, void *to, const void *rule)
{
    scene_control *control = to;
    control->margin_at = node_at(reader, node);
    return read_int(reader, node, &control->delay_margin, rule);
}

static const field control_fields[] = {
    {"rate", read_real, offsetof(scene_control, rate), &above_zero, .of = OF_RATE,
     .help = "Tick rate of the control loop (ticks a second): the rate at which its stability is "
             "assessed, and the time axis of a simulation, which assumes 1000 if it is not given."},
    {"moving_target", read_flag, offsetof(scene_control, moving_target),
     .help = "Whether the target moves while it is followed: a governor then takes the lag out of "
             "the tick that damps vibration; default no."},
    {"clock", read_real, offsetof(scene_control, clock), &above_zero, .of = OF_RATE,
     .help = "Clock of the device's processor. With the rate it limits the work of a tick, and "
             "pzs check tells whether the processor can hold the rate."},
    {"delay_margin", read_margin, 0, &margin_range, .of = OF_NUMBER, .form = &margin_form,
     .help = "Number of ticks, 0 or 1, by which readings may be older than stated. With 1 the tick "
             "that damps vibration gets settings that stay stable then, or the loop is refused; it "
             "may compensate loads more slowly. Default 0."},
    {"modal_gains", read_modal_gains, .of = OF_NUMBER, .form = &modal_gains_form,
     .help = "Gains and leaks of shapes, as in adaptive optics, in the place of ticks that go all "
             "the way to the optimum; a loop with them does not damp vibration."},
    {"sensor_gate", read_flag, offsetof(scene_control, sensor_gate),
     .help = "Whether readings that cannot be count as missing: those beyond their range, and, "
             "where there are enough sensors, those that contradict the others; default no."},
    {.key = NULL}};

const form control_form = {.type = FORM_MAP, .fields = control_fields};

int read_control(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    return read_map(reader, node, control_fields, &scene->control);
}
