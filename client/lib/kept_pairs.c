/* kept_pairs.c - pairs of objects that ignore each other, for another daemon.
 *
 * Room:     client/lib.
 * Does:     see kept_pairs.h. What was said is settled when there is no room for more,
 *           and then there is room for as much again: a note costs a comparison or two
 *           for each doubling of their number.
 * Threads:  [owner].
 */
#include "kept_pairs.h"

#include <stdlib.h>

#include "pccd_types.h"

#define ROOM_MIN 64u

static int compare(const void *left, const void *right)
{
    const struct cli_kept_pair *l = left;
    const struct cli_kept_pair *r = right;

    if (l->a != r->a) {
        return l->a < r->a ? -1 : 1;
    }
    if (l->b != r->b) {
        return l->b < r->b ? -1 : 1;
    }
    return l->order < r->order ? -1 : l->order > r->order;
}

void cli_kept_pairs_settle(struct cli_kept_pairs *pairs)
{
    uint32_t kept = 0;

    if (pairs->count == 0) {
        return;
    }
    qsort(pairs->said, pairs->count, sizeof(*pairs->said), compare);
    for (uint32_t i = 0; i < pairs->count; i++) {
        const struct cli_kept_pair *pair = &pairs->said[i];
        bool is_last = i + 1 == pairs->count || pairs->said[i + 1].a != pair->a ||
                       pairs->said[i + 1].b != pair->b;

        if (is_last && pair->ignored) {
            pairs->said[kept] = *pair;
            pairs->said[kept].order = kept;
            kept++;
        }
    }
    pairs->count = kept;
}

static int make_room(struct cli_kept_pairs *pairs)
{
    struct cli_kept_pair *said;
    uint32_t room;

    if (pairs->count < pairs->room) {
        return 0;
    }
    cli_kept_pairs_settle(pairs);
    if (pairs->room > 0 && pairs->count <= pairs->room / 2) {
        return 0;
    }
    room = pairs->room == 0 ? ROOM_MIN : pairs->room * 2;
    said = realloc(pairs->said, room * sizeof(*said));
    if (said == NULL) {
        return PCCD_E_NOMEM;
    }
    pairs->said = said;
    pairs->room = room;
    return 0;
}

int cli_kept_pairs_note(struct cli_kept_pairs *pairs, uint32_t a, uint32_t b,
                        bool ignored)
{
    int rc = make_room(pairs);

    if (rc == 0) {
        pairs->said[pairs->count] = (struct cli_kept_pair){.a = a < b ? a : b,
                                                           .b = a < b ? b : a,
                                                           .order = pairs->count,
                                                           .ignored = ignored};
        pairs->count++;
    }
    return rc;
}

void cli_kept_pairs_forget(struct cli_kept_pairs *pairs, uint32_t object)
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

void cli_kept_pairs_deinit(struct cli_kept_pairs *pairs)
{
    free(pairs->said);
}
