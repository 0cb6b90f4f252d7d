/*
 * Laws of meshes from files: every format gives the same mesh, damaged files are refused with their
 * place, orientation, directors and numbering.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/quads/quad_graph.h"
#include "../../host_tools/quads/quad_read.h"
#include "../rigs/mesh_writer.h"

#ifndef MUTATIONS
#define MUTATIONS 1000
#endif

static char path[] = "/tmp/test_quads_XXXXXX";
static const quad_options plain = {1, false, 60000};
static grid_mesh grid;

/* ---- files ------------------------------------------------------------- */

static FILE *open_file(void)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    return file;
}

static void write_grid(mesh_format format)
{
    FILE *file = open_file();
    grid_write(&grid, format, file);
    fclose(file);
}

static void write_text(const char *text)
{
    FILE *file = open_file();
    fputs(text, file);
    fclose(file);
}

typedef struct result {
    quad_mesh mesh;
    quad_warnings warnings;
    char error[QUAD_ERROR];
    int status;
} result;

static result read_with(const quad_options *options)
{
    result r;
    memset(&r, 0, sizeof r);
    r.status = quad_read(&r.mesh, path, options, &r.warnings, r.error);
    return r;
}

static quad_mesh read_valid(void)
{
    const result r = read_with(&plain);
    if (r.status != 0)
        fail_msg("%s", r.error);
    return r.mesh;
}

/* ---- surfaces ---------------------------------------------------------- */

static void plate(double u, double v, double x[3])
{
    x[0] = 2 * u;
    x[1] = v;
    x[2] = 0.5;
}

/* Three quarters of a cylinder of radius 1 along z. */
static void cylinder(double u, double v, double x[3])
{
    x[0] = cos(4.7 * u);
    x[1] = sin(4.7 * u);
    x[2] = 2 * v;
}

/* A piece of a unit sphere whose mesh lines are sheared, so that no symmetry helps a director. */
static void sphere(double u, double v, double x[3])
{
    const double polar = 0.9 + 0.7 * v + 0.1 * sin(7 * u), azimuth = 1.1 * u + 0.3 * v * v;
    x[0] = sin(polar) * cos(azimuth);
    x[1] = sin(polar) * sin(azimuth);
    x[2] = cos(polar);
}

/* ---- formats ----------------------------------------------------------- */

static void assert_same_sets(const quad_set *x, const quad_set *y, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const quad_set *other = quad_set_find(y, count, x[i].name);
        assert_non_null(other);
        assert_int_equal(other->count, x[i].count);
        assert_memory_equal(other->index, x[i].index, x[i].count * sizeof *x[i].index);
    }
}

/* Law: the five forms of a file hold the same mesh, to the last bit, whatever the labels. */
static void test_formats_agree(void **state)
{
    (void)state;
    for (unsigned order = 0; order < 2; order++) {
        grid_fill(&grid, 5, 3, cylinder, order);
        write_grid(MSH4_TEXT);
        quad_mesh first = read_valid();
        assert_int_equal(first.nodes, grid.nodes);
        assert_int_equal(first.elements, grid.elements);
        assert_memory_equal(first.position, grid.x, first.nodes * sizeof *first.position);
        for (int format = 0; format < FORMATS; format++) {
            write_grid((mesh_format)format);
            quad_mesh mesh = read_valid();
            assert_memory_equal(mesh.position, first.position,
                                first.nodes * sizeof *first.position);
            assert_memory_equal(mesh.element, first.element, first.elements * sizeof *mesh.element);
            assert_memory_equal(mesh.director, first.director,
                                first.nodes * sizeof *first.director);
            assert_memory_equal(mesh.element_label, grid.element_label, mesh.elements * 8);
            assert_memory_equal(mesh.node_label, grid.node_label, mesh.nodes * 8);
            assert_same_sets(first.node_set, mesh.node_set, first.node_sets);
            assert_same_sets(first.element_set, mesh.element_set, first.element_sets);
            assert_same_sets(first.edge_set, mesh.edge_set, first.edge_sets);
            quad_mesh_free(&mesh);
        }
        quad_mesh_free(&first);
    }
}

