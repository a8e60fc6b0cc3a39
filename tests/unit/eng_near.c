/* eng_near.c - answers about what is near, beside each other. */
#include "eng_near.h"

#include <stdlib.h>
#include <string.h>

#include "order.h"

void near_hash(const void *records, uint64_t count, uint32_t record_bytes,
               uint64_t hash[2])
{
    eng_hash_end(eng_hash_records(records, count, record_bytes), count, hash);
}

void near_keep(const struct eng_step_result *result, struct near_answer *answer)
{
    size_t bytes = result->count * result->record_bytes;
    answer->result = *result;
    answer->records = malloc(bytes + 1);
    assert_non_null(answer->records);
    if (bytes > 0) {
        memcpy(answer->records, result->records, bytes);
    }
    answer->result.records = answer->records;
}

void near_free(struct near_answer *answer)
{
    free(answer->records);
    memset(answer, 0, sizeof *answer);
}

const char *near_difference(const struct near_answer *answer,
                            const struct eng_step_result *result)
{
    const struct eng_step_result *want = &answer->result;
    if (result->what != want->what || result->incomplete != want->incomplete) {
        return "whether it is complete";
    }
    if (result->verdict != want->verdict) {
        return "the verdict";
    }
    if (result->count != want->count || result->crossings != want->crossings ||
        memcmp(result->counts, want->counts, sizeof want->counts) != 0) {
        return "the number of records";
    }
    if (result->record_bytes != want->record_bytes ||
        (want->count > 0 &&
         memcmp(result->records, want->records, want->count * want->record_bytes) != 0)) {
        return "the records";
    }
    if (result->distance_min != want->distance_min ||
        result->distance_max != want->distance_max) {
        return "the least or the greatest distance";
    }
    if (memcmp(result->hash, want->hash, sizeof want->hash) != 0) {
        return "the hash";
    }
    return NULL;
}

void near_find_fresh(const struct player *player, const struct eng_question *settings,
                     struct near_answer *answer)
{
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    struct player copy;
    enum pccd_method method = eng_method_of(settings);
    plain.verb = settings->verb;
    plain.distance = settings->distance;
    plain.gap = settings->gap;
    plain.end = settings->end;
    memcpy(plain.objects, settings->objects, sizeof plain.objects);
    plain.tells_crossings = settings->tells_crossings;
    plain.counts_only = settings->counts_only;
    plain.contact_max = settings->contact_max;
    plain.method = method == PCCD_METHOD_WIDE ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE;
    player_copy(player, NULL, &copy);
    struct eng_step_result result = kit_near(copy.scene, &plain);
    copy.is_staging = false;
    near_keep(&result, answer);
    player_deinit(&copy);
}
