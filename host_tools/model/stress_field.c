/* SPDX-License-Identifier: BSD-2-Clause */
/* Strains, resultants and ply stresses of elements at their centres (stress_field.h). */
#include "stress_field.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/shell.h"
#include "../mesh/invert.h"
#include "../quads/vector.h"
#include "load_forces.h"
#include "strain.h"

const char *const stress_height_name[STRESS_HEIGHTS] = {"inner", "middle", "outer"};
const char *const stress_component_name[STRESS_COMPONENTS] = {"11", "22", "33", "23", "13", "12"};

/*
 * Index of the mean thickness strain 33 among the ten strains of an element (pzs_element_type.d).
 */
enum { MEAN_33 = 4 };

static const laminate_place *place_of(const mesh *mesh, int element)
{
    return &mesh->place[mesh->element_type[element]];
}

bool stress_is_present(const stress_field *field, int element, int layer)
{
    const mesh *mesh = &field->state.design->mesh;
    return place_of(mesh, element)->present_plies >> layer & 1u;
}

double stress_height(const stress_field *field, int layer, int height)
{
    const double *z = field->state.design->mesh.laminate.ply[layer].z;
    return z[0] + (z[1] - z[0]) * height / (STRESS_HEIGHTS - 1);
}

/* ---- axes --------------------------------------------------------------- */

/*
 * Compute the unit vector along direction 1 (a = 0) or direction 2 (a = 1) of an element, which
 * connects the midpoints of two opposite sides.
 */
static void chord_of(const mesh *mesh, int element, int a, double unit[3])
{
    static const int sign[2][4] = {{-1, 1, 1, -1}, {-1, -1, 1, 1}};
    for (int i = 0; i < 3; i++) {
        unit[i] = 0;
        for (int corner = 0; corner < 4; corner++)
            unit[i] += sign[a][corner] * mesh->point[mesh->element[element][corner]].position[i];
    }
    vector_normalise(unit);
}

/*
 * Compute the shell axes of an element of an irregular mesh. They are determined by the unit
 * vectors between the midpoints of its opposite sides (chord_of). The components of these two
 * vectors in the shell axes are stored with the element (natural_base.h).
 */
static void general_axes(const mesh *mesh, int element, double axis[3][3])
{
    const double(*base)[3] = (const double(*)[3])place_of(mesh, element)->natural.base;
    const double size = base[0][0] * base[1][1] - base[0][1] * base[1][0];
    double chord[2][3];
    for (int a = 0; a < 2; a++)
        chord_of(mesh, element, a, chord[a]);
    for (int i = 0; i < 3; i++) {
        axis[0][i] = (chord[0][i] * base[1][1] - chord[1][i] * base[1][0]) / size;
        axis[1][i] = (chord[1][i] * base[0][0] - chord[0][i] * base[0][1]) / size;
    }
    vector_cross(axis[0], axis[1], axis[2]);
}

/*
 * Compute the shell axes of an element whose sides follow lines of curvature: the element's two
 * directions, turned by equal and opposite small angles so that they become orthogonal.
 */
static void line_axes(const mesh *mesh, int element, double axis[3][3])
{
    double chord[2][3], across[3];
    for (int a = 0; a < 2; a++)
        chord_of(mesh, element, a, chord[a]);
    vector_cross(chord[0], chord[1], axis[2]);
    vector_normalise(axis[2]);
    vector_cross(chord[1], axis[2], across);
    for (int i = 0; i < 3; i++)
        axis[0][i] = chord[0][i] + across[i];
    vector_normalise(axis[0]);
    vector_cross(axis[2], axis[0], axis[1]);
}

/*
 * Compute the centre of an element, which is the mean of its corners, and its shell axes.
 *   place [3]    out  centre of the element
 *   axis  [3][3] out  unit vectors of the shell axes 1, 2 and 3 as rows
 */
static void find_axes(const mesh *mesh, int element, double place[3], double axis[3][3])
{
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int corner = 0; corner < 4; corner++)
            place[i] += mesh->point[mesh->element[element][corner]].position[i] / 4;
    }
    (place_of(mesh, element)->is_general ? general_axes : line_axes)(mesh, element, axis);
}

