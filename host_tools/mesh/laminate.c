/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stiffness, prescribed stress resultants and electric charges of the plies of an element
 * (laminate.h).
 */
#include "laminate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "invert.h"
#include "laminate_shear.h"

enum { N = LAMINATE_STRAINS, M33 = 4, D33 = 5, SHEAR = 8 };

/*
 * Voigt component (order 11 22 33 23 13 12) of each of the ten strains of an element: 11, 22, 33
 * and 12, each as mean and as difference of both faces, then 13 and 23.
 */
static const int voigt[N] = {0, 0, 1, 1, 2, 2, 5, 5, 4, 3};
static const int is_difference[N] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 0};

/* ---- plies ------------------------------------------------------------ */

/*
 * Compute the stiffness matrix of a ply in its own axes from the engineering constants of its
 * material (Voigt order 11 22 33 23 13 12). Returns 0, or -1 if the matrix is not positive
 * definite.
 */
static int ply_stiffness(const scene_material *material, double stiffness[6][6])
{
    memset(stiffness, 0, 36 * sizeof(double));
    for (int i = 0; i < 3; i++)
        stiffness[i][i] = 1 / material->e[i];
    stiffness[0][1] = stiffness[1][0] = -material->nu12 / material->e[0];
    stiffness[0][2] = stiffness[2][0] = -material->nu13 / material->e[0];
    stiffness[1][2] = stiffness[2][1] = -material->nu23 / material->e[1];
    stiffness[3][3] = material->g23;
    stiffness[4][4] = material->g13;
    stiffness[5][5] = material->g12;
    return invert(&stiffness[0][0], 3, 6);
}

/*
 * Compute the matrix that transforms engineering strains in the axes of the shell to those in axes
 * turned by an angle about the normal e3 (Voigt order 11 22 33 23 13 12).
 */
static void turn(double degrees, double transform[6][6])
{
    const double angle = degrees * 0.017453292519943295, cosine = cos(angle), sine = sin(angle);
    const double turned[6][6] = {
        {cosine * cosine, sine * sine, 0, 0, 0, cosine * sine},
        {sine * sine, cosine * cosine, 0, 0, 0, -cosine * sine},
        {0, 0, 1, 0, 0, 0},
        {0, 0, 0, cosine, -sine, 0},
        {0, 0, 0, sine, cosine, 0},
        {-2 * cosine * sine, 2 * cosine * sine, 0, 0, 0, cosine * cosine - sine * sine},
    };
    memcpy(transform, turned, sizeof turned);
}

/*
 * Transform the stress of a ply from its own axes to the axes of the shell: turned = transposed
 * transform times stress (Voigt order 11 22 33 23 13 12).
 */
static void turn_back(double transform[6][6], const double stress[6], double turned[6])
{
    for (int i = 0; i < 6; i++) {
        turned[i] = 0;
        for (int j = 0; j < 6; j++)
            turned[i] += transform[j][i] * stress[j];
    }
}

/*
 * Fill a column of piezoelectric constants of a ply: strain (d) or stress (e) per unit of the
 * electric field along one axis of the ply.
 *   constant [5] in   constants 31, 32, 33, 24 and 15 of the material, whose axis 3 is the poling
 *   poling       in   axis of the ply along the poling, 0, 1 or 2
 *   axis         in   axis of the ply along the field, 0, 1 or 2
 *   column [6]   out  constants in the axes of the ply, Voigt order 11 22 33 23 13 12
 */
static void piezo_column(const double constant[5], int poling, int axis, double column[6])
{
    static const int pair[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}}; /* index, in the Voigt order 11
                                                                        22 33 23 13 12, of the
                                                                        strain that belongs to two
                                                                        axes (0 to 2) */
    /* Axes of the ply that are the material's axes 1 (first) and 2 (second). */
    const int first = poling == 2 ? 0 : 2, second = 3 - poling - first;
    memset(column, 0, 6 * sizeof *column);
    if (axis == poling) {
        column[first] = constant[0];
        column[second] = constant[1];
        column[poling] = constant[2];
    } else if (axis == second) {
        column[pair[second][poling]] = constant[3];
    } else {
        column[pair[first][poling]] = constant[4];
    }
}

/*
 * Compute the stress in the axes of a ply per unit of electric field along one of its axes while
 * its strains are zero: the piezoelectric constants e, or the stiffness times the constants d.
 *   poling, axis in  axes of the poling and of the field, 0, 1 or 2
 */
static void field_stress(const scene_material *material, double stiffness[6][6], int poling,
                         int axis, double stress[6])
{
    const double strain_constant[5] = {material->d31, material->d32, material->d33, material->d24,
                                       material->d15};
    double strain[6];
    memset(stress, 0, 6 * sizeof *stress);
    if (material->has_e)
        piezo_column(material->piezo_e, poling, axis, stress);
    piezo_column(strain_constant, poling, axis, strain);
    for (int i = 0; i < 6 && material->has_d; i++)
        for (int j = 0; j < 6; j++)
            stress[i] += stiffness[i][j] * strain[j];
}

/*
 * Compute the electric constants of a ply: prescribed stress per volt, capacitance per area, and
 * pyroelectric charge per kelvin. Charges are those of the upper electrode; for interdigitated
 * electrodes, of the one towards which the poling points.
 *   stress [6] out  prescribed stress per volt in the axes of the ply (Pa/V), Voigt order 11 22 33
 *       23 13 12
 */
static void build_electric(const scene_material *material, const scene_layer *layer,
                           double stiffness[6][6], double stress[6], laminate_ply *ply)
{
    const int poling = abs(layer->poling) - 1;
    const bool has_fingers = layer->finger_distance > 0;
    /*
     * Interdigitated electrodes cause a field along the poling, other electrodes along axis 3, the
     * normal of the shell.
     */
    const int axis = has_fingers ? poling : 2;
    const double distance = has_fingers ? layer->finger_distance : layer->thickness;
    const double share = layer->thickness / distance; /* area of the electrodes per surface area: 1
                                                         on the faces of the ply; thickness over
                                                         distance for interdigitated electrodes,
                                                         modelled as planes across the ply */
    field_stress(material, stiffness, poling, axis, stress);
    /*
     * The field of 1 V between electrodes is -1 V/distance, and the prescribed stress is minus the
     * stress per unit field times this field.
     */
    for (int i = 0; i < 6; i++)
        stress[i] *= (layer->poling < 0 ? -1 : 1) / distance;
    ply->capacitance =
        (axis == poling ? material->permittivity : material->permittivity_across) / distance;
    ply->capacitance *= share;
    ply->pyroelectric_charge = layer->poling < 0 ? material->pyroelectric : -material->pyroelectric;
    ply->pyroelectric_charge *= axis == poling ? share : 0;
    ply->electrode_distance = distance;
    ply->is_field_along_surface = has_fingers;
}

