/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of a scene whose mesh of quadrilaterals comes from a file: the keys of the section `mesh`
 * beside `file`, and the sets of elements, edges and nodes of the mesh file that other sections
 * name (scene_parts.h).
 */
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scene_file.h"
#include "scene_units.h"

enum { LIST = 200 };

/* ---- vectors ----------------------------------------------------------- */

int read_vector(reader *reader, int node, void *to, const void *rule)
{
    double *vector = to;
    int i;
    (void)rule;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count != 3)
        return tree_fault(reader->t, node, "'%.60s' has %d values; give three, [x, y, z]",
                          tree_name(reader->t, node), reader->t->node[node].count);
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_real(reader, i, vector++, NULL) != 0)
            return -1;
    return 0;
}

int read_unit(reader *reader, int node, void *to, const void *rule)
{
    double *vector = to, length;
    int i;
    if (read_vector(reader, node, vector, rule) != 0)
        return -1;
    length = hypot(hypot(vector[0], vector[1]), vector[2]);
    if (length == 0)
        return tree_fault(reader->t, node, "'%.60s: [0, 0, 0]' has no direction; give one",
                          tree_name(reader->t, node));
    for (i = 0; i < 3; i++)
        vector[i] /= length;
    return 0;
}

/* ---- the section mesh -------------------------------------------------- */

typedef struct file_text {
    char *file;
    double unit;
    bool flip, accept_irregular;
} file_text;

/*
 * Read the unit of length of a mesh file; the result is the factor that converts coordinates of the
 * file to the scene's unit of length.
 */
static int read_unit_name(reader *reader, int node, void *to, const void *rule)
{
    static const units_unit length = {{1, 0, 0, 0, 0, 0}, 0, 0};
    const char *const text = node_text(reader, node);
    const char *why = "a name as mm or m is expected";
    units_unit unit;
    int ten;
    (void)rule;
    if (!text || units_parse(text, &unit, &why) < 0 || !units_alike(&unit, &length))
        return tree_fault(reader->t, node,
                          "'unit: %.40s' is no unit of length; write one, as mm or m",
                          text ? text : "");
    if (scene_units_ten(reader->s, &unit, &ten) >= 0)
        return tree_fault(reader->t, node,
                          "'unit: %.40s' needs the scene's own unit; add units: {length: m}", text);
    *(double *)to = pow(10, ten);
    return 0;
}

static int read_quads(reader *reader, int node, scene_quads *quads, const file_text *text)
{
    const quad_options options = {text->unit, text->flip != 0, SCENE_NODES};
    char error[QUAD_ERROR] = "out of memory";
    char *path = scene_file_path(reader, text->file);
    const int status = path ? quad_read(&quads->mesh, path, &options, &quads->warnings, error) : -1;
    free(path);
    if (status == 0)
        return 0;
    return tree_fault(reader->t, tree_find(reader->t, node, "file"), "%s", error);
}

static const field file_fields[] = {
    {"file", read_text, offsetof(file_text, file), .required = 1,
     .help = "Mesh file beside the scene: Gmsh's MSH 4.1 or 2.2, or Abaqus' INP."},
    {"unit", read_unit_name, offsetof(file_text, unit), .form = &name_form,
     .help = "Unit of length of the file, as mm; default that of the scene."},
    {"flip", read_flag, offsetof(file_text, flip),
     .help = "The outer face is the one that the elements of the file show from behind; default "
             "false."},
    DIRECTION_ROW,
    {"accept_irregular", read_flag, offsetof(file_text, accept_irregular),
     .help = "Report elements that are too thin for an irregular mesh, instead of refusing them; "
             "default false."},
    {.key = NULL}};
const form mesh_file_form = {.type = FORM_MAP, .fields = file_fields};