/*
 * Gather the displacement of the four nodes of an element from the displacement vector of the
 * structure; constrained dof are 0 (local [4 dof_per_node] out).
 */
static void gather(const mesh *mesh, int element, const double *displacement, double *local)
{
    for (int corner = 0; corner < 4; corner++) {
        const uint16_t *dof =
            mesh->node_dof + (size_t)mesh->element[element][corner] * mesh->dof_per_node;
        for (unsigned i = 0; i < mesh->dof_per_node; i++)
            local[i] = dof[i] == PZS_CONSTRAINED ? 0 : displacement[dof[i]];
        mesh_turn_to_triad(mesh, mesh->element[element][corner], local);
        local += mesh->dof_per_node;
    }
}

/* ---- prescribed fields ------------------------------------------------------ */

/*
 * Add the voltages, or the temperatures of heaters, that an actuator or sensor applies in an
 * element through one grid of patches: means over the area in which the layer is present.
 *   value                in      voltages of the electrodes (V) or temperatures of the heaters (K)
 *   part    [most_parts] out     work array
 *   applied [layers]     in/out  voltages or temperatures of the layers of the element
 */
static void add_drive(const stress_field *field, int element, const scene_drive *drive,
                      const double *value, design_part *part, double *applied)
{
    const scene_patches *patches = &field->state.design->patches[drive->patches];
    const mesh *mesh = &field->state.design->mesh;
    const double cover = laminate_cover(place_of(mesh, element), patches->layer);
    const int parts = design_patches_in(mesh, element, patches, part);
    for (int i = 0; i < parts; i++)
        applied[patches->layer] += part[i].share / cover * drive->factor * value[part[i].patch];
}

/*
 * For a list of actuators, or of sensors, add the voltages of their electrodes and the temperatures
 * of their heaters in one element to the arrays field->voltage and field->heat.
 *   value [electrodes] in   voltage (V) of each electrode, or temperature (K) of each heater, of
 *                           all items of the list in turn
 *   part               out  work array: the patches that cover parts of the element, with their
 *                           shares of it
 */
static void add_patches(const stress_field *field, int element, const scene_actuator *actuator,
                        int count, const double *value, design_part *part)
{
    const size_t row = (size_t)element * (size_t)field->layers;
    for (int k = 0; k < count; k++)
        for (int drive = 0; drive < actuator[k].drives; drive++)
            add_drive(field, element, &actuator[k].drive[drive], value + actuator[k].first, part,
                      (actuator[k].is_temperature ? field->heat : field->voltage) + row);
}

/*
 * Add the temperatures that all temperature inputs and temperature loads cause on the inner and on
 * the outer face of the laminate.
 *   temperature [2] in/out  temperatures of both faces (K)
 */
static void add_temperatures(const stress_state *state, double temperature[2])
{
    const design *design = state->design;
    for (int k = 0; k < design->actuators; k++)
        for (int face = 0; face < 2 && scene_heats_all(&design->actuator[k]); face++)
            temperature[face] += state->input_value[design->actuator[k].first];
    for (int k = 0; k < design->loads; k++) {
        if (design->load[k].type != LOAD_TEMPERATURE)
            continue;
        const laminate_field load = load_temperatures(&design->load[k]);
        for (int face = 0; face < 2; face++)
            temperature[face] +=
                state->input_value[state->design->amplifiers + k] * load.temperature[face];
    }
}

/*
 * Return the largest number of electrodes of one grid of patches that lie, at least in part, on the
 * same element.
 */
static int most_parts(const design *design)
{
    int most = 1;
    for (int k = 0; k < design->patch_grids; k++)
        for (int element = 0; element < design->mesh.elements; element++) {
            const int parts = design_patches_in(&design->mesh, element, &design->patches[k], NULL);
            most = parts > most ? parts : most;
        }
    return most;
}