/*
 * Compute the prescribed stress, the permittivity and the pyroelectric constants of a ply for
 * electric fields along the surface, in the axes of the shell. A field in these axes is first
 * turned into the axes of the ply by the angle of the layer.
 */
static void build_along(const scene_material *material, const scene_layer *layer,
                        double stiffness[6][6], double transform[6][6], laminate_ply *ply)
{
    const int poling = abs(layer->poling) - 1;
    const double sign = layer->poling < 0 ? -1 : 1;
    const double cosine = transform[3][3], sine = transform[4][3];
    const double share[2][2] = {{cosine, sine}, {-sine, cosine}};
    memset(ply->stress_along, 0, sizeof ply->stress_along);
    memset(ply->permittivity_along, 0, sizeof ply->permittivity_along);
    for (int axis = 0; axis < 2; axis++) {
        double stress[6], turned[6];
        const double permittivity =
            axis == poling ? material->permittivity : material->permittivity_across;
        field_stress(material, stiffness, poling, axis, stress);
        turn_back(transform, stress, turned);
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 6; k++)
                ply->stress_along[i][k] -= sign * share[axis][i] * turned[k];
            for (int j = 0; j < 2; j++)
                ply->permittivity_along[i][j] += share[axis][i] * permittivity * share[axis][j];
        }
    }
    for (int i = 0; i < 2; i++)
        ply->pyroelectric_along[i] =
            poling < 2 ? sign * material->pyroelectric * share[poling][i] : 0;
}

static int build_ply(const scene_material *material, const scene_layer *layer, laminate_ply *ply)
{
    double stiffness[6][6], transform[6][6], half[6][6], stress[6];
    if (ply_stiffness(material, stiffness) < 0)
        return -1;
    turn(layer->angle, transform);
    for (int i = 0; i < 6; i++)
        turn_back(transform, stiffness[i], half[i]); /* product of the ply's stiffness matrix and
                                                        the matrix that transforms strains from the
                                                        axes of the shell to those of the ply */
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            ply->c[i][j] = 0;
            for (int k = 0; k < 6; k++)
                ply->c[i][j] += transform[k][i] * half[k][j];
        }
    build_along(material, layer, stiffness, transform, ply);
    build_electric(material, layer, stiffness, stress, ply);
    turn_back(transform, stress, ply->stress_per_voltage);
    for (int i = 0; i < 6; i++) {
        stress[i] = 0;
        for (int j = 0; j < 3; j++)
            stress[i] -= stiffness[i][j] * material->alpha[j];
    }
    turn_back(transform, stress, ply->stress_per_kelvin);
    ply->density = material->density;
    return 0;
}

int laminate_build(const scene *scene, laminate *laminate, char *error)
{
    memset(laminate, 0, sizeof *laminate);
    if (scene->layers > LAMINATE_LAYERS)
        return scene_fault(scene->at_layers, error, "%d layers; at most %d are possible",
                           scene->layers, LAMINATE_LAYERS);
    for (int i = 0; i < scene->layers; i++)
        laminate->thickness += scene->layer[i].thickness;
    laminate->z[0] = scene->reference_is_middle ? -laminate->thickness / 2 : -scene->reference;
    laminate->z[1] = laminate->z[0] + laminate->thickness;
    laminate->plies = scene->layers;
    double z = laminate->z[0];
    for (int i = 0; i < scene->layers; i++) {
        laminate_ply *ply = &laminate->ply[i];
        const scene_material *material = &scene->material[scene->layer[i].material];
        ply->z[0] = z;
        ply->z[1] = z += scene->layer[i].thickness;
        if (build_ply(material, &scene->layer[i], ply) < 0)
            return scene_fault(
                material->at, error,
                "material '%s' has no positive definite stiffness; lower its Poisson's ratios",
                material->name);
    }
    return 0;
}

/* ---- integrals over the thickness ------------------------------------- */

double laminate_cover(const laminate_place *place, int ply)
{
    return place->present_plies >> ply & 1u ? 1 - place->absent[ply] : 0;
}

enum { POINTS = 6 };
static const double gauss_x[POINTS] = {-0.9324695142031521, -0.6612093864662645,
                                       -0.2386191860831969, 0.2386191860831969,
                                       0.6612093864662645,  0.9324695142031521};
static const double gauss_w[POINTS] = {0.1713244923791704, 0.3607615730481386, 0.4679139345726910,
                                       0.4679139345726910, 0.3607615730481386, 0.1713244923791704};

/*
 * Compute the factors by which the strains of an element along lines of curvature are divided at
 * height z. Lengths there along direction a are c_a = 1 + (curvature along a) z times those in the
 * reference surface. The factor of strain ab is c_a c_b, with c_3 = 1.
 *   share [6] out  the factors, order 11 22 33 23 13 12; 1 with the element option `metric` off and
 *                  on other elements
 * Returns the area of the element at height z over that in the reference surface.
 */
static double metric_at(const scene_element *element, const laminate_place *place, double z,
                        double share[6])
{
    const double height = element->metric ? z : 0;
    const double c1 = 1 + place->curvature[0] * height, c2 = 1 + place->curvature[1] * height;
    const double all[6] = {c1 * c1, c2 * c2, 1, c2, c1, c1 * c2};
    for (int i = 0; i < 6; i++)
        share[i] = place->is_general ? 1 : all[i];
    return place->is_general ? natural_area_ratio(&place->natural, height) : c1 * c2;
}

double laminate_area_ratio(const scene_element *element, const laminate_place *place, double z)
{
    double share[6];
    return metric_at(element, place, z, share);
}

void laminate_strain_map(const scene_element *element, const laminate_place *place, double z,
                         double map[6][6])
{
    double share[6];
    if (place->is_general) {
        natural_strain_map(&place->natural, element->metric ? z : 0, map);
        return;
    }
    metric_at(element, place, z, share);
    memset(map, 0, 36 * sizeof(double));
    for (int i = 0; i < 6; i++)
        map[i][i] = 1 / share[i];
}

/*
 * Compute the stiffness of a ply at height z for strains along the directions of the element, which
 * need not be perpendicular (Voigt order 11 22 33 23 13 12). For an element along lines of
 * curvature the result is the stiffness in the axes of the shell. It then takes no account of the
 * curvature: the caller adds the factors 1 + k z (metric_at).
 */
static void natural_stiffness(const scene_element *element, const laminate_place *place,
                              const laminate_ply *ply, double z, double stiffness[6][6])
{
    double transform[6][6], half[6][6];
    memcpy(stiffness, ply->c, 36 * sizeof(double));
    if (!place->is_general)
        return;
    natural_strain_map(&place->natural, element->metric ? z : 0, transform);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            half[i][j] = 0;
            for (int k = 0; k < 6; k++)
                half[i][j] += ply->c[i][k] * transform[k][j];
        }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            stiffness[i][j] = 0;
            for (int k = 0; k < 6; k++)
                stiffness[i][j] += transform[k][i] * half[k][j];
        }
}