int read_mesh_file(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    file_text text = {NULL, 1, 0, 0};
    (void)rule;
    if (tree_find(reader->t, reader->t->root, "surface"))
        return tree_fault(reader->t, tree_find(reader->t, node, "file"),
                          "a mesh from a file brings its own surface; remove 'surface'");
    int status = read_map(reader, node, file_fields, &text);
    scene->quads = status == 0 ? calloc(1, sizeof *scene->quads) : NULL;
    if (!scene->quads) {
        free(text.file);
        return status == 0 ? tree_fault(reader->t, node, "out of memory") : -1;
    }
    scene->quads->file = text.file;
    scene->quads->at = node_at(reader, node);
    scene->quads->accept_irregular = text.accept_irregular;
    scene->at_surface = scene->line[0].at = scene->line[1].at = scene->quads->at;
    status = read_quads(reader, node, scene->quads, &text);
    scene->hash = (scene->hash ^ scene->quads->mesh.hash) * 16777619u;
    return status;
}

/* ---- sets of the mesh file --------------------------------------------- */

/*
 * Append the names of sets, separated by commas, to a list of at most LIST bytes for an error
 * message.
 */
static void list_names(const quad_set *set, size_t count, char *list)
{
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(list);
        if (length + strlen(set[i].name) + 3 < LIST)
            snprintf(list + length, LIST - length, "%s%s", length ? ", " : "", set[i].name);
    }
}

/*
 * Return whether a mesh has an edge set or a node set with a given name; sets of elements do not
 * count.
 */
static bool is_other_set(const quad_mesh *mesh, const char *name)
{
    return quad_set_find(mesh->edge_set, mesh->edge_sets, name) ||
           quad_set_find(mesh->node_set, mesh->node_sets, name);
}

static int refuse_set(reader *reader, int node, const char *name, bool only_elements)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    char list[LIST] = "";
    list_names(mesh->element_set, mesh->element_sets, list);
    if (!only_elements) {
        list_names(mesh->edge_set, mesh->edge_sets, list);
        list_names(mesh->node_set, mesh->node_sets, list);
    }
    const char *what = mesh->hash ? "mesh file" : "disc";
    if (only_elements && is_other_set(mesh, name))
        return tree_fault(reader->t, node,
                          "set '%.40s' of the %s holds edges or nodes, and a patch needs elements "
                          "(in Gmsh a physical surface); %s%s",
                          name, what, *list ? "it has the element sets " : "it has no element set",
                          list);
    const char *known = *list ? "it has " : "add a physical group to it";
    return tree_fault(reader->t, node, "the %s has no %sset '%.40s'; %s%s", what,
                      only_elements ? "element " : "", name, known, list);
}

static int require_quads(reader *reader, int node, const char *what)
{
    if (reader->s->quads)
        return 0;
    return tree_fault(reader->t, node,
                      "%s belongs to a mesh from a file; remove it, or write mesh: "
                      "{file: name.msh}",
                      what);
}

/*
 * Return whether the name of a set of the mesh file fits a pattern, in which the first * stands for
 * any text.
 */
static bool fits(const char *pattern, const char *name)
{
    const char *star = strchr(pattern, '*');
    if (!star)
        return strcmp(pattern, name) == 0;
    const size_t head = (size_t)(star - pattern), tail = strlen(star + 1), length = strlen(name);
    return length >= head + tail && strncmp(pattern, name, head) == 0 &&
           strcmp(star + 1, name + length - tail) == 0;
}

/*
 * Compare the names of two sets of the mesh file for qsort; numbers in names count by their value,
 * so that patch 2 comes before patch 10.
 */
static int by_name(const void *left, const void *right)
{
    const char *first = (*(const quad_set *const *)left)->name,
               *second = (*(const quad_set *const *)right)->name;
    while (*first && *first == *second) {
        first++;
        second++;
    }
    const size_t own = strspn(first, "0123456789"), other = strspn(second, "0123456789");
    if (own != other && own > 0 && other > 0)
        return own < other ? -1 : 1;
    return (unsigned char)*first - (unsigned char)*second;
}

/* ---- sets as places ------------------------------------------------------- */

/* Return whether a list of sets contains a set with a given name. */
static bool has_name(const quad_set *const *found, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(found[i]->name, name) == 0)
            return true;
    return false;
}

