/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reader of Gmsh's MSH format, versions 2.2 and 4.1, text and binary. Physical groups become sets;
 * a group without a name is named by its number.
 */
#include "quad_raw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A geometric entity of the file, or in version 2.2 a physical group, with its physical groups. */
typedef struct entity {
    int dimension, tag, count;
    int *physical; /* [count] */
} entity;

typedef struct physical_name {
    int dimension, tag;
    const char *text; /* name within the file */
    size_t length;
} physical_name;

typedef struct gmsh {
    quad_file *file;
    quad_raw *raw;
    int version; /* 2 or 4 */
    size_t entities, entity_room, names, name_room;
    entity *entity;
    physical_name *name;
    bool has_nodes, has_elements;
} gmsh;

/* ---- shapes of elements ------------------------------------------------ */

enum { POINT = 15, EDGE = 1, TRIANGLE = 2, QUADRILATERAL = 3 };

/* Number of nodes of each element type of Gmsh, and its name where the element is refused. */
static const struct {
    int nodes;
    const char *refused;
} shapes[] = {[1] = {2, NULL},
              [2] = {3, "a triangle"},
              [3] = {4, NULL},
              [4] = {4, "a tetrahedron"},
              [5] = {8, "a hexahedron"},
              [6] = {6, "a prism"},
              [7] = {5, "a pyramid"},
              [8] = {3, "an edge of 3 nodes"},
              [9] = {6, "a triangle of 6 nodes"},
              [10] = {9, "a quadrilateral of 9 nodes"},
              [11] = {10, "a tetrahedron of 10 nodes"},
              [15] = {1, NULL},
              [16] = {8, "a quadrilateral of 8 nodes"}};

static int refuse_shape(const gmsh *g, size_t at, int64_t label, int type)
{
    const int known = (int)(sizeof shapes / sizeof *shapes);
    char text[40];
    if (type == TRIANGLE)
        return quad_raw_refuse_triangle(g->file, at, label);
    if (type > 0 && type < known && shapes[type].refused)
        return quad_raw_refuse_shape(g->file, at, label, shapes[type].refused);
    snprintf(text, sizeof text, "of Gmsh's type %d", type);
    return quad_raw_refuse_shape(g->file, at, label, text);
}

static bool is_usable(int type)
{
    return type == POINT || type == EDGE || type == QUADRILATERAL;
}

/* ---- entities and groups ----------------------------------------------- */

static int add_entity(gmsh *g, const entity *one)
{
    if (g->entities == g->entity_room) {
        const size_t room = 2 * g->entity_room + 16;
        entity *bigger = realloc(g->entity, room * sizeof *bigger);
        if (!bigger)
            return quad_fault(g->file, "the entities do not fit into memory");
        g->entity = bigger;
        g->entity_room = room;
    }
    g->entity[g->entities++] = *one;
    return 0;
}

/* Index of an entity, or -1. */
static int find_entity(const gmsh *g, int dimension, int tag)
{
    for (size_t i = 0; i < g->entities; i++)
        if (g->entity[i].dimension == dimension && g->entity[i].tag == tag)
            return (int)i;
    return -1;
}

/* Version 2.2: index of the pseudo entity of one physical group; 0 stands for no group. */
static int group_of(gmsh *g, int dimension, int physical)
{
    const int known = find_entity(g, dimension, physical);
    if (known >= 0 || physical == 0)
        return known;
    entity one = {dimension, physical, 1, malloc(sizeof *one.physical)};
    if (!one.physical) {
        quad_fault(g->file, "the entities do not fit into memory");
        return -2;
    }
    one.physical[0] = physical;
    if (add_entity(g, &one) == 0)
        return (int)g->entities - 1;
    free(one.physical);
    return -2;
}

/* Set of a physical group of edges or quadrilaterals (corners 2, 4), or of points (0). */
static quad_raw_set *set_of(gmsh *g, int dimension, int tag)
{
    static const int corners[3] = {0, 2, 4};
    char number[16];
    for (size_t i = 0; i < g->names; i++)
        if (g->name[i].dimension == dimension && g->name[i].tag == tag)
            return quad_raw_find_set(g->raw, g->file, g->name[i].text, g->name[i].length,
                                     corners[dimension]);
    const int length = snprintf(number, sizeof number, "%d", tag);
    return quad_raw_find_set(g->raw, g->file, number, (size_t)length, corners[dimension]);
}

