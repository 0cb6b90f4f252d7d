/*
 * Pictures over the parameter plane: values as a map, volts in their patches. theta1 runs down and
 * theta2 across, as the rows and columns of the printed volts; a polar plate is drawn as the disc
 * that it is, theta2 anticlockwise from the right.
 */
#ifndef REPORT_PLANE_H
#define REPORT_PLANE_H

#include "report_draw.h"

/* A map of value [nodes], bilinear between nodes; NaN is grey. */
void plane_map(FILE *file, const mesh *mesh, const double *value, const draw_scale *scale,
               const char *title);

/* Lay actuators whose patches overlap on plans of their own; a whole temperature gets -1. plan
 * [actuators] out. Returns the number of plans. */
int plane_plans(const scene *scene, int *plan);

typedef enum plane_outline { OUTLINE_NONE, OUTLINE_LIMIT, OUTLINE_BEYOND } plane_outline;

/*
 * Volts in the patches of the actuators with plan[actuator] == which.
 *   volt, outline [amplifiers] in
 */
void plane_volts(FILE *file, const mesh *mesh, const int *plan, int which, const double *voltage,
                 const plane_outline *outline, const draw_scale *scale, const char *title);

#endif
