/* Converged references for thin shells of revolution (revolution.h). */
#include "revolution.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "surface.h"

/*
 * Amplitudes at a node: u v w and the changes t1 t2 of the director. u, w, t1 go with cos(n
 * theta2), v, t2 with sin.
 */
enum { U, V, W, T1, T2, DOF };
enum { NODE_DOF = 3 * DOF, BAND = NODE_DOF, STRAINS = 8 };
enum { ELEMENTS = 2000, NODES = 2 * ELEMENTS + 1, SIZE = DOF * NODES };

static const double nu = 0.3, pi = 3.141592653589793;

/* ---- one element -------------------------------------------------------- */

/*
 * Strains e11 e22 g12, k11 k22 k12, g13 g23 of amplitude i, with value `n` and derivative `d`
 * along the meridian.
 */
static void strain_of(const surface_point *p, double harmonic, int i, double n, double d,
                      double e[STRAINS])
{
    const double k1 = p->k[0], k2 = p->k[1], b = p->b[0], along = harmonic / p->a[1];
    const double l11 = (i == U ? d : 0) + (i == W ? k1 * n : 0);
    const double l22 = (i == U ? b * n : 0) + (i == V ? along * n : 0) + (i == W ? k2 * n : 0);
    const double l12 = (i == U ? -along * n : 0) + (i == V ? -b * n : 0), l21 = i == V ? d : 0;
    e[0] = l11;
    e[1] = l22;
    e[2] = l12 + l21;
    e[3] = -k1 * l11 + (i == T1 ? d : 0);
    e[4] = -k2 * l22 + (i == T1 ? b * n : 0) + (i == T2 ? along * n : 0);
    e[5] = -k2 * l12 - k1 * l21 + (i == T1 ? -along * n : 0) + (i == T2 ? d - b * n : 0);
    e[6] = (i == U ? -k1 * n : 0) + (i == W ? d : 0) + (i == T1 ? n : 0);
    e[7] = (i == V ? -k2 * n : 0) + (i == W ? -along * n : 0) + (i == T2 ? n : 0);
}

/* Plane stress of unit modulus: x' C y of the strains 11 22 12. */
static double plane_product(const double x[3], const double y[3])
{
    const double c = 1 / (1 - nu * nu), g = 1 / (2 * (1 + nu));
    return c * (x[0] * y[0] + x[1] * y[1] + nu * (x[0] * y[1] + x[1] * y[0])) + g * x[2] * y[2];
}

static double energy_product(double h, const double x[STRAINS], const double y[STRAINS])
{
    const double shear = (x[6] * y[6] + x[7] * y[7]) / (2 * (1 + nu));
    return h * (plane_product(x, y) + h * h / 12 * plane_product(x + 3, y + 3) + shear);
}

/* Add an element's stiffness and load. k [SIZE][BAND] lower band, the diagonal last. */
static void add_element(const revolution *r, int element, double *k, double *f)
{
    static const double gauss[2] = {-0.5773502691896258, 0.5773502691896258};
    const double length = (r->theta1[1] - r->theta1[0]) / ELEMENTS;
    for (int g = 0; g < 2; g++) {
        const double x = gauss[g], t = r->theta1[0] + length * (element + (1 + x) / 2);
        const surface_point p = surface_at(&r->surface, t, 0);
        const double shape[3] = {x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2};
        const double slope[3] = {x - 0.5, -2 * x, x + 0.5}, per_length = 2 / (length * p.a[0]);
        const double weight = pi * length / 2 * p.a[0] * p.a[1];
        double e[NODE_DOF][STRAINS];
        for (int i = 0; i < NODE_DOF; i++)
            strain_of(&p, r->harmonic, i % DOF, shape[i / DOF], slope[i / DOF] * per_length, e[i]);
        for (int i = 0; i < NODE_DOF; i++) {
            const int row = 2 * DOF * element + i;
            f[row] += i % DOF == W ? weight * shape[i / DOF] : 0;
            for (int j = 0; j <= i; j++)
                k[row * BAND + BAND - 1 - i + j] += weight * energy_product(r->h, e[i], e[j]);
        }
    }
}

/* ---- the meridian ------------------------------------------------------- */

static int is_held(revolution_end end, int dof)
{
    if (end == END_CLAMPED)
        return 1;
    if (end == END_DIAPHRAGM)
        return dof == V || dof == W || dof == T2;
    return end == END_SYMMETRIC && (dof == U || dof == T1);
}

static void hold(double *k, double *f, int row)
{
    for (int j = 0; j < BAND; j++)
        k[row * BAND + j] = 0;
    for (int i = row + 1; i < row + BAND && i < SIZE; i++)
        k[i * BAND + BAND - 1 - (i - row)] = 0;
    k[row * BAND + BAND - 1] = 1;
    f[row] = 0;
}