/* Law: sets hold what the file says: edges of the border, halves of the elements, one node. */
static void test_sets(void **state)
{
    (void)state;
    grid_fill(&grid, 4, 3, plate, 5);
    write_grid(MSH2_TEXT);
    quad_mesh mesh = read_valid();
    const quad_set *low = quad_set_find(mesh.edge_set, mesh.edge_sets, "low1");
    assert_int_equal(low->count, 3);
    for (size_t i = 0; i < low->count; i++)
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t edge = low->index[i];
            const uint32_t node = mesh.element[edge / 4][(edge % 4 + k) % 4];
            assert_true(fabs(mesh.position[node][0]) < DBL_EPSILON);
        }
    const quad_set *second = quad_set_find(mesh.element_set, mesh.element_sets, "second");
    assert_int_equal(second->count, 6);
    assert_int_equal(second->index[0], 6);
    const quad_set *origin = quad_set_find(mesh.node_set, mesh.node_sets, "origin");
    assert_int_equal(origin->count, 1);
    assert_int_equal(origin->index[0], 0);
    assert_null(quad_set_find(mesh.node_set, mesh.node_sets, "low1"));
    quad_mesh_free(&mesh);
}

/* Law: lengths are multiplied by the unit, and the hash knows it. */
static void test_unit(void **state)
{
    (void)state;
    const quad_options millimetres = {1e-3, false, 60000};
    grid_fill(&grid, 2, 2, plate, 0);
    write_grid(INP);
    quad_mesh metres = read_valid();
    result small = read_with(&millimetres);
    assert_int_equal(small.status, 0);
    assert_true(small.mesh.position[8][0] == 1e-3 * metres.position[8][0]);
    assert_int_not_equal(small.mesh.hash, metres.hash);
    quad_mesh_free(&metres);
    quad_mesh_free(&small.mesh);
}

/* ---- refused files ------------------------------------------------------ */

#define HEAD4 "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define HEAD2 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define SQUARE2 HEAD2 "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n$EndNodes\n"
#define NODES_INP "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 2, 0, 0\n6, 2, 1, 0\n"

/* Files and the message that must be in the answer. */
static const struct {
    const char *text, *says;
} refused[] = {
    {"", "the file is empty"},
    {"PK\003\004 a zip file", "this is no mesh file"},
    {"solid cube\nfacet normal 0 0 1\n", "this is no mesh file"},
    {"$Nodes\n1\n", ":1: a Gmsh file begins with $MeshFormat"},
    {"$MeshFormat\n4.0 0 8\n$EndMeshFormat\n", ":2: MSH version 4; versions 2.2 and 4.1 are read"},
    {"$MeshFormat\n4.1 0 4\n$EndMeshFormat\n", "numbers of 4 bytes"},
    {"$MeshFormat\n4.1 1 8\n\001\000", "the byte order is missing"},
    {"$MeshFormat\n4.1 zero 8\n", ":2: 'zero' stands where 0 for text or 1 for binary is expected"},
    {HEAD4, "the file has no section $Nodes"},
    {HEAD4 "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n", "4 nodes are announced, but only 13 bytes follow"},
    {HEAD4 "$Nodes\n1 99999999999 1 4\n", "99999999999 nodes are announced, but only"},
    {HEAD4 "$Nodes\n1 -4 1 4\n", "-4 nodes are announced"},
    {HEAD4 "$Elements\n0 0 0 0\n$EndElements\n", "$Elements comes before $Nodes"},
    {HEAD4 "$PartitionedEntities\n", "the mesh is partitioned"},
    {HEAD4 "$Nonsense\n1 2 3\n", ":4: $EndNonsense is missing"},
    {SQUARE2 "$Elements\n1\n1 3 2 0 1 1 2 3 9\n$EndElements\n",
     ":15: element 1 has node 9, which the file does not define; export the nodes too"},
    {SQUARE2 "$Elements\n1\n7 2 2 0 1 1 2 3\n$EndElements\n", ":15: element 7 is a triangle"},
    {SQUARE2 "$Elements\n1\n7 16 2 0 1 1 2 3 4 5 6 7 8\n", "a quadrilateral of 8 nodes"},
    {SQUARE2 "$Elements\n1\n7 4 2 0 1 1 2 3 4\n", "element 7 is a tetrahedron"},
    {SQUARE2 "$Elements\n1\n7 77 2 0 1 1 2 3 4\n", "of Gmsh's type 77"},
    {SQUARE2 "$Elements\n1\n7 3 2 0 1 1 2 3 3\n$EndElements\n", "element 7 has node 3 twice"},
    {SQUARE2 "$Elements\n1\n7 1 2 0 1 1 2\n$EndElements\n", "the file has no quadrilaterals"},
    {SQUARE2 "$Elements\n2\n7 3 2 0 1 1 2 3 4\n8 3 2 0 1 2 3 4 1\n$EndElements\n",
     ":16: elements 7 and 8 have the same nodes"},
    {SQUARE2 "$Elements\n2\n7 3 2 0 1 1 2 3 4\n7 3 2 0 1 2 5 6 3\n$EndElements\n",
     ":16: element 7 is defined twice"},
    {SQUARE2 "$Elements\n2\n7 3 2 0 1 1 2 3 4\n8 1 2 1 1 1 3\n$EndElements\n",
     ":16: line element 8 of set '1' is no edge of a quadrilateral"},
    {SQUARE2 "$Elements\n1\n7 3 2 0 1 1 3 2 4\n$EndElements\n", "element 7 is folded at node 1"},
    {HEAD2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 nan 0\n4 0 1 0\n$EndNodes\n$Elements\n1\n"
           "1 3 2 0 1 1 2 3 4\n$EndElements\n",
     ":8: node 3 has the coordinate nan"},
    {HEAD2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1e300 0\n4 0 1 0\n$EndNodes\n$Elements\n1\n"
           "1 3 2 0 1 1 2 3 4\n$EndElements\n",
     "node 3 has the coordinate 1e+300"},
    {HEAD2 "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n$Elements\n0\n$EndElements\n",
     ":7: node 1 is defined twice"},
    {SQUARE2 "$Elements\n1\n7 3 2 0 1 1 2 3 4\n", "$EndElements is expected here"},
    {NODES_INP "*ELEMENT, TYPE=S3\n1, 1, 2, 3\n", ":8: elements of type S3 are triangles"},
    {NODES_INP "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3\n", "elements of type 'C3D8' are not read"},
    {NODES_INP "*ELEMENT\n1, 1, 2, 3, 4\n", "elements of type '' are not read"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, 3\n", ":9: element 1 has 3 nodes; 4 are expected"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, x, 4\n", ":9: 'x' stands where a node of an element"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*ELSET, ELSET=a\n1, 2\n",
     ":11: set 'a' has element 2, which the file does not define"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*NSET, NSET=a\n1, b\n",
     "'b' stands where a number or the name of a set that is defined before"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*NSET, NSET=a, GENERATE\n9, 1\n",
     ":11: GENERATE needs a line as 1, 9, 2"},
    {NODES_INP "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*NSET\n1\n", "a set needs a name"},
    {"*INCLUDE, INPUT=a.inp\n", "*INCLUDE is not followed"},
    {"*PART, NAME=a\n*END PART\n*PART, NAME=b\n", ":3: there are two parts"},
    {"*NODE\n1, 0, 0, 0\n", "the file defines no element: no numbers follow"},
    {"*NODE\n\n\n*NODE\n", ":5: the file defines no node: no numbers follow a line *NODE"},
    {"*NODE\n,\n", ":2: nothing stands where the number of a node is expected"},
};