/* Fill the voltages of electrodes and the temperatures of heaters in all elements and layers. */
static int fill_patches(stress_field *field)
{
    const stress_state *state = &field->state;
    const design *design = state->design;
    design_part *part = calloc((size_t)most_parts(state->design), sizeof *part);
    for (int element = 0; part && element < field->elements; element++) {
        add_patches(field, element, design->actuator, design->actuators, state->input_value, part);
        add_patches(field, element, design->sensor, design->sensors,
                    state->input_value + state->design->sensor_first, part);
    }
    free(part);
    return part ? 0 : -1;
}

/* ---- element states --------------------------------------------------------- */

/*
 * Add the stress resultants that voltages or temperatures prescribe in an element, multiplied by a
 * factor and by the area of the element.
 *   resultant [10] in/out stress resultants for mean and difference of both faces for the strains
 *   11, 22, 33 and 12; then the strains 13 and 23
 */
static void add_prescribed(const mesh *mesh, int element, const laminate_field *given,
                           double factor, double resultant[10])
{
    double h0[LAMINATE_STRAINS];
    laminate_resultants(&mesh->laminate, &mesh->formulation, place_of(mesh, element), given, h0);
    for (int i = 0; i < LAMINATE_STRAINS; i++)
        resultant[i] += factor * h0[i];
}

/*
 * Return the total thickness of the plies that are present in an element (m), as a mean over its
 * area. Each height is weighted with the area of the surface at this height relative to the area of
 * the reference surface.
 */
static double present_thickness(const mesh *mesh, int element)
{
    const laminate_place *place = place_of(mesh, element);
    const scene_element *option = &mesh->formulation;
    double sum = 0;
    for (int layer = 0; layer < mesh->laminate.plies; layer++) {
        const double *z = mesh->laminate.ply[layer].z;
        sum += laminate_cover(place, layer) * (z[1] - z[0]) / 6 *
               (laminate_area_ratio(option, place, z[0]) +
                4 * laminate_area_ratio(option, place, (z[0] + z[1]) / 2) +
                laminate_area_ratio(option, place, z[1]));
    }
    return sum;
}

/* Return the temperature change of a layer in an element by heaters on its patches (K). */
static double heat_of(const stress_field *field, int element, int layer)
{
    return field->heat[(size_t)element * (size_t)field->layers + (size_t)layer];
}

/*
 * Return the mean voltage across a layer in an element (V): that of its electrodes, or that of the
 * potentials of its bare faces (without electrodes).
 */
static double voltage_across(const stress_field *field, int element, int layer)
{
    double across, along[2][2];
    bare_faces_field(&field->state.design->bare, field->state.input_value, layer, element, &across,
                     along);
    return field->voltage[(size_t)element * (size_t)field->layers + (size_t)layer] + across;
}

/*
 * Add the stress resultants, times the area of the element, that the electric field of bare faces
 * (without electrodes) along the surface prescribes in a layer.
 *   resultant [10] in/out stress resultants for mean and difference of both faces for the strains
 *   11, 22, 33 and 12; then the strains 13 and 23
 */
static void add_along(const stress_field *field, int element, int layer, double resultant[10])
{
    double across, along[2][2];
    if (!bare_faces_field(&field->state.design->bare, field->state.input_value, layer, element,
                          &across, along))
        return;
    for (int axis = 0; axis < 2; axis++) {
        const laminate_field own = {
            .ply = layer, .axis = axis + 1, .along = {along[axis][0], along[axis][1]}};
        add_prescribed(&field->state.design->mesh, element, &own, 1, resultant);
    }
}

/*
 * Compute the stress resultants of an element: its stiffness matrix for strains that are constant
 * over the element times these strains, plus the resultants that its voltages and temperatures
 * cause at zero strains.
 */
