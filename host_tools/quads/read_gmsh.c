/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reader of Gmsh's MSH file format, versions 2.2 and 4.1, text and binary. Physical groups become
 * sets; a group without a name is named by its number.
 */
#include "quad_raw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*
 * Geometric entity of a Gmsh file with its physical groups; in version 2.2 every physical group has
 * one entity of its own.
 */
typedef struct entity {
    int dimension, tag, count;
    int *physical; /* [count] numbers of the physical groups to which the geometric entity of the
                      Gmsh file belongs */
    size_t *set;   /* [count] indices of the sets of the entity's physical groups; NULL until the
                      first cell (point, edge or quadrilateral) of the entity is added to them */
} entity;

typedef struct physical_name {
    int dimension, tag;
    const char *text; /* name of a physical group, a part of the text of the Gmsh file; not
                         terminated by NUL */
    size_t length;
} physical_name;

typedef struct gmsh {
    quad_file *file;
    quad_raw *raw;
    int version; /* version of the Gmsh file format, 2 or 4 */
    size_t entities, entity_room, names, name_room;
    entity *entity;
    physical_name *name;
    bool has_nodes, has_elements;
} gmsh;

/* ---- shapes of elements ------------------------------------------------ */

enum { POINT = 15, EDGE = 1, TRIANGLE = 2, QUADRILATERAL = 3 };

/*
 * Number of nodes of each element type of a Gmsh file. Types that this reader refuses also have a
 * name, for the error message.
 */
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

static int refuse_shape(const gmsh *gmsh, size_t at, int64_t label, int type)
{
    const int known = (int)(sizeof shapes / sizeof *shapes);
    char text[40];
    if (type == TRIANGLE)
        return quad_raw_refuse_triangle(gmsh->file, at, label);
    if (type > 0 && type < known && shapes[type].refused)
        return quad_raw_refuse_shape(gmsh->file, at, label, shapes[type].refused);
    snprintf(text, sizeof text, "of Gmsh's type %d", type);
    return quad_raw_refuse_shape(gmsh->file, at, label, text);
}

static bool is_usable(int type)
{
    return type == POINT || type == EDGE || type == QUADRILATERAL;
}

/* ---- entities and groups ----------------------------------------------- */

static int add_entity(gmsh *gmsh, const entity *one)
{
    if (gmsh->entities == gmsh->entity_room) {
        const size_t room = 2 * gmsh->entity_room + 16;
        entity *bigger = realloc(gmsh->entity, room * sizeof *bigger);
        if (!bigger)
            return quad_fault(gmsh->file, "the entities do not fit into memory");
        gmsh->entity = bigger;
        gmsh->entity_room = room;
    }
    gmsh->entity[gmsh->entities++] = *one;
    return 0;
}

/*
 * Return the index of the geometric entity with a given dimension and number, or -1 if there is
 * none.
 */
static int find_entity(const gmsh *gmsh, int dimension, int tag)
{
    for (size_t i = 0; i < gmsh->entities; i++)
        if (gmsh->entity[i].dimension == dimension && gmsh->entity[i].tag == tag)
            return (int)i;
    return -1;
}

/*
 * A Gmsh file of version 2.2 has physical groups, but no geometric entities. Each physical group
 * therefore gets an entry of its own in the list of entities (gmsh->entity), when the group first
 * occurs. Return the index of this entry; -1 for group 0 (none); -2 after writing an error message
 * about the mesh file.
 */
static int group_of(gmsh *gmsh, int dimension, int physical)
{
    const int known = find_entity(gmsh, dimension, physical);
    if (known >= 0 || physical == 0)
        return known;
    if (gmsh->entities >= QUAD_RAW_SETS) {
        quad_raw_refuse_sets(gmsh->file);
        return -2;
    }
    entity one = {dimension, physical, 1, malloc(sizeof *one.physical), NULL};
    if (!one.physical) {
        quad_fault(gmsh->file, "the entities do not fit into memory");
        return -2;
    }
    one.physical[0] = physical;
    if (add_entity(gmsh, &one) == 0)
        return (int)gmsh->entities - 1;
    free(one.physical);
    return -2;
}

/*
 * Return the set of a physical group of points (dimension 0), edges (1) or quadrilaterals (2), or
 * NULL after writing an error message about the mesh file.
 */
