/* SPDX-License-Identifier: BSD-2-Clause */
/* VTK file of displacements for ParaView (report.h). */
#include <math.h>
#include <string.h>
#include "report.h"

void report_displacement(const mesh *mesh, const double *u, double *vector)
{
    for (int i = 0; i < 3 * mesh->nodes; i++) {
        const uint16_t *dof = mesh->node_dof + (size_t)(i / 3) * mesh->dof_per_node;
        double weight[7];
        design_output_weights(mesh, i / 3, (scene_component)((int)COMPONENT_X + i % 3), FACE_MIDDLE,
                              weight);
        vector[i] = 0;
        for (unsigned k = 0; k < mesh->dof_per_node; k++)
            vector[i] += dof[k] == PZS_CONSTRAINED ? 0 : weight[k] * u[dof[k]];
    }
}

/* Write a name without the characters that are special to XML. */
static void write_name(FILE *file, const char *name)
{
    for (; *name; name++) {
        const bool is_plain = *name > ' ' && *name < 127 && !strchr("<>&\"", *name);
        fputc(is_plain ? *name : '_', file);
    }
}

/*
 * Write the three components of a vector.
 *   x [3]  in
 */
static void write_vector(FILE *file, const double *x)
{
    for (int i = 0; i < 3; i++)
        fprintf(file, "%.9g%c", isfinite(x[i]) ? x[i] : 0, " \n"[i == 2]);
}

static void write_cells(FILE *file, const mesh *mesh)
{
    const char *const array = "<DataArray type=\"%s\" Name=\"%s\" format=\"ascii\">\n";
    fprintf(file, array, "Int32", "connectivity");
    for (int e = 0; e < mesh->elements; e++)
        fprintf(file, "%d %d %d %d\n", mesh->element[e][0], mesh->element[e][1],
                mesh->element[e][2], mesh->element[e][3]);
    fprintf(file, "</DataArray>\n");
    fprintf(file, array, "Int32", "offsets");
    for (int e = 0; e < mesh->elements; e++)
        fprintf(file, "%d\n", 4 * (e + 1));
    fprintf(file, "</DataArray>\n");
    fprintf(file, array, "UInt8", "types");
    for (int e = 0; e < mesh->elements; e++)
        fputs("9\n", file); /* cell type VTK_QUAD */
    fputs("</DataArray>\n</Cells>\n<PointData>\n", file);
}

int report_vtu(FILE *file, const mesh *mesh, const report_field *field, int fields)
{
    const char *const vectors =
        "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\" Name=\"";
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">"
          "\n<UnstructuredGrid>\n",
          file);
    fprintf(file, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<Points>\n%splace\">\n",
            mesh->nodes, mesh->elements, vectors);
    for (int n = 0; n < mesh->nodes; n++)
        write_vector(file, mesh->point[n].x);
    fputs("</DataArray>\n</Points>\n<Cells>\n", file);
    write_cells(file, mesh);
    for (int k = 0; k < fields; k++) {
        fputs(vectors, file);
        write_name(file, field[k].name);
        fputs("\">\n", file);
        for (int n = 0; n < mesh->nodes; n++)
            write_vector(file, field[k].u + 3 * n);
        fputs("</DataArray>\n", file);
    }
    fputs("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
    return ferror(file) ? -1 : 0;
}