/*
 * List the sets of nodes, edges and elements of a mesh file whose names fit a pattern with *, in
 * the order of their names; of several sets with one name only the first is listed.
 *   found [all sets of the mesh file] out  these sets
 * Returns their number.
 */
static size_t find_places(const quad_mesh *mesh, const char *pattern, const quad_set **found)
{
    const quad_set *const list[3] = {mesh->node_set, mesh->edge_set, mesh->element_set};
    const size_t sets[3] = {mesh->node_sets, mesh->edge_sets, mesh->element_sets};
    size_t count = 0;
    for (int kind = 0; kind < 3; kind++)
        for (size_t i = 0; i < sets[kind]; i++)
            if (fits(pattern, list[kind][i].name) && !has_name(found, count, list[kind][i].name))
                found[count++] = &list[kind][i];
    qsort(found, count, sizeof *found, by_name);
    return count;
}

/* Allocate a list that can hold all sets of nodes, edges and elements of a mesh file. */
static const quad_set **allocate_places(const quad_mesh *mesh)
{
    const quad_set **found =
        calloc(mesh->node_sets + mesh->edge_sets + mesh->element_sets + 1, sizeof *found);
    return found;
}

/*
 * Refuse a name with *, which stands for several sets of the mesh file, where one set is needed.
 * The message names the sets that fit. Returns -1 after writing an error message about the scene
 * file.
 */
static int refuse_pattern(reader *reader, int node, const char *pattern)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    const quad_set **found = allocate_places(mesh);
    const size_t count = found ? find_places(mesh, pattern, found) : 0;
    char list[LIST] = "";
    for (size_t i = 0; i < count; i++)
        list_names(found[i], 1, list);
    free(found);
    if (count == 0)
        return refuse_set(reader, node, pattern, false);
    return tree_fault(reader->t, node,
                      "'%.40s' stands for %zu sets, and one is needed here; name one of %s (a "
                      "support with 'set', and the 'sets' of layers and patches take a name with "
                      "*)",
                      pattern, count, list);
}

/*
 * Read the name of a set of the mesh file, or a pattern of such names, on which a support, load or
 * output acts. Returns 0, or -1 after writing an error message about the scene file.
 */
static int read_set_name(reader *reader, int node, scene_where *where, const void *rule)
{
    if (require_quads(reader, node, "'set'") != 0 || read_name(reader, node, where->set, rule) != 0)
        return -1;
    if (where->at.column)
        return tree_fault(reader->t, node, "two places; give either 'set' or 'at'");
    where->type = WHERE_SET;
    where->at = node_at(reader, node);
    return 0;
}

/*
 * Refuse a set of nodes, some of which belong to no element. Returns -1 after writing an error
 * message about the scene file.
 */
static int refuse_loose(reader *reader, int node, const quad_set *set)
{
    const quad_loose *loose = &set->loose;
    const size_t listed = loose->count < QUAD_LOOSE ? loose->count : QUAD_LOOSE;
    char list[LIST] = "";
    for (size_t i = 0; i < listed; i++) {
        const size_t length = strlen(list);
        snprintf(list + length, LIST - length, "%s%lld", i > 0 ? ", " : "",
                 (long long)loose->label[i]);
    }
    return tree_fault(
        reader->t, node,
        "nodes without element in set '%.40s' of the mesh file: %zu (%s%s); take them "
        "out of the set, or put the points into the surface (in Gmsh Point{n} In "
        "Surface{m};)",
        set->name, loose->count, list, loose->count > listed ? " ..." : "");
}

/*
 * Check that every node of the sets of nodes whose names fit a name or a pattern with * belongs to
 * an element. Returns 0, or -1 after writing an error message about the scene file.
 */
static int require_elements(reader *reader, int node, const char *pattern)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    for (size_t i = 0; i < mesh->node_sets; i++)
        if (mesh->node_set[i].loose.count > 0 && fits(pattern, mesh->node_set[i].name))
            return refuse_loose(reader, node, &mesh->node_set[i]);
    return 0;
}