/* Law: what cannot be used is refused with the place in the file and the cure. */
static void test_refused_files(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++) {
        write_text(refused[k].text);
        const result r = read_with(&plain);
        if (r.status == 0 || !strstr(r.error, refused[k].says))
            fail_msg("case %zu: '%s', expected '%s'", k, r.error, refused[k].says);
        assert_null(r.mesh.position);
    }
}

/* Law: a binary file of the other byte order is named as such. */
static void test_byte_order(void **state)
{
    (void)state;
    FILE *file = open_file();
    fwrite("$MeshFormat\n4.1 1 8\n\000\000\000\001\n$EndMeshFormat\n", 1, 39, file);
    fclose(file);
    const result r = read_with(&plain);
    assert_int_equal(r.status, -1);
    assert_non_null(strstr(r.error, "another byte order (1 reads as 16777216)"));
}

/* Law: a mesh with too many nodes, a folder and a missing file are refused. */
static void test_refused_sizes(void **state)
{
    (void)state;
    const quad_options few = {1, false, 11};
    quad_mesh mesh;
    quad_warnings warnings;
    char error[QUAD_ERROR];
    grid_fill(&grid, 3, 2, plate, 0);
    write_grid(MSH4_BINARY);
    const result r = read_with(&few);
    assert_non_null(strstr(r.error, "the mesh has 12 nodes; at most 11 are allowed"));
    assert_int_equal(quad_read(&mesh, "/tmp", &plain, &warnings, error), -1);
    assert_non_null(strstr(error, "no regular file"));
    assert_int_equal(quad_read(&mesh, "/tmp/no/such.msh", &plain, &warnings, error), -1);
    assert_non_null(strstr(error, "such.msh: No such file"));
}

/* ---- topology ----------------------------------------------------------- */

/* Law: whatever the orientation of single elements in the file, the mesh has that of most of them.
 */
