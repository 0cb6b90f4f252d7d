/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK files for ParaView (report.h). */
#include <math.h>
#include <string.h>
#include "report.h"

void report_displacement(const mesh *mesh, const double *u, double *vector)
{
    for (int i = 0; i < 3 * mesh->nodes; i++) {
        const scene_component component = (scene_component)((int)COMPONENT_X + i % 3);
        vector[i] = design_displacement(mesh, u, i / 3, component, FACE_MIDDLE);
    }
}

/*
 * Begin an array in the XML text of a VTK file. Characters of the name that are special to XML
 * become underscores.
 */
static void begin_array(FILE *file, const char *type, int components, const char *name)
{
    fprintf(file, "<DataArray type=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\" Name=\"", type,
            components);
    for (; *name; name++)
        fputc(*name > ' ' && *name < 127 && !strchr("<>&\"", *name) ? *name : '_', file);
    fputs("\">\n", file);
}

/*
 * Write those arrays of a VTK file that have values in its cells, or those that have values at its
 * points.
 */
static void write_arrays(FILE *file, bool of_cells, int rows, const report_array *array, int arrays)
{
    for (int k = 0; k < arrays; k++) {
        const int components = array[k].components;
        if (array[k].of_cells != of_cells)
            continue;
        begin_array(file, "Float64", components, array[k].name);
        for (int i = 0; i < components * rows; i++) {
            const double value = array[k].value[i];
            fprintf(file, "%.9g%c", isfinite(value) ? value : 0,
                    i % components == components - 1 ? '\n' : ' ');
        }
        fputs("</DataArray>\n", file);
    }
}

/* Write the coordinates of the points of a VTK file for ParaView. */
static void write_places(FILE *file, const mesh *mesh, const stress_points *points, int count)
{
    begin_array(file, "Float64", 3, "place");
    for (int k = 0; k < 3 * count; k++) {
        const int node = points ? points->node[k / 3] : k / 3;
        fprintf(file, "%.9g%c", mesh->point[node].position[k % 3], "  \n"[k % 3]);
    }
    fputs("</DataArray>\n", file);
}

/*
 * Write the cells of a VTK file: the points at the corners of all cells, the end of each cell in
 * that list, and the cell type VTK_QUAD.
 */
static void write_cells(FILE *file, const mesh *mesh, const stress_points *points)
{
    begin_array(file, "Int32", 1, "connectivity");
    for (int k = 0; k < 4 * mesh->elements; k++)
        fprintf(file, "%d%c", points ? points->corner[k / 4][k % 4] : mesh->element[k / 4][k % 4],
                "   \n"[k % 4]);
    fputs("</DataArray>\n", file);
    begin_array(file, "Int32", 1, "offsets");
    for (int e = 0; e < mesh->elements; e++)
        fprintf(file, "%d\n", 4 * (e + 1));
    fputs("</DataArray>\n", file);
    begin_array(file, "UInt8", 1, "types");
    for (int e = 0; e < mesh->elements; e++)
        fputs("9\n", file);
    fputs("</DataArray>\n", file);
}

int report_vtu(FILE *file, const mesh *mesh, const stress_points *points, const report_array *array,
               int arrays)
{
    const int count = points ? points->count : mesh->nodes;
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n"
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<Points>\n",
            count, mesh->elements);
    write_places(file, mesh, points, count);
    fputs("</Points>\n<Cells>\n", file);
    write_cells(file, mesh, points);
    fputs("</Cells>\n<PointData>\n", file);
    write_arrays(file, false, count, array, arrays);
    fputs("</PointData>\n<CellData>\n", file);
    write_arrays(file, true, mesh->elements, array, arrays);
    fputs("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
    return ferror(file) ? -1 : 0;
}