static void fill_resultants(const stress_field *field, int element)
{
    const mesh *mesh = &field->state.design->mesh;
    const double *stiffness = mesh->type[mesh->element_type[element]].d;
    stress_element *own = &field->element[element];
    double resultant[10] = {0};
    for (int i = 0; i < 10; i++)
        for (int j = 0; j < 10; j++) {
            const int row = i > j ? i : j;
            const int column = i > j ? j : i;
            resultant[i] += stiffness[row * (row + 1) / 2 + column] * own->strain[j];
        }
    for (int layer = 0; layer < field->layers; layer++) {
        const laminate_field volt = {.ply = layer};
        const double voltage = voltage_across(field, element, layer);
        const laminate_field warm = {.ply = layer, .axis = LAMINATE_HEATED_PLY};
        const double heat = heat_of(field, element, layer),
                     cover = laminate_cover(place_of(mesh, element), layer);
        if (voltage != 0)
            add_prescribed(mesh, element, &volt, cover * voltage, resultant);
        if (heat != 0)
            add_prescribed(mesh, element, &warm, cover * heat, resultant);
    }
    for (int layer = 0; layer < field->layers; layer++)
        add_along(field, element, layer, resultant);
    const laminate_field heat = {.ply = -1,
                                 .temperature = {own->temperature[0], own->temperature[1]}};
    if (heat.temperature[0] != 0 || heat.temperature[1] != 0)
        add_prescribed(mesh, element, &heat, 1, resultant);
    for (int i = 0; i < 10; i++)
        own->resultant[i] =
            resultant[i] / place_of(mesh, element)->area +
            (field->correction.resultant ? field->correction.resultant[element][i] : 0);
    own->normal_stress = own->resultant[MEAN_33] / present_thickness(mesh, element);
}

static void fill_element(const stress_field *field, int element)
{
    const mesh *mesh = &field->state.design->mesh;
    stress_element *own = &field->element[element];
    double local[SHELL_MAX];
    find_axes(mesh, element, own->place, own->axis);
    gather(mesh, element, field->state.displacement, local);
    strain_of_element(mesh, element, local, field->state.is_nonlinear, own->strain);
    add_temperatures(&field->state, own->temperature);
    fill_resultants(field, element);
}

/* ---- plies -------------------------------------------------------------------- */

/*
 * Compute the voltage and the temperature that actuate a layer at height z.
 *   voltage out  voltage across the layer (V), times the ratio of the electric field at this height
 *                to the mean field of the layer
 *   kelvin  out  temperature above that of the stress-free shape (K)
 */
static void causes_at(const stress_field *field, int element, int layer, double z, double *voltage,
                      double *kelvin)
{
    const mesh *mesh = &field->state.design->mesh;
    const double *temperature = field->element[element].temperature;
    const laminate_field volt = {.ply = layer},
                         heat = {.ply = -1, .temperature = {temperature[0], temperature[1]}};
    const laminate_place *place = place_of(mesh, element);
    *voltage = voltage_across(field, element, layer) *
               laminate_field_at(&mesh->laminate, &mesh->formulation, place, &volt, z);
    *kelvin = laminate_field_at(&mesh->laminate, &mesh->formulation, place, &heat, z) +
              heat_of(field, element, layer);
}

/*
 * Compute the stress that the voltage and the temperature of a layer cause at height z if all
 * strains are zero, in the shell axes (stress [6] out, Pa).
 */
static void prescribed_stress(const stress_field *field, int element, int layer, double z,
                              double stress[6])
{
    const laminate_ply *ply = &field->state.design->mesh.laminate.ply[layer];
    double voltage, kelvin, across, along[2][2];
    causes_at(field, element, layer, z, &voltage, &kelvin);
    for (int i = 0; i < 6; i++)
        stress[i] = ply->stress_per_voltage[i] * voltage + ply->stress_per_kelvin[i] * kelvin;
    if (!bare_faces_field(&field->state.design->bare, field->state.input_value, layer, element,
                          &across, along))
        return;
    const double height = (z - ply->z[0]) / (ply->z[1] - ply->z[0]);
    for (int axis = 0; axis < 2; axis++)
        for (int i = 0; i < 6; i++)
            stress[i] += ply->stress_along[axis][i] *
                         (along[axis][0] * (1 - height) + along[axis][1] * height);
}

