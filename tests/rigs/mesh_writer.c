/*
 * Writer of mesh files of a grid, in every format that pzs reads (mesh_writer.h).
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

/* Permute unique labels at random. */
static void shuffle(int64_t *label, int count, unsigned *state)
{
    for (int i = count - 1; i > 0; i--) {
        const int j = (int)(next_random(state) % (unsigned)(i + 1));
        const int64_t swap = label[i];
        label[i] = label[j];
        label[j] = swap;
    }
}

void grid_fill(grid_mesh *grid, int n1, int n2,
               void (*point)(double along, double across, double position[3]), unsigned order)
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
    for (int element = 0; element < grid->elements; element++) {
        const int i = element / n2, j = element % n2, first = i * (n2 + 1) + j;
        const int node[4] = {first, first + n2 + 1, first + n2 + 2, first + 1};
        memcpy(grid->node[element], node, sizeof node);
        grid->element_label[element] = order ? 5 * element + 1000 : element + 1;
    }
    if (order)
        shuffle(grid->node_label, grid->nodes, &state);
}

void grid_flip(grid_mesh *grid, unsigned seed)
{
    for (int element = 0; element < grid->elements; element++) {
        const int second = grid->node[element][1];
        if (next_random(&seed) % 2)
            continue;
        grid->node[element][1] = grid->node[element][3];
        grid->node[element][3] = second;
    }
}

/* ---- groups ------------------------------------------------------------ */

/* Physical groups of a Gmsh file: dimension, number and name. */
static const struct {
    int dimension, tag;
    const char *name;
} groups[] = {{0, 1, "origin"}, {1, 1, "low1"}, {1, 2, "high1"}, {1, 3, "low2"},
              {1, 4, "high2"},  {2, 1, "all"},  {2, 2, "first"}, {2, 3, "second"}};
enum { GROUPS = sizeof groups / sizeof *groups };

/* Number of edges on side k of the grid (low1, high1, low2, high2), and the two nodes of edge i. */
static int side_count(const grid_mesh *grid, int k)
{
    return grid->n[k < 2];
}

static void side_nodes(const grid_mesh *grid, int k, int i, int node[2])
{
    for (int at = 0; at < 2; at++) {
        const int across = k % 2 ? grid->n[k / 2] : 0, along = i + at;
        node[at] = k < 2 ? across * (grid->n[1] + 1) + along : along * (grid->n[1] + 1) + across;
    }
}

static int total_cells(const grid_mesh *grid, bool twice)
{
    return 1 + 2 * (grid->n[0] + grid->n[1]) + (twice ? 2 : 1) * grid->elements;
}

/* Labels of line elements and of the point, which lie above those of the quadrilaterals. */
static int64_t line_label(int k, int i)
{
    return 1000000 + 10000 * k + i;
}

/* ---- numbers ----------------------------------------------------------- */

typedef struct out {
    FILE *file;
    bool is_binary;
} out;

static void put_int(const out *file, int64_t value)
{
    const int narrow = (int)value;
    if (file->is_binary)
        fwrite(&narrow, sizeof narrow, 1, file->file);
    else
        fprintf(file->file, "%d ", narrow);
}

static void put_size(const out *file, int64_t value)
{
    const uint64_t wide = (uint64_t)value;
    if (file->is_binary)
        fwrite(&wide, sizeof wide, 1, file->file);
    else
        fprintf(file->file, "%lld ", (long long)value);
}

static void put_real(const out *file, double value)
{
    if (file->is_binary)
        fwrite(&value, sizeof value, 1, file->file);
    else
        fprintf(file->file, "%.17g ", value);
}

static void end_line(const out *file)
{
    if (!file->is_binary)
        fputc('\n', file->file);
}

static void put_head(const out *file, const char *version)
{
    const int one = 1;
    fprintf(file->file, "$MeshFormat\n%s %d 8\n", version, file->is_binary);
    if (file->is_binary)
        fwrite(&one, sizeof one, 1, file->file);
    fprintf(file->file, "%s$EndMeshFormat\n$PhysicalNames\n%d\n", file->is_binary ? "\n" : "",
            GROUPS);
    for (int k = 0; k < GROUPS; k++)
        fprintf(file->file, "%d %d \"%s\"\n", groups[k].dimension, groups[k].tag, groups[k].name);
    fputs("$EndPhysicalNames\n", file->file);
}