/*
 * Compute the stress of a ply at height z in the directions of the element from the stress in the
 * axes of the shell (Voigt order 11 22 33 23 13 12).
 */
static void natural_stress(const scene_element *element, const laminate_place *place, double z,
                           const double stress[6], double natural[6])
{
    double transform[6][6];
    memcpy(natural, stress, 6 * sizeof *natural);
    if (!place->is_general)
        return;
    natural_strain_map(&place->natural, element->metric ? z : 0, transform);
    turn_back(transform, stress, natural);
}

/* ---- strains over the height ------------------------------------------------ */

/*
 * Compute the stiffness of a ply against each in-plane strain, in the directions of the element,
 * while its normal stress 33 is 0 (Pa).
 */
static void plane_stiffness(const scene_element *element, const laminate_place *place,
                            const laminate_ply *ply, double z, double stiffness[HEIGHT_ROWS])
{
    static const int in_plane[HEIGHT_ROWS] = {0, 1, 5};
    double c[6][6];
    natural_stiffness(element, place, ply, z, c);
    for (int row = 0; row < HEIGHT_ROWS; row++) {
        const int i = in_plane[row];
        stiffness[row] = c[i][i] - c[i][2] * c[2][i] / c[2][2];
    }
}

/*
 * Compute the change of the base vectors of an element with the height in terms of the base vectors
 * in the middle of all plies: base vector a changes by the sum over c of change[c][a] times base
 * vector c, per height (1/m).
 */
static void base_change(const laminate_place *place, double middle, double change[2][2])
{
    double dual[3][3];
    memset(change, 0, 4 * sizeof(double));
    for (int a = 0; a < 2 && !place->is_general; a++)
        change[a][a] = place->curvature[a] / (1 + place->curvature[a] * middle);
    if (!place->is_general)
        return;
    natural_dual_base(&place->natural, middle, dual);
    for (int entry = 0; entry < 4; entry++)
        for (int i = 0; i < 3; i++)
            change[entry / 2][entry % 2] += dual[entry / 2][i] * place->natural.slope[i][entry % 2];
}

/*
 * Set the straight lines that replace the squared height in the strains of an element to those that
 * come closest to it over the plies, weighted by their stiffness.
 */
static void fit_heights(const laminate *laminate, const scene_element *element,
                        const laminate_place *place, laminate_heights *heights)
{
    height_ply ply[LAMINATE_LAYERS];
    int plies = 0;
    for (int layer = 0; layer < laminate->plies; layer++)
        if (place->present_plies >> layer & 1u) {
            memcpy(ply[plies].z, laminate->ply[layer].z, sizeof ply[plies].z);
            plane_stiffness(element, place, &laminate->ply[layer], heights->middle,
                            ply[plies].stiffness);
            for (int row = 0; row < HEIGHT_ROWS; row++)
                ply[plies].stiffness[row] *= laminate_cover(place, layer);
            plies++;
        }
    height_fit_lines(ply, plies, heights);
}

void laminate_heights_of(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, laminate_heights *heights)
{
    const double square = laminate->thickness * laminate->thickness;
    double change[2][2];
    memset(heights, 0, sizeof *heights);
    heights->middle = (laminate->z[0] + laminate->z[1]) / 2;
    heights->thickness = laminate->thickness;
    for (int row = 0; row < HEIGHT_ROWS && element->quadratic != SQUARES_OMITTED; row++)
        heights->line[0][row] = square / 4;
    if (element->quadratic == SQUARES_FITTED)
        fit_heights(laminate, element, place, heights);
    if (!element->metric || element->quadratic == SQUARES_OF_FACES)
        return;
    base_change(place, heights->middle, change);
    height_quadratic_part(change, heights);
}

/* ---- thickness strain ------------------------------------------------- */

static int inverse_of(double matrix[N][N], double inverse[N][N])
{
    memcpy(inverse, matrix, N * N * sizeof(double));
    return invert(&inverse[0][0], N, N);
}

/*
 * Uncouple the difference of the thickness strain 33 between both faces from the other strains of
 * an element, for the element option lin33, with which every ply thickens freely. Returns 0, or -1
 * if the matrix is singular.
 */
static int relax_e33(double stiffness[N][N])
{
    double inverse[N][N];
    if (inverse_of(stiffness, inverse) < 0)
        return -1;
    for (int i = 0; i < N; i++)
        stiffness[i][D33] = stiffness[D33][i] = 0;
    /*
     * stiffness against the difference of strain 33 between both faces, while the stress resultants
     * of all other strains are 0
     */
    stiffness[D33][D33] = 1 / inverse[D33][D33];
    return 0;
}

/*
 * Stiffnesses and compliances of the plies of an element, integrated over the thickness. From them
 * follow the stiffness of the element with its thickness kept, and that with the normal stress 33
 * at 0, so that the thickness changes freely. A ply that covers only a part of the element counts
 * by this part of the area (smeared_plies.h).
 */
typedef struct ply_integrals {
    double stiffness[N][N]; /* stiffness for the ten strains of an element (mean and difference of
                               both faces for the strains 11, 22, 33 and 12; then the strains 13 and
                               23), integrated over the thickness (N/m) */
    double plane[N][N]; /* stiffness for the ten strains of an element (order of `voigt`) with the
                           normal stress 33 at 0 at all heights, integrated over the thickness (N/m)
                         */
    double compliance;  /* integral over the thickness of 1/(stiffness of the strain 33): compliance
                           of the plies against the normal stress 33 (m/Pa) */
    double length;      /* thickness of all plies of the element together (m) */
    double narrowing[N]; /* integrals of c_i3/c_33 over the thickness for the ten strains i of an
                            element (m), in the order of the array `voigt`: stiffness c_i3, which
                            couples strain i with the thickness strain 33, over that of the strain
                            33 alone */
} ply_integrals;

/*
 * Strains in Voigt order (11 22 33 23 13 12) at one height per unit of one of the ten strains of an
 * element: number of strains that are not 0, their indices and their values.
 */
typedef struct strain_share {
    int count, voigt[HEIGHT_ROWS];
    double value[HEIGHT_ROWS];
} strain_share;

/*
 * Correct strains at height z for a simplification of the element, which replaces the term m z^2 of
 * an in-plane strain by m times a straight line in z (laminate_height.h): add m (z^2 - line).
 *   of_strain [3][3] in      coefficients m of the strains 11, 22 and 12 (rows) per unit of the
 *                            element's strains 11, 22 and 12 (columns; 1/m2)
 *   column           in      0, 1 or 2: unit strain 11, 22 or 12 of the element
 *   excess    [3]    in      z^2 - line for the strains 11, 22 and 12 (m2)
 *   share            in/out  strains at this height per unit of the element's strain `column`
 */
