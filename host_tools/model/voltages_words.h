/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Texts for reports and terminal output on optimised voltages: which limits they reach, and which
 * parts of the target they cannot change.
 */
#ifndef VOLTAGES_WORDS_H
#define VOLTAGES_WORDS_H

#include "voltages.h"

/* Size of the text of voltages_words, with the terminating zero (characters). */
enum { VOLTAGES_TEXT = 8000 };

/*
 * Write a text on a result: the numbers of amplifiers with narrower limits than the common ones and
 * of target rows that cannot move, the active limits between amplifiers, and the free functions of
 * the target (shapes that may be added at no cost). The text is empty if there is nothing to say.
 * Otherwise it begins with a line end, and its lines are indented by two spaces.
 */
void voltages_words(const design *design, const voltages *result, char text[VOLTAGES_TEXT]);

#endif
