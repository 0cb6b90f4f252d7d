/* What the controller lends to those that work beside it. */
#ifndef PZS_CONTROL_H
#define PZS_CONTROL_H

#include "pzs.h"

#define CONTROL_READY 1u /* stage */

/* predicted = B volt, where volts have changed since the last tick. */
void control_predict(pzs_control *control);

/* Someone else has changed volts: the next step or tick starts from what they are. */
void control_moved(pzs_control *control);

#endif
