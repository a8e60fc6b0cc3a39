/* eng_near.h - what a scene answers about what is near, kept and compared. */
#ifndef TEST_ENG_NEAR_H
#define TEST_ENG_NEAR_H

#include "eng_player.h"
#include "near.h"

/* All of an answer but its counters, times and threads. `records` is ours. */
struct near_answer {
    struct eng_step_result result;
    void *records;
};

/* Version 2 of the hash of an answer with these records. */
void near_hash(const void *records, uint64_t count, uint32_t record_bytes,
               uint64_t hash[2]);

void near_keep(const struct eng_step_result *result, struct near_answer *answer);
void near_free(struct near_answer *answer);

/* What is not the same, byte for byte, in words; NULL: everything is. */
const char *near_difference(const struct near_answer *want,
                            const struct eng_step_result *result);

/* The same asked of the same objects at the same positions in a scene that has been
 * through nothing, in the same request that moves it there: one thread, the other method,
 * no limits but contact_max. The player stays as it is. */
void near_find_fresh(const struct player *player, const struct eng_question *settings,
                     struct near_answer *answer);

#endif