static quad_raw_set *set_of(gmsh *gmsh, int dimension, int tag)
{
    static const int corners[3] = {0, 2, 4};
    char number[16];
    for (size_t i = 0; i < gmsh->names; i++)
        if (gmsh->name[i].dimension == dimension && gmsh->name[i].tag == tag)
            return quad_raw_find_set(gmsh->raw, gmsh->file, gmsh->name[i].text,
                                     gmsh->name[i].length, corners[dimension]);
    const int length = snprintf(number, sizeof number, "%d", tag);
    return quad_raw_find_set(gmsh->raw, gmsh->file, number, (size_t)length, corners[dimension]);
}

/*
 * Find the sets of all physical groups of a geometric entity. A negative number of a group stands
 * for the group with reversed orientation. Returns 0, or -1 after writing an error message about
 * the mesh file.
 */
static int name_sets(gmsh *gmsh, entity *of)
{
    of->set = calloc((size_t)of->count + 1, sizeof *of->set);
    if (!of->set)
        return quad_fault(gmsh->file, "the sets do not fit into memory");
    for (int k = 0; k < of->count; k++) {
        const quad_raw_set *set = set_of(gmsh, of->dimension, abs(of->physical[k]));
        if (!set)
            return -1;
        of->set[k] = (size_t)(set - gmsh->raw->set);
    }
    return 0;
}

/*
 * Add every cell (point, edge or quadrilateral) of the Gmsh file to the sets of its physical
 * groups. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int collect_sets(gmsh *gmsh)
{
    for (size_t index = 0; index < gmsh->raw->cells; index++) {
        const quad_raw_cell *cell = &gmsh->raw->cell[index];
        entity *of = cell->group >= 0 ? &gmsh->entity[cell->group] : NULL;
        if (of && !of->set && name_sets(gmsh, of) < 0)
            return -1;
        for (int k = 0; of && k < of->count; k++) {
            const int64_t item = cell->corners == 1 ? cell->node[0] : (int64_t)index;
            if (quad_raw_add_item(&gmsh->raw->set[of->set[k]], gmsh->file, item) < 0)
                return -1;
        }
    }
    return 0;
}

/* ---- sections ---------------------------------------------------------- */

/*
 * Check that the line that ends a section of the Gmsh file follows. Returns 0, or -1 after writing
 * an error message about the mesh file.
 */
static int end_section(gmsh *gmsh, const char *end)
{
    quad_skip(gmsh->file);
    if (quad_take_word(gmsh->file, end))
        return 0;
    return quad_fault(gmsh->file, "%s is expected here; the section before it is damaged", end);
}

static int read_names(gmsh *gmsh)
{
    quad_file *file = gmsh->file;
    const bool is_binary = file->is_binary;
    int count, dimension, tag;
    file->is_binary = false; /* The section $PhysicalNames of a Gmsh file is text even if the file
                                is binary. */
    if (quad_read_int(file, "the number of names", &count) < 0 ||
        quad_check_count(file, "names", count, 4) < 0)
        return -1;
    if (count > QUAD_RAW_SETS)
        return quad_raw_refuse_sets(file);
    gmsh->name = calloc((size_t)count + 1, sizeof *gmsh->name);
    if (!gmsh->name)
        return quad_fault(file, "the names do not fit into memory");
    for (gmsh->names = 0; gmsh->names < (size_t)count; gmsh->names++) {
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
        gmsh->name[gmsh->names] = one;
        file->at = (size_t)(close + 1 - file->text);
    }
    if (end_section(gmsh, "$EndPhysicalNames") < 0)
        return -1;
    file->is_binary = is_binary;
    return 0;
}

/*
 * Skip numbers of a Gmsh file that are not needed: bounding boxes (pass_reals), or entities on a
 * boundary (pass_boundary). Returns 0, or -1 after writing an error message about the mesh file.
 */
static int pass_reals(gmsh *gmsh, int count)
{
    double unused;
    for (int i = 0; i < count; i++)
        if (quad_read_real(gmsh->file, "the place of an entity", &unused) < 0)
            return -1;
    return 0;
}

static int pass_boundary(gmsh *gmsh)
{
    int64_t count;
    int unused;
    if (quad_read_size(gmsh->file, "the number of boundary entities", &count) < 0 ||
        quad_check_count(gmsh->file, "boundary entities", count, 2) < 0)
        return -1;
    for (int64_t i = 0; i < count; i++)
        if (quad_read_int(gmsh->file, "a boundary entity", &unused) < 0)
            return -1;
    return 0;
}