int read_set(reader *reader, int node, void *to, const void *rule)
{
    scene_where *where = to;
    if (read_set_name(reader, node, where, rule) != 0)
        return -1;
    if (strchr(where->set, '*'))
        return refuse_pattern(reader, node, where->set);
    const quad_mesh *mesh = &reader->s->quads->mesh;
    if (!quad_set_find(mesh->node_set, mesh->node_sets, where->set) &&
        !quad_set_find(mesh->edge_set, mesh->edge_sets, where->set) &&
        !quad_set_find(mesh->element_set, mesh->element_sets, where->set))
        return refuse_set(reader, node, where->set, false);
    return require_elements(reader, node, where->set);
}

int read_set_pattern(reader *reader, int node, void *to, const void *rule)
{
    scene_where *where = to;
    if (!strchr(node_text(reader, node) ? node_text(reader, node) : "", '*'))
        return read_set(reader, node, to, rule);
    char first[SCENE_NAME];
    if (read_set_name(reader, node, where, rule) != 0)
        return -1;
    return scene_fitting_set(reader->s, where->set, 0, first) > 0
               ? require_elements(reader, node, where->set)
               : refuse_set(reader, node, where->set, false);
}

int scene_fitting_set(const scene *scene, const char *pattern, int k, char name[SCENE_NAME])
{
    const quad_mesh *mesh = &scene->quads->mesh;
    const quad_set **found = allocate_places(mesh);
    const int count = found ? (int)find_places(mesh, pattern, found) : 0;
    if (k < count)
        snprintf(name, SCENE_NAME, "%.*s", SCENE_NAME - 1, found[k]->name);
    free(found);
    return count;
}

/*
 * Find the element sets that a name, or a pattern with *, stands for, in the order of their names.
 *   found  [element sets of the mesh] out  whether each set was found
 * Returns their number, or -1 after writing an error message about the scene file.
 */
static int find_sets(reader *reader, int node, const quad_set **found)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    const char *pattern = node_text(reader, node);
    int count = 0;
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    for (size_t i = 0; i < mesh->element_sets; i++)
        if (fits(pattern, mesh->element_set[i].name))
            found[count++] = &mesh->element_set[i];
    if (count == 0)
        return refuse_set(reader, node, pattern, true);
    qsort(found, (size_t)count, sizeof *found, by_name);
    return count;
}

/* Append the element sets that a pattern stands for to a list for an error message. */
static size_t list_fitting(const quad_mesh *mesh, const char *pattern, char *list)
{
    size_t count = 0;
    for (size_t i = 0; i < mesh->element_sets; i++)
        if (fits(pattern, mesh->element_set[i].name)) {
            list_names(&mesh->element_set[i], 1, list);
            count++;
        }
    return count;
}

/*
 * Check that every name and pattern of a YAML list stands for an element set. If some do and others
 * do not, the message names both. Returns 0, or -1 after writing an error message about the scene
 * file.
 */
static int check_patterns(reader *reader, int node)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    char fitting[LIST] = "", missing[LIST] = "";
    int first = 0;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        const size_t length = strlen(missing);
        if (require_kind(reader, i, TREE_SCALAR) != 0)
            return -1;
        if (list_fitting(mesh, node_text(reader, i), fitting) > 0)
            continue;
        snprintf(missing + length, LIST - length, "%s'%.40s'", first ? ", " : "",
                 node_text(reader, i));
        first = first ? first : i;
    }
    if (!first)
        return 0;
    if (!*fitting)
        return refuse_set(reader, first, node_text(reader, first), true);
    return tree_fault(reader->t, first,
                      "no element set of the mesh fits %s; the other names stand for %s", missing,
                      fitting);
}

/*
 * Check that an element set has elements, because a patch without elements has no effect. Returns
 * 0, or -1 after writing an error message about the scene file.
 */
static int check_set(reader *reader, int node, const quad_set *set)
{
    if (set->count > 0)
        return 0;
    return tree_fault(reader->t, node, "set '%s' of the mesh has no elements", set->name);
}

/*
 * Function that read_sets calls for each element set of a YAML list of set names. Returns 0, or -1
 * after writing an error message about the scene file.
 */
