/* SPDX-License-Identifier: BSD-2-Clause */
/* The steps from a mesh file to a checked mesh (quad_read.h). */
#include "quad_read.h"

#include <stdlib.h>
#include <string.h>
#include "quad_steps.h"

long long quad_element_label(const quad_mesh *mesh, size_t element)
{
    return (long long)mesh->element_label[element];
}

long long quad_node_label(const quad_mesh *mesh, size_t node)
{
    return (long long)mesh->node_label[node];
}

/* Return the hash of a mesh file and of those options that change the mesh. */
static uint32_t hash_of(const quad_file *file, const quad_options *options)
{
    unsigned char bytes[sizeof options->unit + 1];
    uint32_t hash = quad_file_hash(file);
    memcpy(bytes, &options->unit, sizeof options->unit);
    bytes[sizeof bytes - 1] = options->is_flipped;
    for (size_t i = 0; i < sizeof bytes; i++)
        hash = (hash ^ bytes[i]) * 16777619u;
    return hash ? hash : 1;
}

static int one_region(quad_mesh *mesh, const quad_file *file)
{
    mesh->region = calloc(1, sizeof *mesh->region);
    mesh->regions = mesh->region ? 1 : 0;
    return mesh->region ? 0 : quad_fault_at(file, 0, "the mesh does not fit into memory");
}

static int build(quad_mesh *mesh, quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_warnings *warnings)
{
    quad_topology topology = {NULL};
    int status = quad_collect(mesh, origin, raw, options, warnings);
    if (status == 0)
        status = quad_check_folds(mesh, origin);
    if (status == 0)
        status = quad_connect(mesh, origin, raw, options, &topology);
    if (status == 0)
        status = quad_directors(mesh, origin, &topology, warnings);
    quad_topology_free(&topology);
    if (status == 0 && (quad_turn(mesh) < 0 || quad_renumber(mesh) < 0))
        status = quad_fault_at(origin->file, 0, "the mesh does not fit into memory");
    return status == 0 ? one_region(mesh, origin->file) : -1;
}

static int read_raw(quad_file *file, quad_raw *raw)
{
    quad_skip(file);
    return file->text[file->at] == '$' ? quad_read_gmsh(file, raw) : quad_read_inp(file, raw);
}

int quad_read(quad_mesh *mesh, const char *path, const quad_options *options,
              quad_warnings *warnings, char *error)
{
    quad_file file;
    quad_raw raw;
    quad_origin origin = {&file, NULL};
    memset(mesh, 0, sizeof *mesh);
    memset(&raw, 0, sizeof raw);
    memset(warnings, 0, sizeof *warnings);
    if (quad_file_open(&file, path, error) < 0)
        return -1;
    int status = read_raw(&file, &raw);
    if (status == 0)
        status = build(mesh, &origin, &raw, options, warnings);
    if (status == 0)
        mesh->hash = hash_of(&file, options);
    free(origin.element_at);
    quad_raw_free(&raw);
    quad_file_close(&file);
    if (status < 0)
        quad_mesh_free(mesh);
    return status;
}