static int read_physicals(gmsh *gmsh, entity *one)
{
    int64_t count;
    if (quad_read_size(gmsh->file, "the number of physical groups", &count) < 0 ||
        quad_check_count(gmsh->file, "physical groups", count, 2) < 0)
        return -1;
    one->physical = calloc((size_t)count + 1, sizeof *one->physical);
    if (!one->physical)
        return quad_fault(gmsh->file, "the groups do not fit into memory");
    for (one->count = 0; one->count < count; one->count++)
        if (quad_read_int(gmsh->file, "a physical group", &one->physical[one->count]) < 0)
            return -1;
    return 0;
}

static int read_entity(gmsh *gmsh, int dimension)
{
    entity one = {dimension, 0, 0, NULL, NULL};
    int status = quad_read_int(gmsh->file, "the number of an entity", &one.tag);
    if (status == 0)
        status = pass_reals(gmsh, dimension == 0 ? 3 : 6);
    if (status == 0)
        status = read_physicals(gmsh, &one);
    if (status == 0 && dimension > 0)
        status = pass_boundary(gmsh);
    if (status == 0)
        status = add_entity(gmsh, &one);
    if (status < 0)
        free(one.physical);
    return status;
}

static int read_entities(gmsh *gmsh)
{
    int64_t count[4];
    for (int dimension = 0; dimension < 4; dimension++)
        if (quad_read_size(gmsh->file, "a number of entities", &count[dimension]) < 0 ||
            quad_check_count(gmsh->file, "entities", count[dimension], 8) < 0)
            return -1;
    for (int dimension = 0; dimension < 4; dimension++)
        for (int64_t i = 0; i < count[dimension]; i++)
            if (read_entity(gmsh, dimension) < 0)
                return -1;
    return end_section(gmsh, "$EndEntities");
}

/* ---- nodes ------------------------------------------------------------- */

static int read_place(gmsh *gmsh, double x[3])
{
    for (int i = 0; i < 3; i++)
        if (quad_read_real(gmsh->file, "a coordinate of a node", &x[i]) < 0)
            return -1;
    return 0;
}

static int read_nodes_2(gmsh *gmsh)
{
    int count, label;
    const bool is_binary = gmsh->file->is_binary;
    gmsh->file->is_binary = false;
    if (quad_read_int(gmsh->file, "the number of nodes", &count) < 0 ||
        quad_check_count(gmsh->file, "nodes", count, 8) < 0)
        return -1;
    gmsh->file->is_binary = is_binary;
    if (is_binary)
        gmsh->file->at++; /* In a binary Gmsh file one line end separates the number of nodes from
                             the binary data. */
    for (int i = 0; i < count; i++) {
        if (!is_binary)
            quad_skip(gmsh->file);
        quad_raw_node node = {0, {0, 0, 0}, gmsh->file->at};
        if (quad_read_int(gmsh->file, "the number of a node", &label) < 0 ||
            read_place(gmsh, node.x) < 0)
            return -1;
        node.label = label;
        if (quad_raw_add_node(gmsh->raw, gmsh->file, &node) < 0)
            return -1;
    }
    return end_section(gmsh, "$EndNodes");
}

/*
 * Read the positions of a block of nodes whose numbers have been read; `parameters` is the number
 * of surface parameters after each position, which are skipped. Returns 0, or -1 after writing an
 * error message about the mesh file.
 */
static int read_places(gmsh *gmsh, size_t first, int parameters)
{
    for (size_t i = first; i < gmsh->raw->nodes; i++) {
        if (!gmsh->file->is_binary)
            quad_skip(gmsh->file);
        gmsh->raw->node[i].at = gmsh->file->at;
        if (read_place(gmsh, gmsh->raw->node[i].x) < 0 || pass_reals(gmsh, parameters) < 0)
            return -1;
    }
    return 0;
}

static int read_node_block(gmsh *gmsh)
{
    int dimension, tag, is_parametric;
    int64_t count;
    if (quad_read_int(gmsh->file, "the dimension of a block", &dimension) < 0 ||
        quad_read_int(gmsh->file, "the entity of a block", &tag) < 0 ||
        quad_read_int(gmsh->file, "0 or 1 for parameters", &is_parametric) < 0 ||
        quad_read_size(gmsh->file, "the number of nodes of a block", &count) < 0 ||
        quad_check_count(gmsh->file, "nodes", count, 8) < 0)
        return -1;
    if (dimension < 0 || dimension > 3)
        return quad_fault(gmsh->file, "a block of nodes has dimension %d; 0 to 3 is expected",
                          dimension);
    const size_t first = gmsh->raw->nodes;
    for (int64_t i = 0; i < count; i++) {
        quad_raw_node node = {0, {0, 0, 0}, gmsh->file->at};
        if (quad_read_size(gmsh->file, "the number of a node", &node.label) < 0 ||
            quad_raw_add_node(gmsh->raw, gmsh->file, &node) < 0)
            return -1;
    }
    return read_places(gmsh, first, is_parametric ? dimension : 0);
}