typedef int set_action(reader *reader, int node, const quad_set *set, void *to);

/*
 * Check that a YAML node is a list and that the mesh of the scene comes from a file. Returns 0, or
 * -1 after writing an error message about the scene file.
 */
static int check_set_list(reader *reader, int node)
{
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    return require_quads(reader, node, "'sets'");
}

/*
 * Call a function for every element set that a YAML list of names and patterns stands for. Returns
 * 0, or -1 after writing an error message about the scene file.
 */
static int read_sets(reader *reader, int node, set_action *action, void *to)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    const quad_set **found = calloc(mesh->element_sets + 1, sizeof *found);
    int status =
        found ? check_patterns(reader, node) : tree_fault(reader->t, node, "out of memory");
    for (int i = reader->t->node[node].first; i && status == 0; i = reader->t->node[i].next) {
        const int count = find_sets(reader, i, found);
        status = count < 0 ? -1 : 0;
        for (int k = 0; k < count && status == 0; k++)
            status = action(reader, i, found[k], to);
    }
    free((void *)found);
    return status;
}

/* Mark a layer as present in the elements of an element set. */
static int add_to_layer(reader *reader, int node, const quad_set *set, void *to)
{
    scene_layer *layer = to;
    (void)reader;
    (void)node;
    for (size_t i = 0; i < set->count; i++)
        layer->present[set->index[i]] = 1;
    return 0;
}

int read_layer_sets(reader *reader, int node, void *to, const void *rule)
{
    scene_layer *layer = to;
    (void)rule;
    if (check_set_list(reader, node) != 0)
        return -1;
    layer->present = calloc(reader->s->quads->mesh.elements, 1);
    if (!layer->present)
        return tree_fault(reader->t, node, "out of memory");
    return read_sets(reader, node, add_to_layer, layer);
}

/*
 * Make the elements of a set the next patch of a list of patches. Returns 0, or -1 after writing an
 * error message about the scene file if an element already belongs to another patch.
 */
static int add_patch(reader *reader, int node, const quad_set *set, void *to)
{
    scene_patches *patches = to;
    if (check_set(reader, node, set) != 0)
        return -1;
    for (size_t j = 0; j < set->count; j++) {
        int *own = &patches->patch[set->index[j]];
        if (*own >= 0)
            return tree_fault(reader->t, node,
                              "set '%s' shares element %lld with another set of these patches; "
                              "leave it out",
                              set->name,
                              (long long)reader->s->quads->mesh.element_label[set->index[j]]);
        *own = patches->grid[0];
    }
    patches->grid[0]++;
    return 0;
}

int read_patch_sets(reader *reader, int node, void *to, const void *rule)
{
    scene_patches *patches = to;
    (void)rule;
    if (check_set_list(reader, node) != 0)
        return -1;
    const size_t elements = reader->s->quads->mesh.elements;
    patches->patch = malloc(elements * sizeof *patches->patch);
    if (!patches->patch)
        return tree_fault(reader->t, node, "out of memory");
    for (size_t element = 0; element < elements; element++)
        patches->patch[element] = -1;
    patches->grid[0] = 0;
    if (read_sets(reader, node, add_patch, patches) != 0)
        return -1;
    if (patches->grid[0] == 0)
        return tree_fault(reader->t, node, "'sets' is empty; name the element sets of the patches");
    return 0;
}

/* ---- points near which a node is sought -------------------------------- */

