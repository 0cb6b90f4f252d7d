/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of a disc without a hole, flat or curved as part of a sphere: a block of squares around the
 * centre, and rings of quadrilaterals around it, so that no element is a triangle.
 */
#ifndef QUAD_DISC_H
#define QUAD_DISC_H

#include "quad_mesh.h"

enum { QUAD_RINGS = 16 };

typedef struct quad_disc {
    double radius;           /* of the rim (m) */
    double sphere;           /* radius of the sphere (m), centre below the disc; 0: flat */
    double ring[QUAD_RINGS]; /* radii of further circles along which elements end, ascending (m) */
    int rings;               /* number of these circles */
    int elements; /* elements along a side of the middle block, an even number; four times as
                     many along every circle */
    int sectors;  /* sectors of equal angle into which each ring outside the first circle is
                     divided; a divisor of the elements along a circle */
} quad_disc;

/*
 * Make the mesh. The disc lies around the origin in the plane z = 0, or as a dome whose rim lies
 * there; the outer face looks along +z. Sets: nodes `centre`; edges `rim`; elements `ring1` inside
 * the first circle, then `ring2` ... to the rim, or with sectors `ring2-1`, `ring2-2` ..., the
 * first of which begins at the x axis. Returns 0, or -1 where memory runs out; the mesh is empty
 * then. The numbers of the disc must be in their ranges.
 */
int quad_disc_make(quad_mesh *mesh, const quad_disc *disc);

#endif
