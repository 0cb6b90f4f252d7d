/* SPDX-License-Identifier: BSD-2-Clause */
/* Writing of a VTK file for ParaView: a mesh with values at its points and in its cells. */
#ifndef VTK_FILE_H
#define VTK_FILE_H

#include <stdbool.h>
#include <stdio.h>
#include "../model/stress_points.h"
#include "../text/words.h"

/* An array of values at the points or in the cells of a VTK file for ParaView. */
typedef struct vtk_array {
    char name[256];
    int components; /* number of values that the array of a VTK file has at each point or in each
                       cell */
    bool of_cells;  /* true: the array of the VTK file has values for the cells; false: for the
                       points */
    double *value;  /* [points or cells][components] values of the array of a VTK file */
} vtk_array;

/* Contents of a VTK file that is being made. The cells of the file are the elements of a mesh,
   or its points where the mesh has no elements. */
typedef struct vtk_file {
    const mesh *mesh;
    const stress_points *points; /* points of the VTK file and the corners of its cells; NULL: the
                                    nodes of the mesh */
    vtk_array *array;
    int arrays;
    bool is_full; /* true after an allocation of memory has failed; the file is then not written */
} vtk_file;

/*
 * Append an array of zeros to a VTK file, with a name made as by printf. Returns the values of the
 * array, or NULL if memory runs out.
 */
double *vtk_add(vtk_file *vtk, bool of_cells, int components, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Size of the text of a unit in parentheses, including its NUL (characters). */
enum { VTK_UNIT = 2 * WORDS_UNIT };

/*
 * Write the unit of a quantity in parentheses, with a blank before it; an empty text if the scene
 * file names none.
 */
const char *vtk_unit(const scene_unit_names *units, words_quantity quantity, char text[VTK_UNIT]);

/* Name of a layer of the scene, or "layer" and its number from 1. */
const char *vtk_layer_name(const design *design, int layer, char name[SCENE_NAME]);

/* Return the number of points of a VTK file, and the mesh node at which a point lies. */
int vtk_points(const vtk_file *vtk);
int vtk_node(const vtk_file *vtk, int point);

/* Write a VTK file and free its arrays. Returns 0, or -1 if memory or writing has failed. */
int vtk_end(vtk_file *vtk, FILE *file);

#endif
