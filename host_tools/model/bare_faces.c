/* SPDX-License-Identifier: BSD-2-Clause */
/* Electric potentials of faces without electrodes as inputs of the structure (bare_faces.h). */
#include "bare_faces.h"
#include <stdlib.h>
#include <string.h>

/*
 * Return the slot of a node on an interface between layers: the index interface * nodes + node.
 * Interface i lies below layer i and above layer i - 1, so that layer i lies between the interfaces
 * i and i + 1.
 */
static size_t slot_of(const mesh *mesh, int interface, int node)
{
    return (size_t)interface * (size_t)mesh->nodes + (size_t)node;
}

static const laminate_place *place_of(const mesh *mesh, int element)
{
    return &mesh->place[mesh->element_type[element]];
}

bool bare_faces_has(const bare_faces *bare, int layer, int element)
{
    return bare->layer[layer].bare != BARE_NONE &&
           place_of(bare->mesh, element)->present_plies >> layer & 1u;
}

/*
 * Return whether the inner (face 0) or the outer (face 1) face of a layer is bare (without
 * electrode).
 */
static bool face_is_bare(const bare_faces *bare, int layer, int face)
{
    return bare->layer[layer].bare & (face ? BARE_OUTER : BARE_INNER);
}

/* ---- connected parts -------------------------------------------------- */

/*
 * Disjoint sets of slots (union-find). A slot is a node on an interface between two layers or on an
 * outer face. Slots on bare faces (without electrodes) of one layer in one element belong to one
 * set. A set without an electrode at 0 V determines its potentials only up to a constant.
 */
typedef struct slot_sets {
    bool *used, *grounded; /* [slots] one entry for each node on an interface between layers. used:
                              whether the node has an electric potential. grounded: whether a set of
                              connected nodes contains a layer with an electrode at 0 V; valid only
                              at the root of the set */
    size_t *parent; /* [slots] parent of each node on an interface between layers, in the tree of
                       its set of connected nodes; the root of a tree is its own parent */
} slot_sets;

static size_t root_of(const slot_sets *sets, size_t slot)
{
    while (sets->parent[slot] != slot)
        slot = sets->parent[slot] = sets->parent[sets->parent[slot]];
    return slot;
}

static void join(slot_sets *sets, size_t first, size_t second)
{
    const size_t one = root_of(sets, first), other = root_of(sets, second);
    const size_t least = one < other ? one : other;
    const size_t most = one < other ? other : one;
    sets->parent[most] = least;
    sets->grounded[least] = sets->grounded[least] || sets->grounded[most];
}

/*
 * Mark the nodes of one element on the bare faces (without electrodes) of one layer as used, and
 * join all of them to one set of connected nodes. If the other face of the layer has an electrode,
 * the set is grounded.
 */
static void join_element(const bare_faces *bare, int layer, int element, slot_sets *sets)
{
    const mesh *mesh = bare->mesh;
    size_t first = 0;
    bool is_first = true;
    for (int k = 0; k < 8; k++) {
        const size_t slot = slot_of(mesh, layer + k % 2, mesh->element[element][k / 2]);
        if (!face_is_bare(bare, layer, k % 2))
            continue;
        sets->used[slot] = true;
        if (!is_first)
            join(sets, first, slot);
        first = is_first ? slot : first;
        is_first = false;
    }
    if (bare->layer[layer].bare != BARE_BOTH)
        sets->grounded[root_of(sets, first)] = true;
}

/*
 * Number the electric potentials, one for each used slot (node on an interface between layers). In
 * a set of connected slots without an electrode at 0 V, the first slot gets no number; its
 * potential is 0.
 */
static void number_slots(bare_faces *bare, const slot_sets *sets, size_t slots)
{
    for (size_t slot = 0; slot < slots; slot++) {
        const bool is_reference = root_of(sets, slot) == slot && !sets->grounded[slot];
        const bool is_unknown = sets->used[slot] && !is_reference;
        bare->number[slot] = is_unknown ? bare->count : -1;
        bare->count += is_unknown;
    }
}

