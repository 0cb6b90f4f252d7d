/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reader of Abaqus' and CalculiX' INP file format: *NODE, *ELEMENT, *NSET and *ELSET with GENERATE.
 * All other keywords are skipped. Upper and lower case of keywords and names of sets are not
 * distinguished.
 */
#include "quad_raw.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*
 * Members of a set in an INP file, given as the numbers first, first + step and so on up to last.
 */
typedef struct run {
    int64_t first, last, step;
    size_t at;
} run;

/*
 * Set of an INP file as the file lists it, before its numbers of nodes or elements are replaced by
 * indices.
 */
typedef struct listed_set {
    char name[64];
    bool is_elements;
    size_t runs, room;
    run *run;
} listed_set;

typedef enum inp_mode { SKIP, NODES, ELEMENTS, SET_MEMBERS } inp_mode;

typedef struct inp {
    quad_file *file;
    quad_raw *raw;
    inp_mode mode;
    int corners;    /* number of corners of the elements that are being read (in the reader's state
                       ELEMENTS) */
    bool generates; /* whether each line of the set that is being read gives first, last and step of
                       a run of numbers instead of single numbers (keyword option GENERATE) */
    int set; /* index of the set of the INP file whose members the present lines list; -1: they list
                no set */
    bool has_part; /* whether the keyword *PART of the INP file has been read */
    size_t sets, room;
    listed_set *list;
} inp;

/* ---- words ------------------------------------------------------------- */

static char upper(char character)
{
    return character >= 'a' && character <= 'z' ? (char)(character - 'a' + 'A') : character;
}

/* Return whether a text of a given length equals a word in capitals, without regard to case. */
static bool same_text(const char *first, size_t length, const char *second)
{
    if (strlen(second) != length)
        return false;
    for (size_t i = 0; i < length; i++)
        if (upper(first[i]) != upper(second[i]))
            return false;
    return true;
}

/*
 * Field of a line of an INP file: the text between two commas, without the blanks and quotes at its
 * ends.
 */
typedef struct piece {
    const char *text;
    size_t length;
} piece;

static bool is_margin(char character)
{
    return character == ' ' || character == '\t' || character == '\r' || character == '"';
}

static piece trimmed(const char *from, const char *to)
{
    while (from < to && is_margin(*from))
        from++;
    while (to > from && is_margin(to[-1]))
        to--;
    const piece one = {from, (size_t)(to - from)};
    return one;
}

/*
 * Read the next field of a line of an INP file; the reading position moves past its comma, or to
 * the line end. Returns whether there is a field.
 */
static bool next_piece(quad_file *file, piece *one)
{
    const char *from = file->text + file->at, *to = from;
    if (*from == '\n' || !*from)
        return false;
    while (*to && *to != ',' && *to != '\n')
        to++;
    *one = trimmed(from, to);
    file->at = (size_t)(to - file->text) + (*to == ',');
    return one->length > 0 || *to == ',';
}

/*
 * Return the value in a field of the form NAME=value in a line of an INP file, or an empty field if
 * the field has another name.
 */
static piece value_of(piece one, const char *name)
{
    const char *equals = memchr(one.text, '=', one.length);
    const piece none = {one.text, 0};
    if (!equals)
        return none;
    const piece key = trimmed(one.text, equals);
    return same_text(key.text, key.length, name) ? trimmed(equals + 1, one.text + one.length)
                                                 : none;
}

/* ---- numbers ----------------------------------------------------------- */

static int refuse_piece(const inp *in, piece one, const char *what)
{
    const size_t at = (size_t)(one.text - in->file->text);
    if (one.length == 0)
        return quad_fault_at(in->file, at, "nothing stands where %s is expected", what);
    return quad_fault_at(in->file, at, "'%.*s' stands where %s is expected",
                         one.length < 20 ? (int)one.length : 20, one.text, what);
}

static int integer_of(const inp *in, piece one, const char *what, int64_t *value)
{
    char *end;
    errno = 0;
    *value = strtoll(one.text, &end, 10);
    if (errno || one.length == 0 || end != one.text + one.length)
        return refuse_piece(in, one, what);
    return 0;
}

static int real_of(const inp *in, piece one, double *value)
{
    char *end;
    *value = strtod(one.text, &end);
    if (one.length == 0 || end != one.text + one.length)
        return refuse_piece(in, one, "a coordinate of a node");
    return 0;
}

/* ---- sets -------------------------------------------------------------- */