/* Compute a symmetric 6 x 6 matrix times a vector, plus another vector (sum [6] out). */
static void product_plus(const double matrix[6][6], const double vector[6], const double plus[6],
                         double sum[6])
{
    for (int i = 0; i < 6; i++) {
        sum[i] = plus[i];
        for (int j = 0; j < 6; j++)
            sum[i] += matrix[i][j] * vector[j];
    }
}

/*
 * Compute the strain and the stress of a layer at height z in the shell axes, with transverse shear
 * strains of zero. With the element option lin33 (every ply thickens freely) the thickness strain
 * 33 of the layer follows from the normal stress 33 that all plies share.
 */
static void ply_state(const stress_field *field, int element, int layer, double z, double strain[6],
                      double stress[6])
{
    const mesh *mesh = &field->state.design->mesh;
    const double(*c)[6] = (const double(*)[6])mesh->laminate.ply[layer].c;
    const stress_element *own = &field->element[element];
    const bool is_free = mesh->formulation.lin33;
    double map[6][6], given[6], in_plane[STRAIN_COUNT], work = -own->normal_stress, stiffness = 0;
    laminate_strain_map(&mesh->formulation, place_of(mesh, element), z, map);
    memcpy(in_plane, own->strain, sizeof in_plane);
    if (is_free)
        in_plane[MEAN_33] = in_plane[MEAN_33 + 1] = 0;
    strain_at_height(mesh, element, in_plane, z, strain);
    prescribed_stress(field, element, layer, z, given);
    product_plus(c, strain, given, stress);
    if (!is_free)
        return;
    for (int i = 0; i < 6; i++) {
        work += map[i][2] * stress[i];
        for (int j = 0; j < 6; j++)
            stiffness += map[i][2] * c[i][j] * map[j][2];
    }
    for (int i = 0; i < 6; i++)
        strain[i] -= map[i][2] * work / stiffness;
    product_plus(c, strain, given, stress);
}

static void fill_samples(const stress_field *field, int element)
{
    stress_sample *sample =
        field->sample + (size_t)element * (size_t)field->layers * STRESS_HEIGHTS;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const int layer = i / STRESS_HEIGHTS;
        double strain[6], stress[6];
        if (!stress_is_present(field, element, layer))
            continue;
        ply_state(field, element, layer, stress_height(field, layer, i % STRESS_HEIGHTS), strain,
                  stress);
        sample[i].plane[0] = stress[0];
        sample[i].plane[1] = stress[1];
        sample[i].plane[2] = stress[5];
        sample[i].normal = sample[i].own_normal = stress[2];
        sample[i].thickening = strain[2];
    }
}

/*
 * Return the electric displacement along the electric field at the middle of a layer (C/m2), from
 * the strain of the layer in the shell axes. The signs of the piezoelectric terms are stated at
 * laminate_ply.
 */
static double electric_displacement(const stress_field *field, int element, int layer, double z,
                                    const double strain[6])
{
    const laminate_ply *ply = &field->state.design->mesh.laminate.ply[layer];
    double voltage, kelvin;
    causes_at(field, element, layer, z, &voltage, &kelvin);
    double sum = (-ply->capacitance * voltage - ply->pyroelectric_charge * kelvin) *
                 (ply->electrode_distance / (ply->z[1] - ply->z[0]));
    for (int i = 0; i < 6; i++)
        sum += ply->electrode_distance * ply->stress_per_voltage[i] * strain[i];
    return sum;
}

/*
 * Compute the transverse shear strains 23 and 13 of a layer from its transverse shear stresses.
 *   shear [2] in  stresses 13 and 23 (Pa)
 *   given [6] in  stress that voltage and temperature cause if all strains are zero (Pa)
 */
static void shear_strains(const laminate_ply *ply, const double shear[2], const double given[6],
                          double strain[6])
{
    const double elastic[2] = {shear[0] - given[4], shear[1] - given[3]};
    const double size = ply->c[3][3] * ply->c[4][4] - ply->c[3][4] * ply->c[4][3];
    strain[3] = (ply->c[4][4] * elastic[1] - ply->c[3][4] * elastic[0]) / size;
    strain[4] = (ply->c[3][3] * elastic[0] - ply->c[4][3] * elastic[1]) / size;
}

