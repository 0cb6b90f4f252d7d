/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimated discretisation errors on standard output (print_mesh_error.h). */
#include "print_mesh_error.h"
#include <math.h>
#include <stdio.h>

/* ---- text ------------------------------------------------------------- */

/*
 * Factor by which the number of elements in each direction has to grow to halve the uncertainty of
 * a result, from the observed order of convergence. Orders are limited to the range 1 to 2.
 */
static double growth(double order)
{
    const double used = isnan(order) ? 1 : fmin(fmax(order, 1), 2);
    return pow(2, 1 / used);
}

/*
 * Print the number of elements with which the largest uncertainty of any output, estimated from two
 * meshes, would be halved.
 */
static void print_next_mesh(const mesh_error *mesh_error)
{
    const int *elements = mesh_error->elements[0];
    double factor = 1;
    int next[2];
    for (int k = 0; k < mesh_error->values.count; k++)
        factor = fmax(factor, growth(mesh_error->estimate[k].order));
    for (int i = 0; i < 2; i++)
        next[i] = elements[i] == 1 ? 1 : 2 * (int)ceil(elements[i] * factor / 2);
    printf("  about half the uncertainty: %d x %d elements\n", next[0], next[1]);
}

static void print_meshes(const mesh_error *mesh_error)
{
    printf("\n  discretisation error, estimated from meshes of");
    for (int level = 0; level < mesh_error->meshes; level++)
        printf("%s %d x %d", level ? "," : "", mesh_error->elements[level][0],
               mesh_error->elements[level][1]);
    puts(" elements");
    for (int i = 0; i < 2; i++)
        if (mesh_error->elements[0][i] == 1)
            printf("  theta%d keeps its one element: its discretisation is not in the estimate\n",
                   i + 1);
    if (mesh_error->meshes == 2)
        printf("  two meshes only: %s\n", mesh_error->why_two);
}

/*
 * Print the estimates of the discretisation error of one result; the relative uncertainty of a
 * result that is 0 has no value.
 */
static void print_estimate(const mesh_estimate *estimate, const char *name)
{
    const double relative = 100 * estimate->uncertainty / fabs(estimate->extrapolated);
    printf("  %-20s %16.6e %16.6e %14.1e", name, estimate->value, estimate->extrapolated,
           estimate->uncertainty);
    if (isfinite(relative))
        printf(" %9.2f%%", relative);
    else
        printf(" %10s", "-");
    if (isnan(estimate->order))
        printf(" %7s\n", "-");
    else
        printf(" %7.2f\n", estimate->order);
}

void print_mesh_error(const mesh_error *mesh_error)
{
    if (mesh_error->meshes == 0)
        return;
    print_meshes(mesh_error);
    printf("  %-20s %16s %16s %14s %10s %7s\n", "", "on this mesh", "extrapolated",
           "uncertainty +-", "relative", "order");
    for (int k = 0; k < mesh_error->values.count; k++)
        print_estimate(&mesh_error->estimate[k], mesh_error->values.item[k].name);
    print_next_mesh(mesh_error);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_meshes(json *json, const mesh_error *mesh_error)
{
    json_open(json, "meshes", '[');
    for (int level = 0; level < mesh_error->meshes; level++) {
        const double elements[2] = {mesh_error->elements[level][0], mesh_error->elements[level][1]};
        json_numbers(json, NULL, elements, 2);
    }
    json_close(json, ']');
}

void print_mesh_error_json(json *json, const mesh_error *mesh_error)
{
    if (mesh_error->meshes == 0)
        return;
    json_open(json, "discretisation", '{');
    json_meshes(json, mesh_error);
    json_open(json, "results", '{');
    for (int k = 0; k < mesh_error->values.count; k++) {
        const mesh_estimate *estimate = &mesh_error->estimate[k];
        json_open(json, mesh_error->values.item[k].name, '{');
        json_number(json, "value", estimate->value);
        json_number(json, "extrapolated", estimate->extrapolated);
        json_number(json, "uncertainty", estimate->uncertainty);
        json_number(json, "order", estimate->order);
        json_close(json, '}');
    }
    json_close(json, '}');
    json_close(json, '}');
}
