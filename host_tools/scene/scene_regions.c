/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Assignment of the elements of a mesh from a file to regions of equal layers, from the layers and
 * patches of the scene (scene_parts.h).
 */
#include "scene_parts.h"

#include <stdlib.h>
#include <string.h>

/* Refuse two grids of patches on one layer that share an element. */
static int check_overlaps(const scene *scene, char *error)
{
    for (int i = 0; i < scene->patch_grids; i++)
        for (int j = 0; j < i; j++) {
            const scene_patches *own = &scene->patches[i], *other = &scene->patches[j];
            if (!own->patch || !other->patch || own->layer != other->layer)
                continue; /* Overlaps of electrodes that are given by outlines are found in
                             outline_overlap.c. */
            for (size_t element = 0; element < scene->quads->mesh.elements; element++)
                if (own->patch[element] >= 0 && other->patch[element] >= 0)
                    return scene_fault(own->at, error,
                                       "patches '%s' and '%s' overlap on one layer, in element "
                                       "%lld; use other sets",
                                       other->name, own->name,
                                       (long long)scene->quads->mesh.element_label[element]);
        }
    return 0;
}

static int check_layer_sets(const scene *scene, char *error)
{
    for (int i = 0; i < scene->layers; i++)
        if (scene->layer[i].patched && scene->layer[i].present)
            return scene_fault(scene->layer[i].at, error,
                               "this layer has 'sets' and is patched; patches say where it is, "
                               "remove 'sets'");
    return 0;
}

/* Return the layers that are present in an element: bit i is set for layer i. */
static uint32_t layers_in(const scene *scene, size_t element)
{
    uint32_t layers = 0;
    for (int i = 0; i < scene->layers && i < 32; i++)
        if (!scene->layer[i].patched &&
            (!scene->layer[i].present || scene->layer[i].present[element]))
            layers |= 1u << i;
    for (int grid = 0; grid < scene->patch_grids; grid++)
        if (scene->patches[grid].patch && scene->patches[grid].patch[element] >= 0 &&
            scene->patches[grid].layer < 32)
            layers |= 1u << scene->patches[grid].layer;
    return layers;
}

/*
 * Return the index of the region (group of elements with the same layers) of a mesh whose layers
 * are given by the bits of `layers`; a new region is added if there is none.
 */
static uint32_t region_of(quad_mesh *mesh, uint32_t layers)
{
    for (size_t i = 0; i < mesh->regions; i++)
        if (mesh->region[i].present_plies == layers)
            return (uint32_t)i;
    quad_region *fresh = &mesh->region[mesh->regions];
    fresh->present_plies = layers;
    return (uint32_t)mesh->regions++;
}

int check_regions(scene *scene, char *error)
{
    quad_mesh *mesh = &scene->quads->mesh;
    if (check_overlaps(scene, error) != 0 || check_layer_sets(scene, error) != 0)
        return -1;
    free(mesh->region);
    mesh->regions = 0;
    mesh->region = calloc(mesh->elements, sizeof *mesh->region);
    mesh->element_region = calloc(mesh->elements, sizeof *mesh->element_region);
    if (!mesh->region || !mesh->element_region)
        return scene_fault(scene->quads->at, error, "the mesh does not fit into memory");
    for (size_t element = 0; element < mesh->elements; element++)
        mesh->element_region[element] = region_of(mesh, layers_in(scene, element));
    return check_directions(scene, error);
}