void stress_shear_strains(const stress_field *field, int element, int layer, int height,
                          double strain[2])
{
    const stress_sample *sample =
        field->sample + ((size_t)element * (size_t)field->layers + (size_t)layer) * STRESS_HEIGHTS;
    double given[6], all[6];
    prescribed_stress(field, element, layer, stress_height(field, layer, height), given);
    shear_strains(&field->state.design->mesh.laminate.ply[layer], sample[height].shear, given, all);
    strain[0] = all[4];
    strain[1] = all[3];
}

/*
 * Complete a layer for bent cross-sections (stress_warp.h). Add their in-plane strains to the
 * strains of the layer, and the thickness strain 33 that they cause while the normal stress 33
 * stays the same. Replace the in-plane stresses by those in `sample`, which belong to these
 * strains. If the stresses contain the effect of a normal stress 33 that varies with the height
 * (has_squeeze), the thickness strain 33 gets its effect, too.
 */
static void add_warp(const laminate_ply *ply, const stress_sample *sample, bool has_squeeze,
                     double strain[6], double stress[6])
{
    static const int plane[3] = {0, 1, 5};
    if (has_squeeze)
        strain[2] += (sample->normal - sample->own_normal) / ply->c[2][2];
    for (int i = 0; i < 3; i++) {
        strain[plane[i]] += sample->warp[i];
        strain[2] -= ply->c[2][plane[i]] / ply->c[2][2] * sample->warp[i];
        stress[plane[i]] = sample->plane[i];
    }
}

void stress_layer_of(const stress_field *field, int element, int layer, stress_layer *result)
{
    const mesh *mesh = &field->state.design->mesh;
    const laminate_ply *ply = &mesh->laminate.ply[layer];
    const double angle = field->state.design->layer[layer].angle * 0.017453292519943295;
    const stress_sample *sample =
        field->sample + ((size_t)element * (size_t)field->layers + (size_t)layer) * STRESS_HEIGHTS;
    for (int height = 0; height < STRESS_HEIGHTS; height++) {
        const double z = stress_height(field, layer, height);
        double strain[6], stress[6], given[6];
        ply_state(field, element, layer, z, strain, stress);
        prescribed_stress(field, element, layer, z, given);
        stress[2] = sample[height].normal;
        stress[3] = sample[height].shear[1];
        stress[4] = sample[height].shear[0];
        shear_strains(ply, sample[height].shear, given, strain);
        if (height == 1)
            result->displacement = electric_displacement(field, element, layer, z, strain);
        if (field->correction.electric)
            result->displacement =
                field->correction.electric[(size_t)element * (size_t)field->layers + (size_t)layer];
        add_warp(ply, &sample[height], field->has_squeeze, strain, stress);
        strain_turn_stress(stress, angle, result->at[height].stress);
        strain_turn(strain, angle, result->at[height].strain);
    }
    result->field = -voltage_across(field, element, layer) / ply->electrode_distance;
}

/* ---- neighbours ----------------------------------------------------------------- */

/* Return whether two elements have the same plies, which cover the same fraction of each. */
static bool have_equal_plies(const laminate_place *first, const laminate_place *second)
{
    return first->present_plies == second->present_plies &&
           memcmp(first->absent, second->absent, sizeof first->absent) == 0;
}

bool stress_are_neighbours(const stress_field *field, int first, int second)
{
    const double least_cosine = 0.766; /* cosine of 40 degrees: two elements whose normals enclose a
                                          larger angle are separated by a fold */
    const mesh *mesh = &field->state.design->mesh;
    const stress_element *a = &field->element[first], *b = &field->element[second];
    const size_t layers = (size_t)field->layers;
    return have_equal_plies(place_of(mesh, first), place_of(mesh, second)) &&
           memcmp(field->voltage + (size_t)first * layers, field->voltage + (size_t)second * layers,
                  layers * sizeof *field->voltage) == 0 &&
           memcmp(field->heat + (size_t)first * layers, field->heat + (size_t)second * layers,
                  layers * sizeof *field->heat) == 0 &&
           vector_dot(a->axis[0], b->axis[0]) > least_cosine &&
           vector_dot(a->axis[2], b->axis[2]) > least_cosine;
}

