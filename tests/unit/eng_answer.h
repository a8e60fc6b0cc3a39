/* eng_answer.h - answers to steps and questions, kept and compared. */
#ifndef TEST_ENG_ANSWER_H
#define TEST_ENG_ANSWER_H

#include "eng_player.h"

/* All of an answer but its counters, times and threads. `records` is ours. */
struct answer {
    struct eng_step_result result;
    void *records;
};

/* Version 2 of the hash of an answer with these records. */
void answer_hash(const void *records, uint64_t count, uint32_t record_bytes,
                 uint64_t hash[2]);

void answer_keep(const struct eng_step_result *result, struct answer *answer);
void answer_free(struct answer *answer);

/* Return what is not the same, byte for byte, in words; NULL: everything is. */
const char *answer_difference(const struct answer *want,
                              const struct eng_step_result *result);

/* The same asked of the same objects at the same positions in a scene that has been
 * through nothing, of a question by the other method, in the same request that moves it
 * there: one thread, no limits but contact_max. The player stays as it is. */
void answer_find_fresh(const struct player *player, const struct eng_question *question,
                       struct answer *answer);

#endif