static void add_quadratic(const double of_strain[HEIGHT_ROWS][HEIGHT_ROWS], int column,
                          const double excess[HEIGHT_ROWS], strain_share *share)
{
    static const int in_plane[HEIGHT_ROWS] = {0, 1, 5};
    for (int row = 0; row < HEIGHT_ROWS; row++) {
        const double part = excess[row] * of_strain[row][column];
        if (row == column) {
            share->value[0] += part;
        } else if (part != 0) {
            share->voigt[share->count] = in_plane[row];
            share->value[share->count++] = part;
        }
    }
}

/*
 * Compute the strains at height z above the reference surface per unit of each of the ten strains
 * of an element: 1 for a mean of both faces, height over thickness for their difference, and the
 * part that is quadratic in the height.
 */
static void strain_shares(const laminate *laminate, const laminate_heights *heights, double z,
                          strain_share share[N])
{
    static const int column[N] = {0, 0, 1, 1, -1, -1, 2, 2, -1, -1};
    const double height = z - heights->middle,
                 excess[HEIGHT_ROWS] = {laminate_height_excess(heights, height, 0),
                                        laminate_height_excess(heights, height, 1),
                                        laminate_height_excess(heights, height, 2)};
    for (int i = 0; i < N; i++) {
        share[i].count = 1;
        share[i].voigt[0] = voigt[i];
        share[i].value[0] = is_difference[i] ? height / laminate->thickness : 1;
        if (column[i] >= 0 && is_difference[i])
            add_quadratic(heights->of_difference, column[i], excess, &share[i]);
        else if (column[i] >= 0)
            add_quadratic(heights->of_mean, column[i], excess, &share[i]);
    }
}

/*
 * Add one quadrature point of a ply to one entry of two stiffness matrices of an element.
 *   natural [6][6] in      stiffness of the ply at the point (Pa), Voigt order 11 22 33 23 13 12
 *   metric  [6]    in      factors by which strains are divided at this height (metric_at)
 *   weight         in      weight of the point (m)
 *   first, second  in      strains at the point per unit of the row's and of the column's strain
 *   stiffness      in/out  entry of the stiffness integrated over the thickness (N/m)
 *   plane          in/out  the same entry with the normal stress 33 at 0 (N/m)
 */
static void add_pair(double natural[6][6], const double metric[6], double weight,
                     const strain_share *first, const strain_share *second, double *stiffness,
                     double *plane)
{
    for (int k = 0; k < first->count; k++)
        for (int l = 0; l < second->count; l++) {
            const int i = first->voigt[k], j = second->voigt[l];
            const double both = weight * first->value[k] * second->value[l];
            const double scale = metric[i] * metric[j];
            const double through = natural[i][2] * natural[2][j] / natural[2][2];
            *stiffness += both * natural[i][j] / scale;
            *plane += both * (natural[i][j] - through) / scale;
        }
}

/*
 * Add one quadrature point of a ply to the integrals over the thickness.
 *   sums           in/out  the integrals
 *   natural [6][6] in      stiffness of the ply at the point (Pa), Voigt order 11 22 33 23 13 12
 *   metric  [6]    in      factors by which strains are divided at this height (metric_at)
 *   weight         in      weight of the point (m)
 *   share   [10]   in      strains at the point per unit of each strain of the element
 */
static void add_point(ply_integrals *sums, double natural[6][6], const double metric[6],
                      double weight, const strain_share share[N])
{
    sums->compliance += weight / natural[2][2];
    sums->length += weight;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < share[i].count; k++)
            sums->narrowing[i] += weight * share[i].value[k] / metric[share[i].voigt[k]] *
                                  natural[share[i].voigt[k]][2] / natural[2][2];
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            add_pair(natural, metric, weight, &share[i], &share[j], &sums->stiffness[i][j],
                     &sums->plane[i][j]);
}

static void integrate_plies(const laminate *laminate, const scene_element *element,
                            const laminate_place *place, ply_integrals *sums)
{
    laminate_heights heights;
    laminate_heights_of(laminate, element, place, &heights);
    memset(sums, 0, sizeof *sums);
    for (int layer = 0; layer < laminate->plies; layer++) {
        const laminate_ply *ply = &laminate->ply[layer];
        const double half = (ply->z[1] - ply->z[0]) / 2;
        for (int point = 0; point < POINTS && place->present_plies >> layer & 1u; point++) {
            const double z = (ply->z[0] + ply->z[1]) / 2 + half * gauss_x[point];
            double metric[6], natural[6][6];
            strain_share share[N];
            const double weight = half * gauss_w[point] * metric_at(element, place, z, metric) *
                                  laminate_cover(place, layer);
            natural_stiffness(element, place, ply, z, natural);
            strain_shares(laminate, &heights, z, share);
            add_point(sums, natural, metric, weight, share);
        }
    }
}

/*
 * Compute the stiffness of an element whose plies may thicken freely under one normal stress 33,
 * equal in all plies:
 *   stiffness_ij = plane_ij + n_i n_j/f.
 *   n_i  integral of c_i3/c_33 over the thickness (`narrowing`). For i = mean strain 33: the
 *       thickness
 *   f    integral of 1/c_33 (`compliance`)
 * A strain 33 that is linear through all plies would instead falsify bending by some per cent where
 * the Poisson's ratios of the plies differ. Entries for the difference of the strain 33 between
 * both faces do not change.
 */
static void free_thickness(const ply_integrals *sums, double stiffness[N][N])
{
    double narrowing[N];
    memcpy(narrowing, sums->narrowing, sizeof narrowing);
    narrowing[M33] = sums->length;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            if (i != D33 && j != D33)
                stiffness[i][j] = (i == M33 || j == M33 ? 0 : sums->plane[i][j]) +
                                  narrowing[i] * narrowing[j] / sums->compliance;
}

/*
 * Compute the transverse shear stiffness of the plies of an element (N/m) from the equilibrium of
 * stresses, in its material axes. A ply counts by the fraction of the area that it covers. Returns
 * 0, or -1 if the plies have no shear stiffness.
 */
static int shear_of_plies(const laminate *laminate, const laminate_place *place, double k[2][2])
{
    shear_ply ply[LAMINATE_LAYERS];
    double smeared[LAMINATE_LAYERS][6][6];
    int plies = 0;
    for (int layer = 0; layer < laminate->plies; layer++)
        if (place->present_plies >> layer & 1u) {
            memcpy(ply[plies].z, laminate->ply[layer].z, sizeof ply[plies].z);
            for (int i = 0; i < 36; i++)
                smeared[plies][i / 6][i % 6] =
                    laminate_cover(place, layer) * laminate->ply[layer].c[i / 6][i % 6];
            ply[plies].c = (const double(*)[6])smeared[plies];
            plies++;
        }
    return laminate_shear(ply, plies, k);
}

