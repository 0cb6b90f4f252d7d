/*
 * Mesh files of a grid (mesh_writer.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "mesh_writer.h"
#include <stdbool.h>
#include <string.h>

static unsigned next_random(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* Shuffle labels, which stay unique. */
static void shuffle(int64_t *label, int count, unsigned *state)
{
    for (int i = count - 1; i > 0; i--) {
        const int j = (int)(next_random(state) % (unsigned)(i + 1));
        const int64_t swap = label[i];
        label[i] = label[j];
        label[j] = swap;
    }
}

void grid_fill(grid_mesh *grid, int n1, int n2, void (*point)(double u, double v, double x[3]),
               unsigned order)
{
    unsigned state = order;
    memset(grid, 0, sizeof *grid);
    grid->n[0] = n1;
    grid->n[1] = n2;
    grid->nodes = (n1 + 1) * (n2 + 1);
    grid->elements = n1 * n2;
    for (int i = 0; i <= n1; i++)
        for (int j = 0; j <= n2; j++) {
            const int node = i * (n2 + 1) + j;
            point((double)i / n1, (double)j / n2, grid->x[node]);
            grid->node_label[node] = order ? 7 * node + 3 : node + 1;
        }
    for (int e = 0; e < grid->elements; e++) {
        const int i = e / n2, j = e % n2, first = i * (n2 + 1) + j;
        const int node[4] = {first, first + n2 + 1, first + n2 + 2, first + 1};
        memcpy(grid->node[e], node, sizeof node);
        grid->element_label[e] = order ? 5 * e + 1000 : e + 1;
    }
    if (order)
        shuffle(grid->node_label, grid->nodes, &state);
}

void grid_flip(grid_mesh *grid, unsigned seed)
{
    for (int e = 0; e < grid->elements; e++) {
        const int second = grid->node[e][1];
        if (next_random(&seed) % 2)
            continue;
        grid->node[e][1] = grid->node[e][3];
        grid->node[e][3] = second;
    }
}

/* ---- groups ------------------------------------------------------------ */

/* Physical groups: dimension, number and name. */
static const struct {
    int dimension, tag;
    const char *name;
} groups[] = {{0, 1, "origin"}, {1, 1, "low1"}, {1, 2, "high1"}, {1, 3, "low2"},
              {1, 4, "high2"},  {2, 1, "all"},  {2, 2, "first"}, {2, 3, "second"}};
enum { GROUPS = sizeof groups / sizeof *groups };

/* Number of edges on side k (low1, high1, low2, high2), and the two nodes of the i-th. */
static int side_count(const grid_mesh *grid, int k)
{
    return grid->n[k < 2];
}

static void side_nodes(const grid_mesh *grid, int k, int i, int node[2])
{
    for (int a = 0; a < 2; a++) {
        const int across = k % 2 ? grid->n[k / 2] : 0, along = i + a;
        node[a] = k < 2 ? across * (grid->n[1] + 1) + along : along * (grid->n[1] + 1) + across;
    }
}

static int total_cells(const grid_mesh *grid, bool twice)
{
    return 1 + 2 * (grid->n[0] + grid->n[1]) + (twice ? 2 : 1) * grid->elements;
}

/* Numbers of line elements and of the point lie above those of the quadrilaterals. */
static int64_t line_label(int k, int i)
{
    return 1000000 + 10000 * k + i;
}

/* ---- numbers ----------------------------------------------------------- */

typedef struct out {
    FILE *file;
    bool is_binary;
} out;

static void put_int(const out *o, int64_t value)
{
    const int narrow = (int)value;
    if (o->is_binary)
        fwrite(&narrow, sizeof narrow, 1, o->file);
    else
        fprintf(o->file, "%d ", narrow);
}

static void put_size(const out *o, int64_t value)
{
    const uint64_t wide = (uint64_t)value;
    if (o->is_binary)
        fwrite(&wide, sizeof wide, 1, o->file);
    else
        fprintf(o->file, "%lld ", (long long)value);
}

static void put_real(const out *o, double value)
{
    if (o->is_binary)
        fwrite(&value, sizeof value, 1, o->file);
    else
        fprintf(o->file, "%.17g ", value);
}

static void end_line(const out *o)
{
    if (!o->is_binary)
        fputc('\n', o->file);
}