/* ---- version 2.2 ------------------------------------------------------- */

/*
 * Write one element: a text file has its type in its line, a binary file a block for each element.
 */
static void put_cell_2(const out *file, int64_t label, int type, int physical)
{
    if (file->is_binary) {
        put_int(file, type);
        put_int(file, 1);
        put_int(file, 2);
        put_int(file, label);
    } else {
        put_int(file, label);
        put_int(file, type);
        put_int(file, 2);
    }
    put_int(file, physical);
    put_int(file, 1);
}

static void put_quad_2(const grid_mesh *grid, const out *file, int element, int64_t label,
                       int physical)
{
    put_cell_2(file, label, 3, physical);
    for (int corner = 0; corner < 4; corner++)
        put_int(file, grid->node_label[grid->node[element][corner]]);
    end_line(file);
}

static void write_2(const grid_mesh *grid, const out *file)
{
    put_head(file, "2.2");
    fprintf(file->file, "$Nodes\n%d\n", grid->nodes);
    for (int index = 0; index < grid->nodes; index++) {
        put_int(file, grid->node_label[index]);
        for (int i = 0; i < 3; i++)
            put_real(file, grid->x[index][i]);
        end_line(file);
    }
    fprintf(file->file, "%s$EndNodes\n$Elements\n%d\n", file->is_binary ? "\n" : "",
            total_cells(grid, true));
    put_cell_2(file, 2000000, 15, 1);
    put_int(file, grid->node_label[0]);
    end_line(file);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < side_count(grid, k); i++) {
            int node[2];
            side_nodes(grid, k, i, node);
            put_cell_2(file, line_label(k, i), 1, k + 1);
            put_int(file, grid->node_label[node[0]]);
            put_int(file, grid->node_label[node[1]]);
            end_line(file);
        }
    for (int element = 0; element < grid->elements; element++) {
        put_quad_2(grid, file, element, grid->element_label[element], 1);
        put_quad_2(grid, file, element, 3000000 + element, 2 * element < grid->elements ? 2 : 3);
    }
    fprintf(file->file, "%s$EndElements\n", file->is_binary ? "\n" : "");
}

/* ---- version 4.1 ------------------------------------------------------- */

/*
 * Write the entities: a point, four curves, and two surfaces, each in the group "all" and in one
 * half.
 */
static void put_entities(const out *file)
{
    fputs("$Entities\n", file->file);
    put_size(file, 1);
    put_size(file, 4);
    put_size(file, 2);
    put_size(file, 0);
    end_line(file);
    put_int(file, 1);
    for (int i = 0; i < 3; i++)
        put_real(file, 0);
    put_size(file, 1);
    put_int(file, 1);
    end_line(file);
    for (int k = 0; k < 6; k++) {
        const int surface = k - 4;
        put_int(file, k < 4 ? k + 1 : surface + 1);
        for (int i = 0; i < 6; i++)
            put_real(file, i);
        put_size(file, k < 4 ? 1 : 2);
        put_int(file, k < 4 ? k + 1 : 1);
        if (k >= 4)
            put_int(file, -(surface + 2)); /* a group of reversed orientation */
        put_size(file, 2);
        put_int(file, 1);
        put_int(file, -2);
        end_line(file);
    }
    fprintf(file->file, "%s$EndEntities\n", file->is_binary ? "\n" : "");
}

/* Write the nodes in two blocks, of which the second has parametric coordinates. */
static void put_nodes_4(const grid_mesh *grid, const out *file)
{
    const int first[3] = {0, grid->nodes / 3, grid->nodes};
    fputs("$Nodes\n", file->file);
    put_size(file, 2);
    put_size(file, grid->nodes);
    put_size(file, 1);
    put_size(file, 1);
    end_line(file);
    for (int block = 0; block < 2; block++) {
        put_int(file, block + 1);
        put_int(file, 1);
        put_int(file, block == 1);
        put_size(file, first[block + 1] - first[block]);
        end_line(file);
        for (int node = first[block]; node < first[block + 1]; node++) {
            put_size(file, grid->node_label[node]);
            end_line(file);
        }
        for (int node = first[block]; node < first[block + 1]; node++) {
            for (int i = 0; i < 3; i++)
                put_real(file, grid->x[node][i]);
            for (int i = 0; block == 1 && i < 2; i++)
                put_real(file, 0.5);
            end_line(file);
        }
    }
    fprintf(file->file, "%s$EndNodes\n", file->is_binary ? "\n" : "");
}

