/* verify_numbers.c - whether the numbers of an answer are those of its records.
 *
 * Source: proto/PROTOCOL.md, "What a step answers".
 */
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "payload.h"
#include "recorded_state.h"
#include "verify.h"

/* The numbers that records have. */
struct numbers {
    uint64_t total, counts[PCCD_KINDS_MAX], possible, initial, inside, coincident;
    double toi_first, safe_step;
    uint64_t hash[2];
};

static void count_contact(struct numbers *is, const struct pccd_contact *contact)
{
    bool is_initial = (contact->flags & PCCD_INITIAL) != 0;
    is->counts[contact->kind]++;
    is->possible += (contact->flags & PCCD_PROVED) == 0;
    is->initial += is_initial;
    is->inside += !is_initial && (contact->flags & PCCD_INSIDE) != 0;
    is->coincident += is_initial && common_is_at_vertices(contact->param);
    is->toi_first = fmin(is->toi_first, contact->toi);
}

/* Return whether anything of the step is thick, wherever it is. */
static bool has_thickness(const struct play_step *step)
{
    bool is_thick = step->frame->separation > 0;
    for (uint32_t i = 0; i < step->scene->object_count && !is_thick; i++) {
        const struct registry_object *object = &step->scene->objects[i];
        const uint32_t vertices = object->mesh->radii ? object->mesh->vertex_count : 1;
        for (uint32_t v = 0; v < vertices && !is_thick; v++) {
            is_thick = recorded_radius(object, &v, 1) > 0;
        }
        is_thick = is_thick ||
                   registry_pairs_half_clearance(&step->scene->pairs, object->handle) > 0;
    }
    return is_thick;
}

/* By records that have a kind each. */
static void number(const struct play_step *step, struct numbers *is)
{
    bool is_pairs = verify_mode(step) == PCCD_MODE_PAIRS;
    bool is_thick = has_thickness(step);
    *is = (struct numbers){.total = step->found.count, .toi_first = 2};
    for (uint64_t i = 0; i < step->found.count; i++) {
        if (is_pairs) {
            is->counts[step->pairs[i].kind]++;
        } else {
            count_contact(is, &step->contacts[i]);
        }
    }
    is->coincident = is_thick ? 0 : is->coincident;
    if (verify_mode(step) == PCCD_MODE_ANY) {
        record_verdict_hash(verify_verdict(step), is->hash);
    } else {
        record_answer_hash(
            is_pairs ? (const void *)step->pairs : (const void *)step->contacts,
            step->found.count, is_pairs ? sizeof *step->pairs : sizeof *step->contacts,
            is->hash);
    }
    bool is_empty = verify_mode(step) == PCCD_MODE_ANY
                        ? verify_verdict(step) == PCCD_VERDICT_NO
                        : step->found.count == 0;
    bool has_time = is->toi_first > 0 && is->toi_first <= 1;
    bool is_crossed = step->answer != NULL && step->answer->crossings > 0;
    is->safe_step = is_crossed || !verify_is_complete(step) ? 0
                    : is_empty                              ? 1
                    : has_time                              ? nextafter(is->toi_first, 0)
                                                            : 0;
}

/* ---- what was recorded ------------------------------------------------------------- */

/* X(member): what differs is named by it. */
#define NAMED(X)                                                                         \
    X(step)                                                                              \
    X(mode)                                                                              \
    X(what)                                                                              \
    X(verdict)                                                                           \
    X(total)                                                                             \
    X(counts)                                                                            \
    X(possible)                                                                          \
    X(initial)                                                                           \
    X(toi_first)                                                                         \
    X(distance_min)                                                                      \
    X(distance_max)                                                                      \
    X(crossings)                                                                         \
    X(hash)

const char *verify_recorded(const struct record_answer *then, struct record_answer must)
{
    must.incomplete = then->incomplete;
#define COMPARE(member)                                                                  \
    if (memcmp(&then->member, &must.member, sizeof must.member) != 0) {                  \
        return #member;                                                                  \
    }
    NAMED(COMPARE)
#undef COMPARE
    return memcmp(then, &must, sizeof must) != 0 ? "another number" : NULL;
}

/* Check that the records, or those of a daemon's answer to the same step, are what the
 * recorded answer says. */