static void test_orientation(void **state)
{
    (void)state;
    grid_fill(&grid, 6, 6, plate, 3);
    write_grid(MSH4_TEXT);
    quad_mesh first = read_valid();
    for (size_t n = 0; n < first.nodes; n++)
        assert_true(first.director[n][2] > 1 - 4 * DBL_EPSILON);
    for (unsigned seed = 1; seed < 6; seed++) {
        grid_flip(&grid, seed);
        write_grid(MSH4_TEXT);
        quad_mesh mesh = read_valid();
        const double up = mesh.director[0][2];
        for (size_t n = 0; n < mesh.nodes; n++)
            assert_true(mesh.director[n][2] * up > 1 - 8 * DBL_EPSILON);
        quad_mesh_free(&mesh);
    }
    quad_mesh_free(&first);
}

/* Law: `is_flipped` turns every director round. */
static void test_flip(void **state)
{
    (void)state;
    const quad_options turned = {1, true, 60000};
    grid_fill(&grid, 3, 3, sphere, 0);
    write_grid(MSH4_TEXT);
    quad_mesh mesh = read_valid();
    result other = read_with(&turned);
    for (size_t n = 0; n < mesh.nodes; n++)
        for (int i = 0; i < 3; i++)
            assert_true(fabs(mesh.director[n][i] + other.mesh.director[n][i]) < 1e-14);
    quad_mesh_free(&mesh);
    quad_mesh_free(&other.mesh);
}

static void refuse(const char *text, const char *says)
{
    write_text(text);
    const result r = read_with(&plain);
    if (r.status == 0 || !strstr(r.error, says))
        fail_msg("'%s', expected '%s'", r.error, says);
}

/* Law: branched, one-sided and disconnected surfaces are refused with the elements by number. */
static void test_refused_surfaces(void **state)
{
    (void)state;
    refuse(HEAD2
           "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n7 1 0 1\n8 1 1 1\n"
           "$EndNodes\n$Elements\n3\n11 3 2 0 1 1 2 3 4\n12 3 2 0 1 2 5 6 3\n"
           "13 3 2 0 1 2 7 8 3\n$EndElements\n",
           ":19: elements 11, 12 and 13 share the edge of nodes 2 and 3");
    refuse(HEAD2
           "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n7 3 0 1\n8 3 1 1\n"
           "$EndNodes\n$Elements\n2\n11 3 2 0 1 1 2 3 4\n12 3 2 0 1 5 7 8 6\n$EndElements\n",
           "the mesh falls apart: 1 elements are joined, 1 are not, element 12 among them; "
           "if the part between them is missing, give it a physical group");
    refuse(HEAD2 "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n$EndNodes\n"
                 "$Elements\n2\n11 3 2 0 1 1 2 3 4\n12 3 2 0 1 2 6 5 3\n$EndElements\n",
           "element 12 is folded at node 2");
    refuse(HEAD2 "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0.3 0.3 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n$EndNodes\n"
                 "$Elements\n2\n11 3 2 0 1 1 2 3 4\n12 3 2 0 1 2 5 6 3\n$EndElements\n",
           "element 11 is folded at node 3");
    refuse(HEAD2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 3 0 0\n$EndNodes\n"
                 "$Elements\n1\n11 3 2 0 1 1 2 3 4\n$EndElements\n",
           "element 11 has no area");
    char strip[4000];
    int n = snprintf(strip, sizeof strip, HEAD2 "$Nodes\n24\n");
    for (int i = 0; i < 12; i++)
        for (int side = 0; side < 2; side++) {
            const double a = i * 6.283185307179586 / 12, w = (side - 0.5) * 0.6;
            n += snprintf(strip + n, sizeof strip - (size_t)n, "%d %.9f %.9f %.9f\n",
                          2 * i + side + 1, (2 + w * cos(a / 2)) * cos(a),
                          (2 + w * cos(a / 2)) * sin(a), w * sin(a / 2));
        }
    n += snprintf(strip + n, sizeof strip - (size_t)n, "$EndNodes\n$Elements\n12\n");
    for (int i = 0; i < 12; i++) {
        const int last = i == 11, first = 2 * i + 1, next = 2 * ((i + 1) % 12) + 1;
        n += snprintf(strip + n, sizeof strip - (size_t)n, "%d 3 2 0 1 %d %d %d %d\n", i + 1, first,
                      last ? next + 1 : next, last ? next : next + 1, first + 1);
    }
    snprintf(strip + n, sizeof strip - (size_t)n, "$EndElements\n");
    refuse(strip, "the surface has one side alone, as a Moebius strip");
}

/*
 * Law: nodes without elements do not count, and are named: those of the file, in ascending order,
 * and those of each set of nodes, once each.
 */
