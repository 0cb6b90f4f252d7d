/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts on what voltages for a target obey and leave out, for reports and terminal output. */
#ifndef VOLTAGES_WORDS_H
#define VOLTAGES_WORDS_H

#include "voltages.h"

/* Size of the text of voltages_words, with the terminating zero (characters). */
enum { VOLTAGES_TEXT = 8000 };

/*
 * Write a text of no or several lines, indented by two spaces after an empty line: numbers of
 * amplifiers with narrower limits than the common ones and of target rows that cannot move, active
 * limits between amplifiers, and free functions of the target.
 */
void voltages_words(const design *design, const voltages *result, char text[VOLTAGES_TEXT]);

#endif
