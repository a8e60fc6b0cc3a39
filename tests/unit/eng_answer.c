/* eng_answer.c - answers beside each other. */
#include "eng_answer.h"

#include "order.h"

void answer_hash(const void *records, uint64_t count, uint32_t record_bytes,
                 uint64_t hash[2])
{
    eng_hash_end(eng_hash_records(records, count, record_bytes), count, hash);
}

void answer_keep(const struct eng_step_result *result, struct answer *answer)
{
    size_t bytes = result->count * result->record_bytes;
    answer->result = *result;
    answer->records = test_copy(result->records, bytes);
    answer->result.records = answer->records;
}

void answer_free(struct answer *answer)
{
    free(answer->records);
    memset(answer, 0, sizeof *answer);
}

static const char *record_difference(const struct eng_step_result *want,
                                     const struct eng_step_result *result)
{
    if (result->count != want->count ||
        memcmp(result->counts, want->counts, sizeof want->counts) != 0) {
        return "the number of records";
    }
    if (result->record_bytes != want->record_bytes ||
        (want->count > 0 &&
         memcmp(result->records, want->records, want->count * want->record_bytes) != 0)) {
        return "the records";
    }
    return memcmp(result->hash, want->hash, sizeof want->hash) != 0 ? "the hash" : NULL;
}

const char *answer_difference(const struct answer *answer,
                              const struct eng_step_result *result)
{
    const struct eng_step_result *want = &answer->result;
    if (result->mode != want->mode || result->what != want->what ||
        result->incomplete != want->incomplete) {
        return "whether it is complete";
    }
    if (result->verdict != want->verdict) {
        return "the verdict";
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
        return "what crosses, or how it begins";
    }
    if (result->distance_min != want->distance_min ||
        result->distance_max != want->distance_max) {
        return "the least or the greatest distance";
    }
    return record_difference(want, result);
}

void answer_find_fresh(const struct player *player, const struct eng_question *question,
                       struct answer *answer)
{
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    struct player copy;
    plain.verb = question->verb;
    plain.mode = question->mode;
    plain.tolerance = question->tolerance;
    plain.contact_max = question->contact_max;
    plain.distance = question->distance;
    plain.approach = question->approach;
    plain.tells_start = question->tells_start;
    plain.gap = question->gap;
    plain.end = question->end;
    memcpy(plain.objects, question->objects, sizeof plain.objects);
    plain.tells_crossings = question->tells_crossings;
    plain.counts_only = question->counts_only;
    player_copy(player, NULL, &copy);
    struct eng_step_result result;
    if (question->verb == ENG_CONTACTS) {
        assert_ok(player_step(&copy, &plain, &result));
    } else {
        plain.method = eng_method_of(question) == PCCD_METHOD_WIDE ? PCCD_METHOD_PAPER
                                                                   : PCCD_METHOD_WIDE;
        result = kit_near(copy.scene, &plain);
        copy.is_staging = false;
    }
    answer_keep(&result, answer);
    player_deinit(&copy);
}