static void put_block_4(const out *file, int dimension, int tag, int type, int count)
{
    put_int(file, dimension);
    put_int(file, tag);
    put_int(file, type);
    put_size(file, count);
    end_line(file);
}

static void put_elements_4(const grid_mesh *grid, const out *file)
{
    const int half = (grid->elements + 1) / 2;
    fputs("$Elements\n", file->file);
    put_size(file, 7);
    put_size(file, total_cells(grid, false));
    put_size(file, 1);
    put_size(file, 1);
    end_line(file);
    put_block_4(file, 0, 1, 15, 1);
    put_size(file, 2000000);
    put_size(file, grid->node_label[0]);
    end_line(file);
    for (int k = 0; k < 4; k++) {
        put_block_4(file, 1, k + 1, 1, side_count(grid, k));
        for (int i = 0; i < side_count(grid, k); i++) {
            int node[2];
            side_nodes(grid, k, i, node);
            put_size(file, line_label(k, i));
            put_size(file, grid->node_label[node[0]]);
            put_size(file, grid->node_label[node[1]]);
            end_line(file);
        }
    }
    for (int block = 0; block < 2; block++) {
        put_block_4(file, 2, block + 1, 3, block ? grid->elements - half : half);
        for (int element = block ? half : 0; element < (block ? grid->elements : half); element++) {
            put_size(file, grid->element_label[element]);
            for (int corner = 0; corner < 4; corner++)
                put_size(file, grid->node_label[grid->node[element][corner]]);
            end_line(file);
        }
    }
    fprintf(file->file, "%s$EndElements\n", file->is_binary ? "\n" : "");
}

static void write_4(const grid_mesh *grid, const out *file)
{
    put_head(file, "4.1");
    fputs("$Comment\nskipped $Nodes $EndComments\n$EndComment\n", file->file);
    put_entities(file);
    put_nodes_4(grid, file);
    put_elements_4(grid, file);
}

/* ---- INP --------------------------------------------------------------- */

static void write_inp(const grid_mesh *grid, FILE *file)
{
    static const char *const side[4] = {"low1", "high1", "low2", "high2"};
    const int half = (grid->elements + 1) / 2;
    fputs("** a grid\n*Heading\n a line of text, 1, 2\n*NODE\n", file);
    for (int index = 0; index < grid->nodes; index++)
        fprintf(file, "%lld, %.17g,%.17g , %.17g\n", (long long)grid->node_label[index],
                grid->x[index][0], grid->x[index][1], grid->x[index][2]);
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
    for (int element = 0; element < grid->elements; element++) {
        if (element == half)
            fputs("*Element, type=S4, elset=\"second\"\n", file);
        fprintf(file, "%lld, %lld,\n%lld, %lld, %lld\n", (long long)grid->element_label[element],
                (long long)grid->node_label[grid->node[element][0]],
                (long long)grid->node_label[grid->node[element][1]],
                (long long)grid->node_label[grid->node[element][2]],
                (long long)grid->node_label[grid->node[element][3]]);
    }
    fprintf(file, "*NSET, NSET=origin\n%lld,\n*elset, elset=all\nFIRST, second\n",
            (long long)grid->node_label[0]);
    fprintf(file, "*ELSET, ELSET=again, GENERATE\n%lld, %lld, 1\n*STEP\n*END STEP\n",
            (long long)grid->element_label[0], (long long)grid->element_label[grid->elements - 1]);
}

void grid_write(const grid_mesh *grid, mesh_format format, FILE *file)
{
    const out target = {file, format == MSH2_BINARY || format == MSH4_BINARY};
    if (format == INP)
        write_inp(grid, file);
    else if (format == MSH2_TEXT || format == MSH2_BINARY)
        write_2(grid, &target);
    else
        write_4(grid, &target);
}
