/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of a rectangular panel with a circular hole, flat or part of a cylinder: a square block of
 * elements around the hole, and eight rectangular blocks around it.
 */
#ifndef QUAD_PANEL_H
#define QUAD_PANEL_H

#include "quad_mesh.h"

typedef struct quad_panel {
    double length;    /* extent of the panel along x (m) */
    double width;     /* extent of the panel along y, on a cylinder along its circumference (m) */
    double hole;      /* radius of the hole, on a cylinder measured along the surface (m) */
    double centre[2]; /* centre of the hole along x and along the width, from the middle of the
                         panel (m) */
    double cylinder;  /* radius of the cylinder along the x axis of which the panel is a part (m);
                         0: the panel is flat */
    int elements;     /* number of elements along a quarter of the hole's rim */
} quad_panel;

/*
 * Make the mesh of a panel around the origin. A flat panel lies in the plane z = 0; a panel on a
 * cylinder has its highest line, the middle, at z = 0. There the outer face looks along +z. The
 * numbers in `panel` must be in their ranges. Named sets:
 *   edges     left and right (ends along x), bottom and top (ends along y), hole
 *   elements  around_hole
 * Returns 0, or -1 with the mesh empty when memory runs out.
 */
int quad_panel_make(quad_mesh *mesh, const quad_panel *panel);

/*
 * For a panel on a cylinder, return the smallest number of elements along a quarter of the hole's
 * rim with which the elements around the hole are at most about a quarter of the cylinder's radius
 * long. At a thickness of a thousandth of the radius, longer elements of an irregular mesh are
 * refused.
 */
int quad_panel_least_elements(const quad_panel *panel);

/* Return the number of nodes of a panel's mesh. */
size_t quad_panel_nodes(const quad_panel *panel);

#endif