static bool check_recorded(const struct play_step *step, const struct numbers *is,
                           struct verify_result *result)
{
    bool is_any = step->frame->mode == PCCD_MODE_ANY;
    struct record_answer must = {.step = step->number,
                                 .mode = step->frame->mode,
                                 .verdict = is_any ? verify_verdict(step)
                                                   : (uint32_t)PCCD_VERDICT_NONE,
                                 .total = is->total,
                                 .possible = is->possible,
                                 .initial = is->initial,
                                 .toi_first = is->toi_first};
    memcpy(must.counts, is->counts, sizeof must.counts);
    memcpy(must.hash, is->hash, sizeof must.hash);
    const char *name = verify_recorded(step->recorded, must);
    return name == NULL ||
           verify_wrong(result, step, NULL, "the recorded %s is not that of %s", name,
                        step->answer != NULL ? "a daemon's records"
                                             : "the recorded records");
}

/* ---- what a daemon answers --------------------------------------------------------- */

static bool check_daemon(const struct play_step *step, const struct numbers *is,
                         struct verify_result *result)
{
    const struct pccd_answer *now = step->answer;
    const char *name = NULL;
    uint32_t verdict =
        step->frame->mode == PCCD_MODE_ANY ? (uint32_t)now->verdict : PCCD_VERDICT_NONE;
#define SAME(member, what)                                                               \
    if (name == NULL && memcmp(&now->member, &is->member, sizeof is->member) != 0) {     \
        name = (what);                                                                   \
    }
    SAME(total, "total")
    SAME(counts, "number of a kind")
    SAME(possible, "possible")
    SAME(initial, "initial")
    SAME(inside, "inside")
    SAME(coincident, "coincident")
    SAME(toi_first, "toi_first")
    SAME(safe_step, "safe_step")
    SAME(hash, "hash")
#undef SAME
    name = name == NULL && (uint32_t)now->verdict != verdict ? "verdict" : name;
    name = name == NULL && (uint32_t)now->mode != step->frame->mode ? "mode" : name;
    bool is_split = is->coincident > is->total / 2;
    bool may_be_crowded = is->initial + is->inside > is->total / 2;
    name = name == NULL && (now->crowded ? !may_be_crowded : is_split) ? "crowded" : name;
    return name == NULL ||
           verify_wrong(result, step, NULL, "the daemon's %s is not that of its records",
                        name);
}

/* ---- both -------------------------------------------------------------------------- */

/* Return why an answer cannot have ended as it says; NULL: it can. */
static const char *misended(const struct play_step *step)
{
    uint32_t incomplete = verify_incomplete(step), verdict = verify_verdict(step);
    bool is_any = verify_mode(step) == PCCD_MODE_ANY;
    if (incomplete > PCCD_INCOMPLETE_UNDECIDED) {
        return "the answer is incomplete for no reason that there is";
    }
    if (is_any && (incomplete == PCCD_INCOMPLETE_RESULT_FULL ||
                   incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT)) {
        return "the answer of mode any has no records, and says that there were too many";
    }
    if (is_any && incomplete == PCCD_COMPLETE && verdict == PCCD_VERDICT_NONE) {
        return "the answer is complete, and has no verdict";
    }
    if (is_any && incomplete != PCCD_COMPLETE && verdict != PCCD_VERDICT_NONE) {
        return "the answer is not complete, and has a verdict";
    }
    if (is_any && verdict > PCCD_VERDICT_NONE) {
        return "the answer has a verdict that there is not";
    }
    if (incomplete == PCCD_COMPLETE && step->found.first_count < step->found.count) {
        return "the answer is complete, and its first page is not";
    }
    if (incomplete == PCCD_INCOMPLETE_RESULT_FULL && step->found.is_whole &&
        step->found.first_count == step->found.count) {
        return "the answer goes on behind its first page, which has all of it";
    }
    return NULL;
}

/* Check that each record of mode first can attain the earliest time: one that is only
 * possible sets none, as it may not meet at all. */
static bool check_earliest(const struct play_step *step, struct verify_result *result)
{
    double bound = INFINITY;
    for (uint64_t i = 0; i < step->found.count; i++) {
        bool is_proved = (step->contacts[i].flags & PCCD_PROVED) != 0;
        bound = is_proved ? fmin(bound, step->contacts[i].toi_hi) : bound;
    }
    for (uint64_t i = 0; i < step->found.count; i++) {
        if (step->contacts[i].toi > bound) {
            return verify_wrong(result, step, NULL,
                                "record %" PRIu64 ": another is earlier for certain", i);
        }
    }
    return true;
}