static void test_loose_nodes(void **state)
{
    (void)state;
    static const char *const files[2] = {
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n9 5 5 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n"
        "4 0 1 0\n8 2 0 0\n7 2 1 0\n$EndNodes\n$Elements\n4\n1 3 2 0 1 1 2 3 4\n"
        "2 15 2 6 1 9\n3 15 2 6 2 2\n4 15 2 6 3 7\n$EndElements\n",
        "*NODE\n9, 5, 5, 0\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n8, 2, 0, 0\n"
        "7, 2, 1, 0\n*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*NSET, NSET=6\n9, 2, 9, 7\n"};
    for (int k = 0; k < 2; k++) {
        static const int64_t all[3] = {7, 8, 9};
        write_text(files[k]);
        result r = read_with(&plain);
        assert_int_equal(r.status, 0);
        assert_int_equal(r.mesh.nodes, 4);
        assert_int_equal(r.warnings.loose.count, 3);
        assert_memory_equal(r.warnings.loose.label, all, sizeof all);
        const quad_set *set = quad_set_find(r.mesh.node_set, r.mesh.node_sets, "6");
        assert_non_null(set);
        assert_int_equal(set->count, 1);
        assert_int_equal(set->loose.count, 2);
        assert_int_equal(set->loose.label[0], 7);
        assert_int_equal(set->loose.label[1], 9);
        quad_mesh_free(&r.mesh);
    }
}

/* Law: two nodes at one place that are not joined are named. */
static void test_slit(void **state)
{
    (void)state;
    write_text(HEAD2 "$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 2 0\n"
                     "8 1 2 0\n9 2 2 0\n10 1 0 0\n$EndNodes\n$Elements\n4\n1 3 2 0 1 1 2 5 4\n"
                     "2 3 2 0 1 10 3 6 5\n3 3 2 0 1 4 5 8 7\n4 3 2 0 1 5 6 9 8\n$EndElements\n");
    result r = read_with(&plain);
    assert_int_equal(r.status, 0);
    assert_int_equal(r.warnings.loose.count, 0);
    assert_int_equal(r.warnings.slits, 1);
    assert_int_equal(r.warnings.slit[0], 2);
    assert_int_equal(r.warnings.slit[1], 10);
    quad_mesh_free(&r.mesh);
}

/* ---- directors ---------------------------------------------------------- */

/* Largest error of the directors of a unit sphere or cylinder, as the length of the difference. */
static double director_error(const quad_mesh *mesh, bool is_sphere)
{
    double worst = 0;
    for (size_t n = 0; n < mesh->nodes; n++) {
        const double *x = mesh->position[n], *d = mesh->director[n];
        const double sign = d[0] * x[0] + d[1] * x[1] > 0 ? 1 : -1;
        const double exact[3] = {sign * x[0], sign * x[1], is_sphere ? sign * x[2] : 0};
        worst = fmax(worst, hypot(hypot(d[0] - exact[0], d[1] - exact[1]), d[2] - exact[2]));
    }
    return worst;
}

/* Law: a cylinder whose mesh follows its lines has exact directors, on its free edges too. */
static void test_cylinder_directors(void **state)
{
    (void)state;
    grid_fill(&grid, 12, 3, cylinder, 9);
    write_grid(MSH4_BINARY);
    quad_mesh mesh = read_valid();
    assert_true(director_error(&mesh, false) < 1e-13);
    for (size_t n = 0; n < mesh.nodes; n++) {
        double along = 0, length = 0;
        for (int i = 0; i < 3; i++) {
            along += mesh.axis[n][i] * mesh.director[n][i];
            length += mesh.axis[n][i] * mesh.axis[n][i];
        }
        assert_true(fabs(along) < 8 * DBL_EPSILON && fabs(length - 1) < 8 * DBL_EPSILON);
    }
    quad_mesh_free(&mesh);
}

/* Law: on a distorted mesh of a sphere the directors converge with second order, to the edges. */
static void test_sphere_directors(void **state)
{
    (void)state;
    double error[3];
    for (int k = 0; k < 3; k++) {
        grid_fill(&grid, 8 << k, 6 << k, sphere, 2);
        write_grid(MSH4_TEXT);
        quad_mesh mesh = read_valid();
        error[k] = director_error(&mesh, true);
        quad_mesh_free(&mesh);
    }
    assert_true(error[2] < 1e-3);
    if (error[1] > error[0] / 3.2 || error[2] > error[1] / 3.2)
        fail_msg("errors %.3g %.3g %.3g", error[0], error[1], error[2]);
}

/* Two plates that meet at a right angle along y. */
static void corner(double u, double v, double x[3])
{
    x[0] = fmin(u, 0.5);
    x[1] = v;
    x[2] = fmax(u - 0.5, 0);
}