/*
 * Replace the transverse shear stiffness of an element by the value that follows from the
 * equilibrium of stresses (element option shear), turned from material axes to the directions of
 * the element. Returns 0, or -1 if the plies have no shear stiffness.
 */
static int set_shear(const laminate *laminate, const laminate_place *place, double stiffness[N][N])
{
    const double(*j)[3] = (const double(*)[3])place->natural.base;
    double k[2][2], turn[2][2] = {{1, 0}, {0, 1}};
    if (shear_of_plies(laminate, place, k) < 0)
        return -1;
    if (place->is_general) {
        const double size = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        const double inverse[2][2] = {{j[1][1] / size, -j[1][0] / size},
                                      {-j[0][1] / size, j[0][0] / size}};
        memcpy(turn, inverse, sizeof turn);
    }
    for (int i = 0; i < 4; i++) {
        double sum = 0;
        for (int entry = 0; entry < 4; entry++)
            sum += turn[entry / 2][i / 2] * k[entry / 2][entry % 2] * turn[entry % 2][i % 2];
        stiffness[SHEAR + i / 2][SHEAR + i % 2] = sum;
    }
    return 0;
}

/*
 * Compute the stiffness of all plies together per area (N/m) for the ten strains of an element, in
 * the order of the array `voigt`. With the element option lin33 every ply thickens freely. Returns
 * 0, or -1 if no ply is present.
 */
static int package_stiffness(const laminate *laminate, const scene_element *element,
                             const laminate_place *place, double stiffness[N][N])
{
    ply_integrals sums;
    integrate_plies(laminate, element, place, &sums);
    memcpy(stiffness, sums.stiffness, sizeof sums.stiffness);
    if (element->lin33 && relax_e33(stiffness) < 0)
        return -1;
    if (element->lin33)
        free_thickness(&sums, stiffness);
    return element->equilibrium_shear ? set_shear(laminate, place, stiffness) : 0;
}

double laminate_field_at(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field, double z)
{
    double share[6], mean = 0;
    if (field->ply < 0)
        return field->temperature[0] + (field->temperature[1] - field->temperature[0]) *
                                           (z - laminate->z[0]) / laminate->thickness;
    const double *face = laminate->ply[field->ply].z;
    if (field->axis == LAMINATE_HEATED_PLY)
        return 1;
    if (field->axis > 0)
        return field->along[0] +
               (field->along[1] - field->along[0]) * (z - face[0]) / (face[1] - face[0]);
    if (laminate->ply[field->ply].is_field_along_surface)
        return 1;
    for (int point = 0; point < POINTS; point++)
        mean += gauss_w[point] / 2 /
                metric_at(element, place,
                          (face[0] + face[1] + (face[1] - face[0]) * gauss_x[point]) / 2, share);
    return 1 / (metric_at(element, place, z, share) * mean);
}

/*
 * Return whether a prescribed field (voltage, electric field along the surface or temperature) is a
 * temperature, of one ply or of all plies.
 */
static bool is_temperature(const laminate_field *field)
{
    return field->ply < 0 || field->axis == LAMINATE_HEATED_PLY;
}

/*
 * Return the stress in a ply, with zero strains, that a unit of an electric field causes, in the
 * axes of the shell (six numbers). The electric field is a voltage across the ply (Pa/V), or a
 * field along the surface (C/m2).
 */
static const double *electric_stress_of(const laminate_ply *ply, const laminate_field *field)
{
    return field->axis > 0 ? ply->stress_along[field->axis - 1] : ply->stress_per_voltage;
}

/*
 * Return the stress in a ply, with zero strains, that a unit of a field causes, in the axes of the
 * shell (six numbers). The field is a voltage across the ply (Pa/V), an electric field along the
 * surface (C/m2) or a temperature (Pa/K).
 */
static const double *field_stress_of(const laminate_ply *ply, const laminate_field *field)
{
    return is_temperature(field) ? ply->stress_per_kelvin : electric_stress_of(ply, field);
}

static int field_acts(const laminate_place *place, const laminate_field *field, int layer)
{
    return (field->ply < 0 || field->ply == layer) && place->present_plies >> layer & 1u;
}

/*
 * Return the fraction of the area of an element in which a field acts in a layer. For a temperature
 * of all plies it is the part that the layer covers. For a field in a single ply the result is 1:
 * there the caller multiplies the effect by the part that the electrode or heater covers.
 */
static double acting_share(const laminate_place *place, const laminate_field *field, int layer)
{
    return field->ply < 0 ? laminate_cover(place, layer) : 1;
}

/*
 * Add the part of one ply to the prescribed resultants of an element under a voltage, an electric
 * field or a temperature.
 *   stress [6]  in      prescribed stress of the ply per unit of the field, Voigt order 11 22 33 23
 *       13 12
 *   h0     [10] in/out  resultants per area (N/m), order of `voigt`
 */
static void integrate_stress(const laminate *laminate, const scene_element *element,
                             const laminate_place *place, const laminate_ply *ply,
                             const laminate_field *field, const double stress[6], double h0[N])
{
    const double half = (ply->z[1] - ply->z[0]) / 2;
    laminate_heights heights;
    laminate_heights_of(laminate, element, place, &heights);
    for (int point = 0; point < POINTS; point++) {
        const double z = (ply->z[0] + ply->z[1]) / 2 + half * gauss_x[point];
        double metric[6], natural[6];
        strain_share share[N];
        const double weight = half * gauss_w[point] * metric_at(element, place, z, metric) *
                              laminate_field_at(laminate, element, place, field, z);
        natural_stress(element, place, z, stress, natural);
        strain_shares(laminate, &heights, z, share);
        for (int i = 0; i < N; i++)
            for (int k = 0; k < share[i].count; k++)
                h0[i] += weight * share[i].value[k] * natural[share[i].voigt[k]] /
                         metric[share[i].voigt[k]];
    }
}

/* ---- formulation ------------------------------------------------------ */

/*
 * Return the bending flexibility of an element (1/(N m)): the smaller curvature 11 or 22 per unit
 * of its bending moment, with transverse shear strains 0. One isotropic ply of modulus E and
 * thickness h has 12/(E h^3).
 *   inverse [10][10] in  compliance matrix of the element (m/N), from plane_compliance
 */
static double bending_flexibility(double inverse[N][N], double thickness)
{
    const double f1 = inverse[1][1], f2 = inverse[3][3];
    return (f1 < f2 ? f1 : f2) / (thickness * thickness);
}

/*
 * Return whether a strain mode of the element (0: constant, 1 and 2: linear, 3: bilinear over the
 * element) contains a strain. Modes 1 to 3 leave out the strains that would make the element too
 * stiff (locking).
 */