static int add_run(inp *in, int set, const run *one)
{
    listed_set *list = &in->list[set];
    if (list->runs == list->room) {
        const size_t room = 2 * list->room + 16;
        run *bigger = realloc(list->run, room * sizeof *bigger);
        if (!bigger)
            return quad_fault(in->file, "the sets do not fit into memory");
        list->run = bigger;
        list->room = room;
    }
    list->run[list->runs++] = *one;
    return 0;
}

static int find_listed(const inp *in, piece name, bool is_elements)
{
    for (size_t i = 0; i < in->sets; i++)
        if (in->list[i].is_elements == is_elements &&
            same_text(name.text, name.length, in->list[i].name))
            return (int)i;
    return -1;
}

/*
 * Return the index of the set with a given name among the sets of the INP file; a new set is added
 * if there is none. Returns -1 after writing an error message about the mesh file when memory runs
 * out.
 */
static int open_set(inp *in, piece name, bool is_elements)
{
    const int known = find_listed(in, name, is_elements);
    if (known >= 0)
        return known;
    if (name.length >= sizeof in->list->name)
        return quad_fault(in->file, "the name of a set has %zu bytes; use at most 63", name.length);
    if (in->sets >= QUAD_RAW_SETS)
        return quad_raw_refuse_sets(in->file);
    if (in->sets == in->room) {
        const size_t room = 2 * in->room + 16;
        listed_set *bigger = realloc(in->list, room * sizeof *bigger);
        if (!bigger)
            return quad_fault(in->file, "the sets do not fit into memory");
        in->list = bigger;
        in->room = room;
    }
    listed_set *fresh = &in->list[in->sets];
    memset(fresh, 0, sizeof *fresh);
    memcpy(fresh->name, name.text, name.length);
    fresh->is_elements = is_elements;
    return (int)in->sets++;
}

/*
 * Add one node or element to the set whose members the present keyword of the INP file lists, if it
 * lists a set. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int add_member(inp *in, int64_t label, size_t at)
{
    const run one = {label, label, 1, at};
    return in->set < 0 ? 0 : add_run(in, in->set, &one);
}

/*
 * Add the members of another set, which must have been defined before, to the set that is being
 * read from the INP file. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int add_other_set(inp *in, piece name)
{
    const int other = find_listed(in, name, in->list[in->set].is_elements);
    if (other < 0)
        return refuse_piece(in, name, "a number or the name of a set that is defined before");
    for (size_t i = 0, count = in->list[other].runs; i < count; i++) {
        const run one = in->list[other].run[i];
        if (other != in->set && add_run(in, in->set, &one) < 0)
            return -1;
    }
    return 0;
}

/* ---- data lines -------------------------------------------------------- */

static int node_line(inp *in)
{
    quad_raw_node node = {0, {0, 0, 0}, in->file->at};
    piece one;
    if (!next_piece(in->file, &one))
        return 0;
    if (integer_of(in, one, "the number of a node", &node.label) < 0)
        return -1;
    for (int i = 0; i < 3 && next_piece(in->file, &one); i++)
        if (real_of(in, one, &node.x[i]) < 0)
            return -1;
    if (add_member(in, node.label, node.at) < 0)
        return -1;
    return quad_raw_add_node(in->raw, in->file, &node);
}

/*
 * Read an element of the INP file; its nodes may continue in the next line if a line ends with a
 * comma. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int element_line(inp *in)
{
    quad_raw_cell cell = {0, {0, 0, 0, 0}, in->corners, -1, in->file->at};
    piece one;
    if (!next_piece(in->file, &one))
        return 0;
    if (integer_of(in, one, "the number of an element", &cell.label) < 0)
        return -1;
    for (int k = 0; k < cell.corners; k++) {
        if (!next_piece(in->file, &one) &&
            (!quad_next_line(in->file) || !next_piece(in->file, &one)))
            return quad_fault_at(in->file, cell.at, "element %lld has %d nodes; %d are expected",
                                 (long long)cell.label, k, cell.corners);
        if (integer_of(in, one, "a node of an element", &cell.node[k]) < 0)
            return -1;
    }
    if (add_member(in, cell.label, cell.at) < 0)
        return -1;
    return quad_raw_add_cell(in->raw, in->file, &cell);
}

static int generate_line(inp *in)
{
    run one = {0, 0, 1, in->file->at};
    int64_t *const value[3] = {&one.first, &one.last, &one.step};
    piece field;
    int count = 0;
    while (count < 3 && next_piece(in->file, &field))
        if (field.length == 0 || integer_of(in, field, "first, last or step", value[count++]) < 0)
            break;
    if (count < 2 || one.step < 1 || one.last < one.first)
        return quad_fault_at(in->file, one.at,
                             "GENERATE needs a line as 1, 9, 2 (first, last, "
                             "step) with last >= first and step >= 1");
    return add_run(in, in->set, &one);
}

static int member_line(inp *in)
{
    int64_t label;
    piece one;
    if (in->generates)
        return generate_line(in);
    while (next_piece(in->file, &one)) {
        const size_t at = (size_t)(one.text - in->file->text);
        const bool is_number = one.length > 0 && strchr("0123456789-+", *one.text);
        if (one.length == 0)
            continue;
        if (!is_number && add_other_set(in, one) < 0)
            return -1;
        if (is_number && (integer_of(in, one, "the number of a member", &label) < 0 ||
                          add_member(in, label, at) < 0))
            return -1;
    }
    return 0;
}

static int data_line(inp *in)
{
    switch (in->mode) {
    case NODES: return node_line(in);
    case ELEMENTS: return element_line(in);
    case SET_MEMBERS: return member_line(in);
    default: return 0;
    }
}

/* ---- keywords ---------------------------------------------------------- */

