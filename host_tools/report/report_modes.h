/* The modes of a target on the page of `pzs shape`: what is left of each, as a picture and a table.
 */
#ifndef REPORT_MODES_H
#define REPORT_MODES_H

#include <stdio.h>
#include "../model/modes.h"

/* A section of the page; nothing where the target lists no modes. */
void modes_section(FILE *file, const scene *scene, const modes *modes);

#endif