/* Put every cell into the sets of its physical groups. */
static int collect_sets(gmsh *g)
{
    for (size_t c = 0; c < g->raw->cells; c++) {
        const quad_raw_cell *cell = &g->raw->cell[c];
        const entity *of = cell->group >= 0 ? &g->entity[cell->group] : NULL;
        for (int k = 0; of && k < of->count; k++) {
            /* A negative number marks a group whose orientation is reversed. */
            quad_raw_set *set = set_of(g, of->dimension, abs(of->physical[k]));
            const int64_t item = cell->corners == 1 ? cell->node[0] : (int64_t)c;
            if (!set || quad_raw_add_item(set, g->file, item) < 0)
                return -1;
        }
    }
    return 0;
}

/* ---- sections ---------------------------------------------------------- */

/* Finish a section: its end line must follow. */
static int end_section(gmsh *g, const char *end)
{
    quad_skip(g->file);
    if (quad_take_word(g->file, end))
        return 0;
    return quad_fault(g->file, "%s is expected here; the section before it is damaged", end);
}

static int read_names(gmsh *g)
{
    quad_file *file = g->file;
    const bool is_binary = file->is_binary;
    int count, dimension, tag;
    file->is_binary = false; /* names are text in a binary file too */
    if (quad_read_int(file, "the number of names", &count) < 0 ||
        quad_check_count(file, "names", count, 4) < 0)
        return -1;
    g->name = calloc((size_t)count + 1, sizeof *g->name);
    if (!g->name)
        return quad_fault(file, "the names do not fit into memory");
    for (g->names = 0; g->names < (size_t)count; g->names++) {
        if (quad_read_int(file, "the dimension of a group", &dimension) < 0 ||
            quad_read_int(file, "the number of a group", &tag) < 0)
            return -1;
        quad_skip(file);
        const char *open = file->text + file->at,
                   *line = memchr(open, '\n', file->bytes - file->at);
        const char *close = *open == '"' && line ? memchr(open + 1, '"', (size_t)(line - open)) : 0;
        if (!close)
            return quad_fault(file, "a name in double quotes is expected here");
        const physical_name one = {dimension, tag, open + 1, (size_t)(close - open) - 1};
        g->name[g->names] = one;
        file->at = (size_t)(close + 1 - file->text);
    }
    if (end_section(g, "$EndPhysicalNames") < 0)
        return -1;
    file->is_binary = is_binary;
    return 0;
}

/* Read numbers that are of no use: the corners of boxes, or the entities on a boundary. */
static int pass_reals(gmsh *g, int count)
{
    double unused;
    for (int i = 0; i < count; i++)
        if (quad_read_real(g->file, "the place of an entity", &unused) < 0)
            return -1;
    return 0;
}

static int pass_boundary(gmsh *g)
{
    int64_t count;
    int unused;
    if (quad_read_size(g->file, "the number of boundary entities", &count) < 0 ||
        quad_check_count(g->file, "boundary entities", count, 2) < 0)
        return -1;
    for (int64_t i = 0; i < count; i++)
        if (quad_read_int(g->file, "a boundary entity", &unused) < 0)
            return -1;
    return 0;
}

static int read_physicals(gmsh *g, entity *one)
{
    int64_t count;
    if (quad_read_size(g->file, "the number of physical groups", &count) < 0 ||
        quad_check_count(g->file, "physical groups", count, 2) < 0)
        return -1;
    one->physical = calloc((size_t)count + 1, sizeof *one->physical);
    if (!one->physical)
        return quad_fault(g->file, "the groups do not fit into memory");
    for (one->count = 0; one->count < count; one->count++)
        if (quad_read_int(g->file, "a physical group", &one->physical[one->count]) < 0)
            return -1;
    return 0;
}

static int read_entity(gmsh *g, int dimension)
{
    entity one = {dimension, 0, 0, NULL};
    int status = quad_read_int(g->file, "the number of an entity", &one.tag);
    if (status == 0)
        status = pass_reals(g, dimension == 0 ? 3 : 6);
    if (status == 0)
        status = read_physicals(g, &one);
    if (status == 0 && dimension > 0)
        status = pass_boundary(g);
    if (status == 0)
        status = add_entity(g, &one);
    if (status < 0)
        free(one.physical);
    return status;
}

static int read_entities(gmsh *g)
{
    int64_t count[4];
    for (int d = 0; d < 4; d++)
        if (quad_read_size(g->file, "a number of entities", &count[d]) < 0 ||
            quad_check_count(g->file, "entities", count[d], 8) < 0)
            return -1;
    for (int d = 0; d < 4; d++)
        for (int64_t i = 0; i < count[d]; i++)
            if (read_entity(g, d) < 0)
                return -1;
    return end_section(g, "$EndEntities");
}