int stress_neighbours(const stress_field *field, int element, int list[STRESS_NEIGHBOURS])
{
    const mesh *mesh = &field->state.design->mesh;
    int count = 0;
    for (int corner = 0; corner < 4; corner++) {
        const int node = mesh->element[element][corner];
        for (int i = field->node_start[node]; i < field->node_start[node + 1]; i++) {
            const int other = field->node_element[i];
            int is_listed = other == element;
            for (int k = 0; k < count; k++)
                is_listed |= list[k] == other;
            if (!is_listed && count < STRESS_NEIGHBOURS &&
                stress_are_neighbours(field, element, other))
                list[count++] = other;
        }
    }
    return count;
}

/*
 * Fill the lists of the elements at each node of the mesh: field->node_element with the element
 * numbers, and field->node_start with the index at which the list of each node begins.
 */
static void fill_node_elements(stress_field *field)
{
    const mesh *mesh = &field->state.design->mesh;
    for (int k = 0; k < 4 * mesh->elements; k++)
        field->node_start[mesh->element[k / 4][k % 4] + 1]++;
    for (int node = 0; node < mesh->nodes; node++)
        field->node_start[node + 1] += field->node_start[node];
    for (int k = 4 * mesh->elements - 1; k >= 0; k--)
        field->node_element[--field->node_start[mesh->element[k / 4][k % 4] + 1]] = k / 4;
    for (int node = 0; node < mesh->nodes; node++)
        field->node_start[node] = field->node_start[node + 1];
    field->node_start[mesh->nodes] = 4 * mesh->elements;
}

/* ---- all elements ----------------------------------------------------------------- */

static bool allocate(stress_field *field)
{
    const mesh *mesh = &field->state.design->mesh;
    const size_t elements = (size_t)field->elements, layers = (size_t)field->layers;
    field->element = calloc(elements, sizeof *field->element);
    field->voltage = calloc(elements * layers, sizeof *field->voltage);
    field->heat = calloc(elements * layers, sizeof *field->heat);
    field->sample = calloc(elements * layers * STRESS_HEIGHTS, sizeof *field->sample);
    field->node_start = calloc((size_t)mesh->nodes + 2, sizeof *field->node_start);
    field->node_element = calloc(4 * elements, sizeof *field->node_element);
    return field->element && field->voltage && field->heat && field->sample && field->node_start &&
           field->node_element;
}

/*
 * If the displacement was corrected, copy the stresses of the correction to the member `balanced`
 * of all samples.
 */
static void fill_balanced(stress_field *field)
{
    const int samples = field->elements * field->layers * STRESS_HEIGHTS;
    for (int i = 0; i < samples && field->correction.lacking; i++)
        memcpy(field->sample[i].balanced, field->correction.lacking[i],
               sizeof field->sample[i].balanced);
}

int stress_field_fill(stress_field *field, const stress_state *state,
                      const stress_correction *correction)
{
    memset(field, 0, sizeof *field);
    field->state = *state;
    if (correction) {
        field->correction = *correction;
        field->state.displacement = correction->displacement;
    }
    field->has_squeeze = correction != NULL;
    field->elements = state->design->mesh.elements;
    field->layers = state->design->mesh.laminate.plies;
    if (!allocate(field) || fill_patches(field) < 0)
        return -1;
    fill_node_elements(field);
    for (int element = 0; element < field->elements; element++) {
        fill_element(field, element);
        fill_samples(field, element);
    }
    fill_balanced(field);
    return 0;
}

void stress_free(stress_field *field)
{
    free(field->correction.displacement);
    free(field->correction.resultant);
    free(field->correction.lacking);
    free(field->correction.electric);
    free(field->element);
    free(field->voltage);
    free(field->heat);
    free(field->sample);
    free(field->node_start);
    free(field->node_element);
    memset(field, 0, sizeof *field);
}
