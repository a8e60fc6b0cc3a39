/* eng_fresh.h - what a scene made anew answers, to compare with. */
#ifndef TEST_ENG_FRESH_H
#define TEST_ENG_FRESH_H

#include "eng_player.h"

/* All of an answer but its counters and times. `records` is ours. */
struct fresh_answer {
    struct eng_step_result result;
    void *records;
};

/* Of the settings those that may change an answer: mode, tolerance, contact_max,
 * separation, approach. The player stays as it is. */
void fresh_find(const struct player *player, const struct eng_question *settings,
                struct fresh_answer *answer);
void fresh_free(struct fresh_answer *answer);

/* What is not the same, byte for byte, in words; NULL: everything is. */
const char *fresh_difference(const struct fresh_answer *fresh,
                             const struct eng_step_result *result);

#endif