/* ---- nodes ------------------------------------------------------------- */

static int read_place(gmsh *g, double x[3])
{
    for (int i = 0; i < 3; i++)
        if (quad_read_real(g->file, "a coordinate of a node", &x[i]) < 0)
            return -1;
    return 0;
}

static int read_nodes_2(gmsh *g)
{
    int count, label;
    const bool is_binary = g->file->is_binary;
    g->file->is_binary = false;
    if (quad_read_int(g->file, "the number of nodes", &count) < 0 ||
        quad_check_count(g->file, "nodes", count, 8) < 0)
        return -1;
    g->file->is_binary = is_binary;
    if (is_binary)
        g->file->at++; /* the line end */
    for (int i = 0; i < count; i++) {
        if (!is_binary)
            quad_skip(g->file);
        quad_raw_node node = {0, {0, 0, 0}, g->file->at};
        if (quad_read_int(g->file, "the number of a node", &label) < 0 || read_place(g, node.x) < 0)
            return -1;
        node.label = label;
        if (quad_raw_add_node(g->raw, g->file, &node) < 0)
            return -1;
    }
    return end_section(g, "$EndNodes");
}

/* Places of a block of nodes whose numbers have been read; parametric nodes have parameters too. */
static int read_places(gmsh *g, size_t first, int parameters)
{
    for (size_t i = first; i < g->raw->nodes; i++) {
        if (!g->file->is_binary)
            quad_skip(g->file);
        g->raw->node[i].at = g->file->at;
        if (read_place(g, g->raw->node[i].x) < 0 || pass_reals(g, parameters) < 0)
            return -1;
    }
    return 0;
}

static int read_node_block(gmsh *g)
{
    int dimension, tag, is_parametric;
    int64_t count;
    if (quad_read_int(g->file, "the dimension of a block", &dimension) < 0 ||
        quad_read_int(g->file, "the entity of a block", &tag) < 0 ||
        quad_read_int(g->file, "0 or 1 for parameters", &is_parametric) < 0 ||
        quad_read_size(g->file, "the number of nodes of a block", &count) < 0 ||
        quad_check_count(g->file, "nodes", count, 8) < 0)
        return -1;
    if (dimension < 0 || dimension > 3)
        return quad_fault(g->file, "a block of nodes has dimension %d; 0 to 3 is expected",
                          dimension);
    const size_t first = g->raw->nodes;
    for (int64_t i = 0; i < count; i++) {
        quad_raw_node node = {0, {0, 0, 0}, g->file->at};
        if (quad_read_size(g->file, "the number of a node", &node.label) < 0 ||
            quad_raw_add_node(g->raw, g->file, &node) < 0)
            return -1;
    }
    return read_places(g, first, is_parametric ? dimension : 0);
}

/* The head of $Nodes and $Elements of version 4.1: blocks, items, lowest and highest number. */
static int read_block_head(gmsh *g, const char *what, int64_t head[4])
{
    for (int i = 0; i < 4; i++)
        if (quad_read_size(g->file, "the head of a section", &head[i]) < 0)
            return -1;
    return quad_check_count(g->file, what, head[1], 8);
}

static int read_nodes_4(gmsh *g)
{
    int64_t head[4];
    if (read_block_head(g, "nodes", head) < 0)
        return -1;
    for (int64_t i = 0; i < head[0]; i++)
        if (read_node_block(g) < 0)
            return -1;
    if ((int64_t)g->raw->nodes != head[1])
        return quad_fault(g->file, "%lld nodes are announced, but the blocks hold %zu",
                          (long long)head[1], g->raw->nodes);
    return end_section(g, "$EndNodes");
}

/* ---- elements ---------------------------------------------------------- */

static int add_element(gmsh *g, const quad_raw_cell *cell)
{
    return quad_raw_add_cell(g->raw, g->file, cell);
}

/* One element of version 2.2 after its number: tags, then nodes. */
static int read_element_2(gmsh *g, quad_raw_cell *cell, int type, int tags)
{
    int tag, node, physical = 0;
    if (!is_usable(type))
        return refuse_shape(g, cell->at, cell->label, type);
    for (int k = 0; k < tags; k++) {
        if (quad_read_int(g->file, "a tag of an element", &tag) < 0)
            return -1;
        physical = k == 0 ? tag : physical;
    }
    cell->corners = shapes[type].nodes;
    for (int k = 0; k < cell->corners; k++) {
        if (quad_read_int(g->file, "a node of an element", &node) < 0)
            return -1;
        cell->node[k] = node;
    }
    cell->group = group_of(g, cell->corners / 2, physical);
    return cell->group == -2 ? -1 : add_element(g, cell);
}