/*
 * Element types of the INP file format by the start of their names; the first row that fits is
 * used.
 */
static const struct {
    const char *start;
    int corners;
    const char *refused;
} element_types[] = {
    {"S4", 4, NULL},           {"M3D4", 4, NULL},         {"CPS4", 4, NULL},
    {"CPE4", 4, NULL},         {"T3D2", 2, NULL},         {"B31", 2, NULL},
    {"S3", 0, "a triangle"},   {"STRI", 0, "a triangle"}, {"CPS3", 0, "a triangle"},
    {"M3D3", 0, "a triangle"}, {"CPE3", 0, "a triangle"}, {"", 0, NULL}};

static int read_type(inp *in, piece type, size_t at)
{
    size_t k = 0;
    char upper_type[16] = "";
    for (size_t i = 0; i < type.length && i < sizeof upper_type - 1; i++)
        upper_type[i] = upper(type.text[i]);
    while (strncmp(upper_type, element_types[k].start, strlen(element_types[k].start)) != 0)
        k++;
    in->corners = element_types[k].corners;
    if (in->corners > 0)
        return 0;
    if (element_types[k].refused)
        return quad_fault_at(in->file, at,
                             "elements of type %s are triangles; quadrilaterals (S4, S4R) are "
                             "needed: in Gmsh set Mesh.RecombineAll = 1;",
                             upper_type);
    return quad_fault_at(in->file, at,
                         "elements of type '%s' are not read; shells of 4 nodes (S4, "
                         "S4R) are",
                         upper_type);
}

/* Options of a keyword of the INP file format, which end at the line end. */
typedef struct options {
    piece type, nset, elset;
    bool generates;
} options;

static options read_options(inp *in)
{
    const piece none = {in->file->text, 0};
    options found = {none, none, none, false};
    piece one;
    while (next_piece(in->file, &one)) {
        const piece type = value_of(one, "TYPE"), nset = value_of(one, "NSET"),
                    elset = value_of(one, "ELSET");
        found.type = type.length ? type : found.type;
        found.nset = nset.length ? nset : found.nset;
        found.elset = elset.length ? elset : found.elset;
        found.generates |= same_text(one.text, one.length, "GENERATE");
    }
    return found;
}

/*
 * Begin a set of nodes or elements of the INP file: by a keyword *NSET or *ELSET, or by the option
 * of *NODE or *ELEMENT that names a set. Returns 0, or -1 after writing an error message about the
 * mesh file.
 */
static int begin_set(inp *in, piece name, bool is_elements, bool is_needed, size_t at)
{
    in->set = -1;
    if (name.length == 0 && !is_needed)
        return 0;
    if (name.length == 0)
        return quad_fault_at(in->file, at, "a set needs a name; write %s=name",
                             is_elements ? "*ELSET, ELSET" : "*NSET, NSET");
    in->set = open_set(in, name, is_elements);
    return in->set < 0 ? -1 : 0;
}

static int begin_part(inp *in, size_t at)
{
    if (in->has_part)
        return quad_fault_at(in->file, at,
                             "there are two parts, whose numbers would clash; export "
                             "one part, or a flat file");
    in->has_part = true;
    return 0;
}