/*
 * Function that reads the next block of a section of the Gmsh file. Returns 0, or -1 after writing
 * an error message about the mesh file.
 */
typedef int read_block(gmsh *gmsh);

/*
 * Read a section of a Gmsh file of version 4.1 that consists of blocks: numbers of blocks and
 * items, lowest and highest number of an item, then the blocks.
 *   what   in  name of the items in messages
 *   found  in  number of items that have been read, which grows with each block
 * Returns 0, or -1 after writing an error message about the mesh file.
 */
static int read_blocks(gmsh *gmsh, const char *what, read_block *read, const size_t *found)
{
    int64_t head[4];
    for (int i = 0; i < 4; i++)
        if (quad_read_size(gmsh->file, "the head of a section", &head[i]) < 0)
            return -1;
    if (quad_check_count(gmsh->file, what, head[1], 8) < 0)
        return -1;
    for (int64_t i = 0; i < head[0]; i++)
        if (read(gmsh) < 0)
            return -1;
    if ((int64_t)*found != head[1])
        return quad_fault(gmsh->file, "%lld %s are announced, but the blocks hold %zu",
                          (long long)head[1], what, *found);
    return 0;
}

static int read_nodes_4(gmsh *gmsh)
{
    if (read_blocks(gmsh, "nodes", read_node_block, &gmsh->raw->nodes) < 0)
        return -1;
    return end_section(gmsh, "$EndNodes");
}

/* ---- elements ---------------------------------------------------------- */

static int add_element(gmsh *gmsh, const quad_raw_cell *cell)
{
    return quad_raw_add_cell(gmsh->raw, gmsh->file, cell);
}

/*
 * Read an element of a Gmsh file of version 2.2, whose number has been read: first its tags, then
 * its nodes. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int read_element_2(gmsh *gmsh, quad_raw_cell *cell, int type, int tags)
{
    int tag, node, physical = 0;
    if (!is_usable(type))
        return refuse_shape(gmsh, cell->at, cell->label, type);
    for (int k = 0; k < tags; k++) {
        if (quad_read_int(gmsh->file, "a tag of an element", &tag) < 0)
            return -1;
        physical = k == 0 ? tag : physical;
    }
    cell->corners = shapes[type].nodes;
    for (int k = 0; k < cell->corners; k++) {
        if (quad_read_int(gmsh->file, "a node of an element", &node) < 0)
            return -1;
        cell->node[k] = node;
    }
    cell->group = group_of(gmsh, cell->corners / 2, physical);
    return cell->group == -2 ? -1 : add_element(gmsh, cell);
}

/*
 * Read a block of elements of one type from a binary Gmsh file of version 2.2; `left` is the number
 * of elements still to be read. Returns 0, or -1 after writing an error message about the mesh
 * file.
 */
static int read_element_block_2(gmsh *gmsh, int *left)
{
    int head[3], label;
    for (int k = 0; k < 3; k++)
        if (quad_read_int(gmsh->file, "the head of a block of elements", &head[k]) < 0)
            return -1;
    if (head[1] < 1 || head[1] > *left || head[2] < 0 || head[2] > 100)
        return quad_fault(gmsh->file, "a block has %d elements with %d tags; the file is damaged",
                          head[1], head[2]);
    for (int i = 0; i < head[1]; i++) {
        quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, -1, gmsh->file->at};
        if (quad_read_int(gmsh->file, "the number of an element", &label) < 0)
            return -1;
        cell.label = label;
        if (read_element_2(gmsh, &cell, head[0], head[2]) < 0)
            return -1;
    }
    *left -= head[1];
    return 0;
}

