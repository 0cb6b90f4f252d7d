/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK files for ParaView (vtk.h). */
#include "vtk_file.h"
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

int vtk_points(const vtk_file *vtk)
{
    return vtk->points ? vtk->points->count : vtk->mesh->nodes;
}

int vtk_node(const vtk_file *vtk, int point)
{
    return vtk->points ? vtk->points->node[point] : point;
}

const char *vtk_unit(const scene_unit_names *units, words_quantity quantity, char text[VTK_UNIT])
{
    char unit[WORDS_UNIT];
    text[0] = '\0';
    if (*words_unit(units, quantity, unit) && quantity == QUANTITY_CHARGE)
        snprintf(text, VTK_UNIT, " (%s/%.60s2)", unit, units->length);
    else if (*unit)
        snprintf(text, VTK_UNIT, " (%s)", unit);
    return text;
}

const char *vtk_layer_name(const design *design, int layer, char name[SCENE_NAME])
{
    snprintf(name, SCENE_NAME, "%.60s", design->layer[layer].name);
    if (!*name)
        snprintf(name, SCENE_NAME, "layer %d", layer + 1);
    return name;
}

double *vtk_add(vtk_file *vtk, bool of_cells, int components, const char *format, ...)
{
    const int rows = of_cells ? vtk->mesh->elements : vtk_points(vtk);
    vtk_array array = {.components = components, .of_cells = of_cells};
    va_list values;
    va_start(values, format);
    vsnprintf(array.name, sizeof array.name, format, values);
    va_end(values);
    array.value = calloc((size_t)(rows * components), sizeof *array.value);
    vtk_array *grown = realloc(vtk->array, ((size_t)vtk->arrays + 1) * sizeof *grown);
    vtk->is_full |= !grown || !array.value;
    if (!grown) {
        free(array.value);
        return NULL;
    }
    vtk->array = grown;
    vtk->array[vtk->arrays++] = array;
    return array.value;
}

/*
 * Begin an array of a VTK file; characters in its name that are special to XML become underscores.
 */
static void begin_array(FILE *file, const char *type, int components, const char *name)
{
    fprintf(file, "<DataArray type=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\" Name=\"", type,
            components);
    for (; *name; name++)
        fputc(*name > ' ' && *name < 127 && !strchr("<>&\"", *name) ? *name : '_', file);
    fputs("\">\n", file);
}

static void write_arrays(FILE *file, const vtk_file *vtk, bool of_cells)
{
    const int rows = of_cells ? vtk->mesh->elements : vtk_points(vtk);
    for (const vtk_array *array = vtk->array; array < vtk->array + vtk->arrays; array++) {
        const int components = array->components;
        if (array->of_cells != of_cells)
            continue;
        begin_array(file, "Float64", components, array->name);
        for (int i = 0; i < components * rows; i++) {
            const char end = i % components == components - 1 ? '\n' : ' ';
            fprintf(file, "%.9g%c", isfinite(array->value[i]) ? array->value[i] : 0, end);
        }
        fputs("</DataArray>\n", file);
    }
}

static void write_places(FILE *file, const vtk_file *vtk)
{
    begin_array(file, "Float64", 3, "place");
    for (int k = 0; k < 3 * vtk_points(vtk); k++)
        fprintf(file, "%.9g%c", vtk->mesh->point[vtk_node(vtk, k / 3)].position[k % 3],
                "  \n"[k % 3]);
    fputs("</DataArray>\n", file);
}

/* Return the number of cells of a VTK file: elements, or points where there are no elements. */
static int cells(const vtk_file *vtk)
{
    return vtk->mesh->elements > 0 ? vtk->mesh->elements : vtk_points(vtk);
}

/* Write the points at the corners of all cells of a VTK file, four each, or one for a point. */
static void write_corners(FILE *file, const vtk_file *vtk)
{
    const mesh *mesh = vtk->mesh;
    for (int k = 0; mesh->elements == 0 && k < vtk_points(vtk); k++)
        fprintf(file, "%d\n", k);
    for (int k = 0; k < 4 * mesh->elements; k++)
        fprintf(file, "%d%c",
                vtk->points ? vtk->points->corner[k / 4][k % 4] : mesh->element[k / 4][k % 4],
                "   \n"[k % 4]);
}

/*
 * Write the cells of a VTK file: the points at the corners of all cells, the end of each cell in
 * that list, and the cell type, VTK_QUAD (9) or VTK_VERTEX (1).
 */
static void write_cells(FILE *file, const vtk_file *vtk)
{
    const bool has_elements = vtk->mesh->elements > 0;
    begin_array(file, "Int32", 1, "connectivity");
    write_corners(file, vtk);
    fputs("</DataArray>\n", file);
    begin_array(file, "Int32", 1, "offsets");
    for (int e = 0; e < cells(vtk); e++)
        fprintf(file, "%d\n", (has_elements ? 4 : 1) * (e + 1));
    fputs("</DataArray>\n", file);
    begin_array(file, "UInt8", 1, "types");
    for (int e = 0; e < cells(vtk); e++)
        fputs(has_elements ? "9\n" : "1\n", file);
    fputs("</DataArray>\n", file);
}

static void write_file(FILE *file, const vtk_file *vtk)
{
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n"
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<Points>\n",
            vtk_points(vtk), cells(vtk));
    write_places(file, vtk);
    fputs("</Points>\n<Cells>\n", file);
    write_cells(file, vtk);
    fputs("</Cells>\n<PointData>\n", file);
    write_arrays(file, vtk, false);
    fputs("</PointData>\n<CellData>\n", file);
    write_arrays(file, vtk, true);
    fputs("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
}

int vtk_end(vtk_file *vtk, FILE *file)
{
    if (!vtk->is_full)
        write_file(file, vtk);
    for (int k = 0; k < vtk->arrays; k++)
        free(vtk->array[k].value);
    free(vtk->array);
    return vtk->is_full || ferror(file) ? -1 : 0;
}