static int keyword_line(inp *in)
{
    const size_t at = in->file->at;
    piece word = {NULL, 0};
    next_piece(in->file, &word);
    const options options = read_options(in);
    in->mode = SKIP;
    if (same_text(word.text, word.length, "*NODE")) {
        in->mode = NODES;
        return begin_set(in, options.nset, false, false, at);
    }
    if (same_text(word.text, word.length, "*ELEMENT")) {
        in->mode = ELEMENTS;
        return begin_set(in, options.elset, true, false, at) < 0 ? -1
                                                                 : read_type(in, options.type, at);
    }
    in->generates = options.generates;
    if (same_text(word.text, word.length, "*NSET")) {
        in->mode = SET_MEMBERS;
        return begin_set(in, options.nset, false, true, at);
    }
    if (same_text(word.text, word.length, "*ELSET")) {
        in->mode = SET_MEMBERS;
        return begin_set(in, options.elset, true, true, at);
    }
    if (same_text(word.text, word.length, "*INCLUDE"))
        return quad_fault_at(in->file, at, "*INCLUDE is not followed; paste the file in its place");
    return same_text(word.text, word.length, "*PART") ? begin_part(in, at) : 0;
}

/* ---- sets by number ---------------------------------------------------- */

/*
 * Number of a node or element in the INP file, with its index in the contents that were read: index
 * of the node, or of the cell (point, edge or quadrilateral) for an element.
 */
typedef struct numbered {
    int64_t label, index;
} numbered;

static int by_label(const void *left, const void *right)
{
    const numbered *first = left, *second = right;
    return (first->label > second->label) - (first->label < second->label);
}

/*
 * Return the index of the first entry, in a list sorted by the numbers of nodes or elements, whose
 * number is at least `label`.
 */
static size_t lower_bound(const numbered *entry, size_t count, int64_t label)
{
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (entry[middle].label < label)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/*
 * Add those members of a run of numbers (first, first + step, ... last) that exist in the file to
 * the sets of the mesh. Numbers that do not exist are skipped, but it is an error if a run with
 * first = last does not exist. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int take_run(inp *in, const listed_set *from, const run *one, const numbered *entry,
                    size_t count)
{
    size_t i = lower_bound(entry, count, one->first);
    if (one->first == one->last && (i == count || entry[i].label != one->first))
        return quad_fault_at(
            in->file, one->at, "set '%s' has %s %lld, which the file does not define; remove it",
            from->name, from->is_elements ? "element" : "node", (long long)one->first);
    for (; i < count && entry[i].label <= one->last; i++) {
        if ((entry[i].label - one->first) % one->step != 0)
            continue;
        const int corners = from->is_elements ? in->raw->cell[entry[i].index].corners : 0;
        quad_raw_set *set =
            quad_raw_find_set(in->raw, in->file, from->name, strlen(from->name), corners);
        if (!set || quad_raw_add_item(set, in->file,
                                      from->is_elements ? entry[i].index : entry[i].label) < 0)
            return -1;
    }
    return 0;
}

static int collect_kind(inp *in, bool is_elements)
{
    const size_t count = is_elements ? in->raw->cells : in->raw->nodes;
    numbered *entry = calloc(count + 1, sizeof *entry);
    int status = 0;
    if (!entry)
        return quad_fault(in->file, "the sets do not fit into memory");
    for (size_t i = 0; i < count; i++) {
        entry[i].label = is_elements ? in->raw->cell[i].label : in->raw->node[i].label;
        entry[i].index = (int64_t)i;
    }
    qsort(entry, count, sizeof *entry, by_label);
    for (size_t k = 0; k < in->sets && status == 0; k++)
        for (size_t i = 0; i < in->list[k].runs && status == 0; i++)
            if (in->list[k].is_elements == is_elements)
                status = take_run(in, &in->list[k], &in->list[k].run[i], entry, count);
    free(entry);
    return status;
}

/* ---- the file ---------------------------------------------------------- */

static int read_lines(inp *in)
{
    quad_file *file = in->file;
    do {
        while (file->text[file->at] == ' ' || file->text[file->at] == '\t')
            file->at++;
        if (file->at >= file->bytes)
            break;
        if (file->text[file->at] != '*') {
            if (data_line(in) < 0)
                return -1;
        } else if (file->text[file->at + 1] != '*' && keyword_line(in) < 0) {
            return -1;
        }
    } while (quad_next_line(file));
    if (in->raw->nodes == 0)
        return quad_fault(file, "the file defines no node: no numbers follow a line *NODE; export "
                                "the mesh again, with its nodes");
    if (in->raw->cells == 0)
        return quad_fault(file, "the file defines no element: no numbers follow a line *ELEMENT; "
                                "export the mesh again, with its elements");
    return collect_kind(in, false) < 0 ? -1 : collect_kind(in, true);
}

int quad_read_inp(quad_file *file, quad_raw *raw)
{
    inp in = {.file = file, .raw = raw, .set = -1};
    const int status = read_lines(&in);
    for (size_t k = 0; k < in.sets; k++)
        free(in.list[k].run);
    free(in.list);
    return status;
}