/* Law: at a sharp edge the director is the mean of the two sides, which keep theirs; it is told. */
static void test_sharp_edge(void **state)
{
    (void)state;
    grid_fill(&grid, 6, 3, corner, 0);
    write_grid(MSH4_TEXT);
    result r = read_with(&plain);
    assert_int_equal(r.status, 0);
    assert_true(fabs(r.warnings.sharp_angle - 90) < 1e-9);
    assert_int_equal(r.warnings.slits, 0);
    for (size_t n = 0; n < r.mesh.nodes; n++) {
        const double *x = r.mesh.position[n], *d = r.mesh.director[n];
        const double of_edge = x[2] > 1e-9 ? 0 : sqrt(0.5);
        const double flat = x[0] < 0.5 - 1e-9 ? 1 : of_edge;
        assert_true(fabs(d[2] - flat) < 1e-14);
    }
    quad_mesh_free(&r.mesh);
}

/* ---- order --------------------------------------------------------------- */

/* Largest and mean distance between a node and its first neighbour in the order. */
static void widths(const quad_mesh *mesh, double *largest, double *mean)
{
    uint32_t *at = calloc(mesh->nodes, sizeof *at), *first = calloc(mesh->nodes, sizeof *first);
    for (uint32_t i = 0; i < mesh->nodes; i++)
        at[mesh->order[i]] = first[mesh->order[i]] = i;
    for (size_t e = 0; e < mesh->elements; e++)
        for (int r = 0; r < 4; r++)
            for (int k = 0; k < 4; k++) {
                uint32_t *own = &first[mesh->element[e][r]];
                const uint32_t other = at[mesh->element[e][k]];
                *own = other < *own ? other : *own;
            }
    *largest = *mean = 0;
    for (size_t n = 0; n < mesh->nodes; n++) {
        *largest = fmax(*largest, at[n] - first[n]);
        *mean += (double)(at[n] - first[n]) / (double)mesh->nodes;
    }
    free(at);
    free(first);
}

/* Law: the order is a permutation; on a grid its width is that of its lines, n + 2 for n elements.
 */
static void test_order(void **state)
{
    static const int sizes[][2] = {{100, 9}, {9, 100}, {30, 30}};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const int *n = sizes[k], narrow = n[0] < n[1] ? n[0] : n[1];
        grid_fill(&grid, n[0], n[1], plate, 17);
        write_grid(MSH4_BINARY);
        quad_mesh mesh = read_valid();
        unsigned char *seen = calloc(mesh.nodes, 1);
        double largest, mean;
        for (size_t i = 0; i < mesh.nodes; i++)
            assert_int_equal(seen[mesh.order[i]]++, 0);
        widths(&mesh, &largest, &mean);
        assert_true(mean <= narrow + 2 && largest <= narrow + 3);
        free(seen);
        quad_mesh_free(&mesh);
    }
}

/*
 * Return the envelope of an order that is found in the simplest way: all nodes level by level from
 * a node that is farthest from the first one, in reverse.
 */
static uint64_t envelope_of_levels(const quad_graph *graph)
{
    uint32_t *order = calloc(graph->nodes, sizeof *order), *place = calloc(graph->nodes, 4);
    unsigned char *seen = malloc(graph->nodes);
    for (int round = 0; round < 2; round++) {
        uint32_t count = 1;
        memset(seen, 0, graph->nodes);
        seen[order[0]] = 1;
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = graph->start[order[i]]; k < graph->start[order[i] + 1]; k++)
                if (!seen[graph->neighbour[k]]++)
                    order[count++] = graph->neighbour[k];
        assert_int_equal(count, graph->nodes);
        for (uint32_t i = 0; i < count / 2; i++) {
            const uint32_t swap = order[i];
            order[i] = order[count - 1 - i];
            order[count - 1 - i] = swap;
        }
    }
    const uint64_t envelope = quad_envelope(graph, order, place);
    free(order);
    free(place);
    free(seen);
    return envelope;
}

/*
 * Check the order of a mesh, and release the mesh. Returns its envelope relative to that of
 * envelope_of_levels.
 */
static double check_order(quad_mesh *mesh)
{
    quad_graph graph;
    double largest, mean;
    uint32_t *place = calloc(mesh->nodes, sizeof *place);
    assert_int_equal(quad_graph_make(&graph, mesh), 0);
    const uint64_t envelope = quad_envelope(&graph, mesh->order, place);
    for (uint32_t i = 0; i < mesh->nodes; i++)
        assert_int_equal(place[mesh->order[i]], i);
    widths(mesh, &largest, &mean);
    assert_true(fabs(mean * (double)mesh->nodes - (double)envelope) < 0.5);
    const double relative = (double)envelope / (double)envelope_of_levels(&graph);
    quad_graph_free(&graph);
    quad_mesh_free(mesh);
    free(place);
    return relative;
}

/*
 * Law: the order is a permutation, and its envelope is that of its widths. It is never larger than
 * that of an order by levels, and on the disc of hexagons a fifth smaller.
 */
