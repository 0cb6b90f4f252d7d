/* The rigid body of a contact in a picture: the part of it that lies along the shell, as a
 * translucent net. */
#ifndef REPORT_BODY_H
#define REPORT_BODY_H

#include "../model/analysis.h"
#include "report_draw.h"

enum { BODY_LINES = 13 };

typedef struct body_net {
    int given;        /* the scene has a contact */
    double normal[3]; /* out of the body where the shell is nearest */
    double x[BODY_LINES][BODY_LINES][3];
} body_net;

/* Lay the net over the body where it stands at the equilibrium reached. vector [nodes][3] in
 * displacement of the shell */
void body_find(body_net *net, const analysis *analysis, const double *vector);

/* Include the net in a view; draw it where it stands between the shell and the eye (in_front) or
 * else behind the shell. */
void body_include(const body_net *net, draw_view *view);
void body_draw(FILE *file, const body_net *net, const draw_view *view, int in_front);

#endif