/* ---- tables ----------------------------------------------------------- */

static int no_memory(const bare_faces *bare, char *error)
{
    return scene_fault(
        bare->layer[0].at, error,
        "the potentials of the bare faces do not fit into memory; use fewer elements");
}

/* Return whether a layer has a bare face (without electrode) and is present in an element type. */
static bool is_bare_in_type(const bare_faces *bare, int layer, int type)
{
    return bare->layer[layer].bare != BARE_NONE &&
           bare->mesh->place[type].present_plies >> layer & 1u;
}

/*
 * Compute the stress resultants and capacitances of the electric potentials on the faces of one
 * layer in one element type.
 */
static void fill_type(bare_faces *bare, int type, int layer)
{
    const mesh *mesh = bare->mesh;
    const size_t layers = (size_t)bare->layers, row = (size_t)type * layers + (size_t)layer;
    if (!is_bare_in_type(bare, layer, type))
        return;
    potential_element_resultants(&mesh->laminate, &mesh->formulation, &mesh->place[type], layer,
                                 bare->resultants[row]);
    for (int other = 0; other < bare->layers; other++)
        if (is_bare_in_type(bare, other, type))
            potential_element_capacitance(&mesh->laminate, &mesh->formulation, &mesh->place[type],
                                          layer, other,
                                          bare->capacitance[row * layers + (size_t)other]);
}

/*
 * List the slot (node on an interface between layers) of each electric potential, and compute the
 * stress resultants and capacitances of the potentials in all element types.
 */
static int fill_tables(bare_faces *bare, char *error)
{
    const mesh *mesh = bare->mesh;
    const size_t layers = (size_t)bare->layers, types = (size_t)mesh->types;
    bare->slot = calloc((size_t)bare->count + 1, sizeof *bare->slot);
    bare->resultants = calloc(types * layers, sizeof *bare->resultants);
    bare->capacitance = calloc(types * layers * layers, sizeof *bare->capacitance);
    if (!bare->slot || !bare->resultants || !bare->capacitance)
        return no_memory(bare, error);
    for (size_t slot = 0; slot < (layers + 1) * (size_t)mesh->nodes; slot++)
        if (bare->number[slot] >= 0)
            bare->slot[bare->number[slot]] = slot;
    for (int type = 0; type < mesh->types; type++)
        for (int layer = 0; layer < bare->layers; layer++)
            fill_type(bare, type, layer);
    return 0;
}

static int number_potentials(bare_faces *bare, slot_sets *sets, size_t slots, char *error)
{
    for (size_t slot = 0; slot < slots; slot++)
        sets->parent[slot] = slot;
    for (int element = 0; element < bare->mesh->elements; element++)
        for (int layer = 0; layer < bare->layers; layer++)
            if (bare_faces_has(bare, layer, element))
                join_element(bare, layer, element, sets);
    number_slots(bare, sets, slots);
    if (bare->count <= BARE_POTENTIALS)
        return fill_tables(bare, error);
    return scene_fault(bare->layer[0].at, error,
                       "the bare faces have %d potentials, one for each of their nodes; at most %d "
                       "are solved for: use fewer elements, or bare faces on fewer layers",
                       bare->count, BARE_POTENTIALS);
}

int bare_faces_build(bare_faces *bare, const mesh *mesh, const scene *scene, char *error)
{
    bare->mesh = mesh;
    bare->layers = scene->layers;
    bare->layer = scene->layer;
    const size_t slots = (size_t)(bare->layers + 1) * (size_t)bare->mesh->nodes;
    bool is_given = false;
    for (int layer = 0; layer < bare->layers; layer++)
        is_given |= bare->layer[layer].bare != BARE_NONE;
    if (!is_given)
        return 0;
    slot_sets sets = {calloc(slots, sizeof *sets.used), calloc(slots, sizeof *sets.grounded),
                      calloc(slots, sizeof *sets.parent)};
    bare->number = calloc(slots, sizeof *bare->number);
    const int status = sets.used && sets.grounded && sets.parent && bare->number
                           ? number_potentials(bare, &sets, slots, error)
                           : no_memory(bare, error);
    free(sets.used);
    free(sets.grounded);
    free(sets.parent);
    return status;
}