static int kept(int mode, int strain)
{
    /*
     * for each of the ten strains, the strain modes that contain it besides mode 0 (constant
     * strains). 1 or 2: this linear mode; 3: both linear modes and the bilinear one; 0: none
     */
    static const int along[N] = {1, 1, 2, 2, 3, 3, 0, 0, 1, 2};
    return mode == 0 || along[strain] == 3 || (mode < 3 && along[strain] == mode);
}

/*
 * Compute the stiffness matrix of a strain mode (constant, linear or bilinear over the element), 0
 * for strains that the mode does not contain. With the option hr (Hellinger-Reissner), linear and
 * bilinear modes get the inverse of a block of the compliance. Returns 0, or -1 if that block is
 * singular.
 */
static int mode_matrix(double stiffness[N][N], double inverse[N][N], int mode, int hr,
                       double out[N][N])
{
    int index[N], count = 0;
    double block[N][N];
    for (int i = 0; i < N; i++)
        if (kept(mode, i))
            index[count++] = i;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            block[i][j] = (hr && mode ? inverse : stiffness)[index[i]][index[j]];
    if (hr && mode && invert(&block[0][0], count, N) < 0)
        return -1;
    memset(out, 0, N * N * sizeof(double));
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            out[index[i]][index[j]] = block[i][j];
    return 0;
}

/*
 * Return the factor (0 to 1) that reduces, in a linear strain mode, the flexibility which the
 * element option `rho` adds to a transverse shear strain:
 *   1/(1 + 0.6 (f/ft) (L_a/L_b)^2)
 *   f, ft     flexibilities of bending and of twist
 *   L_a, L_b  lengths of the element along and across the direction of the shear
 *   inverse [10][10] in  compliance matrix of the element (m/N), from plane_compliance
 *   direction        in  direction of the transverse shear: 0 for 13, 1 for 23
 * Reason: the flexibility stands for a normal displacement inside the element that bends it. In a
 * linear mode this displacement has opposite signs in the two halves of the element, so that it
 * twists the element, too. The factor of a square with Poisson's ratio 0.3 is 0.813 (exact: 0.784).
 */
static double bubble_share(double inverse[N][N], double thickness, const laminate_place *place,
                           int direction)
{
    const double twist_flexibility = inverse[7][7] / (thickness * thickness);
    const double ratio = place->chord[direction] / place->chord[1 - direction];
    return 1 /
           (1 + 0.6 * bending_flexibility(inverse, thickness) / twist_flexibility * ratio * ratio);
}

/*
 * Compute the flexibility that an element gains against the transverse shears 13 and 23 in one
 * strain mode, so that coarse meshes are not too stiff:
 *   rho p b L^2/12 times the bending flexibility.
 *   rho  element option of this name
 *   p    factor for irregular meshes (laminate_place.bubble_share)
 *   b    result of the function bubble_share for the shear 13 in mode 1 and for the shear 23 in
 *       mode 2, else 1
 *   L    length of the element along direction 1 (shear 13) or 2 (shear 23)
 *   inverse [10][10] in   compliance matrix of the element (m/N), from plane_compliance
 *   mode             in   0: constant, 1: linear in xi2, 2: linear in xi1, 3: bilinear
 *   flexibility  [2] out  added flexibility of the shears 13 and 23 (m/N)
 */
static void shear_flexibility(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, double inverse[N][N], int mode,
                              double flexibility[2])
{
    const double rho = element->rho * place->bubble_share;
    const double bending = rho * bending_flexibility(inverse, laminate->thickness) / 12;
    for (int direction = 0; direction < 2; direction++)
        flexibility[direction] = bending * place->chord[direction] * place->chord[direction];
    for (int direction = 0; direction < 2 && element->rho > 0; direction++)
        if (mode == 1 + direction)
            flexibility[direction] *= bubble_share(inverse, laminate->thickness, place, direction);
}

/*
 * List the strains whose stiffness block soften_shear inverts: the transverse shears of a strain
 * mode (constant, linear or bilinear over the element), or all its strains where a stiffness entry
 * couples a shear with another strain.
 *   modal [10][10] in   stiffness matrix of the strain mode
 *   index [10]     out  indices of these strains among the ten strains of an element
 * Returns their number.
 */
static int shear_block(double modal[N][N], int mode, int index[N])
{
    int count = 0, is_coupled = 0;
    for (int i = 0; i < SHEAR; i++)
        is_coupled |= modal[i][SHEAR] != 0 || modal[i][SHEAR + 1] != 0;
    for (int i = is_coupled ? 0 : SHEAR; i < N; i++)
        if (kept(mode, i))
            index[count++] = i;
    return count;
}

/*
 * Make the two transverse shears softer in the stiffness matrix of one strain mode (constant,
 * linear or bilinear over the element).
 *   flexibility [2] in  compliance that is added to each of the two transverse shears
 * Returns 0, or -1 if the stiffness matrix is singular.
 */
static int soften_shear(double modal[N][N], int mode, const double flexibility[2])
{
    double compliance[N][N];
    int index[N];
    const int count = shear_block(modal, mode, index);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            compliance[i][j] = modal[index[i]][index[j]];
    if (!kept(mode, SHEAR) && !kept(mode, SHEAR + 1))
        return 0;
    if (invert(&compliance[0][0], count, N) < 0)
        return -1;
    for (int i = 0; i < count; i++)
        if (index[i] >= SHEAR)
            compliance[i][i] += flexibility[index[i] - SHEAR];
    if (invert(&compliance[0][0], count, N) < 0)
        return -1;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            modal[index[i]][index[j]] = compliance[i][j];
    return 0;
}

/*
 * Compute the compliance matrix of an element (m/N): column k holds all strains while resultant k
 * is 1 and all other resultants are 0, those of the thickness strain 33 included. Coupling of the
 * transverse shears with the other eight strains is left out. Returns 0, or -1 if the stiffness
 * matrix is singular.
 */
static int plane_compliance(double stiffness[N][N], double compliance[N][N])
{
    double uncoupled[N][N];
    memcpy(uncoupled, stiffness, sizeof uncoupled);
    for (int i = 0; i < SHEAR; i++)
        for (int j = SHEAR; j < N; j++)
            uncoupled[i][j] = uncoupled[j][i] = 0;
    return inverse_of(uncoupled, compliance);
}