static int compare_numbers(const void *a, const void *b)
{
    uint64_t one = *(const uint64_t *)a, other = *(const uint64_t *)b;
    return (one > other) - (one < other);
}

/* Check that mode first-per-pair has one record of each two objects at most. */
static bool check_once(const struct play_step *step, struct verify_result *result)
{
    uint64_t count = step->found.count;
    uint64_t *objects = calloc(count + 1, sizeof *objects); /* the lower one first */
    bool is_once = objects != NULL;
    if (objects == NULL) {
        return verify_leave(result, "no memory to look whether a record of two objects "
                                    "is the only one");
    }
    for (uint64_t i = 0; i < count; i++) {
        uint64_t a = step->contacts[i].object_a, b = step->contacts[i].object_b;
        objects[i] = a < b ? a << 32 | b : b << 32 | a;
    }
    qsort(objects, count, sizeof *objects, compare_numbers);
    for (uint64_t i = 1; i < count && is_once; i++) {
        is_once = objects[i] != objects[i - 1];
    }
    free(objects);
    return is_once ||
           verify_wrong(result, step, NULL, "two records are of the same two objects");
}

/* Check an answer of which some records are not there: its recorded numbers by the
 * others. */
static bool check_part(const struct play_step *step, struct verify_result *result)
{
    const struct record_answer *then = step->recorded;
    uint64_t kinds = 0;
    bool fits = true;
    struct numbers is;
    number(step, &is);
    for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        kinds += then->counts[kind];
        fits = fits && is.counts[kind] <= then->counts[kind];
    }
    return (fits && is.possible <= then->possible && is.initial <= then->initial &&
            is.toi_first >= then->toi_first && kinds == then->total) ||
           verify_wrong(result, step, NULL,
                        "the recorded numbers do not fit those of its records that are "
                        "there");
}

/* Records that there should be, or should not. */
static bool check_pages(const struct play_step *step, uint64_t total,
                        struct verify_result *result)
{
    const char *whose = step->answer != NULL ? "a daemon gives" : "the recording has";
    if (step->found.is_torn) {
        return verify_wrong(result, step, NULL,
                            "a page of records that was fetched twice was not the same");
    }
    if (step->found.count > total || (verify_mode(step) == PCCD_MODE_ANY && total > 0) ||
        (step->found.count > 0 && step->found.count < total &&
         verify_incomplete(step) == PCCD_COMPLETE)) {
        return verify_wrong(result, step, NULL,
                            "its total is not that of the records: %" PRIu64
                            ", and %s %" PRIu64,
                            total, whose, step->found.count);
    }
    if (step->found.count < total && step->answer == NULL && !check_part(step, result)) {
        return false;
    }
    return step->found.count == total ||
           verify_leave(result,
                        "%s %" PRIu64 " of its %" PRIu64
                        " records: its numbers, and what is missing, are not checked",
                        whose, step->found.count, total);
}

bool verify_numbers(const struct play_step *step, struct verify_result *result)
{
    const struct record_answer *then = step->recorded;
    struct numbers is;
    uint64_t total = step->answer != NULL ? step->answer->total : then->total;
    const char *what = misended(step);
    if (verify_mode(step) != step->frame->mode) {
        what = "the answer is of another mode than the step";
    }
    if (what != NULL) {
        return verify_wrong(result, step, NULL, "%s", what);
    }
    if (!check_pages(step, total, result)) {
        return false;
    }
    if (step->found.count != total) {
        return true;
    }
    if (verify_mode(step) == PCCD_MODE_FIRST && verify_is_complete(step) &&
        !check_earliest(step, result)) {
        return false;
    }
    if (verify_mode(step) == PCCD_MODE_FIRST_PER_PAIR && !check_once(step, result)) {
        return false;
    }
    number(step, &is);
    if (step->answer != NULL && !check_daemon(step, &is, result)) {
        return false;
    }
    if (then == NULL) {
        return true;
    }
    if (step->answer != NULL &&
        (!play_is_complete(then->incomplete) || !verify_is_complete(step))) {
        return verify_leave(result, "it ended before it was done: only a daemon's answer "
                                    "was checked");
    }
    return check_recorded(step, &is, result);
}
