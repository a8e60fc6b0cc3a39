/* client/ctl/record/world_pairs.c - pairs of objects that ignore each other.
 *
 * Room:     client/ctl.
 * Does:     see world_pairs.h. A sorted array: many pairs come at once, at the beginning,
 *           and few at a time later.
 * Threads:  one.
 * Source:   world_pairs.h.
 */
#include "world_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

static int compare(const void *left, const void *right)
{
    const uint32_t *l = left, *r = right;
    if (l[0] != r[0]) {
        return l[0] < r[0] ? -1 : 1;
    }
    return (l[1] > r[1]) - (l[1] < r[1]);
}

/* Index of the first pair that is not less. */
static uint32_t index_of(const struct world_pairs *pairs, const uint32_t key[2])
{
    uint32_t first = 0, end = pairs->count;
    while (first < end) {
        uint32_t middle = first + (end - first) / 2;
        if (compare(pairs->items[middle], key) < 0) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first;
}

static bool is_at(const struct world_pairs *pairs, uint32_t index, const uint32_t key[2])
{
    return index < pairs->count && compare(pairs->items[index], key) == 0;
}

bool world_pairs_has(const struct world_pairs *pairs, uint32_t a, uint32_t b)
{
    const uint32_t key[2] = {a < b ? a : b, a < b ? b : a};
    return is_at(pairs, index_of(pairs, key), key);
}

static int make_room(struct world_pairs *pairs, uint32_t count)
{
    uint64_t wanted = (uint64_t)pairs->count + count;
    if (wanted <= pairs->room) {
        return PCCD_OK;
    }
    wanted += wanted / 2;
    void *items = wanted > UINT32_MAX
                      ? NULL
                      : realloc(pairs->items, (size_t)wanted * sizeof(*pairs->items));
    if (items == NULL) {
        return PCCD_E_NOMEM;
    }
    pairs->items = items;
    pairs->room = (uint32_t)wanted;
    return PCCD_OK;
}

/* Leave each but once. */
static void unite(struct world_pairs *pairs)
{
    uint32_t kept = 0;
    qsort(pairs->items, pairs->count, sizeof(*pairs->items), compare);
    for (uint32_t i = 0; i < pairs->count; i++) {
        if (kept == 0 || compare(pairs->items[kept - 1], pairs->items[i]) != 0) {
            memmove(pairs->items[kept++], pairs->items[i], sizeof(*pairs->items));
        }
    }
    pairs->count = kept;
}

static void add_one(struct world_pairs *pairs, const uint32_t key[2])
{
    uint32_t index = index_of(pairs, key);
    if (!is_at(pairs, index, key)) {
        memmove(pairs->items + index + 1, pairs->items + index,
                (pairs->count - index) * sizeof(*pairs->items));
        memcpy(pairs->items[index], key, sizeof(*pairs->items));
        pairs->count++;
    }
}

static void remove_one(struct world_pairs *pairs, const uint32_t key[2])
{
    uint32_t index = index_of(pairs, key);
    if (is_at(pairs, index, key)) {
        pairs->count--;
        memmove(pairs->items + index, pairs->items + index + 1,
                (pairs->count - index) * sizeof(*pairs->items));
    }
}

int world_pairs_set(struct world_pairs *pairs, const uint32_t (*which)[2], uint32_t count,
                    bool ignored)
{
    int status = ignored ? make_room(pairs, count) : PCCD_OK;
    for (uint32_t i = 0; status == PCCD_OK && i < count; i++) {
        const uint32_t *pair = which[i];
        const uint32_t key[2] = {pair[0] < pair[1] ? pair[0] : pair[1],
                                 pair[0] < pair[1] ? pair[1] : pair[0]};
        if (!ignored) {
            remove_one(pairs, key);
        } else if (count == 1) {
            add_one(pairs, key);
        } else {
            memcpy(pairs->items[pairs->count++], key, sizeof(key));
        }
    }
    if (status == PCCD_OK && ignored && count > 1) {
        unite(pairs);
    }
    return status;
}

void world_pairs_forget(struct world_pairs *pairs, uint32_t object)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pairs->count; i++) {
        if (pairs->items[i][0] != object && pairs->items[i][1] != object) {
            memmove(pairs->items[kept++], pairs->items[i], sizeof(*pairs->items));
        }
    }
    pairs->count = kept;
}

void world_pairs_deinit(struct world_pairs *pairs)
{
    free(pairs->items);
    memset(pairs, 0, sizeof(*pairs));
}