static void test_envelope(void **state)
{
    static void (*const surface[])(double, double, double[3]) = {plate, cylinder, sphere};
    static const char *const shipped[] = {"hex-mirror", "wing-panel"};
    (void)state;
    for (int k = 0; k < 6; k++) {
        grid_fill(&grid, k < 3 ? 24 : 40, k < 3 ? 24 : 7, surface[k % 3], 5);
        write_grid(MSH4_BINARY);
        quad_mesh mesh = read_valid();
        assert_true(check_order(&mesh) <= 1);
    }
    for (int k = 0; k < 2; k++) {
        char name[64], error[QUAD_ERROR];
        quad_mesh mesh;
        quad_warnings warnings;
        snprintf(name, sizeof name, "host_tools/scenes/%s.msh", shipped[k]);
        assert_int_equal(quad_read(&mesh, name, &plain, &warnings, error), 0);
        assert_true(check_order(&mesh) <= (k == 0 ? 0.8 : 1));
    }
}

/*
 * Law: Sloan's algorithm numbers a strip of n x 2 elements from the first node on with the envelope
 * of its lines, and line by line where the distance weighs as much as the growth of the front.
 */
static void test_sloan_strip(void **state)
{
    uint32_t distance[63], order[63], place[63];
    quad_graph graph;
    (void)state;
    grid_fill(&grid, 20, 2, plate, 0);
    write_grid(MSH4_TEXT);
    quad_mesh mesh = read_valid();
    assert_int_equal(mesh.nodes, 63);
    assert_int_equal(quad_graph_make(&graph, &mesh), 0);
    for (uint32_t node = 0; node < 63; node++)
        distance[node] = (uint32_t)(10 * mesh.position[node][0] + 0.5);
    uint32_t first = 0;
    for (uint32_t node = 0; node < 63; node++)
        if (distance[node] == 20 && mesh.position[node][1] < mesh.position[first][1] + 1e-9)
            first = node;
    for (int weight = 1; weight <= 4; weight++) {
        assert_int_equal(quad_sloan(&graph, distance, first, weight, order), 0);
        assert_int_equal(order[0], first);
        /* a grid whose lines have m = 3 nodes has at best the widths m + 1 within a line, m at its
         * first node, and j in the first line */
        assert_true(quad_envelope(&graph, order, place) <= 4u * 60u + 3u);
        for (uint32_t i = 0; i < 63; i++)
            assert_true(weight > 1 || distance[order[i]] + i / 3 == 20);
    }
    quad_graph_free(&graph);
    quad_mesh_free(&mesh);
}

/* ---- damaged files ------------------------------------------------------- */

