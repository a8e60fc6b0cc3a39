/* eng_fresh.c - the answer of a scene that has been through nothing. */
#include "eng_fresh.h"

#include <stdlib.h>
#include <string.h>

void fresh_find(const struct player *player, const struct eng_question *settings,
                struct fresh_answer *answer)
{
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    struct player copy;
    plain.mode = settings->mode;
    plain.tolerance = settings->tolerance;
    plain.contact_max = settings->contact_max;
    plain.distance = settings->distance;
    plain.approach = settings->approach;
    plain.tells_start = settings->tells_start;
    player_copy(player, NULL, &copy);
    assert_ok(player_step(&copy, &plain, &answer->result));
    size_t bytes = answer->result.count * answer->result.record_bytes;
    answer->records = malloc(bytes + 1);
    assert_non_null(answer->records);
    if (bytes > 0) {
        memcpy(answer->records, answer->result.records, bytes);
    }
    answer->result.records = answer->records;
    player_deinit(&copy);
}

void fresh_free(struct fresh_answer *answer)
{
    free(answer->records);
    memset(answer, 0, sizeof *answer);
}

const char *fresh_difference(const struct fresh_answer *fresh,
                             const struct eng_step_result *result)
{
    const struct eng_step_result *want = &fresh->result;
    if (result->mode != want->mode || result->incomplete != want->incomplete) {
        return "whether it is complete";
    }
    if (result->verdict != want->verdict) {
        return "the verdict";
    }
    if (result->count != want->count ||
        memcmp(result->counts, want->counts, sizeof want->counts) != 0) {
        return "the number of records";
    }
    if (result->record_bytes != want->record_bytes ||
        (want->count > 0 &&
         memcmp(result->records, want->records, want->count * want->record_bytes) != 0)) {
        return "the records";
    }
    if (result->toi_first != want->toi_first || result->possible != want->possible ||
        result->initial != want->initial) {
        return "what is counted of the records";
    }
    if (result->safe_step != want->safe_step || result->inside != want->inside) {
        return "how far it is safe, or what began inside";
    }
    if (result->crossings != want->crossings ||
        result->start_inside != want->start_inside) {
        return "how it begins";
    }
    if (memcmp(result->hash, want->hash, sizeof want->hash) != 0) {
        return "the hash";
    }
    return NULL;
}