static int read_text_element_2(gmsh *gmsh)
{
    int head[3];
    quad_skip(gmsh->file);
    quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, -1, gmsh->file->at};
    for (int k = 0; k < 3; k++)
        if (quad_read_int(gmsh->file, "the number, type and tags of an element", &head[k]) < 0)
            return -1;
    if (head[2] < 0 || head[2] > 100)
        return quad_fault(gmsh->file, "an element has %d tags; the file is damaged", head[2]);
    cell.label = head[0];
    return read_element_2(gmsh, &cell, head[1], head[2]);
}

static int read_elements_2(gmsh *gmsh)
{
    const bool is_binary = gmsh->file->is_binary;
    int left;
    gmsh->file->is_binary = false;
    if (quad_read_int(gmsh->file, "the number of elements", &left) < 0 ||
        quad_check_count(gmsh->file, "elements", left, 8) < 0)
        return -1;
    gmsh->file->is_binary = is_binary;
    if (is_binary)
        gmsh->file->at++; /* In a binary Gmsh file one line end separates the number of elements
                             from the binary data. */
    while (is_binary && left > 0)
        if (read_element_block_2(gmsh, &left) < 0)
            return -1;
    for (; left > 0; left--)
        if (read_text_element_2(gmsh) < 0)
            return -1;
    return end_section(gmsh, "$EndElements");
}

/*
 * Read an element of a Gmsh file of version 4.1. Returns 0, or -1 after writing an error message
 * about the mesh file.
 */
static int read_element_4(gmsh *gmsh, int type, int group)
{
    if (!gmsh->file->is_binary)
        quad_skip(gmsh->file);
    quad_raw_cell cell = {0, {0, 0, 0, 0}, 0, group, gmsh->file->at};
    if (quad_read_size(gmsh->file, "the number of an element", &cell.label) < 0)
        return -1;
    if (!is_usable(type))
        return refuse_shape(gmsh, cell.at, cell.label, type);
    cell.corners = shapes[type].nodes;
    for (int k = 0; k < cell.corners; k++)
        if (quad_read_size(gmsh->file, "a node of an element", &cell.node[k]) < 0)
            return -1;
    return add_element(gmsh, &cell);
}

static int read_element_block_4(gmsh *gmsh)
{
    int head[3];
    int64_t count;
    for (int k = 0; k < 3; k++)
        if (quad_read_int(gmsh->file, "the head of a block of elements", &head[k]) < 0)
            return -1;
    if (quad_read_size(gmsh->file, "the number of elements of a block", &count) < 0 ||
        quad_check_count(gmsh->file, "elements", count, 4) < 0)
        return -1;
    const int group = find_entity(gmsh, head[0], head[1]);
    for (int64_t i = 0; i < count; i++)
        if (read_element_4(gmsh, head[2], group) < 0)
            return -1;
    return 0;
}

static int read_elements_4(gmsh *gmsh)
{
    if (read_blocks(gmsh, "elements", read_element_block_4, &gmsh->raw->cells) < 0)
        return -1;
    return end_section(gmsh, "$EndElements");
}

/* ---- the file ---------------------------------------------------------- */

/*
 * Check that the integer 1 in the head of a binary Gmsh file has the byte order of this machine.
 * Returns 0, or -1 after writing an error message about the mesh file.
 */
static int check_byte_order(gmsh *gmsh)
{
    int one;
    gmsh->file->is_binary = true;
    if (!quad_next_line(gmsh->file) || quad_read_int(gmsh->file, "the byte order", &one) < 0)
        return quad_fault(gmsh->file, "the byte order is missing; export the mesh again");
    if (one == 1)
        return 0;
    return quad_fault(gmsh->file,
                      "the file was written on a machine of another byte order (1 reads as "
                      "%d); save it as text: gmsh -save -format msh41",
                      one);
}

static int read_format(gmsh *gmsh)
{
    double version;
    int is_binary, size;
    if (quad_read_real(gmsh->file, "the version of the format", &version) < 0)
        return -1;
    if (version != 2.2 && version != 4.1)
        return quad_fault(gmsh->file,
                          "MSH version %g; versions 2.2 and 4.1 are read: save with "
                          "gmsh -save -format msh41",
                          version);
    gmsh->version = version > 3 ? 4 : 2;
    if (quad_read_int(gmsh->file, "0 for text or 1 for binary", &is_binary) < 0 ||
        quad_read_int(gmsh->file, "the size of a number", &size) < 0)
        return -1;
    if (size != 8 || is_binary < 0 || is_binary > 1)
        return quad_fault(gmsh->file,
                          "numbers of %d bytes, file type %d; 8 bytes and type 0 or 1 are "
                          "read",
                          size, is_binary);
    if (is_binary && check_byte_order(gmsh) < 0)
        return -1;
    return end_section(gmsh, "$EndMeshFormat");
}