/* Elements of version 2.2 in binary form come in blocks of one type. */
static int read_element_block_2(gmsh *g, int *left)
{
    int head[3], label;
    for (int k = 0; k < 3; k++)
        if (quad_read_int(g->file, "the head of a block of elements", &head[k]) < 0)
            return -1;
    if (head[1] < 1 || head[1] > *left || head[2] < 0 || head[2] > 100)
        return quad_fault(g->file, "a block has %d elements with %d tags; the file is damaged",
                          head[1], head[2]);
    for (int i = 0; i < head[1]; i++) {
        quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, -1, g->file->at};
        if (quad_read_int(g->file, "the number of an element", &label) < 0)
            return -1;
        cell.label = label;
        if (read_element_2(g, &cell, head[0], head[2]) < 0)
            return -1;
    }
    *left -= head[1];
    return 0;
}

static int read_text_element_2(gmsh *g)
{
    int head[3];
    quad_skip(g->file);
    quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, -1, g->file->at};
    for (int k = 0; k < 3; k++)
        if (quad_read_int(g->file, "the number, type and tags of an element", &head[k]) < 0)
            return -1;
    if (head[2] < 0 || head[2] > 100)
        return quad_fault(g->file, "an element has %d tags; the file is damaged", head[2]);
    cell.label = head[0];
    return read_element_2(g, &cell, head[1], head[2]);
}

static int read_elements_2(gmsh *g)
{
    const bool is_binary = g->file->is_binary;
    int left;
    g->file->is_binary = false;
    if (quad_read_int(g->file, "the number of elements", &left) < 0 ||
        quad_check_count(g->file, "elements", left, 8) < 0)
        return -1;
    g->file->is_binary = is_binary;
    if (is_binary)
        g->file->at++; /* the line end */
    while (is_binary && left > 0)
        if (read_element_block_2(g, &left) < 0)
            return -1;
    for (; left > 0; left--)
        if (read_text_element_2(g) < 0)
            return -1;
    return end_section(g, "$EndElements");
}

/* One element of version 4.1. */
static int read_element_4(gmsh *g, int type, int group)
{
    if (!g->file->is_binary)
        quad_skip(g->file);
    quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, group, g->file->at};
    if (quad_read_size(g->file, "the number of an element", &cell.label) < 0)
        return -1;
    if (!is_usable(type))
        return refuse_shape(g, cell.at, cell.label, type);
    cell.corners = shapes[type].nodes;
    for (int k = 0; k < cell.corners; k++)
        if (quad_read_size(g->file, "a node of an element", &cell.node[k]) < 0)
            return -1;
    return add_element(g, &cell);
}

static int read_element_block_4(gmsh *g)
{
    int head[3];
    int64_t count;
    for (int k = 0; k < 3; k++)
        if (quad_read_int(g->file, "the head of a block of elements", &head[k]) < 0)
            return -1;
    if (quad_read_size(g->file, "the number of elements of a block", &count) < 0 ||
        quad_check_count(g->file, "elements", count, 4) < 0)
        return -1;
    const int group = find_entity(g, head[0], head[1]);
    for (int64_t i = 0; i < count; i++)
        if (read_element_4(g, head[2], group) < 0)
            return -1;
    return 0;
}

static int read_elements_4(gmsh *g)
{
    int64_t head[4];
    if (read_block_head(g, "elements", head) < 0)
        return -1;
    for (int64_t i = 0; i < head[0]; i++)
        if (read_element_block_4(g) < 0)
            return -1;
    if ((int64_t)g->raw->cells != head[1])
        return quad_fault(g->file, "%lld elements are announced, but the blocks hold %zu",
                          (long long)head[1], g->raw->cells);
    return end_section(g, "$EndElements");
}

/* ---- the file ---------------------------------------------------------- */

/* The integer 1 that shows the byte order of a binary file. */
static int check_byte_order(gmsh *g)
{
    int one;
    g->file->is_binary = true;
    if (!quad_next_line(g->file) || quad_read_int(g->file, "the byte order", &one) < 0)
        return quad_fault(g->file, "the byte order is missing; export the mesh again");
    if (one == 1)
        return 0;
    return quad_fault(g->file,
                      "the file was written on a machine of another byte order (1 reads as "
                      "%d); save it as text: gmsh -save -format msh41",
                      one);
}