void bare_faces_free(bare_faces *bare)
{
    free(bare->number);
    free(bare->slot);
    free(bare->resultants);
    free(bare->capacitance);
    memset(bare, 0, sizeof *bare);
}

/* ---- effects ---------------------------------------------------------- */

/*
 * Return the index in the arrays `resultants` and `capacitance` of bare_faces that belongs to a
 * layer in an element.
 */
static size_t row_of(const bare_faces *bare, int layer, int element)
{
    return (size_t)bare->mesh->element_type[element] * (size_t)bare->layers + (size_t)layer;
}

void bare_faces_numbers(const bare_faces *bare, int layer, int element, int number[POTENTIAL_NODES])
{
    const mesh *mesh = bare->mesh;
    for (int k = 0; k < POTENTIAL_NODES; k++)
        number[k] = face_is_bare(bare, layer, k % 2)
                        ? bare->number[slot_of(mesh, layer + k % 2, mesh->element[element][k / 2])]
                        : -1;
}

/* Return whether a node is a corner of an element. */
static bool is_corner(const mesh *mesh, int element, int node)
{
    for (int corner = 0; corner < 4; corner++)
        if (mesh->element[element][corner] == node)
            return true;
    return false;
}

bool bare_faces_resultants(const bare_faces *bare, int potential, int element,
                           double h0[LAMINATE_STRAINS])
{
    const int node = (int)(bare->slot[potential] % (size_t)bare->mesh->nodes);
    int number[POTENTIAL_NODES];
    bool acts = false;
    memset(h0, 0, LAMINATE_STRAINS * sizeof *h0);
    for (int layer = 0; layer < bare->layers && is_corner(bare->mesh, element, node); layer++) {
        if (!bare_faces_has(bare, layer, element))
            continue;
        bare_faces_numbers(bare, layer, element, number);
        for (int k = 0; k < POTENTIAL_NODES; k++) {
            if (number[k] != potential)
                continue;
            acts = true;
            for (int i = 0; i < LAMINATE_STRAINS; i++)
                h0[i] += bare->resultants[row_of(bare, layer, element)][k][i];
        }
    }
    return acts;
}

const double (*bare_faces_capacitance(const bare_faces *bare, int layer, int other,
                                      int element))[POTENTIAL_NODES]
{
    const size_t entry = row_of(bare, layer, element) * (size_t)bare->layers + (size_t)other;
    return (const double(*)[POTENTIAL_NODES])bare->capacitance[entry];
}

/* ---- results ---------------------------------------------------------- */

double bare_faces_potential(const bare_faces *bare, const double *value, int layer, int face,
                            int node)
{
    if (bare->count == 0 || !face_is_bare(bare, layer, face))
        return 0;
    const int number = bare->number[slot_of(bare->mesh, layer + face, node)];
    return number >= 0 ? value[bare->first_input + number] : 0;
}

bool bare_faces_field(const bare_faces *bare, const double *value, int layer, int element,
                      double *voltage, double along[2][2])
{
    double potential[POTENTIAL_NODES];
    *voltage = 0;
    memset(along, 0, 4 * sizeof(double));
    if (!bare_faces_has(bare, layer, element))
        return false;
    for (int k = 0; k < POTENTIAL_NODES; k++)
        potential[k] =
            bare_faces_potential(bare, value, layer, k % 2, bare->mesh->element[element][k / 2]);
    potential_element_field(&bare->mesh->laminate, &bare->mesh->formulation,
                            place_of(bare->mesh, element), layer, potential, voltage, along);
    return true;
}