static unsigned next_random(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* Change, remove or repeat bytes. Returns the new length. */
static size_t mutate(unsigned char *bytes, size_t length, size_t room, unsigned *seed)
{
    static const char *const pieces[] = {"-1", "99999999999999", "nan", "$Nodes\n",         "1e999",
                                         ",",  "*ELEMENT",       "\n",  "\377\377\377\377", " 0 "};
    for (unsigned k = 1 + next_random(seed) % 4; k > 0; k--) {
        const size_t at = next_random(seed) % length;
        const char *piece = pieces[next_random(seed) % 10];
        const size_t size = strlen(piece);
        switch (next_random(seed) % 4) {
        case 0: bytes[at] = (unsigned char)next_random(seed); break;
        case 1: bytes[at] ^= (unsigned char)(1u << next_random(seed) % 8); break;
        case 2: length = at + 1; break;
        default:
            if (length + size < room) {
                memmove(bytes + at + size, bytes + at, length - at);
                memcpy(bytes + at, piece, size);
                length += size;
            }
        }
    }
    return length;
}

static void check_invariants(const quad_mesh *mesh)
{
    for (size_t e = 0; e < mesh->elements; e++)
        for (int r = 0; r < 4; r++)
            assert_true(mesh->element[e][r] < mesh->nodes);
    for (size_t n = 0; n < mesh->nodes; n++) {
        double length = 0;
        for (int i = 0; i < 3; i++)
            length += mesh->director[n][i] * mesh->director[n][i];
        assert_true(fabs(length - 1) < 1e-9);
    }
    for (size_t k = 0; k < mesh->edge_sets; k++)
        for (size_t i = 0; i < mesh->edge_set[k].count; i++)
            assert_true(mesh->edge_set[k].index[i] < 4 * mesh->elements);
}

/*
 * Law: 100 MB of zeros behind a valid beginning of a mesh file are refused within four seconds of
 * processor time, the sanitizers included.
 */
static void test_large_garbage(void **state)
{
    static const char *const head[] = {"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n",
                                       "$MeshFormat\n4.1 1 8\n", "*NODE\n1, 0, 0, 0\n", "*", "$"};
    (void)state;
    for (size_t k = 0; k < sizeof head / sizeof *head; k++) {
        const clock_t begin = clock();
        write_text(head[k]);
        assert_int_equal(truncate(path, 100000000), 0);
        const result r = read_with(&plain);
        assert_int_equal(r.status, -1);
        assert_true(strlen(r.error) > 20);
        assert_true((double)(clock() - begin) < 4.0 * CLOCKS_PER_SEC);
    }
    write_text("");
}

/* Write a mesh file of one element that lists `sets` sets by lines of the given format. */
static void write_many_sets(const char *head, const char *line, int sets, const char *tail)
{
    FILE *file = open_file();
    fprintf(file, "%s", head);
    for (int i = 1; i <= sets; i++)
        fprintf(file, line, i, i);
    fprintf(file, "%s", tail);
    fclose(file);
}

/*
 * Law: a file with 300,000 sets is refused within four seconds of processor time, however it lists
 * them; one with 10,000 is read.
 */
static void test_many_sets(void **state)
{
#define GMSH_NODES "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n"
#define GMSH "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define INP                                                                                        \
    "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n"
    static const struct {
        const char *head, *line, *tail;
    } row[] = {
        {GMSH GMSH_NODES "300000\n", "%d 3 2 %d 1 1 2 3 4\n", "$EndElements\n"},
        {GMSH "$PhysicalNames\n300000\n", "2 %d \"%d\"\n",
         "$EndPhysicalNames\n" GMSH_NODES "1\n1 3 2 1 1 1 2 3 4\n$EndElements\n"},
        {INP, "*ELSET, ELSET=s%d\n1\n**%d\n", ""},
        {INP, "*NSET, NSET=s%d\n1\n**%d\n", ""},
    };
    (void)state;
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        const clock_t begin = clock();
        write_many_sets(row[k].head, row[k].line, 300000, row[k].tail);
        const result r = read_with(&plain);
        assert_int_equal(r.status, -1);
        if (!strstr(r.error, "the file has more than 10000 sets"))
            fail_msg("case %zu: %s", k, r.error);
        assert_true((double)(clock() - begin) < 4.0 * CLOCKS_PER_SEC);
    }
    write_many_sets(INP, "*ELSET, ELSET=s%d\n1\n**%d\n", 10000, "");
    result r = read_with(&plain);
    assert_int_equal(r.status, 0);
    assert_int_equal(r.mesh.element_sets, 10000);
    quad_mesh_free(&r.mesh);
}

/* Law: a damaged file is refused with a message, or is a mesh with unit directors. */
static void test_damaged_files(void **state)
{
    (void)state;
    enum { ROOM = 20000 };
    static unsigned char whole[ROOM], bytes[ROOM];
    unsigned seed = 1;
    grid_fill(&grid, 3, 2, sphere, 4);
    for (int format = 0; format < FORMATS; format++) {
        write_grid((mesh_format)format);
        FILE *file = fopen(path, "rb");
        const size_t length = fread(whole, 1, ROOM, file);
        fclose(file);
        assert_true(length > 500 && length < ROOM - 200);
        for (int k = 0; k < MUTATIONS / FORMATS; k++) {
            memcpy(bytes, whole, length);
            const size_t changed = mutate(bytes, length, ROOM, &seed);
            file = open_file();
            fwrite(bytes, 1, changed, file);
            fclose(file);
            result r = read_with(&plain);
            if (r.status == 0)
                check_invariants(&r.mesh);
            else
                assert_true(strlen(r.error) > 20);
            quad_mesh_free(&r.mesh);
        }
    }
}

static int remove_file(void **state)
{
    (void)state;
    return remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats_agree),
        cmocka_unit_test(test_sets),
        cmocka_unit_test(test_unit),
        cmocka_unit_test(test_refused_files),
        cmocka_unit_test(test_byte_order),
        cmocka_unit_test(test_refused_sizes),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_flip),
        cmocka_unit_test(test_refused_surfaces),
        cmocka_unit_test(test_loose_nodes),
        cmocka_unit_test(test_slit),
        cmocka_unit_test(test_cylinder_directors),
        cmocka_unit_test(test_sphere_directors),
        cmocka_unit_test(test_sharp_edge),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_envelope),
        cmocka_unit_test(test_sloan_strip),
        cmocka_unit_test(test_large_garbage),
        cmocka_unit_test(test_many_sets),
        cmocka_unit_test(test_damaged_files),
    };
    const int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    return cmocka_run_group_tests_name("quads", tests, NULL, remove_file);
}
