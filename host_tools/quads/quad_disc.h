/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of a disc without a hole, flat or part of a sphere or of a paraboloid: a block of
 * quadrilaterals around the centre and rings of quadrilaterals around the block, so that no element
 * is a triangle.
 */
#ifndef QUAD_DISC_H
#define QUAD_DISC_H

#include "quad_mesh.h"

enum { QUAD_RINGS = 16 };

typedef struct quad_disc {
    double radius; /* radius of the disc's rim (m) */
    double sphere; /* radius of the sphere of which the disc is a part, with the centre below the
                      disc (m); 0: no sphere */
    double focal;  /* focal length of the paraboloid of which the disc is a part, with the focus
                      above the disc (m); 0: no paraboloid. A disc without sphere and paraboloid is
                      flat */
    double ring[QUAD_RINGS]; /* [rings] radii of circles on the disc that no element crosses,
                                ascending, without the rim (m) */
    int rings;    /* number of circles on the disc, besides the rim, that no element crosses */
    int elements; /* number of elements along a side of the middle block of the disc, even; every
                     circle on the disc has four times as many */
    int sectors;  /* number of equal angular sectors into which each ring between neighbouring
                     circles is divided; the elements of each sector are a named set, for example
                     for an electrode. The area inside the innermost circle is not divided. A
                     divisor of the number of elements along a circle */
} quad_disc;

/*
 * Make the mesh of a disc around the z axis, with the outer face towards +z. The plane z = 0
 * contains a flat disc, the rim of a dome, or the lowest point of a paraboloid. The numbers in
 * `disc` must be in their ranges. Named sets:
 *   nodes     centre
 *   edges     rim
 *   elements  ring1 inside the first circle, ring2 and so on to the rim; with sectors ring2-1,
 *       ring2-2 and so on, the first beginning at the x axis
 * Returns 0, or -1 with the mesh empty when memory runs out.
 */
int quad_disc_make(quad_mesh *mesh, const quad_disc *disc);

#endif
