/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The contents of a mesh file as the readers of the formats deliver them, before any check of the
 * mesh: numbers are those of the file, and each item knows its place in the file.
 */
#ifndef QUAD_RAW_H
#define QUAD_RAW_H

#include "quad_file.h"

typedef struct quad_raw_node {
    int64_t label; /* number of the node in the file */
    double x[3];
    size_t at; /* place in the file (byte) */
} quad_raw_node;

/* A point (1 corner), an edge (2) or a quadrilateral (4). */
typedef struct quad_raw_cell {
    int64_t label;   /* number of the element in the file */
    int64_t node[4]; /* [corners] numbers of its nodes in the file */
    int corners;
    int group; /* number that the reader of a format uses to collect sets */
    size_t at; /* place in the file (byte) */
} quad_raw_cell;

/*
 * A named set of nodes, by their numbers in the file, or of cells with the same number of corners,
 * by their indices.
 */
typedef struct quad_raw_set {
    char *name;
    int corners; /* 0: nodes; 2: edges; 4: quadrilaterals */
    size_t count, room;
    int64_t *item; /* [count] */
} quad_raw_set;

typedef struct quad_raw {
    size_t nodes, node_room, cells, cell_room, sets, set_room;
    quad_raw_node *node;
    quad_raw_cell *cell;
    quad_raw_set *set;
} quad_raw;

void quad_raw_free(quad_raw *raw);

/* Append an item. Each returns 0, or -1 with the message that memory ran out. */
int quad_raw_add_node(quad_raw *raw, const quad_file *file, const quad_raw_node *node);
int quad_raw_add_cell(quad_raw *raw, const quad_file *file, const quad_raw_cell *cell);

/* The set of a name and a number of corners, which is made if there is none. NULL: out of memory.
 */
quad_raw_set *quad_raw_find_set(quad_raw *raw, const quad_file *file, const char *name,
                                size_t length, int corners);
int quad_raw_add_item(quad_raw_set *set, const quad_file *file, int64_t item);

/*
 * Refuse an element of a shape that the structure cannot use, and name the cure.
 *   what  in  description, as "a triangle"
 */
int quad_raw_refuse_triangle(const quad_file *file, size_t at, int64_t label);
int quad_raw_refuse_shape(const quad_file *file, size_t at, int64_t label, const char *shape);

/* Readers of the formats. `file` is at its start. Each returns 0, or -1 with the error filled. */
int quad_read_gmsh(quad_file *file, quad_raw *raw);
int quad_read_inp(quad_file *file, quad_raw *raw);

#endif