/*
 * Skip a section of a Gmsh file that is not needed, up to the line that ends it. Returns 0, or -1
 * after writing an error message about the mesh file.
 */
static int skip_section(gmsh *gmsh, const char *name, size_t length)
{
    char end[72];
    const int size = snprintf(end, sizeof end, "$End%.*s", (int)length, name);
    const char *text = gmsh->file->text;
    const size_t start = gmsh->file->at;
    for (size_t i = gmsh->file->at; i + (size_t)size <= gmsh->file->bytes; i++) {
        const char *found = memchr(text + i, '$', gmsh->file->bytes - i - (size_t)size + 1);
        if (!found)
            break;
        i = (size_t)(found - text);
        gmsh->file->at = i;
        if (quad_take_word(gmsh->file, end))
            return 0;
    }
    return quad_fault_at(gmsh->file, start, "%s is missing; the file is cut off, export it again",
                         end);
}

typedef struct section {
    const char *name;
    int (*read[2])(gmsh *gmsh); /* functions that read a section of a Gmsh file of version 2.2 and
                                   of version 4.1; NULL: the section is skipped */
} section;

/*
 * Read a section of a Gmsh file. In a binary file the section begins after the line end of its
 * name.
 */
static int read_section(gmsh *gmsh, const section *one)
{
    int (*read)(struct gmsh *) = one->read[gmsh->version == 4];
    if (!gmsh->has_nodes && read == read_elements_4)
        return quad_fault(gmsh->file, "$Elements comes before $Nodes; export the mesh again");
    gmsh->has_nodes |= read == read_nodes_2 || read == read_nodes_4;
    gmsh->has_elements |= read == read_elements_2 || read == read_elements_4;
    if (gmsh->file->is_binary)
        quad_next_line(gmsh->file);
    return read(gmsh);
}

static int read_any_section(gmsh *gmsh)
{
    static const section sections[] = {{"$PhysicalNames", {read_names, read_names}},
                                       {"$Entities", {NULL, read_entities}},
                                       {"$Nodes", {read_nodes_2, read_nodes_4}},
                                       {"$Elements", {read_elements_2, read_elements_4}}};
    for (size_t k = 0; k < sizeof sections / sizeof *sections; k++)
        if (sections[k].read[gmsh->version == 4] && quad_take_word(gmsh->file, sections[k].name)) {
            if (k > 1 && (k == 2 ? gmsh->has_nodes : gmsh->has_elements))
                return quad_fault(gmsh->file, "there are two sections %s; export one mesh",
                                  sections[k].name);
            return read_section(gmsh, &sections[k]);
        }
    if (quad_take_word(gmsh->file, "$PartitionedEntities"))
        return quad_fault(gmsh->file,
                          "the mesh is partitioned; save it with Mesh.NbPartitions = 0;");
    const char *name = gmsh->file->text + gmsh->file->at;
    size_t length = 0;
    while (length < 60 && name[length] > ' ')
        length++;
    if (name[0] != '$' || length < 2)
        return quad_fault(gmsh->file, "a section as $Nodes is expected here; the file is damaged");
    return skip_section(gmsh, name + 1, length - 1);
}

static int read_sections(gmsh *gmsh)
{
    quad_file *file = gmsh->file;
    quad_skip(file);
    if (!quad_take_word(file, "$MeshFormat"))
        return quad_fault(file, "a Gmsh file begins with $MeshFormat; save with gmsh -save -format "
                                "msh41");
    if (read_format(gmsh) < 0)
        return -1;
    for (quad_skip(file); file->at < file->bytes; quad_skip(file))
        if (read_any_section(gmsh) < 0)
            return -1;
    if (!gmsh->has_nodes || !gmsh->has_elements)
        return quad_fault(file, "the file has no section %s; export the mesh again",
                          gmsh->has_nodes ? "$Elements" : "$Nodes");
    return collect_sets(gmsh);
}

int quad_read_gmsh(quad_file *file, quad_raw *raw)
{
    gmsh gmsh = {.file = file, .raw = raw};
    const int status = read_sections(&gmsh);
    for (size_t i = 0; i < gmsh.entities; i++) {
        free(gmsh.entity[i].set);
        free(gmsh.entity[i].physical);
    }
    free(gmsh.entity);
    free(gmsh.name);
    return status;
}
