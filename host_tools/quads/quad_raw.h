/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Contents of a mesh file as the readers of the file formats deliver them, before any check:
 * numbers of nodes and elements are those of the file, and every item records its position in the
 * file.
 */
#ifndef QUAD_RAW_H
#define QUAD_RAW_H

#include "quad_file.h"

typedef struct quad_raw_node {
    int64_t label; /* number of the node in the mesh file */
    double x[3];
    size_t at; /* position (byte) in the mesh file at which the node was read, for error messages */
} quad_raw_node;

/* Cell of a mesh file: a point (1 corner), an edge (2 corners) or a quadrilateral (4 corners). */
typedef struct quad_raw_cell {
    int64_t label;   /* number of the cell (point, edge or quadrilateral) in the mesh file */
    int64_t node[4]; /* [corners] numbers, in the mesh file, of the nodes at the corners of the cell
                        (point, edge or quadrilateral) */
    int corners;
    int group; /* index that the reader of a mesh file gives to the set of the cell (point, edge or
                  quadrilateral) while it reads the file; negative if the cell belongs to no set */
    size_t at; /* position (byte) in the mesh file at which the cell (point, edge or quadrilateral)
                  was read, for error messages */
} quad_raw_cell;

/*
 * Named set of a mesh file: nodes, by their numbers in the file, or cells (points, edges or
 * quadrilaterals) with equal numbers of corners, by their indices.
 */
typedef struct quad_raw_set {
    char *name;
    int corners; /* type of the members of a set of the mesh file: 0 nodes, 2 edges, 4
                    quadrilaterals */
    size_t count, room;
    int64_t *item; /* [count] members of a set of the mesh file: numbers of nodes, or indices of
                      cells (points, edges or quadrilaterals) */
} quad_raw_set;

typedef struct quad_raw {
    size_t nodes, node_room, cells, cell_room, sets, set_room;
    quad_raw_node *node;
    quad_raw_cell *cell;
    quad_raw_set *set;
} quad_raw;

/*
 * Largest number of sets of each kind in a mesh file. Sets are found by comparing names one by one:
 * the limit bounds the time that a damaged file takes.
 */
enum { QUAD_RAW_SETS = 10000 };

/* Write the error message that a mesh file has more than QUAD_RAW_SETS sets. Returns -1. */
int quad_raw_refuse_sets(const quad_file *file);

void quad_raw_free(quad_raw *raw);

/*
 * Append a node or a cell (point, edge, quadrilateral) to the contents of a mesh file. Each
 * function returns 0, or -1 after writing an error message about the mesh file when memory runs
 * out.
 */
int quad_raw_add_node(quad_raw *raw, const quad_file *file, const quad_raw_node *node);
int quad_raw_add_cell(quad_raw *raw, const quad_file *file, const quad_raw_cell *cell);

/*
 * Return the set of the mesh file with a given name whose members have a given number of corners
 * (0: nodes); a new set is added if there is none. Returns NULL after writing an error message
 * about the mesh file when memory runs out.
 */
quad_raw_set *quad_raw_find_set(quad_raw *raw, const quad_file *file, const char *name,
                                size_t length, int corners);
int quad_raw_add_item(quad_raw_set *set, const quad_file *file, int64_t item);

/*
 * Write the error message that an element of a mesh file is a triangle, or has another shape that
 * is not supported, and how to avoid it. Both functions return -1.
 *   shape  in  description of the shape, such as "a pentagon"
 */
int quad_raw_refuse_triangle(const quad_file *file, size_t at, int64_t label);
int quad_raw_refuse_shape(const quad_file *file, size_t at, int64_t label, const char *shape);

/*
 * Readers of the mesh file formats, which begin at the start of the file. Each returns 0, or -1
 * after writing an error message about the mesh file.
 */
int quad_read_gmsh(quad_file *file, quad_raw *raw);
int quad_read_inp(quad_file *file, quad_raw *raw);

#endif