static double distance_to(const quad_mesh *mesh, size_t node, const double place[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += pow(mesh->position[node][i] - place[i], 2);
    return sqrt(sum);
}

/* Return the length of the longest diagonal of the elements at a node. */
static double size_at(const quad_mesh *mesh, uint32_t node)
{
    double size = 0;
    for (size_t element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            if (mesh->element[element][corner] == node)
                size = fmax(size,
                            distance_to(mesh, node,
                                        mesh->position[mesh->element[element][(corner + 2) % 4]]));
    return size;
}

static const field place_fields[] = {
    {"x", read_real, offsetof(scene_where, x[0]), .required = 1, .of = OF_LENGTH,
     .help = "Coordinate x of a place on a mesh from a file."},
    {"y", read_real, offsetof(scene_where, x[1]), .required = 1, .of = OF_LENGTH,
     .help = "Coordinate y of a place on a mesh from a file."},
    {"z", read_real, offsetof(scene_where, x[2]), .required = 1, .of = OF_LENGTH,
     .help = "Coordinate z of a place on a mesh from a file."},
    {.key = NULL}};
const form place_form = {.type = FORM_MAP, .fields = place_fields};

/*
 * The scene uses the mesh node nearest to a place instead of the place itself. Record the place,
 * its node and the gap between them, if this gap is the largest so far.
 *   gap in  distance of the place from the node, as a fraction of the size of the elements there
 */
static void note_gap(scene_quads *quads, double gap, uint32_t node, scene_at at)
{
    if (!(gap > quads->place_gap))
        return;
    quads->place_gap = gap;
    quads->place_node = quads->mesh.node_label ? quads->mesh.node_label[node] : 0;
    quads->place_at = at;
}

int read_place(reader *reader, int node, scene_where *where)
{
    if (read_map(reader, node, place_fields, where) != 0)
        return -1;
    const quad_mesh *mesh = &reader->s->quads->mesh;
    uint32_t nearest = 0;
    for (uint32_t candidate = 1; candidate < mesh->nodes; candidate++)
        if (distance_to(mesh, candidate, where->x) < distance_to(mesh, nearest, where->x))
            nearest = candidate;
    const double *found = mesh->position[nearest];
    const double gap = distance_to(mesh, nearest, where->x) / size_at(mesh, nearest);
    if (!(gap <= 1))
        return tree_fault(reader->t, node,
                          "(%g, %g, %g) is not on the mesh; the nearest node is (%g, %g, %g)",
                          where->x[0], where->x[1], where->x[2], found[0], found[1], found[2]);
    where->node[0] = (int)nearest;
    where->type = WHERE_PLACE;
    note_gap(reader->s->quads, gap, nearest, node_at(reader, node));
    return 0;
}

/* ---- nodes of a point, edge or set -------------------------------------- */

/*
 * Mark the nodes of a named set of the mesh file, whose members are nodes, edges or elements.
 *   type            in   number of nodes of each member: 1, 2 or 4
 *   in_set [nodes]  out  1 for a node of the set; other entries stay as they are
 */
static void mark_set(const quad_mesh *mesh, const quad_set *set, int type, unsigned char *in_set)
{
    for (size_t i = 0; i < set->count; i++) {
        const uint32_t item = set->index[i];
        if (type == 1)
            in_set[item] = 1;
        for (uint32_t k = 0; type == 2 && k < 2; k++)
            in_set[mesh->element[item / 4][(item % 4 + k) % 4]] = 1;
        for (int k = 0; type == 4 && k < 4; k++)
            in_set[mesh->element[item][k]] = 1;
    }
}

size_t scene_mark_nodes(const scene *scene, const scene_where *where, unsigned char *in_set)
{
    const quad_mesh *mesh = &scene->quads->mesh;
    const quad_set *nodes = quad_set_find(mesh->node_set, mesh->node_sets, where->set);
    const quad_set *edges = quad_set_find(mesh->edge_set, mesh->edge_sets, where->set);
    const quad_set *elements = quad_set_find(mesh->element_set, mesh->element_sets, where->set);
    size_t count = 0;
    memset(in_set, where->type == WHERE_NODES, mesh->nodes);
    if (where->type == WHERE_PLACE)
        in_set[where->node[0]] = 1;
    if (where->type == WHERE_SET && nodes)
        mark_set(mesh, nodes, 1, in_set);
    else if (where->type == WHERE_SET && edges)
        mark_set(mesh, edges, 2, in_set);
    else if (where->type == WHERE_SET && elements)
        mark_set(mesh, elements, 4, in_set);
    for (size_t node = 0; node < mesh->nodes; node++)
        count += in_set[node];
    return count;
}
