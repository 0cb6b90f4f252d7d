/*
 * Mesh files of a grid of quadrilaterals on any surface, in every format that pzs reads. For test
 * programs.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef MESH_WRITER_H
#define MESH_WRITER_H

#include <stdint.h>
#include <stdio.h>

typedef enum mesh_format {
    MSH2_TEXT,
    MSH2_BINARY,
    MSH4_TEXT,
    MSH4_BINARY,
    INP,
    FORMATS
} mesh_format;

enum { GRID_NODES = 4096 };

/*
 * A grid of n[0] x n[1] elements. Its sets: "all" (elements), "first" and "second" (the halves of
 * the elements, by their index), "low1", "high1", "low2", "high2" (edges), "origin" (one node).
 */
typedef struct grid_mesh {
    int n[2];
    int nodes, elements;
    double x[GRID_NODES][3];
    int node[GRID_NODES][4];
    int64_t node_label[GRID_NODES], element_label[GRID_NODES];
} grid_mesh;

/*
 * Fill a grid with the points of a function of two coordinates from 0 to 1.
 *   order  in  0: ascending labels; else the seed of sparse labels in random order
 */
void grid_fill(grid_mesh *grid, int n1, int n2,
               void (*point)(double along, double across, double position[3]), unsigned order);

/* Reverse the orientation of about half of the elements. */
void grid_flip(grid_mesh *grid, unsigned seed);

/* Write the grid to an open file. */
void grid_write(const grid_mesh *grid, mesh_format format, FILE *file);

#endif