static int read_format(gmsh *g)
{
    double version;
    int is_binary, size;
    if (quad_read_real(g->file, "the version of the format", &version) < 0)
        return -1;
    if (version != 2.2 && version != 4.1)
        return quad_fault(g->file,
                          "MSH version %g; versions 2.2 and 4.1 are read: save with "
                          "gmsh -save -format msh41",
                          version);
    g->version = version > 3 ? 4 : 2;
    if (quad_read_int(g->file, "0 for text or 1 for binary", &is_binary) < 0 ||
        quad_read_int(g->file, "the size of a number", &size) < 0)
        return -1;
    if (size != 8 || is_binary < 0 || is_binary > 1)
        return quad_fault(g->file,
                          "numbers of %d bytes, file type %d; 8 bytes and type 0 or 1 are "
                          "read",
                          size, is_binary);
    if (is_binary && check_byte_order(g) < 0)
        return -1;
    return end_section(g, "$EndMeshFormat");
}

/* Skip a section that is of no use, up to its end line. */
static int skip_section(gmsh *g, const char *name, size_t length)
{
    char end[72];
    const int size = snprintf(end, sizeof end, "$End%.*s", (int)length, name);
    const char *text = g->file->text;
    const size_t start = g->file->at;
    for (size_t i = g->file->at; i + (size_t)size <= g->file->bytes; i++) {
        const char *found = memchr(text + i, '$', g->file->bytes - i - (size_t)size + 1);
        if (!found)
            break;
        i = (size_t)(found - text);
        g->file->at = i;
        if (quad_take_word(g->file, end))
            return 0;
    }
    return quad_fault_at(g->file, start, "%s is missing; the file is cut off, export it again",
                         end);
}

typedef struct section {
    const char *name;
    int (*read[2])(gmsh *g); /* versions 2.2 and 4.1; NULL: skipped */
} section;

/* Binary sections begin behind the line end of their name. */
static int read_section(gmsh *g, const section *one)
{
    int (*read)(gmsh * g) = one->read[g->version == 4];
    if (!g->has_nodes && read == read_elements_4)
        return quad_fault(g->file, "$Elements comes before $Nodes; export the mesh again");
    g->has_nodes |= read == read_nodes_2 || read == read_nodes_4;
    g->has_elements |= read == read_elements_2 || read == read_elements_4;
    if (g->file->is_binary)
        quad_next_line(g->file);
    return read(g);
}

static int read_any_section(gmsh *g)
{
    static const section sections[] = {{"$PhysicalNames", {read_names, read_names}},
                                       {"$Entities", {NULL, read_entities}},
                                       {"$Nodes", {read_nodes_2, read_nodes_4}},
                                       {"$Elements", {read_elements_2, read_elements_4}}};
    for (size_t k = 0; k < sizeof sections / sizeof *sections; k++)
        if (sections[k].read[g->version == 4] && quad_take_word(g->file, sections[k].name)) {
            if (k > 1 && (k == 2 ? g->has_nodes : g->has_elements))
                return quad_fault(g->file, "there are two sections %s; export one mesh",
                                  sections[k].name);
            return read_section(g, &sections[k]);
        }
    if (quad_take_word(g->file, "$PartitionedEntities"))
        return quad_fault(g->file, "the mesh is partitioned; save it with Mesh.NbPartitions = 0;");
    const char *name = g->file->text + g->file->at;
    size_t length = 0;
    while (length < 60 && name[length] > ' ')
        length++;
    if (name[0] != '$' || length < 2)
        return quad_fault(g->file, "a section as $Nodes is expected here; the file is damaged");
    return skip_section(g, name + 1, length - 1);
}

static int read_sections(gmsh *g)
{
    quad_file *file = g->file;
    quad_skip(file);
    if (!quad_take_word(file, "$MeshFormat"))
        return quad_fault(file, "a Gmsh file begins with $MeshFormat; save with gmsh -save -format "
                                "msh41");
    if (read_format(g) < 0)
        return -1;
    for (quad_skip(file); file->at < file->bytes; quad_skip(file))
        if (read_any_section(g) < 0)
            return -1;
    if (!g->has_nodes || !g->has_elements)
        return quad_fault(file, "the file has no section %s; export the mesh again",
                          g->has_nodes ? "$Elements" : "$Nodes");
    return collect_sets(g);
}

int quad_read_gmsh(quad_file *file, quad_raw *raw)
{
    gmsh g = {.file = file, .raw = raw};
    const int status = read_sections(&g);
    for (size_t i = 0; i < g.entities; i++)
        free(g.entity[i].physical);
    free(g.entity);
    free(g.name);
    return status;
}