int laminate_modes(const laminate *laminate, const scene_element *element,
                   const laminate_place *place, double packed[4][LAMINATE_PACKED])
{
    const double *skew = place->skew;
    const double mode_weight[4] = {1, 1 / (3 - skew[0] * skew[0]), 1 / (3 - skew[1] * skew[1]),
                                   1 / 9.0};
    double stiffness[N][N], inverse[N][N], plane[N][N], modal[N][N], flexibility[2];
    if (package_stiffness(laminate, element, place, stiffness) < 0)
        return -1;
    if (inverse_of(stiffness, inverse) < 0 || plane_compliance(stiffness, plane) < 0)
        return -1;
    for (int mode = 0; mode < 4; mode++) {
        shear_flexibility(laminate, element, place, plane, mode, flexibility);
        if (mode_matrix(stiffness, inverse, mode, element->hr, modal) < 0 ||
            soften_shear(modal, mode, flexibility) < 0)
            return -1;
        double *entry = packed[mode];
        for (int i = 0; i < N; i++)
            for (int j = 0; j <= i; j++)
                *entry++ = modal[i][j] * place->area * mode_weight[mode];
    }
    return 0;
}

/* ---- prescribed fields -------------------------------------------------- */

/*
 * Compute the stiffness for strains that are constant over the element (N/m). Its transverse shear
 * stiffness follows two options of the scene: `shear: equilibrium` computes it from the shear
 * stresses that equilibrium asks for, and `rho` adds a part of the bending flexibility to its
 * inverse (shear_flexibility). Returns 0, or -1 if no ply is present.
 */
static int constant_stiffness(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, double stiffness[N][N])
{
    double plane[N][N], flexibility[2];
    if (package_stiffness(laminate, element, place, stiffness) < 0 ||
        plane_compliance(stiffness, plane) < 0)
        return -1;
    shear_flexibility(laminate, element, place, plane, 0, flexibility);
    return soften_shear(stiffness, 0, flexibility);
}

/*
 * Stress resultants of an element whose strains are zero while a voltage or temperature acts
 * (prescribed resultants), and the strains of the element if it is free instead.
 */
typedef struct free_field {
    double resultants[N], strain[N]; /* resultants: stress resultants of the element (N/m) under a
                                        voltage or temperature while the strains are kept at 0.
                                        strain: minus the strains of the unloaded element under the
                                        same voltage or temperature; 0 (not needed) where it causes
                                        no transverse shear stress. Order of both: `voigt` */
    double uniform[N][N];  /* stiffness of all plies for the strains of the element (N/m), with
                              transverse shear strains that are uniform through the thickness */
    double constant[N][N]; /* stiffness of the element for strains that are constant over it (N/m).
                              Its transverse shear stiffness includes the effect of the element
                              options `shear` (stiffness from equilibrium) and `rho` (flexibility
                              added on coarse meshes) */
} free_field;

/*
 * Return whether a field (voltage or temperature) causes a transverse shear stress in a ply of an
 * element.
 */
static bool causes_shear(const laminate *laminate, const laminate_place *place,
                         const laminate_field *field)
{
    for (int layer = 0; layer < laminate->plies; layer++) {
        const double *stress = field_stress_of(&laminate->ply[layer], field);
        if (field_acts(place, field, layer) && (stress[3] != 0 || stress[4] != 0))
            return true;
    }
    return false;
}

/*
 * Change the prescribed resultants of an element so that its unloaded strains are those of the
 * laminate with uniform transverse shear. The element options `shear` and `rho` make the element
 * softer in shear, but must not change its free strains.
 */
static void keep_free_strains(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, free_field *field)
{
    scene_element uniform = *element;
    double inverse[N][N];
    uniform.equilibrium_shear = 0;
    if (package_stiffness(laminate, &uniform, place, field->uniform) < 0 ||
        inverse_of(field->uniform, inverse) < 0 ||
        constant_stiffness(laminate, element, place, field->constant) < 0)
        return;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            field->strain[i] += inverse[i][j] * field->resultants[j];
    for (int i = 0; i < N; i++) {
        field->resultants[i] = 0;
        for (int j = 0; j < N; j++)
            field->resultants[i] += field->constant[i][j] * field->strain[j];
    }
}

/*
 * Compute the stress of a ply under a unit field while the strains of the element are zero. With
 * the element option lin33 the ply thickens freely: its normal stress 33 is 0.
 *   prescribed [6] in   stress at zero strains, Voigt order 11 22 33 23 13 12
 *   stress     [6] out  stress of the ply, same order
 */
static void ply_stress(const laminate_ply *ply, const scene_element *element,
                       const double prescribed[6], double stress[6])
{
    for (int i = 0; i < 6; i++)
        stress[i] =
            prescribed[i] - (element->lin33 ? ply->c[i][2] / ply->c[2][2] * prescribed[2] : 0);
}

/*
 * Return the value of a field at the middle height of a ply: temperature (K), or electric field
 * along the surface (V/m), each interpolated linearly between faces. A voltage across one ply or a
 * temperature of one ply has the value 1 (V or K).
 */
static double field_mean(const laminate *laminate, const laminate_field *field,
                         const laminate_ply *ply)
{
    const double share = ((ply->z[0] + ply->z[1]) / 2 - laminate->z[0]) / laminate->thickness;
    if (field->ply < 0)
        return field->temperature[0] + (field->temperature[1] - field->temperature[0]) * share;
    return field->axis > 0 ? (field->along[0] + field->along[1]) / 2 : 1;
}

/*
 * Return the thickness of all plies that are present in an element together, as a mean over its
 * area (m).
 */
static double present_thickness(const laminate *laminate, const laminate_place *place)
{
    double thickness = laminate->thickness;
    for (int layer = 0; layer < laminate->plies; layer++)
        thickness -= (1 - laminate_cover(place, layer)) *
                     (laminate->ply[layer].z[1] - laminate->ply[layer].z[0]);
    return thickness;
}

/*
 * Return the thickness strain, with the opposite sign, that a field (voltage, electric field along
 * the surface or temperature) would cause if every ply thickened freely: mean over all plies that
 * are present, measured along the director of the element.
 */
static double free_thickening(const laminate *laminate, const laminate_place *place,
                              const laminate_field *field)
{
    const double thickness = present_thickness(laminate, place);
    double thickening = 0;
    for (int layer = 0; layer < laminate->plies; layer++) {
        const laminate_ply *ply = &laminate->ply[layer];
        const double mean = field_mean(laminate, field, ply);
        if (field_acts(place, field, layer))
            thickening += acting_share(place, field, layer) *
                          field_stress_of(&laminate->ply[layer], field)[2] / ply->c[2][2] * mean *
                          (ply->z[1] - ply->z[0]) / thickness;
    }
    return place->is_general ? thickening * place->natural.base[2][2] * place->natural.base[2][2]
                             : thickening;
}

/*
 * Compute the stress resultants (N/m) of an element whose strains are kept at 0 while a voltage, an
 * electric field or a temperature acts. With the element option lin33 the plies may change their
 * thickness meanwhile, but their mean thickness strain is kept at 0, too. If a ply gets a
 * transverse shear stress, also compute the strains of the element without load
 * (free_field.strain).
 */