/* L D L' of the band in place, then f = K^-1 f. */
static void solve_band(double *k, double *f)
{
    for (int i = 0; i < SIZE; i++) {
        const int first = i < BAND ? 0 : i - BAND + 1;
        double *row = k + (size_t)i * BAND + BAND - 1 - i;
        for (int j = first; j < i; j++) {
            const double *other = k + (size_t)j * BAND + BAND - 1 - j;
            for (int m = j < BAND || j - BAND + 1 < first ? first : j - BAND + 1; m < j; m++)
                row[j] -= row[m] * other[m];
        }
        for (int j = first; j < i; j++) {
            const double scaled = row[j] / k[(size_t)j * BAND + BAND - 1];
            row[i] -= row[j] * scaled;
            row[j] = scaled;
            f[i] -= scaled * f[j];
        }
    }
    for (int i = SIZE - 1; i >= 0; i--) {
        f[i] /= k[(size_t)i * BAND + BAND - 1];
        for (int j = i + 1; j < i + BAND && j < SIZE; j++)
            f[i] -= k[(size_t)j * BAND + (size_t)(BAND - 1 - j + i)] * f[j];
    }
}

static double work(const revolution *r, double *k, double *f, double *load)
{
    double sum = 0;
    for (int e = 0; e < ELEMENTS; e++)
        add_element(r, e, k, f);
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < DOF; i++)
            if (is_held(r->end[end], i))
                hold(k, f, end * DOF * (NODES - 1) + i);
    memcpy(load, f, SIZE * sizeof *f);
    solve_band(k, f);
    for (int i = 0; i < SIZE; i++)
        sum += load[i] * f[i];
    return sum;
}

double revolution_compliance(const revolution *r)
{
    double *k = calloc((size_t)SIZE * BAND, sizeof *k), *f = calloc(SIZE, sizeof *f);
    double *load = calloc(SIZE, sizeof *load);
    const double sum = k && f && load ? work(r, k, f, load) : 0;
    free(k);
    free(f);
    free(load);
    return sum;
}

/* ---- the cylinder in closed form ---------------------------------------- */

/*
 * Strains e11 e22 g12 g13 g23 at height z of amplitude i; w = cos cos, u = sin cos, v = cos sin
 * along x and theta2.
 */
static void cylinder_strain(int i, double wave, double harmonic, double z, double e[5])
{
    const double radius = 1 + z, height = i >= T1 ? z : 1;
    const int along = i == U || i == T1, around = i == V || i == T2;
    e[0] = along ? wave * height : 0;
    e[1] = ((around ? harmonic * height : 0) + (i == W ? 1 : 0)) / radius;
    e[2] = (along ? -harmonic * height / radius : 0) + (around ? -wave * height : 0);
    e[3] = (i == W ? -wave : 0) + (i == T1 ? 1 : 0);
    e[4] = ((i == V ? -1 : 0) + (i == W ? -harmonic : 0) + (i == T2 ? 1 : 0)) / radius;
}

static void add_height(double k[DOF][DOF], double wave, double harmonic, double z, double weight)
{
    double e[DOF][5];
    for (int i = 0; i < DOF; i++)
        cylinder_strain(i, wave, harmonic, z, e[i]);
    for (int i = 0; i < DOF; i++)
        for (int j = 0; j < DOF; j++)
            k[i][j] += weight * (1 + z)
                     * (plane_product(e[i], e[j])
                        + (e[i][3] * e[j][3] + e[i][4] * e[j][4]) / (2 * (1 + nu)));
}

double revolution_cylinder(int harmonic, double length, double h)
{
    static const double gauss[4] = {-0.8611363115940526, -0.3399810435848563,
                                    0.3399810435848563, 0.8611363115940526};
    static const double weight[4] = {0.3478548451374538, 0.6521451548625461,
                                     0.6521451548625461, 0.3478548451374538};
    static const int order[DOF] = {T1, T2, U, V, W}; /* w last: its pivot is the stiffness */
    double k[DOF][DOF] = {{0}};
    for (int g = 0; g < 4; g++)
        add_height(k, pi / length, harmonic, h / 2 * gauss[g], h / 2 * weight[g]);
    for (int p = 0; p < DOF - 1; p++)
        for (int i = p + 1; i < DOF; i++)
            for (int j = DOF - 1; j >= p; j--) {
                const double *row = k[order[p]];
                k[order[i]][order[j]] -= k[order[i]][order[p]] * row[order[j]] / row[order[p]];
            }
    return 1 / k[W][W];
}
