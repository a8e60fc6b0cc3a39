/* registry_pairs.c - pairs of objects that ignore each other, or have a clearance. */
#include "registry.h"

#include <assert.h>
#include <stdlib.h>

#include "pccd_types.h"

#define ROOM_MIN 64u

static int compare(const void *left, const void *right)
{
    const struct registry_pair *l = left;
    const struct registry_pair *r = right;

    if (l->a != r->a) {
        return l->a < r->a ? -1 : 1;
    }
    if (l->b != r->b) {
        return l->b < r->b ? -1 : 1;
    }
    return l->order < r->order ? -1 : l->order > r->order;
}

void registry_pairs_settle(struct registry_pairs *pairs)
{
    uint32_t kept = 0;

    if (!pairs->is_unsettled) {
        return;
    }
    pairs->is_unsettled = false;
    if (pairs->count == 0) { /* where there may be no array, either */
        return;
    }
    qsort(pairs->said, pairs->count, sizeof *pairs->said, compare);
    for (uint32_t i = 0; i < pairs->count; i++) {
        const struct registry_pair *pair = &pairs->said[i];
        bool is_last = i + 1 == pairs->count || pairs->said[i + 1].a != pair->a ||
                       pairs->said[i + 1].b != pair->b;

        if (is_last && (pair->ignored || pair->has_clearance)) {
            pairs->said[kept] = *pair;
            pairs->said[kept].order = kept;
            kept++;
        }
    }
    assert(kept <= pairs->count);
    pairs->count = kept;
}

static int make_room(struct registry_pairs *pairs)
{
    struct registry_pair *said;
    uint32_t room;

    if (pairs->count < pairs->room) {
        return 0;
    }
    registry_pairs_settle(pairs);
    if (pairs->room > 0 && pairs->count <= pairs->room / 2) {
        return 0;
    }
    room = pairs->room == 0 ? ROOM_MIN : pairs->room * 2;
    said = realloc(pairs->said, room * sizeof *said);
    if (said == NULL) {
        return PCCD_E_NOMEM;
    }
    pairs->said = said;
    pairs->room = room;
    return 0;
}

int registry_pairs_note(struct registry_pairs *pairs, const struct registry_pair *said)
{
    int status = make_room(pairs);

    if (status == 0) {
        struct registry_pair *pair = &pairs->said[pairs->count];

        *pair = *said;
        pair->a = said->a < said->b ? said->a : said->b;
        pair->b = said->a < said->b ? said->b : said->a;
        pair->order = pairs->count;
        assert(pairs->count < pairs->room);
        pairs->count++;
        pairs->is_unsettled = true;
    }
    return status;
}

void registry_pairs_forget(struct registry_pairs *pairs, uint32_t object)
{
    uint32_t kept = 0;

    for (uint32_t i = 0; i < pairs->count; i++) {
        if (pairs->said[i].a != object && pairs->said[i].b != object) {
            pairs->said[kept] = pairs->said[i];
            pairs->said[kept].order = kept; /* they stay in their order */
            kept++;
        }
    }
    pairs->count = kept;
}

const struct registry_pair *registry_pairs_find(const struct registry_pairs *pairs,
                                                uint32_t a, uint32_t b)
{
    const struct registry_pair key = {.a = a < b ? a : b, .b = a < b ? b : a};
    uint32_t first = 0;
    uint32_t end = pairs->count;

    assert(!pairs->is_unsettled);
    while (first < end) {
        uint32_t middle = first + (end - first) / 2;
        const struct registry_pair *pair = &pairs->said[middle];

        if (pair->a == key.a && pair->b == key.b) {
            return pair;
        }
        if (pair->a < key.a || (pair->a == key.a && pair->b < key.b)) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return NULL;
}

double registry_pairs_clearance(const struct registry_pairs *pairs, uint32_t a,
                                uint32_t b)
{
    const struct registry_pair *pair =
        pairs->count > 0 && a != b ? registry_pairs_find(pairs, a, b) : NULL;

    return pair != NULL && pair->has_clearance ? pair->clearance : -1;
}

double registry_pairs_half_clearance(const struct registry_pairs *pairs, uint32_t object)
{
    double most = 0;

    for (uint32_t i = 0; i < pairs->count; i++) {
        const struct registry_pair *pair = &pairs->said[i];

        if (pair->has_clearance && (pair->a == object || pair->b == object) &&
            pair->clearance / 2 > most) {
            most = pair->clearance / 2;
        }
    }
    return most;
}

void registry_pairs_deinit(struct registry_pairs *pairs)
{
    free(pairs->said);
}