static void field_resultants(const laminate *laminate, const scene_element *element,
                             const laminate_place *place, const laminate_field *field,
                             free_field *result)
{
    const double thickening = element->lin33 ? free_thickening(laminate, place, field) : 0;
    double stiffness[N][N], *h0 = result->resultants;
    memset(h0, 0, N * sizeof *h0);
    for (int layer = 0; layer < laminate->plies; layer++) {
        double stress[6];
        if (!field_acts(place, field, layer))
            continue;
        ply_stress(&laminate->ply[layer], element, field_stress_of(&laminate->ply[layer], field),
                   stress);
        for (int i = 0; i < 6; i++)
            stress[i] *= acting_share(place, field, layer);
        integrate_stress(laminate, element, place, &laminate->ply[layer], field, stress, h0);
    }
    const int thickens =
        element->lin33 && package_stiffness(laminate, element, place, stiffness) == 0;
    if (element->lin33)
        h0[D33] = 0;
    /*
     * The mean thickness strain of all plies is kept at 0; the stress resultants that this needs
     * are added to those of the field.
     */
    for (int i = 0; i < N; i++)
        h0[i] += thickens ? stiffness[i][M33] * thickening : 0;
    memset(result->strain, 0, sizeof result->strain);
    if (causes_shear(laminate, place, field))
        keep_free_strains(laminate, element, place, result);
}

void laminate_resultants(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field, double h0[N])
{
    free_field result;
    field_resultants(laminate, element, place, field, &result);
    for (int i = 0; i < N; i++)
        h0[i] = result.resultants[i] * place->area;
}

void laminate_unit_resultants(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, int ply, double h0[N])
{
    const laminate_field field = {.ply = ply, .temperature = {1, 1}};
    laminate_resultants(laminate, element, place, &field, h0);
}

/*
 * Return the change of an electrode's charge per area because the element is softer in transverse
 * shear than its material (keep_free_strains):
 *   e1^T (D - D') e2
 *   e1, e2  strains of the unloaded element per unit of the field `first` (voltage of the
 *           electrode) and of the field `second` (voltage or temperature)
 *   D       stiffness with uniform transverse shear through the thickness (N/m)
 *   D'      stiffness of the softer element (N/m)
 * Unit: C/m2 per volt or per kelvin. The charge is the second derivative of an energy by both
 * fields, so that the result stays the same if they are exchanged.
 */
static double shear_charge(const laminate *laminate, const scene_element *element,
                           const laminate_place *place, const laminate_field *first,
                           const laminate_field *second)
{
    free_field one, other;
    double charge = 0;
    if (!causes_shear(laminate, place, first) || !causes_shear(laminate, place, second))
        return 0;
    field_resultants(laminate, element, place, first, &one);
    field_resultants(laminate, element, place, second, &other);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            charge += one.strain[i] * (one.uniform[i][j] - one.constant[i][j]) * other.strain[j];
    return charge;
}

/*
 * Return a material constant of a ply for two fields, at zero strain: the permittivity for two
 * electric fields, or the pyroelectric constant for an electric field and a temperature (minus the
 * second derivative of the electric enthalpy per volume).
 */
static double field_density(const laminate_ply *ply, const laminate_field *first,
                            const laminate_field *second)
{
    const double thickness = ply->z[1] - ply->z[0];
    if (is_temperature(second))
        return first->axis > 0 ? ply->pyroelectric_along[first->axis - 1]
                               : ply->pyroelectric_charge / thickness;
    if (first->axis > 0 && second->axis > 0)
        return ply->permittivity_along[first->axis - 1][second->axis - 1];
    return first->axis == second->axis ? ply->capacitance / thickness : 0;
}

/*
 * Return the larger one of two fractions of an element: those covered by the plies in which two
 * fields (electric field or temperature) act; 1 for a temperature of all plies. A capacitance
 * contains products of the mean effects of both fields, which are proportional to both fractions.
 * laminate_capacitance multiplies these products by the larger fraction, its callers by the smaller
 * one.
 */
static double larger_cover(const laminate_place *place, const laminate_field *first,
                           const laminate_field *second)
{
    const double cover = laminate_cover(place, first->ply);
    return second->ply < 0 ? 1 : fmax(cover, laminate_cover(place, second->ply));
}

/*
 * The charge per area that the field `second` causes on the electrode of the field `first` is the
 * sum of four terms:
 *   integral of f1 f2 d + integral of f1 f2 c_33 t1 t2 - s C_33 T1 T2 + s shear_charge
 *   f1, f2      values of `first` and `second` at a height, per unit of each field
 *   d           field_density of the ply of the electrode
 *   c_33, C_33  normal stiffness of this ply, and of all plies together
 *   t1, t2      free thickness strains of this ply per unit of each field
 *   T1, T2      means of the free thickness strains over all plies
 *   s           larger one of the fractions of the element that the plies of both fields cover
 * Terms two and three exist with the element option lin33, term four for uniform fields.
 */
double laminate_capacitance(const laminate *laminate, const scene_element *element,
                            const laminate_place *place, const laminate_field *first,
                            const laminate_field *second, bool is_uniform)
{
    const int ply = first->ply;
    const laminate_ply *own = &laminate->ply[ply];
    const double half = (own->z[1] - own->z[0]) / 2;
    const double thickening = element->lin33 ? electric_stress_of(own, first)[2] *
                                                   field_stress_of(own, second)[2] / own->c[2][2]
                                             : 0;
    const double cover = larger_cover(place, first, second);
    double stiffness[N][N], share[6], charge = 0;
    for (int point = 0; point < POINTS && field_acts(place, second, ply); point++) {
        const double z = (own->z[0] + own->z[1]) / 2 + half * gauss_x[point];
        charge += half * gauss_w[point] * metric_at(element, place, z, share) *
                  (field_density(own, first, second) + thickening) *
                  laminate_field_at(laminate, element, place, first, z) *
                  laminate_field_at(laminate, element, place, second, z);
    }
    if (element->lin33 && place->present_plies >> ply & 1u &&
        package_stiffness(laminate, element, place, stiffness) == 0)
        charge -= cover * free_thickening(laminate, place, first) *
                  free_thickening(laminate, place, second) * stiffness[M33][M33];
    if (is_uniform)
        charge += cover * shear_charge(laminate, element, place, first, second);
    return charge * place->area;
}

/*
 * The charge of an electrode per unit of a field (a voltage or a temperature) is minus the mixed
 * second derivative of the electric enthalpy of all plies with respect to two variables: the
 * voltage of the electrode, and the field.
 */
double laminate_charge(const laminate *laminate, const scene_element *element,
                       const laminate_place *place, int ply, const laminate_field *field)
{
    const laminate_field voltage = {.ply = ply};
    return laminate_capacitance(laminate, element, place, &voltage, field, true);
}
