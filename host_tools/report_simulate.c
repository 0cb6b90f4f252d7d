/* Page of `pzs simulate` (report_simulate.h). */
#include "report_simulate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report.h"
#include "report_html.h"
#include "report_parts.h"
#include "report_plane.h"
#include "report_space.h"

/* ---- record ----------------------------------------------------------- */

int record_open(simulate_record *r, const simulation *s)
{
    const design *d = &s->nominal->design;
    memset(r, 0, sizeof *r);
    r->ticks = d->scene->simulate.ticks;
    r->bins = r->ticks < RECORD_BINS ? r->ticks : RECORD_BINS;
    r->amplifiers = d->amplifiers;
    r->lower = d->lower;
    r->upper = d->upper;
    r->volt = calloc((size_t)(RECORD_BINS * d->amplifiers), sizeof *r->volt);
    return r->volt ? 0 : -1;
}

void record_close(simulate_record *r)
{
    free(r->volt);
    memset(r, 0, sizeof *r);
}

void record_tick(simulate_record *r, const simulate_sample *sample)
{
    const int bin = (int)((double)sample->tick * r->bins / r->ticks);
    r->error[sample->law][bin] = fmax(r->error[sample->law][bin], sample->error);
    if (sample->law == LAW_CONTROLLER)
        memcpy(r->volt + (size_t)(bin * r->amplifiers), sample->volt, (size_t)r->amplifiers * sizeof *r->volt);
}

int report_simulate(FILE *file, const simulation *s, const simulate_record *r)
{
    (void)s; (void)r;
    html_begin(file, "x");
    html_end(file);
    return 0;
}
