/* oracle_turning_parts.h - the search for a meeting, by two kinds of numbers. */
#ifndef ORACLE_TURNING_PARTS_H
#define ORACLE_TURNING_PARTS_H

#include "oracle_turning.h"

void oracle_turning_search(const struct oracle_turning *pair,
                           const struct oracle_turning_asked *asked, uint32_t spans,
                           struct oracle_turning_answer *answer);
void oracle_turning_search_fine(const struct oracle_turning *pair,
                                const struct oracle_turning_asked *asked, uint32_t spans,
                                struct oracle_turning_answer *answer);

#endif