static void put_head(const out *o, const char *version)
{
    const int one = 1;
    fprintf(o->file, "$MeshFormat\n%s %d 8\n", version, o->is_binary);
    if (o->is_binary)
        fwrite(&one, sizeof one, 1, o->file);
    fprintf(o->file, "%s$EndMeshFormat\n$PhysicalNames\n%d\n", o->is_binary ? "\n" : "", GROUPS);
    for (int k = 0; k < GROUPS; k++)
        fprintf(o->file, "%d %d \"%s\"\n", groups[k].dimension, groups[k].tag, groups[k].name);
    fputs("$EndPhysicalNames\n", o->file);
}

/* ---- version 2.2 ------------------------------------------------------- */

/* One element: in text its type stands in its line, in binary in a block of its own. */
static void put_cell_2(const out *o, int64_t label, int type, int physical)
{
    if (o->is_binary) {
        put_int(o, type);
        put_int(o, 1);
        put_int(o, 2);
        put_int(o, label);
    } else {
        put_int(o, label);
        put_int(o, type);
        put_int(o, 2);
    }
    put_int(o, physical);
    put_int(o, 1);
}

static void put_quad_2(const grid_mesh *grid, const out *o, int e, int64_t label, int physical)
{
    put_cell_2(o, label, 3, physical);
    for (int r = 0; r < 4; r++)
        put_int(o, grid->node_label[grid->node[e][r]]);
    end_line(o);
}

static void write_2(const grid_mesh *grid, const out *o)
{
    put_head(o, "2.2");
    fprintf(o->file, "$Nodes\n%d\n", grid->nodes);
    for (int n = 0; n < grid->nodes; n++) {
        put_int(o, grid->node_label[n]);
        for (int i = 0; i < 3; i++)
            put_real(o, grid->x[n][i]);
        end_line(o);
    }
    fprintf(o->file, "%s$EndNodes\n$Elements\n%d\n", o->is_binary ? "\n" : "",
            total_cells(grid, true));
    put_cell_2(o, 2000000, 15, 1);
    put_int(o, grid->node_label[0]);
    end_line(o);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < side_count(grid, k); i++) {
            int node[2];
            side_nodes(grid, k, i, node);
            put_cell_2(o, line_label(k, i), 1, k + 1);
            put_int(o, grid->node_label[node[0]]);
            put_int(o, grid->node_label[node[1]]);
            end_line(o);
        }
    for (int e = 0; e < grid->elements; e++) {
        put_quad_2(grid, o, e, grid->element_label[e], 1);
        put_quad_2(grid, o, e, 3000000 + e, 2 * e < grid->elements ? 2 : 3);
    }
    fprintf(o->file, "%s$EndElements\n", o->is_binary ? "\n" : "");
}

/* ---- version 4.1 ------------------------------------------------------- */

/* Entities: a point, four curves, and two surfaces, each in "all" and in one half. */
static void put_entities(const out *o)
{
    fputs("$Entities\n", o->file);
    put_size(o, 1);
    put_size(o, 4);
    put_size(o, 2);
    put_size(o, 0);
    end_line(o);
    put_int(o, 1);
    for (int i = 0; i < 3; i++)
        put_real(o, 0);
    put_size(o, 1);
    put_int(o, 1);
    end_line(o);
    for (int k = 0; k < 6; k++) {
        const int surface = k - 4;
        put_int(o, k < 4 ? k + 1 : surface + 1);
        for (int i = 0; i < 6; i++)
            put_real(o, i);
        put_size(o, k < 4 ? 1 : 2);
        put_int(o, k < 4 ? k + 1 : 1);
        if (k >= 4)
            put_int(o, -(surface + 2)); /* a reversed group */
        put_size(o, 2);
        put_int(o, 1);
        put_int(o, -2);
        end_line(o);
    }
    fprintf(o->file, "%s$EndEntities\n", o->is_binary ? "\n" : "");
}

/* Nodes in two blocks, the second with a parameter. */
static void put_nodes_4(const grid_mesh *grid, const out *o)
{
    const int first[3] = {0, grid->nodes / 3, grid->nodes};
    fputs("$Nodes\n", o->file);
    put_size(o, 2);
    put_size(o, grid->nodes);
    put_size(o, 1);
    put_size(o, 1);
    end_line(o);
    for (int b = 0; b < 2; b++) {
        put_int(o, b + 1);
        put_int(o, 1);
        put_int(o, b == 1);
        put_size(o, first[b + 1] - first[b]);
        end_line(o);
        for (int n = first[b]; n < first[b + 1]; n++) {
            put_size(o, grid->node_label[n]);
            end_line(o);
        }
        for (int n = first[b]; n < first[b + 1]; n++) {
            for (int i = 0; i < 3; i++)
                put_real(o, grid->x[n][i]);
            for (int i = 0; b == 1 && i < 2; i++)
                put_real(o, 0.5);
            end_line(o);
        }
    }
    fprintf(o->file, "%s$EndNodes\n", o->is_binary ? "\n" : "");
}

static void put_block_4(const out *o, int dimension, int tag, int type, int count)
{
    put_int(o, dimension);
    put_int(o, tag);
    put_int(o, type);
    put_size(o, count);
    end_line(o);
}

static void put_elements_4(const grid_mesh *grid, const out *o)
{
    const int half = (grid->elements + 1) / 2;
    fputs("$Elements\n", o->file);
    put_size(o, 7);
    put_size(o, total_cells(grid, false));
    put_size(o, 1);
    put_size(o, 1);
    end_line(o);
    put_block_4(o, 0, 1, 15, 1);
    put_size(o, 2000000);
    put_size(o, grid->node_label[0]);
    end_line(o);
    for (int k = 0; k < 4; k++) {
        put_block_4(o, 1, k + 1, 1, side_count(grid, k));
        for (int i = 0; i < side_count(grid, k); i++) {
            int node[2];
            side_nodes(grid, k, i, node);
            put_size(o, line_label(k, i));
            put_size(o, grid->node_label[node[0]]);
            put_size(o, grid->node_label[node[1]]);
            end_line(o);
        }
    }
    for (int b = 0; b < 2; b++) {
        put_block_4(o, 2, b + 1, 3, b ? grid->elements - half : half);
        for (int e = b ? half : 0; e < (b ? grid->elements : half); e++) {
            put_size(o, grid->element_label[e]);
            for (int r = 0; r < 4; r++)
                put_size(o, grid->node_label[grid->node[e][r]]);
            end_line(o);
        }
    }
    fprintf(o->file, "%s$EndElements\n", o->is_binary ? "\n" : "");
}

static void write_4(const grid_mesh *grid, const out *o)
{
    put_head(o, "4.1");
    fputs("$Comment\nskipped $Nodes $EndComments\n$EndComment\n", o->file);
    put_entities(o);
    put_nodes_4(grid, o);
    put_elements_4(grid, o);
}

/* ---- INP --------------------------------------------------------------- */

static void write_inp(const grid_mesh *grid, FILE *file)
{
    static const char *const side[4] = {"low1", "high1", "low2", "high2"};
    const int half = (grid->elements + 1) / 2;
    fputs("** a grid\n*Heading\n a line of text, 1, 2\n*NODE\n", file);
    for (int n = 0; n < grid->nodes; n++)
        fprintf(file, "%lld, %.17g,%.17g , %.17g\n", (long long)grid->node_label[n], grid->x[n][0],
                grid->x[n][1], grid->x[n][2]);
    for (int k = 0; k < 4; k++) {
        fprintf(file, "*ELEMENT, TYPE=T3D2, ELSET=%s\n", side[k]);
        for (int i = 0; i < side_count(grid, k); i++) {
            int node[2];
            side_nodes(grid, k, i, node);
            fprintf(file, "%lld, %lld, %lld\n", (long long)line_label(k, i),
                    (long long)grid->node_label[node[0]], (long long)grid->node_label[node[1]]);
        }
    }
    fputs("*Element, type = S4R , elset=first\n", file);
    for (int e = 0; e < grid->elements; e++) {
        if (e == half)
            fputs("*Element, type=S4, elset=\"second\"\n", file);
        fprintf(file, "%lld, %lld,\n%lld, %lld, %lld\n", (long long)grid->element_label[e],
                (long long)grid->node_label[grid->node[e][0]],
                (long long)grid->node_label[grid->node[e][1]],
                (long long)grid->node_label[grid->node[e][2]],
                (long long)grid->node_label[grid->node[e][3]]);
    }
    fprintf(file, "*NSET, NSET=origin\n%lld,\n*elset, elset=all\nFIRST, second\n",
            (long long)grid->node_label[0]);
    fprintf(file, "*ELSET, ELSET=again, GENERATE\n%lld, %lld, 1\n*STEP\n*END STEP\n",
            (long long)grid->element_label[0], (long long)grid->element_label[grid->elements - 1]);
}

void grid_write(const grid_mesh *grid, mesh_format format, FILE *file)
{
    const out o = {file, format == MSH2_BINARY || format == MSH4_BINARY};
    if (format == INP)
        write_inp(grid, file);
    else if (format == MSH2_TEXT || format == MSH2_BINARY)
        write_2(grid, &o);
    else
        write_4(grid, &o);
}
